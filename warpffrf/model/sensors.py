"""Sensors: quantities of a run that get a name and one row a saved step, `result.sensor(name).values`.

They are evaluated from what is saved, so they cost the simulation nothing and change nothing in it; a scene with other
sensors is the same scene. `SENSORS` is the registry by kind.
"""

from __future__ import annotations

from typing import Literal

from warpffrf.model.bodies import Body, Ground, Port, PortLike, as_port
from warpffrf.model.errors import InputError, require_count, unknown_name
from warpffrf.model.joints import Joint
from warpffrf.model.messages import reprs
from warpffrf.model.messages.named_arguments import named_arguments

__all__ = [
    "SENSORS",
    "Acceleration",
    "InterfaceForce",
    "JointReaction",
    "Position",
    "Sensor",
    "Stress",
    "Velocity",
]


def __dir__() -> list[str]:
    return __all__


FRAMES = ("world", "body")
AXES = ("x", "y", "z")
WRENCH = ("force_x", "force_y", "force_z", "torque_x", "torque_y", "torque_z")


class Sensor(reprs.Item):
    """Base of the sensors: a name, a unit, and names of the components of a row of values."""

    scene_list = "sensors"
    kind = ""
    unit = ""
    components: tuple[str, ...] = AXES
    frame = "world"
    name: str | None = None

    def _label(self, name: str | None) -> str:
        return f"{self.kind} sensor {name!r}" if name else f"{self.kind} sensor"


@named_arguments
class _PortSensor(Sensor):
    """Motion of a port: on an interface, of the interface as it deforms."""

    def __init__(self, port: PortLike, *, frame: Literal["world", "body"] = "world", name: str | None = None) -> None:
        label = self._label(name)
        self.port = as_port(port, f"{label}: port")
        if isinstance(self.port.body, Ground) or self.port.point is None:
            raise InputError(f"{label}: the ground does not move; choose a port of a body")
        if frame not in FRAMES:
            raise InputError(f"{label}: frame must be one of {', '.join(FRAMES)}, got {frame!r}")
        self.frame = frame
        self.name = name

    @property
    def ports(self) -> tuple[Port, ...]:
        return (self.port,)


@named_arguments
class Position(_PortSensor):
    """Place of a port in the world (T, 3) [m].

    >>> place = scene.add(wf.sensors.Position(upper["bore"], name="place"))
    """

    kind = "position"
    unit = "m"

    def __init__(self, port: PortLike, *, name: str | None = None) -> None:
        super().__init__(port, name=name)


class Velocity(_PortSensor):
    """Velocity of a port (T, 3) [m/s] against the world. frame: axes of its components, "world" or "body"."""

    kind = "velocity"
    unit = "m/s"


class Acceleration(_PortSensor):
    """Acceleration of a port (T, 3) [m/s2] against the world, without gravity. frame: axes of its components, "world"
    or "body"."""

    kind = "acceleration"
    unit = "m/s2"


@named_arguments
class JointReaction(Sensor):
    """Reaction of a joint and its drives on the second body (T, 6): force [N], torque [N m] about the joint point on
    the second body, world axes. Raises `InputError`."""

    kind = "joint_reaction"
    unit = "N, N m"
    components = WRENCH

    def __init__(self, joint: Joint, *, name: str | None = None) -> None:
        if not isinstance(joint, Joint):
            raise InputError(f"{self._label(name)}: a joint is needed, got {joint!r}")
        self.joint = joint
        self.name = name

    @property
    def ports(self) -> tuple[Port, Port]:
        return self.joint.ports


@named_arguments
class InterfaceForce(Sensor):
    """What joints, springs, bushings and concentrated loads at a port together exert on its body (T, 6): force [N],
    torque [N m] about the port as it moves, world axes. An item acts at the port if it was given the same interface, or
    the same point of a rigid body. Raises `InputError`."""

    kind = "interface_force"
    unit = "N, N m"
    components = WRENCH

    def __init__(self, port: PortLike, *, name: str | None = None) -> None:
        label = self._label(name)
        self.port = as_port(port, f"{label}: port")
        if self.port.point is None:
            raise InputError(f"{label}: a point is needed, use body['interface'], body.at(point) or ground.at(point)")
        self.name = name

    @property
    def ports(self) -> tuple[Port, ...]:
        return (self.port,)


@named_arguments
class Stress(Sensor):
    """Stress of a flexible body at one of the points named when it was reduced (`reduce(..., stress={name: points})`).

    points: their name; index: which of them. Values (T, 7) [Pa]: the tensor xx, yy, zz, xy, yz, zx in the axes of the
    body's user frame, and the equivalent stress. Raises `InputError` for a point that there is not.
    """

    kind = "stress"
    unit = "Pa"
    components = ("xx", "yy", "zz", "xy", "yz", "zx", "von_mises")
    frame = "body"

    def __init__(self, body: Body, points: str, index: int = 0, *, name: str | None = None) -> None:
        label = self._label(name)
        if not isinstance(body, Body) or body.reduced is None:
            raise InputError(f"{label}: a flexible body is needed, got {getattr(body, 'name', body)!r}")
        if points not in body.reduced.stress:
            raise unknown_name(f"{label}: stress points of body {body.name!r}", points, body.reduced.stress)
        self.index = require_count(index, f"{label}: index", 0)
        count = len(body.reduced.stress[points].points)
        if self.index >= count:
            raise InputError(f"{label}: index {index} is out of range, {points!r} has {count} points")
        self.body = body
        self.points = points
        self.name = name

    @property
    def ports(self) -> tuple[Port, ...]:
        return (Port(self.body, None, None),)


SENSORS = {s.kind: s for s in (Position, Velocity, Acceleration, JointReaction, InterfaceForce, Stress)}
