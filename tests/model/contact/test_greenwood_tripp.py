"""The law of Greenwood and Tripp compared with its own integrals, how near its table is, and what is refused."""

from __future__ import annotations

import re
from collections.abc import Callable
from typing import Any

import numpy as np
import pytest
from scipy.integrate import dblquad, quad

from warpffrf.model import laws
from warpffrf.model.errors import InputError
from warpffrf.model.laws.greenwood_tripp import DEEPEST, END, NEGLIGIBLE, gaussian_overlap

DEVIATION, DENSITY, RADIUS, MODULUS = 0.5e-6, 2e9, 50e-6, 115e9
LAW = laws.GreenwoodTripp(DEVIATION, DENSITY, RADIUS, MODULUS)
NEAR, STEEP = 4e-5, 0.01  # of pressures and slopes: what the straight pieces leave


def density_of(v: float) -> float:
    """Of heights in deviations."""
    return float(np.exp(-0.5 * v**2) / np.sqrt(2.0 * np.pi))


@pytest.mark.parametrize("power", [2, 4, 6])
def test_the_integral_is_that_of_adaptive_quadrature(power: int) -> None:
    n = 0.5 * (power - 1)
    for u in (-4.0, -1.0, 0.0, 1.0, 3.0, 6.0):
        top = max(u, 0.0) + 12.0
        exact = quad(lambda v, u=u: (v - u) ** n * density_of(v), u, top, epsabs=0.0, epsrel=1e-12)[0]
        assert float(gaussian_overlap(u, power)) == pytest.approx(exact, rel=1e-9)  # of quad, with a root at its end
    assert float(gaussian_overlap(0.0)) == pytest.approx(0.6166, abs=5e-5)  # as the paper has it


def test_its_derivatives_are_integrals_of_lower_powers() -> None:
    """F_n' = -n F_(n-1); and by parts, F_n = -u F_(n-1) + (n - 1) F_(n-2), which needs no derivative."""
    u, d = np.linspace(-3.5, 5.0, 35), 1e-5
    F52, F32, F12 = (gaussian_overlap(u, power) for power in (6, 4, 2))
    slope = (gaussian_overlap(u + d) - gaussian_overlap(u - d)) / (2.0 * d)
    np.testing.assert_allclose(slope, -2.5 * F32, rtol=1e-7)
    np.testing.assert_allclose(F52, 1.5 * F12 - u * F32, rtol=1e-9)


@pytest.mark.parametrize("gap", [0.2e-6, 1.0e-6])
def test_the_pressure_is_that_of_pairs_of_asperities(gap: float) -> None:
    """Hertz's force of two that overlap by w, over the distance of neighbours and over heights."""

    def of_pairs(r: float, v: float) -> float:
        w = DEVIATION * v - gap - r**2 / (4.0 * RADIUS)
        force = 4.0 / 3.0 * MODULUS * np.sqrt(0.5 * RADIUS) * max(w, 0.0) ** 1.5
        return DENSITY**2 * force * 2.0 * np.pi * r * density_of(v)

    found = dblquad(
        of_pairs, gap / DEVIATION, gap / DEVIATION + 8.0, 0.0,
        lambda v: np.sqrt(4.0 * RADIUS * max(DEVIATION * v - gap, 0.0)), epsabs=0.0, epsrel=1e-9,
    )[0]  # fmt: skip
    shift = LAW.scale * float(gaussian_overlap(END))
    assert float(LAW.pressure(gap)) + shift == pytest.approx(found, rel=NEAR)


def test_the_table_is_as_near_as_it_says() -> None:
    """Pressure compared with the integral less what is cut, slopes, and where it ends."""
    u = np.linspace(-DEEPEST, END - 1e-3, 30_001)
    whole = LAW.scale * gaussian_overlap(u)
    exact = whole - LAW.scale * gaussian_overlap(END)
    assert np.abs(LAW.pressure(DEVIATION * u) - exact).max() > 0.0
    assert np.abs((LAW.pressure(DEVIATION * u) - exact) / whole).max() < NEAR
    slope = 2.5 * LAW.scale / DEVIATION * gaussian_overlap(u, 4)
    assert np.abs(LAW.curve.slope(-DEVIATION * u) / slope - 1.0).max() < STEEP
    assert float(gaussian_overlap(END) / gaussian_overlap(0.0)) == pytest.approx(NEGLIGIBLE, rel=1e-3)
    assert LAW.curve.convex and LAW.curve.begins == pytest.approx(-LAW.end)
    assert LAW.remark == "the pressure of its greenwood_tripp ends at 2.14e-06 m, 4.28 deviations of the roughness"
    cut = laws.GreenwoodTripp(DEVIATION, DENSITY, RADIUS, MODULUS, cut=3.0 * DEVIATION)
    assert cut.end == 3.0 * DEVIATION and float(cut.pressure(3.0 * DEVIATION)) == 0.0
    less = LAW.scale * float(gaussian_overlap(3.0))
    assert float(cut.pressure(0.0)) == pytest.approx(LAW.scale * 0.6166342 - less, rel=NEAR)


def test_products_are_another_way_to_say_it() -> None:
    found = laws.GreenwoodTripp.from_products(DEVIATION, DENSITY * RADIUS * DEVIATION, DEVIATION / RADIUS, MODULUS)
    for name in ("deviation", "density", "radius", "modulus"):
        assert getattr(found, name) == pytest.approx(getattr(LAW, name), rel=1e-14)
    crowding, steepness = 0.05, 0.01
    scale = 16.0 * np.sqrt(2.0) * np.pi / 15.0 * crowding**2 * np.sqrt(steepness) * MODULUS
    assert found.scale == pytest.approx(scale, rel=1e-12)


REFUSED: list[tuple[Callable[[], Any], str]] = [
    (lambda: laws.GreenwoodTripp(0.0, 1e9, 5e-5, 1e11), "deviation [m] must be greater than zero"),
    (lambda: laws.GreenwoodTripp(1e-6, -1e9, 5e-5, 1e11), "density [1/m^2] must be greater than zero"),
    (lambda: laws.GreenwoodTripp(1e-6, 1e9, float("nan"), 1e11), "radius [m] must be finite"),
    (lambda: laws.GreenwoodTripp(1e-6, 1e9, 5e-5, 0.0), "modulus [Pa] must be greater than zero"),
    (lambda: laws.GreenwoodTripp(1e-6, 1e9, 5e-5, 1e11, cut=-1e-6), "cut [m] must be greater than zero"),
    (lambda: laws.GreenwoodTripp(1e-6, 1e9, 5e-5, 1e11, cut=1e-3), "at most 10 deviations, got 1000; leave it out"),
    (lambda: laws.GreenwoodTripp.from_products(1e-6, 0.0, 1e-2, 1e11), "crowding, density times radius times"),
    (lambda: laws.GreenwoodTripp.from_products(1e-6, 0.05, 0.0, 1e11), "steepness, deviation over radius"),
]


@pytest.mark.parametrize("index", range(len(REFUSED)))
def test_what_is_refused(index: int) -> None:
    make, message = REFUSED[index]
    with pytest.raises(InputError, match="GreenwoodTripp: .*" + re.escape(message)):
        make()
