r"""Palmgren's line contact of steel rollers (A. Palmgren, Ball and Roller Bearing Engineering, 1959).

    delta = 3.84e-5 F^0.9/l^0.8        in N and mm, at one contact

so that F = (delta l^0.8/3.84e-5)^(10/9), which is proportional to l^(8/9), not quite to l. Laminae share F evenly: a
roller that stands askew has a moment, and one that does not the force of the formula. It is measured on steel, and
holds for no other material.

The patch of a lamina of the width w is Hertz's of a line, b = sqrt(4 F/(pi E* kappa w)), kappa the relative curvature
across.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import ClassVar

import numpy as np

from warpffrf.model.errors import require_count, require_number
from warpffrf.model.laws.lumped.base import Approach, LumpedLaw, Meeting
from warpffrf.model.messages.named_arguments import named_arguments
from warpffrf.model.moments.patch import Patch

COEFFICIENT = 3.84e-5  # delta [mm] of F = 1 N and l = 1 mm
FORCE_POWER, LENGTH_POWER = 0.9, 0.8
MM = 1e3  # in a metre
MODULUS = 0.5 * 207e9 / (1.0 - 0.3**2)  # Pa: E* of steel on steel
AHEAD = 2.0 / (3.0 * np.pi)  # moment of the pressure ahead of the middle of a line, over F and its half-width


def laminae(length: float, count: int) -> np.ndarray:
    """Middles (count,) [m] of laminae of the same width, from the middle of the length [m]."""
    return length * ((np.arange(count) + 0.5) / count - 0.5)


def line_patch(meeting: Meeting, width: float) -> Patch:
    """Of a lamina of steel of the width [m]."""
    short = float(np.sqrt(4.0 / (np.pi * MODULUS * meeting.curvatures[1] * width)))
    return Patch(short, None, growth=0.5, ahead=AHEAD)


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

    def patch(self, meeting: Meeting) -> Patch:
        return line_patch(meeting, self.length / self.laminae)
