"""Unit quaternions (x, y, z, w) and rotation matrices, as the description of a scene needs them.

The matrix of a quaternion q = (v, w) maps body axes to world axes: A x = x + 2 w (v x x) + 2 v x (v x x).
"""

from __future__ import annotations

from typing import Any

import numpy as np

from warpffrf.model.errors import InputError, require_array

UNIT_TOLERANCE = 1e-6  # |q| - 1 of a quaternion typed with six digits; larger is a mistake, not rounding


def unit_quaternion(value: Any, name: str) -> np.ndarray:
    """`value` (4,) as a unit quaternion (x, y, z, w); `InputError` where its length is not 1."""
    q = require_array(value, name, (4,))
    length = float(np.linalg.norm(q))
    if abs(length - 1.0) > UNIT_TOLERANCE:
        raise InputError(f"{name} must be a unit quaternion (x, y, z, w), its length is {length:.9g}")
    return q / length


def matrix(q: np.ndarray) -> np.ndarray:
    """Rotation matrix (3, 3) of a unit quaternion (x, y, z, w)."""
    x, y, z, w = q
    V = np.array([[0.0, -z, y], [z, 0.0, -x], [-y, x, 0.0]])
    return np.eye(3) + 2.0 * w * V + 2.0 * V @ V


def quaternion(A: np.ndarray) -> np.ndarray:
    """Unit quaternion (x, y, z, w), w >= 0, of a rotation matrix (3, 3).

    4 q q^T is linear in A; the column with the largest diagonal entry is free of cancellation (Shepperd 1978).
    """
    t = np.trace(A)
    diagonal = np.array([1.0 + 2.0 * A[0, 0] - t, 1.0 + 2.0 * A[1, 1] - t, 1.0 + 2.0 * A[2, 2] - t, 1.0 + t])
    i = int(np.argmax(diagonal))
    Q = np.diag(diagonal)
    for a, b in ((0, 1), (0, 2), (1, 2)):
        Q[a, b] = Q[b, a] = A[a, b] + A[b, a]
    for a, (b, c) in enumerate(((2, 1), (0, 2), (1, 0))):
        Q[a, 3] = Q[3, a] = A[b, c] - A[c, b]
    q = Q[i] / np.linalg.norm(Q[i])
    return q if q[3] >= 0.0 else -q


def rotation_vector_matrix(r: np.ndarray) -> np.ndarray:
    """Rotation matrix (3, 3) of the rotation vector `r` (3,) [rad]."""
    angle = float(np.linalg.norm(r))
    half = 0.5 * angle
    scale = 0.5 * np.sinc(half / np.pi)  # sin(half)/angle, also at zero
    return matrix(np.array([*(scale * r), np.cos(half)]))
