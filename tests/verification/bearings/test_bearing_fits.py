"""Flexible rings pressed on shafts and into housings by small-sliding contact: Lame's rings, clearance, creep."""

from __future__ import annotations

import numpy as np
import pytest

from scenes import fitted_rings
from scenes.fitted_rings import LIGHT, RING, ROUGH, SECTORS, SHAFT_BORE, STEEL
from warpffrf.model.bearings import fit
from warpffrf.model.material import Material

LAME = 0.01
SAME_LOADS = 0.01  # of rollers with the same clearance in operation
TIGHTENED = 8e-6  # m: of the diameter, interference of rollers and raceways in operation
NONE = 1e-6  # of the creep above the limit


@pytest.mark.parametrize("shaft", [STEEL, LIGHT], ids=["steel", "aluminium"])
def test_a_ring_on_a_shaft_is_lames(shaft: Material) -> None:
    """With Poisson's ratio, as both contract freely along the axis. Of flat cells the pressure is (pi/N)^2/3 high."""
    result = fitted_rings.ring_on_shaft(2e-5, shaft)
    book = fit(RING, "inner", interference=2e-5, free_diameter=SHAFT_BORE, material=(STEEL, shaft))
    pressure = result.contact(fitted_rings.SEAT).pressure[-1]
    assert [pressure.min(), pressure.max()] == pytest.approx([book.pressure] * 2, rel=LAME)
    assert pressure.mean() / book.pressure - 1.0 == pytest.approx((np.pi / SECTORS) ** 2 / 3.0, rel=0.1)
    change = fitted_rings.raceway_change(result, RING.bottom("inner"))
    assert change == pytest.approx((book.raceway_change,) * 2, rel=LAME)


@pytest.mark.slow
def test_rollers_carry_what_the_clearance_in_operation_makes_them() -> None:
    """Two interferences, and clearances that differ by the difference of the changes of the raceway."""
    given = (1e-5, 2e-5)
    books = [fit(RING, "inner", interference=i, free_diameter=SHAFT_BORE).raceway_change for i in given]
    light, tight = (
        fitted_rings.bearing_on_shaft(i, change - TIGHTENED).bearing("bearing").inner_load[-1]
        for i, change in zip(given, books, strict=True)
    )
    assert light.min() > 100.0 and np.ptp(light) < 1e-4 * light.min()
    assert tight == pytest.approx(light, rel=SAME_LOADS)


@pytest.mark.slow
def test_a_ring_creeps_beyond_the_limit_of_shakedown_and_not_below() -> None:
    """And beyond it in proportion to the excess, so that its rates at two loads lead back to it. Far beyond, the ring
    moves along with the load, as published of rings in service."""
    limits = fitted_rings.limits()
    assert limits.slip < 0.9 * limits.shakedown
    still, slips, first, second, far = (
        fitted_rings.creep(fitted_rings.rotating_load(load, ROUGH, turns))
        for load, turns in (
            (0.98 * limits.slip, 2), (0.95 * limits.shakedown, 4), (1.05 * limits.shakedown, 4),
            (1.1 * limits.shakedown, 4), (3.0 * limits.shakedown, 3),
        )
    )  # fmt: skip
    rate = abs(first[-1])
    assert rate > 1e-10
    assert np.abs(still).max() < NONE * rate
    assert abs(slips[0]) > rate and np.abs(slips[1:]).max() < NONE * rate  # slips at first, then no more
    assert first[-1] == pytest.approx(first[-2], rel=0.01)
    zero = 1.05 - 0.05 * first[-1] / (second[-1] - first[-1])
    assert zero == pytest.approx(1.0, abs=0.01)
    assert far.min() > 100.0 * rate
