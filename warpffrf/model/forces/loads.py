r"""Concentrated force and torque at a port.

Nodal load. Forces spread over the nodes of a free interface.

An interface of kind "free" keeps its nodes X_k and the displacement of the global modes there, `node_modes`. Forces F_k
at the nodes, times a signal, rotate with the body:

    force = sum F_k,      torque = sum X_k cross F_k,      f_m = sum_k node_modes_mk . F_k.

Local modes do not move these nodes, so this is the complete load. Rigid and averaging interfaces store only their
resultant motion; only a `PointForce` and a `PointTorque` can be applied to them.

Surface load. Pressure on a contact surface of a flexible body.

The pressure `s(t) p(theta, z)`, `p = sum_i p_i psi_i` with the shape functions psi_i of the surface's contact grid,
acts inwards along the undeformed normal n and rotates with the body. Its load on the body is stored as constants in
body axes,

    force = -int p n dA,      torque = -int p x cross n dA,      f_m = -sum_ij p_i M_ij (mode_normal)_jm,

force and torque by Gauss points in every cell of the grid, the modal forces exactly: `mode_normal` of `ContactSurface`
holds the outward normal displacement of the global modes as coefficients of the shape functions and M is their Gram
matrix. The body's global modes and interfaces respond as to the true pressure; the local indentation under the
pressure, which moves no interface, is neglected.

Pretension of a bolt: a force that pulls two ports together, and from a given time on the resulting length.

A bolt is tightened with a known force F; its later response to loads follows from its stiffness. So the coordinate s of
a joint, the distance of its two sides along the axis, obeys

    lambda = F(t)    until `lock_at`,        s = s_lock    from then on,

lambda the pull on the coordinate, positive where it draws the sides together, and s_lock the value of s at the end of
the first step, in time or static, that ends at `lock_at` or later, so that locking alone changes nothing. The other
relative motions are the joint's.

With the joint between the two faces of a cut through the shank of a bolt (`Mesh.cut`) this is the *pretension section*
of finite-element programs: a Prismatic joint holds five relative coordinates of the faces, tension moves the faces
into one another by the shortening -s, as tightening the nut shortens the shank. Between head and nut of a bolt without
a mesh, `JointSpringDamper` with a preload represents the bolt with its stiffness.

Work of the tension is work of forces, `-(lambda_0 + lambda_1)/2 (s_1 - s_0)` per step, none once the length is locked.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from typing import Any, Literal, TypeAlias

import numpy as np
from numpy.typing import NDArray

from warpffrf.model.arguments import Matrix, Vector
from warpffrf.model.bodies import Body, Ground, Port, PortLike, SurfacePort, as_port
from warpffrf.model.errors import InputError, require_array, require_direction, require_number
from warpffrf.model.forces.force import Force
from warpffrf.model.forces.laws import BodyLoad, Coordinate, PointLoad, TensionLaw
from warpffrf.model.joints import Joint
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
            raise InputError(f"{label}: a {self.what} on the ground has no effect; choose a port of a body")
        if frame not in FRAMES:
            raise InputError(f"{label}: frame must be one of {', '.join(FRAMES)}, got {frame!r}")
        self.frame = frame
        self.components: tuple[Signal, Signal, Signal] = _components(value, label)

    @property
    def ports(self) -> tuple[Port, ...]:
        return (self.port,)

    def load(self) -> PointLoad:
        """The law that the simulation applies."""
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
    "body" (rotating with the body's frame). `components` are its three signals.

    >>> push = scene.add(wf.forces.PointForce(upper["bore"], (0, 0, -50.0), name="push"))  # N, world axes
    """

    kind = "point_force"
    what = "force"

    def __init__(
        self, port: PortLike, force: Components, *, frame: Literal["world", "body"] = "world", name: str | None = None
    ) -> None:
        super().__init__(port, force, frame, name)


