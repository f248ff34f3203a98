"""The ball on a plane on a coarser mesh, whole; Hertz and Mindlin written out here."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest
from demo_files import left_behind

import warpffrf as wf
from demos import ball_on_plane as demo


@pytest.mark.slow
def test_the_whole_demo_passes_and_writes_its_files(tmp_path: Path) -> None:
    assert demo.main(tmp_path / "out", quick=True, progress=False) == 0
    checks = left_behind(tmp_path / "out", "ball_on_plane")
    E, nu, R, P, mu, Q = 210e9, 0.3, 0.01, 100.0, 0.3, 15.0
    a = np.cbrt(0.75 * P * R * (1 - nu**2) / E)
    assert checks["peak pressure"]["computed"] == pytest.approx(1.5 * P / (np.pi * a**2), rel=demo.SHAPE)
    assert checks["approach"]["computed"] == pytest.approx(a**2 / R, rel=demo.REST_OF_BALL)
    sideways = 3 * mu * P * (2 - nu) / (16 * E / (2 * (1 + nu)) * a) * (1 - (1 - Q / (mu * P)) ** (2 / 3))
    assert checks["tangential displacement"]["computed"] == pytest.approx(sideways, rel=demo.SIDEWAYS)

    pair = wf.Result.load(tmp_path / "out" / "ball_on_plane.h5").contact(demo.PAIR)
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
