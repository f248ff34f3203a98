r"""Dry friction without stick: tau = -mu p w/max(|w|, v_slip), creep up to v_slip below the bound.

The limit that other programs use; as v_slip goes to 0 it becomes `Coulomb`. Over a step h the slip velocity is the
increment of slip over h, so that the law is a bound with a softness: h v_slip/(mu p) metres per pascal are added to the
tangential compliance of a cell, and the bound |tau| <= mu p cuts it: the same convex problem.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any, ClassVar

import numpy as np

from warpffrf.model.errors import require_number
from warpffrf.model.friction.law import FrictionLaw
from warpffrf.model.messages.named_arguments import named_arguments


@named_arguments
@dataclass(frozen=True)
class RegularisedCoulomb(FrictionLaw):
    """Dry friction whose stick creeps: below `slip_velocity` [m/s] the traction is proportional to the velocity.

    coefficient: mu [-], of the bound. Raises `InputError`.
    """

    coefficient: float
    slip_velocity: float
    kind: ClassVar[str] = "regularised_coulomb"

    def __post_init__(self) -> None:
        mu = require_number(self.coefficient, "RegularisedCoulomb: coefficient", non_negative=True)
        v = require_number(self.slip_velocity, "RegularisedCoulomb: slip_velocity [m/s]", positive=True)
        object.__setattr__(self, "coefficient", mu)
        object.__setattr__(self, "slip_velocity", v)

    @property
    def creep_limit(self) -> float:
        return self.slip_velocity

    def coefficient_at(self, speed: Any) -> np.ndarray:
        return np.full_like(np.asarray(speed, float), self.coefficient)
