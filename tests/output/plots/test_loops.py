"""Loops of force against displacement compared with closed forms, and what they are drawn of by name."""

from __future__ import annotations

import numpy as np
import pytest

import warpffrf as wf
from warpffrf.model import forces, joints, signals
from warpffrf.model.errors import InputError
from warpffrf.output.loops import Hysteresis, channel, cycle_times, equivalent_damping, piece, value_at

STEPS = 400  # of a cycle
POLYGON = (2.0 * np.pi / STEPS) ** 2 / 6.0  # what a polygon in a smooth loop is short of
TIME = np.linspace(0.0, 3.0, 3 * STEPS + 1)


def driven(force: np.ndarray, displacement: np.ndarray) -> Hysteresis:
    return Hysteresis(TIME, force, displacement)


def jenkins(stiffness: float, bound: float, x: np.ndarray) -> np.ndarray:
    """A spring in series with a slider."""
    force, slid = np.empty_like(x), 0.0
    for n, place in enumerate(x):
        slid = np.clip(slid, place - bound / stiffness, place + bound / stiffness)
        force[n] = stiffness * (place - slid)
    return force


@pytest.mark.parametrize("ratio", [1e-3, 0.05, 0.4])
def test_a_damped_oscillator_has_its_damping_ratio(ratio: float) -> None:
    """F = k x + c xdot around at the eigenfrequency: D = pi c w X^2, and U = k X^2 sqrt(1 + (2 zeta)^2)/2."""
    k, X = 3e5, 2e-3
    x, rate = X * np.cos(2.0 * np.pi * TIME), -X * np.sin(2.0 * np.pi * TIME)
    loop = driven(k * x + 2.0 * ratio * k * rate, x).cycles(1.0)[-1]
    assert loop.loss == pytest.approx(2.0 * np.pi * ratio * k * X**2, rel=2.0 * POLYGON)
    wide = np.sqrt(1.0 + (2.0 * ratio) ** 2)
    assert loop.equivalent_damping == pytest.approx(ratio / wide, rel=1e-4)
    assert loop.stiffness == pytest.approx(k * wide, rel=1e-4) and loop.open < 1e-9


def test_a_jenkins_element_loses_four_bounds_times_its_slide() -> None:
    """D = 4 mu (X - mu/k), whichever its first cycle was."""
    k, bound, X = 1e6, 300.0, 1e-3
    x = X * np.sin(2.0 * np.pi * TIME)
    found = driven(jenkins(k, bound, x), x)
    first, second, third = found.cycles(1.0)
    assert second.loss == pytest.approx(4.0 * bound * (X - bound / k), rel=1e-4)
    assert third.loss == pytest.approx(second.loss, rel=1e-12) and first.open > 0.1
    assert second.equivalent_damping == pytest.approx(2.0 / np.pi * (1.0 - bound / (k * X)), rel=1e-4)


def test_a_cycle_that_is_not_closed_is_reported(caplog: pytest.LogCaptureFixture) -> None:
    x = 1e-3 * np.sin(2.0 * np.pi * TIME)
    found = driven(jenkins(1e6, 300.0, x), x)
    found.loop(1.0, 2.0)
    assert not caplog.records
    assert found.loop(0.0, 1.0).open > 0.1  # the first loading is in it
    assert "the cycle from 0 to 1 s is open by" in caplog.text


def test_the_box_is_the_most_and_a_spring_the_least() -> None:
    x = np.sin(2.0 * np.pi * TIME)
    assert driven(np.sign(np.cos(2.0 * np.pi * TIME)), x).cycles(1.0)[1].equivalent_damping == pytest.approx(
        2.0 / np.pi, rel=1e-2
    )
    assert driven(7.0 * x, x).cycles(1.0)[0].equivalent_damping == pytest.approx(0.0, abs=1e-12)
    still = driven(x, np.zeros_like(x)).loop()
    assert np.isnan(still.stiffness) and np.isnan(still.equivalent_damping)
    assert equivalent_damping(4.0 * np.pi, 2.0) == pytest.approx(0.5)


