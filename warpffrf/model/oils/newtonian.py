"""An oil whose viscosity does not depend on pressure: right below some 20 MPa, in most bearings with a soft lining."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any, ClassVar

import numpy as np

from warpffrf.model.messages.named_arguments import named_arguments
from warpffrf.model.oils.oil import Array, Oil


@named_arguments
@dataclass(frozen=True)
class Newtonian(Oil):
    """mu = viscosity [Pa s]. Raises `InputError`."""

    kind: ClassVar[str] = "newtonian"
    form: ClassVar[str] = "newtonian"

    def viscosity_at(self, pressure: Any) -> Array:
        return np.full_like(np.asarray(pressure, dtype=float), self.viscosity)

    def viscosity_slope(self, pressure: Any) -> Array:
        return np.zeros_like(np.asarray(pressure, dtype=float))
