"""Friction laws of contact pairs, and of joints, one file a law; `law` has what they share.

    Coulomb               |tau| <= mu p, stick and slip
    RegularisedCoulomb    no stick: tau proportional to the slip velocity below v_slip
    Stribeck       mu(v) = mu_k + (mu_s - mu_k) exp(-(v/v_s)^delta)
    TabulatedFriction          mu(v) from a table
    TractionCurve         lubricated rolling: a rise in proportion to v, a peak, a fall to a limit; of lumped contacts

A law of one's own is a subclass of `FrictionLaw` with a coefficient and its slope.
"""

from __future__ import annotations

from numbers import Real
from typing import Any, TypeAlias

import numpy as np

from warpffrf.model.checks.plausibility import friction_doubts, warn
from warpffrf.model.errors import InputError, require_number
from warpffrf.model.friction.coulomb import Coulomb
from warpffrf.model.friction.law import FrictionLaw
from warpffrf.model.friction.regularised_coulomb import RegularisedCoulomb
from warpffrf.model.friction.stribeck import Stribeck
from warpffrf.model.friction.tabulated_friction import TabulatedFriction
from warpffrf.model.friction.traction_curve import TractionCurve

FRICTION_LAWS = {law.kind: law for law in (Coulomb, RegularisedCoulomb, Stribeck, TabulatedFriction, TractionCurve)}

RUBBED_REST = (
    "equilibrium(scene, friction=True) has it, from where the scene begins, of surfaces from where they are pressed"
)

__all__ = [
    "FRICTION_LAWS", "Coulomb", "FrictionLaw", "RegularisedCoulomb", "Stribeck", "TabulatedFriction",
    "TractionCurve", "RUBBED_REST", "as_constant_friction", "as_friction", "as_lumped_friction", "as_pair_friction",
    "friction_notes", "rolling_notes", "rubbing",
]  # fmt: skip


FrictionLike: TypeAlias = FrictionLaw | float  # a number is the coefficient of Coulomb


def as_friction(value: Any, label: str) -> FrictionLaw:
    """`value` as a friction law: a number is the coefficient of `Coulomb`. Raises `InputError` naming `label`."""
    if isinstance(value, FrictionLaw):
        warn(friction_doubts(value.largest_coefficient, label))
        return value
    scalar = isinstance(value, Real) or (isinstance(value, np.ndarray) and value.ndim == 0)
    if isinstance(value, (bool, np.bool_)) or not scalar:
        names = ", ".join(f"laws.{law.__name__}" for law in FRICTION_LAWS.values())
        raise InputError(f"{label}: friction must be a coefficient or one of {names}, got {value!r}")
    law = Coulomb(require_number(value, f"{label}: friction", non_negative=True))
    warn(friction_doubts(law.coefficient, label))
    return law


def as_constant_friction(value: Any, label: str) -> FrictionLaw:
    """`as_friction` of what joints and laps take; raises `InputError` for a coefficient that depends on the slip speed
    too."""
    law = as_friction(value, label)
    if law.breaks:
        raise InputError(f"{label}: laws.{type(law).__name__} depends on the slip speed, which {_TAKERS}")
    return law


def as_lumped_friction(value: Any, label: str) -> FrictionLaw:
    """`as_friction` of what lumped contacts take: a coefficient that depends on the slip speed only where nothing
    sticks. Raises `InputError`."""
    law = as_friction(value, label)
    if law.breaks and not law.creep_limit:
        raise InputError(f"{label}: laws.{type(law).__name__} depends on the slip speed, which {_TAKERS}")
    return law


def as_pair_friction(value: Any, label: str) -> FrictionLaw:
    """`as_friction` of what contact pairs of surfaces take: all but a coefficient that depends on the slip speed of a
    law that does not stick. Raises `InputError`."""
    law = as_friction(value, label)
    if law.breaks and law.creep_limit:
        raise InputError(
            f"{label}: laws.{type(law).__name__} is a law of lumped contacts, LumpedContact(...); take "
            "laws.Stribeck or laws.RegularisedCoulomb between surfaces with a pressure"
        )
    return law


_TAKERS = (
    "only contact pairs of surfaces take, and of lumped contacts laws.TractionCurve; give a coefficient, or "
    "laws.RegularisedCoulomb"
)


def rubbing(scene: Any) -> list[str]:
    """Names of the contacts and the frictions of joints of a scene that rub; rolling resistance is no friction."""
    contacts = [contact.name for contact in (*scene.contacts, *scene.lumped_contacts) if contact.friction.acts]
    return contacts + [force.name for force in scene.forces if hasattr(force, "slip")]


def friction_notes(scene: Any, state: str, cure: str = "") -> list[str]:
    """Notes of the pairs, and the joints, whose friction a static `state` (words for the reader) leaves out; `cure`:
    what has friction."""
    names = ", ".join(map(repr, rubbing(scene)))
    if not names:
        return []
    return [f"friction of {names} does not act in {state}: it has no slip to answer{cure and f'; {cure}'}"]


def rolling_notes(scene: Any, state: str) -> list[str]:
    """Notes of the lumped contacts whose rolling resistance a static `state` (words for the reader) leaves out."""
    names = [repr(contact.name) for contact in scene.lumped_contacts if contact.rolling_resistance is not None]
    return [f"rolling resistance of {', '.join(names)} does not act in {state}: nothing turns"] if names else []
