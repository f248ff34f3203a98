r"""Hertz's line and point contact (K. L. Johnson, Contact Mechanics, 1985, sections 4.2 and 5.6).

With 1/E* = sum (1 - nu^2)/E and 1/R = 1/R1 + 1/R2 (R2 < 0 in a bore)

    line:   a^2 = 4 P' R/(pi E*),     p0 = 2 P'/(pi a),      p = p0 sqrt(1 - x^2/a^2)
    point:  a^3 = 3 P R/(4 E*),       p0 = 3 P/(2 pi a^2),   p = p0 sqrt(1 - r^2/a^2),   delta = a^2/R.

**Shear below a line contact.** On the axis sigma_x = -p0/a ((a^2 + 2 z^2)/sqrt(a^2 + z^2) - 2 z) and sigma_z =
-p0 a/sqrt(a^2 + z^2), half the difference is

    tau = p0/a (z - z^2/sqrt(a^2 + z^2)),        dtau/dz = 0:   (1 + t^2)^(3/2) = t (2 + t^2),   t = z/a,

and in plane strain sigma_y = nu (sigma_x + sigma_z). **Below a point contact** (Johnson, equations 3.45)

    sigma_r = -p0 ((1 + nu)(1 - t atan(1/t)) - 1/(2 (1 + t^2))),     sigma_z = -p0/(1 + t^2),

sigma_theta = sigma_r, so that von Mises' stress is |sigma_r - sigma_z|.

**Approach of a line contact** depends on the rest of the body. A solid cylinder of radius R0, loaded at both ends of a
diameter over the half-width a: the axis approaches either end by P' (1 - nu^2)/(pi E) (2 ln(4 R0/a) - 1).
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from scipy.optimize import brentq

from warpffrf.model.material import Material

Array = np.ndarray


def contact_modulus(first: Material, second: Material | None = None) -> float:
    """E* [Pa] of two bodies; `second` None: rigid."""
    compliance = 1.0 / first.plane_strain_modulus
    if second is not None:
        compliance += 1.0 / second.plane_strain_modulus
    return 1.0 / compliance


def cylinder_approach(load: float, radius: float, half_width: float, material: Material) -> float:
    """Approach [m] of the axis of a solid cylinder to either of its two loaded lines (Johnson, equation 5.57).

    load P' [N/m]; radius R0 and half_width a [m]. Plane strain.
    """
    return load / (np.pi * material.plane_strain_modulus) * (2.0 * np.log(4.0 * radius / half_width) - 1.0)


@dataclass(frozen=True)
class LineContact:
    """Two parallel cylinders. load P' [N/m], effective radius R [m], modulus E* [Pa]."""

    load: float
    radius: float
    modulus: float

    @property
    def half_width(self) -> float:
        """a [m]."""
        return float(np.sqrt(4.0 * self.load * self.radius / (np.pi * self.modulus)))

    @property
    def peak_pressure(self) -> float:
        """p0 [Pa]."""
        return 2.0 * self.load / (np.pi * self.half_width)

    def pressure(self, x: Array) -> Array:
        """p [Pa] at x [m] across the patch."""
        return self.peak_pressure * np.sqrt(np.maximum(1.0 - (np.asarray(x) / self.half_width) ** 2, 0.0))

    def largest_shear(self) -> tuple[float, float]:
        """Largest shear stress [Pa] and its depth [m] below the middle."""
        t = float(brentq(lambda t: (1.0 + t * t) ** 1.5 - t * (2.0 + t * t), 0.1, 2.0, xtol=1e-15))  # pyright: ignore
        return self.peak_pressure * (t - t * t / np.hypot(1.0, t)), t * self.half_width

    def on_axis(self, z: Array) -> tuple[Array, Array]:
        """sigma_x and sigma_z [Pa] at depths z [m] below the middle."""
        t = np.asarray(z, dtype=float) / self.half_width
        w = np.hypot(1.0, t)
        return self.peak_pressure * (2.0 * t - (1.0 + 2.0 * t * t) / w), -self.peak_pressure / w

    def von_mises(self, z: Array, poisson_ratio: float) -> Array:
        """Von Mises' stress [Pa] at depths z [m] below the middle, in plane strain."""
        x, down = self.on_axis(z)
        y = poisson_ratio * (x + down)
        return np.sqrt(0.5 * ((x - y) ** 2 + (y - down) ** 2 + (down - x) ** 2))


@dataclass(frozen=True)
class PointContact:
    """Two spheres. load P [N], effective radius R [m], modulus E* [Pa]."""

    load: float
    radius: float
    modulus: float

    @property
    def half_width(self) -> float:
        """Radius a [m] of the patch."""
        return float(np.cbrt(0.75 * self.load * self.radius / self.modulus))

    @property
    def peak_pressure(self) -> float:
        """p0 [Pa]."""
        return 1.5 * self.load / (np.pi * self.half_width**2)

    @property
    def approach(self) -> float:
        """delta [m] of distant points."""
        return self.half_width**2 / self.radius

    def pressure(self, r: Array) -> Array:
        """p [Pa] at the distance r [m] from the middle."""
        return self.peak_pressure * np.sqrt(np.maximum(1.0 - (np.asarray(r) / self.half_width) ** 2, 0.0))

    def on_axis(self, z: Array, poisson_ratio: float) -> tuple[Array, Array]:
        """sigma_r = sigma_theta and sigma_z [Pa] at depths z [m] below the middle."""
        t = np.asarray(z, dtype=float) / self.half_width
        down = -self.peak_pressure / (1.0 + t * t)
        around = -self.peak_pressure * (1.0 + poisson_ratio) * (1.0 - t * np.arctan2(1.0, t)) - 0.5 * down
        return around, down

    def von_mises(self, z: Array, poisson_ratio: float) -> Array:
        """Von Mises' stress [Pa] at depths z [m] below the middle."""
        around, down = self.on_axis(z, poisson_ratio)
        return np.abs(around - down)
