"""Contact laws: the interface layer between two surfaces. `layers` defines their common base.

With the gap g [m] between the deformed surfaces, the depth d = -g and the pressure p >= 0 [Pa]

    Unilateral               p > 0 only at g = 0: no layer, no parameter
    LinearLayer              p = k d
    NonlinearLayer           p = k d^n
    TabulatedLayer           p(g) from a table
    ExponentialAsperities    p = p_0 exp(-g/lambda)
    GreenwoodTripp           p = K E* F(g/s), asperities with Gaussian heights
    HuntCrossley             p = k d^n (1 + chi d_dot)

Laws of force against approach, of lumped contacts, are in `warpffrf.model.laws.lumped`, those of their rolling
resistance in `warpffrf.model.moments`; both are exported here too. A user-defined law is a subclass of `Law` with a
curve of `warpffrf.model.laws.curves`. The laws of friction are in `warpffrf.model.friction` and are exported here too.
"""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

from warpffrf.model.errors import InputError, no_attribute
from warpffrf.model.friction import (
    Coulomb,
    EyringTraction,
    FrictionLaw,
    RegularisedCoulomb,
    Stribeck,
    TabulatedFriction,
    TractionCurve,
)
from warpffrf.model.laws import curves
from warpffrf.model.laws.greenwood_tripp import GreenwoodTripp
from warpffrf.model.laws.hunt_crossley import HuntCrossley
from warpffrf.model.laws.layers import (
    ExponentialAsperities,
    Law,
    LinearLayer,
    NonlinearLayer,
    TabulatedLayer,
    Unilateral,
)
from warpffrf.model.laws.lumped import (
    LUMPED_LAWS,
    Approach,
    HertzPoint,
    IsoLamina,
    LumpedLaw,
    PalmgrenLine,
    PowerForce,
    TabulatedForce,
)
from warpffrf.model.moments import RollingHysteresis, RollingResistance, RollingResistanceArm

LAWS = {
    law.kind: law
    for law in (
        Unilateral, LinearLayer, NonlinearLayer, TabulatedLayer, ExponentialAsperities, GreenwoodTripp, HuntCrossley,
    )
}  # fmt: skip

__all__ = [
    "LAWS", "LUMPED_LAWS", "Approach", "Coulomb", "ExponentialAsperities", "EyringTraction", "FrictionLaw",
    "GreenwoodTripp", "HertzPoint", "HuntCrossley", "IsoLamina", "Law", "LinearLayer", "LumpedLaw",
    "NonlinearLayer", "PalmgrenLine", "PowerForce", "RegularisedCoulomb", "RollingHysteresis", "RollingResistance",
    "RollingResistanceArm", "Stribeck", "TabulatedForce", "TabulatedFriction", "TabulatedLayer", "TractionCurve",
    "Unilateral", "as_law", "curves",
]  # fmt: skip


def __dir__() -> list[str]:
    return __all__


def as_law(value: Any, label: str, name: str = "law") -> Law:
    """`value`, the argument `name` of `label`, if it is a law with a curve; raises `InputError` with the existing
    laws."""
    if isinstance(value, LumpedLaw):
        raise InputError(
            f"{label}: laws.{type(value).__name__} gives a force against the approach of two rigid bodies; use "
            "LumpedContact(...) for it, or a law of pressure here"
        )
    if not isinstance(value, Law):
        names = ", ".join(f"laws.{law.__name__}" for law in LAWS.values())
        raise InputError(f"{label}: {name} must be one of {names}, or a laws.Law of your own, got {value!r}")
    curve = value.curve
    if curve is not None and not isinstance(curve, curves.Curve):
        raise InputError(
            f"{label}: the law {value.kind} has no curve, its `curve` is {curve!r}; return one of laws.curves, or "
            "None for no layer between the surfaces"
        )
    if value.chi and (curve is None or not curve.convex):
        raise InputError(
            f"{label}: the law {value.kind} is damped, which requires a curve whose slope never falls; leave out the "
            "damping, or use another curve"
        )
    return value


if not TYPE_CHECKING:
    __getattr__ = no_attribute(__name__, __all__)
