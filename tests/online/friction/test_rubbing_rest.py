"""Equilibria with friction of joints and lumped contacts: what holds below its bound, slides to where it holds, or is
no equilibrium, and runs that go on from there."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest
from scipy.optimize import brentq

import warpffrf as wf
from warpffrf.model import forces, joints, laws, surfaces
from warpffrf.model.errors import InputError
from warpffrf.model.friction import RegularisedCoulomb
from warpffrf.model.lumped_contact import LumpedContact
from warpffrf.model.material import Material
from warpffrf.model.scene import Scene

ORIGIN = (0.0, 0.0, 0.0)
STEEL = Material(210e9, 0.3, 7800.0)
COEFFICIENT = 0.3
PULL, PIN, ARM = 1000.0, 0.02, 0.1  # N, m, m
HELD = 1e-9  # rad or m: rows that stick yield by a part of what a body moves by in a proximal step
GRAVITY, MASS = 9.81, 2.0
SOLVED = 1e-8  # of a force: tolerance of an equilibrium


def lever(push: float, friction: Any = COEFFICIENT) -> Scene:
    """A bar on a pin that rubs under PULL, pushed down at its arm."""
    scene = Scene(gravity=ORIGIN)
    bar = scene.add_rigid_body(1.0, (0.01, 0.01, 0.01), name="bar")
    pin = scene.add(joints.Revolute(scene.ground.at(ORIGIN), bar.at(ORIGIN), axis=(0, 1, 0), name="pin"))
    scene.add(forces.RevoluteFriction(pin, friction, pin_radius=PIN, name="rub"))
    scene.add(forces.PointForce(bar.at((ARM, 0, 0)), (0, 0, -push)))
    scene.add(forces.PointForce(bar.at(ORIGIN), (PULL, 0, 0)))
    return scene


@pytest.mark.parametrize("push", [30.0, 59.0])
def test_a_pin_holds_a_lever_below_its_bound(push: float) -> None:
    rest = wf.equilibrium(lever(push), friction=True)
    assert rest.status == "completed", rest.history.message
    assert abs(rest.history.joints["pin"].coordinate[0]) < HELD
    assert not any("does not act" in note for note in rest.history.notes)


@pytest.mark.parametrize("push", [61.0, 80.0])
def test_a_lever_slips_to_where_the_pin_holds_it(push: float) -> None:
    """push ARM cos(angle) = mu PIN |reaction| there, on the way from where it began."""
    rest = wf.equilibrium(lever(push), friction=True)
    assert rest.status == "completed", rest.history.message
    bound = COEFFICIENT * PIN * np.hypot(PULL, push)
    angle = brentq(lambda a: push * ARM * np.cos(a) - bound, 0.0, 0.5 * np.pi, xtol=1e-14)
    assert rest.history.joints["pin"].coordinate[0] == pytest.approx(angle, rel=SOLVED)
    assert not any(np.any(rest.history.energy[line]) for line in ("force_work", "friction", "numerical"))


def test_without_being_asked_friction_does_not_act_and_a_note_says_so() -> None:
    rest = wf.equilibrium(lever(30.0))
    assert rest.history.joints["pin"].coordinate[0] == pytest.approx(0.5 * np.pi, abs=1e-6)
    assert any("'rub' does not act" in note and "friction=True" in note for note in rest.history.notes)


def block(angle: float, press: float = 0.0) -> Scene:
    """On three feet on a floor that is tilted by `angle`: gravity is. press [N]: on the floor, in addition to the
    weight."""
    down = np.array([-np.sin(angle), 0.0, -np.cos(angle)])
    scene = Scene(gravity=tuple(GRAVITY * down))
    floor = scene.ground.surface(surfaces.Plane(origin=ORIGIN, outward=(0, 0, 1)), name="floor")
    places = {"a": (0.05, 0.0), "b": (-0.05, 0.04), "c": (-0.05, -0.04)}
    feet = {
        name: surfaces.Sphere(radius=0.01, axis_point=(*at, 0.0), axis_direction=(0.0, 0.0, 1.0))
        for name, at in places.items()
    }  # fmt: skip
    body = scene.add_rigid_body(MASS, (0.01, 0.01, 0.01), name="block", position=(0.0, 0.0, 0.01), surfaces=feet)
    for name in feet:
        law = laws.HertzPoint(STEEL, STEEL)
        scene.add(LumpedContact(body[name], floor, law=law, friction=COEFFICIENT, name=name))
    scene.add(forces.PointForce(body.at(ORIGIN), (0.0, 0.0, -press)))
    return scene


@pytest.mark.parametrize("off", [-1.0, -0.1, -1e-3])
def test_a_block_rests_on_an_incline_below_the_angle_of_friction(off: float) -> None:
    """Forces of the feet balance its weight, and none is beyond its bound."""
    angle = (1.0 + off) * np.arctan(COEFFICIENT)
    rest = wf.equilibrium(block(angle), friction=True)
    assert rest.status == "completed", rest.history.message
    found = np.array([contact.force[0] for contact in rest.history.lumped_contacts.values()])
    weight = MASS * GRAVITY * np.array([np.sin(angle), 0.0, np.cos(angle)])
    np.testing.assert_allclose(found.sum(axis=0), weight, atol=SOLVED * MASS * GRAVITY)
    assert np.all(np.hypot(found[:, 0], found[:, 1]) <= COEFFICIENT * found[:, 2] * (1.0 + SOLVED))
    assert abs(rest.history.bodies["block"].position[0, 0]) < 1e-6  # feet yield by less than a micrometre


@pytest.mark.parametrize("off", [1e-3, 0.5])
def test_beyond_the_angle_it_slides_and_is_named(off: float) -> None:
    rest = wf.equilibrium(block((1.0 + off) * np.arctan(COEFFICIENT)), friction=True)
    assert rest.status == "no_equilibrium"
    assert "body 'block' does not come to rest" in rest.history.message and "mechanism" in rest.history.message


def test_without_friction_it_slides_and_the_cure_is_named() -> None:
    rest = wf.equilibrium(block(0.1))
    assert rest.status == "no_equilibrium"
    assert "is free to slide" in rest.history.message
    assert "friction of 'a', 'b', 'c' counts in equilibrium(scene, friction=True) only" in rest.history.message


@pytest.mark.slow
def test_an_elastic_block_set_down_on_a_slope_begins_at_rest() -> None:
    """Let go as it was meshed, on cells as coarse as these, it ends with the cure that helps: it stays to the bit."""
    mesh = wf.mesh.box((1.0, 0.4, 0.3), (6, 4, 3), center=(0, 0, 0.15), order=1)
    skin, load = {"z_min": wf.surfaces.Plane()}, {"z_max": "average"}
    body = wf.reduce(
        mesh,
        Material(1e9, 0.3, 1500.0),
        interfaces=load,
        contact=skin,
        modes=6,
        grid=wf.ContactGrid(tangential=True),
        progress=False,
    )
    scene = Scene(gravity=(GRAVITY * 0.5, 0, -GRAVITY * np.cos(np.pi / 6)))
    slab = scene.add_body(body, name="slab", damping=0.1)
    floor = scene.ground.surface(wf.surfaces.Plane(origin=ORIGIN, outward=(0, 0, 1)), name="floor")
    scene.add(wf.Contact(slab["z_min"], floor, friction=0.7, name="c"))
    dropped = wf.simulate(scene, 0.02, step=1e-3, progress=False)
    assert dropped.status == "energy"
    assert "start=equilibrium(scene, friction=True)" in dropped.message and "gain_limit" not in dropped.message
    rest = wf.equilibrium(scene, friction=True, progress=False)
    laid = wf.simulate(scene, 0.02, step=1e-3, start=rest, progress=False)
    assert laid.status == "completed", laid.message
    assert np.ptp(laid.body("slab").position, axis=0).max() < 1e-12


def test_pressed_it_holds_beyond_the_angle() -> None:
    assert wf.equilibrium(block(0.4, press=MASS * GRAVITY), friction=True).status == "completed"


@pytest.mark.parametrize(("call", "step"), [(wf.static, 0.5), (wf.simulate, 1e-4)])
def test_runs_go_on_with_the_friction_found(call: Any, step: float) -> None:
    """It stays where it is, in statics and in time."""
    scene = block(0.25)
    rest = wf.equilibrium(scene, friction=True)
    run = call(scene, 10.0 * step, step=step, start=rest, progress=False)
    assert run.status == "completed", run.history.message
    moved = run.history.bodies["block"].position - rest.history.bodies["block"].position[0]
    assert np.abs(moved).max() < 1e-12
    assert np.abs(run.history.energy["kinetic"]).max() < 1e-16


def test_what_has_no_friction_at_rest_is_refused() -> None:
    with pytest.raises(InputError, match="regularised friction of 'rub' holds nothing at rest"):
        wf.equilibrium(lever(1.0, RegularisedCoulomb(COEFFICIENT, slip_velocity=1e-3)), friction=True)
