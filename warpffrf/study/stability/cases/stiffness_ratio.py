"""Two springs in series, one a million times as stiff as the other."""

from __future__ import annotations

import numpy as np

from warpffrf.model import joints
from warpffrf.model.forces import JointSpringDamper
from warpffrf.model.scene import Scene
from warpffrf.output.result import Result
from warpffrf.study.stability.case import Case

SOFT, STIFF, MASS, START = 1e3, 1e9, 1.0, 1e-3  # N/m, N/m, kg, m
RATE = np.sqrt(SOFT / (2.0 * MASS))  # rad/s of both masses together, 1e-6 above the true one
PERIOD = 2.0 * np.pi / RATE


def build() -> Scene:
    """Ground, soft spring, mass, stiff spring, mass, along x; both start a way off their rest, without speed."""
    scene = Scene()
    first = scene.add_rigid_body(MASS, (1e-3, 1e-3, 1e-3), name="first", position=(START, 0, 0))
    second = scene.add_rigid_body(MASS, (1e-3, 1e-3, 1e-3), name="second", position=(1.0 + START, 0, 0))
    guide = scene.add(joints.Prismatic(scene.ground, first.at((0, 0, 0)), axis=(1, 0, 0)))
    other = scene.add(joints.Prismatic(first.at((0, 0, 0)), second.at((-1.0, 0, 0)), axis=(1, 0, 0)))
    scene.add(JointSpringDamper(guide, SOFT, 0.0, reference=-START))
    scene.add(JointSpringDamper(other, STIFF, 0.0))
    return scene


def error(_scene: Scene, result: Result) -> float:
    """Of the place of the first mass, over the amplitude."""
    exact = START * np.cos(RATE * result.time)
    return float(np.abs(result.body("first").position[:, 0] - exact).max() / START)


CASE = Case("stiffness ratio 1e6", "two springs in series beside the slow motion", build, PERIOD, error, 0.01, 0.1)
