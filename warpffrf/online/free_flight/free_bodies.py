r"""A body in free flight on the host: its equations of motion in NumPy, for integrators that check the kernels.

With u = (w, qdot) the kinetic energy of turning and deforming (`warpffrf.model.reduced.inertia`) is one quadratic form,

    T = u.M(q) u/2,     M = [[J, H], [H^T, 1]],     J = J0 + sum q_i J1_i + sum q_i q_j J2_ij,     H_j = sum_i q_i G_ij,

its momenta are `pi = J w + H qdot` and `p = qdot + H^T w`, and Lagrange's equations are, with the torque tau and modal
forces f, stiffness k and damping c of the modes,

    pidot + w x pi = tau,      pdot_i - (w.P_i w/2 + sum_j w.G_ij qdot_j) = f_i - k_i q_i - c_i qdot_i,
    P_i = J1_i + 2 sum_j J2_ij q_j.

As G_ij is antisymmetric, sum qdot_i qdot_j G_ij = 0, and what remains is

    J wdot + H qddot = a,          a = tau - w x pi - (sum_i qdot_i P_i) w,
    H^T wdot + qddot = b,          b_i = f_i - k_i q_i - c_i qdot_i + w.P_i w/2 + 2 sum_j w.G_ij qdot_j.

The modes are eliminated: (J - H H^T) wdot = a - H b. Geometric stiffening by rotation, sum w_a w_b Kc_ab, is a part of
-J2; that by interface loads F adds -sum F_k Kf_k q to f, and moves the interface by -q.Kf_k q/2. Modes beyond the first
k, which carry no inertia terms, are oscillators.
"""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import NamedTuple

import numpy as np

from warpffrf.model import rotation as rot
from warpffrf.model.bodies import Body
from warpffrf.model.errors import InputError
from warpffrf.model.forces import PointLoad
from warpffrf.model.reduced.inertia import GeometricStiffness
from warpffrf.model.scene import Scene
from warpffrf.online.compile.inertia_plan import BodyInertia

Array = np.ndarray
CURE = "integrate with GeneralizedAlpha, HHT or Newmark"


class Motion(NamedTuple):
    """State of one body: centre of mass `r` [m], unit quaternion `p` (x, y, z, w) body to world, velocity `v` [m/s],
    all in the world; angular velocity `w` (3,) [rad/s], body axes; modal coordinates `q` (m,) and rates `qd`."""

    r: Array
    p: Array
    v: Array
    w: Array
    q: Array
    qd: Array


class Rates(NamedTuple):
    """Accelerations `v` (3,) [m/s2] world, `w` (3,) [rad/s2] body axes, `qd` (m,); power of the applied loads, and the
    power that damping takes [W]."""

    v: Array
    w: Array
    qd: Array
    power: float
    dissipation: float


@dataclass(frozen=True, eq=False)
class AppliedLoad:
    """A point load as the equations see it: `arm` (3,) [m] from the centre of mass to its point on the undeformed body,
    `shift` (m, 3) and `turn` (m, 3) motion of that point per modal coordinate, `stiffening` (6, k, k) or None."""

    load: PointLoad
    arm: Array
    shift: Array
    turn: Array
    stiffening: Array | None

    def shortening(self, q: Array) -> Array:
        """Motion (3,) [m] of the point of second order in q (m,)."""
        if self.stiffening is None:
            return np.zeros(3)
        k = self.stiffening.shape[1]
        return -0.5 * (self.stiffening[:3] @ q[:k]) @ q[:k]


