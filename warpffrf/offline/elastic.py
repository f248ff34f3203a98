r"""A free elastic body (or one rotational harmonic of it) and its flexibility under inertia relief.

With rigid modes `R`, M-orthonormalised (`R^H M R = 1`), the inertia-relief projector is `P = 1 - M R R^H`: it adds the
rigid-body inertia forces that balance a load. `K` is singular on `R`; on self-equilibrated loads any generalised
inverse gives the same deformation up to rigid motion, and holding as many dofs as there are rigid modes, in a
statically determinate way, is such an inverse: the reactions vanish. So

    flexibility(F) = P^H K^+ P F = P^H (K with pinned dofs)^-1 P F

is exact, symmetric, and independent of which dofs are pinned; its range is M-orthogonal to rigid motion.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from typing import Any

import numpy as np
import scipy.linalg as sla
import scipy.sparse as sp
import scipy.sparse.linalg as spla

from warpffrf.offline.ordering import nested_dissection

Array = np.ndarray
SMALL_SYSTEM = 2000  # dofs; below it SuperLU's own ordering costs less than a dissection


@dataclass
class ElasticModel:
    """K, M (n, n) sparse, rigid modes R (n, r), M-orthonormal (r may be 0), and `solve` with the pinned dofs held."""

    K: Any
    M: Any
    R: Array
    solve: Callable[[Array], Array]

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


def orthonormal_rigid(M: Any, R: Array) -> Array:
    """Rigid modes (n, r) combined so that R^H M R = 1; the columns are scaled first (translations m, rotations rad)."""
    if not R.shape[1]:
        return R
    gram = R.conj().T @ (M @ R)
    scale = 1.0 / np.sqrt(np.real(np.diag(gram)))
    L = np.linalg.cholesky(gram * scale[:, None] * scale[None, :])
    return sla.solve_triangular(L, (R * scale).conj().T, lower=True).conj().T


def pinned_dofs(R: Array, preferred: Array | None = None) -> Array:
    """As many dofs as rigid modes (r,), whose holding is statically determinate: the `preferred` ones (a rigid
    interface's), else the rows of R (n, r) that a pivoted QR picks, which keeps the pinned matrix well conditioned."""
    r = R.shape[1]
    if preferred is not None and len(preferred) == r:
        return np.sort(preferred)
    if r == 0:
        return np.zeros(0, dtype=np.int64)
    pivots = sla.qr(R.conj().T, mode="economic", pivoting=True)[-1]
    return np.sort(np.asarray(pivots)[:r])


def free_model(K: Any, M: Any, R: Array, pinned: Array | None = None, coordinates: Array | None = None) -> ElasticModel:
    """Model of a free body by one sparse factorisation of K without its pinned dofs.

    `coordinates` (n, 3) [m], place of each dof, orders large systems by nested dissection (NaN: ordered last).
    """
    R = orthonormal_rigid(M, R)
    n = M.shape[0]
    held = pinned_dofs(R, pinned)
    free = np.setdiff1d(np.arange(n), held)
    Kff = sp.csc_matrix(sp.csr_matrix(K)[free][:, free])
    if coordinates is not None and n > SMALL_SYSTEM:
        order = nested_dissection(Kff, coordinates[free])
        free, Kff = free[order], sp.csc_matrix(Kff[order][:, order])
        permutation = "NATURAL"
    else:
        permutation = "MMD_AT_PLUS_A"
    # K is definite on the free dofs: no pivoting, symmetric elimination
    lu = spla.splu(Kff, permc_spec=permutation, diag_pivot_thresh=0.0, options={"SymmetricMode": True})

    def solve(F: Array) -> Array:
        U = np.zeros(F.shape, dtype=np.result_type(F, Kff.dtype))
        rhs = np.ascontiguousarray(F[free].astype(Kff.dtype, copy=False))
        x = lu.solve(rhs)
        # one step of iterative refinement: elimination without pivoting on a stiff mesh leaves a few digits to regain
        U[free] = x + lu.solve(rhs - Kff @ x)
        return U

    return ElasticModel(K, M, R, solve)
