"""Moments of lumped contacts, which a force at a place cannot have: against rolling, and against pivoting about the
normal. One file a law; `resistance` has what they share.

    RollingResistanceArm        M = e F, e a lever
    RollingHysteresis   the share of the work of pressing that is lost as a patch rolls on
    spin                Coulomb's friction over Hertz's ellipse in pure pivoting, of the contact's law of friction

Kernels are `warpffrf_kernels.lumped.moments`. A law of rolling of one's own is a subclass of `RollingResistance`.
"""

from __future__ import annotations

from typing import Any

from warpffrf.model.errors import InputError
from warpffrf.model.moments.resistance import NO_RESISTANCE, Resistance, RollingResistance
from warpffrf.model.moments.rolling_hysteresis import RollingHysteresis
from warpffrf.model.moments.rolling_resistance_arm import RollingResistanceArm
from warpffrf.model.moments.spin import spin_resistance

ROLLING_LAWS = {law.kind: law for law in (RollingResistanceArm, RollingHysteresis)}

__all__ = [
    "NO_RESISTANCE", "ROLLING_LAWS", "Resistance", "RollingHysteresis", "RollingResistanceArm", "RollingResistance",
    "as_rolling_resistance", "spin_resistance",
]  # fmt: skip


def as_rolling_resistance(value: Any, label: str) -> RollingResistance | None:
    """`value` if it is a law of rolling resistance, or None; raises `InputError` naming `label` and the laws there
    are."""
    if value is not None and not isinstance(value, RollingResistance):
        names = ", ".join(f"laws.{law.__name__}" for law in ROLLING_LAWS.values())
        raise InputError(
            f"{label}: rolling_resistance must be one of {names}, or None, got {value!r}; a coefficient is a lever "
            "over a radius, laws.RollingResistanceArm(coefficient * radius, rolling_speed)"
        )
    return value
