r"""Hertz's contact of an elliptic patch (K. L. Johnson, Contact Mechanics, 1985, sections 3.5 and 4.1).

The pressure p0 sqrt(1 - x^2/a^2 - y^2/b^2) displaces the surface of a half-space by (L - M x^2 - N y^2)/(pi E*), with
integrals that are Carlson's R_D and R_F:

    M = (pi p0 a b/2) int_0^oo dw/((a^2 + w) sqrt((a^2 + w)(b^2 + w) w)) = (pi p0 a b/3) R_D(0, b^2, a^2),
    N = (pi p0 a b/3) R_D(0, a^2, b^2),      L = pi p0 a b R_F(0, a^2, b^2).

The gap x^2/(2 R_x) + y^2/(2 R_y) - delta vanishes if M/(pi E*) = 1/(2 R_x), N/(pi E*) = 1/(2 R_y):

    R_D(0, 1, k^2)/R_D(0, k^2, 1) = R_x/R_y,  k = b/a;      P = (2/3) pi a b p0;
    a^3 = P R_x R_D(0, k^2, 1)/(pi E*),       delta = (3 P/(2 pi E* a)) R_F(0, 1, k^2).

R_D is homogeneous of degree -3/2, R_F of -1/2. A sphere has k = 1, R_D(0, 1, 1) = 3 pi/4: a^3 = 3 P R/(4 E*).
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property
from typing import Any

import numpy as np
from scipy.optimize import brentq
from scipy.special import elliprd, elliprf

LONGEST = 1e4  # upper limit of the ratio of the half-axes


@dataclass(frozen=True)
class EllipticContact:
    """load P [N], relative radii of curvature R_x, R_y [m] along the principal axes, modulus E* [Pa]."""

    load: float
    radius_x: float
    radius_y: float
    modulus: float

    @cached_property
    def ratio(self) -> float:
        """k = b/a, the half-axis along y over that along x."""
        wanted = np.log(self.radius_x / self.radius_y)

        def excess(log_k: float) -> float:
            k2 = np.exp(2.0 * log_k)
            return float(np.log(elliprd(0.0, 1.0, k2) / elliprd(0.0, k2, 1.0)) - wanted)

        most = float(np.log(LONGEST))
        root: Any = brentq(excess, -most, most, xtol=1e-14)
        return float(np.exp(root))

    @property
    def half_axes(self) -> tuple[float, float]:
        """a along x and b along y [m]."""
        a = float(np.cbrt(self.load * self.radius_x * elliprd(0.0, self.ratio**2, 1.0) / (np.pi * self.modulus)))
        return a, self.ratio * a

    @property
    def peak_pressure(self) -> float:
        """p0 [Pa]."""
        a, b = self.half_axes
        return 1.5 * self.load / (np.pi * a * b)

    @property
    def approach(self) -> float:
        """delta [m] of distant points."""
        a, _ = self.half_axes
        return float(1.5 * self.load * elliprf(0.0, 1.0, self.ratio**2) / (np.pi * self.modulus * a))

    def pressure(self, x: np.ndarray, y: np.ndarray) -> np.ndarray:
        """p [Pa] at x, y [m] from the middle."""
        a, b = self.half_axes
        return self.peak_pressure * np.sqrt(np.maximum(1.0 - (np.asarray(x) / a) ** 2 - (np.asarray(y) / b) ** 2, 0.0))
