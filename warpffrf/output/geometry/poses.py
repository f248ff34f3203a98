r"""Where a pair touches: poses of the two bodies, and the relative curvature of their true surfaces there.

Every shape has a chart (theta, z), an outward normal n away from the material, and unit tangents with
`e_theta x t_z = n`. Outside of a body e_theta points to increasing theta, on an inside form (bore, ring, cup) to
decreasing theta, which is what `side` = +1, -1 says. A plane counts theta in metres along e_theta and has the metric
radius 1, so that arc = radius * theta everywhere.

Near a common point with a common normal the undeformed gap of two surfaces is `1/2 x.(K1 + K2).x`, each tensor
`K = k_theta e_theta e_theta + k_z t_z t_z` in the common tangent plane, convex positive.
"""

from __future__ import annotations

from typing import Any

import numpy as np

from warpffrf.output.geometry.grid_places import rotate


class Pose:
    """Position (3,) [m] and unit quaternion (4,) of a user frame in the world; the identity for the ground."""

    def __init__(self, position: Any = (0.0, 0.0, 0.0), rotation: Any = (0.0, 0.0, 0.0, 1.0)) -> None:
        self.position, self.rotation = np.asarray(position, float), np.asarray(rotation, float)

    @classmethod
    def of(cls, bodies: dict[str, Any], name: str, i: int) -> Pose:
        """Pose of the body called `name` at saved step `i`; a name without a motion is the ground."""
        motion = bodies.get(name)
        return cls() if motion is None else cls(motion.position[i], motion.rotation[i])

    def to_world(self, points: np.ndarray) -> np.ndarray:
        """Points (n, 3) [m] of the user frame in the world."""
        return self.position + rotate(self.rotation, points)

    def to_user(self, points: np.ndarray) -> np.ndarray:
        """World points (n, 3) [m] in the user frame."""
        return self.turned_back(np.asarray(points) - self.position)

    def turned(self, vectors: np.ndarray) -> np.ndarray:
        """Vectors (n, 3) in user axes -> world axes."""
        return rotate(self.rotation, vectors)

    def turned_back(self, vectors: np.ndarray) -> np.ndarray:
        """Vectors (n, 3) in world axes -> user axes."""
        return rotate(self.rotation * np.array([-1.0, -1.0, -1.0, 1.0]), vectors)


def tangents(shape: Any, theta: Any, z: Any) -> np.ndarray:
    """Unit vectors (2, n, 3) e_theta and t_z at chart coordinates theta [rad, m on a plane], z [m], each (n,); user
    axes."""
    theta, z = np.atleast_1d(theta), np.atleast_1d(z)
    return np.stack([np.broadcast_to(shape.around(theta), (*theta.shape, 3)), shape.along(theta, z)])


def relative_curvature(first: Any, second: Any, poses: tuple[Pose, Pose], theta: float, z: float) -> np.ndarray:
    """K1 + K2 (2, 2) [1/m] along (e_theta, t_z) of the shape `first` at its point (theta, z); `second` is taken at the
    point nearest to it."""
    point = np.asarray(first.point(theta, z)).reshape(1, 3)
    theta2, z2, _ = second.chart(poses[1].to_user(poses[0].to_world(point)))
    mine = poses[0].turned(tangents(first, theta, z)[:, 0])  # (2, 3), world
    turn = mine @ poses[1].turned(tangents(second, theta2, z2)[:, 0]).T  # the second's tangents in the first's
    own = np.diag([float(np.ravel(k)[0]) for k in first.curvatures(theta, z)])
    other = np.diag([float(np.ravel(k)[0]) for k in second.curvatures(theta2, z2)])
    return own + turn @ other @ turn.T
