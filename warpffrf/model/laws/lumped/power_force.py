"""A force that is a power of the approach, F = K a^n: a stop, a bumper, a contact whose law is known otherwise."""

from __future__ import annotations

from dataclasses import KW_ONLY, dataclass
from typing import ClassVar

from warpffrf.model.errors import InputError, require_number
from warpffrf.model.laws.lumped.base import STEEL_SHEAR, Approach, LumpedLaw, Meeting
from warpffrf.model.messages.named_arguments import named_arguments


@named_arguments
@dataclass(frozen=True)
class PowerForce(LumpedLaw):
    """F = stiffness * approach^exponent where two surfaces touch in a point.

    stiffness [N/m^exponent] positive, exponent at least 1. shear: tangential stiffness over the normal one, of friction
    that sticks. damping, restitution and impact_speed as in `LumpedLaw`. Raises `InputError`.
    """

    stiffness: float
    exponent: float = 1.5
    _: KW_ONLY
    shear: float = STEEL_SHEAR
    kind: ClassVar[str] = "power_force"

    def __post_init__(self) -> None:
        super().__post_init__()
        for name, unit in (("stiffness", " [N/m^exponent]"), ("exponent", ""), ("shear", "")):
            self._keep(name, require_number(getattr(self, name), f"PowerForce: {name}{unit}", positive=True))
        if self.exponent < 1.0:
            raise InputError(
                f"PowerForce: exponent must be at least 1, got {self.exponent:g}: the stiffness would be infinite at "
                "touch; use laws.TabulatedForce"
            )

    def approach(self, meeting: Meeting) -> Approach:
        return Approach(self.stiffness, self.exponent, shear=self.shear)
