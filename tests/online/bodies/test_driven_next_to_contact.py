"""What is free next to a large contact force: a load that drives it is no slope, however small it is compared with that
force, and a slope that is held is named with the force or torque on it."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest

from warpffrf.model import forces, joints, surfaces
from warpffrf.model.bodies import Body
from warpffrf.model.contact import Contact
from warpffrf.model.reduced.body import ReducedBody
from warpffrf.model.scene import Scene
from warpffrf.online import find_equilibrium

RADIUS, SMALL = 0.05, 0.02  # m, of the flexible roller and the rigid one
LOAD = 60e3  # N
ARM, BOB = 0.1, 0.05  # m, kg
PULLED = 1e-8  # of the largest force: less than that is next to nothing
SLOPE = 5e-7
LEVER = 0.2  # m


def wheel_on_cam(body: ReducedBody, *, slope: float = 0.0) -> tuple[Scene, Body]:
    """A rigid wheel over a flexible roller that is held, pressed down by LOAD; slope: of its axis."""
    scene = Scene(gravity=(0, 0, 0))
    cam = scene.add_body(body, name="cam")
    scene.add(joints.Fixed(scene.ground, cam["bore"], name="hold"))
    tread = surfaces.Cylinder(radius=SMALL, axis_point=(0, 0, 0), axis_direction=(0, 1, 0))
    place: dict[str, Any] = {"position": (0, 0, RADIUS + SMALL), "rotation": (0.5 * slope, 0, 0, 1)}
    wheel = scene.add_rigid_body(1.0, (1.0,) * 3, name="wheel", surfaces={"tread": tread}, **place)
    scene.add(forces.PointForce(wheel.at((0, 0, 0)), (0, 0, -LOAD), name="press"))
    scene.add(Contact(cam["rim"], wheel["tread"], name="nose"))
    return scene, wheel


def guided(body: ReducedBody) -> Scene:
    scene, wheel = wheel_on_cam(body)
    scene.add(joints.Prismatic(scene.ground, wheel.at((0, 0, 0)), axis=(0, 0, 1), name="guide"))
    return scene


@pytest.mark.parametrize("inertia", [1e-5, 1e-2])  # it slides, or it turns
def test_a_pendulum_next_to_a_pair_hangs_down(plain_body: ReducedBody, inertia: float) -> None:
    """Its weight of 0.5 N is 8e-6 of the load. It hangs down as far as what is next to nothing still drives it."""
    scene, tilt = guided(plain_body), np.radians(17.0)
    pin = np.array([0.3, 0.0, 0.0])
    down = ARM * np.array([np.sin(tilt), 0.0, -np.cos(tilt)])
    bob = scene.add_rigid_body(BOB, (inertia,) * 3, name="bob", position=pin + down)
    scene.add(joints.Revolute(scene.ground.at(pin), bob.at(-down), axis=(0, 1, 0), name="pin"))
    scene.gravity = np.array([0.0, 0.0, -9.81])
    rest = find_equilibrium(scene)
    assert rest.status == "completed", rest.message
    gyration = np.sqrt(ARM**2 + inertia / BOB)  # about the pin
    lean = (rest.bodies["bob"].position[0, 0] - pin[0]) / ARM
    assert abs(lean) < 2.0 * PULLED * LOAD * gyration / (BOB * 9.81 * ARM)
    assert not any("drive" in note for note in rest.notes)


def test_a_load_on_what_a_slide_guides_finds_no_equilibrium(plain_body: ReducedBody) -> None:
    """0.1 N compared with 60 kN, and the slider as free as before."""
    scene = guided(plain_body)
    slider = scene.add_rigid_body(BOB, (1e-5,) * 3, name="slider", position=(0.3, 0, 0))
    scene.add(joints.Prismatic(scene.ground, slider.at((0, 0, 0)), axis=(1, 0, 0), name="way"))
    scene.add(forces.PointForce(slider.at((0, 0, 0)), (0.1, 0, 0), name="push"))
    rest = find_equilibrium(scene)
    assert rest.status == "no_equilibrium"
    assert "body 'slider' is free to slide along (1, 0, 0), and 0.1 N drive it there" in rest.message


@pytest.mark.parametrize(
    ("lever", "told", "drive"),
    [
        (0.0, "slide along (0, 1, 0)", f"{LOAD * SLOPE:.2g} N"),
        (LEVER, "turn about (0, 0, 1)", f"{LOAD * SLOPE * LEVER:.2g} N m"),
    ],
)
def test_a_wheel_on_a_slope_stays_and_is_named(plain_body: ReducedBody, lever: float, told: str, drive: str) -> None:
    """Its axis leans against the carriage that it slides on, or turns about at a lever: LOAD drives it by SLOPE."""
    scene, wheel = wheel_on_cam(plain_body, slope=SLOPE)
    carriage = scene.add_rigid_body(1.0, (1e-3,) * 3, name="carriage", position=(-lever, 0, RADIUS + SMALL))
    scene.add(joints.Prismatic(scene.ground, carriage.at((0, 0, 0)), axis=(0, 0, 1), name="guide"))
    hold, axis = (joints.Revolute, (0, 0, 1)) if lever else (joints.Prismatic, (0, 1, 0))
    scene.add(hold(carriage.at((0, 0, 0)), wheel.at((-lever, 0, 0)), axis=axis, name="free"))
    rest = find_equilibrium(scene)
    assert rest.status == "completed", rest.message
    assert any(f"'wheel' is free to {told}, and left where it is, although {drive} drive" in n for n in rest.notes)


def test_a_push_along_a_slope_finds_no_equilibrium(plain_body: ReducedBody) -> None:
    """Though it is less than what FREE lets a slope drive with: 0.1 N along the axis of the wheel that bears 60 kN."""
    scene, wheel = wheel_on_cam(plain_body, slope=SLOPE)
    carriage = scene.add_rigid_body(1.0, (1e-3,) * 3, name="carriage", position=(0, 0, RADIUS + SMALL))
    scene.add(joints.Prismatic(scene.ground, carriage.at((0, 0, 0)), axis=(0, 0, 1), name="guide"))
    slide = scene.add_rigid_body(1.0, (1e-3,) * 3, name="slide", position=(0, 0, RADIUS + SMALL))
    scene.add(joints.Prismatic(carriage.at((0, 0, 0)), slide.at((0, 0, 0)), axis=(0, 1, 0), name="free"))
    scene.add(joints.Fixed(slide.at((0, 0, 0)), wheel.at((0, 0, 0)), name="stiff"))
    scene.add(forces.PointForce(slide.at((0, 0, 0)), (0, 0.1, 0), name="push"))
    rest = find_equilibrium(scene)
    assert rest.status == "no_equilibrium", rest.notes
    assert "is free to slide along (0, 1, 0)" in rest.message
