"""Runs that end before the watch of energy has waited long enough are judged as they end."""

from __future__ import annotations

import pytest

from warpffrf.model import forces, joints, signals
from warpffrf.model.scene import Scene
from warpffrf.online import run

STEP = 1e-3


def spun() -> Scene:
    """A light body whose spring, off its centre, turns it by many turns in a step."""
    scene = Scene(gravity=(0, 0, 0))
    body = scene.add_rigid_body(1.0, (1e-6,) * 3, name="body")
    ends = scene.ground.at((0.1, 0.3, 0)), body.at((0, 0.1, 0))
    scene.add(forces.SpringDamper(*ends, stiffness=1e6, damping=0.0, free_length=0.1, name="spring"))
    return scene


@pytest.mark.parametrize("steps", [1, 5, 30])
def test_a_short_run_that_has_made_its_energy_says_so(steps: int) -> None:
    """All energy beyond the 7.6 kJ of the spring is from nowhere."""
    history = run(spun(), steps * STEP, step=STEP, progress=False)
    assert history.status == "energy" and len(history.time) == steps + 1
    assert "the integrator creates energy" in history.message and "Settings" not in history.message
    assert history.energy["kinetic"][-1] > 100.0 * history.energy["potential"][0]


@pytest.mark.parametrize("steps", [1, 2, 3, 5, 8])
def test_a_drive_that_sets_out_makes_none(steps: int) -> None:
    """The first steps of a motion from rest are a third wrong in their energy, and less with the square of their
    number."""
    scene = Scene(gravity=(0, 0, 0))
    body = scene.add_rigid_body(1.0, (1e-2,) * 3, name="body")
    axis = scene.add(joints.Prismatic(scene.ground, body.at((0, 0, 0)), axis=(0, 0, 1), name="axis"))
    scene.add(joints.Drive(axis, signals.SmoothStep(0.0, 1.0, duration=1.0), quantity="position"))
    assert run(scene, steps * STEP, step=STEP, progress=False).status == "completed"
