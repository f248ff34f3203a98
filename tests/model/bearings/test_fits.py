"""Interference fits of rings against Lame's formulas, limits, and finite elements along the radius."""

from __future__ import annotations

from dataclasses import replace
from typing import Any

import numpy as np
import pytest

from references.closed_forms import PressFit
from references.finite_elements.pressed_tubes import pressed, tube
from warpffrf.model.bearings import BallGeometry, Fit, RollerGeometry, catalogue, fit, operating_clearance
from warpffrf.model.bearings.parts import STEEL
from warpffrf.model.errors import InputError
from warpffrf.model.material import Material

ALUMINIUM = Material(70e9, 0.33, 2700.0, name="aluminium")
LIGHT = 23e-6  # 1/K, of aluminium
BEARING = RollerGeometry(
    elements=12, roller_diameter=0.01, roller_length=0.012, pitch_diameter=0.07, clearance=40e-6, bore=0.05,
    outside_diameter=0.09,
)  # fmt: skip
CLOSE = 1e-3  # finite elements of 1/400 of a wall


@pytest.mark.parametrize("bore", [0.0, 0.03])
def test_the_pressure_of_two_materials_is_lames(bore: float) -> None:
    closed = PressFit(0.025, 0.5 * (0.07 - 0.01 - 20e-6), 1e-5, 0.02, 0.1, ALUMINIUM, STEEL, 0.5 * bore)
    found = fit(BEARING, "inner", interference=2e-5, free_diameter=bore, material=(STEEL, ALUMINIUM))
    assert found.pressure == pytest.approx(closed.pressure, rel=1e-12)
    assert found.hoop_stress[0] == pytest.approx(closed.hub_stress(0.025)[1], rel=1e-12)
    assert found.interference == pytest.approx(2e-5, rel=1e-12)


def test_limits() -> None:
    d, raceway = 0.05, 2.0 * BEARING.bottom("inner")
    solid = fit(BEARING, "inner", interference=2e-5)
    E = STEEL.youngs_modulus
    assert solid.pressure == pytest.approx(E * 2e-5 / (2.0 * d) * (1.0 - (d / raceway) ** 2), rel=1e-12)
    assert solid.raceway_change == pytest.approx(2e-5 * d / raceway, rel=1e-12)  # of one material: for any ring
    assert solid.hoop_stress[1] == pytest.approx(-solid.pressure)
    # a thin ring on a shaft that does not yield takes all of the interference
    thin = replace(BEARING, bore=raceway - 2e-4)
    hard = Material(1e6 * E, 0.3, 7850.0)
    found = fit(thin, "inner", interference=2e-5, material=(STEEL, hard))
    assert found.raceway_change == pytest.approx(2e-5, rel=5e-3)
    assert found.hoop_stress[0] == pytest.approx(E * 2e-5 / raceway, rel=5e-3)
    assert found.pressure == pytest.approx(2e-4 / raceway * found.hoop_stress[0], rel=5e-3)
    massive, thick = (fit(BEARING, "outer", interference=2e-5, free_diameter=b) for b in (None, 90.0))
    assert massive.pressure == pytest.approx(thick.pressure, rel=1e-5)
    assert massive.raceway_change < 0.0 and massive.hoop_stress[0] < 0.0 < massive.hoop_stress[1]


def test_a_rotating_ring_and_a_rotating_shaft() -> None:
    """A thin ring has the hoop stress rho w^2 r^2, a solid shaft (3 + nu)/8 of it in its middle."""
    raceway = 2.0 * BEARING.bottom("inner")
    thin = replace(BEARING, bore=raceway - 1e-5)
    found = fit(thin, "inner", interference=-1e-3, speed=2000.0)
    thrown = STEEL.density * (2000.0 * 0.5 * raceway) ** 2
    assert found.pressure == 0.0
    assert found.hoop_stress == pytest.approx((thrown, (3.0 + 0.3) / 8.0 * thrown), rel=5e-4)
    assert found.raceway_change == pytest.approx(raceway * thrown / STEEL.youngs_modulus, rel=5e-4)


@pytest.mark.parametrize("side", ["inner", "outer"])
def test_finite_elements_along_the_radius(side: str) -> None:
    """Interference, speed and temperatures at once, of two materials."""
    free = {"inner": 0.02, "outer": 0.13}[side]
    seat, raceway = {"inner": 0.05, "outer": 0.09}[side], 2.0 * BEARING.bottom(side)
    given: dict[str, Any] = {
        "interference": 6e-5, "speed": 1500.0, "temperature_rise": (40.0, 25.0), "expansion": (12e-6, LIGHT),
        "material": (STEEL, ALUMINIUM), "free_diameter": free,
    }  # fmt: skip
    found = fit(BEARING, side, **given)
    ring = tube(seat, raceway, STEEL, 12e-6 * 40.0, 1500.0)
    mate = tube(seat, free, ALUMINIUM, LIGHT * 25.0, 1500.0)
    inner, outer = (mate, ring) if side == "inner" else (ring, mate)
    pressure, *u = pressed(inner, outer, 6e-5)
    change = 2.0 * (u[1][-1] if side == "inner" else u[0][0])
    assert found.pressure == pytest.approx(pressure, rel=CLOSE)
    assert found.raceway_change == pytest.approx(change, rel=CLOSE)
    assert found.pressure != pytest.approx(fit(BEARING, side, **{**given, "speed": 0.0}).pressure, rel=0.01)


