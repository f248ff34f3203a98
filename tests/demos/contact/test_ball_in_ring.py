"""The ball in the groove of a ring on a coarser mesh: friction alone makes it roll, and it slips as Heathcote says."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest
from checks import Check, both_sizes, left_behind, missed

import warpffrf as wf
from demos import ball_in_ring as demo
from demos.ball_in_ring import BALL, BOTTOM, GROOVE, LOAD, PAIR, SPEED, STEEL, speeds
from references.closed_forms import contact_modulus
from references.closed_forms.elliptic import EllipticContact

SETTLED = 4  # of them, at the end, that are averaged
HERTZ = EllipticContact(
    LOAD, 1.0 / (1.0 / BALL - 1.0 / BOTTOM), 1.0 / (1.0 / BALL - 1.0 / GROOVE), contact_modulus(STEEL, STEEL)
)
AXES, PEAK = 0.02, 0.03  # of half-axes and peak pressure: four nodes along and five across in a half-axis
FORCE = 1e-3  # of the load, mean: cells of the contact grid pass, and the slide has inertia
RATIO = 5e-4  # of the ball's speed: where in the patch it rolls, a third of b^2/(10 R^2)
DISSIPATION = 1e-12  # of the work of friction: rounding


def checks(scene: wf.Scene, result: wf.Result) -> list[Check]:
    """The figures of a run: at rest, and means over the last crossings."""
    pair, t = result.contact(PAIR), result.time
    rows = t > t[-1] - SETTLED * 2.0 * HERTZ.half_axes[0] / SPEED
    a, b = HERTZ.half_axes
    arm, ball = (float(values[rows].mean()) for values in speeds(result))
    mass = scene.body("ball").mass + scene.body("slide").mass
    carried = LOAD + mass * arm**2 * (BOTTOM - BALL)
    rolls = -arm * (BOTTOM - BALL) / BALL * (1.0 + b**2 / (10.0 * BALL**2))
    work = result.energy["friction"]
    return [
        Check("half-axis along the groove", float(pair.half_widths[0, 0]), a, "Hertz", AXES, "um", 1e6),
        Check("half-axis across", float(pair.half_widths[0, 1]), b, "Hertz", AXES, "um", 1e6),
        Check("peak pressure", float(pair.peak_pressure[0]), HERTZ.peak_pressure, "Hertz", PEAK, "MPa", 1e-6),
        Check("force while rolling", float(pair.force_magnitude[rows].mean()), carried, "load, centrifugal force",
              FORCE, "N"),
        Check("speed of the ball over the arm's", ball / arm, rolls / arm, "rolling", RATIO),
        Check("largest gain from friction", max(float(np.diff(work).max()), 0.0), 0.0, "takes energy only",
              DISSIPATION, "J", scale=float(np.ptp(work))),
    ]  # fmt: skip


SMALL = demo.Size(ball_sectors=230, ring_sectors=1150, layers=6, axial=4)


pytestmark = pytest.mark.slow


@pytest.fixture(scope="module")
def result() -> wf.Result:
    found = demo.run(demo.build(SMALL, progress=False), SMALL, progress=False)
    assert found.status == "completed", found.message
    return found


def test_it_rolls_from_rest(result: wf.Result) -> None:
    arm, ball = demo.speeds(result)
    assert abs(ball[0]) < 1e-9 and arm[-1] == pytest.approx(1.0 / 0.03, rel=1e-6)
    faster = -ball[-20:].mean() / (arm[-1] * (0.03 - 0.006) / 0.006) - 1.0
    b = result.contact(demo.PAIR).half_widths[0, 1]
    assert 0.5 < faster / (b**2 / (10.0 * 0.006**2)) < 1.5  # the groove is curved across


def test_it_slips_one_way_in_the_middle_and_the_other_at_the_ends(result: wf.Result) -> None:
    friction = result.contact(demo.PAIR).friction
    slip = friction.slip_velocity[-1, 0]
    touching = friction.state[-1] > 0
    rows = np.flatnonzero(touching.any(axis=0))
    ends, middle = slip[:, rows[[0, -1]]], slip[:, friction.state.shape[2] // 2]
    assert ends[touching[:, rows[[0, -1]]]].mean() * middle[touching[:, friction.state.shape[2] // 2]].mean() < 0.0
    np.testing.assert_allclose(slip, slip[:, ::-1], atol=1e-6 * np.abs(slip).max())
    assert np.all(np.diff(result.energy["friction"]) <= 1e-15)


def test_the_patch_is_an_ellipse_of_hertz(result: wf.Result) -> None:
    pair = result.contact(demo.PAIR)
    assert pair.half_widths[0] == pytest.approx(HERTZ.half_axes, rel=0.06)  # two nodes in a half-axis


@both_sizes
def test_the_whole_demo(tmp_path: Path, quick: bool) -> None:
    (result,) = demo.main(tmp_path, quick=quick, progress=False)
    left_behind(tmp_path, "ball_in_ring")
    assert not missed(checks(result.scene, result))
