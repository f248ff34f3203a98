r"""Two segments of flexible teeth in a plane state, and the same by full finite elements.

Steel without lateral contraction, evenly loaded across the width: a thin slice of the gears behaves as wide ones do.
Tooth 1 of gear 1 meets tooth 2 of gear 2 at g on the path of contact, tooth 2 tooth 1 a pitch earlier; other teeth do
not touch. As both gears are equal, g and p - g have the same transmission error.
"""

from __future__ import annotations

from functools import cache

import numpy as np

import warpffrf as wf
from references.finite_elements.plane_gears import Flanks, Meshed, meshed
from scenes.gears import angle_at, on_hubs
from warpffrf.output.gears.gear_result import GearResult

MATERIAL = wf.Material(206e9, 0.0, 7850.0, name="steel without lateral contraction")
MODULE, TEETH, WIDTH, LINE_LOAD = 3e-3, 62, 1e-3, 150e3  # m, -, m, N/m
RIM, CARRYING = 80e-3, (1, 2)  # m: radius of the bore
PLAIN, RELIEVED = (0.0, 0.0), (15e-6, 4e-3)  # m: tip relief and its length
LOAD = LINE_LOAD * WIDTH  # N
Cells = tuple[float, float, int]  # of the finite elements along the involute, at its ends [m], layers
COARSE: Cells = (0.1e-3, 0.1e-3, 6)
FINE: Cells = (0.1e-3, 0.03e-3, 6)


@cache
def pair(relief: tuple[float, float] = PLAIN) -> wf.gears.GearPair:
    """62 to 62 teeth, with tip roundings of 0.1 modules."""
    depth, length = relief
    gear = wf.gears.Gear(
        MODULE, TEETH, thickness_allowance=-30e-6, tip_rounding=0.3e-3, tip_relief=depth, tip_relief_length=length
    )
    return wf.gears.GearPair(gear, gear, MODULE * TEETH)


@cache
def segment(relief: tuple[float, float], along: int) -> wf.ReducedBody:
    """Two teeth, `along` cells along their flanks."""
    gear = pair(relief).gear_1
    mesh = wf.mesh.gear(gear, WIDTH, rim_radius=RIM, teeth=2, along=along, across=2, layers=4, axial=1, rim_layers=4)
    return wf.reduce(
        mesh, MATERIAL, interfaces={"bore": "rigid"}, contact=gear.surfaces(("right",), CARRYING),
        grid=wf.ContactGrid(contact_fixed=True), stress={"roots": "roots"}, progress=False,
    )  # fmt: skip


@cache
def flanks(relief: tuple[float, float], cells: Cells) -> Flanks:
    """Finite elements of the same two teeth."""
    cell, fine, layers = cells
    return Flanks(pair(relief).gear_1, MATERIAL, RIM, 2, CARRYING, cell=cell, fine=fine, layers=layers)


def loaded(g: float, *, along: int, relief: tuple[float, float] = PLAIN, alone: bool = False) -> GearResult:
    """The pair at rest under the load; alone: without the second pair of teeth."""
    return on_hubs(pair(relief), segment(relief, along), 1, g, LOAD, alone=alone).gear("mesh")


def known(g: float, *, relief: tuple[float, float] = PLAIN, alone: bool = False, cells: Cells = FINE) -> Meshed:
    """The same by full finite elements."""
    both, pitch = pair(relief), 2.0 * np.pi / TEETH
    one, facing = angle_at(both, g), np.pi - 0.75 * pitch + g / both.gear_2.base_radius
    other = both.mating_angle(one)
    other += pitch * round((facing - other) / pitch)
    half, teeth = flanks(relief, cells), [(1, 2), (2, 1)][: 1 if alone else 2]
    return meshed(both, (half, half), WIDTH, (one, other), teeth, LOAD)