@dataclass(frozen=True, eq=False)
class FreeBody:
    """Constants of one body, see the module: moments about the centre of mass, axes of the user frame."""

    name: str
    mass: float
    J0: Array
    first: Array  # (k, 3, 3)
    second: Array  # (k, k, 3, 3)
    gyroscopic: Array  # (k, k, 3)
    stiffness: Array  # (m,) 1/s^2
    damping: Array  # (m,) 1/s
    gravity: Array
    loads: list[AppliedLoad] = field(default_factory=list)

    @property
    def carrying(self) -> int:
        """Number k of modes with inertia terms."""
        return len(self.first)

    def slopes(self, q: Array) -> Array:
        """P (k, 3, 3) [kg m]: derivative of J by each of the first k modal coordinates, at q (m,)."""
        k = self.carrying
        return self.first + 2.0 * (q[:k] @ self.second.reshape(k, 9 * k)).reshape(k, 3, 3)

    def inertia(self, q: Array, P: Array) -> Array:
        """J(q) (3, 3) [kg m2] from the slopes P at q."""
        k = self.carrying
        return self.J0 + 0.5 * (q[:k] @ (self.first + P).reshape(k, 9)).reshape(3, 3)

    def coupling(self, q: Array) -> Array:
        """H^T (k, 3) [kg m]: angular momentum per unit rate of each mode, at q (m,); linear in q."""
        k = self.carrying
        return (q[:k] @ self.gyroscopic.reshape(k, 3 * k)).reshape(k, 3)

    def kinetic_energy(self, state: Motion) -> float:
        """Of translation, turning and deforming [J]."""
        v, w, q, qd = state.v, state.w, state.q, state.qd
        J, H = self.inertia(q, self.slopes(q)), self.coupling(q)
        turning = 0.5 * w @ J @ w + w @ (qd[: self.carrying] @ H)
        return float(0.5 * self.mass * v @ v + turning + 0.5 * qd @ qd)

    def strain_energy(self, state: Motion) -> float:
        """Of the modes [J]."""
        return float(0.5 * state.q @ (self.stiffness * state.q))

    def potential(self, state: Motion) -> float:
        """Of gravity [J], zero at the origin."""
        return float(-self.mass * self.gravity @ state.r)

    def rates(self, state: Motion, t: float) -> Rates:
        """Accelerations and powers of `state` at time `t` [s]."""
        w, q, qd = state.w, state.q, state.qd
        k = self.carrying
        force, a, b, power = self._applied(state, t)
        b -= self.stiffness * q + self.damping * qd
        P, H = self.slopes(q), self.coupling(q)
        J = self.inertia(q, P)
        Pw = P @ w
        a -= np.cross(w, J @ w + qd[:k] @ H) + qd[:k] @ Pw
        b[:k] += 0.5 * Pw @ w + 2.0 * (self.gyroscopic @ w) @ qd[:k]
        wdot = np.linalg.solve(J - H.T @ H, a - b[:k] @ H)
        b[:k] -= H @ wdot
        return Rates(self.gravity + force / self.mass, wdot, b, power, float(qd @ (self.damping * qd)))

    def _applied(self, state: Motion, t: float) -> tuple[Array, Array, Array, float]:
        """Force (world) and torque about the centre of mass (body axes), modal forces, and power of the point loads."""
        force, torque, modal, power = np.zeros(3), np.zeros(3), np.zeros(len(state.q)), 0.0
        if not self.loads:
            return force, torque, modal, power
        A = rot.matrix(state.p)
        for applied in self.loads:
            value = np.array([float(signal(t)) for signal in applied.load.components])
            local = value if applied.load.frame == "body" else A.T @ value
            if applied.load.what == "force":
                arm = applied.arm + state.q @ applied.shift + applied.shortening(state.q)
                force += A @ local
                torque += np.cross(arm, local)
                modal += applied.shift @ local
                power += local @ (A.T @ state.v + np.cross(state.w, arm) + state.qd @ applied.shift)
            else:
                torque += local
                modal += applied.turn @ local
                power += local @ (state.w + state.qd @ applied.turn)
            if applied.stiffening is not None:
                part = applied.stiffening[:3] if applied.load.what == "force" else applied.stiffening[3:]
                k = self.carrying
                more = np.tensordot(local, part, 1) @ state.q[:k]
                modal[:k] -= more
                power -= more @ state.qd[:k]
        return force, torque, modal, float(power)


