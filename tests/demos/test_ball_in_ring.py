"""The ball in the groove of a ring on a coarser mesh: friction alone makes it roll, and it slips as Heathcote says."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest
from demo_files import left_behind

import warpffrf as wf
from demos import ball_in_ring as demo

SMALL = demo.Size(ball_sectors=230, ring_sectors=1150, layers=6, axial=4, frames=5)


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
    assert pair.half_widths[0] == pytest.approx(demo.HERTZ.half_axes, rel=0.06)  # two nodes in a half-axis


def test_the_whole_demo_passes_and_writes_its_files(tmp_path: Path) -> None:
    assert demo.main(tmp_path / "out", quick=True, progress=False) == 0
    left_behind(tmp_path / "out", "ball_in_ring")
