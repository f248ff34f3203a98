r"""What all laws of friction have in common: the coefficient of their bound as a function of the slip speed.

With the pressure p, the tangential traction tau (2,) on the first surface, the slip velocity w (2,) of the first
surface relative to the second, and mu(v) >= 0 the coefficient at the slip speed v = |w|

    |tau| <= mu(v) p;      w = 0 where |tau| < mu(0) p (stick),      tau = -mu(|w|) p w/|w| where w != 0 (slip),

set-valued at w = 0, and solved as such, stick and slip cell by cell. mu(0) is the coefficient of static friction. A
law with a `creep_limit` does not stick: below it the traction is proportional to the velocity.

A coefficient that falls with the speed does not have one solution for every step. What holds a cell, elastically and
by inertia, resists a slip of the step with the tangential stiffness k [Pa/m]; a sliding cell loses |mu'| p/h of
traction for each metre of it, h the step. Slip is the only one where

    |mu'| p/h < k,      k -> M/(beta h^2) (mass M per area, beta of the integrator) where inertia holds,

so h < M/(beta |mu'| p): a step must resolve how slip grows, within M/(|mu'| p). The elastic stretch of a surface
without inertia has a k that does not grow as h falls; there h > |mu'| p/k, and a shorter step shows jumps that only
local inertia would resolve. Where the iteration comes upon a slip beyond either, it goes on to the solution next to the
state at hand, and the report says so.
"""

from __future__ import annotations

from abc import ABC, abstractmethod
from dataclasses import fields
from typing import Any, ClassVar

import numpy as np


class FrictionLaw(ABC):
    """A law of friction: a frozen dataclass with a `kind`. Those in `warpffrf.model.friction.FRICTION_LAWS` are known
    to scene files by their kind."""

    kind: ClassVar[str]

    @property
    def creep_limit(self) -> float:
        """Slip speed [m/s] at which the bound is reached; 0 of a law that sticks."""
        return 0.0

    @abstractmethod
    def coefficient_at(self, speed: Any) -> np.ndarray:
        """mu [-] of the bound at slip speeds [m/s] from 0 on, any shape."""

    def slope_at(self, speed: Any) -> np.ndarray:
        """dmu/dv [s/m] at slip speeds [m/s], any shape; on the right of a kink."""
        return np.zeros_like(np.asarray(speed, float))

    @property
    def breaks(self) -> tuple[float, ...]:
        """Speeds [m/s] from 0 on between which the coefficient is smooth and only rises, or only falls; beyond the last
        it keeps its value. None where it is the same at all speeds."""
        return ()

    @property
    def static_coefficient(self) -> float:
        """mu(0) [-]."""
        return float(self.coefficient_at(0.0))

    @property
    def largest_coefficient(self) -> float:
        """The largest mu [-] of all speeds."""
        return float(np.max(self.coefficient_at((0.0, *self.breaks))))

    @property
    def least_coefficient(self) -> float:
        """The least mu [-] of all speeds."""
        return float(np.min(self.coefficient_at((0.0, *self.breaks))))

    @property
    def acts(self) -> bool:
        """Whether there is any friction."""
        return self.largest_coefficient > 0.0

    def describe(self) -> dict[str, Any]:
        """Plain data for hashing."""
        values = {field.name: getattr(self, field.name) for field in fields(self)}  # type: ignore[arg-type]
        return {"kind": self.kind} | {n: list(v) if isinstance(v, tuple) else v for n, v in values.items()}
