"""The command `warpffrf info`: what is in a file."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated

import typer

from warpffrf.cli.asked import Asked
from warpffrf.cli.errors import one_line_errors


def info(
    file: Annotated[Path, typer.Argument(metavar="FILE", help="Mesh, reduced body or results (.h5), sweep (folder).")],
    length_unit: Annotated[
        str | None,
        typer.Option(metavar="UNIT", help="For a mesh: unit of the lengths in the file: m, cm, mm, um, in or ft."),
    ] = None,
    part: Annotated[
        str | None,
        typer.Option(help="For a mesh: which body of several: instance, part or group, or a number from 0."),
    ] = None,
    density: Annotated[
        float | None,
        typer.Option(help="For a mesh: density in kg/m3; left out: that of the file's materials, or steel."),
    ] = None,
    page: Annotated[
        Path | None,
        typer.Option(
            metavar="FILE",
            help="Also write a page here: a picture of a reduced body's quality, of a sweep .html with its pictures.",
        ),
    ] = None,
    overwrite: Annotated[bool, typer.Option("--overwrite", help="Replace a picture that is there.")] = False,
) -> None:
    """Say what is in a file: size, mass, inertia, named sets, modes, or how a run or a sweep went."""
    with one_line_errors():
        from warpffrf.cli.describe import describe_file

        print(
            describe_file(
                file,
                length_unit=length_unit,
                part=part_of(part),
                density=density,
                page=page,
                overwrite=overwrite,
                pairs=Asked.pairs,
            )  # fmt: skip
        )


def part_of(text: str | None) -> int | str | None:
    """`--part`: a number is that of a connected part, anything else a name."""
    return int(text) if text is not None and text.isdecimal() else text
