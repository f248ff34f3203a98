r"""A pin in a bore of nearly its own radius, frictionless, plane strain: the conformal problem of Persson.

A disc of radius R, pressed by a force P' per length in its interior into a hole of radius R + dR in an infinite plate,
is in contact for |theta| < eps; eps need not be small. Sources: A. Persson, On the stress distribution of cylindrical
elastic bodies in contact, Dissertation, Chalmers, 1964; M. Ciavarella, P. Decuzzi, Int. J. Solids Structures 38 (2001)
4507. The integral equation is derived here independently from Michell's harmonics.

**Harmonics.** The pressure p = sum p_n cos(n theta) on the rim. For n >= 2 the stress function (A r^n + B r^(n+2)) of
the disc, (C r^-n + D r^(2-n)) of the plate, with sigma_rr = -p_n cos(n theta) and sigma_rtheta = 0 at r = R, gives with
kappa = 3 - 4 nu the radial displacements (over R cos(n theta))

    disc:   -(p_n/(4 G1)) (1/(n - 1) + kappa1/(n + 1)),      plate:   (p_n/(4 G2)) (1/(n + 1) + kappa2/(n - 1)),

and for n = 0  -p_0 (kappa1 - 1)/(4 G1)  and  p_0/(2 G2). The harmonic n = 1 only moves both as rigid bodies, however
the resultant is supported inside. With delta the displacement of the disc the gap is dR - delta cos(theta) + u_plate -
u_disc; the operator d2/dtheta2 + 1 removes delta and each n = 1. In the patch, with

    S = (1 + kappa1)/(4 G1) + (1 + kappa2)/(4 G2) = 2/E*,   c = (kappa2 - 1)/(2 G2) - (kappa1 - 1)/(2 G1),
    d = (kappa1 - 1)/(4 G1) + 1/(2 G2)                                          (= 1/E* for like materials, c = 0)

    S sum_{n>=1} n p_n cos(n theta) + (c/2) p = dR/R + (d + c/2) p_0 + (S + c/2) p_1 cos(theta).

The sum is H', H = sum p_n sin(n theta) the conjugate of p; integrated once, with y = tan(theta/2),

    S H + (c/2) int_0^theta p = (dR/R + (d + c/2) p_0) theta + (S + c/2) p_1 sin(theta),
    H = (1/pi) PV int p/(y - t) dt,   p_0 the mean of p,   p_1 = P'/(pi R).

**Solution.** p = sqrt(1 - x^2) sum c_k U_2k(x), y = tan(eps/2) x: H = sum c_k T_(2k+1)(x); collocation. For small eps
only dR/R theta remains on the right and the integral is negligible compared with H: Hertz with 1/R_eff = dR/R^2.

**Like materials in closed form** (`persson`), b = tan(eps/2):

    E* dR/P' = (2 - ln(1 + b^2) - 2 b^4)/(2 pi b^2 (1 + b^2)),
    p R/P' = 2 sqrt(b^2 - y^2)/(pi sqrt(1 + b^2)(1 + y^2)) + ln((w + v)/(w - v))/(2 pi b^2 (1 + b^2)),
             w = sqrt(1 + b^2), v = sqrt(b^2 - y^2);

dR -> 0 at eps = 84.9 degrees, which no load exceeds as long as there is a clearance.

The gap is linear in dR/R: geometry of second order in dR/R is neglected here, but not in a finite element model.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from scipy.optimize import brentq
from scipy.special import eval_chebyt, eval_chebyu

from warpffrf.model.errors import InputError, require_number
from warpffrf.model.material import Material

Array = np.ndarray
TERMS = 24  # of the pressure: the last coefficient is at most 1e-8 of the first up to 84 degrees
POINTS = 200  # of a quadrature of the pressure over the patch: 1e-12
ANGLES = (1e-3, 2.0)  # rad, bounds of the half-angle; below the first one the contact is Hertz's to 1e-6
ANGLE_ERROR = 1e-13  # rad, of the half-angle at a given load


@dataclass(frozen=True, eq=False)
class ConformalPin:
    """A solved state. Angles from the middle of the patch."""

    half_angle: float  # eps [rad]
    load: float  # P' [N/m]
    radius: float  # R of the pin [m]
    clearance: float  # dR [m]
    modulus: float  # E* [Pa]
    coefficients: Array  # c_k [Pa]

    def pressure(self, theta: Array) -> Array:
        """p [Pa] at the angle theta [rad]; 0 outside the patch."""
        x = np.tan(0.5 * np.asarray(theta, dtype=float)) / np.tan(0.5 * self.half_angle)
        inside = np.clip(x, -1.0, 1.0)
        n = 2 * np.arange(len(self.coefficients))
        return np.sqrt(1.0 - inside**2) * (eval_chebyu(n, inside[..., None]) @ self.coefficients) * (np.abs(x) < 1.0)

    @property
    def peak_pressure(self) -> float:
        """p in the middle [Pa]."""
        return float(self.pressure(np.zeros(1))[0])

    @property
    def moment_angle(self) -> float:
        """Twice the root of the second moment of the pressure over the angle [rad]; the half-angle for small ones."""
        turn = np.pi * np.arange(1, POINTS + 1) / (POINTS + 1)
        b, t = np.tan(0.5 * self.half_angle), np.cos(turn)
        theta = 2.0 * np.arctan(b * t)
        weight = self.pressure(theta) * np.sin(turn) / (1.0 + (b * t) ** 2)  # dtheta is this times a constant
        return float(2.0 * np.sqrt(weight @ theta**2 / weight.sum()))


def conformal_by_half_angle(
    half_angle: float, radius: float, clearance: float, pin: Material, bore: Material | None = None
) -> ConformalPin:
    """The state with half-angle eps [rad]; radius R and clearance dR [m]. `bore` None: the plate is rigid.

    A negative load means that no load gives this half-angle.
    """
    eps = require_number(half_angle, "half-angle of the patch", positive=True)
    slope = require_number(clearance, "clearance", positive=True) / require_number(radius, "radius", positive=True)
    if eps >= np.pi:
        raise InputError(f"half-angle of the patch must be below pi, got {eps:g}")
    kappa, G = 3.0 - 4.0 * pin.poisson_ratio, pin.lame[1]
    S, c, d = (1.0 + kappa) / (4.0 * G), -(kappa - 1.0) / (2.0 * G), (kappa - 1.0) / (4.0 * G)
    if bore is not None:
        kappa, G = 3.0 - 4.0 * bore.poisson_ratio, bore.lame[1]
        S, c, d = S + (1.0 + kappa) / (4.0 * G), c + (kappa - 1.0) / (2.0 * G), d + 1.0 / (2.0 * G)
    b = np.tan(0.5 * eps)
    n = 2 * np.arange(TERMS)

    turn = np.pi * np.arange(1, POINTS + 1) / (POINTS + 1)  # Gauss-Chebyshev of the second kind
    t = np.cos(turn)
    root = np.pi / (POINTS + 1) * np.sin(turn) ** 2
    dtheta = root * 2.0 * b / (1.0 + (b * t) ** 2)
    U = eval_chebyu(n, t[:, None])
    p_0 = dtheta @ U / (2.0 * np.pi)
    p_1 = (dtheta * (1.0 - (b * t) ** 2) / (1.0 + (b * t) ** 2)) @ U / np.pi
    x = np.cos(np.pi * np.arange(1, TERMS + 1) / (2 * TERMS + 1))
    theta = 2.0 * np.arctan(b * x)
    matrix = S * eval_chebyt(n + 1, x[:, None]) - np.outer(theta, (d + 0.5 * c) * p_0)
    matrix -= np.outer(np.sin(theta), (S + 0.5 * c) * p_1)
    if c != 0.0:  # int_0^theta p, with x = sin(turn), which smooths the root at the end of the patch
        g, w = np.polynomial.legendre.leggauss(POINTS)
        end = np.arcsin(x)[:, None]
        turn = 0.5 * end * (g + 1.0)
        s = np.sin(turn)
        measure = 0.5 * end * w * np.cos(turn) ** 2 * 2.0 * b / (1.0 + (b * s) ** 2)
        matrix += 0.5 * c * np.einsum("jq,jqk->jk", measure, eval_chebyu(n, s[..., None]))
    found = np.linalg.solve(matrix, slope * theta)
    return ConformalPin(eps, float(np.pi * radius * p_1 @ found), radius, clearance, 2.0 / S, found)


def conformal_by_load(
    load: float, radius: float, clearance: float, pin: Material, bore: Material | None = None
) -> ConformalPin:
    """The state under the load P' [N/m]; radius and clearance [m]. `bore` None: the plate is rigid."""
    require_number(load, "load", positive=True)

    def missing(eps: float) -> float:
        return load / conformal_by_half_angle(eps, radius, clearance, pin, bore).load - 1.0

    if missing(ANGLES[0]) < 0.0:
        raise InputError(f"load {load:g} N/m gives a half-angle below {ANGLES[0]:g}: use Hertz's line contact")
    eps = float(brentq(missing, *ANGLES, xtol=ANGLE_ERROR))  # pyright: ignore[reportArgumentType]
    return conformal_by_half_angle(eps, radius, clearance, pin, bore)


def persson(half_angle: float, theta: Array) -> tuple[float, Array]:
    """Like materials in closed form: E* dR/P' and p R/P' at the angles theta [rad] within the half-angle."""
    b, y = np.tan(0.5 * half_angle), np.tan(0.5 * np.asarray(theta, dtype=float))
    v, w = np.sqrt(np.maximum(b * b - y * y, 0.0)), np.sqrt(1.0 + b * b)
    share = 2.0 * np.pi * b * b * (1.0 + b * b)
    ratio = (2.0 - np.log(1.0 + b * b) - 2.0 * b**4) / share
    return float(ratio), 2.0 * v / (np.pi * w * (1.0 + y * y)) + np.log((w + v) / (w - v)) / share
