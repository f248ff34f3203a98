"""Equilibria that need no help: followers on free pins, large deflections, snap-through, a pendulum from anywhere."""

from __future__ import annotations

import functools

import numpy as np
import pytest

from warpffrf.model import forces, joints, surfaces
from warpffrf.model.material import Material
from warpffrf.model.mesh import Mesh, box, roller
from warpffrf.model.reduced.body import ReducedBody
from warpffrf.model.scene import Scene
from warpffrf.offline import ReductionOptions, reduce
from warpffrf.online.history.history import History
from warpffrf.online.history.interface_motion import point_motion
from warpffrf.online.run import find_equilibrium

STEEL = Material(210e9, 0.3, 7850.0)
ACROSS = (0.0, 1.0, 0.0)

CAM, FOLLOWER, OFF = 0.030, 0.012, 0.008  # m: radii, and how far the follower moves off the cam's centre


@functools.cache
def cam_body() -> ReducedBody:
    mesh = roller(CAM, 0.010, 0.015, half_width=150e-6, order=1, axial=4)
    return reduce(
        mesh, STEEL, interfaces={"bore": "rigid"}, contact={"rim": surfaces.Cylinder()}, max_frequency=20e3,
        progress=False,
    )  # fmt: skip


def cam_scene(load: float) -> Scene:
    """An eccentric disc on a rigid shaft; a slide next to its centre carries a roller on a free pin, a spring
    presses."""
    from warpffrf.model.contact import Contact

    scene = Scene(gravity=(0, 0, 0))
    height = float(np.sqrt((CAM + FOLLOWER) ** 2 - OFF**2))
    disc = scene.add_body(cam_body(), name="cam", position=(OFF, 0.0, 0.0))
    shaft = scene.add_rigid_body(0.1, (1e-4, 1e-4, 1e-4), name="shaft")
    scene.add(joints.Fixed(shaft.at((OFF, 0.0, 0.0)), disc["bore"], name="key"))
    scene.add(joints.Fixed(scene.ground, shaft.at((0.0, 0.0, 0.0)), name="hold"))
    shape = surfaces.Cylinder(radius=FOLLOWER, axis_point=(0, 0, 0), axis_direction=ACROSS)
    wheel = scene.add_rigid_body(
        0.05, (1e-5, 1e-5, 1e-5), name="wheel", position=(0, 0, height), surfaces={"tread": shape}
    )
    slide = scene.add_rigid_body(0.2, (1e-4, 1e-4, 1e-4), name="slide", position=(0, 0, height))
    scene.add(joints.Revolute(slide.at((0, 0, 0)), wheel.at((0, 0, 0)), axis=ACROSS, name="pin"))
    guide = scene.add(joints.Prismatic(scene.ground, slide.at((0, 0, 0)), axis=(0, 0, 1), name="guide"))
    scene.add(forces.JointSpringDamper(guide, stiffness=1e3, preload=load, name="spring"))
    scene.add(Contact(disc["rim"], wheel["tread"], name="nose"))
    return scene


@pytest.mark.parametrize("load", [1.0, 100.0, 1500.0, 10e3])
def test_a_follower_on_a_free_pin(load: float) -> None:
    """The force runs along the line of centres, and the pin is named and left where it is."""
    rest = find_equilibrium(cam_scene(load))
    assert rest.status == "completed", rest.message
    wheel, disc = rest.bodies["wheel"], rest.bodies["cam"]
    force = rest.contacts["nose"].force[0]
    line = disc.position[0] - wheel.position[0]  # the disc's frame stays at its axis to the tolerance of the joints
    line = line / np.linalg.norm(line)
    assert np.linalg.norm(np.cross(force, line)) < 1e-9 * np.linalg.norm(force)
    lift = wheel.position[0][2] - np.sqrt((CAM + FOLLOWER) ** 2 - OFF**2)
    assert force @ (0.0, 0.0, -1.0) == pytest.approx(load + 1e3 * lift, rel=1e-9)
    assert [note for note in rest.notes if note.startswith("equilibrium:")] == [
        "equilibrium: body 'wheel' is free to turn about (0, 1, 0), and left where it is"
    ]
    assert np.abs(wheel.rotation[0][:3]).max() < 1e-9


LENGTH, THICK, WIDE = 1.0, 0.01, 0.02  # m
BENDING = 210e9 * WIDE * THICK**3 / 12.0
# w/L and u/L of the tip under P L^2/(E I) (Bisshopp and Drucker 1945)
ELASTICA = {1.0: (0.301721, 0.056433), 2.0: (0.493457, 0.160642), 4.0: (0.669964, 0.328941)}


