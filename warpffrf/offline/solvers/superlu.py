"""SciPy's SuperLU: always there, for small systems, and the reference for the others.

The factors are those of an LU factorisation without pivoting, which a definite matrix does not need (`SymmetricMode`).
Large systems that say where their dofs lie are ordered by nested dissection; SuperLU's own orderings fill far more.
"""

from __future__ import annotations

from typing import Any

import numpy as np
import scipy.sparse as sp
import scipy.sparse.linalg as spla

from warpffrf.offline.solvers.factor import Factor, not_definite
from warpffrf.offline.solvers.ordering import Array, nested_dissection

SMALL_SYSTEM = 2000  # dofs; below it SuperLU's own ordering costs less than a dissection
INDEX_BYTES = 4  # of the row number that goes with each entry
# Entries of the factors up to which the signs of all pivots are looked at: SciPy copies the factors for that.
LOOKED_AT = 1 << 24
PROBES = 8  # random loads whose energy is looked at in larger systems


class SuperLU(Factor):
    """See the module docstring."""

    name = "superlu"

    def __init__(self, K: Any, coordinates: Array | None, memory_limit: int | None = None) -> None:
        K = sp.csc_matrix(K)
        size = K.shape[0]
        self._order: Array | None = None
        if coordinates is not None and size > SMALL_SYSTEM:
            self._order = nested_dissection(K, coordinates).order
            K = sp.csc_matrix(K[self._order][:, self._order])
        ordering = "MMD_AT_PLUS_A" if self._order is None else "NATURAL"
        try:
            lu = spla.splu(K, permc_spec=ordering, diag_pivot_thresh=0.0, options={"SymmetricMode": True})
        except RuntimeError as error:
            raise not_definite(str(error)) from None
        self._lu = lu
        dtype = np.dtype(np.result_type(K.dtype, np.float64))
        super().__init__(size, dtype, int(lu.nnz), int(lu.nnz) * (dtype.itemsize + INDEX_BYTES))
        self._check_definite()

    def _check_definite(self) -> None:
        """Refuse an indefinite matrix: by its pivots where the factors are small, else by the energy of random loads,
        which finds many negative eigenvalues for certain and a single one by chance."""
        if self.fill <= LOOKED_AT:
            pivots = np.real(self._lu.U.diagonal())
            if not np.all(pivots > 0.0) or np.any(self._lu.perm_r != self._lu.perm_c):
                raise not_definite(f"{int(np.sum(~(pivots > 0.0)))} of {self.size} pivots are not positive")
            return
        loads = np.random.default_rng(0).standard_normal((self.size, PROBES)).astype(self.dtype)
        if not np.all(np.real(np.sum(loads.conj() * self._lu.solve(loads), axis=0)) > 0.0):
            raise not_definite("a load does negative work")

    def _solve(self, F: Any, rows: Array | None) -> Array:
        x = self._lu.solve(self.dense(F, self._order))
        if self._order is not None:
            U = np.empty_like(x)
            U[self._order] = x
            x = U
        return x if rows is None else x[rows]
