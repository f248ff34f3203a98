"""Solves with the dynamic stiffness of the free body, K - lambda M, real and indefinite or complex.

SuperLU with partial pivoting by threshold: the ordering for low fill stays, pivots that are too small are exchanged.
"""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import numpy as np
import scipy.sparse as sp
import scipy.sparse.linalg as spla

from warpffrf.model.errors import InputError
from warpffrf.offline.elastic import Array
from warpffrf.offline.solvers.ordering import nested_dissection

SMALL_SYSTEM = 2000  # dofs; below it SuperLU's own ordering costs less than a dissection
PIVOT = 0.01  # a diagonal pivot is kept while it is this fraction of the largest of its column
# Residual of the load after one step of refinement: far above round-off, far below any use of the result.
ACCURATE = 1e-8


def shifted_solver(K: Any, M: Any, shift: complex, coordinates: Array, what: str) -> Callable[[Array], Array]:
    """Solver of (K - shift M) u = f for blocks f (n, m); `shift` = omega^2 [rad^2/s^2].

    coordinates (n, 3) [m], place of each dof, NaN where it has none. Raises `InputError`, naming `what` is solved,
    where the matrix is singular to working precision: a natural frequency.
    """
    S: Any = sp.csc_matrix(K - shift * M)
    order, permutation = np.arange(len(coordinates)), "MMD_AT_PLUS_A"
    if len(order) > SMALL_SYSTEM:
        order, permutation = nested_dissection(K, coordinates).order, "NATURAL"
        S = sp.csc_matrix(S[order][:, order])
    try:
        lu = spla.splu(S, permc_spec=permutation, diag_pivot_thresh=PIVOT, options={"SymmetricMode": True})
    except RuntimeError:
        raise InputError(f"{what} is a natural frequency of the body; move it by a percent") from None

    def solve(f: Array) -> Array:
        rhs = np.ascontiguousarray(f[order].astype(S.dtype, copy=False))
        x = lu.solve(rhs)
        x = x + lu.solve(rhs - S @ x)
        rest = np.linalg.norm(rhs - S @ x, axis=0)
        if not np.all(rest <= ACCURATE * np.linalg.norm(rhs, axis=0)):
            raise InputError(f"{what} is a natural frequency of the body; move it by a percent")
        u = np.empty_like(x)
        u[order] = x
        return u

    return solve
