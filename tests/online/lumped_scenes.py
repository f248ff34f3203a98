"""Scenes of two rigid bodies in lumped contact."""

from __future__ import annotations

from typing import Any

import numpy as np

from warpffrf.model import films, laws, surfaces
from warpffrf.model import rotation as rot
from warpffrf.model.lumped_contact import LumpedContact
from warpffrf.model.material import Material
from warpffrf.model.scene import Scene

STEEL = Material(210e9, 0.3, 7800.0)
Y = (0.0, 1.0, 0.0)
ORIGIN = (0.0, 0.0, 0.0)
HERTZ = laws.HertzPoint(STEEL, STEEL)

BALL = surfaces.Sphere(radius=0.00635, axis_point=ORIGIN, axis_direction=(0.0, 0.0, 1.0))
PLANE = surfaces.Plane(origin=ORIGIN, outward=(1.0, 0.0, 0.0))
ROLLER = surfaces.Cylinder(radius=0.005, axis_point=ORIGIN, axis_direction=Y)
CROWNED = surfaces.CrownedCylinder(radius=0.005, crown_radius=0.5, axis_point=ORIGIN, axis_direction=Y)
SHAFT = surfaces.Cylinder(radius=0.026, axis_point=ORIGIN, axis_direction=Y)
BORE = surfaces.Bore(radius=0.036, axis_point=ORIGIN, axis_direction=Y)
INNER = surfaces.Groove(radius=0.0261455, groove_radius=0.0066, axis_point=ORIGIN, axis_direction=Y)
OUTER = surfaces.Ring(radius=0.038853, groove_radius=0.0066, axis_point=ORIGIN, axis_direction=Y)
CUP = surfaces.Cup(radius=0.0066, axis_point=ORIGIN, axis_direction=Y)
CONE = surfaces.Cone(radius=0.02, half_angle=0.2, axis_point=ORIGIN, axis_direction=Y)

# name -> first surface, second one, place of the first body's middle when they just touch, its turn (rotation vector)
MEETINGS: dict[str, tuple[Any, Any, tuple[float, float, float], tuple[float, float, float]]] = {
    "ball on plane": (BALL, PLANE, (0.00635, 0.0, 0.0), (0.3, 0.4, 0.5)),
    "ball on groove": (BALL, INNER, (0.0, 0.0, 0.0261455 + 0.00635), (1.0, 0.4, 0.5)),
    "ball in ring": (BALL, OUTER, (0.0, 0.0, 0.038853 - 0.00635), (1.0, 0.4, 0.5)),
    "ball in cup": (BALL, CUP, (0.0, 0.00025 * 0.6, 0.00025 * 0.8), (1.0, 0.4, 0.5)),
    "ball on cone": (BALL, CONE, (0.020 + 0.00635, 0.0, 0.0), (1.0, 0.4, 0.5)),
    "crowned roller on shaft": (CROWNED, SHAFT, (0.031, 0.0, 0.0), (0.02, 0.0, 0.01)),
    "crowned roller in bore": (CROWNED, BORE, (0.031, 0.0, 0.0), (0.02, 0.0, 0.01)),
    "crossed cylinders": (ROLLER, SHAFT, (0.031, 0.001, 0.002), (0.9, 0.0, 0.0)),
    "plane on crowned roller": (PLANE, CROWNED, (-0.005, 0.0, 0.0), (0.0, 0.01, 0.01)),
    "roller by laminae on shaft": (ROLLER, SHAFT, (0.031, 0.0, 0.0), (1e-4, 0.3, 2e-4)),
    "roller by laminae in bore": (ROLLER, BORE, (0.031, 0.0, 0.0), (1e-4, 0.3, 2e-4)),
}
FORMS = {
    "in wavy": films.LobedForm(4e-6, 9, 0.4) + films.LobedForm(10e-6, 2)
}  # words of a name -> form of the second surface
MEETINGS |= {
    name.replace(" in ", " in wavy "): MEETINGS[name] for name in ("ball in ring", "roller by laminae in bore")
}


def pair(name: str, approach: float, *, mass: float = 0.01, law: Any = None, **options: Any) -> Scene:
    """Two free bodies, both rotated in the world, whose surfaces are moved into one another by `approach` [m]."""
    first, second, place, turn = MEETINGS[name]
    law = law or (laws.PalmgrenLine(0.01, 5) if "laminae" in name else HERTZ)
    scene = Scene()
    A = rot.rotation_vector_matrix(np.array([0.4, -0.7, 0.2]))
    inertia = mass * 0.01**2 * np.array([0.4, 0.5, 0.6])
    b = scene.add_rigid_body(
        mass, 3.0 * inertia, name="second", position=(0.01, 0.02, -0.03), rotation=rot.quaternion(A),
        center_of_mass=(0.001, 0, 0),
    )  # fmt: skip
    b.surface(second, name="skin", form=next((form for words, form in FORMS.items() if words in name), None))
    a = scene.add_rigid_body(
        mass, inertia, name="first", position=b.position + A @ np.array(place),
        rotation=rot.quaternion(A @ rot.rotation_vector_matrix(np.array(turn))), surfaces={"skin": first},
    )  # fmt: skip
    contact = scene.add(LumpedContact(a["skin"], b["skin"], law=law, name="pair", **options))
    for _ in range(4):
        a.position = a.position - (contact.gap() + approach) * contact.nearest().normal
    return scene
