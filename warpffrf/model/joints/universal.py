"""Universal (Cardan, Hooke) joint: two crossing hinges at a right angle, without the mass of the cross.

Marker x is the first axis, fixed to a; marker y the second, fixed to b; the joint holds d = 0 and u_x . w_y = 0. With
`rotation` alpha of the cross against a about u_x and `second_rotation` beta of b against the cross about w_y,

    A_a^T A_b = R_x(alpha) R_y(beta),    w_y = cos(alpha) u_y + sin(alpha) u_z,    u_x = cos(beta) w_x + sin(beta) w_z,

so that alpha is the angle of w_y about u_x and beta that of b about w_y, measured against u_x. Neither has a gimbal
lock: shafts perpendicular to their axis of the cross at any beta.
"""

from __future__ import annotations

from typing import Any

import numpy as np

from warpffrf.model.arguments import Vector
from warpffrf.model.bodies import PortLike
from warpffrf.model.errors import InputError, require_direction
from warpffrf.model.joints.base import POINT, Joint
from warpffrf.model.joints.rows import Row
from warpffrf.model.messages.named_arguments import named_arguments

PERPENDICULAR = 1e-6  # cosine of the two axes: six digits typed; the second is then made perpendicular to the first


@named_arguments
class Universal(Joint):
    """A cross with `axis` fixed to a and `second_axis` fixed to b, perpendicular to each other at the initial pose.

    Coordinates "rotation" (of the cross against a about `axis`) and "second_rotation" (of b against the cross about
    `second_axis`), both [rad]. Directions (3,) in the world at the initial pose. Raises `InputError` where they are not
    perpendicular.
    """

    kind = "universal"
    rows = (*POINT, Row("direction", 0, 1))
    coordinates = {"rotation": Row("angle", 0, 1), "second_rotation": Row("second_angle", 1, 0)}

    def __init__(
        self,
        a: PortLike,
        b: PortLike,
        *,
        axis: Vector,
        second_axis: Vector,
        point: Vector | None = None,
        name: str | None = None,
    ) -> None:
        super().__init__(a, b, axis=axis, point=point, name=name)
        second = require_direction(second_axis, f"{self.label}: second_axis")
        cosine = float(self.axis @ second)
        if abs(cosine) > PERPENDICULAR:
            raise InputError(
                f"{self.label}: axis and second_axis must be perpendicular, their angle is "
                f"{np.degrees(np.arccos(np.clip(cosine, -1.0, 1.0))):.6g} degrees"
            )
        self.second_axis = require_direction(second - cosine * self.axis, f"{self.label}: second_axis")

    def axes(self) -> np.ndarray:
        return np.stack([self.axis, self.second_axis, np.cross(self.axis, self.second_axis)], axis=1)

    def describe(self) -> dict[str, Any]:
        return {**super().describe(), "second_axis": self.second_axis.tolist()}
