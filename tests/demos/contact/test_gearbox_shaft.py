"""The shaft of a gearbox, whole, compared with full finite elements; what its rings are mounted on."""

from __future__ import annotations

from pathlib import Path

import numpy as np
from checks import Check, both_sizes, left_behind, missed

from demos import gearbox_shaft as demo
from gearbox_reference import AXIS, FIRST, compared
from references.closed_forms.ball_bearing import BallBearing
from references.finite_elements.shaft_in_housing import balls, rollers

TOLERANCE = 5e-3  # equations of first order in the tilts, and seats by nodes instead of facets; observed 2e-3


@both_sizes
def test_the_whole_demo(tmp_path: Path, quick: bool) -> None:
    result = demo.main(tmp_path, quick=quick, progress=False)[0]
    left_behind(tmp_path, "gearbox_shaft")
    found = [
        Check(name, ours, theirs, "full finite elements", TOLERANCE, unit, scale=scale)
        for name, ours, theirs, scale, unit in compared(result, demo.QUICK if quick else demo.FULL)
    ]
    assert not missed(found)
    force = result.bearing("locating").force[-1]
    assert abs(abs(force[2]) - demo.FORCE[1]) < 2.0  # the thrust, less that of tilted rollers against their ribs


def test_the_laws_of_the_reference_have_a_potential() -> None:
    """Force and moment are the gradient of one function: their tangent is symmetric."""
    ball = BallBearing(9, 0.0122, 0.06, 0.52 * 0.0122, 0.53 * 0.0122, 1e-5, 210e9)
    at = np.array([2e-6, 1.4e-4, 1e-5, 3e-4, 0.0, -2e-4])
    for law in (balls(ball, AXIS, FIRST), rollers(15, 0.01, 0.011, 1e-6, AXIS, FIRST)):
        steps = np.diag([1e-9] * 3 + [1e-8] * 3)
        K = np.array([(law(at + h)[0] - law(at - h)[0]) / (2.0 * h.max()) for h in steps])
        size = np.sqrt(np.abs(np.diag(K))) + 1e-3
        assert np.abs((K - K.T) / np.outer(size, size)).max() < 1e-4
