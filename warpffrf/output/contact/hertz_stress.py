r"""Stress below the middle of Hertz's patch in closed form, and where it is largest.

A line of half-width a, t = z/a, in plane strain (K. L. Johnson, Contact Mechanics, 1985, eq. 4.46):

    sigma_x = p0 [2 t - (1 + 2 t^2)/w],      sigma_z = -p0/w,      sigma_y = nu (sigma_x + sigma_z),     w^2 = 1 + t^2.

The largest shear (sigma_x - sigma_z)/2 = p0 (t - t^2/w) is 0.300 p0 at 0.786 a, von Mises' stress at nu = 0.3 0.558 p0
at 0.704 a. An ellipse of semi-axes a > b, x along a, m = 1 - b^2/a^2, t = z/a = cot phi,
T^2 = (b^2 + z^2)/(a^2 + z^2), F and E the incomplete elliptic integrals of (phi, m) (H. R. Thomas and V. A. Hoersch,
Univ. of Illinois Bull. 212, 1930; Johnson eq. 4.28; tests/output holds them beside the half-space under Hertz's
pressure):

    sigma_x = c [-(1 - T)/2 + t (F - E)  + nu (1 - T a^2/b^2 + t (E a^2/b^2 - F))],             c = 2 p0 b/(m a),
    sigma_y = c [1/2 + 1/(2 T) - T a^2/b^2 + t (E a^2/b^2 - F)  + nu (T - 1 + t (F - E))],
    sigma_z = -c/2 (1 - T^2)/T.

A circle: sigma_x = sigma_y = p0 [1/2/(1 + t^2) - (1 + nu)(1 - t acot t)], sigma_z = -p0/(1 + t^2); there the largest
shear is half of von Mises' stress, 0.310 p0 and 0.620 p0 at 0.481 a with nu = 0.3.
"""

from __future__ import annotations

from typing import Any, NamedTuple

import numpy as np

from warpffrf.model.reduced.stress_field import max_shear, von_mises
from warpffrf.output.contact.hertz_patch import HertzLine, HertzPoint

Array = np.ndarray
ROUND = 1e-7  # of m: below it a circle, with an error of m; the terms of the ellipse lose 1e-16/m of their digits
DEEPEST = 2.0  # of the smaller half-width: the maxima lie within
PLACES = 2001  # looked at, before a parabola through the largest: 1e-6 of the depth


class Largest(NamedTuple):
    """The largest of a stress below the middle, and the depth where it is."""

    stress: float  # Pa
    depth: float  # m


def stress_on_axis(hertz: HertzLine | HertzPoint, depth: Array, poisson_ratio: float) -> Array:
    """Stress (n, 6) [Pa] at depths (n,) [m] below the middle of Hertz's patch: xx across a line or along the larger
    semi-axis, yy beside it, zz into the depth; tension is positive."""
    z, p0, nu = np.asarray(depth, dtype=float), hertz.peak_pressure, poisson_ratio
    if isinstance(hertz, HertzLine):
        t = z / hertz.half_width
        w = np.hypot(1.0, t)
        x, down = 2.0 * t - (1.0 + 2.0 * t * t) / w, -1.0 / w
        y = nu * (x + down)
    else:
        x, y, down = _under_ellipse(*hertz.semi_axes, z, nu)
    zero = np.zeros_like(z)
    return p0 * np.stack([x, y, down, zero, zero, zero], axis=-1)


def _under_ellipse(a: float, b: float, z: Array, nu: float) -> tuple[Array, Array, Array]:
    """sigma_x, sigma_y, sigma_z over p0."""
    from scipy.special import ellipeinc, ellipkinc

    m, t = 1.0 - (b / a) ** 2, z / a
    if m < ROUND:
        down = -1.0 / (1.0 + t * t)
        around = -0.5 * down - (1.0 + nu) * (1.0 - t * np.arctan2(1.0, t))
        return around, around, down
    phi, T, k = np.arctan2(1.0, t), np.sqrt((b * b + z * z) / (a * a + z * z)), (a / b) ** 2
    F, E = ellipkinc(phi, m), ellipeinc(phi, m)
    c, one, two = 2.0 * b / (m * a), t * (F - E), t * (k * E - F)
    x = c * (-0.5 * (1.0 - T) + one + nu * (1.0 - k * T + two))
    y = c * (0.5 + 0.5 / T - k * T + two + nu * (T - 1.0 + one))
    return x, y, -0.5 * c * (1.0 - T * T) / T


def largest_below(hertz: HertzLine | HertzPoint, poisson_ratio: float) -> tuple[Largest, Largest]:
    """The largest von Mises stress below the middle of Hertz's patch, and the largest shear stress."""
    small = hertz.half_width if isinstance(hertz, HertzLine) else hertz.semi_axes[1]
    depth = small * np.linspace(0.0, DEEPEST, PLACES)
    stress = stress_on_axis(hertz, depth, poisson_ratio)
    return largest_of(depth, von_mises(stress)), largest_of(depth, max_shear(stress))


def largest_of(depth: Array, values: Array) -> Largest:
    """The top of the parabola through the largest of `values` (n,) [Pa] at even depths (n,) [m] and its neighbours; at
    an end the value there."""
    n = int(np.argmax(values))
    if n in (0, len(values) - 1):
        return Largest(float(values[n]), float(depth[n]))
    before, top, after = (float(v) for v in values[n - 1 : n + 2])
    bend: Any = before - 2.0 * top + after
    shift = 0.5 * (before - after) / bend if bend != 0.0 else 0.0
    return Largest(top - 0.25 * (before - after) * shift, float(depth[n] + shift * (depth[1] - depth[0])))
