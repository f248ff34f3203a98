r"""One increment of unilateral contact with Coulomb friction on cells, by dense matrices.

A cell has a force s = (p, t1, t2) [N] on the second face and the opposite on the first, and a relative displacement
y = (g, v) [m] of the second relative to the first: g the gap, v the slip since the last state. With the flexibility
G (3 c, 3 c) of the bodies (and of layers between them, on its diagonal) and y without forces, b,

    y = G s + b,      0 <= p  _|_  g >= 0,      |t| <= mu p,      t = -mu p v/|v|  where v is not zero.

Cells are scaled to trace 3 of their block of G, which leaves the cones unchanged.

**Newton's method** (P. Alart and A. Curnier, Comput. Methods Appl. Mech. Eng. 92 (1991) 353). The conditions are the
root of

    F_n = p - max(0, p - g),      F_t = t - proj(t - v; mu max(0, p - g)),

proj onto the disc of that radius. With z = s - y, u = z_t/|z_t|, beta the radius and A the derivative of the right
parts,

    J = 1 - A (1 - G),      A = [[1, 0], [mu u, beta/|z_t| (1 - u u^T)]]  (slip),   1  (stick),   0  (open):

a step is the linear problem for given states. Started from the last increment it converges in a few steps or cycles.

**Interior path.** If it cycles, a path of solutions of the smoothed conditions

    p g = tau,      v = -lambda t,      lambda phi = tau,      phi = (mu^2 p^2 + e^2 - |t|^2)/2,

all of p, g, lambda, phi positive, is followed by Newton steps with decreasing tau to its end, where Newton's method
restarts; e, a small cohesion, keeps the cone open if p or mu is zero. With lambda and g eliminated a step is
again one linear system of the size of G.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
import scipy.linalg as sla

from warpffrf.model.errors import InputError, require_array

Array = np.ndarray
TOLERANCE = 1e-12  # of F over the largest force, both scaled: round-off of G s is some 1e-13 with hundreds of cells
ROUND_OFF = 1e-9  # of F: accepted if Newton's method stagnates there, as for flexibilities of condition 1e8
NEWTON_STEPS = 25  # 2 to 10 are needed, or it cycles
PATH_STEPS = 80  # of Newton along the interior path: 15 to 30 are needed
PATH_END = 1e-13  # tau at its end, 1 at its beginning
COHESION = 1e-6  # e, of the unit of force: Newton's method then removes it
BOUNDARY = 0.9  # largest fraction of the distance to the boundary of the cone per step
HALF_WAY = 0.5  # a longer step lets tau decrease
SHRINK = 0.15  # of tau per step
OPEN, STICK, SLIP = 0, 1, 2  # states of a cell


@dataclass(frozen=True, eq=False)
class Increment:
    """force s (c, 3) [N], motion y (c, 3) [m] (gap and slip of the increment), state (c,) of `OPEN`, `STICK`, `SLIP`,
    steps of Newton's method, steps along the interior path (0: it was not needed)."""

    force: Array
    motion: Array
    state: Array
    steps: int
    path_steps: int

    @property
    def dissipated(self) -> float:
        """Work [J] of the friction, -t . v >= 0."""
        return float(-np.sum(self.force[:, 1:] * self.motion[:, 1:]))


def solve(G: Array, b: Array, friction: Array | float, start: Array | None = None) -> Increment:
    """The increment of the module docstring.

    G (3 c, 3 c) [m/N], symmetric, positive semidefinite; b (c, 3) [m]; friction mu, one or (c,); `start` (c, 3) [N]: a
    guess of the forces. Raises `InputError` for other shapes and a negative friction, RuntimeError if no solution is
    found, as for unsupported bodies.
    """
    b = require_array(b, "contact program: motion without forces", (None, 3))
    c = len(b)
    G = require_array(G, "contact program: flexibility", (3 * c, 3 * c))
    mu = np.broadcast_to(np.asarray(friction, dtype=float), (c,))
    if np.any(mu < 0.0):
        raise InputError("contact program: the friction coefficient must not be negative")
    problem = _Scaled.of(G, b, mu)
    s = np.zeros_like(b) if start is None else np.asarray(start, dtype=float) / problem.force
    found, steps, off = _newton(problem, s)
    path_steps = 0
    if off > TOLERANCE:
        inner, path_steps = _follow(problem)
        again, more, rest = _newton(problem, inner)
        steps += more
        if rest < off:
            found, off = again, rest
    if off > ROUND_OFF:
        raise RuntimeError(f"contact program: the conditions are met to {off:.1e} only; is every body held?")
    y = problem.motion(found)
    state = _states(problem, found - y)
    return Increment(found * problem.force, y * problem.length, state, steps, path_steps)


@dataclass(frozen=True, eq=False)
class _Scaled:
    """G and b without units; `force` and `length` (c, 1): units of forces and motions of each cell."""

    G: Array
    b: Array
    mu: Array
    force: Array
    length: Array

    @classmethod
    def of(cls, G: Array, b: Array, mu: Array) -> _Scaled:
        c = len(b)
        trace = np.trace(G.reshape(c, 3, c, 3).diagonal(axis1=0, axis2=2).T, axis1=1, axis2=2)
        if np.any(trace <= 0.0):
            raise InputError("contact program: a cell does not yield at all; every cell needs flexibility")
        d = np.sqrt(3.0 / trace)[:, None]  # of forces; motions go with 1/d
        unit = max(float(np.abs(b * d).max(initial=0.0)), np.finfo(float).tiny)
        D = np.repeat(d.ravel(), 3)
        return cls(G * D[:, None] * D, b * d / unit, mu, d * unit, unit / d)

    def motion(self, s: Array) -> Array:
        return (self.G @ s.ravel()).reshape(s.shape) + self.b


