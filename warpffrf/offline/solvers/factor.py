"""The result of every sparse solver: a `Factor` of a symmetric positive definite (or Hermitian) matrix.

CHOLMOD by scikit-sparse, the optional extra `cholmod`.

Supernodal Cholesky factorisation (Chen, Davis, Hager, Rajamanickam 2008, ACM Trans. Math. Softw. 35, 22), with the
speed of the BLAS of the installed SuiteSparse. The ordering is our own nested dissection if the dofs have positions, so
that its size is known before memory is allocated.

Pardiso. MKL Pardiso by pypardiso, the optional extra `pardiso`: real systems.

Schenk and Gaertner 2004, Future Gener. Comput. Syst. 20, 475; settings by the oneMKL reference, `iparm`, counted from 1
there and here: 18 entries of the factors, 16 and 17 permanent memory of factorisation and solution in KiB.

Superlu. SciPy's SuperLU: always available, for small systems, and the reference for the others.

The factors are those of an LU factorisation without pivoting, which a definite matrix does not need (`SymmetricMode`).
Large systems with known positions of the dofs use nested dissection; SuperLU's own orderings cause far more fill.
"""

from __future__ import annotations

from abc import ABC, abstractmethod
from typing import Any

import numpy as np
import scipy.sparse as sp
import scipy.sparse.linalg as spla

from warpffrf.model.errors import InputError
from warpffrf.offline.solvers.ordering import find_fronts, nested_dissection

Array = np.ndarray


class Factor(ABC):
    """The factors of K (n, n), by which `solve` gives K^-1 F."""

    name: str = ""
    concurrent: bool = False  # whether several threads may call `solve` at once, with a gain in speed

    def __init__(self, size: int, dtype: np.dtype, fill: int, bytes: int) -> None:
        self.size = size
        self.dtype = np.dtype(dtype)
        self.fill = fill  # entries of the factors, of both triangles if the solver stores both
        self.bytes = bytes  # memory of the factors

    @property
    def kind(self) -> str:
        """ "real" or "complex"."""
        return "complex" if self.dtype.kind == "c" else "real"

    def solve(self, F: Any, rows: Array | None = None) -> Array:
        """K^-1 F: F (n, m) dense or sparse -> (n, m), or only the requested rows (r, m).

        Loads on few dofs, and few rows, save work if the solver supports it; otherwise they have no effect. Raises
        `InputError` for a load of another size.
        """
        if getattr(F, "ndim", 0) != 2 or F.shape[0] != self.size:
            raise InputError(f"solver: loads must have shape ({self.size}, m), got {getattr(F, 'shape', F)}")
        if self.kind == "real" and F.dtype.kind == "c":
            return self.solve(F.real, rows) + 1j * self.solve(F.imag, rows)
        return self._solve(F, rows)

    @abstractmethod
    def _solve(self, F: Any, rows: Array | None) -> Array:
        """`solve` for loads that fit."""

    def dense(self, F: Any, order: Array | None = None) -> Array:
        """F (n, m) as an array of its own in the factor's precision, its rows in `order`."""
        if sp.issparse(F):
            F = F.toarray()
        taken = F if order is None else F[order]
        return np.array(taken, dtype=self.dtype, copy=order is None or taken.dtype != self.dtype, order="C")


def not_definite(detail: str) -> InputError:
    """The error for a matrix that cannot be the stiffness of a constrained body."""
    return InputError(
        f"the stiffness matrix is not positive definite ({detail}): some part can move without deforming; join parts "
        "that touch at a point, along an edge or not at all, and check the materials"
    )


def missing_extra(name: str, package: str) -> InputError:
    """The error for a solver that is not installed."""
    return InputError(
        f"solver {name!r} is not installed ({package}); pip install 'warpffrf[{name}]', or choose another solver"
    )


class Cholmod(Factor):
    """See the module docstring."""

    name = "cholmod"

    def __init__(self, K: Any, coordinates: Array | None, memory_limit: int | None = None) -> None:
        try:
            from sksparse.cholmod import CholmodNotPositiveDefiniteError, cholesky  # pyright: ignore[reportMissingImports]
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


SMALL_SYSTEM = 2000  # dofs; below it SuperLU's own ordering costs less than a dissection
INDEX_BYTES = 4  # of the row number that goes with each entry
# Entries of the factors up to which the signs of all pivots are checked: SciPy copies the factors for that.
LOOKED_AT = 1 << 24
PROBES = 8  # random loads whose energy is checked in larger systems


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
        """Refuse an indefinite matrix: by its pivots if the factors are small, else by the energy of random loads,
        which detects many negative eigenvalues reliably and a single one by chance."""
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
