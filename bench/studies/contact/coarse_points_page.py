"""Hertz's contacts of solid bodies on meshes coarser than the contact, on contact-fixed cells: some minutes."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from references.closed_forms import contact_modulus
from studies.contact.coarse_points import (
    ALUMINIUM,
    APPROACH,
    BALL_RADIUS,
    BLOCK,
    BLOCKS,
    COARSE_BALLS,
    FINE,
    FINE_POINT,
    LINE_LOAD,
    LOAD,
    LONG,
    PLACES,
    PLAIN,
    RATIOS,
    ROLLER_RADIUS,
    RUBBER,
    SPEED,
    STEEL,
    STEPS,
    THIN,
    BallMesh,
    ball,
    ball_errors,
    ball_mises,
    ball_on_block,
    block,
    impact_errors,
    roller,
    roller_errors,
    roller_mises,
    struck,
    trouble,
    unlike_balls,
    unlike_rollers,
)
from warpffrf.study.markdown import table


def rollers_table() -> str:
    """C1 and C2."""
    plain = replace(STEEL, poisson_ratio=0.0)
    cases = [(plain, n, order) for n in (1, 2, 3, 4, 6, 8) for order in (1, 2) if n * order < 14]
    cases += [(STEEL, n, 1) for n in (3, 4, 6)] + [(STEEL, n, 2) for n in (3, 4)]
    rows = []
    for material, n, order in cases:
        body = roller(material, n, order)
        errors = [c for cells in (None, FINE) for c in roller_errors(body, material, cells).cells()]
        rows.append([f"{material.poisson_ratio:g}", str(n), "hex27" if order == 2 else "hex8", *errors])
    return table(["nu", "on the radius", "cells", *2 * ["approach", "half-width", "peak"]], rows)


def balls_table() -> str:
    """C3."""
    rows = []
    for mesh in COARSE_BALLS:
        body = ball(STEEL, mesh)
        errors = [c for cells in (None, FINE_POINT) for c in ball_errors(body, LOAD, STEEL, cells).cells()]
        asymmetry = body.contact_surfaces["patch"].far.asymmetry  # pyright: ignore[reportOptionalMemberAccess]
        rows.append([f"{mesh.elements:.3g}", mesh.kind, str(body.report["dofs"]), f"{asymmetry:.1%}", *errors])
    return table(["on the radius", "cells", "dofs", "asymmetry", *2 * ["approach", "half-width", "peak"]], rows)


def impact_table() -> str:
    """C7."""
    both = replace(STEEL, youngs_modulus=0.5 * STEEL.youngs_modulus)
    rows = []
    for mesh in (PLAIN, BallMesh(5.2, 4, "hex8"), BallMesh(5.0, 2, "tet10")):
        for cells in (None, FINE_POINT):
            result, exact = struck([ball(both, mesh)], contact_modulus(STEEL, STEEL), SPEED, cells)
            errors = [f"{v:+.2%}" for v in impact_errors(result, exact)]
            rows.append([mesh.kind, f"{mesh.elements:.3g}", "24 x 24" if cells else "11 x 11", *errors])
    return table(["cells", "on the radius", "grid", "force", "time", "approach", "speed after"], rows)


def block_table() -> str:
    """The ball on the block."""
    reference = ball_on_block(block(STEEL, "tet10", 1e-3), PLACES[0])
    rows = [["tet10", "1", f"{reference:.1f}", "", "", ""]]
    for kind, size in BLOCKS:
        body = block(STEEL, kind, size)
        forces = np.array([ball_on_block(body, place) for place in PLACES])
        fine = ball_on_block(body, PLACES[0], FINE_POINT)
        # over a small part of the block its own compliance changes evenly: what is left of a parabola is ripple
        xy = np.array(PLACES) * 1e3
        even = np.column_stack([np.ones(len(xy)), (xy**2).sum(axis=1)])
        left = forces - even @ np.linalg.lstsq(even, forces, rcond=None)[0]
        rows.append([
            kind, f"{size * 1e3:g}", f"{forces[0]:.1f}", f"{forces[0] / reference - 1.0:+.2%}",
            f"{fine / reference - 1.0:+.2%}", f"{np.ptp(left) / forces.mean():.3%}",
        ])  # fmt: skip
    return table(["cells", "size [mm]", "force [N]", "error", "24 x 24 cells", "ripple"], rows)


def ratios_table() -> str:
    """Poisson's ratios."""
    rows = []
    for ratio in RATIOS:
        material = replace(STEEL, poisson_ratio=ratio)
        line = roller_errors(roller(material, 4, 1), material).cells()
        rows.append([f"{ratio:g}", "roller, hex8, 4 on the radius", *line])
        for mesh in (PLAIN, BallMesh(5.2, 4, "hex8")):
            point = ball_errors(ball(material, mesh), LOAD, material).cells()
            rows.append([f"{ratio:g}", f"ball, {mesh.kind}, 5 on the radius", *point])
    return table(["nu", "body", "approach", "half-width", "peak"], rows)


