"""Scenes of lumped contacts alone come to rest though elements spin and slide: what is free stays, and is named."""

from __future__ import annotations

import numpy as np
import pytest
from lumped_scenes import BALL, INNER, OUTER, STEEL
from lumped_scenes import Y as AXIS

from warpffrf.model import forces, joints, laws, surfaces
from warpffrf.model.bearings import BallGeometry
from warpffrf.model.lumped_contact import LumpedContact
from warpffrf.model.scene import Scene
from warpffrf.online import find_equilibrium

LOAD = 1000.0
STAYS = 1e-9  # m, rad: round-off of the torque of 1 kN turns a ball by 2e-10 rad on the way
HERTZ = laws.HertzPoint(STEEL, STEEL)


def ball_in_rings(load: tuple[float, float, float], *, ring_held: bool = False) -> Scene:
    """An inner ring on one ball in an outer one; z is the ball's direction."""
    scene = Scene()
    outer = scene.ground.surface(OUTER, name="raceway")
    ring = scene.add_rigid_body(0.3, (1e-4,) * 3, name="ring", surfaces={"raceway": INNER})
    ball = scene.add_rigid_body(0.008, (1e-7,) * 3, name="ball", position=(0, 0, 0.0325), surfaces={"skin": BALL})
    scene.add(joints.PointInPlane(scene.ground.at((0, 0, 0)), ball.at((0, 0, 0)), axis=(1, 0, 0), name="pocket"))
    hold = joints.Prismatic if ring_held else joints.Cylindrical
    axis = (0, 0, 1) if ring_held else AXIS
    if ring_held:
        scene.add(hold(scene.ground, ring.at((0, 0, 0)), axis=axis, name="guide"))
    else:
        slide = scene.add_rigid_body(0.1, (1e-5,) * 3, name="slide")
        scene.add(joints.Prismatic(scene.ground, slide.at((0, 0, 0)), axis=(0, 0, 1), name="guide"))
        scene.add(hold(slide.at((0, 0, 0)), ring.at((0, 0, 0)), axis=axis, name="axle"))
    scene.add(forces.PointForce(ring.at((0, 0, 0)), load, name="load"))
    for name, port in (("in", ring["raceway"]), ("out", outer)):
        scene.add(LumpedContact(ball["skin"], port, law=HERTZ, name=name))
    return scene


def test_a_ball_between_grooves_spins_freely_and_the_rest_is_held() -> None:
    """The bottom of a groove holds a ball and a ring along the axis, by what they climb: no note, and no drift."""
    rest = find_equilibrium(ball_in_rings((0.0, 0.0, LOAD)))
    assert rest.status == "completed", rest.message
    notes = [note for note in rest.notes if note.startswith("equilibrium:")]
    assert notes == [
        "equilibrium: body 'ring' is free to turn about (0, 1, 0), and left where it is",
        "equilibrium: body 'ball' is free to turn about any line, and left where it is",
    ]
    assert rest.lumped_contacts["out"].normal_force[0] == pytest.approx(LOAD, rel=1e-9)
    assert np.abs(rest.bodies["ball"].rotation[0][:3]).max() < STAYS
    assert np.abs(rest.bodies["ring"].position[0, :2]).max() < STAYS


def test_thrust_finds_the_flank_of_the_groove() -> None:
    """A load along what is free to first order: the ball climbs until the groove carries it, at the same angle on both
    sides."""
    rest = find_equilibrium(ball_in_rings((0.0, 100.0, LOAD)))
    assert rest.status == "completed", rest.message
    for name in ("in", "out"):
        F = rest.lumped_contacts[name].force[0]
        assert abs(F[1] / F[2]) == pytest.approx(0.1, rel=1e-6)


def test_a_ball_that_touches_nothing_is_named() -> None:
    rest = find_equilibrium(ball_in_rings((0.0, 0.0, -1e-9), ring_held=True))
    assert rest.status != "completed"
    assert "body 'ring' is free to slide along (0, 0, 1), and 1e-09 N drive it there" in rest.message


def test_what_falls_is_refused_by_name() -> None:
    """A ball next to the floor, under gravity, with a joint that leaves its fall free."""
    scene = Scene(gravity=(0.0, 0.0, -9.81))
    wall = scene.ground.surface(surfaces.Plane(origin=(0, 0, 0), outward=(1, 0, 0)), name="wall")
    ball = scene.add_rigid_body(0.01, (1e-6,) * 3, name="ball", position=(0.00635, 0, 0), surfaces={"skin": BALL})
    scene.add(forces.PointForce(ball.at((0, 0, 0)), (-10.0, 0.0, 0.0), name="push"))
    scene.add(LumpedContact(ball["skin"], wall, law=HERTZ, name="pair"))
    rest = find_equilibrium(scene)
    assert rest.status == "no_equilibrium"
    assert "body 'ball' is free to slide along" in rest.message and "a mechanism with no load path" in rest.message


@pytest.mark.parametrize(
    ("load", "free", "held"), [(5000.0, "outer", False), (500.0, "inner", False), (500.0, "outer", True)]
)
def test_a_ring_that_only_its_balls_hold_is_named(load: float, free: str, held: bool) -> None:
    """Not what moves most, the shaft or any ball, but the ring that leads nowhere; held, the bearing carries."""
    scene = Scene()
    shaft = scene.add_rigid_body(1.0, (1e-3,) * 3, name="shaft")
    inner, outer = (shaft, None) if free == "outer" else (None, shaft)
    scene.add_bearing(
        "b", BallGeometry(elements=7, ball_diameter=0.0111, pitch_diameter=0.046), inner=inner, outer=outer
    )
    plane = scene.add(joints.Planar(scene.ground, shaft.at((0, 0, 0)), axis=AXIS))
    scene.add(joints.Drive(plane, 0.0, quantity="velocity"))
    scene.add(forces.PointForce(shaft.at((0, 0, 0)), (load, 0, 0)))
    if held:
        scene.add(joints.Fixed(scene.ground, scene.body(f"b {free} ring").at((0, 0, 0))))
    rest = find_equilibrium(scene)
    assert rest.status == ("completed" if held else "no_equilibrium"), rest.message
    assert held or f"body 'b {free} ring' is supported by nothing but the elements of bearing 'b'" in rest.message
