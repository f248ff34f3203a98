"""Flow factors of rough walls compared with limits, bounds and theory that they must obey, and their table."""

from __future__ import annotations

import re
from typing import Any

import numpy as np
import pytest
from scipy.integrate import quad
from scipy.interpolate import CubicHermiteSpline

from warpffrf.model.errors import InputError
from warpffrf.model.films import Roughness
from warpffrf.model.films import roughness as rough

DEVIATION = 0.8e-6
PATTERNS = [float(gamma) for gamma in rough.PATTERNS]


def height_density(x: Any) -> Any:
    """Of heights in deviations, within three of them, much as the Gaussian."""
    return 35.0 / 96.0 * (1.0 - (x / 3.0) ** 2) ** 3


def mean_of_gap(power: float, H: float) -> float:
    """E[(1 + x/H)^power]."""
    value: Any = quad(lambda x: height_density(x) * (1.0 + x / H) ** power, -3.0, 3.0, epsrel=1e-10, limit=200)
    return float(value[0])


@pytest.mark.parametrize("pattern", PATTERNS)
def test_thick_films_have_smooth_walls(pattern: float) -> None:
    """phi_p and Phi go to one, the lag to nothing; and the last line of the table is that."""
    wall, gap = Roughness(DEVIATION, pattern), DEVIATION * np.array([20.0, 50.0, 500.0])
    found = rough.flow_factors(wall, None, gap)
    for values, bound in ((found.flow - 1.0, [0.01, 3e-3, 1e-4]), (found.drag - 1.0, [0.006, 1e-3, 1e-5])):
        assert np.all(np.abs(values) < np.array(bound)[:, None])
    assert np.all(np.abs(found.lag) < DEVIATION * np.array([0.015, 1e-5, 1e-12])[:, None])
    table = rough.factor_table(wall, None)
    np.testing.assert_array_equal(table[-1, 1:], [1, 0, 1, 0, 0, 0, 0, 0, 1, 0, 1, 0])


@pytest.mark.parametrize("pattern", PATTERNS)
def test_flows_lie_between_ridges_across_and_along(pattern: float) -> None:
    """Ridges along the flow have E[h^3], in series 1/E[h^-3]: no pattern conducts more, or less."""
    for H in (3.5, 4.0, 5.0, 7.0):
        flow = rough.of_pressure(np.array([H]), pattern)[0]
        assert 1.0 / mean_of_gap(-3.0, H) < flow < mean_of_gap(3.0, H)


@pytest.mark.parametrize("pattern", PATTERNS)
def test_weak_roughness_is_that_of_second_order(pattern: float) -> None:
    """phi_p = 1 + 3 (1 - 3/(1 + gamma))/H^2, Phi_s = 3/((1 + gamma) H), Phi_fs = 3/((1 + gamma) H^2) (Tripp, J. Lubr.
    Tech. 105, 1983), which the fits to simulations come near, five deviations apart."""
    H = np.array([5.0])
    assert abs(rough.of_pressure(H, pattern)[0] - (1.0 + 3.0 * (1.0 - 3.0 / (1.0 + pattern)) / 25.0)) < 0.03
    assert abs(rough.of_sliding(H, pattern)[0] - 0.6 / (1.0 + pattern)) < 0.05
    assert abs(rough.of_flanks(H, pattern)[0] - 3.0 / 25.0 / (1.0 + pattern)) < 0.03


@pytest.mark.parametrize("pattern", PATTERNS)
def test_fits_meet_where_they_change(pattern: float) -> None:
    """Phi_s at H = 5, within the digits of its coefficients; and no lag is larger than the gap."""
    below, above = rough.of_sliding(np.array([5.0, 5.0 + 1e-9]), pattern)
    assert above == pytest.approx(below, rel=0.01)
    H = np.geomspace(1e-3, 50.0, 400)
    assert np.all(rough.of_sliding(H, pattern) < H)
    assert np.all(rough.of_pressure(H, pattern) > 0.0)
    assert np.all(rough.of_flanks(H, pattern) >= 0.0)


def test_the_shear_of_sliding_is_the_mean_of_one_over_the_gap() -> None:
    """Of the density of the paper, cut where 1/100 of a deviation is left, which its closed form has to first order."""
    for H in (0.3, 1.0, 2.0, 2.9, 3.2, 6.0, 20.0, 29.0, 31.0, 100.0):
        low = max(-3.0, rough.CUT - H)
        exact: Any = quad(lambda x, H=H: height_density(x) * H / (H + x), low, 3.0, epsrel=1e-10, limit=400)
        assert rough.shear_of_sliding(np.array([H]))[0] == pytest.approx(exact[0], rel=2.5e-3 if H < 3.0 else 1e-7)


