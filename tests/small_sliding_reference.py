r"""A small dense reference of one increment of a small-sliding contact in NumPy, and a checker of the conditions
themselves.

Cells c with forces s = (p, t1, t2) [N] on the second face, flat (3 c,); displacements y = G s + b of the second face
against the first; layers of compliance E (3 c,) [m/N]; slip so far w (c, 2) [m]:

    g = y_n + E_n p,      v = y_t + E_t t - w,
    0 <= p _|_ g >= 0,      |t| <= mu p,      v = -l t,  l >= 0,  l (mu p - |t|) = 0;      new slip w + v.

Pressures and friction are solved in turn, each a convex program: pressures by non-negative least squares on a Cholesky
factor (Lawson and Hanson), friction with the bounds mu p by an interior point method on discs. The states so found are
made exact by Newton's method on the equations of all cells together. Nothing of it is shared with
`references.small_sliding.contact_program`.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from scipy.optimize import nnls

PASSES = 60  # of pressure and friction in turn: 2 to 10 are seen
ALIKE = 1e-9  # of the largest force: two passes that differ less have found the states
EXACT = 1e-11  # largest violation that is accepted; 1e-14 to 1e-12 are seen
OPEN, STICK, SLIP = 0, 1, 2


@dataclass(frozen=True)
class SmallSlidingStep:
    """force s (3 c,) [N], displacement y (3 c,) [m], state (c,), slip so far (c, 2) [m], worst violation."""

    force: np.ndarray
    motion: np.ndarray
    state: np.ndarray
    slip: np.ndarray
    violation: float


def solve_increment(G, b, mu, slip=None, E=None) -> SmallSlidingStep:
    """The increment of the module docstring; slip None: none so far; E None: no layers. Raises ValueError where the
    conditions are not met in the end."""
    b = np.asarray(b, dtype=float).ravel()
    c = len(b) // 3
    slip = np.zeros((c, 2)) if slip is None else np.asarray(slip, dtype=float)
    A = np.asarray(G, dtype=float) + np.diag(np.zeros(3 * c) if E is None else np.asarray(E, dtype=float).ravel())
    mu = np.broadcast_to(np.asarray(mu, dtype=float), (c,))
    n, t = np.arange(0, 3 * c, 3), np.setdiff1d(np.arange(3 * c), np.arange(0, 3 * c, 3))
    free = b.copy()
    free[t] -= slip.ravel()
    yields, far = np.trace(A) / len(b), max(np.abs(free).max(), 1e-300)  # units of flexibility and of motion
    s, best, least = np.zeros(3 * c), np.zeros(3 * c), np.inf
    for _ in range(PASSES):
        before = s.copy()
        s[n] = _pressures(A[np.ix_(n, n)], free[n] + A[np.ix_(n, t)] @ s[t])
        s[t] = _friction(A[np.ix_(t, t)], free[t] + A[np.ix_(t, n)] @ s[n], mu * s[n]).ravel()
        if np.abs(s - before).max() > 1e-3 * np.abs(s).max():
            continue
        exact = _polished(A / yields, free / far, mu, s * yields / far) * far / yields
        worst = violations(G, b, mu, slip, E, exact)["worst"]
        if worst < least:
            best, least = exact, worst
        if least < EXACT or np.abs(s - before).max() <= ALIKE * np.abs(s).max():
            break
    if not least < EXACT:
        raise ValueError(f"small-sliding reference: the conditions are met to {least:.1e} only")
    y = np.asarray(G) @ best + b
    v = (A @ best + free).reshape(c, 3)
    p, tau = best[n], np.linalg.norm(best.reshape(c, 3)[:, 1:], axis=1)
    state = np.where(p <= 0.0, OPEN, np.where(tau >= mu * p * (1.0 - 1e-9), SLIP, STICK))
    return SmallSlidingStep(best, y, state, slip + v[:, 1:], least)


def violations(G, b, mu, slip, E, s) -> dict[str, float]:
    """By how much the forces s (3 c,) violate each condition, forces over the largest force and motions over the
    largest motion without forces; `worst` is the largest of all. All zero: solved."""
    b, s = np.asarray(b, dtype=float).ravel(), np.asarray(s, dtype=float).ravel()
    c = len(b) // 3
    y = np.asarray(G) @ s + b + (0.0 if E is None else np.asarray(E).ravel() * s)
    y, s = y.reshape(c, 3), s.reshape(c, 3)
    v = y[:, 1:] - (0.0 if slip is None else slip)
    unit = max(np.abs(b).max(), 0.0 if slip is None else np.abs(slip).max(), 1e-300)
    force = max(np.abs(s).max(), 1e-300)
    g, p, t = y[:, 0], s[:, 0], s[:, 1:]
    room = mu * p - np.linalg.norm(t, axis=1)
    speed = np.linalg.norm(v, axis=1)
    found = {
        "penetration": max(float(-g.min()), 0.0) / unit,
        "tension": max(float(-p.min()), 0.0) / force,
        "complementarity": float(np.abs(p * g).max()) / (unit * force),
        "cone": max(float(-room.min()), 0.0) / force,
        "slip inside the cone": float(np.abs(room * speed).max()) / (unit * force),
        "direction": float(np.abs(t[:, 0] * v[:, 1] - t[:, 1] * v[:, 0]).max()) / (unit * force),
        "gained work": max(float(np.einsum("cd,cd->c", t, v).max()), 0.0) / (unit * force),
    }
    return found | {"worst": max(found.values())}


def _pressures(A, b):
    """p >= 0, A p + b >= 0, complementary; A positive definite."""
    L = np.linalg.cholesky(A)
    return nnls(L.T, -np.linalg.solve(L, b))[0]


def _friction(A, b, bound):
    """min t.A t/2 + b.t over |t_i| <= bound_i: interior points of phi_i = (bound_i^2 - |t_i|^2)/2, l_i phi_i = tau."""
    c = len(bound)
    t = np.zeros((c, 2))
    live = bound > 1e-14 * max(bound.max(), 1e-300)
    if not live.any():
        return t
    rows = np.flatnonzero(np.repeat(live, 2))
    A, b, r = A[np.ix_(rows, rows)], b[rows], bound[live]
    k, x = len(r), np.zeros((len(r), 2))
    D = np.repeat(r, 2)
    A, b = A * D[:, None] * D, b * D  # forces over their bounds
    unit = max(np.abs(b).max(), 1e-300)
    A, b = A / unit, b / unit
    tau = 1.0
    for _ in range(100):
        phi = 0.5 * (1.0 - np.sum(x * x, axis=1))
        lam = tau / phi
        H = A.copy().reshape(k, 2, k, 2)
        H[np.arange(k), :, np.arange(k)] += lam[:, None, None] * np.eye(2)
        H[np.arange(k), :, np.arange(k)] += (lam / phi)[:, None, None] * x[:, :, None] * x[:, None, :]
        gradient = A @ x.ravel() + b + (lam[:, None] * x).ravel()
        dx = -np.linalg.solve(H.reshape(2 * k, 2 * k), gradient).reshape(k, 2)
        way = 1.0
        while np.any(np.sum((x + way * dx) ** 2, axis=1) >= 1.0 - 0.1 * (2.0 * phi)):
            way *= 0.5
        x = x + way * dx
        if way == 1.0 and np.abs(gradient).max() < max(tau, 1e-10):
            if tau < 1e-13:
                break
            tau *= 0.1
    t[live] = x * r[:, None]
    return t


def _polished(A, b, mu, s):
    """Newton's method on the equations of the states that s (3 c,) shows: g = 0 where shut, v = 0 where it sticks,
    v + l t = 0 and |t| = mu p where it slips."""
    c = len(mu)
    x = s.reshape(c, 3).copy()
    F = np.abs(x).max()
    y = (A @ x.ravel() + b).reshape(c, 3)
    shut = x[:, 0] > 1e-9 * F
    size, speed = np.linalg.norm(x[:, 1:], axis=1), np.linalg.norm(y[:, 1:], axis=1)
    # slip: nearer to the cone than to rest
    room, far = (mu * x[:, 0] - size) / max(F, 1e-300), speed / max(np.abs(b).max(), 1e-300)
    slips = shut & (mu > 0.0) & (room < far)
    stuck = shut & (mu > 0.0) & ~slips
    x[~shut] = 0.0
    x[mu == 0.0, 1:] = 0.0
    lam = np.where(slips, speed / np.maximum(size, 1e-300), 0.0)
    live = np.zeros((c, 3), dtype=bool)
    live[shut, 0] = True
    live[stuck | slips, 1:] = True
    at, sliding = np.flatnonzero(live.ravel()), np.flatnonzero(slips)
    m, k = len(at), len(sliding)
    where = np.full(3 * c, -1)
    where[at] = np.arange(m)
    for _ in range(8):
        y = (A @ x.ravel() + b).reshape(c, 3)
        y[:, 1:] += lam[:, None] * x[:, 1:]
        J = np.zeros((m + k, m + k))
        J[:m, :m] = A[np.ix_(at, at)]
        rest = np.concatenate([y.ravel()[at], np.zeros(k)])
        for j, i in enumerate(sliding):
            for d in (1, 2):
                row = where[3 * i + d]
                J[row, row] += lam[i]
                J[row, m + j] = x[i, d]
                J[m + j, row] = x[i, d]
            J[m + j, where[3 * i]] = -(mu[i] ** 2) * x[i, 0]
            rest[m + j] = 0.5 * (x[i, 1:] @ x[i, 1:] - mu[i] ** 2 * x[i, 0] ** 2)
        if not m:
            break
        step = -np.linalg.lstsq(J, rest, rcond=1e-15)[0]
        flat = x.ravel().copy()
        flat[at] += step[:m]
        x, lam = flat.reshape(c, 3), lam.copy()
        lam[sliding] += step[m:]
    return x.ravel()
