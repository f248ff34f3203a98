"""Involute spur gears in their transverse plane: dimensions and curves of a gear, and what follows from two of them.

gear.py   Gear: diameters, tooth thickness, flanks and section as curves
tooth.py  the curves of one tooth
pair.py   GearPair: path of contact, backlash, curvature, sliding, Hertz's pressure
"""

from __future__ import annotations

from typing import TYPE_CHECKING

from warpffrf.model.errors import no_attribute
from warpffrf.model.gears.gear import Gear
from warpffrf.model.gears.pair import GearPair

__all__ = ["Gear", "GearPair"]


def __dir__() -> list[str]:
    return __all__


if not TYPE_CHECKING:
    __getattr__ = no_attribute(__name__, __all__)
