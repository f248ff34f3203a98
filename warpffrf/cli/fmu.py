"""The command `warpffrf fmu`: a scene file as an FMU."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated

import typer

from warpffrf.cli.errors import one_line_errors
from warpffrf.cli.global_options import Asked
from warpffrf.cli.scenes import SCENE


def fmu_of_scene_file(
    scene_file: Annotated[Path, SCENE],
    out: Annotated[
        Path | None, typer.Option("--out", "-o", metavar="FMU", help="The file to write; default: NAME.fmu.")
    ] = None,
    inputs: Annotated[
        list[str] | None,
        typer.Option(
            "--input", metavar="NAME", help="A signal of kind input, by its name. Repeat for more; default: all."
        ),
    ] = None,
    outputs: Annotated[
        list[str] | None,
        typer.Option(
            "--output",
            metavar="NAME",
            help="A sensor, or a history as results call it: joint_coordinate[hinge]. Repeat for more; default: all "
            "sensors.",
        ),
    ] = None,
    step: Annotated[
        float | None,
        typer.Option(help="Step of the simulation, s; communication steps are multiples. Default: that of [simulate]."),
    ] = None,
    start: Annotated[
        str | None, typer.Option(metavar="STATE", help="initial or equilibrium; default: that of [simulate].")
    ] = None,
    settings: Annotated[
        list[str] | None,
        typer.Option("--set", metavar="NAME=VALUE", help="Another value for a parameter or a key. Repeat for more."),
    ] = None,
    fmi: Annotated[str, typer.Option(metavar="VERSION", help="Version of FMI: 2.0 or 3.0.")] = "2.0",
    overwrite: Annotated[bool, typer.Option("--overwrite", help="Replace an existing FMU.")] = False,
) -> None:
    """Write the scene of a TOML file as an FMU for co-simulation, for Simulink, Modelica tools, Python and others.

    The machine that runs it needs Python with warpffrf. Needs the extra fmu: pip install "warpffrf[fmu]".

    Example: warpffrf fmu motor.toml --input "motor torque" --output tip --step 1e-3 -o motor.fmu
    """
    with one_line_errors():
        from warpffrf.fmu import write_fmu

        path = write_fmu(
            scene_file, out or scene_file.with_suffix(".fmu").name, step=step, inputs=inputs or None,
            outputs=outputs or None, start=start, settings=settings or (), fmi=fmi, overwrite=overwrite,
        )  # fmt: skip
        if not Asked.quiet:
            print(f"FMU written to {path}")
