r"""A free elastic body (or one rotational harmonic of it) and its flexibility under inertia relief.

With rigid modes `R`, M-orthonormalised (`R^H M R = 1`), the inertia-relief projector is `P = 1 - M R R^H`: it adds the
rigid-body inertia forces that balance a load. `K` is singular on `R`. On self-equilibrated loads any generalised
inverse gives the same deformation up to rigid motion. A statically determinate constraint of as many dofs as there are
rigid modes is such an inverse: the reactions vanish. So

    flexibility(F) = P^H K^+ P F = P^H (K with pinned dofs)^-1 P F

is exact, symmetric, and independent of which dofs are pinned; its range is M-orthogonal to rigid motion.

For thousands of sparse loads F only some rows of the response are required (`StaticResponse`). Then P need not make the
loads dense: with `X = K_p^-1 F` and `W = K_p^-1 M R` (K_p: pinned),

    flexibility(F) = (1 - R R^H M) (X - W R^H F) = X - W a - R (W^H F - (R^H M W) a),     a = R^H F,

since `R^H M X = W^H F`. Every term is a row of X, W or R times small matrices. In X and W alone the pinned dofs have
reactions, which cancel; measured on 100,000 dofs this costs no digit (1e-14 between the two ways, 2e-13 of both).
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from typing import Any

import numpy as np
import scipy.linalg as sla
import scipy.sparse as sp

from warpffrf.offline.solvers import Factor, factorise

Array = np.ndarray
# Normwise backward error |K x - f|/(|K| |x| + |f|) of a solve above which all solves get one step of refinement.
# Elimination of a definite matrix is backward stable: on meshes 1e-16 is observed, with every solver.
REFINED_ABOVE = 1e-13


@dataclass
class ElasticModel:
    """K, M (n, n) sparse, rigid modes R (n, r), M-orthonormal (r may be 0), and `solve` with the pinned dofs fixed.

    A model of `free_model` also has the `factor` of the unconstrained dofs `free` (n - r,), and the
    `backward_error` of a solve.
    """

    K: Any
    M: Any
    R: Array
    solve: Callable[[Array], Array]
    factor: Factor | None = None
    free: Array | None = None
    backward_error: float = 0.0

    @property
    def size(self) -> int:
        """Number of dofs."""
        return self.M.shape[0]

    def self_equilibrated(self, F: Array) -> Array:
        """P F: loads (n, m) with the inertia forces that balance them."""
        return F - self.M @ (self.R @ (self.R.conj().T @ F)) if self.R.shape[1] else F

    def without_rigid(self, U: Array) -> Array:
        """P^H U: displacements (n, m) without their M-projection on rigid motion."""
        return U - self.R @ (self.R.conj().T @ (self.M @ U)) if self.R.shape[1] else U

    def flexibility(self, F: Array) -> Array:
        """P^H K^+ P F (n, m)."""
        return self.without_rigid(self.solve(self.self_equilibrated(F)))


class StaticResponse:
    """Chosen `rows` (r,) of the flexible response of a `free_model` to sparse loads, excluding the part in K-orthogonal
    M-orthonormal modes `Phi` (n, m) of frequencies `omega` (m,) [rad/s]:

    rows of `flexibility(F) - Phi omega^-2 Phi^H F`, see the module docstring.
    """

    def __init__(self, model: ElasticModel, rows: Array, omega: Array, Phi: Array) -> None:
        if model.factor is None or model.free is None:
            raise ValueError("StaticResponse needs a model of free_model")
        self.factor, self.rows = model.factor, rows
        self.refined = model.backward_error > REFINED_ABOVE
        self.model = model
        position = np.full(model.size, -1)
        position[model.free] = np.arange(len(model.free))
        self.place = position[rows]  # among the free dofs; -1: constrained, at rest
        R = model.R
        W = model.solve(model.M @ R)
        self.inertia = R.conj().T @ (model.M @ W)
        self.R, self.W, self.Phi, self.stiffness = R, W, Phi, omega**2
        self.directions = np.concatenate([W[rows], R[rows], Phi[rows]], axis=1)

    def __call__(self, F: Any) -> Array:
        """Rows (r, m) of the response to loads F (n, m), csc."""
        if self.refined:
            X = self.model.solve(F.toarray())[self.rows]
        else:
            held = self.place < 0
            X = self.factor.solve(F[self.model.free], np.where(held, 0, self.place))
            X[held] = 0.0
        a = _on(self.R, F)
        parts = [a, _on(self.W, F) - self.inertia @ a, _on(self.Phi, F) / self.stiffness[:, None]]
        X -= self.directions @ np.concatenate(parts)
        return X


def _on(modes: Array, F: Any) -> Array:
    """modes^H F (m, count) for sparse F (n, count)."""
    return (F.conj().T @ modes).conj().T


def orthonormal_rigid(M: Any, R: Array) -> Array:
    """Rigid modes (n, r) combined so that R^H M R = 1; the columns are scaled first (translations m, rotations rad)."""
    if not R.shape[1]:
        return R
    gram = R.conj().T @ (M @ R)
    scale = 1.0 / np.sqrt(np.real(np.diag(gram)))
    L = np.linalg.cholesky(gram * scale[:, None] * scale[None, :])
    return sla.solve_triangular(L, (R * scale).conj().T, lower=True).conj().T


def pinned_dofs(R: Array, preferred: Array | None = None) -> Array:
    """As many dofs as rigid modes (r,) for a statically determinate constraint: the `preferred` ones (a rigid
    interface's), else the rows of R (n, r) chosen by a pivoted QR, which keeps the pinned matrix well conditioned."""
    r = R.shape[1]
    if preferred is not None and len(preferred) == r:
        return np.sort(preferred)
    if r == 0:
        return np.zeros(0, dtype=np.int64)
    pivots = sla.qr(R.conj().T, mode="economic", pivoting=True)[-1]
    return np.sort(np.asarray(pivots)[:r])


def free_model(
    K: Any,
    M: Any,
    R: Array,
    pinned: Array | None = None,
    coordinates: Array | None = None,
    *,
    solver: str | None = None,
    memory_limit: int | None = None,
) -> ElasticModel:
    """Model of a free body by one sparse factorisation of K without its pinned dofs.

    `coordinates` (n, 3) [m], position of each dof (NaN: none), enable nested dissection of large systems; `solver` and
    `memory_limit` as in `solvers.factorise`. Raises `InputError` as that does.
    """
    R = orthonormal_rigid(M, R)
    n = M.shape[0]
    held = pinned_dofs(R, pinned)
    free = np.setdiff1d(np.arange(n), held)
    Kff = sp.csc_matrix(sp.csr_matrix(K)[free][:, free])
    factor = factorise(Kff, None if coordinates is None else coordinates[free], solver, memory_limit=memory_limit)
    error = backward_error(Kff, factor)
    refined = error > REFINED_ABOVE

    def solve(F: Array) -> Array:
        U = np.zeros(F.shape, dtype=np.result_type(F, Kff.dtype))
        x = factor.solve(F[free])
        U[free] = x + factor.solve(F[free] - Kff @ x) if refined else x
        return U

    return ElasticModel(K, M, R, solve, factor, free, error)


def backward_error(K: Any, factor: Factor) -> float:
    """Largest |K x - f|/(|K| |x| + |f|), maximum norms, of a few random loads f."""
    f = np.random.default_rng(0).standard_normal((factor.size, 2)).astype(factor.dtype)
    if not factor.size:
        return 0.0
    x = factor.solve(f)
    scale = abs(K).sum(axis=1).max() * np.abs(x).max(axis=0) + np.abs(f).max(axis=0)
    return float(np.max(np.abs(K @ x - f).max(axis=0) / scale))
