"""Bodies so fast that they would pass through each other in a step, and others that only pass by."""

from __future__ import annotations

import numpy as np
import pytest
from lumped_scenes import HERTZ, ORIGIN, STEEL

from scenes.rollers import roller_body
from warpffrf.model import surfaces
from warpffrf.model.contact import Contact
from warpffrf.model.lumped_contact import LumpedContact
from warpffrf.model.reduced.body import ReducedBody
from warpffrf.model.scene import Scene
from warpffrf.online import run

RADIUS = 0.01
MASS = STEEL.density * 4.0 / 3.0 * np.pi * RADIUS**3


def two_balls(offset: float) -> Scene:
    """They fly at each other at 10 m/s, `offset` [m] side by side."""
    scene = Scene()
    skins = []
    for name, side in (("left", -1.0), ("right", 1.0)):
        skin = surfaces.Sphere(radius=RADIUS, axis_point=ORIGIN)
        ball = scene.add_rigid_body(
            MASS, (0.4 * MASS * RADIUS**2,) * 3, name=name, position=(1.2 * side * RADIUS, 0.5 * side * offset, 0.0),
            velocity=(-5.0 * side, 0.0, 0.0), surfaces={"skin": skin},
        )  # fmt: skip
        skins.append(ball["skin"])
    scene.add(LumpedContact(*skins, law=HERTZ, name="pair"))
    return scene


@pytest.mark.parametrize("step", [1e-3, 4e-3, 1e-2])
def test_fast_balls_do_not_leap_over_each_other(step: float) -> None:
    """In a step they move by half a diameter to five diameters; head-on they exchange their velocities all the same."""
    history = run(two_balls(0.0), 5 * step, step=step, progress=False)
    assert history.status == "completed"
    assert history.bodies["left"].velocity[-1, 0] == pytest.approx(-5.0, rel=2e-3 if step > 1e-3 else 3e-2)


def test_balls_that_pass_by_are_left_alone() -> None:
    """Steps are halved until the normal turns by less than a right angle, and nothing touches."""
    history = run(two_balls(2.5 * RADIUS), 0.05, step=1e-2, progress=False)
    assert history.status == "completed" and history.counters["rejected_steps"] < 10
    np.testing.assert_allclose(history.bodies["left"].velocity[-1], (5.0, 0.0, 0.0), atol=1e-12)


@pytest.fixture(scope="module")
def roller() -> ReducedBody:
    return roller_body(60, layers=3, axial=2, grading=1.5, order=1, modes=4)


def two_rollers(body: ReducedBody, speed: float, offset: float) -> Scene:
    scene = Scene()
    for name, side in (("left", -1.0), ("right", 1.0)):
        place = (0.0505 * side, 0.0, 0.5 * side * offset)
        scene.add_body(body, name=name, position=place, velocity=(-0.5 * side * speed, 0.0, 0.0))
    scene.add(Contact(scene.body("left")["rim"], scene.body("right")["rim"], name="pair"))
    return scene


@pytest.mark.parametrize("step", [6e-3, 1e-2])
def test_fast_rollers_do_not_leap_over_each_other(roller: ReducedBody, step: float) -> None:
    """At 50 m/s a roller of 100 mm moves by three and five diameters in a step. What is missing to 1 rings in them."""
    history = run(two_rollers(roller, 50.0, 0.0), 4 * step, step=step, progress=False)
    assert history.status == "completed" and history.counters["rejected_steps"] > 0
    assert history.bodies["left"].velocity[-1, 0] == pytest.approx(-25.0, rel=1e-2)
    assert any("leapt" in note for note in history.notes)


def test_rollers_that_pass_by_are_left_alone(roller: ReducedBody) -> None:
    history = run(two_rollers(roller, 50.0, 0.11), 0.04, step=1e-2, progress=False)
    assert history.status == "completed" and history.counters["rejected_steps"] < 10
    np.testing.assert_allclose(history.bodies["left"].velocity[-1], (25.0, 0.0, 0.0), atol=1e-9)
