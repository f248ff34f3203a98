"""MKL Pardiso by pypardiso, the optional extra `pardiso`: real systems.

Schenk and Gaertner 2004, Future Gener. Comput. Syst. 20, 475; settings by the oneMKL reference, `iparm`, counted from 1
there and here: 18 entries of the factors, 16 and 17 KiB that factorisation and solution take for good.
"""

from __future__ import annotations

from typing import Any

import numpy as np
import scipy.sparse as sp

from warpffrf.model.errors import InputError
from warpffrf.offline.solvers.factor import Factor, missing_extra, not_definite
from warpffrf.offline.solvers.ordering import Array

DEFINITE = 2  # mtype: real symmetric positive definite
ENTRIES, PERMANENT, FACTORS = 18, 16, 17


class Pardiso(Factor):
    """See the module docstring. Pardiso finds its own ordering, `coordinates` are not used."""

    name = "pardiso"

    def __init__(self, K: Any, coordinates: Array | None, memory_limit: int | None = None) -> None:
        try:
            from pypardiso import PyPardisoSolver  # pyright: ignore[reportMissingImports]
            from pypardiso.pardiso_wrapper import PyPardisoError  # pyright: ignore[reportMissingImports]
        except ImportError:
            raise missing_extra("pardiso", "pypardiso") from None
        if K.dtype.kind == "c":
            raise InputError("solver 'pardiso' takes real matrices only; choose 'superlu' or 'cholmod'")
        self._upper = sp.csr_matrix(sp.triu(K))
        self._upper.sort_indices()
        self._solver = PyPardisoSolver(mtype=DEFINITE)
        self._solver.set_iparm(ENTRIES, -1)
        try:
            self._solver.factorize(self._upper)
        except PyPardisoError as error:
            raise not_definite(str(error).split(". See")[0]) from None
        fill = int(self._solver.get_iparm(ENTRIES))
        kept = self._solver.get_iparm(PERMANENT) + self._solver.get_iparm(FACTORS)
        super().__init__(K.shape[0], np.dtype(np.float64), fill, 1024 * int(kept))

    def _solve(self, F: Any, rows: Array | None) -> Array:
        if not F.shape[1]:
            return np.zeros((self.size if rows is None else len(rows), 0))
        x = self._solver.solve(self._upper, np.asfortranarray(self.dense(F))).reshape(self.size, -1)
        return x if rows is None else x[rows]

    def __del__(self) -> None:
        solver = self.__dict__.get("_solver")
        if solver is not None:
            solver.free_memory(everything=True)  # MKL holds the factors, not Python
