r"""A layer that stiffens as it is compressed: p = k d^n of the depth d = -g > 0 (see `warpffrf.model.laws.power`).

For bodies that hardly yield beside the layer a cylinder of relative radius R pressed in by d has the half-width
b = sqrt(2 R d), the pressure p = k d^n (1 - x^2/b^2)^n and, per unit of width, the load

    P' = k d^n b B(1/2, n + 1),        B the beta function: 4/3 at n = 1, 3 pi/8 at n = 3/2.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any, ClassVar

import numpy as np

from warpffrf.model.errors import InputError, require_number
from warpffrf.model.laws.layer import Curve
from warpffrf.model.laws.power import SHIFT, power_energy, power_pressure


def require_exponent(value: Any, label: str) -> float:
    """`value` as an exponent of at least 1; raises `InputError` naming `label` and the law for softening layers."""
    number = require_number(value, label)
    if number < 1.0:
        raise InputError(f"{label} must be at least 1, got {number:g}; for a layer that softens use laws.TableLayer")
    return number


@dataclass(frozen=True)
class NonlinearLayer:
    """A layer with the pressure stiffness * depth^exponent; stiffness [Pa/m^exponent] positive, exponent at least 1.

    For exponent 1 the numbers of `LinearLayer`. Raises `InputError`.
    """

    stiffness: float
    exponent: float
    kind: ClassVar[str] = "nonlinear_layer"

    def __post_init__(self) -> None:
        stiffness = require_number(self.stiffness, "NonlinearLayer: stiffness [Pa/m^exponent]", positive=True)
        object.__setattr__(self, "stiffness", stiffness)
        object.__setattr__(self, "exponent", require_exponent(self.exponent, "NonlinearLayer: exponent"))

    @property
    def compliance(self) -> float:
        """0: the yield is no constant, see `curve`."""
        return 0.0

    @property
    def curve(self) -> Curve:
        """Form "power": stiffness, exponent, shift."""
        return Curve("power", (self.stiffness, self.exponent, SHIFT))

    def pressure(self, gap: Any) -> np.ndarray:
        """Pressure [Pa] at the gaps [m], any shape."""
        return power_pressure(-np.asarray(gap, float), self.stiffness, self.exponent)

    def energy(self, gap: Any) -> np.ndarray:
        """Energy [J/m^2] of the layer at the gaps [m], any shape."""
        return power_energy(-np.asarray(gap, float), self.stiffness, self.exponent)

    def describe(self) -> dict[str, Any]:
        """Plain data for hashing."""
        return {"kind": self.kind, "stiffness": self.stiffness, "exponent": self.exponent}
