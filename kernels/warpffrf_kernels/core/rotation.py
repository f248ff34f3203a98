"""Rotation group: exponential map, its right Jacobian and their inverses.

Derivation. For R(psi) = exp(psi^), a small change of psi rotates the body by `T(psi) dpsi` about its own axes:
    exp((psi + dpsi)^) = exp(psi^) exp((T(psi) dpsi)^) + O(dpsi^2),
    T(psi)    = I - (1 - cos a)/a^2 psi^ + (a - sin a)/a^3 psi^2,           a = |psi|,
    T(psi)^-1 = I + psi^/2 + (1/a^2 - (1 + cos a)/(2 a sin a)) psi^2.
Series are used below SMALL and SMALL_SQUARED, where the closed forms lose digits. (Iserles, Munthe-Kaas, Norsett, Zanna
2000, eq. 2.41.)
"""

import warp as wp

from warpffrf_kernels.core.scalars import mat33, quat, real, vec3

SMALL = wp.constant(wp.float64(1.0e-4))  # rad: the next term of the series of `exponential` is below 1e-18
SMALL_SQUARED = wp.constant(wp.float64(1.0e-4))  # rad^2: truncation of the series of `tangent_inverse` is round-off


@wp.func
def hat(a: vec3) -> mat33:
    o = real(0.0)
    return mat33(o, -a[2], a[1], a[2], o, -a[0], -a[1], a[0], o)


@wp.func
def exponential(psi: vec3) -> quat:
    """Unit quaternion of the rotation vector psi."""
    a2 = wp.dot(psi, psi)
    a = wp.sqrt(a2)
    s = real(0.5) - a2 / real(48.0)
    c = real(1.0) - a2 / real(8.0)
    if a > SMALL:
        s = wp.sin(real(0.5) * a) / a
        c = wp.cos(real(0.5) * a)
    return wp.normalize(quat(s * psi[0], s * psi[1], s * psi[2], c))


@wp.func
def tangent_inverse(psi: vec3) -> mat33:
    """T(psi)^-1: maps a rotation about the body's own axes to the change of the rotation vector."""
    a2 = wp.dot(psi, psi)
    k = real(1.0) / real(12.0) + a2 / real(720.0)
    if a2 > SMALL_SQUARED:
        a = wp.sqrt(a2)
        k = real(1.0) / a2 - (real(1.0) + wp.cos(a)) / (real(2.0) * a * wp.sin(a))
    p = hat(psi)
    return wp.identity(n=3, dtype=real) + real(0.5) * p + k * (p * p)


@wp.func
def rotation_vector(A: mat33) -> vec3:
    """psi with exp(psi^) = A, |psi| <= pi."""
    p = wp.quat_from_matrix(A)
    v = vec3(p[0], p[1], p[2])
    c = p[3]
    if c < real(0.0):
        v = -v
        c = -c
    s = wp.length(v)
    scale = real(2.0) / c
    if s > SMALL:
        scale = real(2.0) * wp.atan2(s, c) / s
    return scale * v


@wp.func
def matrix(p: quat) -> mat33:
    return wp.quat_to_matrix(p)
