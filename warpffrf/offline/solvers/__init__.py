"""Sparse direct solvers behind one interface: `factorise(K) -> Factor`, `factor.solve(F)`.

Another solver is one file with a class of the constructor `(K, coordinates, memory_limit)` and a line in `SOLVERS`.
"""

from __future__ import annotations

import importlib.util
from collections.abc import Callable
from typing import Any

import scipy.sparse as sp

from warpffrf.model.errors import InputError
from warpffrf.offline.solvers.factor import SMALL_SYSTEM, Cholmod, Factor, Pardiso, SuperLU
from warpffrf.offline.solvers.multifrontal import Multifrontal
from warpffrf.offline.solvers.ordering import Array

__all__ = ["SOLVERS", "Factor", "chosen", "factorise", "installed"]

SOLVERS: dict[str, Callable[[Any, Array | None, int | None], Factor]] = {
    "multifrontal": Multifrontal,
    "superlu": SuperLU,
    "cholmod": Cholmod,
    "pardiso": Pardiso,
}
MODULES = {"cholmod": "sksparse", "pardiso": "pypardiso"}  # modules imported by the optional ones


def installed() -> list[str]:
    """Names of the available solvers."""
    return [name for name in SOLVERS if name not in MODULES or importlib.util.find_spec(MODULES[name]) is not None]


def require_solver(name: str) -> str:
    """`name` if that solver is installed, otherwise `InputError`."""
    if name not in SOLVERS:
        raise InputError(f"solver {name!r} is not available, use one of {', '.join(SOLVERS)}")
    if name not in installed():
        raise InputError(
            f"solver {name!r} is not installed; pip install 'warpffrf[{name}]', or choose one of "
            f"{', '.join(installed())}"
        )
    return name


def chosen(size: int, placed: bool, name: str | None = None) -> str:
    """The solver of a system of `size` dofs: the named one, which must be installed; without a name "multifrontal" for
    large systems whose dofs have positions (`placed`), "superlu" for all others.

    No optional solver is chosen by default: the default was measured to be as fast as CHOLMOD and faster than Pardiso
    (`bench/offline.py --solvers`), and results then do not depend on the installation.
    """
    if name is not None:
        return require_solver(name)
    return "multifrontal" if placed and size > SMALL_SYSTEM else "superlu"


def factorise(
    K: Any, coordinates: Array | None = None, name: str | None = None, *, memory_limit: int | None = None
) -> Factor:
    """Factors of a sparse symmetric or Hermitian positive definite matrix K (n, n).

    `coordinates` (n, 3) [m] are the positions of the dofs, NaN for those without one; `name` the solver (`chosen`);
    `memory_limit` [byte] bounds the factorisation if its need is known beforehand. Raises `InputError` for a matrix
    that is not square or not positive definite, a solver that is not installed, too little memory.
    """
    if K.ndim != 2 or K.shape[0] != K.shape[1]:
        raise InputError(f"solver: the matrix must be square, got shape {K.shape}")
    if coordinates is not None and coordinates.shape != (K.shape[0], 3):
        raise InputError(f"solver: coordinates must have shape ({K.shape[0]}, 3), got {coordinates.shape}")
    solver = SOLVERS[chosen(K.shape[0], coordinates is not None, name)]
    return solver(sp.csc_matrix(K), coordinates, memory_limit)