@named_arguments
class PointTorque(_Concentrated):
    """A torque at a port: on a flexible interface it rotates the interface; on a rigid body its point of application
    does not matter.

    torque: three numbers or signals [N m], or (signal, direction (3,)). frame: the axes of its components, "world" or
    "body" (rotating with the body's frame). A constant torque about fixed axes has no potential in space; its work is
    computed from the rotation of the body.
    """

    kind = "point_torque"
    what = "torque"

    def __init__(
        self, port: PortLike, torque: Components, *, frame: Literal["world", "body"] = "world", name: str | None = None
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


@named_arguments
class NodalLoad(Force):
    """Forces on the nodes of a free interface of a flexible body, in body axes.

    port: `body['name of the interface']`. forces: (k, 3) [N], one per node in the order of the interface's `nodes`, or
    (3,), a total that is distributed equally. signal: a number or signal [-] that multiplies them. Raises `InputError`
    for another kind of interface.
    """

    kind = "nodal_load"

    def __init__(
        self, port: PortLike, forces: Vector | Matrix, *, signal: SignalLike = 1.0, name: str | None = None
    ) -> None:
        label = f"nodal load {name!r}" if name else "nodal load"
        self.name = name
        self.port = as_port(port, f"{label}: port")
        interface = self._interface()
        if interface is None or interface.nodes is None:
            raise InputError(
                f"{label}: {self.port.label} keeps no nodes; reduce the body with interfaces={{name: 'free'}}, or "
                "apply the resultant with PointForce and PointTorque"
            )
        count = len(interface.nodes)
        if np.ndim(np.asarray(forces)) == 1:
            forces = np.tile(require_array(forces, f"{label}: forces", (3,)) / count, (count, 1))
        self.forces = require_array(forces, f"{label}: forces", (count, 3))
        self.signal = as_signal(signal, f"{label}: signal")

    def _interface(self) -> Any:
        body, name = self.port.body, self.port.interface_name
        if not isinstance(body, Body) or body.reduced is None or name is None:
            return None
        return body.reduced.interfaces[name]

    @property
    def ports(self) -> tuple[Port, ...]:
        return (self.port,)

    def load(self) -> BodyLoad:
        """Resultants and modal forces of the forces, body axes, about the user origin."""
        interface = self._interface()
        torque = np.cross(interface.nodes, self.forces).sum(axis=0)
        modal = np.einsum("mki,ki->m", interface.node_modes, self.forces)
        return BodyLoad(self.port.body, self.forces.sum(axis=0), torque, modal, self.signal)

    def describe(self) -> dict[str, Any]:
        """Plain data for hashing."""
        fields = {"kind": self.kind, "name": self.name, "port": self.port.describe()}
        return {**fields, "forces": self.forces.tolist(), "signal": self.signal.describe()}


GAUSS = 4  # points per direction in a cell: shape functions times the normal, not polynomial for a crown; error 1e-12


@named_arguments
class SurfaceLoad(Force):
    """A pressure on a contact surface of a flexible body, in body axes.

    surface: `body['name of the surface']`. pressure: a number or signal [Pa], positive inwards. distribution: None:
    uniform; else the factor: coefficients (columns, rows) of the nodes of the surface's grid, or a function of points
    (..., 3) [m, user frame] that is evaluated at the grid's nodes. Raises `InputError`.
    """

    kind = "surface_load"

    def __init__(
        self,
        surface: SurfacePort,
        pressure: SignalLike,
        *,
        distribution: Callable[[np.ndarray], np.ndarray] | Matrix | None = None,
        name: str | None = None,
    ) -> None:
        label = f"surface load {name!r}" if name else "surface load"
        if not isinstance(surface, SurfacePort) or surface.rigid:
            raise InputError(
                f"{label}: a contact surface of a flexible body is needed, body['name'], got "
                f"{getattr(surface, 'label', surface)!r}; for the "
                "nodes of a free interface use NodalLoad, for a resultant at an interface PointForce and PointTorque"
            )
        self.name = name
        self.surface = surface
        self.pressure = as_signal(pressure, f"{label}: pressure")
        grid = surface.surface.grid
        if distribution is None:
            distribution = np.ones((grid.columns, grid.rows))
        elif callable(distribution):
            theta, z = np.meshgrid(grid.theta, grid.z, indexing="ij")
            distribution = distribution(surface.surface.shape.point(theta, z))
        self.distribution = require_array(distribution, f"{label}: distribution", (grid.columns, grid.rows))

    @property
    def ports(self) -> tuple[SurfacePort, ...]:
        return (self.surface,)

    def load(self) -> BodyLoad:
        """Resultants and modal forces of a unit pressure, body axes, about the user origin."""
        surface, p = self.surface.surface, self.distribution
        grid = surface.grid
        force, torque = _resultant(surface, p)
        along = p @ surface.gram_z  # (columns, rows): M_z first, then M_theta
        weighted = grid.along_theta(along)
        modal = -weighted.ravel() @ np.asarray(surface.mode_normal, dtype=np.float64)
        return BodyLoad(self.surface.body, force, torque, modal, self.pressure)

    def describe(self) -> dict[str, Any]:
        """Plain data for hashing."""
        return {
            "kind": self.kind, "name": self.name, "body": self.surface.body.name, "surface": self.surface.name,
            "pressure": self.pressure.describe(), "distribution": self.distribution.tolist(),
        }  # fmt: skip


def _resultant(surface: Any, p: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """-int p n dA [m2] and -int p x cross n dA [m3] of the nodal coefficients p (columns, rows)."""
    grid, shape = surface.grid, surface.shape
    padded = p if not grid.periodic else np.vstack([p, p[:1]])
    theta0 = grid.theta_start + grid.pitch * np.arange(len(padded))
    if not grid.periodic:  # the outermost shape functions end one pitch beyond the outermost nodes
        padded = np.vstack([0.0 * p[:1], p, 0.0 * p[:1]])
        theta0 = grid.theta_start + grid.pitch * np.arange(-1, grid.columns + 1)
    x, w = np.polynomial.legendre.leggauss(GAUSS)
    x, w = 0.5 * (x + 1.0), 0.5 * w
    z0, dz = grid.z[:-1], np.diff(grid.z)
    theta = theta0[:-1, None] + grid.pitch * x  # (cells, GAUSS)
    z = z0[:, None] + dz[:, None] * x
    along = np.stack([1.0 - x, x])  # (2, GAUSS)
    corner = np.stack([padded[:-1], padded[1:]])  # (2, cells, rows)
    corner = np.stack([corner[..., :-1], corner[..., 1:]])  # (2 z, 2 theta, cells, cells z)
    value = np.einsum("batc,ag,bh->tgch", corner, along, along)
    T, Z = np.broadcast_arrays(theta[:, :, None, None], z[None, None])
    measure = shape.radius_at(Z) * np.sqrt(1.0 + shape.slope_at(Z) ** 2)
    weight = value * measure * grid.pitch * w[:, None, None] * (dz[:, None] * w)
    n, point = shape.normal(T, Z), shape.point(T, Z)
    force = -np.einsum("tgch,tgchi->i", weight, n)
    torque = -np.einsum("tgch,tgchi->i", weight, np.cross(point, n))
    return force, torque


@named_arguments
class Pretension(Force):
    """Pulls the two sides of a joint together with a force, and later locks the length between them.

    joint: leaves a translation or a distance free, such as a `Prismatic` joint between the faces of `Mesh.cut`.
    preload: a number or a signal [N], positive: tension, b is drawn towards a. lock_at [s]: from the end of the first
    step at or after this time on the coordinate is constant; 0 locks the start state of a run, "equilibrium" for one;
    None: the preload acts throughout. coordinate: the joint's, or None where it has one only. A static state has the
    preload unless its time is beyond lock_at, or it continues a run that has locked. Once locked it stays so, in
    later stages and in runs that continue from a checkpoint.

    The force in the results is that on the second body, the deformation the coordinate [m]. Raises `InputError` for a
    coordinate that is no length, or that the joint constrains.
    """

    kind = "pretension"

    def __init__(
        self,
        joint: Joint,
        preload: SignalLike,
        *,
        lock_at: float | None = None,
        coordinate: str | None = None,
        name: str | None = None,
    ) -> None:
        label = f"pretension {name!r}" if name else "pretension"
        if not isinstance(joint, Joint):
            raise InputError(f"{label}: acts on a joint, got {joint!r}; a Prismatic joint between the faces of a cut")
        try:
            self.coordinate = joint.coordinate(coordinate)
        except InputError as error:
            raise InputError(f"{label}: {error}") from None
        row = joint.coordinates[self.coordinate]
        if not row.is_length or row in joint.rows:
            free = [c for c, r in joint.coordinates.items() if r.is_length and r not in joint.rows]
            known = f"it leaves free {', '.join(free)}" if free else "it leaves no length free; take a Prismatic joint"
            raise InputError(f"{label}: pulls along a length that {joint.label} leaves free, {known}")
        self.name = name
        self.joint = joint
        self.preload = as_signal(preload, f"{label}: preload")
        self.lock_at = None if lock_at is None else require_number(lock_at, f"{label}: lock_at", non_negative=True)

    @property
    def ports(self) -> tuple[Port, Port]:
        return self.joint.ports

    def tension(self) -> TensionLaw:
        """The law that the simulation applies."""
        row = self.joint.coordinates[self.coordinate]
        lock_at = np.inf if self.lock_at is None else self.lock_at
        return TensionLaw(self.joint, Coordinate(row.kind, row.i, row.j), self.preload, lock_at)

    def describe(self) -> dict[str, Any]:
        """Plain data for hashing."""
        fields = {name: getattr(self, name) for name in ("kind", "name", "coordinate", "lock_at")}
        return {**fields, "joint": self.joint.name, "preload": self.preload.describe()}
