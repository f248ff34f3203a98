"""Applied forces: at a port, along the line between two ports, and on a joint coordinate."""

from __future__ import annotations

from typing import Any

import numpy as np

from warpffrf.model.bodies import Ground, Port, as_port
from warpffrf.model.errors import InputError, require_direction, require_number
from warpffrf.model.joints import COINCIDENT, Joint, Prismatic
from warpffrf.model.signals import Signal, as_signal

FRAMES = ("world", "body")


class PointForce:
    """A force at a port.

    force: three numbers or signals [N], or (signal, direction (3,)). frame: the axes of its components, "world" or
    "body" (turning with the body's frame). `components` are its three signals.
    """

    scene_list = "forces"
    kind = "point_force"

    def __init__(self, port: Any, force: Any, *, frame: str = "world", name: str | None = None) -> None:
        label = f"force {name!r}" if name else "point force"
        self.name = name
        self.port = as_port(port, f"{label}: port")
        if isinstance(self.port.body, Ground):
            raise InputError(f"{label}: a force on the ground does nothing; choose a port of a body")
        if frame not in FRAMES:
            raise InputError(f"{label}: frame must be one of {', '.join(FRAMES)}, got {frame!r}")
        self.frame = frame
        self.components: tuple[Signal, Signal, Signal] = _components(force, label)

    @property
    def ports(self) -> tuple[Port, ...]:
        return (self.port,)

    def describe(self) -> dict[str, Any]:
        """Plain data for hashing."""
        components = [signal.describe() for signal in self.components]
        fields = {"kind": self.kind, "name": self.name, "frame": self.frame}
        return {**fields, "port": self.port.describe(), "components": components}


def _components(force: Any, label: str) -> tuple[Signal, Signal, Signal]:
    try:
        parts = list(force)
    except TypeError:
        parts = []
    if len(parts) == 2:
        direction = require_direction(parts[1], f"{label}: direction")
        signal = as_signal(parts[0], f"{label}: signal")
        x, y, z = (signal.scaled(float(d)) for d in direction)
        return x, y, z
    if len(parts) != 3:
        raise InputError(f"{label}: give three components or (signal, direction), got {force!r}")
    x, y, z = (as_signal(part, f"{label}: component {axis}") for part, axis in zip(parts, "xyz", strict=True))
    return x, y, z


class SpringDamper:
    """A spring and damper along the line between two ports.

    The force that pulls the ports together is stiffness (l - free_length) + damping dl/dt [N], l their distance [m];
    stiffness [N/m], damping [N s/m], free_length [m] or None for the distance at the initial pose.
    """

    scene_list = "forces"
    kind = "spring_damper"

    def __init__(
        self,
        a: Any,
        b: Any,
        stiffness: float,
        damping: float = 0.0,
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
        if self.a.body is self.b.body:
            raise InputError(f"{label}: both ends are on {self.a.body.name!r}; a spring joins two bodies")
        self.stiffness = require_number(stiffness, f"{label}: stiffness", non_negative=True)
        self.damping = require_number(damping, f"{label}: damping", non_negative=True)
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
        if distance <= COINCIDENT:
            raise InputError(
                f"spring {self.name!r}: its ports {self.a.label} and {self.b.label} coincide, the line of force has no "
                "direction; move one, or use JointSpringDamper"
            )
        return distance if self.given_free_length is None else self.given_free_length

    def describe(self) -> dict[str, Any]:
        """Plain data for hashing."""
        fields = ("kind", "name", "stiffness", "damping", "given_free_length")
        return {**{f: getattr(self, f) for f in fields}, "a": self.a.describe(), "b": self.b.describe()}


class JointSpringDamper:
    """A spring and damper on the coordinate s of a prismatic joint.

    The force on the second body along the axis is preload - stiffness (s - reference) - damping ds/dt [N], its opposite
    acts on the first; stiffness [N/m], damping [N s/m], reference [m], preload [N].
    """

    scene_list = "forces"
    kind = "joint_spring_damper"

    def __init__(
        self,
        joint: Joint,
        stiffness: float,
        damping: float = 0.0,
        *,
        reference: float = 0.0,
        preload: float = 0.0,
        name: str | None = None,
    ) -> None:
        label = f"joint spring {name!r}" if name else "joint spring"
        if not isinstance(joint, Prismatic):
            what = f"{joint.kind} joint {joint.name!r}" if isinstance(joint, Joint) else repr(joint)
            raise InputError(f"{label}: acts on a prismatic joint, got {what}")
        self.name = name
        self.joint = joint
        self.stiffness = require_number(stiffness, f"{label}: stiffness", non_negative=True)
        self.damping = require_number(damping, f"{label}: damping", non_negative=True)
        self.reference = require_number(reference, f"{label}: reference")
        self.preload = require_number(preload, f"{label}: preload")

    @property
    def ports(self) -> tuple[Port, Port]:
        return self.joint.ports

    def describe(self) -> dict[str, Any]:
        """Plain data for hashing."""
        fields = ("kind", "name", "stiffness", "damping", "reference", "preload")
        return {**{f: getattr(self, f) for f in fields}, "joint": self.joint.name}
