"""The closed form of a leaf spring: two leaves by hand, gaps between tips, work and loss."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from references.closed_forms import LeafSpring
from warpffrf.model.errors import InputError

E, B, H = 210e9, 0.06, 0.01
FOUR = LeafSpring(lengths=(0.36, 0.27, 0.18, 0.09), width=B, thickness=H, youngs_modulus=E, friction=0.3)
EI = E * B * H**3 / 12.0
EXACT = 1e-9  # round-off of small linear systems


def test_two_leaves_without_friction_are_cantilevers_that_share_a_tip() -> None:
    """w_0(l_1) = P l_1^2 (3 l_0 - l_1)/(6 EI) - X l_1^3/(3 EI) is that of the lower leaf, X l_1^3/(3 EI)."""
    long, short = 0.36, 0.2
    two = LeafSpring((long, short), B, H, E, 0.3)
    X = (3.0 * long - short) / (4.0 * short)
    w = long**3 / (3.0 * EI) - X * short**2 * (3.0 * long - short) / (6.0 * EI)
    assert two.stiffness() == pytest.approx(1.0 / w, rel=EXACT)
    assert two.stiffness(1.0) > two.stiffness() > two.stiffness(-1.0)
    assert two.stuck_stiffness > two.stiffness(1.0)


@pytest.mark.parametrize("sense", [1.0, -1.0])
def test_leaves_touch_at_the_tips_alone(sense: float) -> None:
    """Deflections by integration of the moments twice: the lower leaf of each pair is below, but at its tip."""
    loads = np.array([1000.0, 2000.0]) if sense > 0.0 else np.array([4000.0, 2000.0])
    _, forces = FOUR.follow(loads)
    f, k = forces[-1], FOUR.contacts
    X, friction = f[1 : k + 1], f[k + 1 :]
    assert np.all(X > 0.0)
    assert friction == pytest.approx(sense * 0.3 * X, rel=EXACT)
    x = np.linspace(0.0, FOUR.lengths[0], 3601)
    M = np.zeros((k + 1, len(x)))
    M[0] = f[0] * (FOUR.lengths[0] - x)
    for i in range(k):
        inside = x <= FOUR.lengths[i + 1]
        arm = X[i] * (FOUR.lengths[i + 1] - x)
        M[i] -= np.where(inside, arm + 0.5 * H * friction[i], 0.0)
        M[i + 1] += np.where(inside, arm - 0.5 * H * friction[i], 0.0)
    dx = x[1] - x[0]
    slope = np.cumsum(M, axis=1) * dx / EI
    w = np.cumsum(slope, axis=1) * dx
    for i in range(k):
        inside = x <= FOUR.lengths[i + 1]
        gap = (w[i + 1] - w[i])[inside]
        assert gap.min() > -1e-3 * w.max()  # of the rectangles of the integrals
        assert abs(gap[-1]) < 1e-3 * w.max()
        assert gap.max() > 3e-3 * w.max()
    assert w[0, -1] == pytest.approx(float(FOUR.compliance[0] @ f), rel=2e-3)


def test_a_cycle_loses_its_area_whatever_the_steps() -> None:
    high, low = 3000.0, 600.0
    coarse, fine = FOUR.cycle_loss(high, low, 50), FOUR.cycle_loss(high, low, 1000)
    assert coarse == pytest.approx(fine, rel=2e-3)  # corners of the loop within a step
    down = np.linspace(high, low, 1001)
    load = np.concatenate([[high], down[1:], down[-2::-1]])
    w, f = FOUR.follow(load)
    assert np.trapezoid(load, w) == pytest.approx(fine.sum(), rel=1e-6)
    assert f[-1] == pytest.approx(f[0], rel=EXACT)
    assert np.all(FOUR.cycle_loss(1.001 * low, low) < 1e-6 * fine)  # sticks


def test_a_reversal_meets_the_stuck_spring_and_then_the_falling_line() -> None:
    w, _ = FOUR.follow(np.array([3000.0, 2999.0, 1000.0, 900.0]))
    assert 1.0 / (w[0] - w[1]) == pytest.approx(FOUR.stuck_stiffness, rel=1e-6)
    assert 3000.0 / w[0] == pytest.approx(FOUR.stiffness(1.0), rel=EXACT)
    assert 100.0 / (w[2] - w[3]) == pytest.approx(FOUR.stiffness(-1.0), rel=1e-6)


def test_leaves_that_are_none_are_refused() -> None:
    with pytest.raises(InputError, match="two or more that fall"):
        replace(FOUR, lengths=(0.1, 0.2))
    with pytest.raises(InputError, match="two or more that fall"):
        replace(FOUR, lengths=(0.1,))
    with pytest.raises(InputError, match="thickness"):
        replace(FOUR, thickness=0.0)
