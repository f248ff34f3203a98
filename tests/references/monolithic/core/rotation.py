"""Rotation group in NumPy: exponential map, inverse of its right Jacobian, and the derivative of that inverse.

    exp((psi + dpsi)^) = exp(psi^) exp((T dpsi)^),    T^-1(psi) = 1 + psi^/2 + k(a) psi^2,   a = |psi|,
    k = (1 - (a/2) cot(a/2))/a^2,      k'/a = (a^2/(4 sin^2(a/2)) + (a/2) cot(a/2) - 2)/a^4

(Iserles, Munthe-Kaas, Norsett and Zanna 2000, eq. 2.41). The left inverse, from a rotation about fixed axes to the
change of psi, is the transpose. Below `SMALL` the closed forms lose digits and series are used.
"""

from __future__ import annotations

import numpy as np

HUGE = 1e60  # rad: squares and fourth powers stay finite
NO_TURN = 1e-8  # sine of half the angle: 2 asin(s)/s is 2 to round-off below
SMALL = 1e-2  # rad: the next terms of the series of k and k'/a are a^6 times 1e-6 to 1e-5, below round-off


def hat(a: np.ndarray) -> np.ndarray:
    """a^ (..., 3, 3) with a^ x = a x x."""
    out = np.zeros((*np.shape(a)[:-1], 3, 3))
    out[..., 0, 1], out[..., 0, 2], out[..., 1, 2] = -a[..., 2], a[..., 1], -a[..., 0]
    out[..., 1, 0], out[..., 2, 0], out[..., 2, 1] = a[..., 2], -a[..., 1], a[..., 0]
    return out


def cross(a: np.ndarray, b: np.ndarray) -> np.ndarray:
    """a x b of two vectors (3,); ten times faster than numpy.cross, which is significant for thousands of calls."""
    return np.array([a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]])


def multiply(p: np.ndarray, q: np.ndarray) -> np.ndarray:
    """Product of unit quaternions (x, y, z, w): rotation by q, then by p."""
    v, w = p[:3], p[3]
    u, s = q[:3], q[3]
    product = np.array([*(w * u + s * v + cross(v, u)), w * s - v @ u])
    return product / np.linalg.norm(product)


def exponential(psi: np.ndarray) -> np.ndarray:
    """Unit quaternion of the rotation vector psi (3,)."""
    a = float(np.linalg.norm(psi))
    return np.array([*(0.5 * np.sinc(0.5 * a / np.pi) * psi), np.cos(0.5 * a)])


def rotation_vector(A: np.ndarray) -> np.ndarray:
    """psi (3,), |psi| <= pi, of a rotation matrix (3, 3)."""
    from warpffrf.model.rotation import quaternion

    q = quaternion(A)
    s = float(np.linalg.norm(q[:3]))
    return (2.0 / q[3] if s < NO_TURN else 2.0 * np.arctan2(s, q[3]) / s) * q[:3]


def _k(a: float) -> tuple[float, float]:
    """k and k'/a."""
    if not a < HUGE:  # a diverging iteration: its result is refused by the check of residuals
        return np.nan, np.nan
    if a < SMALL:
        a2 = a * a
        return 1.0 / 12.0 + a2 / 720.0 + a2 * a2 / 30240.0, 1.0 / 360.0 + a2 / 7560.0 + a2 * a2 / 201600.0
    half = 0.5 * a
    cot = half / np.tan(half)
    return (1.0 - cot) / (a * a), ((half / np.sin(half)) ** 2 + cot - 2.0) / a**4


def tangent_inverse(psi: np.ndarray) -> np.ndarray:
    """T(psi)^-1 (3, 3): from a rotation about the body's own axes to the change of psi."""
    p = hat(psi)
    return np.eye(3) + 0.5 * p + _k(float(np.linalg.norm(psi)))[0] * (p @ p)


def left_tangent(psi: np.ndarray) -> np.ndarray:
    """T(psi)^T (3, 3): from a change of psi to the rotation about fixed axes."""
    return np.linalg.inv(tangent_inverse(psi)).T


def tangent_inverse_change(psi: np.ndarray, z: np.ndarray) -> np.ndarray:
    """d(T^-1(psi) z)/dpsi (3, 3)."""
    k, slope = _k(float(np.linalg.norm(psi)))
    p = hat(psi)
    pz = p @ z
    return -0.5 * hat(z) + slope * np.outer(p @ pz, psi) - k * (hat(pz) + p @ hat(z))
