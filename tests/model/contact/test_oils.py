"""Viscosity and density of oils: limits, derivatives, points that laws go through."""

from __future__ import annotations

from dataclasses import replace
from typing import Any

import numpy as np
import pytest

from warpffrf.model import oils
from warpffrf.model.errors import InputError
from warpffrf.model.oils import POLE_PRESSURE, POLE_VISCOSITY

ROUND_OFF = 1e-12
ROUNDED = 1e-4  # constants of a source: 9.67 is -ln(6.315e-5 Pa s) to 2e-6, times an exponent of some tens
DIFFERENCE = 1e-7  # relative, of central differences over 1e-4 of the scale: their next term is 1e-8 of the derivative
PRESSURES = np.array([0.0, 1e6, 5e7, 4e8])
ALPHA = 2e-8
EXAMPLES = [
    oils.Newtonian(0.04),
    oils.Barus(0.04, coefficient=ALPHA, density=oils.DowsonHigginson()),
    oils.Roelands(0.04, coefficient=ALPHA),
]


@pytest.mark.parametrize("oil", EXAMPLES, ids=lambda oil: oil.kind)
def test_slopes_are_derivatives(oil: oils.Oil) -> None:
    step = 1e4
    for value, slope in ((oil.viscosity_at, oil.viscosity_slope), (oil.density_at, oil.density_slope)):
        by_difference = (value(PRESSURES + step) - value(PRESSURES - step)) / (2.0 * step)
        assert np.allclose(slope(PRESSURES), by_difference, rtol=DIFFERENCE, atol=1e-9 * ALPHA)
        assert slope(PRESSURES).shape == value(PRESSURES).shape == PRESSURES.shape


@pytest.mark.parametrize("oil", EXAMPLES, ids=lambda oil: oil.kind)
def test_at_zero_pressure_it_is_what_was_given(oil: oils.Oil) -> None:
    assert oil.viscosity_at(0.0) == pytest.approx(oil.viscosity, rel=ROUND_OFF)
    assert oil.density_at(0.0) == 1.0


def test_roelands_begins_as_barus_and_rises_less() -> None:
    barus, roelands = EXAMPLES[1], EXAMPLES[2]
    assert roelands.viscosity_slope(0.0) == pytest.approx(barus.viscosity_slope(0.0), rel=ROUND_OFF)
    assert roelands.viscosity_at(5e8) < 0.2 * barus.viscosity_at(5e8)
    assert roelands.viscosity_at(-POLE_PRESSURE) == pytest.approx(POLE_VISCOSITY, rel=ROUND_OFF)


def test_density_stays_below_its_limit() -> None:
    law = oils.DowsonHigginson()
    assert law.ratio(1e13) == pytest.approx(1.0 + 0.6 / 1.7, rel=1e-4)  # 1/(b p)
    assert law.ratio(1e9) == pytest.approx(1.0 + 0.6 / 2.7, rel=ROUND_OFF)


def test_walther_goes_through_its_points_and_between() -> None:
    points = [(40.0, 46e-6), (100.0, 6.8e-6)]
    for temperature, nu in points:
        assert oils.walther(temperature, points=points, density=870.0) == pytest.approx(870.0 * nu, rel=ROUND_OFF)
    assert 870.0 * 6.8e-6 < oils.walther(70.0, points=points, density=870.0) < 870.0 * 46e-6


def test_iso_grades_are_those_at_forty_degrees_and_known_oils_at_a_hundred() -> None:
    """Kinematic viscosities at 100 degrees that data sheets of mineral oils of viscosity index about 95 state [mm2/s];
    their density falls by 4 % on the way, which the kinematic ones here leave out."""
    for grade, at_100 in ((32, 5.4), (46, 6.8), (100, 11.1), (220, 18.8)):
        forty, hundred = (oils.iso_vg(grade, temperature=T).viscosity / 880.0 * 1e6 for T in (40.0, 100.0))
        assert forty == pytest.approx(grade, rel=ROUND_OFF)
        assert hundred == pytest.approx(at_100, rel=0.08)
        measured = oils.iso_vg(grade, temperature=70.0, at_100=hundred * 1e-6)
        assert measured.viscosity == pytest.approx(oils.iso_vg(grade, temperature=70.0).viscosity, rel=0.03)


def test_vogel() -> None:
    assert oils.vogel(40.0, a=1e-4, b=800.0, c=95.0) == pytest.approx(1e-4 * np.exp(800.0 / 135.0), rel=ROUND_OFF)


WARM: dict[str, Any] = dict(heat_capacity=2000.0, conductivity=0.13, density=870.0, expansion=7e-4)
POINTS = [(40.0, 46e-6), (100.0, 6.8e-6)]
LAWS = [oils.VogelLaw(870.0, 95.0), oils.WaltherLaw(POINTS), oils.RoelandsLaw(1.2), oils.ExponentialLaw(0.03)]


def warm(law: oils.ThermalLaw, oil: oils.Oil) -> Any:
    return replace(oil, thermal=oils.Thermal(law, 40.0, **WARM))


