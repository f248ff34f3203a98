"""Base of all joints: two ports, their markers, and the tables of rows that define a kind of joint.

A joint has a *marker* on each side: a point and axes fixed to the body (to the interface, if it is flexible), with z
along the joint axis, coincident at the initial pose unless the joint specifies otherwise. A kind of joint consists of
two tables of `Row`: `rows`, the functions constrained to their initial values, and `coordinates`, the named free ones,
which can be driven and are recorded. All of them are zero at the initial pose, except a distance.

Rows. The scalar constraint functions of joints, and their forces.

A row is a function c of two markers a and b: positions x_a, x_b and axes u_i (of a), w_j (of b), all in the world.

    translation    c = u_i . (x_b - x_a)
    distance       c = |x_b - x_a|
    direction      c = u_i . w_j
    angle          c = angle of w_j about u_i, from u_j towards u_i x u_j
    second_angle   c = angle of w_j about w_i, measured against u_j
    twist          c = rotation of b against a about the axis i, for any axis of b (swing and twist)

With dx_a, dx_b the displacements of the material points of either body that lie at x_b, and dTheta their rotations,
every variation is dc = f.(dx_b - dx_a) + t.(dTheta_b - dTheta_a). A multiplier therefore exerts the wrench -lambda (f,
t) at x_b on the second body and with its exact opposite on the first. Two angles need a derivation. With P = p.e, Q =
q.e for a vector e of one body in the orthonormal directions p, q of the other, c = atan2(P, Q) and dc = (Q dP - P
dQ)/(P^2 + Q^2). For `angle` e = w_j rotates relative to p = u_i x u_j, q = u_j, so that t = e x (Q p - P q)/(P^2 +
Q^2); for `second_angle` p = w_j x w_i, q = w_j rotate relative to e = u_j, and t is the opposite of the same
expression. On the joint (e perpendicular to the axis) t is the axis itself.

Where the axis is not constrained, these angles are those of one particular vector: to first order in the tilt they
depend on its choice. The *twist* does not. With the quaternion (q_v, q_0) of A_a^T A_b it is 2 atan2(q_i, q_0): the
shortest rotation from u_i to w_i is removed; the remainder is a rotation about u_i. In the markers' axes, p and q the
two after i,

    c = atan2(u_q.w_p - u_p.w_q, u_p.w_p + u_q.w_q),      as q_i q_0 and q_0^2 - q_i^2 are 1/4 and 1/2 of these,

and with omega the angular velocity of b against a, q_0' = -omega.q_v/2 and q_v' = (q_0 omega + omega x q_v)/2,

    c' = (u_i + w_i).omega/(1 + u_i.w_i),      t = (u_i + w_i)/(1 + u_i.w_i).

It fails only where w_i = -u_i; without a tilt it is the angle, and a tilt alone (omega perpendicular to u_i + w_i) is
no twist.

`warpffrf_kernels.constraints.rows` computes the same on the device; this is the independent copy that checks of scenes,
recorded coordinates and tests use.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property
from typing import Any, ClassVar

import numpy as np

from warpffrf.model import rotation as rot
from warpffrf.model.arguments import Vector
from warpffrf.model.bodies import Port, PortLike, as_port, require_relative_motion
from warpffrf.model.errors import InputError, require_array, require_direction, unknown_name
from warpffrf.model.messages import reprs
from warpffrf.model.messages.named_arguments import named_arguments
from warpffrf.model.surfaces.fit import reference_direction

KINDS = ("translation", "direction", "angle", "distance", "second_angle", "twist")
_AXES = "xyz"


@dataclass(frozen=True)
class Row:
    """One scalar function of two markers: its kind (see the module), axis i of marker a and axis j of marker b. Raises
    `InputError` for a kind that the kernels do not evaluate."""

    kind: str
    i: int = 0
    j: int = 0

    def __post_init__(self) -> None:
        if self.kind not in KINDS:
            raise unknown_name("joints.Row: kind", self.kind, KINDS)

    @property
    def is_length(self) -> bool:
        """True where the function is a length [m], else it is an angle or a direction cosine."""
        return self.kind in ("translation", "distance")

    @property
    def held(self) -> str:
        """Description of the constrained motion, in the joint's axes."""
        if self.kind == "translation":
            return f"translation along {_AXES[self.i]}"
        if self.kind == "distance":
            return "distance"
        about = 3 - self.i - self.j if self.kind == "direction" else self.i
        return f"rotation about {_AXES[about]}"


def _dot(a: np.ndarray, b: np.ndarray) -> np.ndarray:
    return np.einsum("...k,...k->...", a, b)


