r"""Available integrators: one stepper with a table of coefficients, and two host integrators for checks.

The stepper (`warpffrf_kernels.bodies.motion`) is the generalized-alpha method on the rotation group in the form of
Arnold and Bruels (2007, eq. 17 to 19): the equations of motion hold at the end of the step with the true acceleration
vdot_1, the update uses an algorithmic acceleration a,

    d = h v_0 + h^2 ((1/2 - beta) a_0 + beta a_1),      v_1 = v_0 + h ((1 - gamma) a_0 + gamma a_1),
    (1 - alpha_m) a_1 + alpha_m a_0 = (1 - alpha_f) vdot_1 + alpha_f vdot_0.

A method is defined by four numbers (alpha_m, alpha_f, beta, gamma); it is of second order for gamma = 1/2 - alpha_m +
alpha_f. At infinite frequency an oscillator has the root -alpha_f/(1 - alpha_f), of the recursion between the
accelerations, and those of beta z^2 + (1/2 - 2 beta + gamma) z + 1/2 + beta - gamma, of the update; with beta = (gamma
+ 1/2)^2/4 they are both (gamma - 3/2)/(gamma + 1/2).

* **Generalized-alpha** (Chung and Hulbert 1993): alpha_m = (2 rho - 1)/(rho + 1), alpha_f = rho/(rho + 1),
  beta = (gamma + 1/2)^2/4; all three roots are -rho.
* **HHT** (Hilber, Hughes and Taylor 1977; at index 3 Negrut, Rampalli, Ottarsson and Sajdak 2007): with F all forces
  but inertia, M a_1/(1 + alpha) = F_1 - alpha/(1 + alpha) F_0. As F = M vdot, this is a_1 = (1 + alpha) vdot_1 - alpha
  vdot_0, hence alpha_m = 0, alpha_f = -alpha; beta = (1 - alpha)^2/4, gamma = 1/2 - alpha. Forces of joints are
  averaged with the others. The roots are -(1 + alpha)/(1 - alpha), double, and alpha/(1 + alpha).
* **Newmark** (1959): a = vdot, alpha_m = alpha_f = 0. With gamma = 1/2, beta = 1/4 it is the trapezoidal rule, which
  dissipates nothing (double root -1), so that oscillations of the joints' multipliers are not damped.

The host integrators (`warpffrf.online.free_flight.check_run`) step scenes of free bodies in NumPy. They share no code
with the kernels, which they check, and `EnergyMomentum` conserves energy and momenta to round-off."""

from __future__ import annotations

from abc import ABC, abstractmethod
from dataclasses import dataclass
from typing import NamedTuple

import numpy as np

from warpffrf.model.errors import InputError, require_number
from warpffrf.model.messages.named_arguments import named_arguments

__all__ = [
    "INTEGRATORS",
    "Coefficients",
    "EnergyMomentum",
    "GeneralizedAlpha",
    "HHT",
    "Integrator",
    "Newmark",
    "RungeKutta4",
]


def __dir__() -> list[str]:
    return __all__


LEAST_ALPHA = -1.0 / 3.0  # HHT is unconditionally stable down to here


class Coefficients(NamedTuple):
    """The four numbers of a method [-], alpha_m, alpha_f, beta and gamma: see `warpffrf.model.integrators`."""

    alpha_m: float
    alpha_f: float
    beta: float
    gamma: float


class Integrator(ABC):
    """Base of the methods of the stepper: four numbers, see the module.

    project_velocities: after each step the velocities are projected onto those that the joints allow, in the mass
    metric.
    """

    project_velocities: bool = False

    @property
    @abstractmethod
    def coefficients(self) -> Coefficients:
        """Its four numbers."""


@named_arguments
@dataclass(frozen=True)
class GeneralizedAlpha(Integrator):
    """Second order, unconditionally stable for linear systems, with dissipation by choice.

    rho_inf [-]: spectral radius at infinite frequency, 0 (annihilates what it cannot resolve) to 1 (dissipates
    nothing).
    project_velocities: after each step the velocities are projected onto those that the joints allow, in the mass
    metric. Raises `InputError` for rho_inf outside 0 to 1.

    >>> options = wf.RunOptions(integrator=wf.integrators.GeneralizedAlpha(rho_inf=0.9))
    >>> run = wf.simulate(machine, 0.01, step=1e-3, options=options, progress=False)
    >>> round(float(run.body("wheel").angular_velocity[-1, 1]))  # rad/s
    100
    """

    rho_inf: float = 0.8
    project_velocities: bool = False

    def __post_init__(self) -> None:
        require_number(self.rho_inf, "GeneralizedAlpha: rho_inf")
        if not 0.0 <= self.rho_inf <= 1.0:
            raise InputError(f"GeneralizedAlpha: rho_inf must lie between 0 and 1, got {self.rho_inf!r}")
        _require_flag(self.project_velocities, "GeneralizedAlpha")

    @property
    def coefficients(self) -> Coefficients:
        alpha_m = (2.0 * self.rho_inf - 1.0) / (self.rho_inf + 1.0)
        alpha_f = self.rho_inf / (self.rho_inf + 1.0)
        gamma = 0.5 - alpha_m + alpha_f
        return Coefficients(alpha_m, alpha_f, 0.25 * (gamma + 0.5) ** 2, gamma)


