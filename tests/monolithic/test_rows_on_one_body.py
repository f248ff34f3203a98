"""Rows between two interfaces of one flexible body, and pretension: both solvers agree, and the Jacobian is exact."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest
from mass_point_body import mass_point_body
from test_against_separated import TIGHT, both, check_difference, difference
from test_jacobian import check as check_jacobian

from warpffrf.model import forces, joints, signals
from warpffrf.model.scene import Scene

STEP, STEPS = 2e-4, 100
RIGHT, LEFT = "right", "left"
LOCK = 40 * STEP
HELD = 1e-11  # tolerance where a length is held: it is judged as a spring is, down to round-off of positions
FORCES_AGREE = 1e-8  # as accelerations: the pull is a multiplier


def tied(level: str = "full", stiffening: bool = False, pull: Any = None, lock_at: float | None = None) -> Scene:
    """A body that is spun on an axle, whose two interfaces are tied to each other by a joint, a spring on it and
    others."""
    scene = Scene(gravity=(0.0, 0.0, -9.81))
    body = mass_point_body(5, stiffening=stiffening)
    a = scene.add_body(body, name="a", inertia=level, stiffening=stiffening, damping=0.01)
    axle = scene.add(joints.Revolute(scene.ground, a[LEFT], axis=(0.0, 0.6, 0.8), name="axle"))
    scene.add(joints.Drive(axle, signals.SmoothStep(0.0, 15.0, duration=0.01), quantity="velocity"))
    ends = a[LEFT], a[RIGHT]
    middle = 0.5 * (ends[0].world_point() + ends[1].world_point())
    slide = scene.add(joints.PointOnLine(*ends, axis=(0.2, 0.3, 0.9), point=middle, name="slide"))
    if pull is None:
        scene.add(forces.JointSpringDamper(slide, 2e3, 1.0, preload=30.0, name="bolt"))
    else:
        scene.add(forces.Pretension(slide, pull, lock_at=lock_at, name="bolt"))
    scene.add(forces.Bushing(*ends, [3e3, 2e3, 1e3, 20.0, 30.0, 10.0], np.full(6, 0.1), point=middle + 0.02))
    scene.add(forces.SpringDamper(*ends, 1e3, 0.2, free_length=0.9 * float(np.linalg.norm(middle - ends[0].point))))
    return scene


def chain() -> Scene:
    """The same, with a second body on its end that is tied up as well, and a rigid one."""
    scene = tied()
    first = scene.body("a")
    second = scene.add_body(mass_point_body(4, seed=3), name="b", inertia="full", damping=0.02)
    scene.place(second[LEFT], onto=first[RIGHT])
    scene.add(joints.Spherical(first[RIGHT], second[LEFT], name="link"))
    middle = 0.5 * (second[LEFT].world_point() + second[RIGHT].world_point())
    scene.add(joints.Universal(second[LEFT], second[RIGHT], axis=(1, 0, 0), second_axis=(0, 1, 0), point=middle))
    end = scene.add_rigid_body(0.2, (1e-3, 1e-3, 2e-3), name="end", position=second[RIGHT].world_point())
    scene.add(joints.Fixed(second[RIGHT], end.at((0, 0, 0)), name="end"))
    return scene


CASES = {
    "chain": chain(),
    "constant": tied("constant"),
    "full": tied("full"),
    "stiffened": tied("full", stiffening=True),
    "pulled": tied(pull=signals.SmoothStep(0.0, 20.0, duration=0.01)),
    "held": tied(pull=20.0, lock_at=0.0),
    "held in motion": tied(pull=20.0, lock_at=LOCK),
}


@pytest.mark.slow
@pytest.mark.parametrize("name", CASES)
def test_both_solvers_agree(name: str) -> None:
    a, b = both(CASES[name], STEPS * STEP, STEP, tolerance=HELD if "held" in name else TIGHT)
    check_difference(difference(a, b))
    for bolt, row in b.tensions.items():
        pull = a.forces[bolt].force
        assert np.abs(pull - row[:, 1:4]).max() < FORCES_AGREE * np.abs(pull).max()
        assert np.abs(a.forces[bolt].deformation[:, 0] - row[:, 0]).max() < 1e-12


@pytest.mark.parametrize("name", CASES)
def test_jacobian(name: str) -> None:
    check_jacobian(CASES[name])
