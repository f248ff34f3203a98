r"""A body in free flight on the host: its equations of motion in NumPy, for integrators that verify the kernels.

With u = (w, qdot) the kinetic energy of rotation and deformation (`warpffrf.model.reduced.inertia`) is one quadratic
form,

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

Runge-Kutta. The classical Runge-Kutta method of order 4 (Kutta 1901) for free bodies, on the host.

The equations of motion (`warpffrf.online.free_flight.free_bodies`) are integrated directly, with pdot = p o (w,
0)/2 of the unit quaternion, which is normalised after each step; its drift is of fifth order, so that the
order is retained. The work of the loads and the loss in dampers are integrated with the motion, to the same order.

Explicit methods have a stability limit: with z = lambda h, lambda = -zeta omega +- i omega sqrt(1 - zeta^2) of a mode,
the step multiplies it by R(z) = 1 + z + z^2/2 + z^3/6 + z^4/24, and |R| <= 1 ends at omega h = 2 sqrt(2) without
damping.

Energy momentum. Steps that conserve energy and momenta: the midpoint rule with the discrete derivative of the kinetic
energy.

In the notation of `warpffrf.online.free_flight.free_bodies`: u = (w, qdot), T = u.M(q) u/2, momenta P = M u = (pi, p),
a bar for the mean of both ends of the step h. Positions follow the mean velocities, rotations by the Cayley map,

    r_1 = r_0 + h vbar,      q_1 = q_0 + h qdbar,      A_1 = A_0 cay(h wbar),     cay(x) = (1 - x^/2)^-1 (1 + x^/2),

and the balances are, with k, c of the modes and gravity g,

    m (v_1 - v_0) = h m g,      A_1 pi_1 = A_0 pi_0,      p_1 - p_0 = h (D - k qbar - c qdbar).

*Angular momentum* is the second balance, linear momentum the first. *Energy*: for any symmetric M_0, M_1

    T_1 - T_0 = ubar.(P_1 - P_0) - u_0.(M_1 - M_0) u_1/2.

As cay(h wbar) pi_1 = pi_0 is pi_1 - pi_0 = -h wbar x pibar, wbar does no work on pi. M is of second degree in q, so
that

    u_0.(M_1 - M_0) u_1/2 = sum_i (q_1 - q_0)_i D_i,
    D_i = w_0.P_i(qbar) w_1/2 + sum_j (w_0.G_ij qdot_1j + w_1.G_ij qdot_0j)/2,

exactly. With this D the rotation part drops out and T_1 - T_0 = -(k q_1^2 - k q_0^2)/2 - h c qdbar^2: with no damping
the energy is conserved at any step (a discrete gradient, Gonzalez 1996; of a rigid body, Simo and Wong 1991). The
scheme is symmetric in time, hence of even order: two.

The unknowns are w_1 and the rates of the first k modes; the remaining modes are oscillators under the midpoint rule, in
closed form. Newton's method with the exact Jacobian stops when a correction is below CORRECTION of the energy:
its convergence is quadratic, so that the remaining error is the square of that, below round-off. Energy and momentum
are conserved to it.
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
        """Kinetic energy of translation, rotation and deformation [J]."""
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
    """Raises `InputError` naming the first item of `scene` that is not a free body under gravity; point forces and
    torques are allowed where `loads`.
    """
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
    for item in [*scene.joints, *scene.drives, *scene.contacts, *scene.lumped_contacts, *scene.films]:
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


GROWTH = 1e-9  # of |R|: rounding of a mode on the limit of stability
IMAGINARY_LIMIT = 2.0 * np.sqrt(2.0)  # of omega h, undamped
SAFE = 0.7  # of the limit, in the step that a message proposes: the limit of damped modes may be slightly lower


def advance(body: FreeBody, state: Motion, t: float, h: float) -> tuple[Motion, float, float, int]:
    """One step of `h` [s] from time `t`: the new state, work of the loads, energy lost by damping [J], stages."""
    slopes = [_slope(body, state, t)]
    for part in (0.5, 0.5, 1.0):
        moved = Motion(*(x + part * h * s for x, s in zip(state, slopes[-1], strict=False)))
        slopes.append(_slope(body, moved, t + part * h))
    total = [a + 2.0 * b + 2.0 * c + d for a, b, c, d in zip(*slopes, strict=True)]
    new = Motion(*(x + h / 6.0 * s for x, s in zip(state, total, strict=False)))
    return (
        new._replace(p=new.p / np.linalg.norm(new.p)),
        float(h / 6.0 * total[6]),
        float(h / 6.0 * total[7]),
        len(slopes),
    )


def _slope(body: FreeBody, state: Motion, t: float) -> tuple:
    """Time derivatives of r, p, v, w, q, qd, and the two powers."""
    unit = state._replace(p=state.p / np.linalg.norm(state.p))
    rates = body.rates(unit, t)
    p_rate = 0.5 * product(state.p, np.array([*state.w, 0.0]))
    return state.v, p_rate, rates.v, rates.w, state.qd, rates.qd, rates.power, rates.dissipation


def amplification(stiffness: Array, damping: Array, h: float) -> Array:
    """|R| (m,) of modes with `stiffness` omega^2 [1/s^2] and `damping` 2 zeta omega [1/s] at step `h` [s]."""
    root = np.sqrt(np.asarray(0.25 * damping**2 - stiffness, dtype=complex))
    found = []
    for z in (h * (root - 0.5 * damping), h * (-root - 0.5 * damping)):
        found.append(np.abs(1.0 + z * (1.0 + z / 2.0 * (1.0 + z / 3.0 * (1.0 + z / 4.0)))))
    return np.maximum(*found)


def check_step(body: FreeBody, h: float) -> None:
    """Raises `InputError` where a mode of `body` would grow at step `h` [s]."""
    growth = amplification(body.stiffness, body.damping, h)
    if not len(growth) or growth.max() <= 1.0 + GROWTH:
        return
    omega = float(np.sqrt(body.stiffness.max()))
    raise InputError(
        f"RungeKutta4: step {h:g} s is beyond the stability limit of body {body.name!r}, whose highest mode has "
        f"{omega / (2.0 * np.pi):.4g} Hz; use a step of at most {SAFE * IMAGINARY_LIMIT / omega:.2g} s, or {CURE}"
    )


CORRECTION = 1e-9  # of the velocity, in the energy norm: its square is far below round-off
MOST_ITERATIONS = 25  # quadratic convergence needs 3 to 6; more means that the step is too long


class NotConverged(ArithmeticError):
    """Newton's method found no solution of the step; `str()` names the body."""


