"""A ball that drills on a plane: spin moment and friction power of a run against the closed form of full slip."""

from __future__ import annotations

import numpy as np
import pytest

import warpffrf as wf
from demos.ball_on_plane import (
    DOWN_ON_PLANE,
    FRICTION,
    HALF_WIDTH,
    LOAD,
    RADIUS,
    SLIDE_INERTIA,
    SLIDE_MASS,
    Size,
    reduced_ball,
)

SPEED, RISE, DURATION, STEP = 10.0, 2e-3, 0.02, 2.5e-4  # rad/s, s: turns by 0.19, full slip needs mu p0/G = 0.008
MOMENT = 0.01  # of mu p summed over cells, five in a half-width: 0.5 % is found
BALANCE = 1e-6  # relative: of records of one state


@pytest.mark.slow
def test_a_drilling_ball() -> None:
    """M_z = 3 pi/16 mu P a of Hertz's pressure in full slip, against the spin; the drive gives what friction takes."""
    scene = wf.Scene()
    ball = scene.add_body(
        reduced_ball(Size(), progress=False), name="ball", position=(0, 0, RADIUS), rotation=DOWN_ON_PLANE
    )
    plane = wf.surfaces.Plane(origin=(0, 0, 0), outward=(0, 0, 1))
    scene.add(wf.Contact(ball["patch"], scene.ground.surface(plane, name="plane"), friction=FRICTION, name="pair"))
    lift = scene.add_rigid_body(SLIDE_MASS, SLIDE_INERTIA, name="lift", position=ball["outside"].world_point())
    scene.add(wf.joints.Prismatic(scene.ground, lift.at((0, 0, 0)), axis=(0, 0, 1)))
    turn = scene.add(wf.joints.Revolute(lift.at((0, 0, 0)), ball["outside"], axis=(0, 0, 1), name="turn"))
    scene.add(wf.joints.Drive(turn, wf.signals.Ramp(0.0, SPEED, duration=RISE), quantity="velocity"))
    scene.add(wf.forces.PointForce(lift.at((0, 0, 0)), (0, 0, -LOAD)))
    integrator = wf.integrators.GeneralizedAlpha(0.0)
    result = wf.simulate(
        scene, DURATION, step=STEP, start="equilibrium", options=wf.RunOptions(integrator=integrator), progress=False
    )
    friction = result.contact("pair").friction
    assert friction.spin_velocity[-1] == pytest.approx(-SPEED, rel=BALANCE)  # outwards is down
    assert friction.spin_moment[-1] == pytest.approx(3.0 * np.pi / 16.0 * FRICTION * LOAD * HALF_WIDTH, rel=MOMENT)
    assert friction.spin_moment[-1] == pytest.approx(result.joint("turn").torque[-1, 2], rel=BALANCE)
    assert friction.power[-1] == pytest.approx(SPEED * friction.spin_moment[-1], rel=BALANCE)
    assert np.isnan(friction.t_gamma[-1]) and np.isnan(friction.spin_creepage[-1])  # it does not roll
