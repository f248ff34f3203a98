"""A force that is a power of deformation or rate and acts both ways alike, F = c sgn(x) |x|^n.

n = 2 over the rate is drag, c v |v|; n = 3/2 over the deformation is the closing of two balls. For n > 1 the slope is
zero at x = 0: there is no stiffness there, and vibrations about it have no frequency of their own.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property
from typing import Any, ClassVar

import numpy as np

from warpffrf.model.errors import InputError, require_number
from warpffrf.model.forces.characteristics.characteristic import TERMS, Characteristic, Pieces
from warpffrf.model.messages.named_arguments import named_arguments


@named_arguments
@dataclass(frozen=True)
class PowerLaw(Characteristic):
    """F = coefficient * sgn(x) |x|^exponent; coefficient [N/m^exponent, N (s/m)^exponent, N m/rad^exponent ...]
    positive, exponent at least 1. Raises `InputError`."""

    coefficient: float
    exponent: float
    kind: ClassVar[str] = "power_law"

    def __post_init__(self) -> None:
        coefficient = require_number(self.coefficient, "PowerLaw: coefficient", positive=True)
        exponent = require_number(self.exponent, "PowerLaw: exponent")
        if exponent < 1.0:
            raise InputError(
                f"PowerLaw: exponent must be at least 1, got {exponent:g}: the slope at zero would be infinite; use a "
                "ForceTable that is straight through zero"
            )
        object.__setattr__(self, "coefficient", coefficient)
        object.__setattr__(self, "exponent", exponent)

    @cached_property
    def pieces(self) -> Pieces:
        one = np.ones(1)
        return Pieces(np.zeros(0), np.zeros(1), np.zeros((1, TERMS)), self.coefficient * one, self.exponent * one)

    def describe(self) -> dict[str, Any]:
        return {"kind": self.kind, "coefficient": self.coefficient, "exponent": self.exponent}
