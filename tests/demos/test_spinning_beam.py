"""The spun-up beam against the beam equation with tension; without stiffening it must fail the same checks."""

from __future__ import annotations

import numpy as np
import pytest

from demos import spinning_beam as demo

SHORT = demo.Size(cells=10, at_speed=2.0, frames=5)
FIRST = 3.516015  # lambda of a clamped beam, omega = lambda sqrt(EI / (rho A L^4))


def test_the_reference_has_the_frequency_and_the_lag_of_a_clamped_beam() -> None:
    """At a speed that rises slowly from zero the lag is that under -rho A alpha x, 11/120 rho A alpha L^5 / EI."""
    t = np.linspace(0.0, 2.0, 400)
    slow = demo.beam_tip(t)
    static = -11.0 / 120.0 * demo.LINE_MASS * demo.hub_motion(t)[2] * demo.LENGTH**5 / demo.BENDING_STIFFNESS
    late = t > 1.0
    omega_1 = FIRST * np.sqrt(demo.BENDING_STIFFNESS / demo.LINE_MASS) / demo.LENGTH**2
    # an oscillator under a load that rises as t^2 follows it up to 2/omega_1^2 of its curvature and as much ringing
    curvature = np.abs(np.gradient(np.gradient(static, t), t)).max()
    assert np.abs(slow - static)[late].max() < 4.0 * curvature / omega_1**2
    assert slow[late].mean() == pytest.approx(static[late].mean(), rel=0.2)


@pytest.fixture(scope="module")
def runs() -> dict[bool, list]:
    found = {}
    for stiffening in (True, False):
        scene, result = demo.run(SHORT, stiffening=stiffening, progress=False)
        assert result.status == "completed", result.message
        u, w = demo.tip_in_hub_frame(scene, result)
        found[stiffening] = demo.checks(result.time, u, w, demo.beam_tip(result.time))
    return found


def test_the_stiffened_beam_follows_the_beam_equation(runs: dict[bool, list]) -> None:
    assert all(check.passed for check in runs[True]), [(c.name, c.error) for c in runs[True]]


def test_without_stiffening_the_lag_is_wrong(runs: dict[bool, list]) -> None:
    lag, difference, _ = runs[False]
    assert lag.error > 0.1 and difference.error > 0.2
