"""Sensors: named quantities of a run with one row per saved step, `result.sensor(name).values`.

They are evaluated from saved data, so they neither cost simulation time nor affect it, and are not part of the scene's
hash. A user-defined sensor is a subclass of `Sensor` with `evaluate`.
"""

from __future__ import annotations

from abc import ABC, abstractmethod
from typing import Any, Literal

import numpy as np

from warpffrf.model.bodies import Body, Ground, Port, PortLike, as_port
from warpffrf.model.errors import InputError, require_count, unknown_name
from warpffrf.model.forces import BodyLoad, SpringLaw
from warpffrf.model.joints import Joint, coincident_within
from warpffrf.model.messages import reprs
from warpffrf.model.messages.named_arguments import named_arguments
from warpffrf.model.reduced.stress_field import von_mises

__all__ = ["Acceleration", "InterfaceForce", "JointReaction", "Position", "Sensor", "Stress", "Velocity"]


def __dir__() -> list[str]:
    return __all__


FRAMES = ("world", "body")
AXES = ("x", "y", "z")
WRENCH = ("force_x", "force_y", "force_z", "torque_x", "torque_y", "torque_z")


class Sensor(reprs.Item, ABC):
    """Base of the sensors.

    A subclass defines its `kind`, the `unit` of its values, the names of their `components`, the `frame` of their axes
    ("world" or "body"), `ports` and `evaluate`. Its constructor sets `name`.
    """

    scene_list = "sensors"
    kind = ""
    unit = ""
    components: tuple[str, ...] = AXES
    frame = "world"
    of_result = False  # True: evaluated from the `Result` on request
    name: str | None = None

    @abstractmethod
    def evaluate(self, run: Any) -> np.ndarray:
        """Values (T, components) of the saved steps.

        run: the saved data, with `time` (T,) [s], `scene` and dictionaries by name: `bodies`, `joints`, `forces`,
        `contacts`, `lumped_contacts`, `films`, with the objects that `result.body(name)` etc. return;
        `run.motion(port)` is the position, velocity and acceleration (T, 3) of a port. A class with `of_result`
        receives the `Result` itself.
        """

    def _label(self, name: str | None) -> str:
        return f"{self.kind} sensor {name!r}" if name else f"{self.kind} sensor"


@named_arguments
class _PortSensor(Sensor):
    """Motion of a port; on an interface, of the deforming interface."""

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
    """Position of a port in the world (T, 3) [m].

    >>> place = scene.add(wf.sensors.Position(upper["bore"], name="place"))
    """

    kind = "position"
    unit = "m"

    def __init__(self, port: PortLike, *, name: str | None = None) -> None:
        super().__init__(port, name=name)

    def evaluate(self, run: Any) -> np.ndarray:
        return run.motion(self.port)[0]


class Velocity(_PortSensor):
    """Velocity of a port (T, 3) [m/s] relative to the world. frame: axes of its components, "world" or "body"."""

    kind = "velocity"
    unit = "m/s"

    def evaluate(self, run: Any) -> np.ndarray:
        return run.motion(self.port, frame=self.frame)[1]


class Acceleration(_PortSensor):
    """Acceleration of a port (T, 3) [m/s2] relative to the world, without gravity. frame: axes of its components,
    "world" or "body"."""

    kind = "acceleration"
    unit = "m/s2"

    def evaluate(self, run: Any) -> np.ndarray:
        return run.motion(self.port, frame=self.frame)[2]


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

    def evaluate(self, run: Any) -> np.ndarray:
        joint = run.joints[self.joint.name]
        return np.hstack([joint.force, joint.torque])


@named_arguments
class InterfaceForce(Sensor):
    """Total load of joints, springs, bushings and concentrated loads at a port on its body (T, 6): force [N], torque [N
    m] about the moving port, world axes. An item acts at the port if it is attached to the same interface, or to the
    same point of a rigid body. Raises `InputError`."""

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

    def evaluate(self, run: Any) -> np.ndarray:
        x = run.motion(self.port)[0]
        total = np.zeros((len(x), 6))

        def add(sign: float, force: np.ndarray, torque: np.ndarray, at: np.ndarray) -> None:
            total[:, :3] += sign * force
            total[:, 3:] += sign * (torque + np.cross(at - x, force))

        for joint in run.scene.joints:
            history = run.joints[joint.name]
            points = [marker.point for marker in joint.frames()]
            at = run.motion(joint.b, point=points[1])[0]
            for sign, port, point in zip((-1.0, 1.0), joint.ports, points, strict=True):
                if _same_place(port, point, self.port):
                    add(sign, history.force, history.torque, at)
        for item in run.scene.forces:
            history = run.forces[item.name]
            law: Any = next((getattr(item, term)() for term in ("law", "slip", "tension") if hasattr(item, term)), None)
            if law is not None:
                given = law.points if isinstance(law, SpringLaw) else None
                points = given or [marker.point for marker in law.joint.frames()]
                at = run.motion(law.ports[1], point=points[1])[0]
                for sign, port, point in zip((-1.0, 1.0), law.ports, points, strict=True):
                    if _same_place(port, point, self.port):
                        add(sign, history.force, history.torque, at)
            elif len(item.ports) == 1 and _same_place(item.ports[0], None, self.port):
                at = x
                if isinstance(item.load(), BodyLoad):  # its torque is about the user origin
                    at = run.bodies[self.port.body.name].position
                add(1.0, history.force, history.torque, at)
        return total


@named_arguments
class Stress(Sensor):
    """Stress of a flexible body at one of the points named in its reduction (`reduce(..., stress={name: points})`).

    points: name of the set; index: point within it. Values (T, 7) [Pa]: the tensor xx, yy, zz, xy, yz, zx in the axes
    of the body's user frame, and the equivalent stress. Raises `InputError` for a point that does not exist.
    """

    kind = "stress"
    unit = "Pa"
    components = ("xx", "yy", "zz", "xy", "yz", "zx", "von_mises")
    frame = "body"
    of_result = True

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

    def evaluate(self, run: Any) -> np.ndarray:
        tensor = run.stress(self.body.name, self.points, only=[self.index]).tensor[:, 0]
        return np.concatenate([tensor, von_mises(tensor)[:, None]], axis=1)


def _same_place(port: Port, point: np.ndarray | None, other: Port) -> bool:
    """True for two ports of the same interface, or of the same point of a body without interfaces; `point` replaces
    that of a port on the bare ground."""
    if port.body is not other.body:
        return False
    name, other_name = getattr(port, "interface_name", ""), other.interface_name
    if name is not None or other_name is not None:
        return name == other_name
    here = point if port.point is None else port.point
    return here is not None and float(np.linalg.norm(here - other.point)) <= coincident_within(port, other)
