"""Cylindrical joint: d_x = d_y = 0, A e_z = e_z; coordinates "translation" d_z [m] and "rotation" [rad]."""

from __future__ import annotations

import numpy as np

from warpffrf.model.joints.base import ABOUT, ALONG, ON_AXIS, PARALLEL, Joint, off_axis
from warpffrf.model.messages.named_arguments import named_arguments


@named_arguments
class Cylindrical(Joint):
    """Lets b turn about the axis and slide along it; coordinates "translation" [m] and "rotation" [rad].

    The ports may lie apart along the axis at the initial pose; both coordinates are zero there.
    """

    kind = "cylindrical"
    rows = (*ON_AXIS, *PARALLEL)
    coordinates = {"translation": ALONG, "rotation": ABOUT}

    def mismatch(self, d: np.ndarray) -> float:
        return off_axis(self, d)
