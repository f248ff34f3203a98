"""Rolling bearings with published loads, deflections and lives: cases P7 to P10 and G3 of the verification cases.

The first element is along +z, where the radial load goes, and y is the axis.
"""

from __future__ import annotations

from typing import Any

import numpy as np

from warpffrf.model import forces, laws
from warpffrf.model.bearings import BallGeometry, Bearing, RollerGeometry, RollingContact
from warpffrf.model.material import Material
from warpffrf.model.scene import Scene

MM, UM = 1e-3, 1e-6
E210, E206 = Material(210e9, 0.3, 7850.0), Material(206e9, 0.3, 7850.0)
P7 = {"elements": 7, "ball_diameter": 11.5 * MM, "pitch_diameter": 43.5 * MM, "osculation": (0.52, 0.53)}
P7_CAPACITY = 23400.0  # N, dynamic


def loaded(scene: Scene, bearing: Bearing, radial: float, axial: float) -> tuple[Scene, Bearing]:
    """With the load [N] on the inner ring."""
    scene.add(forces.PointForce(bearing.inner.at((0, 0, 0)), (0.0, axial, radial), name="load"))
    return scene, bearing


def p7(clearance: float, radial: float, axial: float) -> tuple[Scene, Bearing]:
    """Seven balls of 11.5 mm; diametral clearance [m]."""
    scene = Scene()
    geometry = BallGeometry(**P7, clearance=clearance)
    bearing = scene.add_bearing("bearing", geometry, first=(0, 0, 1), outer=scene.ground, materials=E210)
    return loaded(scene, bearing, radial, axial)


def p8(**geometry: Any) -> tuple[Scene, Bearing]:
    """A 209 ball bearing under 8.9 kN; geometry: more of it."""
    scene = Scene()
    bearing = scene.add_bearing(
        "209",
        BallGeometry(
            elements=9, ball_diameter=12.7 * MM, pitch_diameter=0.5 * (52.291 + 77.706) * MM, osculation=6.6 / 12.7,
            clearance=15 * UM, **geometry,
        ),
        first=(0, 0, 1), outer=scene.ground, materials=E206,
    )  # fmt: skip
    return loaded(scene, bearing, 8900.0, 0.0)


def p9() -> tuple[Scene, Bearing]:
    """A 218 angular-contact bearing under 17.8 kN of thrust."""
    scene = Scene()
    bearing = scene.add_bearing(
        "218",
        BallGeometry(
            elements=16, ball_diameter=22.23 * MM, pitch_diameter=125.3 * MM, osculation=0.5232,
            contact_angle=np.radians(40.0),
        ),
        outer=scene.ground, materials=E206,
    )  # fmt: skip
    return loaded(scene, bearing, 0.0, 17800.0)


P10_CLEARANCE, P10_LENGTH, P10_LOAD = 40.6 * UM, 9.6 * MM, 4450.0  # m, m, N


def p10() -> tuple[Scene, Bearing]:
    """A 209 cylindrical roller bearing, Palmgren's law at each of the two contacts of a roller."""
    scene = Scene()
    bearing = scene.add_bearing(
        "N 209",
        RollerGeometry(
            elements=14, roller_diameter=10 * MM, roller_length=P10_LENGTH, pitch_diameter=64 * MM,
            clearance=P10_CLEARANCE,
        ),
        first=(0, 0, 1), outer=scene.ground, contact=RollingContact(law=laws.PalmgrenLine(P10_LENGTH, 3)),
        materials=E206,
    )  # fmt: skip
    return loaded(scene, bearing, P10_LOAD, 0.0)
