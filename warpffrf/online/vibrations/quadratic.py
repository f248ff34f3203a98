"""Eigenvalues of m z'' + d z' + k z = 0, by its first-order form, balanced."""

from __future__ import annotations

import numpy as np
import scipy.linalg

Array = np.ndarray


def quadratic_modes(m: Array, d: Array, k: Array) -> tuple[Array, Array]:
    """Eigenvalues (2 n,) [1/s] and shapes z (n, 2 n); complex matrices are accepted."""
    n = len(m)
    A = np.block([[np.zeros((n, n)), np.eye(n)], [-np.linalg.solve(m, k), -np.linalg.solve(m, d)]])
    balanced, (scale, _) = scipy.linalg.matrix_balance(A, permute=False, separate=True)
    values, vectors = np.linalg.eig(balanced)
    return values, (scale[:, None] * vectors)[:n]