def test_a_preload_counts_not() -> None:
    x = 1e-3 * np.sin(2.0 * np.pi * TIME)
    F = jenkins(1e6, 300.0, x)
    own, loaded = (driven(F + load, x + 1e-4 * load).cycles(1.0)[1] for load in (0.0, 5e4))
    assert loaded.equivalent_damping == pytest.approx(own.equivalent_damping, rel=1e-6)
    assert -driven(-F, x).cycles(1.0)[1].work == pytest.approx(own.work)


def test_stiffness_of_a_hardening_spring() -> None:
    x = TIME * 1e-3
    found = driven(2e5 * x + 4e10 * x**3, x).stiffness()
    np.testing.assert_allclose(found.secant[1:], 2e5 + 4e10 * x[1:] ** 2, rtol=1e-9)
    middle = 0.5 * (x[1:] + x[:-1])
    np.testing.assert_allclose(found.tangent[1:], 2e5 + 12e10 * middle**2 + 1e10 * (x[1] - x[0]) ** 2, rtol=1e-6)


def test_pieces_between_rows() -> None:
    time, values = piece(np.array([0.0, 1.0, 2.0]), np.array([0.0, 2.0, 0.0]), 0.5, 1.5, "a")
    np.testing.assert_allclose(time, [0.5, 1.0, 1.5])
    np.testing.assert_allclose(values, [1.0, 2.0, 1.0])
    np.testing.assert_allclose(cycle_times(np.array([0.0, 0.9999999999]), 0.5, "a"), [0.0, 0.5, 1.0], atol=1e-9)
    np.testing.assert_array_equal(value_at(np.zeros(1), np.array([4.0]), np.zeros(2), "a"), [4.0, 4.0])
    with pytest.raises(InputError, match="the run has no saved row"):
        value_at(np.zeros(0), np.zeros(0), np.zeros(1), "a")


# --- by name


@pytest.fixture(scope="module")
def result() -> wf.Result:
    scene = wf.Scene(gravity=(0.0, 0.0, 0.0))
    block = scene.add_rigid_body(2.0, (0.1, 0.1, 0.1), name="block")
    guide = scene.add(joints.Prismatic(scene.ground, block.at((0, 0, 0)), axis=(1, 0, 0), name="guide"))
    scene.add(forces.JointSpringDamper(guide, stiffness=800.0, damping=3.0, name="spring"))
    scene.add(forces.PointForce(block.at((0, 0, 0)), (signals.Ramp(0.0, 5.0, duration=0.02), 0, 0), name="push"))
    scene.add(wf.sensors.Position(block.at((0, 0, 0)), name="place"))
    scene.add(wf.sensors.Velocity(block.at((0, 0, 0)), name="block"))
    return wf.simulate(scene, 0.02, step=1e-3, progress=False)


def test_names_find_their_values(result: wf.Result) -> None:
    place = result.sensor("place").values[:, 0]
    np.testing.assert_allclose(channel(result, "guide", "m", "x").values, place, atol=1e-12)
    found = result.hysteresis(("push", "x"), "guide")
    np.testing.assert_array_equal(found.force, result.force("push").force[:, 0])
    assert (found.force_label, found.force_unit, found.displacement_unit) == ("push x", "N", "m")
    for what, values in (
        (("sensor", "block", "x"), result.sensor("block").values[:, 0]),
        (("body", "block", "x"), result.body("block").position[:, 0]),
        (("guide", "torque_z"), result.joint("guide").torque[:, 2]),
        (("spring", "deformation"), result.force("spring").deformation[:, 0]),
        (place, place),
    ):
        np.testing.assert_array_equal(channel(result, what, "m", "x").values, values)


@pytest.mark.parametrize(
    ("what", "words"),
    [
        ("pusch", "name 'pusch' does not exist"),
        (("push", "w"), "component of force 'push'"),
        ("place", "several components"),
        (("block", "x"), "a sensor and a body"),
        (np.zeros(3), "21 saved steps"),
        (("rod", "push", "x"), "kind"),
        ((), "give a name"),
    ],
)
def test_what_is_not_there_is_named(result: wf.Result, what: object, words: str) -> None:
    with pytest.raises(InputError, match=words):
        result.hysteresis(what, "guide")
