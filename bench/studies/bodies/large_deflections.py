"""Writes docs/studies/large_deflections.md: `python -m studies.bodies.large_deflections [FOLDER]`. A minute or two.

The engine's energy of large deflections, a sum of squares on a quadratic manifold, beside Galerkin's method on
vibration modes, static modal derivatives and ECSW, on a beam, an arch, a plate and a free plate: error beside full
finite elements by number of coordinates, what forces and tangents cost, and whether V4 is definite. `reduced_energies`
derives them.
"""

from __future__ import annotations

import sys
import textwrap
import time
from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any

import numpy as np

from references.large_deflections.body import StVenantKirchhoffBody
from references.large_deflections.statics import by_load
from studies.bodies.reduced_energies import (
    Energy,
    Structure,
    equilibria,
    few_cells,
    free_ends,
    galerkin,
    slaved,
    squares,
    with_derivatives,
)
from warpffrf.model.material import Material
from warpffrf.model.mesh import grid
from warpffrf.offline.reduction import one_thread
from warpffrf.study.markdown import table

Array = np.ndarray
STEEL = Material(210e9, 0.3, 7850.0)
THICK = 0.01  # m, of beam and arch
SPAN, RISE = 1.0, 0.025  # m
SIDE, PLATE = 0.4, 4e-3  # m
MODES = (2, 4, 8)  # of the sum of squares, and slaved derivatives
GALERKIN = (4, 8, 16)
DERIVATIVES = (2, 4)  # modes that derivatives are of
LIMIT = 2472.0  # N: limit load of the whole arch, see the demo `snapping_arch`
STEPS = 8  # load steps
TIMED = 30  # calls


@dataclass(frozen=True)
class Entry:
    """An energy in one structure: error of the load's way at half of the load and at all of it (NaN: no equilibrium),
    us a force and a tangent."""

    energy: Energy
    half: float
    whole: float
    force: float
    tangent: float


@dataclass(frozen=True)
class Compared:
    """A structure: full way over thickness, the linear error there, entries."""

    structure: Structure
    deflection: float
    linear: float
    entries: list[Entry]


def beam(cells: int = 8) -> Structure:
    """Half of a beam clamped at both ends, under a uniform load, w/t 1.9."""
    mesh = grid(np.linspace(0.0, 0.5 * SPAN, cells + 1), [-0.015, 0.015], [-0.5 * THICK, 0.5 * THICK])
    body = StVenantKirchhoffBody(mesh, STEEL)
    held = np.concatenate([body.held("x_max"), _plane(body, 0), _plane(body, 1)])
    load = body.body_force((0.0, 0.0, 1.0))
    return Structure("beam", body, np.unique(held), load, _steps(6000.0), end=_end(body))


def arch(cells: int = 10) -> Structure:
    """Half of a clamped arch 2.5 times as high as thick, pushed at its crown to 0.9 of its limit load."""
    flat = grid(np.linspace(0.0, 0.5 * SPAN, cells + 1), [-0.015, 0.015], [-0.5 * THICK, 0.5 * THICK])
    height = RISE * (1.0 - (2.0 * flat.points[:, 0] / SPAN) ** 2)
    bent = replace(flat, points=flat.points + height[:, None] * np.array([0.0, 0.0, 1.0]))
    body = StVenantKirchhoffBody(bent.select("crown", "z_max", lambda x: x[:, 0] < 0.05), STEEL)
    held = np.concatenate([body.held("x_max"), _plane(body, 0), _plane(body, 1)])
    load = body.spread("crown", (0.0, 0.0, -1.0))
    return Structure("arch", body, np.unique(held), load, _steps(0.45 * LIMIT), end=_end(body))


def plate(cells: int = 5) -> Structure:
    """A quarter of a clamped plate under pressure, w/t 1.8."""
    body = _quarter(cells, 1.5)
    edges = np.isclose(body.mesh.points[:, :2].max(axis=1), 0.5 * SIDE)
    rim = (3 * np.flatnonzero(edges)[:, None] + np.arange(3)).ravel()
    held = np.unique(np.concatenate([rim, _plane(body, 0), _plane(body, 1)]))
    unit = STEEL.youngs_modulus * PLATE**3 / (SIDE**4 * STEEL.density)
    return Structure("clamped plate", body, held, body.body_force((0.0, 0.0, unit)), _steps(402.0))


def free_plate(cells: int = 5) -> Structure:
    """A quarter of a free plate pushed in its middle, and by its inertia everywhere, w/t 3."""
    body = _quarter(cells, 1.0)
    still = np.array([3 * body.nearest_node((0.0, 0.0, 0.0)) + 2])
    held = np.unique(np.concatenate([still, _plane(body, 0), _plane(body, 1)]))
    inertia = body.body_force((0.0, 0.0, 1.0))
    load = body.spread("middle", (0.0, 0.0, 1.0)) - inertia / inertia[2::3].sum()
    return Structure("free plate", body, held, load, _steps(4500.0), still)


