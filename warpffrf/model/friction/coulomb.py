"""Dry friction: |tau| <= mu p with one coefficient in stick and slip; no parameter but mu."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any, ClassVar

import numpy as np

from warpffrf.model.errors import require_number
from warpffrf.model.friction.law import FrictionLaw
from warpffrf.model.messages.named_arguments import named_arguments


@named_arguments
@dataclass(frozen=True)
class Coulomb(FrictionLaw):
    """Dry friction with stick and slip. coefficient: mu [-], 0 is frictionless. Raises `InputError`."""

    coefficient: float
    kind: ClassVar[str] = "coulomb"

    def __post_init__(self) -> None:
        value = require_number(self.coefficient, "Coulomb: coefficient", non_negative=True)
        object.__setattr__(self, "coefficient", value)

    def coefficient_at(self, speed: Any) -> np.ndarray:
        return np.full_like(np.asarray(speed, float), self.coefficient)
