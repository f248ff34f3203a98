"""Equilibria with friction of contact surfaces: what it holds, what slides, and runs that go on from there."""

from __future__ import annotations

import functools
from typing import Any

import numpy as np
import pytest

import warpffrf as wf
from scenes.rollers import roller_body
from warpffrf.model import forces, joints, surfaces
from warpffrf.model.contact import Contact
from warpffrf.model.scene import Scene
from warpffrf.model.signals import Table

ORIGIN = (0.0, 0.0, 0.0)
RADIUS, FRICTION, PRESS, GRAVITY = 0.05, 0.3, 3e4, 9.81  # m, -, N, m/s2
SOLVED = 1e-8  # of the largest force: ten times what Newton's method leaves, as what holds falls below it at last
STAYS = 1e-9  # m: a run in time comes to rest anew, to its own tolerance; penetrations are 1e-5


@functools.cache
def rim(grid: Any) -> Any:
    return roller_body(
        120,
        layers=4,
        axial=3,
        grading=1.6,
        order=1,
        max_frequency=15e3,
        tangential=True,
        contact_fixed=grid == "contact_fixed",
    )


def on_floor(force: Any, *, gravity: Any = ORIGIN, grid: Any = "body_fixed", spring: float = 0.0) -> tuple[Scene, Any]:
    """A roller on a plane, its bore on an axle in a cart on guides along z and x; and the axle. force: on the cart."""
    scene = Scene(gravity=gravity)
    floor = scene.ground.surface(surfaces.Plane(origin=(0, 0, -RADIUS), outward=(0, 0, 1)), name="floor")
    roller = scene.add_body(rim(grid), name="roller")
    place = roller["bore"].world_point()
    slide, cart = (
        scene.add_rigid_body(1.0, (1e-3, 1e-3, 1e-3), name=name, position=place) for name in ("slide", "cart")
    )
    scene.add(joints.Prismatic(scene.ground.at(place), slide.at(ORIGIN), axis=(0, 0, 1), name="lift"))
    way = scene.add(joints.Prismatic(slide.at(ORIGIN), cart.at(ORIGIN), axis=(1, 0, 0), name="way"))
    axle = scene.add(joints.Revolute(cart.at(ORIGIN), roller["bore"], axis=(0, 1, 0), name="axle"))
    scene.add(Contact(roller["rim"], floor, friction=FRICTION, name="nip", grid=grid))
    scene.add(forces.PointForce(cart.at(ORIGIN), force))
    if spring:
        scene.add(forces.JointSpringDamper(way, spring))
    return scene, axle


def pulled(share: float, **options: Any) -> Scene:
    """By `share` of what friction bears; the roller does not turn."""
    scene, axle = on_floor((share * FRICTION * PRESS, 0.0, -PRESS), **options)
    scene.add(joints.Drive(axle, 0.0, quantity="position"))
    return scene


def incline(tangent: float, grid: Any = "body_fixed", *, brake: bool = True) -> Scene:
    """A wheel on an incline, its brake a joint that rubs. tangent: of the force on the patch, tangential over normal;
    the slide, which the guide holds, presses but does not pull."""
    weight = rim(grid).mass + 1.0
    angle = np.arctan(tangent * (weight + 1.0) / weight)
    down = GRAVITY * np.array([np.sin(angle), 0.0, -np.cos(angle)])
    scene, axle = on_floor((0.0, 0.0, 0.0), gravity=tuple(down), grid=grid)
    if brake:
        scene.add(forces.RevoluteFriction(axle, 0.5, load_independent=1e3, pin_radius=RADIUS, name="brake"))
    return scene


