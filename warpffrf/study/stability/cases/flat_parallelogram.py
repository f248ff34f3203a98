"""A parallelogram that is turned through its flat pose, where it could go on as an antiparallelogram."""

from __future__ import annotations

import numpy as np

from warpffrf.model import joints, signals
from warpffrf.model.scene import Scene
from warpffrf.output.result import Result
from warpffrf.study.stability.case import Case

CRANK, COUPLER, SPEED = 0.1, 0.3, 2.0 * np.pi  # m, m, rad/s
INERTIA = (1e-3, 1e-3, 1e-3)  # kg m2
Y = (0, 1, 0)


def build() -> Scene:
    """Two equal cranks and a coupler; the first crank is driven, from upright, a whole turn: two flat poses."""
    return linkage(())


def linkage(between: tuple[float, ...]) -> Scene:
    """The parallelogram, with further cranks at parts `between` of the coupler: none of them changes its motion."""
    scene, up = Scene(), np.array([0.0, 0.0, CRANK])
    turn = (0.0, SPEED, 0.0)
    coupler = scene.add_rigid_body(1.0, INERTIA, name="coupler", position=up, velocity=(SPEED * CRANK, 0, 0))
    for number, part in enumerate((0.0, 1.0, *between)):
        foot = np.array([part * COUPLER, 0.0, 0.0])
        crank = scene.add_rigid_body(0.2, INERTIA, name=f"crank {number}", position=foot, angular_velocity=turn)
        pivot = scene.add(joints.Revolute(scene.ground, crank.at((0, 0, 0)), axis=Y, name=f"pivot {number}"))
        scene.add(joints.Revolute(crank.at(up), coupler.at(foot), axis=Y, name=f"hinge {number}"))
        if number == 0:
            scene.add(joints.Drive(pivot, signals.Constant(SPEED), quantity="velocity"))
    return scene


def error(_scene: Scene, result: Result) -> float:
    """Of the place of the coupler, which moves on a circle and does not turn, over the length of a crank."""
    angle = SPEED * result.time
    exact = CRANK * np.stack([np.sin(angle), np.zeros_like(angle), np.cos(angle)], axis=1)
    coupler = result.body("coupler")
    place = np.linalg.norm(coupler.position - exact, axis=1).max() / CRANK
    turned = 2.0 * np.abs(coupler.rotation[:, 1]).max() * COUPLER / CRANK
    return float(max(place, turned))


CASE = Case("flat parallelogram", "a driven parallelogram through its two flat poses", build, 1.0, error, 1e-3, 1e-2)
