"""A rotor with its equations in NumPy and SciPy on our film, by a `Connector`, against a run of one scene."""

from __future__ import annotations

import numpy as np
import pytest

from scenes.connected_rotor import CLEARANCE, outside, whole

NODES, TURNS = (32, 5), 1
ORBIT = 1e-3  # of the orbit: 9.1e-4 at 40 steps per revolution, 2.7e-4 at 80


@pytest.mark.slow
def test_a_rotor_outside_has_the_orbit_of_one_inside() -> None:
    """From rest, with an orbit of half of the clearance. Two schemes of the second order: their difference falls with
    the square of the step."""
    off = []
    for steps in (40, 80):
        inside = whole(steps, TURNS, NODES)
        found = outside(inside[0], steps, TURNS, NODES)
        orbit = np.ptp(inside, axis=0)
        assert orbit.max() > 0.4 * CLEARANCE
        off.append(np.abs(found.places - inside).max() / orbit.max())
        print(f"{steps} steps: off by {off[-1]:.2e} of the orbit, {found.trials / steps:.1f} trials per step")
    assert max(off) < ORBIT
    assert off[1] < 0.4 * off[0]