def _states(problem: _Scaled, z: Array) -> Array:
    slips = np.linalg.norm(z[:, 1:], axis=1) > problem.mu * z[:, 0]
    return np.where(z[:, 0] <= 0.0, OPEN, np.where(slips, SLIP, STICK))


def _residual(problem: _Scaled, s: Array) -> tuple[Array, Array]:
    """F (c, 3), and A (c, 3, 3) of the module docstring."""
    z = s - problem.motion(s)
    normal = np.maximum(z[:, 0], 0.0)
    length = np.linalg.norm(z[:, 1:], axis=1)
    beta = problem.mu * normal
    shut, slips = z[:, 0] > 0.0, length > beta
    u = z[:, 1:] / np.where(length > 0.0, length, 1.0)[:, None]
    shrink = np.where(slips, beta / np.where(length > 0.0, length, 1.0), 1.0)
    F = s - np.concatenate([normal[:, None], z[:, 1:] * shrink[:, None]], axis=1)
    A = np.zeros((len(s), 3, 3))
    A[:, 0, 0] = shut
    A[:, 1:, 0] = (problem.mu * (shut & slips))[:, None] * u
    A[:, 1:, 1:] = shrink[:, None, None] * (np.eye(2) - slips[:, None, None] * u[:, :, None] * u[:, None, :])
    return F, A


def _newton(problem: _Scaled, s: Array) -> tuple[Array, int, float]:
    """Best forces found from s, steps, and their largest |F| over the largest force."""
    best, least = s, np.inf
    size = s.size
    for step in range(NEWTON_STEPS + 1):
        F, A = _residual(problem, s)
        off = float(np.abs(F).max(initial=0.0)) / max(float(np.abs(s).max(initial=0.0)), TOLERANCE)
        if off < least:
            best, least = s, off
        if off <= TOLERANCE or step == NEWTON_STEPS:
            return best, step, least
        J = np.einsum("cij,cjm->cim", A, (problem.G - np.eye(size)).reshape(-1, 3, size)).reshape(size, size)
        J[np.diag_indices(size)] += 1.0
        try:
            s = s - sla.solve(J, F.ravel(), check_finite=False).reshape(s.shape)
        except sla.LinAlgError:
            return best, step, least
        if not np.all(np.isfinite(s)):
            return best, step, least
    raise AssertionError("unreachable")


def _follow(problem: _Scaled) -> tuple[Array, int]:
    """Forces at the end of the interior path, and steps."""
    c = len(problem.b)
    mu2 = problem.mu**2
    p = np.full(c, 1.0)
    t = np.zeros((c, 2))
    g = np.full(c, 1.0)
    tau, e2 = 1.0, COHESION**2
    lam = tau / (0.5 * (mu2 + e2))
    for step in range(PATH_STEPS):
        s = np.concatenate([p[:, None], t], axis=1)
        y = problem.motion(s)
        phi = 0.5 * (mu2 * p**2 + e2 - np.sum(t * t, axis=1))
        J = problem.G.copy()
        blocks = np.zeros((c, 3, 3))
        blocks[:, 0, 0] = g / p
        blocks[:, 1:, 0] = -(lam / phi * mu2 * p)[:, None] * t
        blocks[:, 1:, 1:] = lam[:, None, None] * np.eye(2) + (lam / phi)[:, None, None] * t[:, :, None] * t[:, None, :]
        at = 3 * np.arange(c)[:, None, None]
        J[at + np.arange(3)[:, None], at + np.arange(3)] += blocks
        rhs = np.concatenate([(tau / p - y[:, 0])[:, None], -y[:, 1:] - t * (tau / phi)[:, None]], axis=1)
        ds = sla.solve(J, rhs.ravel(), check_finite=False).reshape(c, 3)
        dp, dt = ds[:, 0], ds[:, 1:]
        dg = tau / p - g - g / p * dp
        dlam = tau / phi - lam - lam / phi * (mu2 * p * dp - np.sum(t * dt, axis=1))
        way = min(_way(p, dp), _way(g, dg), _way(lam, dlam))
        while np.any(
            mu2 * (p + way * dp) ** 2 + e2 - np.sum((t + way * dt) ** 2, axis=1) <= 2.0 * (1.0 - BOUNDARY) * phi
        ):
            way *= 0.7
            if way < 1e-12:
                return s, step
        p, t, g, lam = p + way * dp, t + way * dt, g + way * dg, lam + way * dlam
        if way > HALF_WAY:
            if tau <= PATH_END:
                break
            tau = max(SHRINK * tau, PATH_END)
    return np.concatenate([p[:, None], t], axis=1), step + 1


def _way(x: Array, dx: Array) -> float:
    """Largest step up to 1 that keeps at least 1 - `BOUNDARY` of the positive x (c,)."""
    falls = dx < 0.0
    return min(1.0, BOUNDARY * float(np.min(-x[falls] / dx[falls], initial=np.inf)))
