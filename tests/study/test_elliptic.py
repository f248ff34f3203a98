"""Hertz's elliptic contact against the sphere, quadrature of its integrals, and the published table of its shape."""

from __future__ import annotations

import numpy as np
import pytest
from scipy.integrate import quad

from references.closed_forms import PointContact
from references.closed_forms.elliptic import EllipticContact

LOAD, MODULUS = 300.0, 1.1e11


def test_equal_radii_are_a_sphere() -> None:
    found, sphere = EllipticContact(LOAD, 0.01, 0.01, MODULUS), PointContact(LOAD, 0.01, MODULUS)
    assert found.half_axes == pytest.approx((sphere.half_width, sphere.half_width), rel=1e-12)
    assert found.peak_pressure == pytest.approx(sphere.peak_pressure, rel=1e-12)
    assert found.approach == pytest.approx(sphere.approach, rel=1e-12)


@pytest.mark.parametrize("long", [0.02, 0.1, 5.0])
def test_the_pressure_closes_the_gap(long: float) -> None:
    """Displacements by quadrature of the integrals over the angle that Johnson's are transformed from: with
    w = a^2 tan^2(t) the roots leave."""
    found = EllipticContact(LOAD, 0.01, long, MODULUS)
    a, b = found.half_axes
    p0 = found.peak_pressure

    def integral(f) -> float:
        # int_0^oo f(w) dw/sqrt((a^2 + w)(b^2 + w) w), w = b^2 tan^2(t)
        def of_angle(t: float) -> float:
            w = (b * np.tan(t)) ** 2
            return f(w) * 2.0 / (np.cos(t) * np.sqrt(a * a + w))

        return float(quad(of_angle, 0.0, 0.5 * np.pi, limit=400, epsabs=0.0, epsrel=1e-10)[0])

    scale = 0.5 * p0 * a * b / MODULUS
    assert scale * integral(lambda w: 1.0 / (a * a + w)) == pytest.approx(0.5 / 0.01, rel=1e-8)
    assert scale * integral(lambda w: 1.0 / (b * b + w)) == pytest.approx(0.5 / long, rel=1e-8)
    assert scale * integral(lambda w: 1.0) == pytest.approx(found.approach, rel=1e-8)
    assert found.load == pytest.approx(2.0 / 3.0 * np.pi * a * b * p0)


def test_axes_change_places_with_the_radii() -> None:
    one, other = EllipticContact(LOAD, 0.01, 0.2, MODULUS), EllipticContact(LOAD, 0.2, 0.01, MODULUS)
    assert one.half_axes == pytest.approx(other.half_axes[::-1], rel=1e-12)
    assert one.approach == pytest.approx(other.approach, rel=1e-12)


def test_the_shape_is_nearly_a_power_of_the_ratio() -> None:
    """b/a = (R_y/R_x)^(2/3) to a few per cent (Johnson, section 4.2) up to ratios of 5."""
    for ratio in (1.5, 3.0, 5.0):
        found = EllipticContact(LOAD, 0.01, 0.01 * ratio, MODULUS)
        assert found.ratio == pytest.approx(ratio ** (2.0 / 3.0), rel=0.03)


def test_the_pressure_carries_the_load() -> None:
    found = EllipticContact(LOAD, 0.01, 0.1, MODULUS)
    a, b = found.half_axes
    x, y = np.linspace(-a, a, 401), np.linspace(-b, b, 401)
    p = found.pressure(x[:, None], y)
    assert p.sum() * (x[1] - x[0]) * (y[1] - y[0]) == pytest.approx(LOAD, rel=1e-3)
