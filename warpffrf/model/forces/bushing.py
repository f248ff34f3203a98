"""Bushing: full 6 x 6 stiffness and damping between two ports.

With markers a and b that coincide at the initial pose, x, A their world positions and axes later on,

    e = (d, phi),      d = A_a^T (x_b - x_a),      exp(phi^) = A_a^T A_b,       |phi| < pi,

the law is `lambda = K e + D de/dt + preload` in the axes of a. Its generalised force is the gradient of the energy, not
K e read as force and torque: with T the tangent of the exponential map, the torque that turns phi is `A_a T(phi)^-1`
times the last three entries of lambda, acting at x_b, which differs from K e in second order of phi and makes the work
of a closed path zero for symmetric K at any displacement of the frames. A skew part of K (an oil film) is allowed; its
work is booked as work of forces. Directions of a rubber mount with characteristics of their own have
`lambda_i = F_i(e_i) + G_i(de_i/dt) + preload_i`, uncoupled. (Rotation vector as bushing coordinate: e.g. EXUDYN's
RigidBodySpringDamper uses Tait-Bryan angles instead; the rotation vector has no preferred order of axes.)
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from typing import Any, TypeAlias

import numpy as np

from warpffrf.model import rotation as rot
from warpffrf.model.arguments import Matrix, Vector
from warpffrf.model.bodies import Port, PortLike, as_port, require_relative_motion
from warpffrf.model.errors import InputError, require_array
from warpffrf.model.forces.characteristics import Characteristic
from warpffrf.model.forces.force import Force
from warpffrf.model.forces.laws import (
    Coordinate,
    SpringLaw,
    matrix_6x6,
    require_damping,
    require_stiffness,
    split,
    split_directions,
    vanishes,
)
from warpffrf.model.joints import coincident_within
from warpffrf.model.messages.named_arguments import named_arguments

ORTHONORMAL = 1e-6  # entries of axes typed with six digits; further off is a mistake


Directions: TypeAlias = Matrix | Sequence[float | Characteristic]  # (6, 6), or one a direction


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
        """Place (3,) [m] in the world at the initial pose: `point` if given, else where the ports meet.

        Raises `InputError` where they do not.
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

    stiffness, damping: (6, 6), or (6,) for a diagonal, on (d_x, d_y, d_z [m], phi_x, phi_y, phi_z [rad]): N/m, N/rad,
    N m/rad and the same times s. axes: (3, 3), columns are the axes of the law in the world at the initial pose, from
    where they move with the first port. point: (3,) [m], world, at the initial pose; None takes the place of the ports,
    which must then coincide. preload (6,) [N, N m]: what the law gives at the initial pose; the force on the second
    body is minus the law. The relative rotation must stay below half a turn. Raises `InputError` for a matrix whose
    symmetric part is negative in some direction.
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
        """Coordinates and law, from the initial pose as it is now. Raises `InputError` for ports that lie
        apart, and a preload in a direction without stiffness and damping."""
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
    """A matrix (6, 6), and the characteristics of the six directions, from what a stiffness or damping may be."""
    entries = list(value) if isinstance(value, (list, tuple, np.ndarray)) else []
    if not any(isinstance(entry, Characteristic) for entry in entries):
        return matrix_6x6(value, name), (None,) * 6
    if len(entries) != 6:
        raise InputError(f"{name}: six values are needed, one a direction, got {len(entries)}")
    numbers, curves = split([required(entry, f"{name}[{i}]") for i, entry in enumerate(entries)])
    return np.diag(numbers), curves
