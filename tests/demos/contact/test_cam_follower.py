"""A cam and its follower: lift, force by the law of the cam, and the speed at which the follower jumps."""

from __future__ import annotations

from functools import cache
from pathlib import Path

import numpy as np
import pytest
from checks import both_sizes, left_behind

import warpffrf as wf
from demos import cam_follower as demo

LIFTED = 1e-3  # of the lift: compression of the contact, 1 um of 8 mm
AT_REST, VIBRATES = 2e-3, 1e-2  # of the largest force: at a third of the jump speed, and at 0.98 of it
JUMPS = 0.02  # of the jump speed: below by this part nothing lifts off, above by it the follower does


@cache
def mass(size: demo.Size) -> float:
    """kg of the follower with its roller."""
    return demo.MASS + demo.roller(size).mass


@cache
def ran(part: float) -> tuple[float, wf.Result]:
    """Speed and a revolution at this part of the jump speed."""
    speed = part * demo.jump_speed(mass(demo.QUICK))
    return speed, demo.run(demo.roller(demo.QUICK), speed, demo.QUICK, progress=False)


def compare(speed: float, result: wf.Result, tolerance: float, size: demo.Size = demo.QUICK) -> None:
    assert result.status == "completed", result.message
    angle = speed * result.time
    height = result.body("follower").position[:, 2] - demo.BASE - demo.ROLLER
    expected = demo.force(angle, speed, mass(size))
    assert np.abs(height - demo.lift(angle)[0]).max() < LIFTED * demo.LIFT
    assert np.abs(np.linalg.norm(result.contact("valve").force, axis=1) - expected).max() < tolerance * expected.max()


def test_the_follower_moves_and_presses_by_the_law() -> None:
    compare(*ran(1.0 / 3.0), AT_REST)


@pytest.mark.slow
def test_the_follower_jumps_at_its_speed() -> None:
    """Just below the force is that of a rigid follower, and never zero; just above contact is lost where it decelerates
    most, and closes again with a blow."""
    compare(*ran(1.0 - JUMPS), VIBRATES)
    speed, result = ran(1.0 + JUMPS)
    force = np.linalg.norm(result.contact("valve").force, axis=1)
    first = speed * result.time[np.argmax(force == 0.0)]
    angle = np.linspace(0.0, np.pi, 2001)
    expected = demo.force(angle, speed, mass(demo.QUICK))
    open_ones = angle[expected < 0.0]
    assert open_ones.min() - np.radians(2.0) < first < open_ones.max()
    assert force.max() > 2.0 * expected.max()


@both_sizes
def test_the_whole_demo(tmp_path: Path, quick: bool) -> None:
    slow, fast, jumping = demo.main(tmp_path, quick=quick, progress=False)
    left_behind(tmp_path, "cam_follower")
    size = demo.QUICK if quick else demo.FULL
    limit = demo.jump_speed(mass(size))
    compare(demo.SPEEDS[0] * limit, slow, AT_REST, size)
    compare(demo.SPEEDS[1] * limit, fast, VIBRATES, size)
    assert np.any(np.linalg.norm(jumping.contact("valve").force, axis=1) == 0.0)
