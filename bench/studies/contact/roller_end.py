r"""Pressure at the ends of a roller compared with finite elements (`free_end`).

The rollers are those of `free_end`, but whole: hex27 cells around, cells along the axis that grow from both ends
inwards, a node at every node of the rim, no modes but those of the hub. The hub is guided down and carries the load;
the state is the static one. On a rigid plane gaps are taken at points. A longer partner is a reduced roller below,
whose cells have lines where the short one ends; the pair is one on the line of centres. Of `free_end` nothing is used
but sizes and the measures of `EndPressure`; mesh, elimination of modes, weak gaps, compliance and active set are the
package's.

**A longer partner.** At the end of the short roller a corner of angle pi/2 presses into a surface that goes on. With
tractions p r^(lambda - 1) on one face and none on the other, the slope of a wedge of angle phi under its face is
p r^(lambda - 1) times 2/E* times

    f(phi) = (sin(2 lambda phi) + lambda sin(2 phi)) / (2 (sin(lambda phi)^2 - lambda^2 sin(phi)^2)),

f(pi) = cot(pi lambda), and without friction the two surfaces stay together where f(pi/2) + f(pi) = 0 (J. Dundurs and
M. S. Lee, J. Elasticity 2, 1972, 109): lambda = 0.774 for like materials. The pressure at the corner is infinite, as
r^(-0.226), the value in the last hat grows with every refinement, and figures to compare are those inside and means
over a length from the end.
"""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from references.closed_forms import LineContact, contact_modulus
from references.finite_elements.free_end import (
    GROWTH_FROM_PATCH,
    LINE_LOAD,
    MARGIN,
    STEEL_ROLLER,
    EndPressure,
    Roller,
    press_pair,
    press_roller,
)
from references.finite_elements.pin_in_bore import graded
from warpffrf.model import forces, joints, surfaces
from warpffrf.model.contact import Contact
from warpffrf.model.errors import InputError
from warpffrf.model.mesh import roller as roller_mesh
from warpffrf.model.reduced.body import ReducedBody
from warpffrf.model.scene import Scene
from warpffrf.offline import ContactGrid, reduce
from warpffrf.output.simulate import equilibrium
from warpffrf.study.markdown import table

Array = np.ndarray
PAIR, GUIDE = "pair", "guide"
RIM_LAYER = 0.8  # depth of the outer layer over the width of its cells
OVERHANG = 0.01  # m, of a longer partner at each end: 13 half-widths
FINITE_ELEMENTS = ((4.0, 0.25), (6.0, 0.25), (6.0, 0.125), (6.0, 0.0625), (8.0, 0.0625))  # cells in a, end cell over a
LEVELS = ((4, 0.25), (6, 0.25), (6, 0.125))  # nodes in a, end cell over a
REFERENCE = FINITE_ELEMENTS[-1]  # cells in a, end cell over a
PAIR_REFERENCES = ((4.0, 0.25), (5.0, 0.125))
PLACES, LENGTHS = (0.0, 0.5, 2.0), (0.25, 1.0)  # half-widths from the end: of pressures, of mean line loads


def axial_lines(roller: Roller, end_cell: float, overhang: float = 0.0) -> Array:
    """Boundaries (n,) [m] of cells from `end_cell` [m] at both ends of the roller inwards, and outwards over `overhang`
    [m]."""
    half = 0.5 * roller.width
    inside = half - graded(end_cell, half, growth=GROWTH_FROM_PATCH)[::-1]
    outside = half + graded(end_cell, overhang, growth=GROWTH_FROM_PATCH)[1:] if overhang else np.empty(0)
    right = np.concatenate([inside[1:], outside])
    return np.concatenate([-right[::-1], [0.0], right])


def reduced(roller: Roller, half_width: float, grid_nodes: int, lines: Array) -> ReducedBody:
    """The roller with `grid_nodes` in a half-width [m] around and cells between `lines` [m], its bore rigid."""
    R = roller.outer_radius
    sectors = 4 * round(2.0 * np.pi * R / half_width * grid_nodes / 8.0)  # two nodes each, one at the bottom
    depth = graded(RIM_LAYER * 2.0 * np.pi * R / sectors, R - roller.inner_radius, growth=GROWTH_FROM_PATCH)
    mesh = roller_mesh(
        R, roller.inner_radius, float(np.ptp(lines)), sectors=sectors, layers=len(depth) - 1, axial=lines,
        grading=GROWTH_FROM_PATCH,
    )  # fmt: skip
    return reduce(
        mesh, roller.material, interfaces={"bore": "rigid"}, contact={"rim": surfaces.Cylinder()}, modes=0,
        grid=ContactGrid(contact_fixed=False), progress=False,
    )  # fmt: skip


