"""What every sparse solver gives back: a `Factor` of a symmetric positive definite (or Hermitian) matrix."""

from __future__ import annotations

from abc import ABC, abstractmethod
from typing import Any

import numpy as np
import scipy.sparse as sp

from warpffrf.model.errors import InputError

Array = np.ndarray


class Factor(ABC):
    """The factors of K (n, n), by which `solve` gives K^-1 F."""

    name: str = ""
    concurrent: bool = False  # whether several threads may call `solve` at once, and gain by it

    def __init__(self, size: int, dtype: np.dtype, fill: int, bytes: int) -> None:
        self.size = size
        self.dtype = np.dtype(dtype)
        self.fill = fill  # entries of the factors, of both triangles where the solver keeps both
        self.bytes = bytes  # memory that they take

    @property
    def kind(self) -> str:
        """ "real" or "complex"."""
        return "complex" if self.dtype.kind == "c" else "real"

    def solve(self, F: Any, rows: Array | None = None) -> Array:
        """K^-1 F: F (n, m) dense or sparse -> (n, m), or only the rows (r, m) asked for.

        Loads on few dofs, and few rows, save work where the solver can use it; otherwise they change nothing. Raises
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
    """The error for a matrix that cannot be a held body's stiffness."""
    return InputError(
        f"the stiffness matrix is not positive definite ({detail}): some part can move without deforming; join parts "
        "that touch at a point, along an edge or not at all, and check the materials"
    )


def missing_extra(name: str, package: str) -> InputError:
    """The error for a solver that is not installed."""
    return InputError(
        f"solver {name!r} is not installed ({package}); pip install 'warpffrf[{name}]', or choose another solver"
    )
