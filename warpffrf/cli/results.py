"""The commands `warpffrf report`, `compare`, `plot` and `spectrum`: evaluation of results files."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated, Any

import typer

from warpffrf.cli.errors import one_line_errors
from warpffrf.cli.global_options import Asked

OVERWRITE = typer.Option("--overwrite", help="Replace an existing picture.")
THEME = typer.Option(metavar="NAME", help="Of the picture: light or dark.")
WIDTH = typer.Option(metavar="METRES", help="Of the picture: width in print, such as 0.09 or 0.18; text stays legible.")


def add_result_commands(app: typer.Typer) -> None:
    """Add `report`, `compare`, `plot` and `spectrum` to `app`."""

    @app.command("report")
    def report_page(
        file: Annotated[Path, typer.Argument(metavar="FILE", help="Results file (.h5).")],
        out: Annotated[Path, typer.Option("--out", "-o", metavar="HTML", help="The page to write: .html.")],
        since: Annotated[
            float | None, typer.Option(metavar="SECONDS", help="Only the part of the run from this time on.")
        ] = None,
        overwrite: Annotated[bool, typer.Option("--overwrite", help="Replace an existing page.")] = False,
    ) -> None:
        """Write a run as one self-contained HTML page: model, figures with their errors, plots, settings.

        It opens in any browser, without a network, and prints on A4. The report as text: warpffrf info FILE.

        Example: warpffrf report press.h5 -o press.html
        """
        with one_line_errors():
            from warpffrf.output.result import Result

            result = Result.load(file)
            part = result if since is None else result.since(since)
            print(f"written to {part.page(out, overwrite=overwrite, progress=not Asked.quiet)}")

    @app.command("compare")
    def compare_results(
        first: Annotated[Path, typer.Argument(metavar="A", help="Results file (.h5) to compare with.")],
        second: Annotated[Path, typer.Argument(metavar="B", help="Results file (.h5) that is compared.")],
        out: Annotated[
            Path | None, typer.Option("--out", metavar="PNG", help="Also draw both runs here: .png, .pdf or .svg.")
        ] = None,
        drawn: Annotated[
            list[str] | None,
            typer.Option(
                "--history",
                metavar="NAME",
                help="For the picture: a history by its name in the table; default: the six that differ most. Repeat "
                "for more.",
            ),
        ] = None,
        every: Annotated[
            bool, typer.Option("--all", help="List all differences, not only the first twenty of each.")
        ] = False,
        theme: Annotated[str, THEME] = "light",
        width: Annotated[float | None, WIDTH] = None,
        overwrite: Annotated[bool, OVERWRITE] = False,
    ) -> None:
        """List the settings in which two runs differ, and the deviation of each history of B from that of A.

        The relative L2 norm is over the common time of both runs, at the times of A.

        Example: warpffrf compare fine.h5 coarse.h5 --out both.png
        """
        with one_line_errors():
            import warpffrf
            from warpffrf.output.comparison import LISTED

            if drawn and out is None:
                raise warpffrf.InputError("--history selects what is drawn; give the file with --out PNG")
            found = warpffrf.compare(first, second)
            print(found.report(None if every else LISTED))
            if out is not None:
                print(f"drawn to {found.save_figure(out, drawn, theme=theme, width=width, overwrite=overwrite)}")

    @app.command("plot")
    def plot_results(
        file: Annotated[Path | None, typer.Argument(metavar="FILE", help="Results file (.h5).")] = None,
        kind: Annotated[str, typer.Argument(metavar="KIND", help="What to draw; see --list.")] = "summary",
        out: Annotated[
            Path | None, typer.Option("--out", metavar="PNG", help="The picture to write: .png, .pdf or .svg.")
        ] = None,
        listed: Annotated[
            bool, typer.Option("--list", help="List the kinds of plots; with FILE those that it has data for.")
        ] = False,
        contact: Annotated[
            str | None, typer.Option(metavar="NAME", help="Contact to draw; default: the first.")
        ] = None,
        film: Annotated[str | None, typer.Option(metavar="NAME", help="Oil film to draw; default: the first.")] = None,
        row: Annotated[
            int | None,
            typer.Option(help="Saved step of maps of films and small-sliding contacts, from 0; default: the last."),
        ] = None,
        channel: Annotated[
            str | None,
            typer.Option(
                metavar="HISTORY",
                help="Of spectrum and waterfall: history to draw, by its column name in to_csv: 'contact_force_z[a on "
                "b]'.",
            ),
        ] = None,
        speed: Annotated[
            str | None, typer.Option(metavar="BODY", help="Of spectrum and waterfall: over the rotation of this body.")
        ] = None,
        theme: Annotated[str, THEME] = "light",
        width: Annotated[float | None, WIDTH] = None,
        overwrite: Annotated[bool, OVERWRITE] = False,
    ) -> None:
        """Draw one kind of plot of a run into a picture; without KIND, a page with all kinds that the run has data for.

        Example: warpffrf plot press.h5 force --out force.png
        """
        with one_line_errors():
            from warpffrf.model.errors import InputError
            from warpffrf.output.plots.figure import about_kinds, drawable, write_plot
            from warpffrf.output.plots.panels import HISTORY_PLOTS
            from warpffrf.output.result import Result

            if file is None and not listed:
                raise InputError("give the results file (.h5) to draw; --list lists the kinds of plots")
            result = None if file is None else Result.load(file)
            if listed:
                known = about_kinds()
                kinds = [*known] if result is None else [*drawable(result, film), *HISTORY_PLOTS, "summary"]
                width = max(map(len, kinds))
                print("\n".join(f"{name:{width}}  {known[name]}" for name in kinds))
                return
            if out is None:
                raise InputError("give the file of the picture with --out, as in --out force.png")
            written = write_plot(
                result, kind, out, contact=contact, film=film, row=row, channel=channel, speed=speed,
                theme=theme, width=width, overwrite=overwrite,
            )  # fmt: skip
            print(f"written to {written}")

    @app.command("spectrum")
    def spectrum_of_results(
        file: Annotated[Path, typer.Argument(metavar="FILE", help="Results file (.h5).")],
        history: Annotated[
            str, typer.Argument(metavar="HISTORY", help="Column name in to_csv: 'contact_force_z[a on b]'.")
        ],
        orders_of: Annotated[
            str | None,
            typer.Option(metavar="BODY", help="By orders of the rotation of this body instead of by frequency."),
        ] = None,
        peaks: Annotated[int, typer.Option(help="Number of peaks to list, the largest first.")] = 5,
        out: Annotated[
            Path | None, typer.Option("--out", metavar="PNG", help="Also draw it here: .png, .pdf or .svg.")
        ] = None,
        theme: Annotated[str, THEME] = "light",
        width: Annotated[float | None, WIDTH] = None,
        overwrite: Annotated[bool, OVERWRITE] = False,
    ) -> None:
        """List the largest amplitudes in a history of a run by frequency, or by orders of the rotation of a body.

        Example: warpffrf spectrum press.h5 "contact_force_z[lower-upper]" --out spectrum.png
        """
        with one_line_errors():
            from warpffrf.output.plots.picture import write_drawing
            from warpffrf.output.result import Result

            result = Result.load(file)
            found = result.spectrum(history) if orders_of is None else result.orders(history, orders_of)
            print(found.report(peaks))
            if out is not None:
                look: dict[str, Any] = {"theme": theme, "width": width, "overwrite": overwrite}
                print(f"drawn to {write_drawing(found.draw, out, 'spectrum', **look)}")
