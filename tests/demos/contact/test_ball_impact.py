"""The impact of a ball on a coarser mesh, whole; Hertz's figures from an integration of his force."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest
from checks import Check, both_sizes, left_behind, missed
from scipy.integrate import solve_ivp

import warpffrf as wf
from demos import ball_impact as demo
from demos.ball_impact import PAIR, RADIUS, SPEED, STEEL
from references.closed_forms import HertzImpact, PointContact, contact_modulus

IMPACT = HertzImpact(RADIUS, contact_modulus(STEEL, STEEL), STEEL.density * 4.0 / 3.0 * np.pi * RADIUS**3, SPEED)
HERTZ = 0.02  # of force and time: a/R, and five nodes in the widest half-width
KEPT = 2e-3  # of momentum and speed: what the cells of the contact grid and the steps take


def contact_time(result: wf.Result) -> float:
    """Time from touch to separation [s]; NaN where the ball does not leave.

    F^(2/3) is proportional to the approach, which is nearly linear in time at both ends: each is where the line through
    the two outermost values above zero meets zero.
    """
    force = result.contact(PAIR).normal_load
    touching = np.flatnonzero(force > 0.0)
    if len(touching) < 4 or touching[-1] == len(force) - 1:
        return float("nan")
    ends = []
    for i, j in ((touching[0], touching[1]), (touching[-1], touching[-2])):
        (t, u), (f, g) = result.time[[i, j]], force[[i, j]] ** (2.0 / 3.0)
        ends.append(t - f * (u - t) / (g - f))
    return float(ends[1] - ends[0])


def checks(result: wf.Result) -> list[Check]:
    """The figures of a run."""
    pair, motion = result.contact(PAIR), result.body("ball")
    scene_mass = float(result.history.scene.body("ball").mass)  # pyright: ignore[reportAttributeAccessIssue]
    impulse = scene_mass * float(motion.velocity[-1, 2] - motion.velocity[0, 2])
    area = float(np.trapezoid(pair.force[:, 2], result.time))
    return [
        Check("largest force", float(pair.normal_load.max()), IMPACT.force, "Hertz", HERTZ, "N"),
        Check("time of contact", contact_time(result), IMPACT.duration, "Hertz", HERTZ, "us", 1e6),
        Check("largest approach", float(pair.approach.max()), IMPACT.approach, "Hertz", HERTZ, "um", 1e6),
        Check("force over time", area, IMPACT.impulse, "2 m v", KEPT, "mN s", 1e3),
        Check("momentum gained", impulse, area, "force over time", KEPT, "mN s", 1e3),
        Check("speed after over before", -float(motion.velocity[-1, 2] / motion.velocity[0, 2]), 1.0,
              "no vibration", KEPT),
    ]  # fmt: skip


@both_sizes
def test_the_whole_demo(tmp_path: Path, quick: bool) -> None:
    (result,) = demo.main(tmp_path, quick=quick, progress=False)
    left_behind(tmp_path, "ball_impact")
    found = checks(result)
    assert not missed(found)
    computed = {check.name: check.computed for check in found}
    E, nu, R, v = 210e9, 0.3, 0.01, 0.1
    K, m = 4 / 3 * E / (2 * (1 - nu**2)) * np.sqrt(R), 7800 * 4 / 3 * np.pi * R**3

    def motion(_, y):
        return [y[1], -K / m * max(y[0], 0.0) ** 1.5]

    def leaves(_, y):
        return y[0]

    leaves.terminal, leaves.direction = True, -1.0
    path = solve_ivp(motion, (0.0, 1e-3), [1e-12, v], events=leaves, rtol=1e-10, atol=1e-14, max_step=1e-6)
    assert computed["time of contact"] == pytest.approx(path.t_events[0][0], rel=HERTZ)
    assert computed["largest force"] == pytest.approx(K * path.y[0].max() ** 1.5, rel=HERTZ)


def test_the_closed_forms_of_the_demo_are_those_of_the_reference() -> None:
    found = (demo.FORCE, demo.APPROACH, demo.DURATION, demo.WIDEST)
    widest = PointContact(IMPACT.force, RADIUS, IMPACT.modulus).half_width
    assert found == pytest.approx((IMPACT.force, IMPACT.approach, IMPACT.duration, widest), rel=1e-12)


def test_the_time_of_contact_is_that_of_its_closed_form() -> None:
    """On the force of Hertz's own motion, sampled: the ends are found between the samples."""
    from types import SimpleNamespace

    t = np.linspace(0.0, 1e-4, 101)
    touch, leave = 1.23e-5, 8.71e-5
    approach = np.maximum(np.sin(np.pi * (t - touch) / (leave - touch)), 0.0) * ((t > touch) & (t < leave))
    pair = SimpleNamespace(normal_load=approach**1.5)
    result = SimpleNamespace(time=t, contact=lambda _: pair)
    assert contact_time(result) == pytest.approx(leave - touch, rel=1e-3)  # pyright: ignore[reportArgumentType]