def pairs_table() -> str:
    """Unlike bodies."""
    rows = []
    for other, half_width, speed in ((ALUMINIUM, 2e-4, SPEED), (RUBBER, 1e-3, 0.5 * SPEED)):
        names = f"{STEEL.name} on {other.name}"
        errors, width = unlike_rollers(STEEL, other, half_width)
        rows.append([names, "rollers", f"{width:.3f}", *errors.cells()])
        errors, width = unlike_balls(STEEL, other, speed)
        rows.append([names, "balls that meet", f"{width:.3f}", *errors.cells()])
    return table(["bodies", "", "half-width over radius", "approach", "half-width", "peak"], rows)


def stress_table() -> str:
    """Von Mises below lines and points."""
    plain = replace(STEEL, poisson_ratio=0.0)
    rows = []
    for material, n, order in ((plain, 3, 1), (plain, 4, 2), (STEEL, 3, 1), (STEEL, 4, 1), (STEEL, 6, 1)):
        kind = "hex27" if order == 2 else "hex8"
        rows.append(["roller", f"{material.poisson_ratio:g}", kind, str(n), *roller_mises(material, n, order)])
    for mesh in (PLAIN, BallMesh(5.2, 4, "hex8"), BallMesh(5.0, 2, "tet10"), BallMesh(8.0, 4, "tet4")):
        rows.append(["ball", "0.3", mesh.kind, f"{mesh.elements:.3g}", *ball_mises(STEEL, mesh)])
    return table(["body", "nu", "cells", "on the radius", "value", "depth"], rows)


def compute() -> dict[str, str]:
    """The figures of the page."""
    return {
        "rollers": rollers_table(),
        "balls": balls_table(),
        "impact": impact_table(),
        "block": block_table(),
        "ratios": ratios_table(),
        "pairs": pairs_table(),
        "stress": stress_table(),
        "trouble": table(["situation", "message"], [list(row) for row in trouble()]),
    }


def page(found: dict[str, str]) -> str:
    """The whole page."""
    return rf"""# Hertz's contacts of solid bodies on coarse meshes

Pressures on contact-fixed cells (`Contact(grid="contact_fixed")`). *On the radius*: elements along the
surface in a radius; the contacts are 0.003 to 0.05 radii wide. Errors are relative: approach against the closed form
for the load found, half-width (by second moments, C11) and peak against Hertz at that load. The first three columns
of errors are those of the cells that the program chooses, eight in the patch, the second three of 24.

**What the approach misses.** To first order in its curvatures k_i a curved surface deforms under a unit force as the
half-space and

    f = (1 + nu)(1 - 2 nu)/(4 pi E) sum_i k_i ((3 - 2 nu) x_i^2/r^2 - (1 - 2 nu) ln r),

which is not smooth at the force: along a line it is a cusp, (1 + nu)(1 - 2 nu) k |x|/(2 E). It is left to the far
field, whose splines see it as if it were spread over the spacing h of the contact grid. A line misses by
(1 - 2 nu)/(1 - nu) h/(2 R) of P'(1 - nu^2)/(pi E), where the approach is some twelve of these; a ball by
4 (1 - 2 nu)^2/(6 pi (1 - nu)) (a/R) ln(h/a) of its approach. Half-width and peak are not affected.

## A solid roller, loaded at both ends of a diameter (C1, C2)

R = {ROLLER_RADIUS * 1e3:g} mm, {LINE_LOAD / 1e3:g} N/mm, between rigid planes. With nu = 0 the roller is
{THIN * 1e3:g} mm wide ({ROLLER_RADIUS * 1e3:g} mm with one and two elements on the radius), and in plane strain; with
nu = 0.3 it is {LONG * 1e3:g} mm wide, has free ends, and is looked at in its middle.

{found["rollers"]}
## A solid ball on a rigid plane (C3)

R = {BALL_RADIUS * 1e3:g} mm, {LOAD:g} N. Approach against Hertz and how much less a ball deforms than a half-space
(`elastic_sphere`). *Asymmetry*: of the half-space on the ball's mesh.

{found["balls"]}
## A ball strikes a half-space (C7)

{SPEED:g} m/s, {STEPS} steps in the time of contact. Against Hertz's impact of half-spaces; a ball deforms less, which
makes the force 0.5 % larger.

{found["impact"]}
## A rigid ball on a block of tetrahedra

R = {BALL_RADIUS * 1e3:g} mm, {APPROACH * 1e6:g} um deep, on {BLOCK[0] * 1e3:g} x {BLOCK[0] * 1e3:g} x
{BLOCK[1] * 1e3:g} mm of steel. *Error*: in the middle, against tet10 of 1 mm. *Ripple*: of the force at nine places
over a quarter of an element of 4 mm, without the parabola that the block itself makes.

{found["block"]}
## Poisson's ratio

{found["ratios"]}
## Unlike bodies

Rollers between planes, the squeeze of both; balls in free flight, at the largest force. Rubber: E = 5 MPa, nu = 0.49.
Each roller has two patches, which feel each other through it.

{found["pairs"]}
## Von Mises stress below the patch

The largest at 0.3 to 1.3 half-widths below the middle, and its depth, against Hertz at the load found.

{found["stress"]}
## Situations that are refused or warned of

{found["trouble"]}"""
