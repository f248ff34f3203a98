"""Prismatic joint: d_x = d_y = 0, A = 1; coordinate "translation" d_z [m]."""

from __future__ import annotations

import numpy as np

from warpffrf.model.joints.base import ALONG, NO_SPIN, ON_AXIS, PARALLEL, Joint
from warpffrf.model.messages.named_arguments import named_arguments


@named_arguments
class Prismatic(Joint):
    """Lets b slide against a along the axis; coordinate "translation", the displacement [m].

    Its ports may lie apart at the initial pose: the joint then sits at b's.

    >>> guide = scene.add(wf.joints.Prismatic(scene.ground, upper["bore"], axis=(0, 0, 1), name="guide"))
    """

    kind = "prismatic"
    rows = (*ON_AXIS, *PARALLEL, *NO_SPIN)
    coordinates = {"translation": ALONG}

    def mismatch(self, d: np.ndarray) -> float:
        return 0.0