def pressed(
    roller: Roller, load: float, half_width: float, grid_nodes: int, end_cell: float, overhang: float | None = None
) -> EndPressure:
    """The roller under the load [N] on a rigid plane, or, with `overhang` [m] at both ends, on a longer one of its kind
    (0: on its equal), as an `EndPressure` of one end, `dofs` the active nodes.

    half_width a [m] expected, `grid_nodes` in it, first cell at the end `end_cell` a wide: for the mesh only. Pressures
    are means over the nodes around. `InputError` where no static state is found.
    """
    body = reduced(roller, half_width, grid_nodes, axial_lines(roller, end_cell * half_width))
    grid = body.contact_surfaces["rim"].grid
    scene = Scene()
    upper = scene.add_body(body, name="roller")
    if overhang is None:
        plane = surfaces.Plane(
            origin=(0.0, 0.0, -roller.outer_radius), outward=(0.0, 0.0, 1.0), direction=(0.0, 1.0, 0.0)
        )
        partner = scene.ground.surface(plane, name="plane")
    else:
        below = reduced(roller, half_width, grid_nodes, axial_lines(roller, end_cell * half_width, overhang))
        lower = scene.add_body(below, name="partner", position=(0.0, 0.0, -2.0 * roller.outer_radius))
        scene.add(joints.Fixed(scene.ground, lower["bore"], name="hold"))
        partner = lower["rim"]
    columns = 2 * int(np.ceil(MARGIN * half_width / (grid.pitch * roller.outer_radius))) + 1
    scene.add(Contact(upper["rim"], partner, capacity=columns * grid.rows, name=PAIR))
    scene.add(joints.Prismatic(scene.ground, upper["bore"], axis=(0.0, 0.0, 1.0), name=GUIDE))
    scene.add(forces.PointForce(upper["bore"], (0.0, 0.0, -load), name="press"))
    result = equilibrium(scene)
    if result.status != "completed":
        raise InputError(f"roller end: no static state was found ({result.message})")
    c = result.contact(PAIR)
    p = c.mean_pressure[-1]
    middle = int(np.argmin(np.abs(c.arc[-1])))
    reach = min(middle, len(p) - 1 - middle)
    p = 0.5 * (p[middle : middle + reach + 1] + p[middle - reach : middle + 1][::-1])
    p = 0.5 * (p + p[:, ::-1])[:, grid.rows // 2 :]
    return EndPressure(
        roller.outer_radius, grid.pitch * np.arange(reach + 1), np.asarray(c.z)[grid.rows // 2 :], p,
        -float(result.joint(GUIDE).named("translation")[-1]), int(c.active_nodes[-1]),
    )  # fmt: skip


def figures(f: EndPressure, half_width: float) -> Array:
    """Pressures at PLACES and mean line loads over LENGTHS, over those in the middle."""
    return np.array(
        [f.along(place * half_width) / f.middle for place in PLACES]
        + [f.mean_line_load(length * half_width) / f.middle_line_load for length in LENGTHS]
    )


def _row(name: list[str], f: EndPressure, half_width: float, reference: Array | None) -> list[str]:
    found = figures(f, half_width)
    cells = [f"{x:.4f}" for x in found]
    if reference is not None:
        cells = [f"{x:.4f} ({x / r - 1.0:+.1%})" for x, r in zip(found, reference, strict=True)]
    return [*name, *cells, f"{f.approach * 1e6:.3f}"]


def finite_element_rows(solved: dict[tuple[float, float], EndPressure]) -> list[list[str]]:
    """The roller on a plane by finite elements, by level."""
    line = LineContact(LINE_LOAD, STEEL_ROLLER.outer_radius, contact_modulus(STEEL_ROLLER.material))
    rows = []
    for (cells, end), f in solved.items():
        # the load is that of the width, of which the middle has more than the mean
        middle = LineContact(f.middle_line_load, STEEL_ROLLER.outer_radius, line.modulus)
        row = [f"{cells:g}", f"{end:g} a", str(f.dofs), f"{f.middle / middle.peak_pressure - 1.0:+.2%}"]
        near = [f.along(inside * line.half_width) / f.middle for inside in PLACES]
        rows.append([*row, *(f"{p:.4f}" for p in near), f"{f.end_line_load:.4f}", f"{f.approach * 1e6:.3f}"])
    return rows


def compute() -> dict[str, list[list[str]]]:
    """Rows of finite elements, of reduced bodies, and of a longer partner."""
    roller = STEEL_ROLLER
    load = LINE_LOAD * roller.width
    a = LineContact(LINE_LOAD, roller.outer_radius, contact_modulus(roller.material)).half_width
    solved = {level: press_roller(roller, load, a, *level) for level in FINITE_ELEMENTS}
    fine = solved[REFERENCE]
    rows = [_row(["finite elements", f"{REFERENCE[0]:g}", f"{REFERENCE[1]:g} a"], fine, a, None)]
    for grid_nodes, end in LEVELS:
        name = ["reduced, plane", str(grid_nodes), f"{end:g} a"]
        rows.append(_row(name, pressed(roller, load, a, grid_nodes, end), a, figures(fine, a)))
    grid_nodes, end = LEVELS[0]
    rows.append(_row(["reduced, its equal", str(grid_nodes), f"{end:g} a"], pressed(roller, load, a, grid_nodes, end,
        0.0), a,
                     figures(fine, a)))  # fmt: skip
    longer = replace(roller, width=roller.width + 2.0 * OVERHANG)
    found = [press_pair(roller, longer, load, a, *level) for level in PAIR_REFERENCES]
    beyond = [
        _row(["finite elements", f"{cells:g}", f"{end:g} a"], f, a, None)
        for (cells, end), f in zip(PAIR_REFERENCES, found, strict=True)
    ]
    for grid_nodes, end in LEVELS[:2]:
        f = pressed(roller, load, a, grid_nodes, end, OVERHANG)
        beyond.append(_row(["reduced", str(grid_nodes), f"{end:g} a"], f, a, figures(found[-1], a)))
    return {"finite elements": finite_element_rows(solved), "reduced": rows, "longer": beyond}


def page(found: dict[str, list[list[str]]]) -> str:
    """The whole page."""
    roller = STEEL_ROLLER
    a = LineContact(LINE_LOAD, roller.outer_radius, contact_modulus(roller.material)).half_width
    places = ["end" if not place else f"{place:g} a" for place in PLACES]
    shown = ["cells", "end cell", "dofs", "middle over Hertz", *places, "line loads", "approach [µm]"]
    head = ["", "in a", "end cell", *places]
    head += [f"mean over {length:g} a" for length in LENGTHS] + ["approach [µm]"]
    return f"""# Pressure at the free end of a roller

A steel roller (R {roller.outer_radius * 1e3:g} mm, rigid hub {roller.inner_radius * 1e3:g} mm, width
{roller.width * 1e3:g} mm) under {LINE_LOAD * roller.width / 1e3:g} kN on a rigid plane, or on its equal: full finite
elements with quadratic cells and no modes. Cells in Hertz's half-width a = {a * 1e3:.4f} mm, and the first one at the
end along the axis. *Middle over Hertz*: peak pressure at mid-width compared with Hertz's at the line load found there.
Pressure on the line of contact over that in the middle: at the end, {PLACES[1]:g} a and {PLACES[2]:g} a from it. *Line
loads*: end over middle. Approach of the hub.

{table(shown, found["finite elements"])}
## Reduced bodies in the step

The whole roller of quadratic cells, reduced, under the same load at rest. *In a*: nodes (of finite elements cells) in
the half-width; *end cell*: the first of the mesh along the axis, with two rows of nodes in it. Pressure on the line of
contact at the end, {PLACES[1]:g} a and {PLACES[2]:g} a from it, and mean line load over the last {LENGTHS[0]:g} a and
{LENGTHS[1]:g} a, all over those in the middle; in brackets the difference from finite elements. *Its equal*: on a
second reduced roller instead of the plane; the approach is that of both hubs.

{table(head, found["reduced"])}
## A longer partner

The roller on one of the same radius that is {OVERHANG * 1e3:g} mm longer at each end. At the end the pressure is
infinite, as r^-0.226 of a corner on a half-space, so that the figure there belongs to the mesh; the differences are
from the finer finite elements.

{table(head, found["longer"])}"""