def _quarter(cells: int, power: float) -> StVenantKirchhoffBody:
    x = 0.5 * SIDE * (1.0 - (1.0 - np.linspace(0.0, 1.0, cells + 1)) ** power)
    mesh = grid(x, x, [-0.5 * PLATE, 0.5 * PLATE])
    return StVenantKirchhoffBody(mesh.select("middle", "z_max", lambda y: y[:, :2].max(axis=1) < 0.25 * SIDE), STEEL)


def _plane(body: StVenantKirchhoffBody, c: int) -> Array:
    """Dofs across the plane of symmetry of component c."""
    return 3 * np.flatnonzero(np.isclose(body.mesh.points[:, c], 0.0, atol=1e-9)) + c


def _end(body: StVenantKirchhoffBody) -> Array:
    """Nodes of the clamped end."""
    return body.mesh.facets("x_max").node_set


def _steps(most: float) -> Array:
    return most * np.arange(1, STEPS + 1) / STEPS


def energies(structure: Structure) -> list[Energy]:
    """All of them; ECSW is trained by the load steps in its basis, up and down."""
    found: list[Energy] = [squares(structure, structure.modes(m)) for m in MODES]
    if len(structure.end):
        found += [free_ends(structure, m) for m in MODES]
    found += [slaved(structure, structure.modes(m)) for m in MODES]
    found += [galerkin(structure, structure.modes(m), "Galerkin, modes") for m in GALERKIN]
    for m in DERIVATIVES:
        basis, solves = with_derivatives(structure, structure.modes(m)), m * (m + 1) // 2
        whole = galerkin(structure, basis, f"{m} modes and derivatives", solves, m)
        found.append(whole)
        states = [q for q in equilibria(whole, structure.factors) if np.isfinite(q).all()]
        cut = few_cells(structure, basis, [*states, *(-q for q in states)], solves)
        cut.name = f"ECSW of these, {cut.cells} of {len(structure.body.nodes)} cells"
        found.append(cut)
    return found


def compared(structure: Structure) -> Compared:
    """Everything of one structure."""
    return compared_with(structure, energies(structure))


