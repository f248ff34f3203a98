"""Point in a plane: d_z = 0; rotations and sliding in the plane are free."""

from __future__ import annotations

import numpy as np

from warpffrf.model.joints.base import ALONG, Joint
from warpffrf.model.messages.named_arguments import named_arguments


@named_arguments
class PointInPlane(Joint):
    """Keeps a point of b in the plane through a's point across the axis, which is fixed to a: a ball in a slot.

    It has no coordinate. The ports may lie apart across the axis at the initial pose.
    """

    kind = "point_in_plane"
    rows = (ALONG,)
    coordinates = {}

    def mismatch(self, d: np.ndarray) -> float:
        return abs(float(d @ self.axis))
