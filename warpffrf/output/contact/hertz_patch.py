r"""Hertz's contact of two bodies that touch in a line or in a point, from relative curvatures and E*.

K. L. Johnson, Contact Mechanics, 1985, sections 4.1 and 4.2. Line, 1/R the relative curvature:

    a^2 = 4 P' R / (pi E*),      p0 = 2 P' / (pi a).

Point, with the relative principal curvatures `2A <= 2B`, semi-axes a >= b, m = e^2 = 1 - b^2/a^2, complete elliptic
integrals K(m), E(m), p = p0 sqrt(1 - x^2/a^2 - y^2/b^2), p0 = 3 P / (2 pi a b) (eq. 4.25 and 4.26):

    B/A = [E/(1 - m) - K] / [K - E],      a^3 = 3 P (K - E) / (2 pi E* m A),      delta = p0 b K / E*.

As m -> 0 (K - E)/m -> pi/4, which gives the sphere, a^3 = 3 P R/(4 E*). Hertz's theory asks for a patch much smaller
than the radii of both bodies; `conforms` says where it is not.
"""

from __future__ import annotations

from typing import Any, NamedTuple

import numpy as np

CONFORMAL = 0.25  # half-width over the smallest radius from which on Hertz's half-space no longer holds
ROUND = 1e-6  # B/A - 1 below which the patch is a circle (error of a 2e-7); the formulas lose 1e-16/m of their digits
LONGEST = 1e-12  # 1 - m of the longest ellipse looked for: b/a = 1e-6, far beyond any patch that ends on a surface


class HertzLine(NamedTuple):
    """Hertz's line contact at the line load found at mid-width."""

    half_width: float  # m
    peak_pressure: float  # Pa
    line_load: float  # N/m
    radius: float  # m, 1/(1/R1 + 1/R2) at mid-width
    modulus: float  # Pa, E*
    reason: str = ""  # why Hertz does not apply; the numbers are NaN then


class HertzPoint(NamedTuple):
    """Hertz's elliptical contact at the load found."""

    semi_axes: tuple[float, float]  # m, the larger one first
    angle: float  # rad, of the larger axis from e_theta of the first surface towards t_z
    peak_pressure: float  # Pa
    load: float  # N
    approach: float  # m, of distant points
    radii: tuple[float, float]  # m, 1/(2A) >= 1/(2B)
    modulus: float  # Pa, E*
    reason: str = ""  # why Hertz does not apply; the numbers are NaN then

    @property
    def half_width(self) -> float:
        """Half the side of the ellipse's bounding rectangle along e_theta [m]."""
        (a, b), c, s = self.semi_axes, np.cos(self.angle), np.sin(self.angle)
        return float(np.hypot(a * c, b * s))

    @property
    def half_width_along(self) -> float:
        """Half the side of the bounding rectangle along t_z [m]."""
        (a, b), c, s = self.semi_axes, np.cos(self.angle), np.sin(self.angle)
        return float(np.hypot(a * s, b * c))

    @property
    def section(self) -> float:
        """Half the length of the section through the centre along e_theta [m]; 0 without a load."""
        (a, b), c, s = self.semi_axes, np.cos(self.angle), np.sin(self.angle)
        return float(1.0 / np.hypot(c / a, s / b)) if a > 0.0 else 0.0

    @property
    def section_along(self) -> float:
        """Half the length of the section through the centre along t_z [m]; 0 without a load."""
        (a, b), c, s = self.semi_axes, np.cos(self.angle), np.sin(self.angle)
        return float(1.0 / np.hypot(s / a, c / b)) if a > 0.0 else 0.0


def hertz_line(line_load: float, curvature: float, modulus: float) -> HertzLine:
    """Line contact at `line_load` [N/m], relative `curvature` [1/m] and `modulus` E* [Pa]."""
    radius = 1.0 / curvature
    a = float(np.sqrt(4.0 * line_load * radius / (np.pi * modulus)))
    return HertzLine(a, 2.0 * line_load / (np.pi * a) if a > 0.0 else 0.0, line_load, radius, modulus)


def hertz_point(load: float, curvature: np.ndarray, modulus: float) -> HertzPoint:
    """Point contact at `load` [N], the relative curvature tensor (2, 2) [1/m] along (e_theta, t_z), `modulus` E* [Pa].

    Both principal curvatures must be positive.
    """
    from scipy.special import ellipe, ellipkm1

    values, axes = np.linalg.eigh(curvature)  # ascending: the larger semi-axis lies along the first
    A, B = 0.5 * float(values[0]), 0.5 * float(values[1])
    angle = float(np.arctan2(axes[1, 0], axes[0, 0]))
    angle -= float(np.pi * np.round(angle / np.pi))  # an axis has no sense
    m = eccentricity_squared(B / A)
    first, second = float(ellipkm1(1.0 - m)), float(ellipe(m))
    moment = 0.25 * np.pi if m == 0.0 else (first - second) / m
    a = float(np.cbrt(3.0 * load * moment / (2.0 * np.pi * modulus * A)))
    b = a * float(np.sqrt(1.0 - m))
    peak = 3.0 * load / (2.0 * np.pi * a * b) if load > 0.0 else 0.0
    return HertzPoint((a, b), angle, peak, load, peak * b * first / modulus, (0.5 / A, 0.5 / B), modulus)


def eccentricity_squared(ratio: float) -> float:
    """m = 1 - b^2/a^2 of the ellipse at the ratio B/A >= 1 of the relative curvatures."""
    from scipy.optimize import brentq
    from scipy.special import ellipe, ellipkm1

    if ratio - 1.0 < ROUND:
        return 0.0

    def excess(log_rest: float) -> float:
        rest = np.exp(log_rest)  # 1 - m
        first, second = ellipkm1(rest), ellipe(1.0 - rest)
        return float(np.log((second / rest - first) / (first - second)) - np.log(ratio))

    # 1 - m falls from 1 as the ratio grows; for a nearly round patch m = 4/3 (ratio - 1) to first order
    high = np.log1p(-min(0.5, 0.1 * (ratio - 1.0)))
    root: Any = brentq(excess, np.log(LONGEST), high, xtol=1e-15, rtol=np.float64(1e-14))
    return float(-np.expm1(root))


def conforms(half_width: float, curvature: float) -> bool:
    """True where a patch of this half-width [m] is not small beside the radius 1/|curvature| of a body."""
    return half_width * abs(curvature) > CONFORMAL
