r"""The linear systems of the three variants.

K is the Jacobian of all unknowns without contact. Rows and columns are equilibrated: coordinates by the root of their
diagonal entry (of order m/h^2), multipliers so that their largest entry is one, which is the usual scaling of index-3
constraints by h^2. A contact enters by its gradients G (k, size), forces F (k, size) and softness E:

    K z - F^T ds = -r,        G z + E ds = -(g + E s).

    full       K dense, factored by LAPACK (LU) in each iteration
    modified   the same factor kept over iterations and steps until convergence slows
    low_rank   local coordinates are diagonal in K and condensed, only rigid coordinates, modes and rows are dense
               (and, for the law at nodes, Woodbury's identity with the active nodes)

Law "hats": the solution for F^T gives the Schur complement `G K^-1 F^T + E` of the active tests (tens), and ds; exact,
and required for E = 0. Law "nodes": full and modified add the contact stiffness `F^T E^-1 G` to K before factoring, the
conventional way; low_rank uses the Schur complement (Woodbury's identity).
"""

from __future__ import annotations

from typing import Any, Protocol

import numpy as np
from scipy.linalg import blas as _blas
from scipy.linalg import lapack as _lapack

from references.monolithic.core.equations import Balance
from references.monolithic.core.state import Layout

blas: Any = _blas  # routines made at import, unknown to type checkers
lapack: Any = _lapack
VARIANTS = ("full", "modified", "low_rank")


class SingularError(ArithmeticError):
    """K cannot be factored."""


class Solver(Protocol):
    """A factored K."""

    def solve(self, right: np.ndarray) -> np.ndarray:
        """K^-1 times `right` (size,) or (size, k)."""
        ...


def dense_jacobian(
    layout: Layout,
    balance: Balance,
    turnings: list[tuple[Any, np.ndarray]],
    stiffness: list[Any],
    buffer: np.ndarray | None = None,
) -> np.ndarray:
    """K (size, size), Fortran order, in `buffer` if given.

    `turnings`: per pair its state and the derivative (columns, rigid) of the contact forces by the rigid coordinates;
    `stiffness`: (columns, F, G, E) of contacts to be added.
    """
    n, c, o = layout.size, layout.coordinates, layout.retained
    K = np.zeros((n, n), order="F") if buffer is None else buffer
    K.fill(0.0)
    K[:o, :o] = balance.retained[:o, :o]
    K[:o, c:] = balance.retained[:o, o:]
    K[c:, :o] = balance.retained[o:, :o]
    K[c:, c:] = balance.retained[o:, o:]
    local = np.arange(o, c)
    K[local, local] = balance.diagonal
    for state, turning in turnings:
        at = state.data.columns
        K[np.ix_(at, at[: turning.shape[1]])] -= turning
    for at, F, G, E in stiffness:
        _add(K, at, blas.dgemm(1.0, F.T, (G / E[:, None]).T, trans_b=True))
    return K


def _add(K: np.ndarray, at: np.ndarray, block: np.ndarray) -> None:
    """K[at, at] += block by runs of consecutive numbers: a few slices instead of a million single entries."""
    ends = np.concatenate([[0], np.flatnonzero(np.diff(at) != 1) + 1, [len(at)]])
    runs = [(slice(i, j), slice(at[i], at[i] + j - i)) for i, j in zip(ends[:-1], ends[1:], strict=True) if j > i]
    for rows, into in runs:
        for columns, beside in runs:
            K[into, beside] += block[rows, columns]


class Dense:
    """LU factor of an equilibrated dense K."""

    def __init__(self, K: np.ndarray, coordinates: int) -> None:
        self.scale = _scales(K, coordinates)
        rows = K.T  # C order: both passes are contiguous in memory
        rows *= self.scale[:, None]
        rows *= self.scale
        self.factor, self.pivots, info = lapack.dgetrf(K, overwrite_a=True)
        if not np.all(np.isfinite(np.diag(self.factor))):
            raise FloatingPointError("a number beyond all bounds in the Jacobian")
        if info != 0:
            raise SingularError

    def solve(self, right: np.ndarray) -> np.ndarray:
        """K^-1 times `right`."""
        x, info = lapack.dgetrs(self.factor, self.pivots, (right.T * self.scale).T)
        if info != 0:
            raise SingularError
        return (x.T * self.scale).T


class LowRank:
    """K with the diagonal of the local coordinates condensed."""

    def __init__(self, layout: Layout, balance: Balance, turnings: list[tuple[Any, np.ndarray]]) -> None:
        self.layout = layout
        o, c = layout.retained, layout.coordinates
        K = np.asfortranarray(balance.retained.copy())
        self.beside: list[tuple[np.ndarray, np.ndarray, np.ndarray]] = []
        for state, turning in turnings:
            at = state.data.columns
            retained = at < o
            rigid = at[: turning.shape[1]]
            K[np.ix_(at[retained], rigid)] -= turning[retained]
            self.beside.append((at[~retained] - o, rigid, -turning[~retained]))
        self.retained = Dense(K, o)
        self.diagonal = balance.diagonal
        self.at = np.concatenate([np.arange(o), np.arange(c, layout.size)])

    def solve(self, right: np.ndarray) -> np.ndarray:
        """K^-1 times `right`."""
        o, c = self.layout.retained, self.layout.coordinates
        out = np.empty_like(right)
        out[self.at] = self.retained.solve(right[self.at])
        local = right[o:c].copy()
        for rows, rigid, block in self.beside:
            local[rows] -= block @ out[rigid]
        out[o:c] = (local.T / self.diagonal).T
        return out


class Woodbury:
    """K + sum L^T W of a factored K, W = -M R of contacts with a stiffness and without multipliers.

    `(K + L^T W)^-1 r = y - X w`, `y = K^-1 r`, `X = K^-1 L^T`, `(1 + W X) w = W y`.
    """

    def __init__(self, solver: Solver, size: int, stiffness: list[tuple[np.ndarray, np.ndarray, np.ndarray]]) -> None:
        self.solver = solver
        count = sum(len(L) for _, L, _ in stiffness)
        loads, self.weights, row = np.zeros((size, count), order="F"), np.zeros((count, size)), 0
        for at, L, W in stiffness:
            loads[at, row : row + len(L)] = L.T
            self.weights[row : row + len(W), at] = W
            row += len(L)
        self.responses = solver.solve(loads)
        small = np.eye(count) + self.weights @ self.responses
        self.factor, self.pivots, info = lapack.dgetrf(small)
        if not np.all(np.isfinite(self.factor)):
            raise FloatingPointError("a number beyond all bounds in the stiffness of a contact")
        if info != 0:
            raise SingularError

    def solve(self, right: np.ndarray) -> np.ndarray:
        """(K + L^T W)^-1 times `right` (size,)."""
        y = self.solver.solve(right)
        w, info = lapack.dgetrs(self.factor, self.pivots, self.weights @ y)
        if info != 0:
            raise SingularError
        return y - self.responses @ w


def _scales(K: np.ndarray, coordinates: int) -> np.ndarray:
    """Factors (n,) of rows and columns, see the module."""
    diagonal = np.abs(np.diag(K)[:coordinates])
    scale = np.ones(len(K))
    scale[:coordinates] = 1.0 / np.sqrt(np.where(diagonal > 0.0, diagonal, 1.0))
    if coordinates < len(K):
        largest = np.abs(K[coordinates:, :coordinates] * scale[:coordinates]).max(axis=1, initial=0.0)
        scale[coordinates:] = 1.0 / np.where(largest > 0.0, largest, 1.0)
    return scale
