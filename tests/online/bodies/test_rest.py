"""Equilibrium of bodies that are free to turn: what the grids leave of a torque that is zero keeps none from rest."""

from __future__ import annotations

import numpy as np
import pytest

from warpffrf.model import forces, joints, surfaces
from warpffrf.model.contact import Contact
from warpffrf.model.reduced.body import ReducedBody
from warpffrf.model.scene import Scene
from warpffrf.online import find_equilibrium

STAYS = 1e-5  # rad, before the first step shows what is free
BALANCED = 1e-8  # of the moment: what the iteration promises
LOAD, ANGLE = 200e3, 0.1  # N; rad, no multiple of half a column: the grid is not symmetric about the line of centres


def free_roller(body: ReducedBody, *, pull: float = 0.0, held: float = 0.0) -> Scene:
    """A roller that turns freely on the axle of a slide, pressed on a plane at ANGLE; pull [N]: along the axle."""
    scene = Scene(gravity=(0, 0, 0))
    radius = body.contact_surfaces["rim"].shape.radius
    up = np.array([np.sin(ANGLE), 0.0, np.cos(ANGLE)])
    floor = scene.ground.surface(surfaces.Plane(origin=(0, 0, 0), outward=tuple(up)), name="floor")
    roller = scene.add_body(body, name="roller", position=tuple(radius * up))
    slide = scene.add_rigid_body(1.0, (1e-3, 1e-3, 1e-3), name="slide", position=tuple(radius * up)).at((0, 0, 0))
    scene.add(joints.Prismatic(scene.ground, slide, axis=tuple(up), name="guide"))
    kind = joints.Cylindrical if pull else joints.Revolute
    axle = scene.add(kind(slide, roller["bore"], axis=(0, 1, 0), name="axle"))
    scene.add(forces.PointForce(slide, tuple(-LOAD * up), name="press"))
    if pull:
        scene.add(forces.PointForce(roller["bore"], (0.0, pull, 0.0), name="pull"))
    if held:
        scene.add(forces.JointSpringDamper(axle, held, name="spring"))
    scene.add(Contact(roller["rim"], floor, name="pair"))
    return scene


def test_a_roller_free_on_its_axle_is_named_and_left_where_it_is(plain_body: ReducedBody) -> None:
    rest = find_equilibrium(free_roller(plain_body))
    assert rest.status == "completed", rest.message
    up = np.array([np.sin(ANGLE), 0.0, np.cos(ANGLE)])
    assert rest.contacts["pair"].force[0] @ up == pytest.approx(LOAD, rel=1e-8)
    notes = [note for note in rest.notes if note.startswith("equilibrium:")]
    assert notes == ["equilibrium: body 'roller' is free to turn about (0, 1, 0), and left where it is"]
    assert np.abs(rest.bodies["roller"].rotation[0][:3]).max() < STAYS


def test_a_roller_held_by_a_weak_spring_needs_no_note_and_presses_alike(plain_body: ReducedBody) -> None:
    held, free = (find_equilibrium(free_roller(plain_body, held=stiffness)) for stiffness in (1e3, 0.0))
    assert held.status == "completed", held.message
    assert not any(note.startswith("equilibrium:") for note in held.notes)
    assert free.contacts["pair"].approach[0] == pytest.approx(held.contacts["pair"].approach[0], rel=1e-4)


def test_a_roller_that_is_pulled_off_is_refused(plain_body: ReducedBody) -> None:
    """A ten-thousandth of the load, along an axle on which it slides without friction: no load path, no rest."""
    history = find_equilibrium(free_roller(plain_body, pull=1e-4 * LOAD))
    assert history.status != "completed"
    assert "roller" in history.message or "reduce step" not in history.message


def test_all_that_is_free_is_left_where_it_is(plain_body: ReducedBody) -> None:
    """A roller that lies on a floor: two translations and two turns, more motions than bodies."""
    scene = Scene(gravity=(0.0, 0.0, -9.81))
    roller = scene.add_body(plain_body, name="roller", position=(0.0, 0.0, 0.05))
    floor = scene.ground.surface(surfaces.Plane(origin=(0, 0, 0), outward=(0, 0, 1)), name="floor")
    scene.add(Contact(roller["rim"], floor, name="pair"))
    rest = find_equilibrium(scene)
    assert rest.status == "completed", rest.message
    told = [note for note in rest.notes if "left where it is" in note]
    assert told == [
        f"equilibrium: body 'roller' is free to {clause}, and left where it is"
        for clause in ("slide along a plane", "turn about any line of a plane")
    ]
    assert np.abs(rest.bodies["roller"].position[0, :2]).max() < STAYS
    assert np.abs(rest.bodies["roller"].rotation[0][:3]).max() < STAYS


@pytest.mark.parametrize("length", [1.0, 1e-2, 1e-4])  # m
def test_a_bar_on_a_soft_spring_rests_whatever_its_size(length: float) -> None:
    """k theta = m g L/2 cos theta: the spring's frequency does not grow as the bar grows smaller."""
    mass, frequency = 1000.0 * length**3, 5.0  # kg, Hz
    k = (2.0 * np.pi * frequency) ** 2 * mass * length**2 / 3.0
    scene = Scene(gravity=(0, 0, -9.81))
    bar = scene.add_rigid_body(mass, (mass * length**2 / 12.0,) * 3, name="bar", position=(0.5 * length, 0, 0))
    pin = scene.add(joints.Revolute(scene.ground, bar.at((-0.5 * length, 0, 0)), axis=(0, 1, 0), name="pin"))
    scene.add(forces.TorsionalSpringDamper(pin, k, 0.0))
    rest = find_equilibrium(scene)
    assert rest.status == "completed", rest.message
    theta = rest.joints["pin"].coordinate[-1]
    assert k * theta == pytest.approx(0.5 * mass * 9.81 * length * np.cos(theta), rel=BALANCED)
