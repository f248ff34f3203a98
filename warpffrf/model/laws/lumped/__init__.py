"""Laws of lumped contacts: force against the approach of two rigid surfaces. `base` defines their common base.

With the approach a [m] of the undeformed surfaces, i.e. their penetration, and the force F [N]

    HertzPoint      F = K a^1.5, K from the curvatures where they touch and the moduli of both
    PalmgrenLine    F = (a l^0.8/3.84e-5)^(1/0.9) in N and mm, steel rollers of length l, by laminae
    IsoLamina       F = sum over laminae c a_k^(10/9), ISO/TS 16281, with the roller's profile
    PowerForce      F = K a^n
    TabulatedForce  F(a) from a table

each times (1 + chi a_dot) where damping is given, never tensile.
"""

from __future__ import annotations

from typing import Any

from warpffrf.model.errors import InputError
from warpffrf.model.laws.lumped.base import Approach, LumpedLaw, PowerForce, TabulatedForce
from warpffrf.model.laws.lumped.hertz_point import HertzPoint, IsoLamina, PalmgrenLine

LUMPED_LAWS = {law.kind: law for law in (HertzPoint, PalmgrenLine, IsoLamina, PowerForce, TabulatedForce)}

__all__ = [
    "LUMPED_LAWS", "Approach", "TabulatedForce", "HertzPoint", "IsoLamina", "LumpedLaw", "PalmgrenLine", "PowerForce",
    "as_lumped_law",
]  # fmt: skip


def as_lumped_law(value: Any, label: str) -> LumpedLaw:
    """`value` if it is a law of lumped contacts; raises `InputError` naming `label` and the existing laws."""
    if not isinstance(value, LumpedLaw):
        names = ", ".join(f"laws.{law.__name__}" for law in LUMPED_LAWS.values())
        raise InputError(
            f"{label}: law must be one of {names}, or a laws.LumpedLaw of your own, which give a force against the "
            f"approach, got {value!r}"
        )
    return value
