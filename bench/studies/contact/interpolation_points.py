r"""Points of interpolation by modes: DEIM and Q-DEIM.

With modes U (n, m) of a function at n points, U^T U = 1, the function f is taken at m points only, P^T f, and
interpolated between them by the modes:

    f ~ U (P^T U)^-1 P^T f,      |f - f~| <= c |(1 - U U^T) f|,      c = |(P^T U)^-1|_2.

DEIM (S. Chaturantabut, D. C. Sorensen, SIAM J. Sci. Comput. 32, 2010) takes the points one by one, each where the next
mode is worst interpolated by those before it. Q-DEIM (Z. Drmac, S. Gugercin, SIAM J. Sci. Comput. 38, 2016) takes the
first m pivots of a QR factorisation of U^T, for which c <= sqrt(n - m + 1) sqrt(4^m + 6 m - 1)/3, and depends on the
space of the modes alone, not on their order.
"""

from __future__ import annotations

from typing import Any

import numpy as np
from scipy.linalg import qr

Array = np.ndarray


def deim(U: Array) -> Array:
    """Points (m,) of the greedy choice for the modes U (n, m), in the order in which they are taken."""
    points = [int(np.argmax(np.abs(U[:, 0])))]
    for m in range(1, U.shape[1]):
        at = np.array(points)
        rest = U[:, m] - U[:, :m] @ np.linalg.solve(U[at, :m], U[at, m])
        points.append(int(np.argmax(np.abs(rest))))
    return np.array(points)


def qdeim(U: Array) -> Array:
    """Points (m,) of the pivoted QR factorisation of U^T, U (n, m)."""
    found: Any = qr(U.T, mode="economic", pivoting=True)
    return np.asarray(found[2][: U.shape[1]])


def interpolation(U: Array, points: Array) -> Array:
    """U (P^T U)^-1 (n, m): from values at the points to values everywhere."""
    return np.linalg.solve(U[points].T, U.T).T


def constant(U: Array, points: Array) -> float:
    """c = |(P^T U)^-1|_2 of orthonormal U: how much farther than the best approximation the interpolation may be."""
    return float(1.0 / np.linalg.svd(U[points], compute_uv=False)[-1])


def qdeim_bound(n: int, m: int) -> float:
    """Largest c that Q-DEIM can have."""
    return float(np.sqrt(n - m + 1.0) * np.sqrt(4.0**m + 6.0 * m - 1.0) / 3.0)
