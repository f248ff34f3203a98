"""The one-step family of `warpffrf.model.integrators` as formulas, and the phases of a run as members of it.

`REST`: vdot_1 = d/h^2, a proximal step towards the static state. `PROJECT`: one tiny implicit Euler step, velocities
consistent with the joints. `BEGIN`: one tiny step of constant acceleration, consistent accelerations and multipliers.
`FORGET`: a step by the implicit Euler method, without memory of accelerations.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np

from warpffrf.model.errors import InputError
from warpffrf.model.integrators import HHT, Coefficients

DEFAULT_INTEGRATOR = HHT(-0.3)  # the usual strongest dissipation of HHT

REST = Coefficients(0.0, 0.0, 1.0, 0.0)
PROJECT = Coefficients(0.0, 0.0, 1.0, 1.0)
BEGIN = Coefficients(0.0, 0.0, 0.5, 1.0)
FORGET = Coefficients(0.0, 0.0, 1.0, 1.0)  # with algorithmic accelerations of zero


def coefficients_of(integrator: Any) -> Coefficients:
    """Coefficients of `integrator`, None for the default; raises `InputError` for one without, or with projection."""
    found = DEFAULT_INTEGRATOR if integrator is None else integrator
    if not isinstance(getattr(found, "coefficients", None), Coefficients):
        raise InputError(
            f"the monolithic reference: integrator {integrator!r} has no alpha_m, alpha_f, beta, gamma; use "
            "HHT(alpha), GeneralizedAlpha(rho_inf) or Newmark() of warpffrf.integrators"
        )
    if found.project_velocities:
        raise InputError("the monolithic reference does not project velocities; use project_velocities=False")
    return found.coefficients


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
        """Increment for which the rate of the old state is kept."""
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
