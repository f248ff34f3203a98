r"""The lamina model of roller bearings of ISO/TS 16281:2008.

A roller of effective length L is cut into n laminae. Between the rings, where it has two contacts in series, lamina k
carries q_k = (c_L/n) delta_k^(10/9) with c_L = 35948 L^(8/9), in N and mm, delta_k the approach of both together, each
lessened by the profile P(x_k). One contact of two alike yields half of it:

    F_k = (c_L/n) (2 (a - P(x_k)))^(10/9) = (2^(10/9) c_L/n) (a - P(x_k))^(10/9).

The standard's profile of a roller of diameter D, x from its middle: where L <= 2.5 D

    P = 0.00035 D ln(1/(1 - (2 x/L)^2)),

else none for |x| <= (L - 2.5 D)/2 and, beyond,

    P = 0.0005 D ln(1/(1 - ((2 |x| - (L - 2.5 D))/(2.5 D))^2)).
"""

from __future__ import annotations

from dataclasses import KW_ONLY, dataclass
from typing import ClassVar

import numpy as np

from warpffrf.model.errors import require_count, require_number
from warpffrf.model.laws.lumped.base import Approach, LumpedLaw, Meeting
from warpffrf.model.laws.lumped.palmgren_line import MM, laminae, line_patch
from warpffrf.model.messages.named_arguments import named_arguments
from warpffrf.model.moments.patch import Patch

CONSTANT, LENGTH_POWER, EXPONENT = 35948.0, 8.0 / 9.0, 10.0 / 9.0  # of c_L [N/mm^(10/9)], L in mm
SHORT, SHORT_DROP, LONG_DROP = 2.5, 0.00035, 0.0005  # diameters; of the diameter
LAMINAE = 30  # the fewest that the standard asks for


@named_arguments
@dataclass(frozen=True)
class IsoLamina(LumpedLaw):
    """ISO/TS 16281's law of a steel roller of effective length `length` [m] on a raceway; the first surface is the
    roller.

    laminae: the standard asks for 30 at least. profile: whether the roller has the standard's profile, beside what its
    surface says. damping, restitution and impact_speed as in `LumpedLaw`. Raises `InputError`.
    """

    length: float
    laminae: int = LAMINAE
    _: KW_ONLY
    profile: bool = True
    kind: ClassVar[str] = "iso_lamina"
    by_laminae: ClassVar[bool] = True

    def __post_init__(self) -> None:
        super().__post_init__()
        self._keep("length", require_number(self.length, "IsoLamina: length [m]", positive=True))
        self._keep("laminae", require_count(self.laminae, "IsoLamina: laminae", 1))
        self._keep("profile", bool(self.profile))

    def approach(self, meeting: Meeting) -> Approach:
        stiffness = CONSTANT * (MM * self.length) ** LENGTH_POWER * (2.0 * MM) ** EXPONENT
        x = laminae(self.length, self.laminae)
        drop = iso_profile(x, self.length, 2.0 * meeting.radius) if self.profile else np.zeros(len(x))
        return Approach(stiffness, EXPONENT, z=x, drop=drop)

    def patch(self, meeting: Meeting) -> Patch:
        return line_patch(meeting, self.length / self.laminae)


def iso_profile(x: np.ndarray, length: float, diameter: float) -> np.ndarray:
    """P [m] at the places x [m] from the middle of a roller, inside its length [m]."""
    if length <= SHORT * diameter:
        return -SHORT_DROP * diameter * np.log(1.0 - (2.0 * x / length) ** 2)
    beyond = np.maximum(2.0 * np.abs(x) - (length - SHORT * diameter), 0.0)
    return -LONG_DROP * diameter * np.log(1.0 - (beyond / (SHORT * diameter)) ** 2)
