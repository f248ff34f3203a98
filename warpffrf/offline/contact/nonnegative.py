r"""Non-negative least squares that may stop early: few points, positive weights.

    minimise |A c - b|^2   subject to   c >= 0

by the active-set method of Lawson and Hanson (Solving Least Squares Problems, 1974, chapter 23): the column whose
gradient `A^T (b - A c)` is largest enters, the least-squares problem of the columns that are in is solved, and columns
whose coefficient would fall below zero leave on the way. Two things are added. The columns of a `seed` enter first,
each if its gradient is positive; that saves rounds and, of many equal solutions, decides which is found. And `enough`
may end it before the minimum: each round adds about one column, so the first set that is good enough is a small one
(Farhat, Chapman, Avery, Int. J. Numer. Meth. Engng 102, 2015). At the end of a full run

    A^T (A c - b) = 0 where c > 0,      >= 0 where c = 0,

which is what makes a minimum (Karush, Kuhn, Tucker).

Columns are compared by their gradient over their own norm, so that scaling a column changes nothing.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable

import numpy as np
from scipy.linalg import lstsq, qr

OPTIMAL = 1e-11  # gradient over the norms of column and b: below it is round-off of the products
DEPENDENT = 1e-10  # of the norm: a column that the others make up to this adds nothing
ROUNDS_PER_COLUMN = 5  # a column enters and leaves a few times at most; more is cycling by round-off


def nonnegative_least_squares(
    A: np.ndarray,
    b: np.ndarray,
    *,
    seed: Iterable[int] = (),
    enough: Callable[[np.ndarray], bool] | None = None,
) -> np.ndarray:
    """c (n,) >= 0 that minimises |A c - b|, A (m, n); or the first on the way there for which `enough(c)` is true.
    Columns `seed` are tried first. Raises `ArithmeticError` where the method does not end."""
    n = A.shape[1]
    norm = np.linalg.norm(A, axis=0)
    norm[norm == 0.0] = 1.0
    A, size = A / norm, max(float(np.linalg.norm(b)), float(np.finfo(float).tiny))
    c = np.zeros(n)
    inside, refused = np.zeros(n, dtype=bool), np.zeros(n, dtype=bool)
    waiting = list(seed)
    for _ in range(ROUNDS_PER_COLUMN * n + len(waiting)):
        if not waiting and enough is not None and inside.any() and enough(c / norm):
            return c / norm
        gradient = A.T @ (b - A @ c) / size
        gradient[inside | refused] = 0.0
        from_seed = bool(waiting)
        enters = waiting.pop(0) if from_seed else int(np.argmax(gradient))
        if gradient[enters] <= OPTIMAL:
            if from_seed:
                continue
            return c / norm
        inside[enters] = True
        c = _settle(A, b, c, inside)
        refused[:] = refused & ~inside
        refused[enters] = not inside[enters]  # round-off: it entered with a positive gradient and left at once
    raise ArithmeticError("non-negative least squares: the active set does not settle")


def _settle(A: np.ndarray, b: np.ndarray, c: np.ndarray, inside: np.ndarray) -> np.ndarray:
    """Least squares of the columns `inside`, from which those leave that reach zero on the way there."""
    while inside.any():
        chosen = np.flatnonzero(inside)
        target = np.zeros_like(c)
        target[chosen] = least_squares(A[:, chosen], b)
        if np.all(target[chosen] > 0.0):
            return target
        falling = chosen[target[chosen] <= 0.0]
        step = c[falling] / np.maximum(c[falling] - target[falling], np.finfo(float).tiny)
        alpha = min(float(step.min()), 1.0)
        c = c + alpha * (target - c)
        out = falling[step <= alpha]
        inside[out] = False
        c[~inside] = 0.0
    return np.zeros_like(c)


def least_squares(A: np.ndarray, b: np.ndarray) -> np.ndarray:
    """x that minimises |A x - b|, the smallest of many."""
    found = lstsq(A, b, cond=DEPENDENT)
    return np.asarray(found[0])  # type: ignore[index]


def pivots(A: np.ndarray, count: int) -> np.ndarray:
    """The `count` columns of A that QR with column pivoting takes first (DEIM's choice of points, Drmac and Gugercin,
    SIAM J. Sci. Comput. 38, 2016), fewer where A has a lower rank."""
    R, order = (np.asarray(part) for part in qr(A, mode="r", pivoting=True))
    diagonal = np.abs(np.diag(R))
    rank = int(np.sum(diagonal > DEPENDENT * diagonal[0])) if len(diagonal) and diagonal[0] > 0.0 else 0
    return order[: min(count, rank)]
