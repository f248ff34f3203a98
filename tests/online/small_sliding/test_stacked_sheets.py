"""Sheets on top of each other: what loads one face of a body moves the other, whatever its global modes.

A static response is that of global and local modes together, so pressures must not depend on how the two share it.
"""

from __future__ import annotations

from functools import cache

import numpy as np
import pytest

from warpffrf.model import forces, joints, mesh
from warpffrf.model.contact import Contact
from warpffrf.model.material import Material
from warpffrf.model.scene import Scene
from warpffrf.model.surfaces import Plane, Sphere
from warpffrf.offline import reduce
from warpffrf.online import find_equilibrium

STEEL = Material(210e9, 0.3, 7850.0)
SIZE = (0.02, 0.016, 0.004)  # m, of a sheet
SHEETS = 4
RADIUS, LOAD = 0.2, 2e3  # of the punch [m], N
SAME = 1e-6  # of the largest pressure: the residual that ends a static solve


@cache
def sheet(modes: int):
    return reduce(
        mesh.box(SIZE, (8, 6, 2), order=1), STEEL, interfaces={"x_min": "average"},
        contact={"z_min": Plane(), "z_max": Plane()}, modes=modes, progress=False,
    )  # fmt: skip


def stack(modes: int) -> Scene:
    """Sheets on a rigid floor under a round punch, all guided along z."""
    scene = Scene(gravity=(0.0, 0.0, 0.0))
    below = scene.ground.surface(Plane(origin=(0, 0, 0), outward=(0, 0, 1)), name="floor")
    for i in range(SHEETS):
        body = scene.add_body(sheet(modes), name=f"sheet {i + 1}", position=(0.0, 0.0, SIZE[2] * (i + 0.5)))
        scene.add(joints.Prismatic(scene.ground, body["x_min"], axis=(0, 0, 1), name=f"guide {i + 1}"))
        scene.add(Contact(body["z_min"], below, name=f"pair {i + 1}"))
        below = body["z_max"]
    ball = Sphere(radius=RADIUS, axis_point=(0.0, 0.0, 0.0), axis_direction=(1.0, 0.0, 0.0))
    punch = scene.add_rigid_body(
        1.0, (1e-3,) * 3, name="punch", position=(0.0, 0.0, SHEETS * SIZE[2] + RADIUS), surfaces={"tip": ball}
    )
    center = punch.at((0.0, 0.0, 0.0))
    scene.add(joints.Prismatic(scene.ground, center, axis=(0, 0, 1), name="ram"))
    scene.add(forces.PointForce(center, (0.0, 0.0, -LOAD)))
    scene.add(Contact(below, punch["tip"], name="tip"))
    return scene


@cache
def pressures(modes: int) -> dict[str, np.ndarray]:
    rest = find_equilibrium(stack(modes))
    assert rest.status == "completed", rest.message
    return {name: np.asarray(contact.pressure[0]) for name, contact in rest.contacts.items()}


@pytest.mark.parametrize("modes", [0, 40])
def test_pressures_do_not_depend_on_how_many_modes_are_global(modes: int) -> None:
    few, other = pressures(4), pressures(modes)
    for name, expected in few.items():
        assert np.abs(other[name] - expected).max() < SAME * np.abs(expected).max(), name
