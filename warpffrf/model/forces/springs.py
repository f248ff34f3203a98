"""Spring and damper along a line.

Bearing: radial, axial and tilt stiffness of an axis that spins freely.

Coordinates of the second port's marker (axes w) against the first's (axes u), z along the bearing's axis:

    d = A_a^T (x_b - x_a),      theta_x = -u_y . w_z,      theta_y = u_x . w_z.

theta is the sine of the tilt of b's axis about a's x and y axes; unlike a rotation vector it is independent of the
spin, so the law holds for any number of revolutions. A bushing is unsuitable: its rotation is that of the whole frame.
The spin is the twist (`warpffrf.model.joints.base`), which does not depend on the choice of x axes.

Bushing: full 6 x 6 stiffness and damping between two ports.

With markers a and b that coincide at the initial pose, x, A their world positions and axes later on,

    e = (d, phi),      d = A_a^T (x_b - x_a),      exp(phi^) = A_a^T A_b,       |phi| < pi,

the law is `lambda = K e + D de/dt + preload` in the axes of a. Its generalised force is the gradient of the energy, not
K e taken as force and torque: with T the tangent of the exponential map, the torque conjugate to phi is `A_a T(phi)^-1`
times the last three entries of lambda, acting at x_b, which differs from K e in second order of phi and makes the work
of a closed path zero for symmetric K at any displacement of the frames. A skew part of K (an oil film) is allowed; its
work is counted as work of forces. Directions of a rubber mount with characteristics of their own have `lambda_i =
F_i(e_i) + G_i(de_i/dt) + preload_i`, uncoupled. (Rotation vector as bushing coordinate: e.g. EXUDYN's
RigidBodySpringDamper uses Tait-Bryan angles instead; the rotation vector has no preferred order of axes.)

Joint spring. Springs and dampers on the coordinate of a joint.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from typing import Any, TypeAlias

import numpy as np

from warpffrf.model import rotation as rot
from warpffrf.model.arguments import Matrix, Vector
from warpffrf.model.bodies import Port, PortLike, as_port, require_relative_motion
from warpffrf.model.errors import InputError, require_array, require_direction, require_number
from warpffrf.model.forces.characteristics import Characteristic
from warpffrf.model.forces.force import Force
from warpffrf.model.forces.laws import (
    Coordinate,
    SpringLaw,
    TensionLaw,
    described,
    matrix_6x6,
    require_damping,
    require_stiffness,
    scalar_law,
    split,
    split_directions,
    vanishes,
)
from warpffrf.model.joints import Joint, coincident_within
from warpffrf.model.messages.named_arguments import named_arguments
from warpffrf.model.signals import Constant, Signal, as_signal
from warpffrf.model.surfaces.fit import reference_direction


@named_arguments
class SpringDamper(Force):
    """A spring and damper along the line between two ports a and b.

    The force that pulls the ports together is stiffness (l - free_length) + damping dl/dt [N], l their distance [m];
    stiffness [N/m], damping [N s/m], free_length [m] or None for the distance at the initial pose. A characteristic
    (`characteristics`) instead of either number is the force over l - free_length [m], or over dl/dt [m/s]. Raises
    `InputError`.
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
        """Free length [m]: the given one, else the distance of the ports at the current initial pose.

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
        """Coordinate and law, from the current initial pose. Raises `InputError` for ports that coincide, and where
        stiffness and damping are both zero."""
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


ORTHONORMAL = 1e-6  # entries of axes given with six digits; a larger error is a mistake


Directions: TypeAlias = Matrix | Sequence[float | Characteristic]  # (6, 6), or one per direction


class TwoPorts(Force):
    """Two ports, of two bodies or two interfaces of one, that meet in a point, and marker axes there; base of bushing
    and bearing."""

    kind = ""

    def __init__(self, a: PortLike, b: PortLike, point: Vector | None, name: str | None) -> None:
        self.name = name
        self.label = f"{self.kind} {name!r}" if name else self.kind
        self.a = as_port(a, f"{self.label}: first port")
        self.b = as_port(b, f"{self.label}: second port")
        require_relative_motion(self.a, self.b, self.label)
        self.point = None if point is None else require_array(point, f"{self.label}: point", (3,))

    @property
    def ports(self) -> tuple[Port, Port]:
        return self.a, self.b

    def world_point(self) -> np.ndarray:
        """Position (3,) [m] in the world at the initial pose: `point` if given, else that of the ports. Raises
        `InputError` where they do not coincide.
        """
        if self.point is not None:
            return self.point
        given = [port.world_point() for port in self.ports if port.point is not None]
        if not given:
            raise InputError(f"{self.kind} {self.name!r}: neither port has a point; give point=(x, y, z)")
        distance = float(np.linalg.norm(given[0] - given[-1]))
        if distance > coincident_within(*self.ports):
            raise InputError(
                f"{self.kind} {self.name!r}: its ports {self.a.label} and {self.b.label} are {distance:.3g} m apart; "
                "move a body with scene.place(port, onto=port), or give point=(x, y, z)"
            )
        return given[-1]

    def markers(self, world_axes: np.ndarray) -> dict[str, Any]:
        """Ports, points and axes of the markers as `SpringLaw` takes them, of the columns `world_axes` (3, 3)."""
        x = self.world_point()
        points = tuple(port.body.to_user(x) for port in self.ports)
        axes = tuple(rot.matrix(port.body.rotation).T @ world_axes for port in self.ports)
        return {"ports": self.ports, "points": points, "axes": axes}

    def describe(self) -> dict[str, Any]:
        """Plain data for hashing."""
        point = None if self.point is None else self.point.tolist()
        return {
            "kind": self.kind, "name": self.name, "a": self.a.describe(), "b": self.b.describe(), "point": point,
        }  # fmt: skip


@named_arguments
class Bushing(TwoPorts):
    """Resists relative displacement and rotation of two ports a and b by 6 x 6 matrices; unloaded at the initial pose.

    stiffness, damping: (6, 6), or (6,) for a diagonal, on (d_x, d_y, d_z [m], phi_x, phi_y, phi_z [rad]): N/m, N/rad, N
    m/rad and the same times s. axes: (3, 3), columns are the axes of the law in the world at the initial pose, from
    where they move with the first port. point: (3,) [m], world, at the initial pose; None takes the position of the
    ports, which must then coincide. preload (6,) [N, N m]: value of the law at the initial pose, positive for tension:
    the force on the second body is minus the law. The relative rotation must stay below half a revolution. Raises
    `InputError` for a matrix whose symmetric part is negative in some direction.
    """

    kind = "bushing"

    def __init__(
        self,
        a: PortLike,
        b: PortLike,
        stiffness: Directions,
        damping: Directions | None = None,
        *,
        axes: Matrix | None = None,
        point: Vector | None = None,
        preload: Vector | None = None,
        name: str | None = None,
    ) -> None:
        super().__init__(a, b, point, name)
        label = self.label
        self.stiffness, self.elastic = _directions(stiffness, f"{label}: stiffness", require_stiffness)
        self.damping, self.viscous = _directions(
            np.zeros(6) if damping is None else damping, f"{label}: damping", require_damping
        )
        curves = [curve for curve in (*self.elastic, *self.viscous) if curve is not None]
        if not np.any(self.stiffness) and not np.any(self.damping) and all(map(vanishes, curves)):
            raise InputError(f"{label}: stiffness and damping are both zero; remove it")
        self.linear = not curves
        if curves and any(np.any(A - np.diag(np.diag(A))) for A in (self.stiffness, self.damping)):
            raise InputError(
                f"{label}: directions with characteristics are not coupled; give stiffness and damping as six values "
                "each, numbers or characteristics, or use a second bushing for the matrix"
            )
        A = np.eye(3) if axes is None else require_array(axes, f"{label}: axes", (3, 3))
        if np.abs(A.T @ A - np.eye(3)).max() > ORTHONORMAL or np.linalg.det(A) < 0.0:
            raise InputError(f"{label}: axes must be three perpendicular unit vectors in columns, right-handed")
        u, _, vt = np.linalg.svd(A)
        self.axes = u @ vt
        self.preload = np.zeros(6) if preload is None else require_array(preload, f"{label}: preload", (6,))

    def law(self) -> SpringLaw:
        """Coordinates and law, from the current initial pose. Raises `InputError` for ports that lie apart,
        and a preload in a direction without stiffness and damping."""
        Q, W, sprung = split_directions(self.stiffness, self.damping) if self.linear else self._own_directions()
        if np.abs(Q @ (W.T @ self.preload) - self.preload).max() > ORTHONORMAL * np.abs(self.preload).max():
            raise InputError(f"{self.label}: preload acts in a direction that has neither stiffness nor damping")
        return SpringLaw(
            tuple(Coordinate("bushing", vector=v) for v in Q.T),
            W.T @ self.stiffness @ W, W.T @ self.damping @ W, np.zeros(Q.shape[1]), W.T @ self.preload, sprung,
            **self.markers(self.axes), expand=W, **self._curves(Q),
        )  # fmt: skip

    def _own_directions(self) -> tuple[np.ndarray, np.ndarray, int]:
        """As `split_directions`, of directions that are not coupled: unit vectors."""
        sprung, damped = (
            [a > 0.0 or not (curve is None or curve.vanishes) for a, curve in zip(np.diag(A), curves, strict=True)]
            for A, curves in ((self.stiffness, self.elastic), (self.damping, self.viscous))
        )
        use = [i for i in range(6) if sprung[i]] + [i for i in range(6) if damped[i] and not sprung[i]]
        return np.eye(6)[:, use], np.eye(6)[:, use], sum(sprung)

    def _curves(self, Q: np.ndarray) -> dict[str, Any]:
        """The characteristics of the directions Q (6, n), in the words of `SpringLaw`."""
        if self.linear:
            return {}
        use = np.argmax(Q, axis=0)
        return {name: tuple(getattr(self, name)[i] for i in use) for name in ("elastic", "viscous")}

    def describe(self) -> dict[str, Any]:
        fields = ("stiffness", "damping", "axes", "preload")
        found = {**super().describe(), **{f: getattr(self, f).tolist() for f in fields}}
        if not self.linear:
            for name in ("elastic", "viscous"):
                found[name] = [None if curve is None else curve.describe() for curve in getattr(self, name)]
        return found


def _directions(
    value: Any, name: str, required: Callable[[Any, str], float | Characteristic]
) -> tuple[np.ndarray, tuple[Characteristic | None, ...]]:
    """A matrix (6, 6), and the characteristics of the six directions, from any form of a stiffness or damping."""
    entries = list(value) if isinstance(value, (list, tuple, np.ndarray)) else []
    if not any(isinstance(entry, Characteristic) for entry in entries):
        return matrix_6x6(value, name), (None,) * 6
    if len(entries) != 6:
        raise InputError(f"{name}: six values are needed, one per direction, got {len(entries)}")
    numbers, curves = split([required(entry, f"{name}[{i}]") for i, entry in enumerate(entries)])
    return np.diag(numbers), curves


# theta_x has the opposite sign of the coordinate u_y . w_z; the law's matrices are rotated accordingly
_COORDINATES = (
    Coordinate("translation", 0),
    Coordinate("translation", 1),
    Coordinate("translation", 2),
    Coordinate("direction", 1, 2),
    Coordinate("direction", 0, 2),
    Coordinate("twist", 2),
)
_SIGNS = np.array([1.0, 1.0, 1.0, -1.0, 1.0, 1.0])


@named_arguments
class BearingSpring(TwoPorts):
    """A bearing between two ports a and b, described by its stiffness and damping; b spins freely about `axis`.

    axis: direction (3,), world, at the initial pose; the law's axes stay with the first port. radial [N/m], 0 for a
    damper alone, axial [N/m], tilt [N m/rad], radial_tilt [N/rad] (force per tilt, moment per displacement, in the
    planes x-z and y-z: d_x with theta_y, -d_y with theta_x), cross [N/m] (skew, as of an oil film: displacement along x
    pushes along +y, one along y pushes along -x, which drives forward whirl about the axis; its work is counted as work
    of forces). radial_damping, axial_damping [N s/m], tilt_damping, spin_damping [N m s/rad]; the last brakes the spin.
    point as in `Bushing`. Moments follow the sine of the tilt. Raises `InputError`.
    """

    kind = "bearing_spring"
    quantities = (
        "radial", "axial", "tilt", "radial_tilt", "cross", "radial_damping", "axial_damping", "tilt_damping",
        "spin_damping",
    )  # fmt: skip

    def __init__(
        self,
        a: PortLike,
        b: PortLike,
        *,
        axis: Vector,
        radial: float,
        axial: float = 0.0,
        tilt: float = 0.0,
        radial_tilt: float = 0.0,
        cross: float = 0.0,
        radial_damping: float = 0.0,
        axial_damping: float = 0.0,
        tilt_damping: float = 0.0,
        spin_damping: float = 0.0,
        point: Vector | None = None,
        name: str | None = None,
    ) -> None:
        super().__init__(a, b, point, name)
        label = self.label
        self.axis = require_direction(axis, f"{label}: axis")
        self.radial = require_number(radial, f"{label}: radial", non_negative=True)
        self.axial = require_number(axial, f"{label}: axial", non_negative=True)
        self.tilt = require_number(tilt, f"{label}: tilt", non_negative=True)
        self.radial_tilt = require_number(radial_tilt, f"{label}: radial_tilt")
        self.cross = require_number(cross, f"{label}: cross")
        self.radial_damping = require_number(radial_damping, f"{label}: radial_damping", non_negative=True)
        self.axial_damping = require_number(axial_damping, f"{label}: axial_damping", non_negative=True)
        self.tilt_damping = require_number(tilt_damping, f"{label}: tilt_damping", non_negative=True)
        self.spin_damping = require_number(spin_damping, f"{label}: spin_damping", non_negative=True)
        if not any(getattr(self, quantity) for quantity in self.quantities):
            raise InputError(f"{label}: no stiffness or damping is given; give radial or radial_damping")
        if self.cross and not self.radial:
            raise InputError(f"{label}: cross {self.cross:g} N/m requires radial above zero")
        if self.radial_tilt and self.radial_tilt**2 >= self.radial * self.tilt:
            limit = np.sqrt(self.radial * self.tilt)
            raise InputError(
                f"{label}: radial_tilt {self.radial_tilt:g} must be below the root of radial times tilt, {limit:g} "
                "N/rad, otherwise some motion has negative stiffness"
            )

    def law(self) -> SpringLaw:
        """Coordinates and law, from the current initial pose."""
        K = np.diag([self.radial, self.radial, self.axial, self.tilt, self.tilt, 0.0])
        K[0, 4] = K[4, 0] = self.radial_tilt
        K[1, 3] = K[3, 1] = -self.radial_tilt
        K[0, 1], K[1, 0] = self.cross, -self.cross
        D = np.diag([self.radial_damping] * 2 + [self.axial_damping] + [self.tilt_damping] * 2 + [self.spin_damping])
        K, D = (_SIGNS[:, None] * A * _SIGNS for A in (K, D))
        sprung = np.flatnonzero(np.diag(K))
        damped = np.flatnonzero((np.diag(K) == 0.0) & (np.diag(D) > 0.0))
        use = np.concatenate([sprung, damped])
        e_x = reference_direction(self.axis)
        world = np.stack([e_x, np.cross(self.axis, e_x), self.axis], axis=1)
        zero = np.zeros(len(use))
        return SpringLaw(
            tuple(_COORDINATES[i] for i in use), K[np.ix_(use, use)], D[np.ix_(use, use)], zero, zero, len(sprung),
            **self.markers(world), expand=np.diag(_SIGNS)[:, use],
        )  # fmt: skip

    def describe(self) -> dict[str, Any]:
        values = {q: getattr(self, q) for q in self.quantities}
        return {**super().describe(), "axis": self.axis.tolist(), **values}


ROTATION = "rotation"


@named_arguments
class JointSpringDamper(Force):
    """A spring and damper on a coordinate s of a joint: a free displacement or angle.

    The tension [N or N m] preload + stiffness (s - reference) + damping ds/dt acts against the axis on the second body
    and along it on the first. stiffness [N/m or N m/rad], damping [N s/m or N m s/rad], reference [m or rad]. preload
    [N or N m]: the tension at s = reference and at rest, positive where it draws the second body back towards the
    first; a number, or a signal of time for a gradual load. coordinate: the name of the joint's coordinate
    ("translation", "rotation", ...), or None where it has only one. Angles are not limited to one revolution, so a
    spiral spring winds up over any number of them. A characteristic (`characteristics`) instead of stiffness or damping
    is the force over s - reference, or over ds/dt. Between interfaces under head and nut, on a joint that leaves their
    axis free, it is a bolt with this preload. Raises `InputError`.

    A gradual load, with `guide` as in `joints.Prismatic`:

    >>> load = wf.signals.SmoothStep(100.0, 1000.0, duration=1e-3)  # N
    >>> press = scene.add(wf.forces.JointSpringDamper(guide, stiffness=1e5, damping=100.0, preload=load, name="press"))
    """

    kind = "joint_spring_damper"

    def __init__(
        self,
        joint: Joint,
        stiffness: float | Characteristic,
        damping: float | Characteristic = 0.0,
        *,
        coordinate: str | None = None,
        reference: float = 0.0,
        preload: float | Signal = 0.0,
        name: str | None = None,
    ) -> None:
        label = f"joint spring {name!r}" if name else "joint spring"
        if not isinstance(joint, Joint):
            raise InputError(f"{label}: acts on a joint, got {joint!r}")
        free = [c for c, row in joint.coordinates.items() if row not in joint.rows]
        if not free:
            raise InputError(
                f"{label}: acts on a coordinate that its joint leaves free, {joint.kind} joint {joint.name!r} has none"
            )
        self.coordinate = joint.coordinate(coordinate)
        if self.coordinate not in free:
            raise InputError(
                f"{label}: {joint.label} constrains its {self.coordinate}; it leaves free {', '.join(free)}"
            )
        self.name = name
        self.joint = joint
        self.stiffness = require_stiffness(stiffness, f"{label}: stiffness")
        self.damping = require_damping(damping, f"{label}: damping")
        self.reference = require_number(reference, f"{label}: reference")
        given = as_signal(preload, f"{label}: preload")
        self.preload: float | Signal = given.value if isinstance(given, Constant) else given

    @property
    def ports(self) -> tuple[Port, Port]:
        return self.joint.ports

    def law(self) -> SpringLaw:
        """Coordinate and law. Raises `InputError` where stiffness and damping are both zero."""
        if vanishes(self.stiffness) and vanishes(self.damping):
            raise InputError(
                f"joint spring {self.name!r}: stiffness and damping are both zero; use a PointForce or PointTorque"
            )
        constant = 0.0 if isinstance(self.preload, Signal) else self.preload
        return scalar_law(
            self._row(), self.stiffness, self.damping, self.reference, constant, ports=self.ports, joint=self.joint
        )

    def tension(self) -> TensionLaw | None:
        """The preload that changes with time, in addition to the law; None of a constant one."""
        if not isinstance(self.preload, Signal):
            return None
        return TensionLaw(self.joint, self._row(), self.preload, np.inf)

    def _row(self) -> Coordinate:
        row = self.joint.coordinates[self.coordinate]
        return Coordinate(row.kind, row.i, row.j)

    def describe(self) -> dict[str, Any]:
        """Plain data for hashing."""
        fields = ("kind", "name", "coordinate", "stiffness", "damping", "reference", "preload")
        return {**{f: described(getattr(self, f)) for f in fields}, "joint": self.joint.name}


@named_arguments
class TorsionalSpringDamper(JointSpringDamper):
    """A spring and damper on the angle of a revolute or cylindrical joint: `JointSpringDamper` with
    coordinate="rotation". stiffness [N m/rad], damping [N m s/rad], or characteristics; reference [rad], preload [N
    m]."""

    kind = "torsional_spring_damper"

    def __init__(
        self,
        joint: Joint,
        stiffness: float | Characteristic,
        damping: float | Characteristic = 0.0,
        *,
        reference: float = 0.0,
        preload: float | Signal = 0.0,
        name: str | None = None,
    ) -> None:
        super().__init__(
            joint, stiffness, damping, coordinate=ROTATION, reference=reference, preload=preload, name=name
        )
