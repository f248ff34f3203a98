r"""Steps that conserve energy and momenta: the midpoint rule with the discrete derivative of the kinetic energy.

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
the energy is kept at any step (a discrete gradient, Gonzalez 1996; of a rigid body, Simo and Wong 1991). The scheme is
symmetric in time, hence of even order: two.

The unknowns are w_1 and the rates of the first k modes; the remaining modes are oscillators under the midpoint rule, in
closed form. Newton's method with the exact Jacobian stops when a correction is below CORRECTION of the energy at hand:
its convergence is quadratic, what is left is the square of that, below round-off. Energy and momentum are kept to it.
"""

from __future__ import annotations

import numpy as np

from warpffrf.online.free_flight.free_bodies import FreeBody, Motion, product

Array = np.ndarray
CORRECTION = 1e-9  # of the velocity, in the energy norm: its square is far below round-off
MOST_ITERATIONS = 25  # quadratic convergence needs 3 to 6; more means that the step is too long


class NotConverged(ArithmeticError):
    """Newton's method found no solution of the step; `str()` says of which body."""


def advance(body: FreeBody, state: Motion, t: float, h: float) -> tuple[Motion, float, float, int]:
    """One step of `h` [s] from time `t`: the new state, work of loads (none), energy taken by damping [J], iterations.

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
    """Quaternion of A(p) cay(x), x (3,) [rad]: cay turns by 2 atan(|x|/2) about x."""
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
            [
                pi_1 - pi_0 + 0.5 * h * np.cross(wbar, sum_pi),
                qd_1 + H_1 @ w_1 - p_0 - h * (D - k * qbar - c * qdbar),
            ]
        )
        # d pi_1/d qd_1 (3, k): of q_1 = ... + h/2 qd_1, and of H_1 qd_1
        pi_qd = H_1.T + 0.5 * h * (P_1 @ w_1 + np.tensordot(G, qd_1, (1, 0))).T
        turn = np.eye(3) + 0.5 * h * _hat(wbar)
        D_w = 0.5 * (P_w0 + np.tensordot(G, qd_0, (1, 0)))
        D_qd = 0.5 * G_w0
        if n:
            D_qd = D_qd + 0.25 * h * (body.second @ w_1) @ w_0
        jacobian = np.zeros((3 + n, 3 + n))
        jacobian[:3, :3] = turn @ J_1 - 0.25 * h * _hat(sum_pi)
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


def _hat(x: Array) -> Array:
    return np.array([[0.0, -x[2], x[1]], [x[2], 0.0, -x[0]], [-x[1], x[0], 0.0]])
