"""The commands `warpffrf view` and `warpffrf picture`: bodies of a run, on screen and as pictures."""

from __future__ import annotations

import tempfile
from pathlib import Path
from typing import Annotated, Any

import typer

from warpffrf.cli.errors import one_line_errors
from warpffrf.cli.global_options import Asked
from warpffrf.cli.results import THEME, WIDTH

FIELD = typer.Option(
    metavar="FIELD",
    help="What surfaces are coloured by: displacement, pressure, traction, slip, state, wear or von_mises.",
)
RELATIVE_TO = typer.Option(
    metavar="NAME",
    help="Of results: show elastic displacements relative to this interface, or to the 'start'; default: user frames.",
)
OVERWRITE = typer.Option("--overwrite", help="Replace an existing file.")


def add_picture_commands(app: typer.Typer) -> None:
    """Add `view` and `picture` to `app`."""

    @app.command("view")
    def view_results(
        file: Annotated[Path, typer.Argument(metavar="FILE", help="Results (.h5) or recording (.rrd).")],
        field: Annotated[str, FIELD] = "displacement",
        every: Annotated[
            int | None, typer.Option(help="Of results: draw every n-th saved step; default: at most 300 of them.")
        ] = None,
        relative_to: Annotated[str | None, RELATIVE_TO] = None,
        out: Annotated[
            Path | None,
            typer.Option("--out", metavar="RRD", help="Of results: write the recording here and open no viewer."),
        ] = None,
        serve: Annotated[
            bool, typer.Option("--serve", help="Serve it to a browser, on a machine without a screen.")
        ] = False,
        bind: Annotated[
            str, typer.Option(metavar="ADDRESS", help="Of --serve: address to listen on; 0.0.0.0: the whole network.")
        ] = "127.0.0.1",
        overwrite: Annotated[bool, OVERWRITE] = False,
    ) -> None:
        """Open a run in the rerun viewer; results are recorded first.

        Example: warpffrf view press.h5 --field von_mises
        """
        with one_line_errors():
            from warpffrf.model.errors import InputError
            from warpffrf.output.recording import viewer

            if file.suffix.lower() == viewer.ENDING:
                if any(option is not None for option in (out, every, relative_to)) or field != "displacement":
                    raise InputError(
                        "a recording is shown unchanged; --field, --every, --relative-to and --out are for results"
                    )
                _show(file, serve, bind)
                return
            if out is None and not serve and not viewer.has_screen():
                raise InputError(
                    "there is no screen for the viewer; --serve opens the recording in a browser, --out FILE.rrd "
                    "writes it for another machine, and warpffrf picture draws without a screen"
                )
            if out is not None:
                print(_recorded(file, out, field, every, relative_to, overwrite, Asked.quiet))
                return
            with tempfile.TemporaryDirectory() as folder:
                recording = Path(folder) / f"{file.stem}{viewer.ENDING}"
                said = _recorded(file, recording, field, every, relative_to, False, Asked.quiet)
                if not Asked.quiet:
                    print(said)
                _show(recording, serve, bind)

    @app.command("picture")
    def picture_of_results(
        file: Annotated[Path, typer.Argument(metavar="FILE", help="Results (.h5) or recording (.rrd).")],
        out: Annotated[
            Path, typer.Argument(metavar="OUT", help="Of results .png, .pdf, .svg, .gif or .mp4; of a recording .png.")
        ],
        field: Annotated[str, FIELD] = "displacement",
        time: Annotated[
            float | None,
            typer.Option(metavar="SECONDS", help="Of results: draw the saved step nearest to it; default: the last."),
        ] = None,
        every: Annotated[
            int | None, typer.Option(help="Of a .gif or .mp4: a frame for every n-th saved step; default: at most 100.")
        ] = None,
        fps: Annotated[float, typer.Option(help="Of a .gif or .mp4: frames per second.")] = 15.0,
        view: Annotated[
            str | None,
            typer.Option(
                metavar="NAME",
                help="front (from -y), side (from +x), top, iso, or the name of a contact or film for a close-up; "
                "default: one that suits the extents of the bodies.",
            ),
        ] = None,
        deformation_factor: Annotated[
            float | None, typer.Option(help="Magnification of elastic displacements; default: chosen automatically.")
        ] = None,
        relative_to: Annotated[str | None, RELATIVE_TO] = None,
        theme: Annotated[str, THEME] = "light",
        width: Annotated[float | None, WIDTH] = None,
        overwrite: Annotated[bool, OVERWRITE] = False,
    ) -> None:
        """Draw the bodies of a run, still or moving; results need neither screen nor viewer.

        A recording is drawn as it opens in the viewer, at its begin, as the viewer cannot be opened at another time;
        a server requires xvfb and mesa-vulkan-drivers.

        Example: warpffrf picture press.h5 press.gif --field von_mises
        """
        with one_line_errors():
            from warpffrf.model.errors import InputError
            from warpffrf.output.plots.animation import ENDINGS
            from warpffrf.output.recording.viewer import ENDING, recording_picture
            from warpffrf.output.result import Result

            if file.suffix.lower() == ENDING:
                of_results = (time, every, view, deformation_factor, relative_to, width)
                if any(option is not None for option in of_results) or (field, theme) != ("displacement", "light"):
                    raise InputError(
                        "a recording is drawn by its viewer as it opens, at its begin; --time, --view, --theme and the "
                        "other options are for results: warpffrf picture RUN.h5"
                    )
                print(f"written to {recording_picture(file, out, overwrite=overwrite)}")
                return
            result = Result.load(file)
            common: dict[str, Any] = {"view": view, "deformation_factor": deformation_factor, "theme": theme}
            common |= {"relative_to": relative_to, "overwrite": overwrite}
            if out.suffix.lower() in ENDINGS:
                written = result.animate(out, field, every=every, fps=fps, progress=not Asked.quiet, **common)
            else:
                written = result.picture(out, field, time=time, width=width, **common)
            print(f"written to {written}")


def _show(recording: Path, serve: bool, bind: str) -> None:
    """Open the viewer of a recording, or serve it and print the address."""
    from warpffrf.output.recording import viewer

    command = viewer.viewer_command(recording, serve=serve, bind=bind)
    if serve:
        print(viewer.served_at(bind), flush=True)
    viewer.run(command)


def _recorded(
    file: Path, out: Path, field: str, every: int | None, relative_to: str | None, overwrite: bool, is_quiet: bool
) -> str:
    """Record a results file; returns a summary."""
    import time

    from warpffrf.output.recording.recorder import record
    from warpffrf.output.result import Result
    from warpffrf.output.written_file import Written

    begin = time.perf_counter()
    info = record(
        Result.load(file), out, color=field, every=every, relative_to=relative_to, overwrite=overwrite,
        progress=not is_quiet,
    )  # fmt: skip
    written = Written.of("recording", info.path, time.perf_counter() - begin)
    return f"recording: {written}, {info.frames} frames"
