r"""Palmgren's line contact of steel rollers (A. Palmgren, Ball and Roller Bearing Engineering, 1959).

    delta = 3.84e-5 F^0.9/l^0.8        in N and mm, at one contact

so that F = (delta l^0.8/3.84e-5)^(10/9), which is proportional to l^(8/9), not quite to l. Laminae share F evenly: a
roller that stands askew has a moment, and one that does not the force of the formula. It is measured on steel, and
holds for no other material.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import ClassVar

import numpy as np

from warpffrf.model.errors import require_count, require_number
from warpffrf.model.laws.lumped.base import Approach, LumpedLaw, Meeting
from warpffrf.model.named_arguments import named_arguments

COEFFICIENT = 3.84e-5  # delta [mm] of F = 1 N and l = 1 mm
FORCE_POWER, LENGTH_POWER = 0.9, 0.8
MM = 1e3  # in a metre


def laminae(length: float, count: int) -> np.ndarray:
    """Middles (count,) [m] of laminae of the same width, from the middle of the length [m]."""
    return length * ((np.arange(count) + 0.5) / count - 0.5)


@named_arguments
@dataclass(frozen=True)
class PalmgrenLine(LumpedLaw):
    """Palmgren's law of a roller of effective length `length` [m], steel on steel; the first surface is the roller.

    laminae: slices that each meet the other surface; one only has no moment against tilting. damping, restitution and
    impact_speed as in `LumpedLaw`. Raises `InputError`.
    """

    length: float
    laminae: int = 1
    kind: ClassVar[str] = "palmgren_line"
    by_laminae: ClassVar[bool] = True

    def __post_init__(self) -> None:
        super().__post_init__()
        self._keep("length", require_number(self.length, "PalmgrenLine: length [m]", positive=True))
        self._keep("laminae", require_count(self.laminae, "PalmgrenLine: laminae", 1))

    def approach(self, meeting: Meeting) -> Approach:
        exponent = 1.0 / FORCE_POWER
        stiffness = (MM * (MM * self.length) ** LENGTH_POWER / COEFFICIENT) ** exponent
        return Approach(stiffness, exponent, z=laminae(self.length, self.laminae), drop=np.zeros(self.laminae))
