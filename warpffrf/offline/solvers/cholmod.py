"""CHOLMOD by scikit-sparse, the optional extra `cholmod`.

Supernodal Cholesky factorisation (Chen, Davis, Hager, Rajamanickam 2008, ACM Trans. Math. Softw. 35, 22), as fast as
the BLAS that the installed SuiteSparse is linked with. The ordering is our own nested dissection where the dofs have
places, so that its size is known before memory is asked for.
"""

from __future__ import annotations

from typing import Any

import numpy as np
import scipy.sparse as sp

from warpffrf.model.errors import InputError
from warpffrf.offline.solvers.factor import Factor, missing_extra, not_definite
from warpffrf.offline.solvers.fronts import find_fronts
from warpffrf.offline.solvers.ordering import Array, nested_dissection


class Cholmod(Factor):
    """See the module docstring."""

    name = "cholmod"

    def __init__(self, K: Any, coordinates: Array | None, memory_limit: int | None = None) -> None:
        try:
            from sksparse.cholmod import (  # pyright: ignore[reportMissingImports]
                CholmodNotPositiveDefiniteError,
                cholesky,
            )
        except ImportError:
            raise missing_extra("cholmod", "scikit-sparse") from None
        K = sp.csc_matrix(K)
        dtype = np.dtype(np.result_type(K.dtype, np.float64))
        self._order: Array | None = None
        fill = 0
        if coordinates is not None:
            fronts = find_fronts(K, nested_dissection(K, coordinates))
            self._order, K = fronts.order, fronts.matrix
            pivots = fronts.sizes[0]
            fill = fronts.entries - int((pivots * (pivots - 1) // 2).sum())
            if memory_limit is not None and fill * dtype.itemsize > memory_limit:
                raise InputError(
                    f"the factors of {K.shape[0]} dofs need {fill * dtype.itemsize / 2**30:.3g} GiB, memory_limit is "
                    f"{memory_limit / 2**30:.3g} GiB; raise memory_limit or coarsen the mesh"
                )
        try:
            # the order is final: CHOLMOD only postorders its elimination tree
            self._factor = cholesky(K, ordering_method="default" if self._order is None else "natural")
        except CholmodNotPositiveDefiniteError:
            raise not_definite("CHOLMOD met a pivot that is not positive") from None
        if self._order is None:
            fill = int(self._factor.L().nnz)
        super().__init__(K.shape[0], dtype, fill, fill * dtype.itemsize)

    def _solve(self, F: Any, rows: Array | None) -> Array:
        x = self._factor(np.asfortranarray(self.dense(F, self._order)))
        if self._order is not None:
            U = np.empty_like(x)
            U[self._order] = x
            x = U
        return x if rows is None else x[rows]
