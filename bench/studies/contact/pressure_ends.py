r"""Errors at the edge of a patch, of nodes, shape functions and contact-fixed cells; ten minutes.

Two equal treads (`evaluations.tread`) are pressed together by a given force with a layer between them, in the ways of
`pressing`: at *nodes*, by *nodes* ("full"), by pressures constant in *cells*, at *points*; and by the program
on STRIPS contact-fixed cells (`patch_ends`), "patch 11" and so on, on the same bodies.

The *reference* is `points` on a mesh of REFINED times as many sectors. Pressures are compared as everywhere, meaned
over the nodes of the coarse grid, f_i/a_i, which is what its forces can tell, in the L2 norm of the surface; the
reference's forces are shared between the nodes of the coarse grid by their values there. The stress is that of
`evaluations`, von Mises at points under the patch, the largest difference over the largest; it is compared on one mesh
only, because close to the surface the cells themselves err by more than the pressures.
"""

from __future__ import annotations

import sys
from dataclasses import dataclass

import numpy as np

from studies.contact.evaluations import STIFFER, layer_of, tread
from studies.contact.patch_ends import ROWS, OnPatch, Refused
from studies.contact.pressing import WAYS, Pressing
from studies.speed.step_time import RADIUS
from warpffrf.model.contact import CELL_ERROR
from warpffrf.model.reduced.far_field import LONGEST
from warpffrf.study.markdown import table

REFINED = 4  # times as many sectors of the reference: with errors of the order 3/2 it errs by an eighth
GRADED = 5  # layers more, so that its outermost cells are square too: 1.3^5 is about 4
PHASES = np.linspace(0.0, 0.5, 5)  # of a column: line of centres on a node, and half way between two
HALF_WIDTH = 0.45  # over sqrt(approach R): where the stress points lie, as in bench/evaluations.py
WIDER, BESIDE = 1.25, 6  # times the half-width, and columns next to it, that the tread has on each side
MESHES = ((2400, 17), (3840, 20))  # sectors, layers; 4 cells along the axis
APPROACHES = (40e-6, 60e-6)  # m
HARD = 300.0
STRIPS = (11, 21, 41)  # of a patch: the first is what `Contact` takes unless another number is given
PATCHES = tuple(f"patch {n}" for n in STRIPS)


@dataclass(frozen=True)
class Ends:
    """Worst of all phases, fractions, by way: pressure against the `reference`, pressure and stress against `points`
    on the same mesh, and against `nodes`."""

    half_width: float  # columns
    reference: dict[str, float]
    points: dict[str, float]
    nodes: dict[str, float]
    stress_points: dict[str, float]
    stress_nodes: dict[str, float]


def ends(coarse: Pressing, fine: Pressing, k: float, approach: float) -> Ends:
    """Errors of all ways with a layer of stiffness k [Pa/m], under the force of "at nodes" at `approach` [m]."""
    load = float(coarse.by_nodes(k, 0.0, approach).sum())
    kinds = ("reference", "points", "nodes", "stress_points", "stress_nodes")
    worst: dict[str, dict[str, float]] = {kind: {} for kind in kinds}
    widths = []
    patches = [OnPatch(coarse, strips) for strips in STRIPS]

    def note(kind: str, way: str, value: float) -> None:
        worst[kind][way] = float(np.maximum(worst[kind].get(way, 0.0), value))  # NaN stays

    for phase in PHASES * coarse.grid.pitch:
        f = fine.forces("points", k, phase, load)
        true = coarse.means(f.reshape(-1, fine.grid.rows), fine.angle)
        size = coarse.norm(true)
        forces = {way: coarse.forces(way, k, phase, load) for way in WAYS}
        for patch in list(patches):
            try:
                forces[patch.name] = patch.forces(k, phase, load)
            except Refused as refusal:
                print(f"{refusal}, layer {k:.3g} Pa/m", file=sys.stderr)
                patches.remove(patch)
                for kind in kinds:
                    note(kind, patch.name, np.nan)
        p = {way: force / coarse.area for way, force in forces.items()}
        stress = {way: coarse.stress(force) for way, force in forces.items()}
        line = true.reshape(-1, coarse.grid.rows) @ coarse.gram_z.sum(axis=1)
        second = line @ (coarse.angle - phase) ** 2 / line.sum()
        widths.append(2.0 * np.sqrt(second) / coarse.grid.pitch)
        for way in forces:
            note("reference", way, coarse.norm(p[way] - true) / size)
            for other in ("points", "nodes"):
                note(other, way, coarse.norm(p[way] - p[other]) / size)
                note(f"stress_{other}", way, float(np.abs(stress[way] - stress[other]).max() / stress[other].max()))
    return Ends(float(np.mean(widths)), **worst)


