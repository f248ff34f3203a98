r"""A rigid body has mass and inertia, but no shape. It is drawn as the solid box with the same principal moments,

I_x = m (b^2 + c^2)/3, ...    =>    a^2 = 3 (I_y + I_z - I_x)/(2 m), ...    half lengths a, b, c.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from warpffrf.model import rotation as rot
from warpffrf.output.geometry.places import rotate
from warpffrf.output.geometry.scene_view import BodyView

THINNEST = 0.03  # smallest half length drawn, of the longest: a disc is drawn with some thickness
CORNERS = np.array([[x, y, z] for x in (-1.0, 1.0) for y in (-1.0, 1.0) for z in (-1.0, 1.0)])
SIDES = np.array([[0, 1, 3, 2], [4, 6, 7, 5], [0, 4, 5, 1], [2, 3, 7, 6], [0, 2, 6, 4], [1, 5, 7, 3]])  # from outside


@dataclass(frozen=True)
class InertiaBox:
    """The box of a rigid body: center (3,) [m, user frame], half lengths (3,) [m], axes as a quaternion (x y z w)."""

    center: np.ndarray
    half: np.ndarray
    rotation: np.ndarray

    def mesh(self) -> tuple[np.ndarray, np.ndarray]:
        """Points (24, 3) [m, user frame], four per side, and triangles (12, 3) of the box."""
        points = self.center + rotate(self.rotation, CORNERS * self.half)
        first = 4 * np.arange(len(SIDES))[:, None, None]
        return points[SIDES.ravel()], (first + np.array([[0, 1, 2], [0, 2, 3]])).reshape(-1, 3)


def inertia_box(body: BodyView) -> InertiaBox:
    """The box with the body's mass and inertia."""
    moments, axes = np.linalg.eigh(body.inertia)
    if np.linalg.det(axes) < 0.0:
        axes[:, 0] = -axes[:, 0]
    squares = 1.5 * (moments.sum() - 2.0 * moments) / body.mass
    half = np.sqrt(np.maximum(squares, 0.0))
    return InertiaBox(body.center_of_mass, np.maximum(half, THINNEST * half.max()), rot.quaternion(axes))
