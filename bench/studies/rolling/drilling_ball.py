"""A steel ball under a load on a rigid plane, rotated about the normal of its contact: full slip."""

from __future__ import annotations

import numpy as np

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
SPIN_MOMENT = 3.0 * np.pi / 16.0 * FRICTION * LOAD * HALF_WIDTH  # N m, of Hertz's pressure


def drilling() -> wf.Result:
    """The run: contact `pair`, joint `turn`."""
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
    return wf.simulate(
        scene, DURATION, step=STEP, start="equilibrium", options=wf.RunOptions(integrator=integrator), progress=False
    )
