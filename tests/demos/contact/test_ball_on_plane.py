"""The ball on a plane on a coarser mesh, whole; Hertz and Mindlin written out here."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest
from checks import Check, both_sizes, left_behind, missed

import warpffrf as wf
from demos import ball_on_plane as demo
from demos.ball_on_plane import DOWN, FRICTION, LOAD, PAIR, PUSH, RADIUS, SIDE, STEEL
from references.closed_forms import MindlinPoint, PointContact, contact_modulus, tangential_compliance

HERTZ = PointContact(LOAD, RADIUS, contact_modulus(STEEL))
MINDLIN = MindlinPoint(HERTZ, FRICTION, tangential_compliance(STEEL))
SHAPE = 0.01  # of half-width and peak pressure, at five nodes in a half-width
REST_OF_BALL = 0.015  # of the approach: a/R
SIDEWAYS = 0.02  # of the tangential displacement: a/R, and cells at the edge


def checks(result: wf.Result) -> list[Check]:
    """The figures of a run."""
    pair = result.contact(PAIR)
    friction = pair.friction
    grid = float(pair.spacing) / HERTZ.half_width
    stick = float(np.sqrt(friction.stick_area[-1] / np.pi)) / HERTZ.half_width
    work = result.energy["friction"]
    return [
        Check("half-width around", float(pair.half_widths[0, 0]), HERTZ.half_width, "Hertz", SHAPE, "um", 1e6),
        Check("half-width along", float(pair.half_widths[0, 1]), HERTZ.half_width, "Hertz", SHAPE, "um", 1e6),
        Check("peak pressure", float(pair.peak_pressure[0]), HERTZ.peak_pressure, "Hertz", SHAPE, "MPa", 1e-6),
        Check("approach", -float(result.joint(DOWN).coordinate[0]), HERTZ.approach, "Hertz", REST_OF_BALL, "um", 1e6),
        Check("force sideways", abs(float(pair.force[-1, 0])), PUSH, "statics", 1e-3, "N"),
        Check("stick radius over half-width", stick, MINDLIN.stick_ratio(PUSH), "Mindlin, to a grid spacing", grid,
              scale=1.0),
        Check("tangential displacement", float(result.joint(SIDE).coordinate[-1]), float(MINDLIN.loading(PUSH)),
              "Mindlin", SIDEWAYS, "um", 1e6),
        Check("largest gain from friction", max(float(np.diff(work).max()), 0.0), 0.0, "takes energy only",
              1e-12, "J", scale=float(np.ptp(work))),
    ]  # fmt: skip


@both_sizes
def test_the_whole_demo(tmp_path: Path, quick: bool) -> None:
    (result,) = demo.main(tmp_path, quick=quick, progress=False)
    left_behind(tmp_path, "ball_on_plane")
    found = checks(result)
    assert not missed(found)
    computed = {check.name: check.computed for check in found}
    E, nu, R, P, mu, Q = 210e9, 0.3, 0.01, 100.0, 0.3, 15.0
    a = np.cbrt(0.75 * P * R * (1 - nu**2) / E)
    assert computed["peak pressure"] == pytest.approx(1.5 * P / (np.pi * a**2), rel=SHAPE)
    assert computed["approach"] == pytest.approx(a**2 / R, rel=REST_OF_BALL)
    assert demo.HALF_WIDTH == pytest.approx(a, rel=1e-12)
    assert demo.PEAK == pytest.approx(HERTZ.peak_pressure, rel=1e-12)
    assert demo.mindlin(Q) == pytest.approx(MINDLIN.loading(Q), rel=1e-12)
    sideways = 3 * mu * P * (2 - nu) / (16 * E / (2 * (1 + nu)) * a) * (1 - (1 - Q / (mu * P)) ** (2 / 3))
    assert computed["tangential displacement"] == pytest.approx(sideways, rel=SIDEWAYS)

    pair = wf.Result.load(tmp_path / "ball_on_plane.h5").contact(demo.PAIR)
    stick, slip = pair.friction.stick_area, pair.friction.slip_area
    held = np.flatnonzero(stick > 0.0)
    assert np.all(np.diff(stick[held]) <= 1e-9 * stick.max())  # the stick zone only shrinks
    assert slip[-1] > 0.0
    assert np.all(np.diff(-pair.force[held, 0]) > 0.0)  # the push only grows


def test_the_ball_cannot_turn_and_nothing_is_redundant() -> None:
    """Joints do not ask how fine the patch is."""
    check = demo.build(demo.Size(cells=0.8), progress=False).check()
    assert not check.redundant and not check.unsupported
    assert check.degrees_of_freedom == sum(check.modes.values()) + 2  # down and sideways