def test_the_shear_by_pressure_is_that_of_the_paper() -> None:
    """1 - l/h of a rough wall opposite a smooth one, by reciprocity, compared with the fit 1 - 1.4 exp(-0.66 H) to its
    own simulations."""
    H = np.linspace(2.0, 10.0, 33)
    lag = rough.flow_factors(Roughness(DEVIATION), None, DEVIATION * H).lag[:, 0]
    assert np.abs(1.0 - lag / (DEVIATION * H) - (1.0 - 1.4 * np.exp(-0.66 * H))).max() < 0.02


def test_two_walls() -> None:
    """Alike: no lag, and the factors of their sum; exchanged: the opposite lag; rotated by 90 degrees: directions
    exchanged."""
    gap = DEVIATION * np.array([0.3, 1.0, 3.0, 8.0])
    part = DEVIATION / np.sqrt(2.0)
    both = rough.flow_factors(Roughness(part, 3.0), Roughness(part, 3.0), gap)
    one = rough.flow_factors(Roughness(DEVIATION, 3.0), None, gap)
    np.testing.assert_allclose(both.flow, one.flow, rtol=1e-12)
    np.testing.assert_allclose(both.drag, one.drag, rtol=1e-12)
    assert np.abs(both.lag).max() < 1e-12 * DEVIATION
    first, second = Roughness(0.5e-6, 1 / 6), Roughness(0.3e-6, 3.0)
    found, other = rough.flow_factors(first, second, gap), rough.flow_factors(second, first, gap)
    np.testing.assert_allclose(found.lag, -other.lag, rtol=1e-12)
    np.testing.assert_allclose(found.flow, other.flow, rtol=1e-12)
    turned = rough.flow_factors(Roughness(DEVIATION, 1 / 3), None, gap)
    np.testing.assert_allclose(turned.flow, one.flow[:, ::-1], rtol=1e-12)
    np.testing.assert_allclose(turned.lag, one.lag[:, ::-1], rtol=1e-12)
    between = rough.of_pressure(np.array([2.0]), 2.0)[0]
    assert between == pytest.approx(
        np.interp(np.log(2.0), [0.0, np.log(3.0)], [rough.of_pressure(np.array([2.0]), g)[0] for g in (1.0, 3.0)])
    )
    assert rough.least_gap(Roughness(DEVIATION), None) == 0.5 * DEVIATION
    assert rough.least_gap(Roughness(DEVIATION, 9.0), None) == DEVIATION  # along it is 1/9


def test_the_table_is_as_near_as_it_says() -> None:
    """Cubics between its lines: 2e-5 away from kinks, which are rounded, and 4e-3 there."""
    first, second = Roughness(1e-6, 1 / 3), Roughness(0.5e-6, 6.0)
    s, table = rough.summed_deviation(first, second), rough.factor_table(first, second)
    H = np.geomspace(2e-3, 900.0, 20_001)
    exact = rough.flow_factors(first, second, s * H)
    kinks = np.array([0.5, 0.75, 1.0, 5.0, 7.0])
    smooth = np.all(np.abs(np.log(H[:, None] / kinks)) > 0.08, axis=1)
    for k, values in enumerate((exact.flow, exact.lag / s, exact.drag)):
        for c in (0, 1):
            column = 1 + 4 * k + 2 * c
            found = CubicHermiteSpline(table[:, 0], table[:, column], table[:, column + 1])(s * H)
            error = np.abs(found / (s if k == 1 else 1.0) - values[:, c])
            assert error.max() < 4e-3
            assert error[smooth].max() < 2e-5


@pytest.mark.parametrize(
    ("given", "message"),
    [
        ({"deviation": 0.0}, "films.Roughness: deviation [m] must be greater than zero"),
        (
            {"deviation": 1e-6, "pattern": 0.05},
            "pattern must lie from 1/9 to 9, where flow factors are known, got 0.05",
        ),
        ({"deviation": 1e-6, "pattern": 10.0}, "pattern must lie from 1/9 to 9"),
        ({"deviation": "1e-6"}, "films.Roughness: deviation [m] must be a number"),
    ],
)
def test_what_is_refused(given: dict[str, Any], message: str) -> None:
    with pytest.raises(InputError, match=re.escape(message)):
        Roughness(**given)
