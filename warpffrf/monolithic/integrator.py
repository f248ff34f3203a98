r"""Coefficients of the one-step family that both solvers use, and its amplification on an oscillator.

With the algorithmic acceleration `a` (Arnold and Bruels 2007, eq. 17 to 19) any coordinate with increment d of the step
and rate v obeys

    d = h v_0 + h^2 ((1/2 - beta) a_0 + beta a_1),      v_1 = v_0 + h ((1 - gamma) a_0 + gamma a_1),
    (1 - alpha_m) a_1 + alpha_m a_0 = (1 - alpha_f) vdot_1 + alpha_f vdot_0,

and the equations of motion hold at the end of the step, with vdot_1. The members:

    HHT-alpha            alpha_m = 0, alpha_f = -alpha, gamma = 1/2 - alpha, beta = (1 - alpha)^2/4
    generalized-alpha    alpha_m = (2 rho - 1)/(rho + 1), alpha_f = rho/(rho + 1), gamma = 1/2 - alpha_m + alpha_f,
                         beta = (gamma + 1/2)^2/4
    Newmark              alpha_m = alpha_f = 0

(Hilber, Hughes and Taylor 1977; Chung and Hulbert 1993). Three further sets are phases of a run: `REST` (vdot_1 =
d/h^2, a proximal step towards the static state), `PROJECT` (one tiny implicit Euler step: velocities consistent with
the joints), `BEGIN` (one tiny step of constant acceleration: consistent accelerations and multipliers).

Amplification. For `vdot = -omega^2 x - 2 zeta omega v`, with X = (x, h v, h^2 a) and L = h^2 vdot(x, v), a step is
`X_1 = B^-1 R X_0` from the three relations above; its eigenvalues for omega h -> infinity are what the method makes of
frequencies that it cannot resolve.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np

from warpffrf.model.errors import InputError, require_number

HHT_ALPHA = -0.3  # the usual strongest dissipation of HHT; beyond -1/3 the method loses its stability


@dataclass(frozen=True)
class Coefficients:
    """alpha_m, alpha_f, beta, gamma of the module docstring."""

    alpha_m: float
    alpha_f: float
    beta: float
    gamma: float

    def __post_init__(self) -> None:
        for name in ("alpha_m", "alpha_f", "beta", "gamma"):
            require_number(getattr(self, name), f"integrator: {name}")
        if not self.beta > 0.0 or not self.alpha_f < 1.0 or self.alpha_m == 1.0:
            raise InputError(
                "integrator: beta must be greater than zero, alpha_f less than 1 and alpha_m other than 1, got "
                f"beta {self.beta:g}, alpha_f {self.alpha_f:g}, alpha_m {self.alpha_m:g}"
            )


def hht(alpha: float = HHT_ALPHA) -> Coefficients:
    """HHT-alpha, -1/3 <= alpha <= 0; 0 is the trapezoidal rule."""
    alpha = require_number(alpha, "HHT: alpha")
    if not -1.0 / 3.0 <= alpha <= 0.0:
        raise InputError(f"HHT: alpha must lie between -1/3 and 0, got {alpha:g}")
    return Coefficients(0.0, -alpha, 0.25 * (1.0 - alpha) ** 2, 0.5 - alpha)


def generalized_alpha(rho_inf: float = 0.8) -> Coefficients:
    """Generalized-alpha with the spectral radius `rho_inf` (0 to 1) at infinite frequency."""
    rho = require_number(rho_inf, "generalized-alpha: rho_inf")
    if not 0.0 <= rho <= 1.0:
        raise InputError(f"generalized-alpha: rho_inf must lie between 0 and 1, got {rho:g}")
    alpha_m, alpha_f = (2.0 * rho - 1.0) / (rho + 1.0), rho / (rho + 1.0)
    gamma = 0.5 - alpha_m + alpha_f
    return Coefficients(alpha_m, alpha_f, 0.25 * (gamma + 0.5) ** 2, gamma)


def newmark(beta: float = 0.25, gamma: float = 0.5) -> Coefficients:
    """Newmark's method."""
    return Coefficients(0.0, 0.0, beta, gamma)


REST = Coefficients(0.0, 0.0, 1.0, 0.0)
PROJECT = Coefficients(0.0, 0.0, 1.0, 1.0)
BEGIN = Coefficients(0.0, 0.0, 0.5, 1.0)