def free_body(scene: Scene, body: Body, plan: BodyInertia) -> FreeBody:
    """Constants of `body` of `scene` with the inertia level of `plan` (`online.compile.inertia_plan.BodyInertia`)."""
    k, m = plan.count, body.mode_count
    first, second, gyroscopic = np.zeros((k, 3, 3)), np.zeros((k, k, 3, 3)), np.zeros((k, k, 3))
    if plan.terms is not None:
        first, second, gyroscopic = plan.terms.kept(plan.level, stiffened=plan.stiffening is not None)
    omega = 2.0 * np.pi * body.flexible.frequencies if m else np.zeros(0)
    loads = [
        _applied_load(body, force.load(), plan.stiffening)
        for force in scene.forces
        if len(force.ports) == 1 and force.ports[0].body is body
    ]
    return FreeBody(
        body.name, body.mass, body.inertia, first, second, gyroscopic, omega**2, 2.0 * body.damping * omega,
        scene.gravity, loads,
    )  # fmt: skip


def _applied_load(body: Body, load: PointLoad, stiffening: GeometricStiffness | None) -> AppliedLoad:
    m, port = body.mode_count, load.port
    shift = turn = np.zeros((m, 3))
    more = None
    if m and port.interface_name is not None:
        modes = np.asarray(body.flexible.interfaces[port.interface_name].modes)
        shift, turn = modes[:, :3], modes[:, 3:]
        more = None if stiffening is None else stiffening.interfaces[port.interface_name]
    return AppliedLoad(load, port.point - body.center_of_mass, shift, turn, more)


def check_free(scene: Scene, integrator: str, *, loads: bool) -> None:
    """Raises `InputError` naming the first thing of `scene` that is no free body under gravity; point forces and
    torques pass where `loads`."""
    if not scene.bodies:
        raise InputError("scene: there are no bodies; add one with scene.add_body or scene.add_rigid_body")
    for body in scene.bodies:
        terms = None if body.reduced is None or not body.stiffening else body.reduced.inertia_terms
        forms = None if terms is None or terms.stiffening is None else terms.stiffening.membrane
        if forms is not None and len(forms):
            raise InputError(
                f"{integrator}: body {body.name!r} has membrane energy, which is not known here; add it with "
                f"stiffening=False, or {CURE}"
            )
    for item in [*scene.joints, *scene.drives, *scene.contacts, *scene.lumped_contacts, *scene.films, *scene.laps]:
        raise InputError(
            f"{integrator}: {item.kind} {item.name!r}: only scenes of free bodies can be integrated so; remove it, or "
            f"{CURE}"
        )
    for force in scene.forces:
        if not loads:
            raise InputError(
                f"{integrator}: {force.kind} {force.name!r}: of all loads only gravity keeps the energy; remove it, or "
                f"{CURE}"
            )
        if not (hasattr(force, "load") and isinstance(force.load(), PointLoad)):
            raise InputError(
                f"{integrator}: {force.kind} {force.name!r}: of all forces only point forces and torques are known "
                f"here; remove it, or {CURE}"
            )


def initial_motion(body: Body) -> Motion:
    """The state of a scene's body at the start."""
    A = rot.matrix(body.rotation)
    arm = A @ body.center_of_mass
    m = body.mode_count
    velocity = body.velocity + np.cross(body.angular_velocity, arm)
    return Motion(
        body.position + arm, body.rotation.copy(), velocity, A.T @ body.angular_velocity, np.zeros(m), np.zeros(m)
    )


def product(a: Array, b: Array) -> Array:
    """Quaternion (x, y, z, w) of the rotation b followed by a: A(a b) = A(a) A(b)."""
    x, y = a[:3], b[:3]
    return np.array([*(a[3] * y + b[3] * x + np.cross(x, y)), a[3] * b[3] - x @ y])
