r"""Friction laws of contact pairs, and of joints.

With the pressure p, the tangential traction tau (2,) on the first surface and the slip velocity w (2,) of the first
surface relative to the second

    Coulomb               |tau| <= mu p;   w = 0 where |tau| < mu p (stick),   tau = -mu p w/|w| where w != 0 (slip)
    RegularisedCoulomb    tau = -mu p w / max(|w|, v_slip): no stick, creep up to v_slip below the bound

The first is set-valued and solved as such, stick and slip per cell; it has no parameter but mu. The second is the limit
that other programs use; as v_slip goes to 0 it becomes the first. Over a step h the slip velocity is the increment of
slip over h, so that the regularised law is a bound with a softness: h v_slip/(mu p) metres per pascal are added to the
tangential compliance of a cell, and the bound |tau| <= mu p cuts it: the same convex problem.
"""

from __future__ import annotations

from dataclasses import dataclass
from numbers import Real
from typing import Any

import numpy as np

from warpffrf.model.errors import InputError, require_number


@dataclass(frozen=True)
class Coulomb:
    """Dry friction with stick and slip. coefficient: mu [-], 0 is frictionless. Raises `InputError`."""

    coefficient: float
    kind = "coulomb"

    def __post_init__(self) -> None:
        value = require_number(self.coefficient, "Coulomb: coefficient", non_negative=True)
        object.__setattr__(self, "coefficient", value)

    @property
    def slip_velocity(self) -> float:
        """Creep [m/s] at which the bound is reached: none, the law sticks."""
        return 0.0

    def describe(self) -> dict[str, Any]:
        """Plain data for hashing."""
        return {"kind": self.kind, "coefficient": self.coefficient}


@dataclass(frozen=True)
class RegularisedCoulomb:
    """Dry friction whose stick creeps: below `slip_velocity` [m/s] the traction is proportional to the velocity.

    coefficient: mu [-]. Raises `InputError`.
    """

    coefficient: float
    slip_velocity: float
    kind = "regularised_coulomb"

    def __post_init__(self) -> None:
        mu = require_number(self.coefficient, "RegularisedCoulomb: coefficient", non_negative=True)
        v = require_number(self.slip_velocity, "RegularisedCoulomb: slip_velocity [m/s]", positive=True)
        object.__setattr__(self, "coefficient", mu)
        object.__setattr__(self, "slip_velocity", v)

    def describe(self) -> dict[str, Any]:
        """Plain data for hashing."""
        return {"kind": self.kind, "coefficient": self.coefficient, "slip_velocity": self.slip_velocity}


FRICTION_LAWS = {law.kind: law for law in (Coulomb, RegularisedCoulomb)}


def as_friction(value: Any, label: str) -> Coulomb | RegularisedCoulomb:
    """`value` as a friction law: a number is the coefficient of `Coulomb`. Raises `InputError` naming `label`."""
    if isinstance(value, tuple(FRICTION_LAWS.values())):
        return value
    scalar = isinstance(value, Real) or (isinstance(value, np.ndarray) and value.ndim == 0)
    if isinstance(value, (bool, np.bool_)) or not scalar:
        names = ", ".join(f"laws.{law.__name__}" for law in FRICTION_LAWS.values())
        raise InputError(f"{label}: friction must be a coefficient or one of {names}, got {value!r}")
    return Coulomb(require_number(value, f"{label}: friction", non_negative=True))


def friction_notes(scene: Any, state: str) -> list[str]:
    """A note of the pairs, and the joints, whose friction a static `state` (words for the reader) leaves out."""
    contacts = (*scene.contacts, *scene.lumped_contacts)
    rubbing = [repr(contact.name) for contact in contacts if contact.friction.coefficient > 0.0]
    rubbing += [repr(force.name) for force in scene.forces if hasattr(force, "slip")]
    if not rubbing:
        return []
    return [f"friction of {', '.join(rubbing)} does not act in {state}: it has no slip to answer"]