def twisted(share: float, grid: Any) -> Scene:
    """Two rollers, the lower one fixed, the upper one pressed down and rotated by a torque, by `share` of what friction
    bears."""
    scene = Scene(gravity=ORIGIN)
    lower = scene.add_body(rim(grid), name="lower")
    upper = scene.add_body(rim(grid), name="upper", position=(0.0, 0.0, 2.0 * RADIUS))
    contact = scene.add(Contact(lower["rim"], upper["rim"], friction=FRICTION, name="nip", grid=grid))
    scene.close_gap(contact, along=(0.0, 0.0, 1.0))
    cart = scene.add_rigid_body(1.0, (1e-3, 1e-3, 1e-3), name="cart", position=upper["bore"].world_point())
    scene.add(joints.Fixed(scene.ground, lower["bore"], name="foot"))
    scene.add(joints.Prismatic(scene.ground, cart.at(ORIGIN), axis=(0, 0, 1), name="guide"))
    scene.add(joints.Revolute(cart.at(ORIGIN), upper["bore"], axis=(0, 1, 0), name="axle"))
    scene.add(forces.PointForce(cart.at(ORIGIN), (0.0, 0.0, -PRESS)))
    scene.add(forces.PointTorque(upper["bore"], (0.0, share * FRICTION * PRESS * RADIUS, 0.0)))
    return scene


def at_rest(scene: Scene) -> wf.Result:
    rest = wf.equilibrium(scene, friction=True)
    assert rest.status == "completed", rest.history.message
    return rest


def stays(scene: Scene, rest: wf.Result, body: str) -> None:
    run = wf.simulate(scene, 5e-3, step=1e-3, start=rest, progress=False)
    assert run.status == "completed", run.history.message
    assert np.abs(run.history.bodies[body].position - rest.history.bodies[body].position[0]).max() < STAYS


@pytest.mark.parametrize("share", [0.3, 0.9, 0.99])
def test_a_patch_holds_a_pull(share: float) -> None:
    """Tractions are the pull; the patch gives by micrometres, and stays in time."""
    scene = pulled(share)
    rest = at_rest(scene)
    force = rest.history.contacts["nip"].force[0]
    np.testing.assert_allclose(force, [-share * FRICTION * PRESS, 0.0, PRESS], atol=SOLVED * PRESS)
    assert 0.0 < rest.history.bodies["cart"].position[0, 0] < 2e-5
    stays(scene, rest, "cart")


@pytest.mark.parametrize("share", [0.5, 0.9])
def test_it_is_what_a_static_run_finds(share: float) -> None:
    """Pressed first, pulled then, in a few load steps. In an equilibrium the roller deforms under the pull while it is
    pressed, which shears its rim by a few per cent of what the patch gives; tractions feel a tenth of that."""
    rest = at_rest(pulled(share))
    scene, axle = on_floor((Table([0.0, 1.0], [0.0, share * FRICTION * PRESS]), 0.0, -PRESS))
    scene.add(joints.Drive(axle, 0.0, quantity="position"))
    run = wf.static(scene, 1.0, step=0.25, progress=False)
    assert run.status == "completed", run.history.message
    found, expected = (r.history.checkpoint["traction"] for r in (rest, run))
    assert np.abs(found - expected).max() < 1e-2 * np.abs(expected).max()
    shift = [r.history.bodies["cart"].position[-1, 0] for r in (rest, run)]
    assert shift[0] == pytest.approx(shift[1], rel=5e-2)


@pytest.mark.parametrize("share", [1.01, 1.5])
def test_more_than_it_holds_slides_and_is_named(share: float) -> None:
    rest = wf.equilibrium(pulled(share), friction=True)
    assert rest.status == "no_equilibrium"
    assert "does not come to rest" in rest.history.message and "friction of 'nip' holds" in rest.history.message
    assert "mechanism" in rest.history.message


def test_a_spring_takes_what_friction_does_not() -> None:
    """Pulled by twice what friction bears it slides to where a spring holds the rest."""
    stiffness = 1e7
    rest = at_rest(pulled(2.0, spring=stiffness))
    assert rest.history.contacts["nip"].force[0, 0] == pytest.approx(-FRICTION * PRESS, rel=1e-6)
    assert rest.history.bodies["cart"].position[0, 0] == pytest.approx(FRICTION * PRESS / stiffness, rel=1e-6)


