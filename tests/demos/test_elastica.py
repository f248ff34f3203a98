"""The elastica, whole; and what is written of it: the order of the error, what stiffening is for, roots that hold."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest
from demo_files import left_behind

from demos import elastica as demo
from references.closed_forms import Elastica


def test_the_whole_demo_passes_and_writes_its_files(tmp_path: Path) -> None:
    assert demo.main(tmp_path / "out", quick=True, progress=False) == 0
    checks = left_behind(tmp_path / "out", "elastica")
    assert len(checks) == 13
    assert checks["4 bodies, PL2/EI = 4: w/L"]["expected"] == pytest.approx(0.669964, abs=1e-6)
    assert checks["4 bodies, PL2/EI = 4: u/L"]["expected"] == pytest.approx(0.328941, abs=1e-6)


def test_the_drawn_shape_ends_where_the_closed_form_says() -> None:
    for load in demo.SHOWN:
        x, z = demo.shape(load)[-1]
        assert (1.0 - x, z) == pytest.approx((Elastica(load).shortening, Elastica(load).deflection), abs=1e-8)


def test_one_body_is_off_by_the_square_of_the_load() -> None:
    """4.0 between 1/2 and 1 in the limit; mesh and the next order take a fifth of that."""
    one = demo.run(demo.QUICK, parts=1, load=demo.ONE_BODY, progress=False)
    assert one.error(1.0) / one.error(0.5) == pytest.approx(4.0, rel=0.2)
    assert abs(one.error(0.5)) < 3e-3


def test_without_stiffening_a_body_does_not_shorten() -> None:
    """Its tip goes around the root on a circle, where the elastica's chord gets 1 % shorter."""
    linear = demo.run(demo.QUICK, parts=1, load=demo.ONE_BODY, stiffening=False, progress=False)
    chord = np.linalg.norm(linear.ends[:, -1], axis=1) / demo.LENGTH
    assert np.abs(chord - 1.0).max() < 5e-4
    assert linear.error(1.0) > 0.03
    bent = demo.run(demo.QUICK, parts=1, load=demo.ONE_BODY, progress=False)
    assert np.abs(bent.ends[:, 0]).max() < demo.ROOT * demo.LENGTH
    exact = np.hypot(1.0 - Elastica(1.0).shortening, Elastica(1.0).deflection)
    assert np.linalg.norm(bent.ends[-1, -1]) / demo.LENGTH == pytest.approx(exact, abs=5e-4)
    assert bent.back[-1] == pytest.approx(Elastica(1.0).shortening, rel=0.01)
