"""Distance joint: |x_b - x_a| held, like a massless rod with a ball at each end; coordinate "distance" [m]."""

from __future__ import annotations

import numpy as np

from warpffrf.model.bodies import PortLike
from warpffrf.model.errors import InputError
from warpffrf.model.joints.base import Joint, Marker, coincident_within
from warpffrf.model.joints.rows import Row
from warpffrf.model.messages.named_arguments import named_arguments


@named_arguments
class Distance(Joint):
    """Holds the distance of two ports a and b at its initial value, or at that of a drive (then it is a telescopic
    rod).

    Coordinate "distance", the length itself [m]: a drive with quantity="position" prescribes the length. Raises
    `InputError` where the ports coincide.
    """

    kind = "distance"
    rows = (Row("distance"),)
    coordinates = {"distance": Row("distance")}

    def __init__(self, a: PortLike, b: PortLike, *, name: str | None = None) -> None:
        super().__init__(a, b, axis=(0.0, 0.0, 1.0), name=name)
        for port in (self.a, self.b):
            if port.point is None:
                raise InputError(
                    f"{self.label}: a distance needs a point on the ground, use scene.ground.at((x, y, z))"
                )

    def initial_value(self, row: Row) -> float:
        """The initial length [m], whatever the row; raises `InputError` where the ports coincide: the rod then has no
        direction."""
        length = float(np.linalg.norm(self.b.world_point() - self.a.world_point()))
        if length <= coincident_within(self.a, self.b):
            raise InputError(
                f"{self.label}: its ports {self.a.label} and {self.b.label} coincide, the rod has no direction; use a "
                "Spherical joint, or move one"
            )
        return length

    def world_point(self) -> np.ndarray:
        """Place of b's port (3,) [m], where the reaction on the second body acts."""
        return self.b.world_point()

    def frames(self) -> tuple[Marker, Marker]:
        self.initial_value(self.rows[0])
        world = self.axes()
        return self._marker(self.a, self.a.world_point(), world), self._marker(self.b, self.b.world_point(), world)
