"""Rigid motions of a set of nodes."""

from __future__ import annotations

import numpy as np


def rigid_modes(points: np.ndarray, center: np.ndarray) -> np.ndarray:
    """Rigid motions (3 n, 6) of nodes `points` (n, 3): three translations, three rotations about `center` (3,)."""
    n = len(points)
    x, y, z = (points - center).T
    R = np.zeros((n, 3, 6))
    R[:, range(3), range(3)] = 1.0
    R[:, 1, 3], R[:, 2, 3] = -z, y
    R[:, 0, 4], R[:, 2, 4] = z, -x
    R[:, 0, 5], R[:, 1, 5] = -y, x
    return R.reshape(3 * n, 6)
