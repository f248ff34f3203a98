"""The command `warpffrf reduce`: reduction of a mesh to a reduced body."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated, Any

import typer

import warpffrf
from warpffrf.cli.errors import one_line_errors
from warpffrf.cli.global_options import Asked
from warpffrf.cli.info import part_of


def reduce_mesh(
    mesh_file: Annotated[
        Path, typer.Argument(metavar="MESH", help="Volume mesh: .msh, .vtu, .inp (Abaqus, CalculiX), .bdf (Nastran).")
    ],
    length_unit: Annotated[
        str, typer.Option(metavar="UNIT", help="Unit of the lengths in the mesh file: m, cm, mm, um, in or ft.")
    ],
    output: Annotated[Path, typer.Option("--output", "-o", help="File to write, for example roller.h5.")],
    youngs_modulus: Annotated[
        float | None, typer.Option(help="Young's modulus in Pa, for steel 210e9. Default: the materials of the file.")
    ] = None,
    poisson_ratio: Annotated[float | None, typer.Option(help="Poisson's ratio, for steel 0.3.")] = None,
    density: Annotated[float | None, typer.Option(help="Density in kg/m3, for steel 7850.")] = None,
    part: Annotated[
        str | None,
        typer.Option(
            help="Body to read of several: instance, part or group, or the number of a connected part from 0."
        ),
    ] = None,
    interface: Annotated[
        list[str] | None,
        typer.Option(
            metavar="SET",
            help="Named set of facets for joints: rigid, SET, by its mean motion, SET=average, or node by node, "
            "SET=free. Repeat for more.",
        ),
    ] = None,
    contact: Annotated[
        list[str] | None,
        typer.Option(
            metavar="SET", help="Named set of facets for contact; a cylinder is fitted to it. Repeat for more."
        ),
    ] = None,
    max_frequency: Annotated[
        float | None, typer.Option(help="Keep vibration modes up to this frequency in Hz.")
    ] = None,
    basis: Annotated[
        str, typer.Option(help="free_free, craig_bampton, craig_chang, krylov, balanced or pod.")
    ] = "free_free",
    modes: Annotated[int | None, typer.Option(help="Keep at most this many vibration modes.")] = None,
    spacing: Annotated[
        float | None, typer.Option(help="Spacing of the contact grid in m; default: that of the mesh.")
    ] = None,
    half_width: Annotated[
        float | None,
        typer.Option(help="Instead of a spacing: expected half-width of the contact patch in m (force within 1 %)."),
    ] = None,
    stress: Annotated[
        list[str] | None,
        typer.Option(metavar="SET", help="Set of facets, skin or all, where stresses are computed. Repeat for more."),
    ] = None,
    inertia_modes: Annotated[
        int | None,
        typer.Option(help="Number of global modes, from the lowest, with inertia terms; default: all up to 60."),
    ] = None,
    stiffening: Annotated[
        bool,
        typer.Option("--stiffening", help="Geometric stiffness of the modes by rotation and by loads on interfaces."),
    ] = False,
    membrane: Annotated[
        bool,
        typer.Option(
            "--membrane", help="As --stiffening, with the membrane energy of plates and frames at large deflections."
        ),
    ] = False,
    membrane_modes: Annotated[
        int | None, typer.Option(help="Number of modes, from the lowest, with membrane energy; default: up to 20.")
    ] = None,
    centrifugal: Annotated[
        bool,
        typer.Option(
            "--centrifugal", help="Also modes for the static response to rotation: for rotors, discs, rings and blades."
        ),
    ] = False,
    local_dynamics: Annotated[
        bool,
        typer.Option("--local-dynamics", help="Also the mass of the local modes, for runs that give them inertia."),
    ] = False,
    cache: Annotated[
        bool, typer.Option(help="Read an unchanged body from the cache instead of reducing again.")
    ] = True,
    overwrite: Annotated[bool, typer.Option("--overwrite", help="Replace an existing reduced body.")] = False,
) -> None:
    """Reduce a finite-element mesh to a body for simulations.

    Example: warpffrf reduce roller.msh --length-unit mm --youngs-modulus 210e9 --poisson-ratio 0.3 --density 7850
    --interface bore --contact rim --max-frequency 20e3 -o roller.h5

    Names of the sets in a mesh: warpffrf info MESH --length-unit mm
    """
    with one_line_errors():
        from warpffrf.model.files.paths import check_ending, checked_output_path, size_text

        check_ending(output, "--output", (".h5", ".hdf5"))
        target = checked_output_path(output, "--output", overwrite=overwrite)
        mesh = warpffrf.mesh.read(mesh_file, length_unit=length_unit, part=part_of(part))
        body = warpffrf.reduce(
            mesh,
            _material(mesh, youngs_modulus, poisson_ratio, density),
            interfaces={name: kind or "rigid" for name, _, kind in (entry.partition("=") for entry in interface or [])},
            contact=dict.fromkeys(contact or []),
            basis=basis,
            max_frequency=max_frequency,
            modes=modes,
            stress={name: name for name in stress or []},
            grid=warpffrf.ContactGrid(spacing=spacing, expected_half_width=half_width),
            options=warpffrf.ReductionOptions(
                inertia_modes=inertia_modes,
                stiffening="membrane" if membrane else stiffening,
                membrane_modes=membrane_modes,
                centrifugal=centrifugal,
                local_dynamics=local_dynamics,
            ),
            cache=cache,
            progress=not Asked.quiet,
        )
        body.save(target, overwrite=overwrite)
        if not Asked.quiet:
            print(body.info())
            print(f"written to {target}, {size_text(target.stat().st_size)}")


def _material(mesh: Any, E: float | None, nu: float | None, rho: float | None) -> Any:
    """The material of the three options, or the materials of the mesh file."""
    given = [value for value in (E, nu, rho) if value is not None]
    if len(given) == 3:
        return warpffrf.Material(*given)
    if given:
        raise warpffrf.InputError("--youngs-modulus, --poisson-ratio and --density belong together; give all three")
    if not mesh.materials:
        raise warpffrf.InputError(
            f"mesh {mesh.name}: the file defines no material; add --youngs-modulus, --poisson-ratio and --density"
        )
    return mesh.materials
