"""The spindle at speed: preload, loads and contact angles of its bearings compared with the balance of their balls."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from checks import both_sizes, left_behind

import warpffrf as wf
from demos import spindle as demo
from demos.spindle import ANGLE, BALL, COUNT, GROOVE, GROWTH, MOUNTINGS, OFFSET, PITCH, RPM, SPRING
from references.closed_forms.angular_contact import AngularContact, State

PROMISED = 1e-2
NUMPY = AngularContact(COUNT, BALL, PITCH, ANGLE, GROOVE, GROOVE, gyroscopic=True)


def balanced(rpm: float, mounting: str) -> np.ndarray:
    """Preload, loads and contact angles, as `demo.found_in`."""
    bearing = replace(NUMPY, growth=GROWTH if mounting == "warm" else 0.0)
    held: dict[str, Any] = {"force": SPRING} if mounting == "spring" else {"press": OFFSET}
    return listed(bearing.state(rpm * RPM, **held))


def listed(state: State) -> np.ndarray:
    return np.array([state.force, *state.loads, *state.angles])


@both_sizes
def test_the_whole_demo(tmp_path: Path, quick: bool) -> None:
    (result,) = demo.main(tmp_path, quick=quick, progress=False)
    left_behind(tmp_path, "spindle")
    size = demo.QUICK if quick else demo.FULL
    np.testing.assert_allclose(demo.found_in(result), balanced(size.speeds[-1], "offset"), rtol=PROMISED)


@pytest.mark.slow
@pytest.mark.parametrize("mounting", MOUNTINGS)
def test_preload_at_three_speeds(mounting: str) -> None:
    """Held by their faces the rings press twice as much at 20,000 rpm; those that a spring presses do not."""
    found, result = demo.sweep(mounting, demo.QUICK)
    assert result.status == "completed", result.message
    exact = np.array([balanced(rpm, mounting) for rpm in demo.QUICK.speeds])
    print(f"{mounting}: off by {np.abs(found / exact - 1.0).max(axis=1)} of preload, loads and angles")
    np.testing.assert_allclose(found, exact, rtol=PROMISED)


def test_axial_stiffness_at_speed() -> None:
    """The slope of equilibria of a ball with its centrifugal force and gyroscopic moment, by differences, within 2 %:
    friction keeps its forces, and the orbit its speed. At rest the stiffness is a third larger."""
    speed, angles, h = 20e3 * RPM, (ANGLE, ANGLE), 1e-8
    for _ in range(2):
        result = wf.simulate(
            demo.build(speed, angles=angles), 3e-3, step=1e-5, start="equilibrium", progress=False,
            options=wf.RunOptions(save_every=10),
        )  # fmt: skip
        angles = tuple(demo.found_in(result)[3:])
    at_speed, at_rest = (
        (NUMPY.state(w, press=OFFSET + h).force - NUMPY.state(w, press=OFFSET - h).force) / (2.0 * h)
        for w in (speed, 0.0)
    )
    found = result.bearing_stiffness("front")
    print(f"axial stiffness {found.matrix[2, 2] / 1e6:.2f}, balance {at_speed / 1e6:.2f}, {at_rest / 1e6:.2f} N/um")
    assert found.left_out == ("friction",) and found.asymmetry < 1e-6
    assert found.matrix[2, 2] == pytest.approx(at_speed, rel=2e-2) and at_rest > 1.3 * at_speed


@pytest.mark.slow
def test_pair_under_thrust_at_speed() -> None:
    """One bearing of the pair is loaded, the other relieved; each begins at the contact angles of its own balls."""
    speed, thrust, angles = 20e3 * RPM, 150.0, {"front": (ANGLE, ANGLE), "rear": (ANGLE, ANGLE)}
    exact = NUMPY.pair(OFFSET, speed, thrust)
    found = {}
    for _ in range(3):
        scene = demo.build(speed)
        scene.add(wf.forces.PointForce(scene.body("shaft"), (0.0, thrust, 0.0), name="thrust"))
        for name, sense in (("front", 1.0), ("rear", -1.0)):
            scene.bearing(name).roll(speed, angle=(sense * angles[name][0], sense * angles[name][1]))
        result = wf.simulate(scene, 6e-3, step=1e-5, start="equilibrium", progress=False)
        assert result.status == "completed", result.message
        for name in angles:
            one = result.bearing(name)
            columns = (one.inner_load, one.outer_load, np.abs(one.inner_angle), np.abs(one.outer_angle))
            found[name] = np.array([abs(one.force[-1, 2]), *(column[-1].mean() for column in columns)])
            angles[name] = (found[name][3], found[name][4])
    print([found[name] / listed(state) - 1.0 for name, state in zip(("front", "rear"), exact, strict=True)])
    for name, state in zip(("front", "rear"), exact, strict=True):
        np.testing.assert_allclose(found[name], listed(state), rtol=PROMISED)
