"""Hats that stand over the end of the second grid, of rollers whose axes are skew: both ends are alike."""

from __future__ import annotations

from dataclasses import replace
from typing import Any

import numpy as np
import pytest

from scenes.rollers import roller_body
from warpffrf.model import rotation as rot
from warpffrf.model.contact import Contact
from warpffrf.model.reduced.body import ReducedBody
from warpffrf.model.reduced.contact_surface import Sampling
from warpffrf.model.scene import Scene
from warpffrf.offline.contact.cubature import all_points
from warpffrf.online import History, run

RADIUS, WIDTH, ROWS = 0.05, 0.02, 4  # m
SKEW = 1e-3  # rad: places opposite stand 50 um further out than the stations on the line of centres
SPEED, STEP, STEPS = 0.8, 2e-5, 20  # m/s, s
ROUND_OFF = 1e-12  # of the largest force


@pytest.fixture(scope="module")
def body() -> ReducedBody:
    """With all points of its grid as a list."""
    plain = roller_body(180, layers=3, axial=ROWS, grading=1.8, order=1, width=WIDTH, modes=0, cache=False)
    rim = plain.contact_surfaces["rim"]
    places, weight = all_points(rim)
    sampling = Sampling(places.x, places.row, places.zeta, weight, 0.0, 0.0, 0.0, 0)
    return replace(plain, contact_surfaces={"rim": replace(rim, sampling=sampling)})


def collision(body: ReducedBody, side: float, past: float, quadrature: Any) -> History:
    """A roller hits another one, shifted along its axis until the first Gauss points of its last cells stand `past` [m]
    over the end on `side`, and skew so that what is opposite stands further out."""
    cell = WIDTH / ROWS
    shift = side * (cell - cell * (0.5 - 0.5 / 3.0**0.5) + past)
    skew = rot.quaternion(rot.rotation_vector_matrix(np.array([-side * SKEW, 0.0, 0.0])))
    scene = Scene()
    first = scene.add_body(
        body, name="first", position=(0.0, shift, 2.0 * RADIUS), velocity=(0.0, 0.0, -SPEED), rotation=skew
    )
    second = scene.add_body(body, name="second")
    scene.add(Contact(first["rim"], second["rim"], quadrature=quadrature, overlap=1.0, name="pair"))
    return run(scene, STEPS * STEP, step=STEP, progress=False)


@pytest.mark.parametrize("quadrature", ["full", "reduced"])
@pytest.mark.parametrize("past", [-2e-5, 2e-5, 6e-5, 1.2e-4])
def test_both_ends_are_alike(body: ReducedBody, past: float, quadrature: Any) -> None:
    low, high = (collision(body, side, past, quadrature) for side in (-1.0, 1.0))
    assert low.status == high.status == "completed", (low.message, high.message)
    forces = [history.contacts["pair"].force for history in (low, high)]
    size = np.abs(forces[0]).max()
    assert size > 100.0
    assert np.abs(forces[0] * (1.0, -1.0, 1.0) - forces[1]).max() < ROUND_OFF * size
