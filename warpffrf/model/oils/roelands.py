r"""Viscosity against pressure to a GPa (C. J. A. Roelands, Correlational Aspects of the Viscosity-Temperature-Pressure
Relationship of Lubricating Oils, Delft 1966).

    mu = mu_0 exp(b ((1 + p/p_r)^z - 1)),      b = ln(mu_0/mu_r),      p_r = 196.2 MPa,   mu_r = 6.315e-5 Pa s

All oils meet at mu_r at the pressure -p_r. What oils are known by is the coefficient of Barus' law, the slope at zero
pressure: alpha = b z/p_r, z = alpha p_r/b. Mineral oils have z between 0.5 and 0.7.
"""

from __future__ import annotations

from dataclasses import KW_ONLY, dataclass
from typing import Any, ClassVar

import numpy as np

from warpffrf.model.errors import InputError, require_number
from warpffrf.model.messages.named_arguments import named_arguments
from warpffrf.model.oils.oil import Array, Oil

POLE_PRESSURE, POLE_VISCOSITY = 196.2e6, 6.315e-5  # Pa, Pa s
LARGEST = 1.5  # of z: no oil is known with more than 1


@named_arguments
@dataclass(frozen=True)
class Roelands(Oil):
    """mu = viscosity exp(b ((1 + p/p_r)^z - 1)) with mu'/mu = coefficient at zero pressure; viscosity [Pa s],
    coefficient alpha [1/Pa]. Raises `InputError`."""

    _: KW_ONLY
    coefficient: float
    kind: ClassVar[str] = "roelands"
    form: ClassVar[str] = "roelands"

    def __post_init__(self) -> None:
        super().__post_init__()
        alpha = require_number(self.coefficient, f"{self.label}: coefficient [1/Pa]", positive=True)
        object.__setattr__(self, "coefficient", alpha)
        if self.viscosity <= POLE_VISCOSITY:
            raise InputError(
                f"{self.label}: viscosity must be above {POLE_VISCOSITY:g} Pa s, the least that an oil of Roelands "
                f"has, got {self.viscosity:g}; take oils.Barus"
            )
        if self.exponent > LARGEST:
            usual = 0.6 * self.rise / POLE_PRESSURE
            raise InputError(
                f"{self.label}: a coefficient of {alpha:g} 1/Pa with {self.viscosity:g} Pa s makes its exponent z "
                f"{self.exponent:.3g}; mineral oils have 0.5 to 0.7, which is about {usual:.2g} 1/Pa here"
            )

    @property
    def rise(self) -> float:
        """b of the module docstring [-]."""
        return float(np.log(self.viscosity / POLE_VISCOSITY))

    @property
    def exponent(self) -> float:
        """z [-]."""
        return self.coefficient * POLE_PRESSURE / self.rise

    @property
    def numbers(self) -> tuple[float, float, float]:
        return self.coefficient, self.rise, self.exponent

    def viscosity_at(self, pressure: Any) -> Array:
        relative = 1.0 + np.asarray(pressure, dtype=float) / POLE_PRESSURE
        return self.viscosity * np.exp(self.rise * (relative**self.exponent - 1.0))

    def viscosity_slope(self, pressure: Any) -> Array:
        relative = 1.0 + np.asarray(pressure, dtype=float) / POLE_PRESSURE
        return self.coefficient * relative ** (self.exponent - 1.0) * self.viscosity_at(pressure)
