r"""Dry friction whose coefficient falls from a static to a kinetic one as slip becomes faster.

    mu(v) = mu_k + (mu_s - mu_k) exp(-(v/v_s)^delta),

steepest at rest for delta = 1, |mu'| = (mu_s - mu_k)/v_s, and at v_s/sqrt(2) for delta = 2, sqrt(2/e) times that. It
is the falling part of Stribeck's curve (Bo and Pavelescu, Wear 82, 1982, with delta from 1/2 to 1; Armstrong-Helouvry,
Control of Machines with Friction, 1991, with 2). delta below 1 has an infinite slope at rest, with which no step would
be short enough to slide away in one way (`law`), and is refused. v_s -> 0 is a coefficient that drops at once.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any, ClassVar

import numpy as np

from warpffrf.model.errors import InputError, require_number
from warpffrf.model.friction.law import FrictionLaw
from warpffrf.model.messages.named_arguments import named_arguments

GONE = 1e-12  # of mu_s - mu_k: what is left of it where the fall ends


@named_arguments
@dataclass(frozen=True)
class Stribeck(FrictionLaw):
    """Friction with the coefficient `static` [-] at rest that falls to `kinetic` [-], by a factor e of their difference
    at the speed `decay_velocity` [m/s]: kinetic + (static - kinetic) exp(-(speed/decay_velocity)^exponent).

    0 < kinetic <= static; exponent at least 1. Raises `InputError`.
    """

    static: float
    kinetic: float
    decay_velocity: float
    exponent: float = 2.0
    kind: ClassVar[str] = "stribeck"

    def __post_init__(self) -> None:
        for name, unit in (("static", ""), ("kinetic", ""), ("decay_velocity", " [m/s]"), ("exponent", "")):
            value = require_number(getattr(self, name), f"Stribeck: {name}{unit}", positive=True)
            object.__setattr__(self, name, value)
        if self.kinetic > self.static:
            raise InputError(
                f"Stribeck: kinetic must be at most static, got {self.kinetic:g} and {self.static:g}; for a "
                "coefficient that rises use laws.TabulatedFriction"
            )
        if self.exponent < 1.0:
            raise InputError(
                f"Stribeck: exponent must be at least 1, got {self.exponent:g}: below, the coefficient falls "
                "infinitely steeply at rest, and a step has more than one solution however short it is"
            )

    @property
    def breaks(self) -> tuple[float, ...]:
        """Speeds [m/s] from rest to where the fall has ended."""
        return 0.0, self.decay_velocity * float(-np.log(GONE)) ** (1.0 / self.exponent)

    def coefficient_at(self, speed: Any) -> np.ndarray:
        x = np.asarray(speed, float) / self.decay_velocity
        return self.kinetic + (self.static - self.kinetic) * np.exp(-(x**self.exponent))

    def slope_at(self, speed: Any) -> np.ndarray:
        x = np.asarray(speed, float) / self.decay_velocity
        falling = (self.coefficient_at(speed) - self.kinetic) * self.exponent * x ** (self.exponent - 1.0)
        return -falling / self.decay_velocity