def pressing(sectors: int, layers: int, approach: float, finer: int = 1) -> Pressing:
    """A tread for patches of `approach` [m]; with `finer` times as many columns, the cells at its rim are as square."""
    half_width = HALF_WIDTH * float(np.sqrt(approach * RADIUS))
    wide = 2.0 * (half_width / (2.0 * np.pi * RADIUS / sectors) * WIDER + BESIDE)
    columns = 2 * (int(wide) * finer // 2) + 1
    body = tread(
        columns + 1, sectors=finer * sectors, layers=layers + (GRADED if finer > 1 else 0), axial=4,
        half_width=half_width if finer == 1 else None, contact_fixed=finer == 1,
    )  # fmt: skip
    return Pressing(body, columns)


def compute() -> list[tuple[int, float, float, Ends]]:
    """Sectors, approach [m], layer over a node, and what was found."""
    rows = []
    for sectors, layers in MESHES:
        fine = pressing(sectors, layers, max(APPROACHES), REFINED)
        for approach in APPROACHES:
            coarse = pressing(sectors, layers, approach)
            for stiffer in (STIFFER, HARD):
                k = layer_of(coarse.body, stiffer).stiffness
                rows.append((sectors, approach, stiffer, ends(coarse, fine, k, approach)))
    return rows


def page(rows: list[tuple[int, float, float, Ends]]) -> str:
    """The page of docs/studies."""
    fixed = ["sectors", "approach [µm]", "layer", "columns"]
    of_law, of_nodal = WAYS[:-1], WAYS[1:]
    sides = [f"{way} / law" for way in of_law] + [f"{way} / at nodes" for way in of_nodal]
    pressure, stress, travelling = [], [], []
    for sectors, approach, stiffer, e in rows:
        line = [str(sectors), f"{approach * 1e6:.0f}", f"{stiffer:g}", f"{e.half_width:.1f}"]
        values = (
            [e.reference[way] for way in WAYS] + [e.points[way] for way in of_law] + [e.nodes[way] for way in of_nodal]
        )
        pressure.append(line + [f"{value:.2%}" for value in values])
        values = [e.stress_points[way] for way in of_law] + [e.stress_nodes[way] for way in of_nodal]
        stress.append(line + [f"{value:.2%}" for value in values])
        values = [e.reference[way] for way in ("nodes", "hats", *PATCHES)]
        values += [e.nodes[way] for way in ("hats", *PATCHES)] + [e.stress_nodes[way] for way in ("hats", *PATCHES)]
        travelling.append(line + ["refused" if np.isnan(value) else f"{value:.2%}" for value in values])
    head = [*fixed, *(f"{way} / reference" for way in WAYS), *sides]
    patch_head = [
        *fixed, *(f"{way} / reference" for way in ("nodes", "hats", *PATCHES)),
        *(f"{way} / at nodes" for way in ("hats", *PATCHES)),
        *(f"{way} / at nodes, stress" for way in ("hats", *PATCHES)),
    ]  # fmt: skip
    return f"""# Where a patch ends: "full" and "at nodes" compared with the law itself

Two equal steel rollers, R = {RADIUS * 1e3:.0f} mm, linear cells, pressed together by the force that "at nodes" has
at the approach, with a layer so many times as stiff as the surface under a node. *Columns* of the grid, which is the
mesh, in a half-width. The law of the layer is met at the *nodes*, by pressures in *nodes* ("full"), by
pressures constant in *cells* around the nodes, or at *points* inside the elements; the last is the law itself on bodies
of that mesh. Worst of {len(PHASES)} places of the patch on the grid.

Pressure, meaned over the nodes, L2 norm: against the *reference*, the law at points of {REFINED} times as many sectors;
against the *law* at points of the same mesh; against *at nodes* on the same mesh.

{table(head, pressure)}
Stress under the patch, von Mises, the largest difference over the largest, on the same mesh:

{table([*fixed, *sides], stress)}
{READ_MATERIAL}
## On contact-fixed cells

The same bodies, layers, forces and reference with `Contact(grid="contact_fixed")`, on {
        ", ".join(map(str, STRIPS))
    } strips
across ({STRIPS[0]} is what `Contact` takes by itself) by {ROWS} rows. Its pressures are meaned over the nodes of the
bodies' grid, as all others are.

{table(patch_head, travelling)}
{read_patch(rows)}"""


READ_MATERIAL = """\
What to read from it. Nodes err where a patch ends between two of them: a node has its whole share of the surface or
nothing. Nodes that are not negative cannot end inside a cell: the outermost one reaches beyond the patch,
    or is missing,
and its neighbours make up for it. Under a layer as compliant as the penalties of practice both err by about the same,
in different ways, so that their difference is larger than either error; a quadrature without error would differ from
"at nodes" by as much as that errs. Under a layer that is hardly there nodes are the better ones, and most of the
difference is an error of "full": it excludes tension at every point of the surface, not only in the sum at a node.
Pressures in cells have less of it. The law at points, in nodes that are cut off at the edge of the patch, would have
none, at a price: products of nodes over a part of a cell are no constants of a body, so that no compliance of the
pressures could be tabulated when it is reduced, and any change of the edge would need rows of the local solve again.
"""


def read_patch(rows: list[tuple[int, float, float, Ends]]) -> str:
    """What the table of travelling cells says, with its figures: of the coarser mesh, and of the finer one."""
    coarser = [e for sectors, _, _, e in rows if sectors == MESHES[0][0]]
    finer = [e for sectors, _, _, e in rows if sectors != MESHES[0][0]]

    def between(way: str) -> str:
        found = [e.reference[way] for e in coarser]
        return f"{min(found):.1%} to {max(found):.1%}"

    fine, most = PATCHES[-1], STRIPS[-1]
    counts = ", ".join(f"{between(way)} with {n} strips" for way, n in zip(PATCHES, STRIPS, strict=True))
    beyond = max(e.nodes[fine] - e.reference["nodes"] for e in coarser)
    refused = sum(bool(np.isnan(e.reference[way])) for e in finer for way in PATCHES)
    silent = [e.reference[way] for e in finer for way in PATCHES if not np.isnan(e.reference[way])]
    wrong = f" In the others it errs by up to {max(silent):.1%}." if silent else ""
    return f"""\
What to read from it. On {MESHES[0][0]} sectors "full" errs by {between("hats")} against the reference, "at nodes" by
{between("nodes")}, contact-fixed cells by {counts}.
Their edge lies inside a cell too, but the cell is as narrow as is asked for, on the same body and mesh: the error falls
with the strips, where that of nodes and nodes falls with the mesh only. From "at nodes" they differ by what that errs,
with {most} strips by {beyond:.1%} more at most: the distance of "full" from "at nodes" is one of nodes and nodes, which
end where the mesh lets them. The {STRIPS[0]} strips of the default are no finer than the grid here: a strip is a
quarter of the half-width, and a pressure that is constant in it makes steps which nodes narrower than it see. They are
chosen for force and largest pressure, right to {CELL_ERROR:.1%}; whoever wants the pressure at the edge takes more, by
`Contact(cells=)` or `Contact(cell_error=)`.

On {MESHES[1][0]} sectors the program *refuses* {refused} of {len(finer) * len(PATCHES)} cases.{wrong} These bodies are
narrow arcs of a mesh finer than the cells, its own cells sixty times as long as wide; from {LONGEST:g} times on
`Contact` takes no contact-fixed cells. Without that bound they err by up to a fifth, or their compliance is not
positive definite. It is not their far field, which is that of {MESHES[0][0]} sectors to 1e-4 of the whole, nor that the
arcs are narrow: why is not found out here. The cure is a mesh with squarer cells at the surface.
"""
