r"""Traction of a lubricated rolling contact as a coefficient over the slip speed.

With the slip velocity w and v = |w| the traction is -mu(v) F w/v,

    mu(v) = mu_p v/v_p,      v <= v_p,                                (elastic and Newtonian rise)
    mu(v) = mu_l + (mu_p - mu_l) exp(-(v - v_p)/v_d),      v > v_p    (fall to the limiting traction, as Stribeck's)

the shape of measured curves of rolling bearings (Gupta, Advanced Dynamics of Rolling Elements, 1984, who takes mu(v) =
(A + B v) exp(-C v) + D): a steep rise from zero slip, a peak, and a fall as the film heats. It is no fluid model: film
thickness, pressure and temperature are in its four numbers. There is no stick. Where the coefficient falls, the slip
grows by itself unless inertia holds it: |mu'| F h < M (`warpffrf.model.friction.law`).
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any, ClassVar

import numpy as np

from warpffrf.model.errors import InputError, require_number
from warpffrf.model.friction.law import FrictionLaw
from warpffrf.model.messages.named_arguments import named_arguments

FALLEN = 28.0  # decay velocities beyond the peak: e^-28 of the fall are left


@named_arguments
@dataclass(frozen=True)
class TractionCurve(FrictionLaw):
    """A coefficient that rises in proportion to the slip speed up to `peak` [-] at `peak_velocity` [m/s], and falls
    from there to `limit` [-], by a factor e of their difference every `decay_velocity` [m/s].

    Of lumped contacts, and so of rigid rolling bearings. 0 < limit <= peak. Raises `InputError`.
    """

    peak: float
    peak_velocity: float
    limit: float
    decay_velocity: float
    kind: ClassVar[str] = "traction_curve"

    def __post_init__(self) -> None:
        for name, unit in (("peak", ""), ("peak_velocity", " [m/s]"), ("limit", ""), ("decay_velocity", " [m/s]")):
            value = require_number(getattr(self, name), f"TractionCurve: {name}{unit}", positive=True)
            object.__setattr__(self, name, value)
        if self.limit > self.peak:
            raise InputError(
                f"TractionCurve: limit must be at most peak, got {self.limit:g} and {self.peak:g}; of a curve that "
                "only rises both are the same"
            )

    @property
    def creep_limit(self) -> float:
        return self.peak_velocity

    @property
    def breaks(self) -> tuple[float, ...]:
        """Where the bound begins to fall, and where it has fallen [m/s]."""
        return 0.0, self.peak_velocity, self.peak_velocity + FALLEN * self.decay_velocity

    def coefficient_at(self, speed: Any) -> np.ndarray:
        beyond = np.maximum(np.asarray(speed, float) - self.peak_velocity, 0.0)
        return self.limit + (self.peak - self.limit) * np.exp(-beyond / self.decay_velocity)

    def slope_at(self, speed: Any) -> np.ndarray:
        v = np.asarray(speed, float)
        beyond = np.maximum(v - self.peak_velocity, 0.0)
        fall = -(self.peak - self.limit) / self.decay_velocity * np.exp(-beyond / self.decay_velocity)
        return np.where(v >= self.peak_velocity, fall, 0.0)
