"""A body that slides to rest under a friction coefficient from 0 to 10."""

from __future__ import annotations

import numpy as np

from warpffrf.model import joints
from warpffrf.model.forces import PrismaticFriction
from warpffrf.model.scene import Scene
from warpffrf.output.result import Result
from warpffrf.study.stability.case import Case

COEFFICIENTS = (0.0, 1e-3, 0.1, 1.0, 10.0)
G, SPEED, DURATION = 9.81, 1.0, 0.2  # m/s2, m/s, s


def build() -> Scene:
    """One slide for each coefficient, side by side, under gravity."""
    scene = Scene(gravity=(0, 0, -G))
    for number, coefficient in enumerate(COEFFICIENTS):
        block = scene.add_rigid_body(
            1.0, (1e-2, 1e-2, 1e-2), name=f"block {number}", position=(0, number, 0), velocity=(SPEED, 0, 0)
        )
        slide = scene.add(joints.Prismatic(scene.ground, block.at((0, 0, 0)), axis=(1, 0, 0)))
        if coefficient:
            scene.add(PrismaticFriction(slide, coefficient))
    return scene


def error(_scene: Scene, result: Result) -> float:
    """Of the way of each, v t - mu g t^2/2 up to rest, over the way without friction."""
    worst = 0.0
    for number, coefficient in enumerate(COEFFICIENTS):
        t = np.minimum(result.time, SPEED / (coefficient * G)) if coefficient else result.time
        exact = SPEED * t - 0.5 * coefficient * G * t**2
        worst = max(worst, float(np.abs(result.body(f"block {number}").position[:, 0] - exact).max()))
    return worst / (SPEED * DURATION)


CASE = Case("friction 0 to 10", "five slides to rest, the way beside Coulomb's", build, DURATION, error, 0.01, 0.05)
