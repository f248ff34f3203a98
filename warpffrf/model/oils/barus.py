r"""Viscosity that grows exponentially with pressure (C. Barus, Am. J. Sci. 45, 1893, 87).

    mu = mu_0 exp(alpha p),      mu' = alpha mu

Mineral oils have alpha between 1e-8 and 3e-8 per Pa. The law holds up to some 0.1 to 0.2 GPa, and rises too steeply
beyond: take `Roelands` there.
"""

from __future__ import annotations

from dataclasses import KW_ONLY, dataclass
from typing import Any, ClassVar

import numpy as np

from warpffrf.model.errors import require_number
from warpffrf.model.messages.named_arguments import named_arguments
from warpffrf.model.oils.oil import Array, Oil


@named_arguments
@dataclass(frozen=True)
class Barus(Oil):
    """mu = viscosity exp(coefficient p); viscosity [Pa s], coefficient alpha [1/Pa]. Raises `InputError`."""

    _: KW_ONLY
    coefficient: float
    kind: ClassVar[str] = "barus"
    form: ClassVar[str] = "barus"

    def __post_init__(self) -> None:
        super().__post_init__()
        alpha = require_number(self.coefficient, f"{self.label}: coefficient [1/Pa]", non_negative=True)
        object.__setattr__(self, "coefficient", alpha)

    @property
    def numbers(self) -> tuple[float, float, float]:
        return self.coefficient, 0.0, 0.0

    def viscosity_at(self, pressure: Any) -> Array:
        return self.viscosity * np.exp(self.coefficient * np.asarray(pressure, dtype=float))

    def viscosity_slope(self, pressure: Any) -> Array:
        return self.coefficient * self.viscosity_at(pressure)
