"""Planar joint: d_z = 0, A e_z = e_z; coordinate "rotation" [rad]."""

from __future__ import annotations

import numpy as np

from warpffrf.model.joints.base import ABOUT, ALONG, PARALLEL, Joint
from warpffrf.model.messages.named_arguments import named_arguments


@named_arguments
class Planar(Joint):
    """Lets b slide across the axis in any direction and turn about it, as a shaft in a journal bearing; coordinate
    "rotation", the angle [rad], which counts turns.

    Its ports may lie apart across the axis at the initial pose: the joint then sits at b's.
    """

    kind = "planar"
    rows = (ALONG, *PARALLEL)
    coordinates = {"rotation": ABOUT}

    def mismatch(self, d: np.ndarray) -> float:
        return abs(float(d @ self.axis))
