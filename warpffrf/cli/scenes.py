"""The commands `warpffrf run`, `modes` and `campbell`, which act on scene files."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated, Any

import typer

import warpffrf
from warpffrf.cli.errors import one_line_errors
from warpffrf.cli.global_options import Asked

SCENE = typer.Argument(metavar="SCENE", help="Scene file, .toml; reference: warpffrf scene-file.")
EQUILIBRIUM = "equilibrium"  # default state of the modes


def run_scene_file(
    scene_file: Annotated[Path, SCENE],
    settings: Annotated[
        list[str] | None,
        typer.Option(
            "--set",
            metavar="NAME=VALUE",
            help="Another value for a parameter or a key, by its dotted name: --set upper.load=2000. Repeat for more.",
        ),
    ] = None,
    out: Annotated[
        Path | None, typer.Option("--out", help="Folder for the results; default: out/NAME of the file NAME.toml.")
    ] = None,
    anywhere: Annotated[
        bool, typer.Option("--anywhere", help="Allow results and recordings outside the folder.")
    ] = False,
    check: Annotated[bool, typer.Option("--check", help="Build the scene and describe it, but do not run it.")] = False,
    overwrite: Annotated[bool, typer.Option("--overwrite", help="Replace the files of an earlier run.")] = False,
    resume: Annotated[
        bool,
        typer.Option("--resume", help="Continue an interrupted run in the same folder, or read it if it is complete."),
    ] = False,
) -> None:
    """Run the scene of a TOML file: bodies, joints, drives, forces, contacts, and how to simulate them.

    Writes the results (.h5), a recording if requested (.rrd, open it with: rerun FILE), and the scene as run
    (.toml) into a folder, and prints a report. Exit code 1 if a solver failed or a file could not be written; results
    are kept. Ctrl-C stops a run and keeps its results; --resume continues it.

    Example: warpffrf run press.toml --set upper.load=2000 --set simulate.step=5e-5 --out out/press
    """
    with one_line_errors():
        from warpffrf.scene_file import load_scene, run_scene

        if check:
            print(load_scene(scene_file, settings=settings or ()).scene.check())
            return
        results = run_scene(
            scene_file, settings=settings or (), out=out, anywhere=anywhere, progress=not Asked.quiet,
            overwrite=overwrite, resume=resume,
        )  # fmt: skip
        for call, result in results.items():
            if not Asked.quiet:
                print(f"{call}\n{result.report(pairs=Asked.pairs)}")
                for file in result.written:
                    if file.what == "results":  # again, with the error budget of the report
                        result.save(file.path, overwrite=True)
        if any(result.status != "completed" or result.unwritten for result in results.values()):
            raise typer.Exit(1)


def modes_of_scene_file(
    scene_file: Annotated[Path, SCENE],
    settings: Annotated[
        list[str] | None,
        typer.Option(
            "--set", metavar="NAME=VALUE", help="Another value for a parameter or a key, as in run. Repeat for more."
        ),
    ] = None,
    count: Annotated[int, typer.Option(help="Number of modes, from the lowest.")] = 20,
    about: Annotated[
        str,
        typer.Option(
            metavar="STATE",
            help="equilibrium, initial, or a results file (.h5) of this scene, of which the last state is used.",
        ),
    ] = EQUILIBRIUM,
    out: Annotated[
        Path | None, typer.Option("--out", metavar="PNG", help="Also draw their shapes here: .png, .pdf or .svg.")
    ] = None,
    overwrite: Annotated[bool, typer.Option("--overwrite", help="Replace an existing picture.")] = False,
) -> None:
    """List frequencies, damping and moving bodies of the lowest modes of a machine, joints and contacts included.

    Example: warpffrf modes press.toml --count 6 --about out/press/press.h5
    """
    with one_line_errors():
        from warpffrf.scene_file import load_scene

        scene = load_scene(scene_file, settings=settings or ()).scene
        modes = warpffrf.eigenmodes(scene, count, about=_state(about), progress=not Asked.quiet)
        print(modes.report())
        if out is not None:
            from warpffrf.output.plots.picture import write_picture

            print(f"drawn to {write_picture(modes.plot_shapes(count), out, 'modes', overwrite=overwrite)}")


def campbell_of_scene_file(
    scene_file: Annotated[Path, SCENE],
    speed: Annotated[str, typer.Argument(metavar="NAME", help="The key of the speed [rad/s], as in --set of run.")],
    last: Annotated[float, typer.Argument(metavar="LAST", help="The largest speed, rad/s.")],
    first: Annotated[float, typer.Option(metavar="SPEED", help="The smallest speed, rad/s.")] = 0.0,
    steps: Annotated[int, typer.Option(help="Number of steps from the smallest to the largest speed.")] = 12,
    settings: Annotated[
        list[str] | None,
        typer.Option("--set", metavar="NAME=VALUE", help="Another value for a parameter or a key. Repeat for more."),
    ] = None,
    count: Annotated[int, typer.Option(help="Number of modes at each speed, from the lowest.")] = 12,
    out: Annotated[
        Path | None, typer.Option("--out", metavar="PNG", help="Also draw the diagram here: .png, .pdf or .svg.")
    ] = None,
    overwrite: Annotated[bool, typer.Option("--overwrite", help="Replace an existing picture.")] = False,
) -> None:
    """List natural frequencies about the initial state of a machine against the speed of its rotation.

    Example: warpffrf campbell rotor.toml speed 600 --out campbell.png
    """
    with one_line_errors():
        from warpffrf.output.plots.picture import write_drawing
        from warpffrf.scene_file import load_scene

        if steps < 1:
            raise warpffrf.InputError(f"--steps is {steps}; it must be at least 1")

        def build(rate: float) -> warpffrf.Scene:
            return load_scene(scene_file, settings=[*(settings or ()), f"{speed}={rate!r}"]).scene

        speeds = [first + (last - first) * n / steps for n in range(steps + 1)]
        found = warpffrf.campbell(build, speeds, count, progress=not Asked.quiet)
        print(found.report())
        if out is not None:
            print(f"drawn to {write_drawing(found.plot, out, 'campbell', overwrite=overwrite)}")


def _state(about: str) -> Any:
    """Argument `about` of `eigenmodes` for the option `--about`."""
    if about in (EQUILIBRIUM, "initial"):
        return None if about == EQUILIBRIUM else about
    if Path(about).suffix.lower() not in (".h5", ".hdf5"):
        raise warpffrf.InputError(f"--about is {about!r}; known: {EQUILIBRIUM}, initial, or a results file (.h5)")
    return warpffrf.Result.load(about)