def compared_with(structure: Structure, chosen: Sequence[Energy]) -> Compared:
    """The `chosen` energies beside full finite elements."""
    body = structure.body
    states = by_load(body, structure.held, structure.load, list(structure.factors))
    ways = np.array([structure.load @ s.u for s in states])
    linear = structure.factors * (structure.load @ structure.solve(structure.load[:, None])[:, 0])
    entries = []
    for energy in chosen:
        found = equilibria(energy, structure.factors)
        error = [energy.way(found[k]) / ways[k] - 1.0 for k in (STEPS // 2 - 1, STEPS - 1)]
        at = next((q for q in reversed(found) if np.isfinite(q).all()), np.zeros(energy.coordinates))
        entries.append(
            Entry(energy, error[0], error[1], _microseconds(energy.force, at), _microseconds(energy.tangent, at))
        )
    thickness = np.ptp(body.mesh.points[:, 2]) if structure.name != "arch" else THICK
    deflection = float(np.abs(states[-1].u[2::3]).max() / thickness)
    return Compared(structure, deflection, float(linear[-1] / ways[-1] - 1.0), entries)


def _microseconds(call: Callable[[Array], Any], q: Array) -> float:
    taken = []
    for _ in range(TIMED):
        begin = time.perf_counter()
        call(q)
        taken.append(time.perf_counter() - begin)
    return float(np.median(taken)) * 1e6


def rows(one: Compared) -> list[list[str]]:
    """Of the table of a structure."""

    def percent(value: float) -> str:
        return f"{value:+.2%}" if np.isfinite(value) else "none"

    found = []
    for entry in one.entries:
        energy = entry.energy
        definite = "weights above 0" if energy.definite is None else f"{energy.definite:+.0e}"
        found.append([
            energy.name, str(energy.coordinates), str(energy.solves), percent(entry.half), percent(entry.whole),
            f"{energy.force_operations:.1e}", f"{energy.tangent_operations:.1e}", f"{entry.force:.0f}",
            f"{entry.tangent:.0f}", definite,
        ])  # fmt: skip
    return found


def page(all_of: Sequence[Compared]) -> str:
    """The Markdown page."""
    what = f"""Structures of hex27 cells, each a half or a quarter by symmetry, under loads that keep their direction,
in {STEPS} load steps. Errors are those of the work that the load does, its way, beside full finite elements of St.
Venant-Kirchhoff's material, at half of the load and at all of it; *none*: no equilibrium was found. Vibration modes are
those that the load works on by symmetry. *Sum of squares* is the energy of `stiffening="membrane"`, of modes of the
held structure; *ends free*, as the engine has it, of modes of the free body, whose end moves and is held by multipliers
(coordinates before these; a rim of a plate is one rigid interface and moves nothing, so that there both are the same).
*Derivatives slaved* is the manifold of modal derivatives, with all of the second-order force, to fourth order, *modes
and derivatives* takes them as coordinates of their own, *ECSW* its forces from a few cells. Solves: static ones before
anything is computed. Multiply-adds of a force and a tangent by the formulas in
`bench/studies/bodies/reduced_energies.py`, microseconds of the same in NumPy on one core, which others share. Definite:
least over largest eigenvalue of V4 on products of the modes."""
    parts = []
    head = ["energy", "coordinates", "solves", "error at 1/2", "error"]
    head += ["force", "tangent", "force µs", "tangent µs", "definite"]
    for one in all_of:
        about = f"""{(one.structure.body.size)} dofs, {len(one.structure.body.nodes)} cells; it deflects by
{one.deflection:.2f} times its thickness, without second-order terms the way would be off by {one.linear:+.0%}."""
        parts.append(f"## {one.structure.name.capitalize()}\n\n{textwrap.fill(about, 120)}\n\n{table(head, rows(one))}")
    return f"""# Large deflections: the energy of few coordinates

Made by `python -m studies.bodies.large_deflections`; do not edit.

{textwrap.fill(what, 120)}

{chr(10).join(parts)}
## What to take from it

{reading(all_of)}"""


def reading(all_of: Sequence[Compared]) -> str:
    """Sentences whose figures are those of the tables."""

    def told(begins: str, last: bool = True) -> str:
        found = []
        for one in all_of:
            entries = [e for e in one.entries if e.energy.name.startswith(begins)]
            entry = entries[-1 if last else 0]
            error = f"{entry.whole:+.1%}" if np.isfinite(entry.whole) else "none"
            found.append(f"{one.structure.name} {error} ({entry.energy.coordinates})")
        return ", ".join(found)

    def cost(begins: str) -> tuple[float, float]:
        entries = [e for one in all_of for e in one.entries if e.energy.name.startswith(begins)]
        return max(e.energy.force_operations for e in entries), max(e.energy.tangent_operations for e in entries)

    own, few, m = cost("sum of squares"), cost("ECSW"), DERIVATIVES[-1]
    least = min(e.energy.definite or 0.0 for one in all_of for e in one.entries if e.energy.name.startswith("sum"))
    worst = min(e.energy.definite or 0.0 for one in all_of for e in one.entries if "slaved" in e.energy.name)
    ended = [one for one in all_of if len(one.structure.end)]
    held = {one.structure.name: e.whole for one in ended for e in one.entries if e.energy.name == "sum of squares"}
    same = ", ".join(
        f"{one.structure.name} {e.whole:+.1%}"
        for one in all_of
        for e in one.entries
        if e.energy.name == "sum of squares" and e.energy.coordinates == m and not len(one.structure.end)
    )
    points = [
        f"Error under all of the load, coordinates in brackets: sum of squares {told('sum of squares')}; modal "
        f"derivatives as coordinates {told(f'{m} modes and')}; slaved {told('derivatives slaved')}; Galerkin on modes "
        f"alone {told('Galerkin')}: modes that bend lock, and more of them hardly help. Derivatives "
        f"of {m} modes are as near as the sum of squares of these alone, {same}. The arch is off by "
        f"{held['arch']:+.0%} if its end is held from the start, not by the thrust that it answers: ends must move.",
        f"A force takes {own[0]:.0e} multiply-adds and a tangent {own[1]:.0e} by the sum of squares, at most, with "
        f"ECSW {few[0]:.0e} and {few[1]:.0e}, as cells are evaluated whatever the coordinates are.",
        f"V4 as a sum of squares is never negative, its least eigenvalue over its largest {least:.0e} is round-off; "
        f"slaved derivatives with all of the second-order force have {worst:.1e}, an energy without a lower bound.",
    ]
    return "\n".join(textwrap.fill(p, 120, initial_indent="- ", subsequent_indent="  ") for p in points) + "\n"


def main(arguments: Sequence[str] | None = None) -> None:
    """Make the page."""
    given: Sequence[Any] = sys.argv[1:] if arguments is None else arguments
    folder = Path(given[0] if given else "docs/studies")
    folder.mkdir(parents=True, exist_ok=True)
    with one_thread():
        all_of = [compared(make()) for make in (beam, arch, plate, free_plate)]
    (folder / "large_deflections.md").write_text(page(all_of))
    print(folder / "large_deflections.md")


if __name__ == "__main__":
    main()
