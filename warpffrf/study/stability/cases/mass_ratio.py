"""A pendulum of a gram that carries one of a tonne below it."""

from __future__ import annotations

import numpy as np
import scipy.linalg

from warpffrf.model import joints
from warpffrf.model.scene import Scene
from warpffrf.output.result import Result
from warpffrf.study.stability.case import Case

LIGHT, HEAVY, ARM, G, START = 1e-3, 1e3, 0.5, 9.81, 1e-3  # kg, kg, m, m/s2, rad
SIZE = 1e-4  # m2: moments of inertia over the masses


def build() -> Scene:
    """Both hang in a line that is turned a little about the pivot."""
    scene = Scene(gravity=(0, 0, -G))
    upper = np.array([np.sin(START), 0.0, -np.cos(START)]) * ARM
    light = scene.add_rigid_body(LIGHT, (LIGHT * SIZE,) * 3, name="light", position=upper)
    heavy = scene.add_rigid_body(HEAVY, (HEAVY * SIZE,) * 3, name="heavy", position=2.0 * upper)
    scene.add(joints.Revolute(scene.ground, light.at(-upper), axis=(0, 1, 0), name="pivot"))
    scene.add(joints.Revolute(light.at((0, 0, 0)), heavy.at(-upper), axis=(0, 1, 0), name="hinge"))
    return scene


def error(_scene: Scene, result: Result) -> float:
    """Of the place of the heavy one beside small vibrations of both, over its amplitude."""
    M = ARM**2 * np.array([[LIGHT + HEAVY, HEAVY], [HEAVY, HEAVY]])
    M += SIZE * np.diag([LIGHT, HEAVY])
    K = G * ARM * np.diag([LIGHT + HEAVY, HEAVY])
    square, shapes = scipy.linalg.eigh(K, M)
    parts = shapes * np.linalg.solve(shapes, np.full(2, START))
    angles = parts @ np.cos(np.sqrt(square)[:, None] * result.time)
    x = result.body("heavy").position[:, 0]
    return float(np.abs(x - ARM * angles.sum(axis=0)).max() / np.abs(x).max())


CASE = Case("mass ratio 1e6", "a heavy pendulum on a light one beside small vibrations", build, 1.0, error, 0.01, 0.1)
