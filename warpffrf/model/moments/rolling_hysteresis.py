r"""Rolling resistance by hysteresis (D. Tabor 1955; K. L. Johnson, Contact Mechanics, 1985, section 9.2).

As a patch rolls on, its pressure ahead of the middle does work on the material that comes under it, and the one behind
gives it back but for the fraction alpha. With the half-axis b of the patch in the direction of rolling, the pressures
ahead have the moments

    line    2 F b/(3 pi),      ellipse    3 F b/16

about the middle, and alpha of them is left over: M = alpha times that. b grows as F^(1/2) of a line, F^(1/3) of an
ellipse. The shorter half-axis is taken, whatever the direction: elements of bearings roll across the long one.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import ClassVar

from warpffrf.model.errors import InputError, require_number
from warpffrf.model.messages.named_arguments import named_arguments
from warpffrf.model.moments.patch import Patch
from warpffrf.model.moments.resistance import RollingResistance


@named_arguments
@dataclass(frozen=True)
class RollingHysteresis(RollingResistance):
    """The fraction `loss` [-] of the work that presses the material ahead is lost, which makes a moment against
    rolling.

    loss: between 0 and 1, about 0.01 of hard steel. For laws.HertzPoint, laws.PalmgrenLine and laws.IsoLamina, whose
    patches are known. rolling_speed [rad/s] as in `RollingResistance`. Raises `InputError`.
    """

    loss: float
    rolling_speed: float
    kind: ClassVar[str] = "rolling_hysteresis"

    def __post_init__(self) -> None:
        alpha = require_number(self.loss, "RollingHysteresis: loss", non_negative=True)
        if alpha > 1.0:
            raise InputError(f"RollingHysteresis: loss must be at most 1, the whole work, got {alpha:g}")
        speed = require_number(self.rolling_speed, "RollingHysteresis: rolling_speed [rad/s]", positive=True)
        object.__setattr__(self, "loss", alpha)
        object.__setattr__(self, "rolling_speed", speed)

    def bound(self, patch: Patch | None, label: str) -> tuple[float, float]:
        if patch is None:
            raise InputError(
                f"{label}: laws.RollingHysteresis needs the size of the patch, which only laws.HertzPoint, "
                "laws.PalmgrenLine and laws.IsoLamina know; take one of these, or laws.RollingResistanceArm"
            )
        return self.loss * patch.ahead * patch.short, 1.0 + patch.growth
