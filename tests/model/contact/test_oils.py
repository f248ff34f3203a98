"""Viscosity and density of oils: limits, derivatives, points that laws go through."""

from __future__ import annotations

import numpy as np
import pytest

from warpffrf.model import oils
from warpffrf.model.errors import InputError
from warpffrf.model.oils import POLE_PRESSURE, POLE_VISCOSITY

ROUND_OFF = 1e-12
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
        (lambda: oils.as_oil(0.04, "film 'bearing'"), "film 'bearing': oil must be one of oils.Newtonian"),
    ],
)  # fmt: skip
def test_what_is_no_oil_is_named(make, words: str) -> None:
    with pytest.raises(InputError, match=words):
        make()
