"""Impulsive and smooth steps of a bar that hits its mirror image, in NumPy, by the equations of
`warpffrf_kernels.impulsive.impulsive_contact` as they stand, one scalar equation a coordinate and no factor kappa."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np
from scipy.linalg import expm

from warpffrf.model.reduced.local_modes import dynamic_modes

CALM = 0.5


@dataclass
class Half:
    """Coordinates of one bar: mass, stiffness, damping, displacement of the face towards the other bar, coefficients
    (alpha_m, alpha_f, beta, gamma) and omega^2 of the weight b; `exact`: steps exactly."""

    m: np.ndarray
    k: np.ndarray
    c: np.ndarray
    J: np.ndarray
    coefficients: np.ndarray  # (4, n)
    weigh: np.ndarray
    exact: np.ndarray

    @classmethod
    def of(cls, body: Any, damping: np.ndarray, outer: Any, local: Any, h: float) -> Half:
        """Of `colliding_bars.bar`; damping (modes,); outer, local: coefficients and `LocalModes`."""
        face = body.contact_surfaces["left"]
        amplitude = np.sqrt(2.0 / body.mass)  # of the face, by a mode
        uniform = np.abs(face.mode_normal[0, 0]) / amplitude  # coefficient of a face that moves by one
        modes = dynamic_modes(face)
        t = modes.trace[0] / uniform
        n = len(body.frequencies)
        omega = np.concatenate([[0.0], 2.0 * np.pi * body.frequencies, modes.omega])
        zeta = np.concatenate([[0.0], damping, np.full(len(modes.omega), local.ratio)])
        weigh = np.full(len(omega), omega[n] ** 2)
        weigh[n + 1 :] = modes.omega**2
        table = np.repeat(np.array(outer)[:, None], len(omega), axis=1)
        table[:, n + 1 :] = np.array(local.coefficients)[:, None]
        exact = np.zeros(len(omega), bool)
        exact[n + 1 :] = (local.treatment == "exponential") & (modes.omega * h >= np.pi)
        J = np.concatenate([[1.0], np.full(n, amplitude), np.abs(t)])
        m = np.concatenate([[body.mass], np.ones(len(omega) - 1)])
        return cls(m, m * omega**2, 2.0 * zeta * m * omega, J, table, weigh, exact)


def collide(half: Half, speed: float, gap: float, h: float, steps: int) -> tuple[np.ndarray, np.ndarray, int]:
    """Contact force [N] and energy [J] of both bars (steps + 1,), and how many steps were repeated. speed: of each
    towards the other [m/s], gap: between them at the start [m]."""
    alpha_m, alpha_f, _, _ = half.coefficients
    n = len(half.m)
    q, v, a, rate = np.zeros(n), np.zeros(n), np.zeros(n), np.zeros(n)
    v[0] = speed
    memory = np.zeros(n)  # what a has of the force
    s, impulsive, repeated = 0.0, False, 0
    forces, energies = [0.0], [half.m @ v**2]
    for _ in range(steps):
        f = -half.J * s
        free = (q, v, a - memory / half.m, rate - f / half.m)
        s1, new = _step(half, free if impulsive else (q, v, a, rate), gap, h, s, impulsive)
        if not impulsive and _unsettled(s, s1):
            impulsive, repeated = True, repeated + 1
            s1, new = _step(half, free, gap, h, s, impulsive)
        q, v, a, rate = new
        f1 = -half.J * s1
        if impulsive:
            memory = f1
            a, rate = a + f1 / half.m, rate + f1 / half.m
        else:
            memory = ((1.0 - alpha_f) * f1 + alpha_f * f - alpha_m * memory) / (1.0 - alpha_m)
        memory = np.where(half.exact, f1, memory)
        a = np.where(half.exact, rate, a)
        if impulsive and s1 + s > 0.0 and not _unsettled(s, s1):
            impulsive = False
        s = s1
        forces.append(s)
        energies.append(half.m @ v**2 + half.k @ q**2)  # of two
    return np.array(forces), np.array(energies), repeated


def _unsettled(before: float, after: float) -> bool:
    return abs(after - before) > CALM * max(before, after)


def _step(half: Half, state: Any, gap: float, h: float, before: float, impulsive: bool) -> tuple[float, Any]:
    """Force and state at the end: what the motion is at the force 0 and 1, and the force that closes the gap."""
    ends = [_moved(half, state, h, before, s, impulsive) for s in (0.0, 1.0)]
    closing = [gap - 2.0 * half.J @ end[0] for end in ends]
    s = max(0.0, -closing[0] / (closing[1] - closing[0]))
    return s, _moved(half, state, h, before, s, impulsive)


def _moved(half: Half, state: Any, h: float, before: float, s: float, impulsive: bool) -> Any:
    """q, v, a and vdot at the end of a step with the force s at its end, the last two without it where it is
    impulsive."""
    q0, v0, a0, rate0 = state
    alpha_m, alpha_f, beta, gamma = half.coefficients
    f = -half.J * s
    w = f / half.m if impulsive else np.zeros_like(f)
    held = np.zeros_like(f) if impulsive else f
    b = 0.5 + (beta / gamma - 0.5) / (1.0 + half.weigh * h**2)
    # q_1 = q + h^2 beta a_1, v_1 = v + h gamma a_1, vdot_1 = r + p a_1
    q = q0 + h * v0 + h**2 * ((0.5 - beta) * a0 + b * w)
    v = v0 + h * ((1.0 - gamma) * a0 + w)
    p = (1.0 - alpha_m) / (1.0 - alpha_f)
    r = (alpha_m * a0 - alpha_f * rate0) / (1.0 - alpha_f)
    a1 = (held - half.m * r - half.c * v - half.k * q) / (half.m * p + half.c * h * gamma + half.k * h**2 * beta)
    q, v, rate = q + h**2 * beta * a1, v + h * gamma * a1, r + p * a1
    for i in np.flatnonzero(half.exact):
        A = np.array([[0.0, 1.0, 0.0, 0.0], [-half.k[i], -half.c[i], 1.0, 0.0], [0, 0, 0, 1.0], [0, 0, 0, 0]])
        first = f[i] if impulsive else -half.J[i] * before
        q[i], v[i], _, _ = expm(A * h) @ [q0[i], v0[i], first, (f[i] - first) / h]
        rate[i] = held[i] - half.c[i] * v[i] - half.k[i] * q[i]
    return q, v, a1, rate
