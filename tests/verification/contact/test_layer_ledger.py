"""Energy with every contact law (VERIFICATION C10): falls at steps from 1e-6 to 1e-3 s never gain, and loading, rolling
and unloading gives back what it took."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest

from scenes.rollers import roller_body
from warpffrf.model import joints, laws, signals
from warpffrf.model.contact import Contact
from warpffrf.model.reduced.body import ReducedBody
from warpffrf.model.scene import Scene
from warpffrf.online.history.history import History
from warpffrf.online.run import run

RADIUS = 0.05
GAINED = 0.01  # of the energy, in one fall
SPEED = 0.14  # m/s, of a fall of 1 mm
CLOSES = 0.01  # of the largest contact energy, the ripple of the grid included
LAWS: list[Any] = [
    laws.Unilateral(),
    laws.LinearLayer(1e13),
    laws.NonlinearLayer(1e15, 1.5),
    laws.NonlinearLayer(1e25, 3.0),
    laws.TabulatedLayer((-1e-4, -1e-6, 0.0), (1e8, 1e5, 0.0)),
    laws.ExponentialAsperities(1e7, 1e-6),
    laws.ExponentialAsperities(1e9, 3e-7),
    laws.HuntCrossley(1e15, 1.5, restitution=0.6, impact_speed=SPEED),
]


@pytest.fixture(scope="module")
def body() -> ReducedBody:
    return roller_body(900, layers=3, axial=2, grading=1.6, order=1, max_frequency=12e3, cache=False)


def total(history: History) -> np.ndarray:
    """Energy of the state [J] at the saved times."""
    return sum((history.energy[line] for line in ("kinetic", "strain", "contact", "potential")), np.zeros(1))


def fall(body: ReducedBody, law: Any, step: float, phase: float) -> History:
    """The upper roller falls on the lower one; `phase` of the step at which it touches (not 1/2^n apart: halved steps
    would be the same)."""
    gap = 20e-6 + phase * SPEED * step
    scene = Scene(gravity=(0.0, 0.0, 0.0))
    lower = scene.add_body(body, name="lower")
    upper = scene.add_body(body, name="upper", position=(0.0, 0.0, 2.0 * RADIUS + gap), velocity=(0.0, 0.0, -SPEED))
    scene.add(joints.Fixed(scene.ground, lower["bore"]))
    scene.add(joints.Prismatic(scene.ground, upper["bore"], axis=(0.0, 0.0, 1.0)))
    scene.add(Contact(lower["rim"], upper["rim"], law=law, capacity=400, name="pair"))
    steps = int(np.ceil(max(1.2e-3, 8.0 * step) / step))
    history = run(scene, steps * step, step=step, progress=False)
    assert history.status == "completed", history.message
    assert history.bodies["upper"].velocity[-1, 2] > 0.0
    return history


def gains_nothing(body: ReducedBody, law: Any, step: float, phase: float) -> None:
    history = fall(body, law, step, phase)
    energy = total(history)
    assert energy.max() < (1.0 + GAINED) * energy[0]
    assert history.contacts["pair"].pressure.min() >= 0.0
    assert np.diff(history.energy["damping"]).min() >= 0.0
    print(f"{law.kind}, h = {step:g}: {energy.max() / energy[0] - 1.0:.1e} gained, {energy[-1] / energy[0]:.4f} left")


@pytest.mark.parametrize("phase", [0.1, 0.77])
@pytest.mark.parametrize("step", [1e-4, 1e-3])
@pytest.mark.parametrize("index", range(len(LAWS)), ids=lambda i: LAWS[i].kind)
def test_a_fall_gains_nothing(body: ReducedBody, index: int, step: float, phase: float) -> None:
    gains_nothing(body, LAWS[index], step, phase)


def test_a_fall_whose_impact_no_mean_balances(body: ReducedBody) -> None:
    """No mean of the force gives back the energy of this one: the step is halved."""
    gains_nothing(body, laws.ExponentialAsperities(1e7, 1e-6), 3e-4, 0.31)


@pytest.mark.slow
@pytest.mark.parametrize("phase", [0.03, 0.31, 0.87])
@pytest.mark.parametrize("step", [1e-6, 3e-6, 1e-5, 3e-5, 3e-4])
@pytest.mark.parametrize("index", range(len(LAWS)), ids=lambda i: LAWS[i].kind)
def test_a_fall_gains_nothing_at_more_steps(body: ReducedBody, index: int, step: float, phase: float) -> None:
    gains_nothing(body, LAWS[index], step, phase)


@pytest.mark.parametrize("index", [2, 4, 5], ids=lambda i: LAWS[i].kind)
def test_load_roll_unload(body: ReducedBody, index: int) -> None:
    """Pressed together by 20 um along a prescribed path, rolled on by 0.4 rad, and parted: the work of the drives."""
    scene = Scene(gravity=(0.0, 0.0, 0.0))
    lower = scene.add_body(body, name="lower")
    upper = scene.add_body(body, name="upper", position=(0.0, 0.0, 2.0 * RADIUS))
    carriage = scene.add_rigid_body(1.0, (0.01, 0.01, 0.01), name="carriage", position=(0.0, 0.0, 2.0 * RADIUS))
    center = carriage.at((0.0, 0.0, 0.0))
    guide = scene.add(joints.Prismatic(scene.ground, center, axis=(0.0, 0.0, 1.0)))
    axles = [
        scene.add(joints.Revolute(scene.ground, lower["bore"], axis=(0.0, 1.0, 0.0))),
        scene.add(joints.Revolute(center, upper["bore"], axis=(0.0, 1.0, 0.0))),
    ]
    times = np.array([0.0, 0.01, 0.015, 0.02, 0.025, 0.03, 0.04])
    depth = -20e-6 * np.array([0.0, 1.0, 1.0, 1.0, 1.0, 1.0, 0.0])
    scene.add(joints.Drive(guide, signals.Table(times, depth, cubic=True), quantity="position"))
    for axle, sense in zip(axles, (1.0, -1.0), strict=True):
        turn = signals.SmoothStep(0.0, 0.4 * sense, duration=0.02, delay=0.01)
        scene.add(joints.Drive(axle, turn, quantity="position"))
    scene.add(Contact(lower["rim"], upper["rim"], law=LAWS[index], capacity=400, name="pair"))
    history = run(scene, 0.04, step=5e-5, progress=False)
    assert history.status == "completed", history.message
    stored = history.energy["contact"].max()
    left = total(history)[-1]
    work = history.energy["drive_work"][-1]
    assert stored > 1e-4
    assert abs(work) < CLOSES * stored + left + history.energy["damping"][-1]
    assert np.abs(history.energy["contact_grid"] + history.energy["numerical"]).max() < CLOSES * stored
