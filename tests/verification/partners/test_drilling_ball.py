"""A ball that drills on a plane: spin moment and friction power of a run against the closed form of full slip."""

from __future__ import annotations

import numpy as np
import pytest

from studies.rolling.drilling_ball import SPEED, SPIN_MOMENT, drilling

MOMENT = 0.01  # of mu p summed over cells, five in a half-width: 0.5 % is found
BALANCE = 1e-6  # relative: of records of one state


@pytest.mark.slow
def test_a_drilling_ball() -> None:
    """M_z = 3 pi/16 mu P a of Hertz's pressure in full slip, against the spin; the drive gives what friction takes."""
    result = drilling()
    friction = result.contact("pair").friction
    assert friction.spin_velocity[-1] == pytest.approx(-SPEED, rel=BALANCE)  # outwards is down
    assert friction.spin_moment[-1] == pytest.approx(SPIN_MOMENT, rel=MOMENT)
    assert friction.spin_moment[-1] == pytest.approx(result.joint("turn").torque[-1, 2], rel=BALANCE)
    assert friction.power[-1] == pytest.approx(SPEED * friction.spin_moment[-1], rel=BALANCE)
    assert np.isnan(friction.t_gamma[-1]) and np.isnan(friction.spin_creepage[-1])  # it does not roll
