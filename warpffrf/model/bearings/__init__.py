"""Rolling bearings: builders of rings, elements, contacts and cage, and the `Bearing` object.

    geometry.py   pitch circle, grooves, clearance, contact angle; what does not fit
    parts.py      place, masses, rings, contacts            cage.py              PrescribedCage, PocketCage
    preload.py    PreloadForce, PreloadOffset               flanges.py           ribs that stop rollers
    bearing.py    Bearing: its parts by name                rating.py            ISO 281 and ISO/TS 16281 lives
    rolling.py    orbit and spin of elements that roll
    build.py      what both builders do                     ball.py, roller.py   the builders

A ring or an element is a body of the scene, rigid or flexible, and `parts.contact_of` chooses the contact that its
surfaces require: a new kind of bearing is a geometry and a builder.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

from warpffrf.model.bearings.bearing import Bearing
from warpffrf.model.bearings.build import add_ball_bearing, add_roller_bearing
from warpffrf.model.bearings.elements import Cage, PocketCage, PrescribedCage
from warpffrf.model.bearings.flanges import Flanges
from warpffrf.model.bearings.parts import Preload, PreloadForce, PreloadOffset
from warpffrf.model.errors import no_attribute

__all__ = [
    "Bearing", "Cage", "Flanges", "PocketCage", "Preload", "PreloadForce", "PreloadOffset", "PrescribedCage",
    "add_ball_bearing",
    "add_roller_bearing",
]  # fmt: skip


def __dir__() -> list[str]:
    return __all__


if not TYPE_CHECKING:
    __getattr__ = no_attribute(__name__, __all__)
