"""The outer integrator: generalized-alpha on the rotation group (Chung and Hulbert 1993; Arnold and Bruels 2007)."""

from __future__ import annotations

from dataclasses import dataclass

from warpffrf.model.errors import InputError, require_number


@dataclass(frozen=True)
class GeneralizedAlpha:
    """Second order, unconditionally stable for linear systems.

    rho_inf: spectral radius at infinite frequency, 0 (annihilates what it cannot resolve) to 1 (dissipates nothing).
    alpha_m = (2 rho - 1)/(rho + 1), alpha_f = rho/(rho + 1), gamma = 1/2 - alpha_m + alpha_f, beta = (gamma + 1/2)^2/4.
    """

    rho_inf: float = 0.8

    def __post_init__(self) -> None:
        require_number(self.rho_inf, "GeneralizedAlpha: rho_inf")
        if not 0.0 <= self.rho_inf <= 1.0:
            raise InputError(f"GeneralizedAlpha: rho_inf must lie between 0 and 1, got {self.rho_inf!r}")
