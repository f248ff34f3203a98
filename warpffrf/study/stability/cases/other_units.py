"""The same machine in SI and in mm, N and t."""

from __future__ import annotations

import numpy as np

from warpffrf.model import joints
from warpffrf.model.forces import JointSpringDamper, PointForce
from warpffrf.model.scene import Scene
from warpffrf.output.result import Result
from warpffrf.output.simulate import simulate
from warpffrf.study.stability.case import Case

MILLIMETRE, TONNE = 1e3, 1e-3  # of lengths and masses; forces stay N, times s
DURATION = 0.2


def build() -> Scene:
    """In SI."""
    return crank(1.0, 1.0)


def crank(length: float, mass: float) -> Scene:
    """A crank on a spring that a force turns, with units of `length` and `mass`."""
    scene = Scene()
    J = 0.02 * mass * length**2
    body = scene.add_rigid_body(2.0 * mass, (J, J, J), name="crank", position=(0.2 * length, 0, 0))
    pivot = scene.add(joints.Revolute(scene.ground, body.at((-0.2 * length, 0, 0)), axis=(0, 1, 0)))
    scene.add(JointSpringDamper(pivot, 50.0 * length, 0.1 * length))
    scene.add(PointForce(body.at((0, 0, 0)), force=(0, 0, 20.0)))
    return scene


def error(_scene: Scene, result: Result) -> float:
    """Largest difference of the places, made metres, over the largest way."""
    step = float(result.time[1] - result.time[0])
    other = simulate(crank(MILLIMETRE, TONNE), float(result.time[-1]), step=step, progress=False)
    x, y = result.body("crank").position, other.body("crank").position / MILLIMETRE
    return float(np.abs(x - y).max() / np.ptp(x, axis=0).max())


CASE = Case("mm-N-t beside SI", "one machine in two systems of units", build, DURATION, error, 1e-6, 1e-4)
