"""Unit quaternions (x, y, z, w) and rotation matrices for the description of a scene.

The matrix of a quaternion q = (v, w) maps body axes to world axes: A x = x + 2 w (v x x) + 2 v x (v x x).

Every `rotation` argument accepts the forms read by `orientation`:

    (x, y, z, w)                          unit quaternion, the real part last
    a matrix (3, 3)                       body axes in its columns
    {"axis": (0, 1, 0), "angle": 0.3}     rotated about an axis, right-handed [rad]
    {"xyz": (0.1, 0.2, 0.3)}              Euler angles [rad]: about the fixed axes x, y, z, in sequence;
                                          {"ZYX": ...} in capitals about body-fixed axes
    scipy.spatial.transform.Rotation
"""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

import numpy as np

from warpffrf.model.checks.plausibility import angle_doubts, quaternion_doubts, warn
from warpffrf.model.errors import InputError, require_array, require_direction, require_number

UNIT_TOLERANCE = 1e-6  # |q| - 1 of a quaternion given with six digits; larger is a mistake, not rounding


FORMS = (
    "a quaternion (x, y, z, w), a matrix (3, 3), a scipy Rotation, {'axis': (0, 1, 0), 'angle': 0.3} or Euler angles "
    "{'xyz': (0.1, 0.2, 0.3)}, angles in rad"
)


def orientation(value: Any, name: str) -> np.ndarray:
    """`value`, a pose in one of the forms of the module, as a unit quaternion (x, y, z, w).

    Raises `InputError` naming `name` for anything else, a matrix that is no rotation, a quaternion that is not of
    length 1. Warns of angles that look like degrees, and of (1, 0, 0, 0), which is a rotation by pi here.
    """
    if hasattr(value, "as_quat"):
        return unit_quaternion(value.as_quat(), name)
    if isinstance(value, Mapping):
        return _described(dict(value), name)
    try:
        shape = np.shape(value)
    except ValueError:  # rows of several lengths
        shape = ()
    if shape == (3, 3):
        return _of_matrix(require_array(value, name, (3, 3)), name)
    if shape != (4,):
        raise InputError(f"{name} must be {FORMS}; got {'shape ' + str(shape) if shape else repr(value)}")
    q = unit_quaternion(value, name)
    warn(quaternion_doubts(q, name))
    return q


def _described(value: dict[Any, Any], name: str) -> np.ndarray:
    """The unit quaternion of an axis and an angle, or of Euler angles."""
    if set(value) == {"axis", "angle"}:
        angle = require_number(value["angle"], f"{name}: angle")
        warn(angle_doubts([angle], name))
        axis = require_direction(value["axis"], f"{name}: axis")
        return np.array([*(np.sin(0.5 * angle) * axis), np.cos(0.5 * angle)])
    order = str(next(iter(value), ""))
    if len(value) != 1 or not 1 <= len(order) <= 3 or not (set(order) <= set("xyz") or set(order) <= set("XYZ")):
        raise InputError(f"{name} must be {FORMS}; got {value!r}")
    given = value[order] if len(order) > 1 or np.ndim(value[order]) else [value[order]]
    angles = require_array(given, f"{name}: {order}", (len(order),))
    warn(angle_doubts(angles, name))
    A = np.eye(3)
    for letter, angle in zip(order, angles, strict=True):
        turn = rotation_vector_matrix(angle * np.eye(3)["xyz".index(letter.lower())])
        A = A @ turn if order.isupper() else turn @ A
    return quaternion(A)


def _of_matrix(A: np.ndarray, name: str) -> np.ndarray:
    off = float(np.abs(A.T @ A - np.eye(3)).max())
    if off > UNIT_TOLERANCE:
        raise InputError(
            f"{name}: the matrix is no rotation, its columns are not unit vectors at right angles ({off:.3g})"
        )
    if np.linalg.det(A) < 0.0:
        raise InputError(f"{name}: the matrix is a reflection, its determinant is -1; reverse the sign of one axis")
    return quaternion(A)


def unit_quaternion(value: Any, name: str) -> np.ndarray:
    """`value` (4,) as a unit quaternion (x, y, z, w); `InputError` where its length is not 1."""
    q = require_array(value, name, (4,))
    length = float(np.linalg.norm(q))
    if abs(length - 1.0) > UNIT_TOLERANCE:
        raise InputError(f"{name} must be a unit quaternion (x, y, z, w), its length is {length:.9g}")
    return q / length


def matrix(q: np.ndarray) -> np.ndarray:
    """Rotation matrices (..., 3, 3) of unit quaternions (..., 4), (x, y, z, w)."""
    q = np.asarray(q)
    V = np.zeros((*q.shape[:-1], 3, 3))
    for i, (a, b) in enumerate(((2, 1), (0, 2), (1, 0))):
        V[..., a, b], V[..., b, a] = q[..., i], -q[..., i]
    return np.eye(3) + 2.0 * q[..., 3, None, None] * V + 2.0 * V @ V


def cross(a: np.ndarray, b: np.ndarray) -> np.ndarray:
    """Vector product (..., 3), with the operations of numpy.cross, which takes ten times as long for a few rows."""
    a_x, a_y, a_z = a[..., 0], a[..., 1], a[..., 2]
    b_x, b_y, b_z = b[..., 0], b[..., 1], b[..., 2]
    x = a_y * b_z - a_z * b_y
    found = np.empty((*x.shape, 3))
    found[..., 0] = x
    found[..., 1] = a_z * b_x - a_x * b_z
    found[..., 2] = a_x * b_y - a_y * b_x
    return found


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
