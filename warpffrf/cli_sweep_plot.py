"""The command `warpffrf sweep-plot`: pictures of a sweep that has been run."""

from __future__ import annotations

import tomllib
from collections.abc import Sequence
from pathlib import Path
from typing import Annotated, Any

import typer

from warpffrf.cli_errors import one_line_errors


def rows_of(texts: Sequence[str]) -> dict[str, Any]:
    """`--where NAME=VALUE` as values: numbers and truth values as TOML has them, else texts. Raises `InputError`."""
    from warpffrf.model.errors import InputError

    found: dict[str, Any] = {}
    for text in texts:
        name, equals, value = (part.strip() for part in text.partition("="))
        if not equals or not name or not value:
            raise InputError(f"--where {text!r}: write --where NAME=VALUE, for example --where friction=0.2")
        try:
            found[name] = tomllib.loads(f"v = {value}")["v"]
        except tomllib.TOMLDecodeError:
            found[name] = value
    return found


def add_sweep_plot_command(app: typer.Typer) -> None:
    """Add `sweep-plot` to `app`."""

    @app.command("sweep-plot")
    def plot_sweep(
        folder: Annotated[Path, typer.Argument(metavar="SWEEP", help="Folder of a sweep.")],
        output: Annotated[str, typer.Argument(metavar="OUTPUT", help="What to draw; `info SWEEP` lists outputs.")],
        out: Annotated[Path, typer.Option("--out", metavar="PNG", help="The picture to write: .png, .pdf or .svg.")],
        x: Annotated[str | None, typer.Option(metavar="NAME", help="Parameter along; left out: the first.")] = None,
        y: Annotated[str | None, typer.Option(metavar="NAME", help="Draw a map; parameter upwards.")] = None,
        hue: Annotated[str | None, typer.Option(metavar="NAME", help="Parameter by colour.")] = None,
        style: Annotated[str | None, typer.Option(metavar="NAME", help="Parameter by dashes.")] = None,
        col: Annotated[str | None, typer.Option(metavar="NAME", help="Parameter with a panel a value.")] = None,
        component: Annotated[str | None, typer.Option(help="Of a vector: x, y or z.")] = None,
        where: Annotated[
            list[str] | None, typer.Option("--where", metavar="NAME=VALUE", help="These rows alone. Repeat for more.")
        ] = None,
        overwrite: Annotated[bool, typer.Option("--overwrite", help="Replace a picture that is there.")] = False,
    ) -> None:
        """Draw an output of a sweep over a parameter, over time, or as a map of two parameters.

        Example: warpffrf sweep-plot press.sweep peak --x upper.load --hue friction --out peak.png
        """
        with one_line_errors():
            from warpffrf.study import open_sweep

            entry = int(component) if component is not None and component.isdecimal() else component
            open_sweep(folder).plot(
                output, x=x, y=y, hue=hue, style=style, col=col, component=entry, where=rows_of(where or ()), path=out,
                overwrite=overwrite,
            )  # fmt: skip
            print(f"written to {out}")