def test_causes_superpose() -> None:
    base = fit(BEARING, "inner", interference=3e-5)
    spun = fit(BEARING, "inner", interference=3e-5, speed=1500.0)
    warm = fit(BEARING, "inner", interference=3e-5, temperature_rise=(30.0, 20.0))
    all_of_it = fit(BEARING, "inner", interference=3e-5, speed=1500.0, temperature_rise=(30.0, 20.0))
    for name in ("interference", "pressure", "raceway_change"):
        whole = sum(getattr(case, name) for case in (spun, warm)) - getattr(base, name)
        assert getattr(all_of_it, name) == pytest.approx(whole, rel=1e-9)
    assert base.interference - warm.interference == pytest.approx(12e-6 * 10.0 * 0.05, rel=1e-9)
    even = fit(BEARING, "inner", interference=3e-5, temperature_rise=50.0)
    assert even.pressure == pytest.approx(base.pressure, rel=1e-9)
    growth = 12e-6 * 50.0 * 2.0 * BEARING.bottom("inner")
    assert even.raceway_change - base.raceway_change == pytest.approx(growth, rel=1e-9)


def test_operating_clearance() -> None:
    inner = fit(BEARING, "inner", interference=2e-5, temperature_rise=30.0)
    outer = fit(BEARING, "outer", interference=-1e-5, temperature_rise=20.0)
    assert outer.pressure == 0.0 and outer.interference == pytest.approx(-1e-5)
    found = operating_clearance(BEARING, inner, outer, temperature_rise=25.0)
    expected = 40e-6 - inner.raceway_change + outer.raceway_change - 2.0 * 12e-6 * 25.0 * 0.01
    assert found == pytest.approx(expected, rel=1e-12)
    assert operating_clearance(BEARING) == 40e-6
    # as warm as each other, all dimensions grow alike, and so does the clearance
    rings = [fit(BEARING, side, interference=-1e-5, temperature_rise=50.0) for side in ("inner", "outer")]
    assert operating_clearance(BEARING, *rings, temperature_rise=50.0) == pytest.approx(40e-6 * (1.0 + 6e-4), rel=1e-9)
    angular = catalogue("7210 B")
    ring = fit(angular, "inner", interference=1e-5)
    expected = -ring.raceway_change - 2.0 * 12e-6 * 30.0 * angular.diameter / np.cos(np.radians(40.0))
    assert operating_clearance(angular, ring, temperature_rise=30.0) == pytest.approx(expected, rel=1e-12)


def test_rings_that_come_loose_or_burst_are_named() -> None:
    with pytest.raises(InputError, match=r"comes loose from the shaft.*a speed below (\d+) rad/s") as caught:
        fit(BEARING, "inner", interference=1e-5, speed=8000.0)
    last = float(str(caught.value).rpartition("below ")[2].split()[0])
    assert fit(BEARING, "inner", interference=1e-5, speed=0.999 * last).pressure > 0.0
    with pytest.raises(InputError, match="comes loose"):
        fit(BEARING, "inner", interference=1e-5, speed=1.001 * last)
    with pytest.raises(InputError, match=r"from the housing.*temperatures 2.97e-05 m; use more interference, above"):
        fit(
            BEARING, "outer", interference=2e-5, temperature_rise=30.0, expansion=(12e-6, LIGHT),
            material=(STEEL, ALUMINIUM),
        )  # fmt: skip
    stress = fit(BEARING, "inner", interference=1e-4).hoop_stress
    assert fit(BEARING, "inner", interference=1e-4, yield_strength=1.001 * stress[0]).hoop_stress == stress
    with pytest.raises(InputError, match=r"hoop stress of the inner ring.*exceeds its yield strength.*at most 5e-05 m"):
        fit(BEARING, "inner", interference=1e-4, yield_strength=(0.5 * stress[0], None))
    with pytest.raises(InputError, match="use a lower speed"):
        fit(BEARING, "inner", interference=1e-3, speed=4000.0, yield_strength=50e6)
    with pytest.raises(InputError, match="hoop stress of the shaft"):
        fit(BEARING, "inner", interference=1e-4, yield_strength=(None, -0.999 * stress[1]))


def test_bad_input_is_named() -> None:
    balls = BallGeometry(elements=9, ball_diameter=0.0127, pitch_diameter=0.065)
    three: Any = (1e-5, 1e-5, 1e-5)
    for match, call in {
        "has no bore; give BallGeometry": lambda: fit(balls, "inner", interference=1e-5),
        "geometry must be": lambda: fit(three, "inner", interference=1e-5),
        "material must be": lambda: fit(BEARING, "inner", interference=1e-5, material=three[:2]),
        "side must be": lambda: fit(BEARING, "left", interference=1e-5),
        "must ascend: bore of the shaft 0.06 m": lambda: fit(BEARING, "inner", interference=1e-5, free_diameter=0.06),
        "outside of the housing 0.08 m": lambda: fit(BEARING, "outer", interference=1e-5, free_diameter=0.08),
        "massive housing does not rotate": lambda: fit(BEARING, "outer", interference=1e-5, speed=10.0),
        r"\(ring, seat\), got 3": lambda: fit(BEARING, "inner", interference=1e-5, expansion=three),
        "no diametral clearance": lambda: fit(catalogue("81110"), "inner", interference=1e-5),
        "got the fit of the outer ring": lambda: operating_clearance(BEARING, Fit("outer", 0.0, 0.0, 0.0, (0.0, 0.0))),
    }.items():
        with pytest.raises(InputError, match=match):
            call()
