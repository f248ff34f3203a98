"""Hertz's point contact against the potential of the ellipsoidal pressure, integrated numerically."""

from __future__ import annotations

import numpy as np
import pytest
from scipy.integrate import quad

from warpffrf.output.contact.hertz import conforms, half_axis_ratio, hertz_ellipse, hertz_line, hertz_point

MODULUS, LOAD = 1.1e11, 250.0


def potential(a: float, b: float, power: tuple[int, int]) -> float:
    """int_0^inf dw / ((a^2 + w)^i (b^2 + w)^j sqrt((a^2 + w)(b^2 + w) w)); w = s^2 takes the root away."""

    def integrand(t: float) -> float:
        s = b * t / (1.0 - t)
        w = s * s
        rest = (a * a + w) ** (power[0] + 0.5) * (b * b + w) ** (power[1] + 0.5)
        return 2.0 * b / (1.0 - t) ** 2 / rest

    return quad(integrand, 0.0, 1.0, epsabs=0.0, epsrel=1e-12, limit=400)[0]


@pytest.mark.parametrize("radii", [(0.02, 0.01), (0.5, 0.01), (0.0101, 0.01), (30.0, 0.01)])
def test_an_ellipse_carries_its_own_curvature(radii: tuple[float, float]) -> None:
    """The displacement p0 a b/(2 E*) int (1 - x^2/(a^2+w) - y^2/(b^2+w)) dw/sqrt(...) is delta - A x^2 - B y^2."""
    found = hertz_point(LOAD, np.diag([1.0 / radii[0], 1.0 / radii[1]]), MODULUS)
    a, b = found.semi_axes
    assert a > b and found.angle == pytest.approx(0.0, abs=1e-12)
    assert 2.0 / 3.0 * np.pi * a * b * found.peak_pressure == pytest.approx(LOAD, rel=1e-12)
    factor = found.peak_pressure * a * b / (2.0 * MODULUS)
    assert factor * potential(a, b, (0, 0)) == pytest.approx(found.approach, rel=1e-8)
    assert factor * potential(a, b, (1, 0)) == pytest.approx(0.5 / radii[0], rel=1e-7)
    assert factor * potential(a, b, (0, 1)) == pytest.approx(0.5 / radii[1], rel=1e-7)


def test_a_sphere() -> None:
    R = 0.01
    found = hertz_point(LOAD, np.eye(2) / R, MODULUS)
    a = np.cbrt(0.75 * LOAD * R / MODULUS)
    assert found.semi_axes == pytest.approx((a, a), rel=1e-14)
    assert found.approach == pytest.approx(a * a / R, rel=1e-12)
    assert found.half_width == pytest.approx(a) and found.section == pytest.approx(a)


def test_nearly_round_patches_go_over_into_round_ones() -> None:
    inside = [hertz_point(LOAD, np.diag([100.0, 100.0 * (1.0 + e)]), MODULUS).semi_axes[0] for e in (0.9e-6, 1.1e-6)]
    assert inside[0] == pytest.approx(inside[1], rel=1e-6)
    assert half_axis_ratio(1.0) == 1.0


def test_many_ellipses_at_once_are_single_ones() -> None:
    """Whichever of the curvatures is the larger one; without a load all is zero."""
    small, large, load = np.array([2.0, 80.0, 5.0]), np.array([90.0, 3.0, 5.0]), np.array([100.0, 200.0, 0.0])
    a, b, peak, approach = hertz_ellipse(load, small, large, MODULUS)
    for i in range(3):
        one = hertz_point(float(load[i]), np.diag([small[i], large[i]]), MODULUS)
        assert (a[i], b[i]) == pytest.approx((one.half_width, one.half_width_along), rel=1e-12)
        assert (peak[i], approach[i]) == pytest.approx((one.peak_pressure, one.approach), rel=1e-12)


def test_a_rotated_ellipse_has_its_extents() -> None:
    turn = 0.4
    c, s = np.cos(turn), np.sin(turn)
    axes = np.array([[c, -s], [s, c]])
    found = hertz_point(LOAD, axes @ np.diag([20.0, 100.0]) @ axes.T, MODULUS)
    assert found.angle == pytest.approx(turn)
    a, b = found.semi_axes
    t = np.linspace(0.0, 2.0 * np.pi, 100_001)
    rim = axes @ np.stack([a * np.cos(t), b * np.sin(t)])
    assert found.half_width == pytest.approx(rim[0].max(), rel=1e-8)
    assert found.half_width_along == pytest.approx(rim[1].max(), rel=1e-8)
    on_axis = rim[:, np.argmin(np.abs(rim[1]) + (rim[0] < 0.0))]
    assert found.section == pytest.approx(on_axis[0], rel=1e-3)


def test_a_long_ellipse_is_a_line() -> None:
    """Of a long ellipse the middle section is Hertz's line contact at the load per length found there."""
    found = hertz_point(LOAD, np.diag([1e-7 / 0.01, 1.0 / 0.01]), MODULUS)
    b = found.semi_axes[1]
    line = hertz_line(0.5 * np.pi * found.peak_pressure * b, 1.0 / 0.01, MODULUS)
    assert line.half_width == pytest.approx(b, rel=1e-3) and line.peak_pressure == pytest.approx(
        found.peak_pressure, rel=1e-3
    )


def test_no_load_and_conforming_patches() -> None:
    assert hertz_line(0.0, 100.0, MODULUS).peak_pressure == 0.0
    point = hertz_point(0.0, np.eye(2), MODULUS)
    assert point.semi_axes == (0.0, 0.0) and point.peak_pressure == 0.0 and point.section == 0.0
    assert conforms(3e-3, 1.0 / 0.01) and not conforms(1e-4, 1.0 / 0.01)
