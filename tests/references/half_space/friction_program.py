r"""Coulomb friction on cells as a convex program, the reference for every other solver of it.

Slip s = G tau + s0 (n cells, d = 1 or 2 directions), G symmetric positive definite, |tau_i| <= b_i. Coulomb's law,

    s_i = 0 where |tau_i| < b_i,        s_i = -l_i tau_i, l_i >= 0 where |tau_i| = b_i,

is the optimality of  min tau.G tau/2 + s0.tau  on the product of discs: one solution. It is also the root of

    F(tau) = tau - proj(tau - rho s),   rho_i = 1/trace(G_ii) > 0,

with the projection on the discs. Newton's method with the derivative D of the projection, J = 1 - D (1 - rho G),

    D_i = 1 inside,   D_i = (b_i/|z_i|)(1 - z_i z_i^T/|z_i|^2) outside (0 for d = 1),   z = tau - rho s,

is an active-set method: with d = 1 it ends exactly. It may cycle; then block Gauss-Seidel sweeps, which always descend
(each cell solved in turn, tau_i = proj(tau_i - rho_i s_i)), continue until Newton's method converges.
"""

from __future__ import annotations

import numpy as np

from warpffrf.model.errors import InputError, require_array

Array = np.ndarray
TOLERANCE = 1e-13  # of F over the largest bound; with the condition of G below 1e3 tau is accurate to 1e-12
NEWTON_STEPS = 30  # before sweeps are used: it ends in 5 to 10 or cycles
SWEEPS = 20  # of Gauss-Seidel between two tries
TRIES = 50


def project(z: Array, bound: Array) -> Array:
    """The nearest points (n, d) to z in the discs of radius bound (n,)."""
    length = np.linalg.norm(z, axis=1)
    scale = np.where(length > bound, bound / np.where(length > 0.0, length, 1.0), 1.0)
    return z * scale[:, None]


def residual(G: Array, s0: Array, bound: Array, tau: Array) -> float:
    """Largest entry of F over the largest bound, 0 at the solution; tau (n, d)."""
    F = _residual(G, s0.reshape(tau.shape), bound, tau, _scale(G, tau.shape))[0]
    return float(np.abs(F).max() / max(bound.max(), np.finfo(float).tiny))


def _scale(G: Array, shape: tuple[int, ...]) -> Array:
    return 1.0 / np.diag(G).reshape(shape).sum(axis=1)


def _residual(G: Array, s0: Array, bound: Array, tau: Array, rho: Array) -> tuple[Array, Array]:
    z = tau - rho[:, None] * ((G @ tau.ravel()).reshape(tau.shape) + s0)
    return tau - project(z, bound), z


def _newton(G: Array, bound: Array, F: Array, z: Array, rho: Array) -> Array:
    """Step (n, d) of Newton's method."""
    n, d = z.shape
    length = np.linalg.norm(z, axis=1)
    slips = length > bound
    unit = z / np.where(length > 0.0, length, 1.0)[:, None]
    D = np.broadcast_to(np.eye(d), (n, d, d)).copy()
    turned = np.eye(d) - unit[:, :, None] * unit[:, None, :]
    D[slips] = (bound / np.where(slips, length, 1.0))[slips, None, None] * turned[slips]
    inner = np.eye(n * d) - np.repeat(rho, d)[:, None] * G
    J = np.eye(n * d) - np.einsum("ijk,ikm->ijm", D, inner.reshape(n, d, n * d)).reshape(n * d, n * d)
    return -np.linalg.solve(J, F.ravel()).reshape(n, d)


def solve(G: Array, s0: Array, bound: Array, start: Array | None = None) -> Array:
    """Tractions tau (n, d) of the program; for d = 1 also as (n,), as s0 is.

    G (n d, n d) [m/Pa], rows and columns by (cell, direction); s0 (n,) or (n, d) [m]; bound (n,) [Pa], >= 0, cells of
    bound 0 have no traction. `start`: a guess. Raises InputError for a negative bound, RuntimeError if G is not
    positive definite and no solution is found.
    """
    flat = np.ndim(s0) == 1
    free = np.array(s0, dtype=float).reshape(len(s0), -1)
    bound = require_array(bound, "bound of the traction", (len(free),))
    if np.any(bound < 0.0):
        raise InputError("bound of the traction must not be negative: it is friction times pressure")
    G = require_array(G, "compliance of the tractions", (free.size, free.size))
    rho = _scale(G, free.shape)
    tau = project(np.zeros_like(free) if start is None else np.reshape(start, free.shape), bound)
    wanted = TOLERANCE * bound.max(initial=0.0)
    for _ in range(TRIES):
        trial = tau
        for _ in range(NEWTON_STEPS):
            F, z = _residual(G, free, bound, trial, rho)
            if np.abs(F).max(initial=0.0) <= wanted:
                found = project(trial, bound)
                return found[:, 0] if flat else found
            trial = trial + _newton(G, bound, F, z, rho)
        tau = sweep(G, free, bound, tau, SWEEPS)
    raise RuntimeError("friction program: no solution found, is the compliance positive definite?")


def sweep(G: Array, s0: Array, bound: Array, tau: Array, count: int) -> Array:
    """`count` sweeps of block Gauss-Seidel from tau (n, d)."""
    n, d = tau.shape
    rows, rho, tau = G.reshape(n, d, n * d), _scale(G, tau.shape), tau.copy()
    for _ in range(count):
        for i in range(n):
            z = tau[i] - rho[i] * (rows[i] @ tau.ravel() + s0[i])
            tau[i] = project(z[None], bound[i : i + 1])[0]
    return tau
