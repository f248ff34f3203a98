"""A wheelset of two cones that hunts on round rails, against the exact kinematics of rolling (`scenes.hunting`)."""

from __future__ import annotations

import pytest

from scenes.hunting import RAIL, SLOPE, hunting, kinematics, wavelength

EXACT = 5e-3  # creepages of this size are what forces need: mu N at about 4e-3, a tenth of it here


@pytest.mark.slow
def test_hunting_is_that_of_the_kinematics() -> None:
    found, (kappa, conicity, b, r) = hunting(), kinematics()
    assert conicity == pytest.approx(SLOPE * (b + RAIL * SLOPE) / (b - r * SLOPE), rel=1e-3)  # Wickens, to first order
    assert found.roll == pytest.approx(kappa, rel=EXACT)
    assert found.drift == pytest.approx(found.speed / (1.0 + kappa * r), rel=EXACT)
    assert found.steer == pytest.approx(-found.speed * conicity / (b * r), rel=EXACT)
    assert found.wave == pytest.approx(wavelength(), rel=EXACT)
    energy = found.result.history.energy
    assert abs(energy["numerical"][-1]) < 1e-3 * energy["kinetic"][0]