def advance_energy_momentum(body: FreeBody, state: Motion, t: float, h: float) -> tuple[Motion, float, float, int]:
    """One step of `h` [s] from time `t`: the new state, work of loads (none), energy lost by damping [J], iterations.

    Raises `NotConverged`.
    """
    k = body.carrying
    vbar = state.v + 0.5 * h * body.gravity
    qd_1 = _oscillators(body, state, h)
    w_1 = state.w.copy()
    w_1, qd_1[:k], iterations = _solve(body, state, w_1, qd_1[:k], h)
    qdbar = 0.5 * (state.qd + qd_1)
    new = Motion(
        state.r + h * vbar, turned(state.p, 0.5 * h * (state.w + w_1)), state.v + h * body.gravity, w_1,
        state.q + h * qdbar, qd_1,
    )  # fmt: skip
    return new, 0.0, float(h * qdbar @ (body.damping * qdbar)), iterations


def turned(p: Array, x: Array) -> Array:
    """Quaternion of A(p) cay(x), x (3,) [rad]: cay rotates by 2 atan(|x|/2) about x."""
    half = np.array([*(0.5 * x), 1.0])
    found = product(p, half)
    return found / np.linalg.norm(found)


def _oscillators(body: FreeBody, state: Motion, h: float) -> Array:
    """Rates (m,) at the end of a step under the midpoint rule, without inertia terms."""
    k, c = body.stiffness, body.damping
    share = 0.25 * h * h * k + 0.5 * h * c
    return ((1.0 - share) * state.qd - h * k * state.q) / (1.0 + share)


