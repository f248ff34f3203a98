"""`close_gap` moves with a body what joints take along."""

from __future__ import annotations

import numpy as np
import pytest

from warpffrf.model import joints
from warpffrf.model.contact import Contact
from warpffrf.model.errors import InputError
from warpffrf.model.placement.gap import smallest_gap
from warpffrf.model.scene import Scene

Z = (0.0, 0.0, 1.0)
UP = 0.3


def machine(body_maker, guide: type = joints.Prismatic) -> tuple[Scene, Contact]:
    """A cam below a roller on a pin of a slider, which a `guide` along z holds in a frame."""
    scene = Scene()
    cam = scene.add_body(body_maker(), name="cam")
    roller = scene.add_body(body_maker(), name="roller", position=(0.0, 0.0, UP))
    slider = scene.add_rigid_body(1.0, (1, 1, 1), name="slider", position=(0.0, 0.0, UP))
    frame = scene.add_rigid_body(1.0, (1, 1, 1), name="frame", position=(0.0, 0.0, UP))
    pin = (0.0, 0.001, UP)  # where the bore of the made-up body is
    scene.add(joints.Revolute(roller["bore"], slider.at((0.0, 0.001, 0.0)), axis=(0, 1, 0), name="pin"))
    scene.add(guide(slider.at((0.0, 0.0, 0.1)), frame.at((0.0, 0.0, 0.1)), axis=Z, point=(0.0, 0.0, 0.4), name="guide"))
    scene.add(joints.Fixed(frame.at((0, 0, 0)), scene.ground, point=pin, name="foot"))
    return scene, scene.add(Contact(cam["rim"], roller["rim"]))


def heights(scene: Scene) -> dict[str, float]:
    return {body.name: float(body.position[2]) for body in scene.bodies}


def test_a_follower_moves_with_its_roller_and_not_its_guide(body_maker) -> None:
    scene, contact = machine(body_maker)
    moved = scene.close_gap(contact)
    assert smallest_gap(contact)[0] == pytest.approx(0.0, abs=1e-9)
    at = heights(scene)
    assert at["roller"] == at["slider"] == pytest.approx(UP + moved)
    assert at["frame"] == UP and at["cam"] == 0.0
    scene.check()  # the pin is still in its bore


def test_joints_that_hold_take_everything_along(body_maker) -> None:
    scene, contact = machine(body_maker, guide=joints.Fixed)
    moved = scene.close_gap(contact)
    assert [heights(scene)[name] for name in ("roller", "slider", "frame")] == pytest.approx(3 * [UP + moved])
    guide, foot = (scene.joint(name).world_point() for name in ("guide", "foot"))
    np.testing.assert_allclose(guide, (0.0, 0.0, 0.4 + moved))  # with both of its bodies
    np.testing.assert_allclose(foot, (0.0, 0.001, UP))  # the ground stays


def test_bodies_that_are_named(body_maker) -> None:
    scene, contact = machine(body_maker)
    moved = scene.close_gap(contact, with_bodies=[scene.body("frame")])
    at = heights(scene)
    assert at["roller"] == at["frame"] == pytest.approx(UP + moved) and at["slider"] == UP
    scene, contact = machine(body_maker)
    scene.close_gap(contact, with_bodies=())
    assert heights(scene)["slider"] == UP
    with pytest.raises(InputError, match="'pin': its ports .* apart"):
        scene.check()


def test_a_chain_that_leads_to_the_other_body_stays(body_maker) -> None:
    scene, contact = machine(body_maker)
    link = joints.Fixed(scene.body("slider").at((0, 0, 0)), scene.body("cam")["bore"], point=(0, 0, UP), name="link")
    scene.add(link)
    scene.close_gap(contact)
    assert heights(scene)["slider"] == UP and heights(scene)["roller"] < UP


def test_bodies_that_cannot_move(body_maker) -> None:
    scene, contact = machine(body_maker)
    with pytest.raises(InputError, match="moving both bodies.*leave 'cam' out"):
        scene.close_gap(contact, with_bodies=[scene.body("cam")])
    with pytest.raises(InputError, match="bodies of this scene.*'cam', 'roller', 'slider', 'frame'; got 'slider'"):
        scene.close_gap(contact, with_bodies="slider")  # pyright: ignore[reportArgumentType]
