r"""The surface of a quarter space: what a free end face adds to the half-space under a load near it and to its mirror
image, read from a table that `warpffrf.offline.near_field.quarter_space` makes.

With `|x| = hypot(s, zeta)`, zeta the distance of a place and d that of the load from the end face, s along the edge,

    w(s, zeta; d) = g(t, theta)/(d + |x|),    t = |x|/(d + |x|),    theta = atan2(zeta, |s|),

g smooth on a box, as coefficients of a cubic spline. By Maxwell and Betti a place and a load may change sides; the
mean of both readings is exactly symmetric.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike

from warpffrf.model.errors import InputError

Array = np.ndarray
DEGREE = 3


@dataclass(frozen=True, eq=False)
class QuarterSurface:
    """Spline `coefficients` (t, theta) of g times Young's modulus, two more than nodes along each axis."""

    coefficients: Array

    def displacement(self, s: ArrayLike, zeta: ArrayLike, d: ArrayLike) -> Array:
        """Depth component (...) of w [1/m], per unit load and times Young's modulus, at the places (s, zeta) [m] of
        loads at d [m]; they are broadcast. Not finite where a place on the edge meets a load on it. Raises
        `InputError` for places or loads outside the material."""
        x, z, load = np.broadcast_arrays(*(np.asarray(a, float) for a in (s, zeta, d)))
        require_inside(z, load)
        return 0.5 * (self._read(x, z, load) + self._read(x, load, z))

    def _read(self, s: Array, zeta: Array, d: Array) -> Array:
        from scipy.ndimage import map_coordinates

        radius = np.hypot(s, zeta)
        steps = np.array(self.coefficients.shape) - 3
        places = (radius / (radius + d), np.arctan2(zeta, np.abs(s)) / (0.5 * np.pi))
        at = [(place * n + 1.0).ravel() for place, n in zip(places, steps, strict=True)]
        g = map_coordinates(self.coefficients, at, order=DEGREE, prefilter=False)
        return g.reshape(radius.shape) / (radius + d)


def require_inside(*distances: Array) -> None:
    """Raises `InputError` for a negative distance."""
    if any(np.any(a < 0.0) for a in distances):
        raise InputError("quarter space: distance from the end face, depth and place of the load must not be negative")
