"""Spherical joint: d = 0; rotations are free and have no coordinate."""

from __future__ import annotations

from warpffrf.model.arguments import Vector
from warpffrf.model.bodies import PortLike
from warpffrf.model.joints.base import POINT, Joint
from warpffrf.model.messages.named_arguments import named_arguments


@named_arguments
class Spherical(Joint):
    """Holds a point of b to a point of a; every rotation is free. No coordinate."""

    kind = "spherical"
    rows = POINT

    def __init__(self, a: PortLike, b: PortLike, *, point: Vector | None = None, name: str | None = None) -> None:
        super().__init__(a, b, axis=(0.0, 0.0, 1.0), point=point, name=name)
