"""Columns that a patch advances a step: none is missed between saved rows, and none is made up between two patches."""

from __future__ import annotations

import numpy as np
import pytest

import warpffrf as wf
from scenes.rollers import CARRIAGE_INERTIA, CARRIAGE_MASS, STEEL, roller_body
from warpffrf.model import surfaces
from warpffrf.model.mesh import box
from warpffrf.model.reduced.body import ReducedBody

STEP = 2e-4  # s
SPEED = 30.0  # rad/s
SECTORS = 120


@pytest.fixture(scope="module")
def body() -> ReducedBody:
    return roller_body(
        SECTORS, layers=3, axial=2, grading=1.6, width=0.01, modes=0, tangential=True, contact_fixed=False, cache=False
    )  # fmt: skip


@pytest.fixture(scope="module")
def slab() -> ReducedBody:
    mesh = box((0.02, 0.02, 0.008), (8, 8, 3), center=(0.0, 0.0, -0.004), order=1)
    top = surfaces.Plane(origin=(0.0, 0.0, 0.0), outward=(0.0, 0.0, 1.0), direction=(0.0, 1.0, 0.0))
    return wf.reduce(
        mesh, STEEL, interfaces={"z_min": "rigid"}, contact={"z_max": top}, modes=0,
        grid=wf.ContactGrid(tangential=True, contact_fixed=False), cache=False,
        progress=False,
    )  # fmt: skip


def rolling(body: ReducedBody) -> wf.Scene:
    """Two rollers, drawn from rest to speed and back within 2 ms."""
    scene = wf.Scene(gravity=(0.0, 0.0, 0.0))
    lower = scene.add_body(body, name="lower")
    upper = scene.add_body(body, name="upper", position=(0.0, 0.0, 0.1 - 1e-4))
    contact = wf.Contact(lower["rim"], upper["rim"], name="pair", friction=0.2, overlap=1.0)
    scene.add(contact)
    for roller, sense in ((lower, 1.0), (upper, -1.0)):
        axle = scene.add(wf.joints.Revolute(scene.ground, roller["bore"], axis=(0, 1, 0)))
        t = np.linspace(0.0, 2e-3, 21)
        speed = wf.signals.Table(t, sense * SPEED * np.sin(np.pi * t / t[-1]) ** 2, cubic=True)
        scene.add(wf.joints.Drive(axle, speed, quantity="velocity"))
    return scene


def advances(scene: wf.Scene, duration: float, **options) -> np.ndarray:
    result = wf.simulate(scene, duration, step=STEP, progress=False, **{"start": "equilibrium", **options})
    assert result.status == "completed", result.message
    friction = result.history.contacts["pair"].friction
    assert friction is not None
    return friction.cells_per_step


def test_the_fastest_step_between_two_saved_rows_is_recorded(body) -> None:
    every = advances(rolling(body), 10 * STEP)
    columns = SPEED * STEP / (2.0 * np.pi / SECTORS)
    assert 0.5 * columns < every.max() < 1.01 * columns  # an impact halves some of the steps
    assert every[-1] < 0.2 * every.max()  # the row that is saved of ten is not the fastest
    for count in (2, 5, 10):
        saved = advances(rolling(body), 10 * STEP, options=wf.RunOptions(save_every=count))
        np.testing.assert_array_equal(saved[1:], every[1:].reshape(-1, count).max(axis=1))


def test_rows_of_a_run_in_parts_hold_the_fastest_step_since_the_row_before(body) -> None:
    every = advances(rolling(body), 10 * STEP)
    first = wf.simulate(
        rolling(body), 7 * STEP, step=STEP, options=wf.RunOptions(save_every=10), progress=False, start="equilibrium"
    )
    rest = advances(rolling(body), 3 * STEP, options=wf.RunOptions(save_every=10), start=first)
    friction = first.history.contacts["pair"].friction
    assert friction is not None
    assert friction.cells_per_step[-1] == every[1:8].max() and rest[-1] == every[8:].max()


def test_the_nearest_place_passes_from_one_patch_to_another(slab) -> None:
    """A grooved wheel touches the slab on both of its edges and rocks from one to the other: nothing rolls."""
    scene = wf.Scene(gravity=(0.0, 0.0, 0.0))
    block = scene.add_body(slab, name="slab")
    scene.add(wf.joints.Fixed(scene.ground, block["z_min"], name="hold"))
    across = (1.0, 0.0, 0.0)
    groove = surfaces.Groove(groove_radius=2.0, radius=0.05, axis_point=(0.0, 0.0, 0.0), axis_direction=across)
    height = 0.05 + 0.01**2 / (2.0 * 2.0) - 2e-5  # the wheel is wider by x^2/2 groove_radius at the edges
    wheel = scene.add_rigid_body(
        CARRIAGE_MASS, CARRIAGE_INERTIA, name="wheel", position=(0.0, 0.0, height), surfaces={"face": groove}
    )  # fmt: skip
    rock = scene.add(wf.joints.Revolute(scene.ground, wheel.at((0.0, 0.0, 0.0)), axis=(0, 1, 0), name="rock"))
    t = np.linspace(0.0, 2e-3, 21)
    angle = wf.signals.Table(t, 3e-4 * np.sin(np.pi * t / t[-1]) ** 2 - 1.5e-4, cubic=True)
    scene.add(wf.joints.Drive(rock, angle, quantity="position"))
    scene.add(wf.Contact(block["z_max"], wheel["face"], friction=0.1, name="pair", overlap=1.0))
    result = wf.simulate(scene, 2e-3, step=STEP, progress=False, start="equilibrium")
    assert result.status == "completed", result.message
    found = result.history.contacts["pair"]
    assert np.ptp(found.center_column) > 4.0  # the nearest place changed sides
    assert found.friction is not None
    assert found.friction.cells_per_step.max() < 0.5
