"""Patches that leave a body: a ball over the edges of a slab, a tilted roller over its own end. Friction, all positions
prescribed."""

from __future__ import annotations

from typing import Any

import numpy as np

from scenes.rollers import CARRIAGE_INERTIA, CARRIAGE_MASS, STEEL
from warpffrf.model import joints, signals, surfaces
from warpffrf.model.contact import Contact
from warpffrf.model.mesh import box, roller
from warpffrf.model.reduced.body import ReducedBody
from warpffrf.model.scene import Scene
from warpffrf.offline import ContactGrid, reduce

FRICTION, TILT = 0.2, 5e-4  # rad
DURATION = 0.02  # s
ACROSS = (0.0, 1.0, 0.0)
_HERE = (0.0, 0.0, 0.0)


def slab_body() -> ReducedBody:
    """A slab of 20 x 20 x 8 mm, its face on top at z = 0."""
    mesh = box((0.02, 0.02, 0.008), (12, 12, 4), center=(0.0, 0.0, -0.004), order=1)
    top = surfaces.Plane(origin=_HERE, outward=(0.0, 0.0, 1.0), direction=ACROSS)
    return reduce(
        mesh, STEEL, interfaces={"z_min": "rigid"}, contact={"z_max": top}, modes=0,
        grid=ContactGrid(tangential=True, contact_fixed=False), cache=False, progress=False,
    )  # fmt: skip


def ball_over_slab(slab: ReducedBody, way: tuple[float, float], *, friction: Any = FRICTION) -> Scene:
    """A rigid ball, 40 um deep, leaves the slab along `way` (x, y) within DURATION."""
    radius = 0.06
    scene = Scene()
    block = scene.add_body(slab, name="slab")
    scene.add(joints.Fixed(scene.ground, block["z_min"], name="hold"))
    shape = surfaces.Sphere(radius=radius, axis_point=_HERE, axis_direction=ACROSS)
    ball = scene.add_rigid_body(
        CARRIAGE_MASS, CARRIAGE_INERTIA, name="ball", position=(0.0, 0.0, radius - 40e-6), surfaces={"face": shape}
    )
    along = np.array([*way, 0.0])
    slide = scene.add(joints.Prismatic(scene.ground, ball.at(_HERE), axis=along, name="slide"))
    path = signals.SmoothStep(0.0, 0.0135 * float(np.linalg.norm(along)), duration=DURATION)
    scene.add(joints.Drive(slide, path, quantity="position"))
    scene.add(Contact(block["z_max"], ball["face"], friction=friction, name="pair", overlap=1.0))
    return scene


def long_roller_body() -> ReducedBody:
    """A roller of 100 x 20 mm with ten cells along its axis."""
    mesh = roller(0.05, 0.015, 0.02, sectors=180, layers=4, axial=10, grading=1.6, order=1)
    return reduce(
        mesh, STEEL, interfaces={"bore": "rigid"}, contact={"rim": surfaces.Cylinder()}, modes=0,
        grid=ContactGrid(tangential=True, contact_fixed=False), cache=False, progress=False,
    )  # fmt: skip


def roller_off_its_end(body: ReducedBody) -> Scene:
    """Tilted by TILT, 60 um deep, the roller slides along its axis until it has left the barrel below over its end, and
    rotates, within DURATION."""
    scene = Scene()
    tilted = (np.sin(0.5 * TILT), 0.0, 0.0, np.cos(0.5 * TILT))
    turning = scene.add_body(body, name="roller", rotation=tilted)
    # a short rigid roller below, barrelled, so that it ends nowhere itself
    partner = surfaces.CrownedCylinder(
        radius=0.05, crown_radius=0.5, axis_point=(0.0, 0.0, -0.1 + 60e-6), axis_direction=ACROSS
    )
    barrel = scene.ground.surface(partner, name="barrel")
    scene.add(Contact(turning["rim"], barrel, friction=FRICTION, name="pair", overlap=1.0))
    carriage = scene.add_rigid_body(CARRIAGE_MASS, CARRIAGE_INERTIA, name="carriage")
    center = carriage.at(_HERE)
    axis = (0.0, np.cos(TILT), np.sin(TILT))
    slide = scene.add(joints.Prismatic(scene.ground, center, axis=ACROSS, name="slide"))
    axle = scene.add(joints.Revolute(center, turning["bore"], axis=axis, name="axle"))
    scene.add(joints.Drive(slide, signals.SmoothStep(0.0, 0.022, duration=DURATION), quantity="position"))
    scene.add(joints.Drive(axle, signals.SmoothStep(0.0, 1.0, duration=DURATION), quantity="position"))
    return scene
