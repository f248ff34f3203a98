"""Applied forces and compliant elements, one file each; `FORCES` has them by kind.

An element describes itself in the terms of `laws`: springs return a `SpringLaw`, joint friction a `SlipLaw`, a
pretension a `TensionLaw`, loads a `PointLoad` or a `BodyLoad`. The simulation uses nothing else: a user-defined element
is a subclass of `Force`. Nonlinear springs and dampers have `characteristics`.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

from warpffrf.model.errors import no_attribute
from warpffrf.model.forces.characteristics import (
    CHARACTERISTICS,
    Characteristic,
    ForcePolynomial,
    ForceTable,
    Pieces,
    PowerLaw,
)
from warpffrf.model.forces.force import Force
from warpffrf.model.forces.joint_friction import CylindricalFriction, PrismaticFriction, RevoluteFriction
from warpffrf.model.forces.laws import BodyLoad, Coordinate, PointLoad, SlipLaw, SpringLaw, TensionLaw, scalar_law
from warpffrf.model.forces.loads import NodalLoad, PointForce, PointTorque, Pretension, SurfaceLoad
from warpffrf.model.forces.springs import BearingSpring, Bushing, JointSpringDamper, SpringDamper, TorsionalSpringDamper
from warpffrf.model.forces.thermal_load import ThermalLoad

FORCES = {
    element.kind: element
    for element in (
        PointForce,
        PointTorque,
        SpringDamper,
        JointSpringDamper,
        TorsionalSpringDamper,
        Pretension,
        Bushing,
        BearingSpring,
        SurfaceLoad,
        NodalLoad,
        ThermalLoad,
        RevoluteFriction,
        PrismaticFriction,
        CylindricalFriction,
    )
}

__all__ = [
    "CHARACTERISTICS",
    "FORCES",
    "BearingSpring",
    "BodyLoad",
    "Bushing",
    "Characteristic",
    "Coordinate",
    "CylindricalFriction",
    "Force",
    "ForcePolynomial",
    "ForceTable",
    "JointSpringDamper",
    "NodalLoad",
    "Pieces",
    "PointForce",
    "PointLoad",
    "PointTorque",
    "PowerLaw",
    "Pretension",
    "PrismaticFriction",
    "RevoluteFriction",
    "SlipLaw",
    "SpringDamper",
    "SpringLaw",
    "SurfaceLoad",
    "TensionLaw",
    "ThermalLoad",
    "TorsionalSpringDamper",
    "scalar_law",
]


def __dir__() -> list[str]:
    return __all__


if not TYPE_CHECKING:
    __getattr__ = no_attribute(__name__, __all__)