def _angle(row: Row, A_a: np.ndarray, A_b: np.ndarray) -> tuple[np.ndarray, np.ndarray, np.ndarray, float]:
    """e, p, q and the sign of the torque (see the module)."""
    first = row.kind == "angle"
    held, turned = (A_a, A_b) if first else (A_b, A_a)
    q = held[..., row.j]
    p = rot.cross(held[..., row.i], q) if first else rot.cross(q, held[..., row.i])
    return turned[..., row.j], p, q, 1.0 if first else -1.0


def value(row: Row, x_a: np.ndarray, A_a: np.ndarray, x_b: np.ndarray, A_b: np.ndarray) -> np.ndarray:
    """c (...) of markers at x (..., 3) with axes A (..., 3, 3), columns x, y, z; angles in (-pi, pi]."""
    if row.kind == "translation":
        return _dot(A_a[..., row.i], x_b - x_a)
    if row.kind == "distance":
        return np.linalg.norm(x_b - x_a, axis=-1)
    if row.kind == "direction":
        return _dot(A_a[..., row.i], A_b[..., row.j])
    if row.kind == "twist":
        p, q = (row.i + 1) % 3, (row.i + 2) % 3
        across = _dot(A_a[..., q], A_b[..., p]) - _dot(A_a[..., p], A_b[..., q])
        return np.arctan2(across, _dot(A_a[..., p], A_b[..., p]) + _dot(A_a[..., q], A_b[..., q]))
    e, p, q, _ = _angle(row, A_a, A_b)
    return np.arctan2(_dot(p, e), _dot(q, e))


def gradient(
    row: Row, x_a: np.ndarray, A_a: np.ndarray, x_b: np.ndarray, A_b: np.ndarray
) -> tuple[np.ndarray, np.ndarray]:
    """f (..., 3) and t (..., 3), world axes, of dc = f.(dx_b - dx_a) + t.(dTheta_b - dTheta_a) at x_b."""
    zero = np.zeros(np.broadcast_shapes(np.shape(x_a), np.shape(x_b)))
    if row.kind == "translation":
        return zero + A_a[..., row.i], zero
    if row.kind == "distance":
        return (x_b - x_a) / np.linalg.norm(x_b - x_a, axis=-1)[..., None], zero
    if row.kind == "direction":
        return zero, zero + rot.cross(A_b[..., row.j], A_a[..., row.i])
    if row.kind == "twist":
        u, w = A_a[..., row.i], A_b[..., row.i]
        return zero, zero + (u + w) / (1.0 + _dot(u, w))[..., None]
    e, p, q, sign = _angle(row, A_a, A_b)
    P, Q = _dot(p, e)[..., None], _dot(q, e)[..., None]
    return zero, zero + sign * rot.cross(e, Q * p - P * q) / (P * P + Q * Q)


# of the largest coordinate or size involved (1 um at 0.1 m): two ports further apart than this at the initial pose do
# not meet, closer is rounding of input
COINCIDENT = 1e-5

POINT = (Row("translation", 0), Row("translation", 1), Row("translation", 2))
ON_AXIS = POINT[:2]
PARALLEL = (Row("direction", 2, 0), Row("direction", 2, 1))  # z axes: no rotation about y and x
NO_SPIN = (Row("direction", 0, 1),)  # no rotation about z
ALONG = Row("translation", 2)
ABOUT = Row("angle", 2, 0)


def coincident_within(*ports: Port) -> float:
    """Distance [m] up to which ports coincide: COINCIDENT times their coordinates, in the world and on the body, or a
    radius of gyration."""
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

    @cached_property
    def axes(self) -> np.ndarray:
        """Axes of the marker (3, 3) in its columns, user frame."""
        return rot.matrix(self.rotation)


@named_arguments
class Joint(reprs.Item):
    """Two ports and an axis; see the subclasses.

    a, b: ports (`body['interface']`, `body.at(point)`, `scene.ground`) of two bodies, or two interfaces of one flexible
    body, with relative motion by its modes. axis: direction (3,), world, at the initial pose. point: (3,) [m], world,
    at the initial pose; None takes the position of the ports, which must then coincide.
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
        """Name of the coordinate `name`, or of the only one if `name` is None.

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
        """Value [m or rad] of a row at the initial pose: the constrained value, or the start value of a coordinate."""
        return 0.0

    def world_point(self) -> np.ndarray:
        """Position of the joint (3,) [m] in the world at the initial pose: `point` if given, else b's, else a's.

        Raises `InputError` where the ports do not coincide as the kind of joint requires.
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
        """Markers on a's and b's body, from the current initial pose: call after place() and close_gap()."""
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