@pytest.mark.parametrize("grid", ["body_fixed", "contact_fixed"])
def test_a_braked_wheel_rests_on_an_incline_below_the_angle_of_friction(grid: Any) -> None:
    scene = incline(0.95 * FRICTION, grid)
    rest = at_rest(scene)
    force = rest.history.contacts["nip"].force[0]
    assert -force[0] / force[2] == pytest.approx(0.95 * FRICTION, rel=SOLVED)
    stays(scene, rest, "roller")


@pytest.mark.parametrize("grid", ["body_fixed", "contact_fixed"])
def test_beyond_the_angle_it_slides(grid: Any) -> None:
    rest = wf.equilibrium(incline(1.05 * FRICTION, grid), friction=True)
    assert rest.status == "no_equilibrium" and "friction of 'nip' holds" in rest.history.message


def test_without_a_brake_it_rolls() -> None:
    rest = wf.equilibrium(incline(0.5 * FRICTION, brake=False), friction=True)
    assert rest.status == "no_equilibrium"
    assert "body 'roller' is free to turn about (0, 1, 0)" in rest.history.message


@pytest.mark.parametrize("grid", ["body_fixed", "contact_fixed"])
def test_two_rollers_hold_a_torque_up_to_what_friction_bears(grid: Any) -> None:
    """The force is the torque over the distance of the patch from the axle."""
    scene = twisted(0.9, grid)
    rest = at_rest(scene)
    force = rest.history.contacts["nip"].force[0]
    arm = 0.9 * FRICTION * PRESS * RADIUS / abs(force[0])
    assert RADIUS - 1e-4 < arm < RADIUS
    stays(scene, rest, "upper")
    beyond = wf.equilibrium(twisted(1.1, grid), friction=True)
    assert beyond.status == "no_equilibrium" and "friction of 'nip' holds" in beyond.history.message


def test_a_load_cycle_of_a_pull_closes() -> None:
    """To and fro by 0.9 of what friction bears, in a static run: the second time there is the first one."""
    scene, axle = on_floor(
        (Table([0.0, 1.0, 3.0, 5.0], 0.9 * FRICTION * PRESS * np.array([0.0, 1.0, -1.0, 1.0])), 0.0, -PRESS)
    )
    scene.add(joints.Drive(axle, 0.0, quantity="position"))
    run = wf.static(scene, 5.0, step=0.25, progress=False)
    assert run.status == "completed", run.history.message
    x = run.history.bodies["cart"].position[:, 0]
    pull = -run.history.contacts["nip"].force[:, 0]
    assert np.abs(pull[[4, 12, 20]] - 0.9 * FRICTION * PRESS * np.array([1.0, -1.0, 1.0])).max() < SOLVED * PRESS
    assert x[20] == pytest.approx(x[4], rel=1e-3) and x[12] == pytest.approx(-x[4], rel=1e-3)
    lost = -np.diff(run.energy["friction"][[4, 12, 20]])
    assert lost[0] == pytest.approx(lost[1], rel=1e-2) and lost[0] > 0.0


def stacked(grid: Any, off: float = 0.0) -> tuple[Scene, Any, Any]:
    """Two rollers that overlap, the upper one on a guide across, `off` [m] the top; its bore, and the guide."""
    scene = Scene(gravity=ORIGIN)
    lower = scene.add_body(rim(grid), name="lower")
    upper = scene.add_body(rim(grid), name="upper", position=(off, 0.0, 2.0 * RADIUS))
    contact = scene.add(Contact(lower["rim"], upper["rim"], friction=FRICTION, name="nip", grid=grid))
    scene.close_gap(contact, gap=-6e-5)
    scene.add(joints.Fixed(scene.ground, lower["bore"], name="foot"))
    guide = scene.add(joints.Prismatic(scene.ground, upper["bore"], axis=(1, 0, 0), name="guide"))
    return scene, upper["bore"], guide


