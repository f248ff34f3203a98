"""Line in a plane: d_z = 0, e_z . A e_y = 0; b turns about the line and about the axis, and slides in the plane."""

from __future__ import annotations

from typing import Any

import numpy as np

from warpffrf.model.arguments import Vector
from warpffrf.model.bodies import PortLike
from warpffrf.model.errors import InputError, require_direction
from warpffrf.model.joints.base import ALONG, Joint
from warpffrf.model.joints.rows import Row
from warpffrf.model.joints.universal import PERPENDICULAR
from warpffrf.model.messages.named_arguments import named_arguments


@named_arguments
class LineInPlane(Joint):
    """Keeps a line of b, through its point along `line`, in the plane through a's point across `axis`, which is fixed
    to a: a roller in the pocket of a cage, whose axis cannot skew out of the plane.

    line: direction (3,), world, at the initial pose, perpendicular to the axis; fixed to b from then on. It has no
    coordinate. The ports may lie apart across the axis at the initial pose. Raises `InputError` for a line that does
    not lie in the plane.
    """

    kind = "line_in_plane"
    rows = (ALONG, Row("direction", 2, 1))
    coordinates = {}

    def __init__(
        self,
        a: PortLike,
        b: PortLike,
        *,
        axis: Vector,
        line: Vector,
        point: Vector | None = None,
        name: str | None = None,
    ) -> None:
        super().__init__(a, b, axis=axis, point=point, name=name)
        given = require_direction(line, f"{self.label}: line")
        cosine = float(self.axis @ given)
        if abs(cosine) > PERPENDICULAR:
            raise InputError(
                f"{self.label}: the line must lie in the plane across axis, it is "
                f"{np.degrees(np.arcsin(np.clip(abs(cosine), 0.0, 1.0))):.6g} degrees out of it"
            )
        self.line = require_direction(given - cosine * self.axis, f"{self.label}: line")

    def mismatch(self, d: np.ndarray) -> float:
        return abs(float(d @ self.axis))

    def axes(self) -> np.ndarray:
        return np.stack([np.cross(self.line, self.axis), self.line, self.axis], axis=1)

    def describe(self) -> dict[str, Any]:
        return {**super().describe(), "line": self.line.tolist()}