@functools.cache
def beam_body(parts: int) -> ReducedBody:
    mesh = box((WIDE, LENGTH / parts, THICK), (2, max(48 // parts, 4), 2), order=2)
    return reduce(
        mesh, Material(210e9, 0.0, 7850.0), interfaces={"y_min": "rigid", "y_max": "rigid"}, modes=24,
        options=ReductionOptions(stiffening=True), progress=False,
    )  # fmt: skip


@pytest.mark.parametrize("parts", [1, 4])
@pytest.mark.parametrize("number", list(ELASTICA))
def test_a_cantilever_that_bends_far(number: float, parts: int) -> None:
    scene = Scene(gravity=(0, 0, 0))
    before = scene.ground
    for i in range(parts):
        beam = scene.add_body(
            beam_body(parts), name=f"b{i}", position=(0, (i + 0.5) * LENGTH / parts, 0), stiffening=True,
            inertia="constant",
        )  # fmt: skip
        scene.add(joints.Fixed(before, beam["y_min"], name=f"j{i}"))
        before = beam["y_max"]
    scene.add(forces.PointForce(before, (0, 0, -number * BENDING / LENGTH**2), name="tip"))
    rest = find_equilibrium(scene)
    assert rest.status == "completed", rest.message
    moved = tip_motion(rest, scene) / LENGTH
    down, back = ELASTICA[number]
    # second order in what one body's interfaces turn from its axes; of four bodies in a row each turns little
    allowed = {1: {1.0: 6e-3, 2.0: 2e-2, 4.0: 6e-2}[number], 4: 1e-3}[parts]
    assert -moved[2] == pytest.approx(down, rel=allowed)
    if parts == 4:
        assert -moved[1] == pytest.approx(back, rel=1e-2)


def tip_motion(rest: History, scene: Scene) -> np.ndarray:
    """Displacement [m] of the interface at the end of the last body, with its motion of second order."""
    end = scene.bodies[-1]["y_max"]
    return point_motion(end, end.point, rest.bodies, 1)[0][0] - end.body.to_world(end.point)


@functools.cache
def arch_body() -> ReducedBody:
    """Clamped, a parabola of rise 2.5 thicknesses."""
    flat = box((WIDE, LENGTH, THICK), (2, 48, 2), order=2)
    points = flat.points.copy()
    points[:, 2] += 2.5 * THICK * (1.0 - (2.0 * points[:, 1] / LENGTH) ** 2)
    mesh = Mesh(points, flat.cells, flat.facet_sets).select("top", "z_max", lambda x: np.abs(x[:, 1]) < 0.03)
    interfaces = {"y_min": "rigid", "y_max": "rigid", "top": "average"}
    return reduce(
        mesh, Material(210e9, 0.0, 7850.0), interfaces=interfaces, modes=24, options=ReductionOptions(stiffening=True),
        progress=False
    )  # fmt: skip


LIMIT = 7.17 * 64.0 * BENDING * THICK / LENGTH**3  # N, of this arch: bisected by equilibria


def test_an_arch_on_both_sides_of_its_limit_load() -> None:
    """It carries more and more until it snaps: beyond, it hangs below its clamps, and at rest all the
    same."""
    down = {}
    for share in (0.5, 0.9, 0.99, 1.03, 1.5):
        scene = Scene(gravity=(0, 0, 0))
        arch = scene.add_body(arch_body(), name="arch", stiffening=True, inertia="constant")
        for end in ("y_min", "y_max"):
            scene.add(joints.Fixed(scene.ground, arch[end], name=end))
        load = share * LIMIT
        scene.add(forces.PointForce(arch["top"], (0, 0, -load), name="press"))
        rest = find_equilibrium(scene)
        assert rest.status == "completed", rest.message
        interface, q = arch_body().interfaces["top"], rest.bodies["arch"].modal[0]
        motion = rest.bodies["arch"].position[0] + q @ interface.modes[:, :3]
        down[share] = -float(motion[2])
    assert 0.0 < down[0.5] < down[0.9] < down[0.99] < 1.2 * THICK
    assert down[1.03] > 2.5 * THICK + THICK and down[1.5] > down[1.03]


@pytest.mark.parametrize("degrees", [30.0, 89.9, 120.0, 179.0])
def test_a_pendulum_comes_to_hang(degrees: float) -> None:
    """Newton's method alone would go to the upright one from above the hinge."""
    arm, angle = 0.5, np.radians(degrees)
    scene = Scene(gravity=(0, 0, -9.81))
    place = arm * np.array([np.sin(angle), 0.0, -np.cos(angle)])
    bob = scene.add_rigid_body(2.0, (0.01, 0.01, 0.01), name="bob", position=place)
    scene.add(joints.Revolute(scene.ground, bob.at((0, 0, 0)), axis=ACROSS, point=(0, 0, 0), name="hinge"))
    rest = find_equilibrium(scene)
    assert rest.status == "completed", rest.message
    assert rest.bodies["bob"].position[0] == pytest.approx([0.0, 0.0, -arm], abs=1e-9)
