"""Flexible cams and followers, by the law of the cam: lift, and the force that a rigid follower would have.

The roller follower is that of the demo, at a third of its jump speed, as in the verification case
`cam_and_roller_follower`; here the cam is elastic too, and a closed curve over whose ends the patch runs.
"""

from __future__ import annotations

from functools import cache
from typing import Any

import numpy as np
import pytest

import warpffrf as wf
from demos import cam_follower as demo
from warpffrf.model.mesh import Mesh, box, roller
from warpffrf.model.surfaces import Curve, Cylinder, Extruded, Plane, cam
from warpffrf.offline import ContactGrid, reduce

FLAT_BASE, FLAT_LIFT, FLAT_SPEED = 40e-3, 3e-3, 30.0  # m, m, rad/s: of the cam below a flat follower
STEPS = 1800  # per revolution
CELLS = {"grid": ContactGrid(contact_fixed=True), "progress": False}


def face(section: Curve) -> Extruded:
    return Extruded(curve=section, axis_direction=(0, 1, 0), x_direction=(0, 0, 1))


def cam_mesh(section: Curve, bore: float = 8e-3) -> Mesh:
    """A cam with a round bore, sets `rim` and `bore`: a ring whose nodes lie evenly along the curve."""
    ring, shape = roller(1.0, 0.5, demo.WIDTH, sectors=60, layers=3, axial=2, order=2), face(section)
    x, y, z = ring.points.T
    outer = section.at(section.knots[0] + section.length * np.remainder(np.arctan2(x, z), 2.0 * np.pi) / (2.0 * np.pi))
    inner = bore * outer / np.linalg.norm(outer, axis=1, keepdims=True)
    at = inner + 2.0 * (np.hypot(x, z) - 0.5)[:, None] * (outer - inner)
    return Mesh(at @ shape.frame[:2] + np.outer(y, shape.e_a), ring.cells, ring.facet_sets, name="cam")


@cache
def bodies() -> tuple[wf.ReducedBody, wf.ReducedBody]:
    """The elastic cam, and the elastic roller of the follower."""
    section = cam(demo.law(), base_radius=demo.BASE, roller_radius=demo.ROLLER)
    ring = roller(demo.ROLLER, demo.PIN, demo.WIDTH, sectors=48, layers=4, axial=2, order=2)
    options: Any = {"interfaces": {"bore": "rigid"}, "modes": 6, **CELLS}
    return (
        reduce(cam_mesh(section), demo.STEEL, contact={"rim": face(section)}, **options),
        reduce(ring, demo.STEEL, contact={"rim": Cylinder()}, **options),
    )


def revolved(scene: wf.Scene, cam_port: Any, follower_port: Any, speed: float) -> wf.Result:
    """One revolution of the cam below the follower, pressed down by the spring of the demo."""
    shaft = scene.add(wf.joints.Revolute(scene.ground, cam_port, axis=(0, 1, 0), name="shaft"))
    scene.add(wf.joints.Drive(shaft, speed, quantity="velocity"))
    guide = scene.add(wf.joints.Prismatic(scene.ground, follower_port, axis=(0, 0, 1)))
    scene.add(wf.forces.JointSpringDamper(guide, stiffness=demo.STIFFNESS, preload=demo.PRELOAD))
    turn = 2.0 * np.pi / speed
    result = wf.simulate(
        scene, turn, step=turn / STEPS, start="equilibrium", options=wf.RunOptions(save_every=4), progress=False
    )
    assert result.status == "completed", result.message
    assert np.abs(result.energy_residual).max() < 1e-5 * result.energy_scale
    return result


@pytest.mark.slow
@pytest.mark.parametrize("first", ["roller", "cam"])
def test_an_elastic_roller_on_an_elastic_cam(first: str) -> None:
    body, ring = bodies()
    speed = demo.jump_speed(demo.MASS + ring.mass) / 3.0
    scene, top = wf.Scene(gravity=(0, 0, 0)), (0.0, 0.0, demo.BASE + demo.ROLLER)
    turning = scene.add_body(body, name="cam", angular_velocity=(0, speed, 0))
    wheel = scene.add_body(ring, name="roller", position=top)
    follower = scene.add_rigid_body(demo.MASS, np.eye(3) * 1e-4, name="follower", position=top)
    scene.add(wf.joints.Revolute(follower.at((0, 0, 0)), wheel["bore"], axis=(0, 1, 0)))
    faces = (wheel["rim"], turning["rim"]) if first == "roller" else (turning["rim"], wheel["rim"])
    scene.add(wf.Contact(*faces, grid="contact_fixed", name="contact"))
    result = revolved(scene, turning["bore"], follower.at((0, 0, 0)), speed)
    angle = speed * result.time
    height = result.body("follower").position[:, 2] - top[2]
    force = np.linalg.norm(result.contact("contact").force, axis=1)
    assert height == pytest.approx(demo.lift(angle)[0], abs=1e-3 * demo.LIFT)
    assert force == pytest.approx(demo.force(angle, speed, demo.MASS + ring.mass), rel=1e-3)


@pytest.mark.slow
def test_an_elastic_flat_follower_on_a_cam() -> None:
    """The force is m s'' + k s + F_0, and along the guide."""
    scale = FLAT_LIFT / demo.LIFT
    law = wf.signals.Polynomial(demo.law().breaks, scale * np.asarray(demo.law().coefficients))
    block = reduce(
        box((0.04, demo.WIDTH, 6e-3), (20, 4, 5), center=(0, 0, 3e-3)), demo.STEEL, interfaces={"z_max": "rigid"},
        contact={"z_min": Plane(origin=(0, 0, 0), outward=(0, 0, -1), direction=(0, 1, 0))}, modes=0, **CELLS,
    )  # fmt: skip
    scene = wf.Scene(gravity=(0, 0, 0))
    turning = scene.add_rigid_body(
        0.5, np.eye(3) * 1e-4, name="cam", surfaces={"rim": face(cam(law, base_radius=FLAT_BASE))},
        angular_velocity=(0, FLAT_SPEED, 0),
    )  # fmt: skip
    follower = scene.add_body(block, name="follower", position=(0.0, 0.0, FLAT_BASE))
    scene.add(wf.Contact(follower["z_min"], turning["rim"], grid="contact_fixed", name="contact"))
    result = revolved(scene, turning.at((0, 0, 0)), follower["z_max"], FLAT_SPEED)
    s, _, dds = (scale * part for part in demo.lift(FLAT_SPEED * result.time))
    expected = block.mass * FLAT_SPEED**2 * dds + demo.STIFFNESS * s + demo.PRELOAD
    force = result.contact("contact").force
    assert result.body("follower").position[:, 2] - FLAT_BASE == pytest.approx(s, abs=1e-3 * FLAT_LIFT)
    assert force[:, 2] == pytest.approx(expected, rel=1e-3)
    assert np.abs(force[:, :2]).max() < 1e-4 * demo.PRELOAD
