"""Revolute joint: d = 0, A e_z = e_z with d = A_a^T (x_b - x_a), A = A_a^T A_b; coordinate "rotation" [rad]."""

from __future__ import annotations

from warpffrf.model.joints.base import ABOUT, PARALLEL, POINT, Joint
from warpffrf.model.named_arguments import named_arguments


@named_arguments
class Revolute(Joint):
    """Lets b turn against a about the axis; coordinate "rotation", the angle [rad], which counts turns."""

    kind = "revolute"
    rows = (*POINT, *PARALLEL)
    coordinates = {"rotation": ABOUT}