def _solve(body: FreeBody, state: Motion, w_1: Array, qd_1: Array, h: float) -> tuple[Array, Array, int]:
    """Angular velocity and rates of the first k modes at the end of the step, from a guess of both."""
    n = body.carrying
    k, c, G = body.stiffness[:n], body.damping[:n], body.gyroscopic
    w_0, q_0, qd_0 = state.w, state.q[:n], state.qd[:n]
    H_0 = body.coupling(q_0)
    pi_0 = body.inertia(q_0, body.slopes(q_0)) @ w_0 + qd_0 @ H_0
    p_0 = qd_0 + H_0 @ w_0
    at_hand = w_0 @ body.J0 @ w_0 + qd_0 @ qd_0 + q_0 @ (k * q_0)
    G_w0 = G @ w_0
    for iteration in range(1, MOST_ITERATIONS + 1):
        q_1 = q_0 + 0.5 * h * (qd_0 + qd_1)
        qbar, qdbar, wbar = 0.5 * (q_0 + q_1), 0.5 * (qd_0 + qd_1), 0.5 * (w_0 + w_1)
        P_1, H_1, P_bar = body.slopes(q_1), body.coupling(q_1), body.slopes(qbar)
        J_1 = body.inertia(q_1, P_1)
        pi_1 = J_1 @ w_1 + qd_1 @ H_1
        G_w1 = G @ w_1
        P_w0 = P_bar @ w_0
        D = 0.5 * (P_w0 @ w_1 + G_w0 @ qd_1 + G_w1 @ qd_0)
        sum_pi = pi_0 + pi_1
        residual = np.concatenate(
            [pi_1 - pi_0 + 0.5 * h * np.cross(wbar, sum_pi), qd_1 + H_1 @ w_1 - p_0 - h * (D - k * qbar - c * qdbar)]
        )
        # d pi_1/d qd_1 (3, k): of q_1 = ... + h/2 qd_1, and of H_1 qd_1
        pi_qd = H_1.T + 0.5 * h * (P_1 @ w_1 + np.tensordot(G, qd_1, (1, 0))).T
        turn = np.eye(3) + 0.5 * h * _grid_node(wbar)
        D_w = 0.5 * (P_w0 + np.tensordot(G, qd_0, (1, 0)))
        D_qd = 0.5 * G_w0
        if n:
            D_qd = D_qd + 0.25 * h * (body.second @ w_1) @ w_0
        jacobian = np.zeros((3 + n, 3 + n))
        jacobian[:3, :3] = turn @ J_1 - 0.25 * h * _grid_node(sum_pi)
        jacobian[:3, 3:] = turn @ pi_qd
        jacobian[3:, :3] = H_1 - h * D_w
        # w_1.(G_lj h/2): line j, column l, and G_lj = -G_jl
        jacobian[3:, 3:] = np.diag(1.0 + h * (0.25 * h * k + 0.5 * c)) - 0.5 * h * G_w1 - h * D_qd
        try:
            step = -np.linalg.solve(jacobian, residual)
        except np.linalg.LinAlgError:
            break
        w_1, qd_1 = w_1 + step[:3], qd_1 + step[3:]
        size = step[:3] @ body.J0 @ step[:3] + step[3:] @ step[3:]
        present = w_1 @ body.J0 @ w_1 + qd_1 @ qd_1
        if not np.isfinite(size):
            break
        if size <= CORRECTION**2 * max(at_hand, present):
            return w_1, qd_1, iteration
    raise NotConverged(f"body {body.name!r}: Newton's method found no solution of the step; reduce step")


def _grid_node(x: Array) -> Array:
    return np.array([[0.0, -x[2], x[1]], [x[2], 0.0, -x[0]], [-x[1], x[0], 0.0]])
