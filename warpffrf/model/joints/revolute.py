"""Revolute joint: d = 0, A e_z = e_z with d = A_a^T (x_b - x_a), A = A_a^T A_b; coordinate "rotation" [rad]."""

from __future__ import annotations

from warpffrf.model.joints.base import ABOUT, PARALLEL, POINT, Joint
from warpffrf.model.messages.named_arguments import named_arguments


@named_arguments
class Revolute(Joint):
    """Lets b turn against a about the axis; coordinate "rotation", the angle [rad], which counts turns.

    >>> machine = wf.Scene(gravity=(0, 0, 0))
    >>> wheel = machine.add_rigid_body(1.0, (0.01, 0.02, 0.01), name="wheel")
    >>> axle = machine.add(wf.joints.Revolute(machine.ground, wheel.at((0, 0, 0)), axis=(0, 1, 0), name="axle"))
    """

    kind = "revolute"
    rows = (*POINT, *PARALLEL)
    coordinates = {"rotation": ABOUT}