@named_arguments
@dataclass(frozen=True)
class HHT(Integrator):
    """HHT-I3, the method of Hilber, Hughes and Taylor with joints at position level; second order.

    alpha: 0 (trapezoidal rule) to -1/3 (most dissipation). project_velocities: as in `GeneralizedAlpha`. Raises
    `InputError` for alpha outside -1/3 to 0.
    """

    alpha: float = -0.1
    project_velocities: bool = False

    def __post_init__(self) -> None:
        require_number(self.alpha, "HHT: alpha")
        if not LEAST_ALPHA <= self.alpha <= 0.0:
            raise InputError(f"HHT: alpha must lie between -1/3 and 0, got {self.alpha!r}")
        _require_flag(self.project_velocities, "HHT")

    @property
    def coefficients(self) -> Coefficients:
        return Coefficients(0.0, -self.alpha, 0.25 * (1.0 - self.alpha) ** 2, 0.5 - self.alpha)


@named_arguments
@dataclass(frozen=True)
class Newmark(Integrator):
    """Newmark's method. Second order for gamma = 1/2 only, first order and dissipative above.

    gamma >= 1/2 and beta >= gamma/2, where it is unconditionally stable; others raise `InputError`.
    project_velocities: as in `GeneralizedAlpha`. With joints gamma = 1/2 leaves oscillations of the reactions undamped.
    """

    gamma: float = 0.5
    beta: float = 0.25
    project_velocities: bool = False

    def __post_init__(self) -> None:
        gamma = require_number(self.gamma, "Newmark: gamma")
        beta = require_number(self.beta, "Newmark: beta")
        if gamma < 0.5:
            raise InputError(f"Newmark: gamma must be at least 1/2 (below it gains energy), got {gamma:g}")
        if gamma > 1.0:
            raise InputError(f"Newmark: gamma must be at most 1, got {gamma:g}")
        if beta < 0.5 * gamma:
            raise InputError(
                f"Newmark: beta must be at least gamma/2 = {0.5 * gamma:g} (unconditionally stable), got {beta:g}"
            )
        _require_flag(self.project_velocities, "Newmark")

    @property
    def coefficients(self) -> Coefficients:
        return Coefficients(0.0, 0.0, float(self.beta), float(self.gamma))


@named_arguments
@dataclass(frozen=True)
class RungeKutta4:
    """The classical explicit Runge-Kutta method of order 4, on the host, for checks: scenes of free bodies under
    gravity, point forces and point torques, with steps below the stability limit of the stiffest mode
    (`warpffrf.online.free_flight.free_bodies`)."""


@named_arguments
@dataclass(frozen=True)
class EnergyMomentum:
    """Energy- and momentum-conserving steps of second order, on the host, for checks: scenes of free bodies, with
    gravity only. At any step size, energy and both momenta are constant to round-off
    (`warpffrf.online.free_flight.free_bodies`)."""


INTEGRATORS = {
    "generalized_alpha": GeneralizedAlpha,
    "hht": HHT,
    "newmark": Newmark,
    "runge_kutta4": RungeKutta4,
    "energy_momentum": EnergyMomentum,
}
CHECK_INTEGRATORS = (
    RungeKutta4,
    EnergyMomentum,
)  # those of `warpffrf.online.free_flight.check_run`, without coefficients


def roots_at_infinity(coefficients: Coefficients) -> np.ndarray:
    """Factors (3,), complex, by which a step multiplies an oscillator of infinite frequency: first that of the
    recursion between the accelerations, then the two of the update, which multipliers of joints obey, too (see the
    module)."""
    _, alpha_f, beta, gamma = coefficients
    update = np.roots([beta, 0.5 - 2.0 * beta + gamma, 0.5 + beta - gamma])
    return np.array([-alpha_f / (1.0 - alpha_f), *update], dtype=complex)


def _require_flag(value: object, label: str) -> None:
    if not isinstance(value, bool):
        raise InputError(f"{label}: project_velocities must be True or False, got {value!r}")
