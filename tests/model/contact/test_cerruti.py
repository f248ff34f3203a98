"""Integrals over rectangles of what forces along a surface displace, compared with quadrature."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
import pytest

from warpffrf.model.half_space import across, along_x, along_z, rectangle, toward_x, toward_z

WIDTH, LENGTH = 0.7, 1.9
PLACES = ((2.1, 0.4), (-1.3, -2.2), (0.9, -0.3), (-0.5, 1.4))  # outside the rectangle
QUADRATURE = 1e-9  # 40 Gauss points a direction, at an eighth of the width from the nearest side


def quadrature(kernel: Callable[[np.ndarray, np.ndarray], np.ndarray], x: float, z: float) -> float:
    """Integral of `kernel` of the way from the places of the rectangle to (x, z)."""
    p, w = np.polynomial.legendre.leggauss(40)
    a, b = 0.5 * WIDTH * p, 0.5 * LENGTH * p
    weight = np.outer(0.5 * WIDTH * w, 0.5 * LENGTH * w)
    return float(np.sum(weight * kernel(x - a[:, None], z - b[None, :])))


@pytest.mark.parametrize(
    ("integral", "kernel"),
    [
        (rectangle, lambda x, z: 1.0 / np.hypot(x, z)),
        (along_x, lambda x, z: x**2 / np.hypot(x, z) ** 3),
        (along_z, lambda x, z: z**2 / np.hypot(x, z) ** 3),
        (across, lambda x, z: x * z / np.hypot(x, z) ** 3),
        (toward_x, lambda x, z: x / np.hypot(x, z) ** 2),
        (toward_z, lambda x, z: z / np.hypot(x, z) ** 2),
    ],
)
def test_integrals_are_those_of_quadrature(integral: Callable, kernel: Callable) -> None:
    for x, z in PLACES:
        expected = quadrature(kernel, x, z)
        assert float(integral(x, z, WIDTH, LENGTH)) == pytest.approx(expected, rel=QUADRATURE, abs=QUADRATURE)


def test_the_parts_of_a_square_add_up_and_vanish_by_symmetry() -> None:
    zero = np.zeros(1)
    both = along_x(zero, zero, WIDTH, LENGTH) + along_z(zero, zero, WIDTH, LENGTH)
    assert both == pytest.approx(rectangle(zero, zero, WIDTH, LENGTH), rel=1e-14)
    for odd in (across, toward_x, toward_z):
        assert abs(float(odd(zero, zero, WIDTH, LENGTH)[0])) < 1e-14