_NAMES = ("alpha_m", "alpha_f", "beta", "gamma")


def coefficients_of(integrator: Any) -> Coefficients:
    """Coefficients of `integrator`: None (HHT, alpha = -0.3), `Coefficients`, anything with the four as attributes or
    with `coefficients()`, or with `rho_inf`. Raises `InputError` for anything else.
    """
    if integrator is None:
        return hht()
    if isinstance(integrator, Coefficients):
        return integrator
    if getattr(integrator, "project_velocities", False):
        raise InputError("method 'monolithic' does not project velocities; use project_velocities=False")
    found = getattr(integrator, "coefficients", None)
    values = found() if callable(found) else found
    if isinstance(values, tuple) and len(values) == len(_NAMES):
        return Coefficients(*map(float, values))
    if all(hasattr(integrator, name) for name in _NAMES):
        return Coefficients(*(float(getattr(integrator, name)) for name in _NAMES))
    if hasattr(integrator, "rho_inf"):
        return generalized_alpha(integrator.rho_inf)
    raise InputError(
        f"method 'monolithic': integrator {integrator!r} has no alpha_m, alpha_f, beta, gamma; use "
        "warpffrf.monolithic.hht(alpha), generalized_alpha(rho_inf) or Coefficients(...)"
    )


@dataclass(frozen=True)
class Formula:
    """The family at one step size h [s]: affine maps from increments to rates, with slopes `vel` and `acc`."""

    coefficients: Coefficients
    h: float

    @property
    def vel(self) -> float:
        """d v_1/d d = gamma/(beta h) [1/s]."""
        return self.coefficients.gamma / (self.coefficients.beta * self.h)

    @property
    def acc(self) -> float:
        """d vdot_1/d d [1/s^2]."""
        c = self.coefficients
        return (1.0 - c.alpha_m) / (c.beta * self.h**2 * (1.0 - c.alpha_f))

    def predicted(self, v0: np.ndarray, rate0: np.ndarray, a0: np.ndarray) -> np.ndarray:
        """Increment that keeps the rate of the old state."""
        c, h = self.coefficients, self.h
        a1 = (rate0 - c.alpha_m * a0) / (1.0 - c.alpha_m)
        return h * v0 + h * h * ((0.5 - c.beta) * a0 + c.beta * a1)

    def algorithmic(self, d: np.ndarray, v0: np.ndarray, a0: np.ndarray) -> np.ndarray:
        """a_1 of an increment d."""
        c, h = self.coefficients, self.h
        return (d - h * v0 - h * h * (0.5 - c.beta) * a0) / (c.beta * h * h)

    def velocity(self, v0: np.ndarray, a0: np.ndarray, a1: np.ndarray) -> np.ndarray:
        """v_1."""
        gamma = self.coefficients.gamma
        return v0 + self.h * ((1.0 - gamma) * a0 + gamma * a1)

    def rate(self, rate0: np.ndarray, a0: np.ndarray, a1: np.ndarray) -> np.ndarray:
        """vdot_1."""
        c = self.coefficients
        return ((1.0 - c.alpha_m) * a1 + c.alpha_m * a0 - c.alpha_f * rate0) / (1.0 - c.alpha_f)


def amplification(coefficients: Coefficients, omega_h: float, zeta: float = 0.0) -> np.ndarray:
    """Matrix (4, 4) that takes (x, h v, h^2 vdot, h^2 a) over one step of an oscillator; one eigenvalue is zero.

    omega_h: angular frequency times step; zeta: damping ratio.
    """
    c, s = coefficients, omega_h
    B = np.array(
        [
            [1.0, 0.0, 0.0, -c.beta],
            [0.0, 1.0, 0.0, -c.gamma],
            [s * s, 2.0 * zeta * s, 1.0, 0.0],
            [0.0, 0.0, -(1.0 - c.alpha_f), 1.0 - c.alpha_m],
        ]
    )
    R = np.array(
        [
            [1.0, 1.0, 0.0, 0.5 - c.beta],
            [0.0, 1.0, 0.0, 1.0 - c.gamma],
            [0.0, 0.0, 0.0, 0.0],
            [0.0, 0.0, c.alpha_f, -c.alpha_m],
        ]
    )
    scale = np.diag([1.0, 1.0, 1.0 / max(1.0, s * s), 1.0])  # rows of one size
    return np.linalg.solve(scale @ B, scale @ R)
