"""A driven roller between others around it: one contact surface shared by many pairs.

The rollers are at equal angles about the middle one, each pressed against it along a guide with the same load, and
roll on it. All use one body, so that by symmetry every pair has the same force, and on the middle one they cancel.
"""

from __future__ import annotations

import numpy as np

from warpffrf.model import forces, joints
from warpffrf.model.contact import Contact
from warpffrf.model.errors import require_count, require_number
from warpffrf.model.reduced.body import ReducedBody
from warpffrf.model.scene import Scene

CARRIAGE_MASS, CARRIAGE_INERTIA = 1.0, (1e-3, 1e-3, 1e-3)  # kg, kg m2, of each slide
SPEED = 10.0  # rad/s


def planets(body: ReducedBody, count: int, load: float, *, friction: float = 0.0, creepage: float = 0.0) -> Scene:
    """`count` rollers "planet 1", ... around one "sun", each pressed on it by `load` [N]; pairs "pair 1", ...

    body: a roller reduced with the interface "bore" and the contact surface "rim", its axis along y. All axles are
    driven: the sun's at SPEED [rad/s], the others' against it, slower by `creepage` (a fraction). Raises `InputError`
    for a count below 1 or non-numeric arguments.
    """
    count, load = require_count(count, "planets: count", 1), require_number(load, "planets: load", positive=True)
    radius = body.contact_surfaces["rim"].shape.radius
    scene = Scene(gravity=(0.0, 0.0, 0.0))
    sun = scene.add_body(body, name="sun", angular_velocity=(0.0, SPEED, 0.0))
    axle = scene.add(joints.Revolute(scene.ground, sun["bore"], axis=(0, 1, 0), name="sun axle"))
    scene.add(joints.Drive(axle, SPEED, quantity="velocity"))
    back = -SPEED * (1.0 - creepage)
    for i in range(count):
        angle = 2.0 * np.pi * i / count
        out = np.array([np.cos(angle), 0.0, np.sin(angle)])
        name, at = f"planet {i + 1}", 2.0 * radius * out
        planet = scene.add_body(body, name=name, position=at, angular_velocity=(0.0, back, 0.0))
        slide = scene.add_rigid_body(CARRIAGE_MASS, CARRIAGE_INERTIA, name=f"slide {i + 1}", position=at)
        center = slide.at((0.0, 0.0, 0.0))
        axle = scene.add(joints.Revolute(center, planet["bore"], axis=(0, 1, 0), name=f"{name} axle"))
        scene.add(joints.Drive(axle, back, quantity="velocity"))
        scene.add(joints.Prismatic(scene.ground, center, axis=tuple(out), name=f"{name} guide"))
        scene.add(forces.PointForce(center, tuple(-load * out)))
        scene.add(Contact(sun["rim"], planet["rim"], friction=friction, name=f"pair {i + 1}"))
    return scene
