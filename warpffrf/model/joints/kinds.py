"""Fixed joint: d = 0, A = 1 with d = A_a^T (x_b - x_a), A = A_a^T A_b; no coordinate.

Revolute joint: d = 0, A e_z = e_z with d = A_a^T (x_b - x_a), A = A_a^T A_b; coordinate "rotation" [rad].

Cylindrical joint: d_x = d_y = 0, A e_z = e_z; coordinates "translation" d_z [m] and "rotation" [rad].

Planar joint: d_z = 0, A e_z = e_z; coordinate "rotation" [rad].

Prismatic joint: d_x = d_y = 0, A = 1; coordinate "translation" d_z [m].

Spherical joint: d = 0; rotations are free and have no coordinate.

Universal (Cardan, Hooke) joint: two crossing hinges at a right angle, without the mass of the cross.

Marker x is the first axis, fixed to a; marker y the second, fixed to b; the joint holds d = 0 and u_x . w_y = 0. With
`rotation` alpha of the cross against a about u_x and `second_rotation` beta of b against the cross about w_y,

    A_a^T A_b = R_x(alpha) R_y(beta),    w_y = cos(alpha) u_y + sin(alpha) u_z,    u_x = cos(beta) w_x + sin(beta) w_z,

so that alpha is the angle of w_y about u_x and beta that of b about w_y, measured against u_x. Neither has a gimbal
lock: shafts perpendicular to their axis of the cross at any beta.

Point on a line: d_x = d_y = 0; coordinate "translation" d_z [m]; rotations are free.

Point in a plane: d_z = 0; rotations and sliding in the plane are free.

Line in a plane: d_z = 0, e_z . A e_y = 0; b rotates about the line and about the axis, and slides in the plane.

Distance joint: |x_b - x_a| is constant, like a massless rod with a ball at each end; coordinate "distance" [m].
"""

from __future__ import annotations

from typing import Any

import numpy as np

from warpffrf.model.arguments import Vector
from warpffrf.model.bodies import PortLike
from warpffrf.model.errors import InputError, require_direction
from warpffrf.model.joints.base import (
    ABOUT,
    ALONG,
    NO_SPIN,
    ON_AXIS,
    PARALLEL,
    POINT,
    Joint,
    Marker,
    Row,
    coincident_within,
    off_axis,
)
from warpffrf.model.messages.named_arguments import named_arguments


@named_arguments
class Fixed(Joint):
    """Fixes b to a: no relative motion. `axis` only defines the marker's z axis.

    >>> hold = scene.add(wf.joints.Fixed(scene.ground, lower["bore"], axis=(0, 1, 0), name="hold"))
    """

    kind = "fixed"
    rows = (*POINT, *PARALLEL, *NO_SPIN)

    def __init__(
        self,
        a: PortLike,
        b: PortLike,
        *,
        axis: Vector = (0.0, 0.0, 1.0),
        point: Vector | None = None,
        name: str | None = None,
    ) -> None:
        super().__init__(a, b, axis=axis, point=point, name=name)


@named_arguments
class Revolute(Joint):
    """Allows rotation of b relative to a about the axis; coordinate "rotation", the angle [rad], not limited to one
    revolution.

    >>> machine = wf.Scene(gravity=(0, 0, 0))
    >>> wheel = machine.add_rigid_body(1.0, (0.01, 0.02, 0.01), name="wheel")
    >>> axle = machine.add(wf.joints.Revolute(machine.ground, wheel, axis=(0, 1, 0), name="axle"))
    """

    kind = "revolute"
    rows = (*POINT, *PARALLEL)
    coordinates = {"rotation": ABOUT}


@named_arguments
class Cylindrical(Joint):
    """Allows rotation of b about the axis and sliding along it; coordinates "translation" [m] and "rotation" [rad].

    The ports may lie apart along the axis at the initial pose; both coordinates are zero there.
    """

    kind = "cylindrical"
    rows = (*ON_AXIS, *PARALLEL)
    coordinates = {"translation": ALONG, "rotation": ABOUT}

    def mismatch(self, d: np.ndarray) -> float:
        return off_axis(self, d)


@named_arguments
class Planar(Joint):
    """Allows translation of b perpendicular to the axis and rotation about it, as a shaft in a journal bearing;
    coordinate "rotation", the angle [rad], not limited to one revolution.

    Its ports may be apart perpendicular to the axis at the initial pose: the joint is then located at b's.
    """

    kind = "planar"
    rows = (ALONG, *PARALLEL)
    coordinates = {"rotation": ABOUT}

    def mismatch(self, d: np.ndarray) -> float:
        return abs(float(d @ self.axis))


@named_arguments
class Prismatic(Joint):
    """Allows sliding of b relative to a along the axis; coordinate "translation", the displacement [m].

    Its ports may be apart at the initial pose: the joint is then located at b's.

    >>> guide = scene.add(wf.joints.Prismatic(scene.ground, upper["bore"], axis=(0, 0, 1), name="guide"))
    """

    kind = "prismatic"
    rows = (*ON_AXIS, *PARALLEL, *NO_SPIN)
    coordinates = {"translation": ALONG}

    def mismatch(self, d: np.ndarray) -> float:
        return 0.0


