"""The twist of two markers: the turn about an axis that is left when its tilt is taken off."""

from __future__ import annotations

import numpy as np
import pytest

from warpffrf.model import rotation as rot
from warpffrf.model.joints.base import Row, gradient, value

STEP = 1e-6  # rad, of central differences: truncation 1e-12, round-off 1e-10
ROUND_OFF = 1e-14


def turn(*vector: float) -> np.ndarray:
    return rot.rotation_vector_matrix(np.array(vector))


def twist(i: int, A_a: np.ndarray, A_b: np.ndarray) -> float:
    return float(value(Row("twist", i), np.zeros(3), A_a, np.zeros(3), A_b))


@pytest.mark.parametrize("i", range(3))
def test_it_is_the_angle_of_the_quaternion_and_its_rate_that_of_the_turns(i: int) -> None:
    rng = np.random.default_rng(i)
    for _ in range(20):
        A_a, A_b = turn(*rng.normal(size=3)), turn(*rng.normal(size=3))
        q = rot.quaternion(A_a.T @ A_b)
        expected = 2.0 * np.arctan2(q[i], q[3])
        found = twist(i, A_a, A_b)
        assert np.angle(np.exp(1j * (found - expected))) == pytest.approx(0.0, abs=ROUND_OFF)
        _, t = gradient(Row("twist", i), np.zeros(3), A_a, np.zeros(3), A_b)
        for direction in np.eye(3):
            plus, minus = (twist(i, A_a, turn(*(s * STEP * direction)) @ A_b) for s in (1.0, -1.0))
            change = np.angle(np.exp(1j * (plus - minus))) / (2.0 * STEP)
            assert change == pytest.approx(t @ direction, abs=1e-9 * max(1.0, float(np.linalg.norm(t))))


def test_a_spin_before_or_after_a_tilt_adds_to_it_and_the_tilt_does_not() -> None:
    tilt = turn(0.7, -0.4, 0.0)
    assert twist(2, np.eye(3), tilt) == pytest.approx(0.0, abs=ROUND_OFF)
    assert twist(2, np.eye(3), turn(0, 0, 0.3) @ tilt) == pytest.approx(0.3, abs=ROUND_OFF)
    assert twist(2, turn(0, 0, -0.5), tilt @ turn(0, 0, 0.3)) == pytest.approx(0.8, abs=ROUND_OFF)
