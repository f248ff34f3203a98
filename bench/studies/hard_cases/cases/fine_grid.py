"""A contact grid with ten times as many columns as the mesh below it has, on a mesh far too coarse for the patch.

Ten nodes stand on one element: what they displace is no more than the element's own shapes, and the patch is that of a
faceted body. The run must be refused, or say that its pressures are those of the mesh, or be right (Hertz).
"""

from __future__ import annotations

from functools import lru_cache

import numpy as np

from scenes.rollers import PAIR, STEEL, guided_pair
from studies.hard_cases.case import Case, Finding
from warpffrf.model import surfaces
from warpffrf.model.mesh import roller
from warpffrf.model.reduced.body import ReducedBody
from warpffrf.model.scene import Scene
from warpffrf.offline import ContactGrid, reduce
from warpffrf.output.result import Result

SECTORS, FINER, LOAD = 60, 10, 20e3  # N


@lru_cache
def _body() -> ReducedBody:
    mesh = roller(0.05, 0.015, 0.02, sectors=SECTORS, layers=3, axial=2, grading=1.5, order=1)
    spacing = 2.0 * np.pi * 0.05 / SECTORS / FINER
    return reduce(
        mesh, STEEL, interfaces={"bore": "rigid"}, contact={"rim": surfaces.Cylinder()}, modes=4,
        grid=ContactGrid(contact_fixed=False, spacing=spacing), cache=False, progress=False,
    )  # fmt: skip


def build() -> Scene:
    """Two such rollers under a load."""
    return guided_pair(_body(), _body(), load=LOAD, speed=1.0, gravity=0.0)


def check(result: Result) -> list[Finding]:
    """Half-width and peak at mid-width against Hertz at the end, and the force."""
    contact = result.contact(PAIR)
    hertz = contact.hertz(-1)
    return [
        Finding("half-width", abs(float(contact.half_width[-1]) / hertz.half_width - 1.0), 3e-2, 1e-1),
        Finding("peak pressure", abs(float(contact.mid_peak_pressure[-1]) / hertz.peak_pressure - 1.0), 5e-2, 2e-1),
        Finding("force", abs(float(contact.force_magnitude[-1]) / LOAD - 1.0), 2e-2, 1e-1),
    ]


CASE = Case(
    "fine grid, coarse mesh",
    "A contact grid with ten columns an element on a mesh too coarse for the patch.",
    build, 0.02, check, options={"start": "equilibrium"}, most_steps=400, middle=1e-4, tolerances=(1e-6,),
    said=("the mesh", "peak pressures and half-widths may be off", "nodes of the mesh", "coarse"),
)  # fmt: skip
