"""The ball bearing, whole; its equations against those of a published method, and what its checks tell apart."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest
from demo_files import left_behind

from demos import ball_bearing as demo
from references.closed_forms.ball_bearing import BallBearing


@pytest.mark.slow
def test_the_whole_demo_passes_and_writes_its_files(tmp_path: Path) -> None:
    assert demo.main(tmp_path / "out", quick=True, progress=False) == 0
    assert len(left_behind(tmp_path / "out", "ball_bearing")) == 12


def test_the_equations_are_those_of_the_standard() -> None:
    """A ball under the load, as `BallBearing` has it by root finding in space."""
    book = BallBearing(9, demo.BALL, demo.PITCH, demo.GROOVE, demo.GROOVE, demo.CLEARANCE, 206e9)
    exact, Q = book.solve(demo.LOAD, 0.0, (60e-6, 0.0, 0.0), tilts=False, lever=0.0)
    loads, shift = demo.by_the_equations(book.angles[None])
    assert shift[0] == pytest.approx(exact[0], rel=1e-3)  # there the clearance is a free contact angle
    np.testing.assert_allclose(loads[0], Q, atol=2e-3 * Q.max())
    turned, same = demo.by_the_equations(book.angles[None] + 2.0 * np.pi / 9.0)
    np.testing.assert_allclose(np.roll(turned[0], 1), loads[0], rtol=1e-6)
    assert same[0] == pytest.approx(shift[0], rel=1e-9)
