"""Rolling bearings: builders of rings, elements, contacts and cage, and the `Bearing` object.

    geometry.py   BallGeometry, RollerGeometry: raceways and rollers of all kinds
    kinematics.py rolling without slip, defect frequencies
    parts.py      Materials, RollingContact, axial preload; position, masses, rings, contacts
    elements.py   rolling elements, PrescribedCage, PocketCage
    flanges.py    ribs that stop rollers
    bearing.py    Bearing: its parts by name
    build.py      the builders
    rating.py     load ratings of ISO 281 and ISO 76, factors of equivalent loads
    designations.py  geometries by designation: boundary_dimensions.toml, and estimates of the inside
    life.py       lives of ISO 281 and ISO/TS 16281
    modified_life.py  a_ISO, contamination, duty cycles, static safety
    fits.py       interference fits, operating clearance
    lubrication.py    film thickness, drag, torque of catalogues

A ring or an element is a body of the scene, rigid or flexible, and `parts.contact_of` chooses the contact that its
surfaces require: a new kind of bearing is a geometry and a builder.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

from warpffrf.model.bearings.bearing import Bearing
from warpffrf.model.bearings.designations import catalogue
from warpffrf.model.bearings.elements import Cage, PocketCage, PrescribedCage
from warpffrf.model.bearings.fits import Fit, fit, operating_clearance
from warpffrf.model.bearings.flanges import Flanges
from warpffrf.model.bearings.geometry import BallGeometry, RollerGeometry
from warpffrf.model.bearings.lubrication import catalogue_torque, drag_torque
from warpffrf.model.bearings.modified_life import contamination_factor, duty_life, viscosity_ratio
from warpffrf.model.bearings.parts import AxialPreload, Materials, PreloadForce, PreloadOffset, RollingContact
from warpffrf.model.errors import no_attribute

__all__ = [
    "AxialPreload", "BallGeometry", "Bearing", "Cage", "Fit", "Flanges", "Materials",
    "PocketCage", "PreloadForce", "PreloadOffset", "PrescribedCage", "RollerGeometry",
    "RollingContact", "catalogue", "catalogue_torque", "contamination_factor", "drag_torque", "duty_life", "fit",
    "operating_clearance", "viscosity_ratio",
]  # fmt: skip


def __dir__() -> list[str]:
    return __all__


if not TYPE_CHECKING:
    __getattr__ = no_attribute(__name__, __all__)
