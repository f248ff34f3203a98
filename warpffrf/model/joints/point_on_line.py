"""Point on a line: d_x = d_y = 0; coordinate "translation" d_z [m]; rotations are free."""

from __future__ import annotations

import numpy as np

from warpffrf.model.joints.base import ALONG, ON_AXIS, Joint, off_axis
from warpffrf.model.messages.named_arguments import named_arguments


@named_arguments
class PointOnLine(Joint):
    """Keeps a point of b on the line through a's point along the axis, which is fixed to a.

    Coordinate "translation", the displacement of the point along the line [m] from its place at the initial pose. The
    ports may lie apart along the axis there.
    """

    kind = "point_on_line"
    rows = ON_AXIS
    coordinates = {"translation": ALONG}

    def mismatch(self, d: np.ndarray) -> float:
        return off_axis(self, d)
