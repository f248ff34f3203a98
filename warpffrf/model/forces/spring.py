"""Spring and damper along a line."""

from __future__ import annotations

from typing import Any

import numpy as np

from warpffrf.model.bodies import Port, PortLike, as_port, require_relative_motion
from warpffrf.model.errors import InputError, require_number
from warpffrf.model.forces.characteristics import Characteristic
from warpffrf.model.forces.force import Force
from warpffrf.model.forces.laws import (
    Coordinate,
    SpringLaw,
    described,
    require_damping,
    require_stiffness,
    scalar_law,
    vanishes,
)
from warpffrf.model.joints import coincident_within
from warpffrf.model.messages.named_arguments import named_arguments


@named_arguments
class SpringDamper(Force):
    """A spring and damper along the line between two ports a and b.

    The force that pulls the ports together is stiffness (l - free_length) + damping dl/dt [N], l their distance [m];
    stiffness [N/m], damping [N s/m], free_length [m] or None for the distance at the initial pose. A characteristic
    (`characteristics`) in the place of either number is the force over l - free_length [m], or over dl/dt [m/s].
    Raises `InputError`.
    """

    kind = "spring_damper"

    def __init__(
        self,
        a: PortLike,
        b: PortLike,
        stiffness: float | Characteristic,
        damping: float | Characteristic = 0.0,
        *,
        free_length: float | None = None,
        name: str | None = None,
    ) -> None:
        label = f"spring {name!r}" if name else "spring damper"
        self.name = name
        self.a = as_port(a, f"{label}: first port")
        self.b = as_port(b, f"{label}: second port")
        for port in (self.a, self.b):
            if port.point is None:
                raise InputError(f"{label}: a spring needs a point on the ground, use scene.ground.at((x, y, z))")
        require_relative_motion(self.a, self.b, label)
        self.stiffness = require_stiffness(stiffness, f"{label}: stiffness")
        self.damping = require_damping(damping, f"{label}: damping")
        if free_length is not None:
            free_length = require_number(free_length, f"{label}: free_length", non_negative=True)
        self.given_free_length = free_length

    @property
    def ports(self) -> tuple[Port, Port]:
        return self.a, self.b

    @property
    def free_length(self) -> float:
        """Free length [m]: the given one, else the distance of the ports at the initial pose as it is now.

        Raises `InputError` where the ports coincide: the line between them then has no direction.
        """
        distance = float(np.linalg.norm(self.b.world_point() - self.a.world_point()))
        if distance <= coincident_within(*self.ports):
            raise InputError(
                f"spring {self.name!r}: its ports {self.a.label} and {self.b.label} coincide, the line of force has no "
                "direction; move one, or use JointSpringDamper or Bushing"
            )
        return distance if self.given_free_length is None else self.given_free_length

    def law(self) -> SpringLaw:
        """Coordinate and law, from the initial pose as it is now. Raises `InputError` for ports that coincide,
        and where stiffness and damping are both zero."""
        if vanishes(self.stiffness) and vanishes(self.damping):
            raise InputError(f"spring {self.name!r}: stiffness and damping are both zero; remove it")
        points = (np.asarray(self.a.point), np.asarray(self.b.point))
        return scalar_law(
            Coordinate("distance"), self.stiffness, self.damping, self.free_length, 0.0,
            ports=self.ports, points=points, axes=(np.eye(3), np.eye(3)),
        )  # fmt: skip

    def describe(self) -> dict[str, Any]:
        """Plain data for hashing."""
        fields = ("kind", "name", "stiffness", "damping", "given_free_length")
        return {**{f: described(getattr(self, f)) for f in fields}, "a": self.a.describe(), "b": self.b.describe()}
