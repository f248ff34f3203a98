"""A ball that bounces a thousand times on a plane, and loses nothing."""

from __future__ import annotations

import numpy as np

from warpffrf.model import laws, surfaces
from warpffrf.model.lumped_contact import LumpedContact
from warpffrf.model.scene import Scene
from warpffrf.output.result import Result
from warpffrf.study.stability.case import Case

RADIUS, MASS, G, HEIGHT = 0.01, 0.03, 9.81, 0.5e-3  # m, kg, m/s2, m above the touch
STIFFNESS = 1e8  # N/m^1.5: an impact takes 0.3 ms
FLIGHT = 2.0 * np.sqrt(2.0 * HEIGHT / G)  # s of a bounce
BOUNCES = 1000


def build() -> Scene:
    """The ball is let go above the plane."""
    scene = Scene(gravity=(0, 0, -G))
    sphere = surfaces.Sphere(radius=RADIUS, axis_point=(0, 0, 0), axis_direction=(0, 0, 1))
    plane = surfaces.Plane(origin=(0, 0, 0), outward=(0, 0, 1))
    ball = scene.add_rigid_body(
        MASS, (0.4 * MASS * RADIUS**2,) * 3, name="ball", position=(0, 0, RADIUS + HEIGHT), surfaces={"skin": sphere}
    )
    floor = scene.ground.surface(plane, name="floor")
    scene.add(LumpedContact(ball["skin"], floor, law=laws.PowerForce(STIFFNESS, 1.5), name="pair"))
    return scene


def error(_scene: Scene, result: Result) -> float:
    """Of the energy in the last tenth, over that at the start."""
    motion = result.body("ball")
    last = result.time >= 0.9 * result.time[-1]
    energy = MASS * (0.5 * motion.velocity[:, 2] ** 2 + G * (motion.position[:, 2] - RADIUS))
    free = motion.position[:, 2] > RADIUS
    return float(np.abs(energy[last & free] / (MASS * G * HEIGHT) - 1.0).max(initial=0.0))


CASE = Case(
    "1,000 bounces", "energy of a ball on a Hertz contact without damping", build, BOUNCES * FLIGHT, error, 0.05, 0.2,
    most=25000,
)  # fmt: skip
