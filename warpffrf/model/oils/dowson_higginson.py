r"""Density against pressure (D. Dowson and G. R. Higginson, Elasto-hydrodynamic Lubrication, 1966).

    rho/rho_0 = 1 + a p/(1 + b p),      a = 0.6 1/GPa,   b = 1.7 1/GPa of mineral oils,

which rises from 1 with the compliance a and stays below 1 + a/b = 1.35.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np

from warpffrf.model.errors import require_number
from warpffrf.model.messages.named_arguments import named_arguments

Array = np.ndarray


@named_arguments
@dataclass(frozen=True)
class DowsonHigginson:
    """rho/rho_0 = 1 + a p/(1 + b p); a, b [1/Pa] positive, by default those of mineral oils. Raises `InputError`."""

    a: float = 0.6e-9
    b: float = 1.7e-9

    def __post_init__(self) -> None:
        for name in ("a", "b"):
            number = require_number(getattr(self, name), f"oils.DowsonHigginson: {name} [1/Pa]", positive=True)
            object.__setattr__(self, name, number)

    def ratio(self, pressure: Any) -> Array:
        """rho/rho_0 [-] at pressures [Pa], any shape."""
        p = np.asarray(pressure, dtype=float)
        return 1.0 + self.a * p / (1.0 + self.b * p)

    def slope(self, pressure: Any) -> Array:
        """Its derivative [1/Pa] at pressures [Pa], any shape."""
        return self.a / (1.0 + self.b * np.asarray(pressure, dtype=float)) ** 2

    def describe(self) -> dict[str, Any]:
        """Plain data for hashing."""
        return {"a": self.a, "b": self.b}
