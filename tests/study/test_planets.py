"""Rollers around a roller: by symmetry every pair carries the same, and the middle one is pushed nowhere."""

from __future__ import annotations

import numpy as np
import pytest

from scenes.planets import planets
from scenes.rollers import STEEL
from warpffrf.model import mesh
from warpffrf.model.errors import InputError
from warpffrf.model.surfaces import Cylinder
from warpffrf.offline import ContactGrid, reduce
from warpffrf.online import run

LOAD = 100e3  # N
STEP = 1e-4  # s
SYMMETRY = 1e-6  # of the load: the iteration stops at 1e-8 of the forces, and leans on the bodies one after the other


@pytest.fixture(scope="module")
def body():
    return reduce(
        mesh.roller(0.05, 0.015, 0.01, sectors=120, layers=4, axial=2, grading=1.6, order=1), STEEL,
        interfaces={"bore": "rigid"}, contact={"rim": Cylinder()}, modes=6,
        grid=ContactGrid(tangential=True, contact_fixed=False), cache=False, progress=False,
    )  # fmt: skip


@pytest.mark.parametrize("friction", [0.0, 0.3])
def test_all_pairs_carry_the_same(body, friction: float) -> None:
    """Three rollers at 120 degrees, 40 columns apart on a grid of 120: each sees the same grid at the same place."""
    history = run(
        planets(body, 3, LOAD, friction=friction, creepage=2e-3), 20 * STEP, step=STEP, start="equilibrium",
        progress=False,
    )  # fmt: skip
    assert history.status == "completed", history.message
    force = np.array([c.force for c in history.contacts.values()])  # (pairs, T, 3)
    size = np.linalg.norm(force, axis=2)
    assert np.abs(size / LOAD - 1.0).max() < 0.05  # they are pressed; a slide has inertia
    assert np.abs(size - size[0]).max() < SYMMETRY * LOAD
    assert np.abs(force.sum(axis=0)).max() < SYMMETRY * LOAD
    assert np.all(np.array([c.active_nodes[-1] for c in history.contacts.values()]) >= 3)


def test_wrong_numbers(body) -> None:
    with pytest.raises(InputError, match="planets: count"):
        planets(body, 0, LOAD)
    with pytest.raises(InputError, match="planets: load"):
        planets(body, 2, -1.0)
