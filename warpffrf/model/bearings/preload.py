r"""Axial preload of ball bearings, which presses the rings against each other in the sense of the contact angle.

    PreloadForce     a force of given size: a spring between the rings
    PreloadOffset    raceways that stand off on their rings, as those of paired bearings are ground: rings whose faces
                     are flush, or that a nut pulls together, then press with what the balls answer

A kind of preload is a class with `offset`, how far the inner raceway stands along the axis beyond its free place, and
`press`, which adds forces. The sense is that in which thrust on the inner ring presses the bearing together: along the
axis, or against it where the contact angle is negative. With the distance A of groove centres that touch and the free
angle alpha_0, rings that are pressed by u along the axis have

    tan alpha = (A sin alpha_0 + u)/(A cos alpha_0),      Q = K ((A cos alpha_0)/cos alpha - A)^(3/2),      F = Z Q sin
    alpha.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, ClassVar

import numpy as np

from warpffrf.model.bodies import Body
from warpffrf.model.errors import InputError, require_number
from warpffrf.model.forces import PointForce
from warpffrf.model.messages.named_arguments import named_arguments

if TYPE_CHECKING:
    from warpffrf.model.bearings.bearing import Bearing
    from warpffrf.model.scene import Scene


@dataclass(frozen=True)
class Preload:
    """What preloads have in common; see the module."""

    kind: ClassVar[str] = ""

    def offset(self, label: str) -> float:
        """How far [m] the inner raceway stands beyond its free place, in the pressing sense; label: of the bearing, in
        messages. Raises `InputError`."""
        return 0.0

    def press(self, scene: Scene, bearing: Bearing, sense: float) -> None:
        """Add forces to `scene` and to `bearing.forces`; sense [-]: 1 along the axis, -1 against it. Raises
        `InputError`."""


@named_arguments
@dataclass(frozen=True)
class PreloadForce(Preload):
    """The rings are pressed against each other along the axis by `force` [N], on each ring along its own axis.

    A ring that does not move takes it from what holds it. The forces are `bearing.forces["preload_inner"]` and
    ["preload_outer"], the latter where the outer ring is no ground. Rings are rigid. Raises `InputError`.
    """

    force: float
    kind: ClassVar[str] = "preload_force"

    def press(self, scene: Scene, bearing: Bearing, sense: float) -> None:
        label = f"bearing {bearing.name!r}: PreloadForce"
        force = require_number(self.force, f"{label}: force [N]", positive=True)
        center, axis = bearing.place.center, bearing.place.axis
        for side, sign in (("inner", sense), ("outer", -sense)):
            body = getattr(bearing, side)
            if not isinstance(body, Body):
                continue
            if body.reduced is not None:
                raise InputError(
                    f"{label}: the {side} ring, {body.name!r}, is flexible, and a force needs a place on it; press on "
                    "an interface of yours, forces.PointForce(body['face'], ...)"
                )
            own = body.to_user(center + axis) - body.to_user(center)
            bearing.forces[f"preload_{side}"] = scene.add(
                PointForce(
                    body.at(body.to_user(center)), (sign * force, own), frame="body",
                    name=f"{bearing.name} preload {side}",
                )
            )  # fmt: skip


@named_arguments
@dataclass(frozen=True)
class PreloadOffset(Preload):
    """The inner raceway stands off on its ring by `distance` [m], in the sense that presses the bearing together: a
    ring that is held where it would be free presses from the start. Raises `InputError`."""

    distance: float
    kind: ClassVar[str] = "preload_offset"

    def offset(self, label: str) -> float:
        return require_number(self.distance, f"{label}: PreloadOffset: distance [m]", positive=True)


def checked_preload(label: str, preload: Preload | None) -> Preload:
    """Raises `InputError` for what is no preload."""
    if preload is None:
        return Preload()
    if not isinstance(preload, Preload):
        raise InputError(
            f"{label}: preload must be bearings.PreloadForce(newtons) or bearings.PreloadOffset(metres), got "
            f"{preload!r}; a radial one is a negative clearance"
        )
    return preload


def sense_of(angle: float) -> float:
    """1 where thrust on the inner ring along the axis presses a bearing of that contact angle [rad] together, else
    -1."""
    return -1.0 if np.sign(angle) < 0.0 else 1.0
