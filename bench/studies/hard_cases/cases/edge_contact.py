"""A roller tilted by 5 mrad, whose end alone touches the plate below, pressed and let swing.

Momentum is all that is needed: the plate pushes along its normal; once the swing is over it carries the load, and the
guide the moment of the force about the bore.
"""

from __future__ import annotations

from functools import lru_cache

import numpy as np

from scenes.rollers import roller_body
from studies.hard_cases.case import Case, Finding
from warpffrf.model import forces, joints, surfaces
from warpffrf.model.contact import Contact
from warpffrf.model.reduced.body import ReducedBody
from warpffrf.model.scene import Scene
from warpffrf.output.result import Result

TILT, LOAD, DAMPING = 5e-3, 2e3, 2e3  # rad, N, N s/m
SETTLED = 0.05  # s


@lru_cache
def _body() -> ReducedBody:
    return roller_body(180, layers=4, axial=10, grading=1.6, order=1, modes=4)


def build() -> Scene:
    """The roller on a guide that damps it."""
    scene = Scene()
    body = _body()
    tilted = (np.sin(0.5 * TILT), 0.0, 0.0, np.cos(0.5 * TILT))
    roller = scene.add_body(body, name="roller", position=(0.0, 0.0, 0.06), rotation=tilted)
    plate = scene.ground.surface(surfaces.Plane(origin=(0, 0, 0), outward=(0, 0, 1)), name="plate")
    contact = scene.add(Contact(roller["rim"], plate, name="pair"))
    scene.close_gap(contact, along=(0.0, 0.0, -1.0))
    guide = scene.add(joints.Prismatic(scene.ground, roller["bore"], axis=(0, 0, 1), name="guide"))
    scene.add(forces.JointSpringDamper(guide, stiffness=0.0, damping=DAMPING, name="damper"))
    scene.add(forces.PointForce(roller["bore"], (0.0, 0.0, -LOAD), name="load"))
    return scene


def check(result: Result) -> list[Finding]:
    """Direction of the force at all times; force and moments once the swing is over."""
    pair, t = result.history.contacts["pair"], result.time
    found = [Finding("force along the plate", float(np.abs(pair.force[:, :2]).max()) / LOAD, 1e-2, 5e-2)]
    if t[-1] > SETTLED:
        late = t > 0.9 * t[-1]
        mean = float(pair.force[late, 2].mean())
        found.append(Finding("force at rest", abs(mean / LOAD - 1.0), 1e-3, 1e-2))
        moment = pair.torque[late].mean(axis=0) + result.joint("guide").torque[late].mean(axis=0)
        found.append(Finding("moment at rest", float(np.abs(moment).max()) / (abs(mean) * 0.01), 1e-3, 1e-2))
    return found


CASE = Case(
    "edge contact",
    "A roller tilted by 5 mrad is dropped by its load on the plate: its end alone touches.",
    build, 0.06, check, most_steps=2000,
)  # fmt: skip
