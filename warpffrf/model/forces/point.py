"""Concentrated force and torque at a port."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any, Literal, TypeAlias

import numpy as np
from numpy.typing import NDArray

from warpffrf.model.arguments import Vector
from warpffrf.model.bodies import Ground, Port, PortLike, as_port
from warpffrf.model.errors import InputError, require_direction
from warpffrf.model.forces.force import Force
from warpffrf.model.forces.laws import PointLoad
from warpffrf.model.messages.named_arguments import named_arguments
from warpffrf.model.signals import Signal, SignalLike, as_signal

FRAMES = ("world", "body")


# three numbers or signals, or a signal and a direction (3,)
Components: TypeAlias = Sequence[SignalLike] | tuple[SignalLike, Vector] | NDArray[Any]


class _Concentrated(Force):
    """Port, frame and three signals; see the subclasses."""

    kind = ""
    what = ""  # "force" or "torque"

    def __init__(self, port: PortLike, value: Components, frame: str, name: str | None) -> None:
        label = f"{self.what} {name!r}" if name else f"point {self.what}"
        self.name = name
        self.port = as_port(port, f"{label}: port")
        if isinstance(self.port.body, Ground):
            raise InputError(f"{label}: a {self.what} on the ground does nothing; choose a port of a body")
        if frame not in FRAMES:
            raise InputError(f"{label}: frame must be one of {', '.join(FRAMES)}, got {frame!r}")
        self.frame = frame
        self.components: tuple[Signal, Signal, Signal] = _components(value, label)

    @property
    def ports(self) -> tuple[Port, ...]:
        return (self.port,)

    def load(self) -> PointLoad:
        """What the simulation applies."""
        return PointLoad(self.what, self.port, self.frame, self.components)

    def describe(self) -> dict[str, Any]:
        """Plain data for hashing."""
        components = [signal.describe() for signal in self.components]
        fields = {"kind": self.kind, "name": self.name, "frame": self.frame}
        return {**fields, "port": self.port.describe(), "components": components}


@named_arguments
class PointForce(_Concentrated):
    """A force at a port.

    force: three numbers or signals [N], or (signal, direction (3,)). frame: the axes of its components, "world" or
    "body" (turning with the body's frame). `components` are its three signals.

    >>> push = scene.add(wf.forces.PointForce(upper["bore"], (0, 0, -50.0), name="push"))  # N, world axes
    """

    kind = "point_force"
    what = "force"

    def __init__(
        self,
        port: PortLike,
        force: Components,
        *,
        frame: Literal["world", "body"] = "world",
        name: str | None = None,
    ) -> None:
        super().__init__(port, force, frame, name)


@named_arguments
class PointTorque(_Concentrated):
    """A torque at a port: on a flexible interface it turns the interface, on a rigid body its place does not matter.

    torque: three numbers or signals [N m], or (signal, direction (3,)). frame: the axes of its components, "world" or
    "body" (turning with the body's frame). A constant torque about fixed axes has no potential in space; its work is
    counted from the turns that the body makes.
    """

    kind = "point_torque"
    what = "torque"

    def __init__(
        self,
        port: PortLike,
        torque: Components,
        *,
        frame: Literal["world", "body"] = "world",
        name: str | None = None,
    ) -> None:
        super().__init__(port, torque, frame, name)


def _components(value: Any, label: str) -> tuple[Signal, Signal, Signal]:
    try:
        parts = list(value)
    except TypeError:
        parts = []
    if len(parts) == 2:
        if np.shape(parts[1]) != (3,):
            raise InputError(
                f"{label}: two values are (signal, direction) with a direction (3,), got {value!r}; give three "
                "components, (x, y, z), or for example (10.0, (0, 0, 1))"
            )
        direction = require_direction(parts[1], f"{label}: direction")
        signal = as_signal(parts[0], f"{label}: signal")
        x, y, z = (signal.scaled(float(d)) for d in direction)
        return x, y, z
    if len(parts) != 3:
        raise InputError(
            f"{label}: give three components, (0, 0, -10), or (signal, direction), (10.0, (0, 0, -1)), got {value!r}"
        )
    x, y, z = (as_signal(part, f"{label}: component {axis}") for part, axis in zip(parts, "xyz", strict=True))
    return x, y, z
