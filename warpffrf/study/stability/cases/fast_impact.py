"""A steel ball that hits a rigid plane at 10 m/s."""

from __future__ import annotations

import numpy as np

from warpffrf.model import laws, surfaces
from warpffrf.model.lumped_contact import LumpedContact
from warpffrf.model.scene import Scene
from warpffrf.output.result import Result
from warpffrf.study.stability.case import Case
from warpffrf.verification.closed_forms.impact import HertzImpact

RADIUS, MASS, SPEED, MODULUS = 0.01, 0.033, 10.0, 230.8e9  # m, kg, m/s, Pa: E/(1 - nu^2) of steel
IMPACT = HertzImpact(RADIUS, MODULUS, MASS, SPEED)
GAP = 1e-5  # m


def build() -> Scene:
    """The ball flies at the plane."""
    scene = Scene()
    sphere = surfaces.Sphere(radius=RADIUS, axis_point=(0, 0, 0), axis_direction=(0, 0, 1))
    plane = surfaces.Plane(origin=(0, 0, 0), outward=(0, 0, 1))
    ball = scene.add_rigid_body(
        MASS, (0.4 * MASS * RADIUS**2,) * 3, name="ball", position=(0, 0, RADIUS + GAP), velocity=(0, 0, -SPEED),
        surfaces={"skin": sphere},
    )  # fmt: skip
    floor = scene.ground.surface(plane, name="floor")
    scene.add(LumpedContact(ball["skin"], floor, law=laws.PowerForce(IMPACT.stiffness, 1.5), name="pair"))
    return scene


def error(_scene: Scene, result: Result) -> float:
    """Of the speed with which the ball leaves, over that with which it came."""
    return float(abs(result.body("ball").velocity[-1, 2] / SPEED - 1.0))


CASE = Case(
    "impact at 10 m/s", "a ball on a plane, restitution beside Hertz's impact", build,
    float(np.ceil(3.0 * IMPACT.duration / 1e-4) * 1e-4), error, 0.01, 0.05,
)  # fmt: skip
