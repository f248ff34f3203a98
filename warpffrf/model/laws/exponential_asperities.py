r"""Rough surfaces: the pressure of asperities falls exponentially with the gap between the mean planes.

    p = p_0 exp(-g/lambda)

is the law of Greenwood and Williamson for an exponential distribution of the asperities' heights (Proc. R. Soc. A 295,
1966), whose decay length lambda is their standard deviation; p_0 is the pressure with the mean planes in touch, g = 0.
It is positive at any gap. Here it ends at a named gap `cut`, where the curve is shifted to zero,

    p = p_0 [exp(-g/lambda) - eps],      eps = exp(-cut/lambda),
    W = lambda p_0 [exp(-g/lambda) - eps] - p_0 eps (cut - g),

so that the pressure errs by no more than eps p_0; by default eps = 1e-6. The inverse is y(p) = lambda ln(p/p_0 + eps).
A uniform pressure p keeps the surfaces apart by lambda ln(p_0/p), if p >> eps p_0: choose `cut` well above that.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any, ClassVar

import numpy as np

from warpffrf.model.errors import InputError, require_number
from warpffrf.model.laws.curves import Exponential
from warpffrf.model.laws.law import Law
from warpffrf.model.messages.named_arguments import named_arguments

NEGLIGIBLE = 1e-6  # of the pressure at zero gap: what the law is cut at by default
DEEPEST = 300.0  # decay lengths between zero gap and the cut: exponentials of more leave the range of numbers


@named_arguments
@dataclass(frozen=True)
class ExponentialAsperities(Law):
    """Asperities with the pressure `pressure_at_zero` [Pa] at zero gap that falls by a factor e every `decay_length`
    [m] and ends at the gap `cut` [m], by default where it is 1e-6 of that at zero gap. Raises `InputError`."""

    pressure_at_zero: float
    decay_length: float
    cut: float | None = None
    kind: ClassVar[str] = "exponential_asperities"

    def __post_init__(self) -> None:
        pressure = require_number(self.pressure_at_zero, "ExponentialAsperities: pressure_at_zero [Pa]", positive=True)
        length = require_number(self.decay_length, "ExponentialAsperities: decay_length [m]", positive=True)
        object.__setattr__(self, "pressure_at_zero", pressure)
        object.__setattr__(self, "decay_length", length)
        if self.cut is not None:
            cut = require_number(self.cut, "ExponentialAsperities: cut [m]", positive=True)
            if cut > DEEPEST * length:
                raise InputError(
                    f"ExponentialAsperities: cut must be at most {DEEPEST:g} decay lengths, got {cut / length:g}"
                )
            object.__setattr__(self, "cut", cut)

    @property
    def end(self) -> float:
        """The gap [m] from which on there is no pressure: `cut`, or what stands for it."""
        return float(-np.log(NEGLIGIBLE) * self.decay_length) if self.cut is None else self.cut

    @property
    def curve(self) -> Exponential:
        """p_0 exp(-g/lambda) up to where it ends."""
        return Exponential(self.pressure_at_zero, self.decay_length, self.end)

    @property
    def remark(self) -> str:
        return f"the pressure of its {self.kind} ends at {self.end:.3g} m"

    def describe(self) -> dict[str, Any]:
        """Plain data for hashing."""
        numbers = {"pressure_at_zero": self.pressure_at_zero, "decay_length": self.decay_length}
        return {"kind": self.kind, **numbers, "cut": self.end}