@named_arguments
class Spherical(Joint):
    """Fixes a point of b to a point of a; all rotations are free. No coordinate."""

    kind = "spherical"
    rows = POINT

    def __init__(self, a: PortLike, b: PortLike, *, point: Vector | None = None, name: str | None = None) -> None:
        super().__init__(a, b, axis=(0.0, 0.0, 1.0), point=point, name=name)


PERPENDICULAR = 1e-6  # cosine of the two axes: input of six digits; the second is then made perpendicular to the first


@named_arguments
class Universal(Joint):
    """A cross with `axis` fixed to a and `second_axis` fixed to b, perpendicular to each other at the initial pose.

    Coordinates "rotation" (of the cross against a about `axis`) and "second_rotation" (of b against the cross about
    `second_axis`), both [rad]. Directions (3,) in the world at the initial pose. Raises `InputError` where they are not
    perpendicular.
    """

    kind = "universal"
    rows = (*POINT, Row("direction", 0, 1))
    coordinates = {"rotation": Row("angle", 0, 1), "second_rotation": Row("second_angle", 1, 0)}

    def __init__(
        self,
        a: PortLike,
        b: PortLike,
        *,
        axis: Vector,
        second_axis: Vector,
        point: Vector | None = None,
        name: str | None = None,
    ) -> None:
        super().__init__(a, b, axis=axis, point=point, name=name)
        second = require_direction(second_axis, f"{self.label}: second_axis")
        cosine = float(self.axis @ second)
        if abs(cosine) > PERPENDICULAR:
            raise InputError(
                f"{self.label}: axis and second_axis must be perpendicular, their angle is "
                f"{np.degrees(np.arccos(np.clip(cosine, -1.0, 1.0))):.6g} degrees"
            )
        self.second_axis = require_direction(second - cosine * self.axis, f"{self.label}: second_axis")

    def axes(self) -> np.ndarray:
        return np.stack([self.axis, self.second_axis, np.cross(self.axis, self.second_axis)], axis=1)

    def describe(self) -> dict[str, Any]:
        return {**super().describe(), "second_axis": self.second_axis.tolist()}


@named_arguments
class PointOnLine(Joint):
    """Keeps a point of b on the line through a's point along the axis, which is fixed to a.

    Coordinate "translation", the displacement of the point along the line [m] from its position at the initial pose.
    The ports may lie apart along the axis there.
    """

    kind = "point_on_line"
    rows = ON_AXIS
    coordinates = {"translation": ALONG}

    def mismatch(self, d: np.ndarray) -> float:
        return off_axis(self, d)


@named_arguments
class PointInPlane(Joint):
    """Keeps a point of b in the plane through a's point perpendicular to the axis, which is fixed to a: a ball in a
    slot.

    It has no coordinate. The ports may lie apart across the axis at the initial pose.
    """

    kind = "point_in_plane"
    rows = (ALONG,)
    coordinates = {}

    def mismatch(self, d: np.ndarray) -> float:
        return abs(float(d @ self.axis))


@named_arguments
class LineInPlane(Joint):
    """Keeps a line of b, through its point along `line`, in the plane through a's point perpendicular to `axis`, which
    is fixed to a: a roller in the pocket of a cage, whose axis cannot skew out of the plane.

    line: direction (3,), world, at the initial pose, perpendicular to the axis; fixed to b from then on. It has no
    coordinate. The ports may lie apart across the axis at the initial pose. Raises `InputError` for a line that does
    not lie in the plane.
    """

    kind = "line_in_plane"
    rows = (ALONG, Row("direction", 2, 1))
    coordinates = {}

    def __init__(
        self,
        a: PortLike,
        b: PortLike,
        *,
        axis: Vector,
        line: Vector,
        point: Vector | None = None,
        name: str | None = None,
    ) -> None:
        super().__init__(a, b, axis=axis, point=point, name=name)
        given = require_direction(line, f"{self.label}: line")
        cosine = float(self.axis @ given)
        if abs(cosine) > PERPENDICULAR:
            raise InputError(
                f"{self.label}: the line must lie in the plane across axis, it is "
                f"{np.degrees(np.arcsin(np.clip(abs(cosine), 0.0, 1.0))):.6g} degrees out of it"
            )
        self.line = require_direction(given - cosine * self.axis, f"{self.label}: line")

    def mismatch(self, d: np.ndarray) -> float:
        return abs(float(d @ self.axis))

    def axes(self) -> np.ndarray:
        return np.stack([np.cross(self.line, self.axis), self.line, self.axis], axis=1)

    def describe(self) -> dict[str, Any]:
        return {**super().describe(), "line": self.line.tolist()}


@named_arguments
class Distance(Joint):
    """Constrains the distance of two ports a and b to its initial value, or to that of a drive (a telescopic rod).

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
        """The initial length [m], for any row; raises `InputError` where the ports coincide: the rod then has no
        direction."""
        length = float(np.linalg.norm(self.b.world_point() - self.a.world_point()))
        if length <= coincident_within(self.a, self.b):
            raise InputError(
                f"{self.label}: its ports {self.a.label} and {self.b.label} coincide, the rod has no direction; use a "
                "Spherical joint, or move one"
            )
        return length

    def world_point(self) -> np.ndarray:
        """Position of b's port (3,) [m], where the reaction on the second body acts."""
        return self.b.world_point()

    def frames(self) -> tuple[Marker, Marker]:
        self.initial_value(self.rows[0])
        world = self.axes()
        return self._marker(self.a, self.a.world_point(), world), self._marker(self.b, self.b.world_point(), world)