@pytest.mark.parametrize("off", [1e-5, 1e-3])
def test_friction_holds_what_is_pressed_off_the_top(off: float) -> None:
    """Nothing else acts along the guide, so that the pull is the push: T/N is the slope of the line of centres."""
    scene, _, _ = stacked("body_fixed", off)
    rest = at_rest(scene)
    nip = rest.contact("nip")
    line = np.subtract(*(rest.history.bodies[name].position[0] for name in ("upper", "lower")))
    slope = line[0] / line[2]
    assert slope == pytest.approx(off / (2.0 * RADIUS), rel=2e-3)
    assert abs(rest.history.contacts["nip"].force[0, 0]) < SOLVED * nip.normal_load[0]
    assert np.linalg.norm(nip.friction.tangential_force[0]) == pytest.approx(slope * nip.normal_load[0], rel=1e-2)


def pushed_over(grid: Any, pull: Any = None, way: Any = None) -> wf.Result:
    """The upper roller pulled along its guide or driven, in load steps of 1 s."""
    scene, bore, guide = stacked(grid)
    table = Table(np.arange(len(OVER)), OVER * pull if way is None else way)
    if way is None:
        scene.add(forces.PointForce(bore, (table, 0.0, 0.0)))
    else:
        scene.add(joints.Drive(guide, table, quantity="position"))
    run = wf.static(scene, len(OVER) - 1.0, step=1.0, progress=False)
    assert run.status == "completed", run.history.message
    return run


OVER = np.array([0.0, 0.4, 0.7, 0.9, 0.2, -0.5, -0.9])  # of what friction bears at the least


@pytest.mark.parametrize("grid", ["body_fixed", pytest.param("contact_fixed", marks=pytest.mark.slow)])
def test_a_force_finds_what_a_displacement_finds(grid: Any) -> None:
    """To and fro by 0.9 of what friction bears, without a step halved, although slips of 20 um tilt the line of centres
    by 2e-4; a drive to the same places asks for the same forces."""
    pull = FRICTION * 3.9e4
    by_force = pushed_over(grid, pull=pull)
    nip = by_force.history.contacts["nip"]
    assert by_force.history.counters["rejected_steps"] == 0
    assert 0.8 < np.abs(nip.force[3, 0] / (FRICTION * nip.force[3, 2])) < 0.9
    np.testing.assert_allclose(nip.force[:, 0], pull * OVER, atol=SOLVED * pull)
    by_place = pushed_over(grid, way=by_force.history.joints["guide"].coordinate)
    np.testing.assert_allclose(by_place.history.contacts["nip"].force[:, 0], pull * OVER, atol=3.0 * SOLVED * pull)
    found, expected = (r.history.checkpoint["traction"] for r in (by_force, by_place))
    assert np.abs(found - expected).max() < 1e-6 * np.abs(expected).max()


def test_sliding_ends_a_static_run_at_once() -> None:
    """Just beyond mu P, and named."""
    scene, axle = on_floor((Table([0.0, 1.0], [0.0, 1.1 * FRICTION * PRESS]), 0.0, -PRESS))
    scene.add(joints.Drive(axle, 0.0, quantity="position"))
    run = wf.static(scene, 1.0, step=0.1, progress=False)
    assert run.status == "no_equilibrium" and "body 'roller' does not come to rest" in run.history.message
    assert run.time[-1] == pytest.approx(0.9)


@pytest.mark.slow
@pytest.mark.parametrize("share", [0.3, 0.5, 0.8])
def test_the_stick_zone_is_that_of_cattaneo_and_mindlin(share: float) -> None:
    """Its half-width over that of the patch is sqrt(1 - Q/(mu P)), to half a cell of the nine or so across."""
    friction = at_rest(twisted(share, "contact_fixed")).contact("nip").friction
    stick, slip = (float(np.ravel(area)[-1]) for area in (friction.stick_area, friction.slip_area))
    assert stick / (stick + slip) == pytest.approx(np.sqrt(1.0 - share), abs=0.07)
