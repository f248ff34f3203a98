r"""Stiffening of a whole elastic sphere relative to Hertz's half-space, pressed at its pole in free fall.

The sphere of radius R is loaded by Hertz's pressure over its pole and balanced by a uniform body force (gravity, or its
own acceleration). The approach is the displacement of the pole relative to the mean displacement of the sphere's mass,
i.e. to its Tisserand frame. In Legendre series sigma_rr = sum S_n P_n(cos theta) on r = R, no shear (A. I. Lur'e,
Three-Dimensional Problems of the Theory of Elasticity, 1964, chapter 6), for n >= 2

    u_r       = (A (n + 1)(n - 2 + 4 nu) r^(n+1) + B n r^(n-1)) P_n,
    sigma_rr  = 2 G (A (n + 1)(n^2 - n - 2 - 2 nu) r^n + B n (n - 1) r^(n-2)) P_n,
    sigma_rt  = 2 G (A (n^2 + 2 n - 1 + 2 nu) r^n + B (n - 1) r^(n-2)) dP_n/dtheta = 0;

n = 0 is u_r = S_0 r (1 - 2 nu)/(2 G (1 + nu)), and for n = 1, with the body force -S_1/R along the axis e,

    u = c ((x.e) x - r^2 e/2),   c = S_1/(R (2 G + 3 lambda)),   at the pole less the mean: (3/5) c R^2.

The displacement is averaged with the pressure; the mean of Hertz's half-space is 4/5 of its maximum,
pi p0 a/(2 E'): the series then converges fast beyond R/a terms.
"""

from __future__ import annotations

import numpy as np

from warpffrf.model.errors import InputError, require_number
from warpffrf.model.material import Material

POINTS = 400  # of the quadrature over the pressure: thousands of zeros of P_n there need several points each
TERMS = 40.0  # over R/a


def harmonic(n: int, material: Material) -> tuple[float, float]:
    """A and B of the module for S_n = 1 on the unit sphere, n >= 2."""
    G, nu = material.lame[1], material.poisson_ratio
    ratio = -(n * n + 2 * n - 1 + 2.0 * nu) / (n - 1)  # B/A, from sigma_rt = 0
    A = 0.5 / G / ((n + 1) * (n * n - n - 2 - 2.0 * nu) + ratio * n * (n - 1))
    return A, ratio * A


def approach_correction(half_width: float, radius: float, material: Material) -> float:
    """Approach of the sphere at a pressure of this `half_width` [m] over that of the half-space, less 1; negative.

    radius [m]. Raises `InputError` if the patch is not small.
    """
    a = require_number(half_width, "elastic sphere: half_width", positive=True)
    R = require_number(radius, "elastic sphere: radius", positive=True)
    if a > 0.2 * R:
        raise InputError(f"elastic sphere: half_width {a:g} is not small compared with the radius {R:g}")
    lame, G = material.lame
    nu = material.poisson_ratio
    x, w = np.polynomial.legendre.leggauss(POINTS)
    phi, w = 0.25 * np.pi * (x + 1.0), 0.25 * np.pi * w  # sin(theta) = (a/R) sin(phi): p = p0 cos(phi)
    sine = a / R * np.sin(phi)
    cosine = np.sqrt(1.0 - sine**2)
    weight = np.cos(phi) * sine * (a / R * np.cos(phi) / cosine) * w  # p sin(theta) dtheta
    total = float(weight.sum())
    before, P = np.ones(POINTS), cosine
    work = 0.5 * total**2 * R * (1.0 - 2.0 * nu) / (2.0 * G * (1.0 + nu))
    moment = float(weight @ P)
    work += 1.5 * moment**2 * 0.6 * R / (2.0 * G + 3.0 * lame)
    for n in range(2, int(TERMS * R / a)):
        before, P = P, ((2 * n - 1) * cosine * P - (n - 1) * before) / n
        moment = float(weight @ P)
        A, B = harmonic(n, material)
        moved = A * (n + 1) * (n - 2 + 4.0 * nu) + B * n
        work += 0.5 * (2 * n + 1) * moment**2 * R * moved
    half_space = 0.5 * np.pi * a / material.plane_strain_modulus  # largest, per p0
    return (work / total - 0.8 * half_space) / half_space
