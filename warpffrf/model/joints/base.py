"""What all joints share: two ports, the markers on them, and the tables of rows that a kind of joint is.

A joint has a *marker* on each side: a point and axes fixed to the body (to the interface, if it is flexible), with z
along the joint axis, coincident at the initial pose unless the joint says otherwise. A kind of joint is two tables of
`Row`: `rows`, the functions that it holds at their initial values, and `coordinates`, the named ones it leaves free,
which can be driven and are recorded. All of them are zero at the initial pose, except a distance.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any, ClassVar

import numpy as np

from warpffrf.model import rotation as rot
from warpffrf.model.arguments import Vector
from warpffrf.model.bodies import Port, PortLike, as_port, require_relative_motion
from warpffrf.model.errors import InputError, require_array, require_direction, unknown_name
from warpffrf.model.joints.rows import Row
from warpffrf.model.messages import reprs
from warpffrf.model.messages.named_arguments import named_arguments
from warpffrf.model.surfaces.fit import reference_direction

# of the largest coordinate or size at hand (1 um at 0.1 m): two ports further apart than this at the initial pose do
# not meet, closer is rounding of input
COINCIDENT = 1e-5

POINT = (Row("translation", 0), Row("translation", 1), Row("translation", 2))
ON_AXIS = POINT[:2]
PARALLEL = (Row("direction", 2, 0), Row("direction", 2, 1))  # z axes: no rotation about y and x
NO_SPIN = (Row("direction", 0, 1),)  # no rotation about z
ALONG = Row("translation", 2)
ABOUT = Row("angle", 2, 0)


def coincident_within(*ports: Port) -> float:
    """Distance [m] up to which ports are at one place: COINCIDENT of their coordinates, in the world and on the body,
    or of a radius of gyration."""
    sizes = [0.0]
    for port in ports:
        if port.point is not None:
            sizes += [np.linalg.norm(port.point), np.linalg.norm(port.world_point())]
        if port.body.index >= 0 and port.body.mass > 0.0:
            sizes.append(np.sqrt(np.trace(port.body.inertia) / (3.0 * port.body.mass)))
    return COINCIDENT * float(max(sizes))


@dataclass(frozen=True, eq=False)
class Marker:
    """A joint's frame on one body: `point` (3,) [m] and `rotation` (x, y, z, w) marker to body, user frame,
    undeformed."""

    point: np.ndarray
    rotation: np.ndarray


@named_arguments
class Joint(reprs.Item):
    """Two ports and an axis; see the subclasses.

    a, b: ports (`body['interface']`, `body.at(point)`, `scene.ground`) of two bodies, or two interfaces of one flexible
    body, which its modes move against each other. axis: direction (3,), world, at the initial
    pose. point: (3,) [m], world, at the initial pose; None takes the place of the ports, which must then meet.
    """

    scene_list = "joints"
    kind: ClassVar[str] = "joint"
    rows: ClassVar[tuple[Row, ...]] = ()
    coordinates: ClassVar[dict[str, Row]] = {}

    def __init__(
        self, a: PortLike, b: PortLike, *, axis: Vector, point: Vector | None = None, name: str | None = None
    ) -> None:
        label = f"joint {name!r}" if name else f"{self.kind} joint"
        self.name = name
        self.a = as_port(a, f"{label}: first port")
        self.b = as_port(b, f"{label}: second port")
        require_relative_motion(self.a, self.b, label)
        self.axis = require_direction(axis, f"{label}: axis")
        self.point = None if point is None else require_array(point, f"{label}: point", (3,))

    @property
    def label(self) -> str:
        """Readable name, for messages."""
        return f"joint {self.name!r}" if self.name else f"{self.kind} joint"

    @property
    def ports(self) -> tuple[Port, Port]:
        return self.a, self.b

    def coordinate(self, name: str | None = None) -> str:
        """Name of the coordinate called `name`, or of the only one where that is None.

        Raises `InputError` for a joint without coordinates, an unknown name, and None where there are several.
        """
        known = list(self.coordinates)
        if not known:
            raise InputError(f"{self.label} is {self.kind} and has no coordinate")
        if name is None:
            if len(known) > 1:
                listed = ", ".join(f"coordinate={c!r}" for c in known)
                raise InputError(f"{self.label}: a {self.kind} joint has several coordinates; choose one of {listed}")
            return known[0]
        if name not in known:
            raise unknown_name(f"{self.label}: coordinate", name, known)
        return name

    def initial_value(self, row: Row) -> float:
        """Value [m or rad] of a row at the initial pose: what a constraint holds, where a coordinate starts."""
        return 0.0

    def world_point(self) -> np.ndarray:
        """Place of the joint (3,) [m] in the world at the initial pose: `point` if given, else b's, else a's.

        Raises `InputError` where the ports do not meet as the kind of joint demands.
        """
        if self.point is not None:
            return self.point
        given = [port.world_point() for port in (self.b, self.a) if port.point is not None]
        if not given:
            raise InputError(f"joint {self.name!r}: neither port has a point; give point=(x, y, z)")
        if len(given) == 2:
            distance = self.mismatch(given[0] - given[1])
            if distance > coincident_within(self.a, self.b):
                raise InputError(
                    f"joint {self.name!r}: its ports {self.a.label} and {self.b.label} are {distance:.3g} m apart; "
                    "move a body with scene.place(port, onto=port), or give point=(x, y, z)"
                )
        return given[0]

    def mismatch(self, d: np.ndarray) -> float:
        """Distance [m] by which two ports that lie `d` (3,) apart at the initial pose fail to meet."""
        return float(np.linalg.norm(d))

    def axes(self) -> np.ndarray:
        """Unit directions of the marker axes (3, 3) in the world at the initial pose, columns x, y, z."""
        e_x = reference_direction(self.axis)
        return np.stack([e_x, np.cross(self.axis, e_x), self.axis], axis=1)

    def frames(self) -> tuple[Marker, Marker]:
        """Markers on a's and b's body, from the initial pose as it is now: call after place() and close_gap()."""
        x, world = self.world_point(), self.axes()
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


def off_axis(joint: Joint, d: np.ndarray) -> float:
    """Length [m] of the part of `d` (3,) perpendicular to the joint's axis."""
    return float(np.linalg.norm(d - joint.axis * (joint.axis @ d)))