@pytest.mark.parametrize("oil", EXAMPLES, ids=lambda oil: oil.kind)
@pytest.mark.parametrize("law", LAWS, ids=lambda law: law.kind)
def test_an_oil_at_another_temperature_is_the_same_oil(law: oils.ThermalLaw, oil: Any) -> None:
    """Over a third temperature it comes to where the direct way leads, and back again; viscosity and density fall."""
    oil = warm(law, oil)
    there = oil.at(80.0)
    assert there.viscosity_at(0.0) < 0.5 * oil.viscosity_at(0.0)
    for found in (oil.at(60.0).at(80.0), oil.at(80.0).at(40.0).at(80.0)):
        assert np.allclose(found.viscosity_at(PRESSURES), there.viscosity_at(PRESSURES), rtol=ROUND_OFF)
    assert oil.at(80.0).at(40.0).viscosity == pytest.approx(oil.viscosity, rel=ROUND_OFF)
    assert there.thermal.density == pytest.approx(870.0 * (1.0 - 7e-4 * 40.0), rel=ROUND_OFF)
    assert there.at(40.0).thermal.density == pytest.approx(870.0, rel=ROUND_OFF)


def test_laws_over_temperature_are_those_of_their_sources() -> None:
    """Roelands in his own form, with pressure and temperature together; Walther at its points, with the density."""
    oil = warm(LAWS[2], oils.Roelands(0.04, coefficient=ALPHA))
    b, z = np.log(0.04) + 9.67, oil.exponent
    for T, p in ((80.0, 0.0), (60.0, 3e8), (20.0, 1e8)):
        by_source = np.exp(b * ((T + 135.0) / 175.0) ** -1.2 * (1.0 + p / 196.2e6) ** z - 9.67)
        assert oil.at(T).viscosity_at(p) == pytest.approx(by_source, rel=ROUNDED)
    oil = warm(LAWS[1], oils.Newtonian(870.0 * 46e-6))
    assert oil.at(100.0).viscosity == pytest.approx(870.0 * (1.0 - 7e-4 * 60.0) * 6.8e-6, rel=ROUND_OFF)
    assert warm(LAWS[0], EXAMPLES[0]).at(90.0).viscosity == pytest.approx(
        oils.vogel(90.0, a=0.04 / np.exp(870.0 / 135.0), b=870.0, c=95.0), rel=ROUND_OFF
    )


def test_an_iso_grade_with_a_heat_capacity_is_that_grade_at_any_temperature() -> None:
    assert oils.iso_vg(32, temperature=40.0).thermal is None
    oil = oils.iso_vg(32, temperature=40.0, heat_capacity=2000.0)
    assert oil.at(70.0).viscosity == pytest.approx(oils.iso_vg(32, temperature=70.0).viscosity, rel=ROUND_OFF)
    measured = oils.iso_vg(32, temperature=40.0, at_100=5e-6, heat_capacity=2000.0, expansion=0.0)
    assert measured.at(100.0).viscosity == pytest.approx(880.0 * 5e-6, rel=ROUND_OFF)
    assert measured.describe()["thermal"]["law"]["points"] == ((40.0, 32e-6), (100.0, 5e-6))


@pytest.mark.parametrize(
    ("make", "words"),
    [
        (lambda: oils.Newtonian(-1.0), "viscosity"),
        (lambda: oils.Newtonian(46.0e3), "0.04 Pa s"),
        (lambda: oils.Barus(0.04, coefficient=-1e-8), "coefficient"),
        (lambda: oils.Barus(0.04, coefficient=1e-8, density="dowson"), "DowsonHigginson"),  # pyright: ignore[reportArgumentType]
        (lambda: oils.Roelands(5e-5, coefficient=1e-8), "Barus"),
        (lambda: oils.Roelands(0.04, coefficient=20.0), "exponent"),
        (lambda: oils.iso_vg(45, temperature=40.0), "known: 2, 3"),
        (lambda: oils.iso_vg(46, temperature=313.15), "kelvins"),
        (lambda: oils.walther(40.0, points=[(40.0, 46.0), (100.0, 6.8)], density=880.0), "46 mm2/s are 46e-6"),
        (lambda: oils.walther(40.0, points=[(40.0, 7e-6), (100.0, 46e-6)], density=880.0), "fall"),
        (lambda: oils.vogel(-50.0, a=1e-4, b=800.0, c=40.0), "above -c"),
        (lambda: oils.Newtonian(0.04).at(50.0), "oils.Newtonian: it is isothermal; give it thermal"),
        (lambda: oils.Newtonian(0.04, thermal="vogel"), "oils.Thermal"),  # pyright: ignore[reportArgumentType]
        (lambda: oils.Thermal("vogel", 40.0, 2000.0), "law must be one of oils.VogelLaw"),  # pyright: ignore[reportArgumentType]
        (lambda: oils.Thermal(LAWS[0], 40.0, 2.0), "mineral oils have about 2000"),
        (lambda: oils.Thermal(LAWS[0], 313.15, 2000.0), "kelvins"),
        (lambda: oils.Thermal(LAWS[0], 40.0, 2000.0, expansion=0.1), "no density"),
        (lambda: oils.VogelLaw(870.0, 50.0), "above 60 K"),
        (lambda: oils.as_oil(0.04, "film 'bearing'"), "film 'bearing': oil must be one of oils.Newtonian"),
    ],
)  # fmt: skip
def test_what_is_no_oil_is_named(make, words: str) -> None:
    with pytest.raises(InputError, match=words):
        make()
