"""Joints between two ports, and prescribed motion of their coordinate.

A joint has a *marker* on each side: a point and axes fixed to the body (to the interface, if it is flexible), with z
along the joint axis, coincident at the initial pose. With x_a, A_a and x_b, A_b their world positions and axes, d =
A_a^T (x_b - x_a) and A = A_a^T A_b, the joint asks for

    Fixed      d = 0,             A = 1                    no coordinate
    Revolute   d = 0,             A e_z = e_z              coordinate: angle of b against a about z [rad]
    Prismatic  d_x = d_y = 0,     A = 1                    coordinate: d_z [m]

The coordinate is zero at the initial pose.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np

from warpffrf.model import rotation as rot
from warpffrf.model.bodies import Port, as_port
from warpffrf.model.errors import InputError, require_array, require_direction
from warpffrf.model.signals import as_signal
from warpffrf.model.surface_fit import reference_direction

COINCIDENT = 1e-6  # m; two ports further apart than this at the initial pose do not meet, closer is rounding of input
QUANTITIES = ("velocity", "position")


@dataclass(frozen=True, eq=False)
class Marker:
    """A joint's frame on one body: `point` (3,) [m] and `rotation` (x, y, z, w) marker to body, user frame,
    undeformed."""

    point: np.ndarray
    rotation: np.ndarray


class Joint:
    """Two ports and an axis; see the subclasses.

    a, b: ports (`body['interface']`, `body.at(point)`, `scene.ground`). axis: direction (3,), world, at the initial
    pose. point: (3,) [m], world, at the initial pose; None takes the place of the ports, which must then coincide.
    """

    scene_list = "joints"
    kind = "joint"
    free_translation = False  # along the axis
    free_rotation = False  # about the axis

    def __init__(self, a: Any, b: Any, *, axis: Any, point: Any = None, name: str | None = None) -> None:
        label = f"joint {name!r}" if name else f"{self.kind} joint"
        self.name = name
        self.a = as_port(a, f"{label}: first port")
        self.b = as_port(b, f"{label}: second port")
        if self.a.body is self.b.body:
            raise InputError(f"{label}: both ports are on {self.a.body.name!r}; a joint needs two bodies")
        self.axis = require_direction(axis, f"{label}: axis")
        self.point = None if point is None else require_array(point, f"{label}: point", (3,))

    @property
    def has_coordinate(self) -> bool:
        """True where the joint leaves one motion free."""
        return self.free_translation or self.free_rotation

    @property
    def constraint_count(self) -> int:
        """Number of scalar constraints."""
        return 6 - self.free_translation - self.free_rotation

    @property
    def ports(self) -> tuple[Port, Port]:
        return self.a, self.b

    def world_point(self) -> np.ndarray:
        """Place of the joint (3,) [m] in the world at the initial pose.

        `point` if given; else the ports' own place, b's for a prismatic joint, whose ports may lie apart. Raises
        `InputError` where the ports of another joint do not meet.
        """
        if self.point is not None:
            return self.point
        given = [port.world_point() for port in (self.b, self.a) if port.point is not None]
        if not given:
            raise InputError(f"joint {self.name!r}: neither port has a point; give point=(x, y, z)")
        if len(given) == 2 and not self.free_translation:
            distance = float(np.linalg.norm(given[0] - given[1]))
            if distance > COINCIDENT:
                raise InputError(
                    f"joint {self.name!r}: its ports {self.a.label} and {self.b.label} are {distance:.3g} m apart; "
                    "move a body with scene.place(port, onto=port), or give point=(x, y, z)"
                )
        return given[0]

    def frames(self) -> tuple[Marker, Marker]:
        """Markers on a's and b's body, from the initial pose as it is now: call after place() and close_gap()."""
        x = self.world_point()
        e_x = reference_direction(self.axis)
        world = np.stack([e_x, np.cross(self.axis, e_x), self.axis], axis=1)
        return self._marker(self.a, x, world), self._marker(self.b, x, world)

    def describe(self) -> dict[str, Any]:
        """Plain data for hashing."""
        point = None if self.point is None else self.point.tolist()
        ports = {"a": self.a.describe(), "b": self.b.describe()}
        return {"kind": self.kind, "name": self.name, **ports, "axis": self.axis.tolist(), "point": point}

    @staticmethod
    def _marker(port: Port, x: np.ndarray, world: np.ndarray) -> Marker:
        axes = rot.matrix(port.body.rotation).T @ world
        return Marker(port.body.to_user(x), rot.quaternion(axes))


class Fixed(Joint):
    """Holds b to a: no relative motion. `axis` only names the marker's z axis."""

    kind = "fixed"

    def __init__(
        self, a: Any, b: Any, *, axis: Any = (0.0, 0.0, 1.0), point: Any = None, name: str | None = None
    ) -> None:
        super().__init__(a, b, axis=axis, point=point, name=name)


class Revolute(Joint):
    """Lets b turn against a about the axis; the coordinate is the angle [rad]."""

    kind = "revolute"
    free_rotation = True


class Prismatic(Joint):
    """Lets b slide against a along the axis; the coordinate is the displacement [m]."""

    kind = "prismatic"
    free_translation = True


class Drive:
    """Prescribes the coordinate of a revolute or prismatic joint, or its rate.

    signal: a number or a signal; [rad/s] or [m/s] for quantity="velocity", [rad] or [m] from the initial pose for
    quantity="position". A prescribed velocity is integrated exactly, so the position does not drift.
    """

    scene_list = "drives"
    kind = "drive"

    def __init__(self, joint: Joint, signal: Any, *, quantity: str = "velocity", name: str | None = None) -> None:
        if not isinstance(joint, Joint):
            raise InputError(f"drive: a joint is needed, got {joint!r}")
        if not joint.has_coordinate:
            raise InputError(f"drive: joint {joint.name or joint.kind!r} is fixed and has no coordinate to drive")
        if quantity not in QUANTITIES:
            raise InputError(f"drive: quantity must be one of {', '.join(QUANTITIES)}, got {quantity!r}")
        self.name = name
        self.joint = joint
        self.quantity = quantity
        self.signal = as_signal(signal, f"drive of joint {joint.name!r}: signal")

    @property
    def ports(self) -> tuple[Port, Port]:
        return self.joint.ports

    def position(self) -> Any:
        """The prescribed coordinate [rad or m] as a signal: the signal, or its integral from t = 0."""
        return self.signal if self.quantity == "position" else self.signal.integral()

    def describe(self) -> dict[str, Any]:
        """Plain data for hashing."""
        return {"name": self.name, "joint": self.joint.name, "quantity": self.quantity, **self.signal.describe()}
