r"""A contact surface laid flat around one of its points: where the half-space of the near field lies.

At the point x_c of the surface stand the unit tangents e_theta and t_z and the outward normal n. A point x of the body
goes to (s, t, y): y is its distance below the surface, and of the nearest point of the surface the components a, b
along the tangents become arcs of the principal curvatures k,

    s = asin(k_theta a)/k_theta,   t = asin(k_z b)/k_z       (a and b themselves where k = 0),

so that a cylinder unrolls without stretching, and a sphere keeps its distances from x_c along both principal lines.
(s, t, -y) is right-handed: cells keep their orientation.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np

Array = np.ndarray
FARTHEST = 1.4  # rad between normals: arcs are known by their chords, which shorten again from pi/2 on
STRAIGHT = 1e-12  # of a curvature times a length: below it the arc is its chord to round-off


@dataclass(frozen=True, eq=False)
class FlatChart:
    """The chart of a resolved `shape` about its point (`theta`, `z`) [rad or m, m]."""

    shape: Any
    theta: float
    z: float

    @property
    def origin(self) -> Array:
        """x_c (3,) [m], user frame."""
        return self.shape.point(self.theta, self.z)

    @property
    def smallest_radius(self) -> float:
        """Smaller radius of curvature [m] of a convex surface at x_c; inf where it is convex in no direction."""
        largest = max(float(k) for k in self.shape.curvatures(self.theta, self.z))
        return 1.0 / largest if largest > 0.0 else np.inf

    def before(self, points: Array) -> Array:
        """Which of `points` (n, 3) [m], user frame, lie less than `FARTHEST` round the body from x_c (n,)."""
        theta, z, _ = self.shape.chart(points)
        return self.shape.normal(theta, z) @ self.shape.normal(self.theta, self.z) > np.cos(FARTHEST)

    def flat(self, points: Array) -> tuple[Array, Array, Array]:
        """(s, t, y) [m] of `points` (n, 3) [m], user frame; y > 0 below the surface."""
        theta, z, distance = self.shape.chart(points)
        return *self.on_surface(theta, z), -distance

    def on_surface(self, theta: Array, z: Array) -> tuple[Array, Array]:
        """(s, t) [m] of the places (theta, z) of the surface, at less than a quarter of a turn from the centre."""
        off = self.shape.point(theta, z) - self.origin
        k_theta, k_z = (float(k) for k in self.shape.curvatures(self.theta, self.z))
        return (
            _arc(off @ self.shape.around(self.theta), k_theta),
            _arc(off @ self.shape.along(self.theta, self.z), k_z),
        )


def _arc(chord: Array, curvature: float) -> Array:
    """Length of the arc of `curvature` [1/m] from its middle to where it lies `chord` [m] beside it."""
    if abs(curvature) * np.max(np.abs(chord), initial=0.0) < STRAIGHT:
        return chord
    return np.arcsin(np.clip(curvature * chord, -1.0, 1.0)) / curvature
