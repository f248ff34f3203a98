"""Static runs with friction of joints, lumped contacts and contact surfaces: paths, loops, losses, their history."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest

import warpffrf as wf
from scenes.rollers import roller_body
from warpffrf.model import forces, joints, laws, surfaces
from warpffrf.model.contact import Contact
from warpffrf.model.friction import RegularisedCoulomb
from warpffrf.model.lumped_contact import LumpedContact
from warpffrf.model.material import Material
from warpffrf.model.scene import Scene
from warpffrf.model.signals import Ramp, Table
from warpffrf.online.engine import Engine
from warpffrf_kernels.core import control as k

ORIGIN = (0.0, 0.0, 0.0)
STIFFNESS, BOUND, LOAD = 1000.0, 20.0, 50.0  # N/m, N, N
RADIUS, CLAMP = 0.05, 3e4  # m, N: of a roller
BALANCED = 1e-7  # of the largest force: Newton's method leaves 1e-9 of it, friction in passes a little more
ROUND_OFF = 1e-12
TIMES, SIGNS = [0.0, 1.0, 3.0, 5.0], np.array([0.0, 1.0, -1.0, 1.0])


def rail(friction: Any = 0.0, *, load_independent: float = BOUND, spring: float = STIFFNESS) -> Scene:
    """A block on a guide that rubs, held by a spring and pushed to and fro."""
    scene = Scene(gravity=ORIGIN)
    block = scene.add_rigid_body(1.0, (0.01, 0.01, 0.01), name="block")
    guide = scene.add(joints.Prismatic(scene.ground.at(ORIGIN), block.at(ORIGIN), axis=(1, 0, 0), name="guide"))
    if spring:
        scene.add(forces.JointSpringDamper(guide, spring, damping=7.0, name="spring"))
    scene.add(forces.PrismaticFriction(guide, friction, load_independent=load_independent, name="rub"))
    scene.add(forces.PointForce(block.at(ORIGIN), (Table(TIMES, LOAD * SIGNS, hold=True), 0.0, 0.0), name="push"))
    return scene


def static(scene: Scene, duration: float, step: float, **options: Any) -> wf.Result:
    found = wf.static(scene, duration, step=step, progress=False, **options)
    assert found.status == "completed", found.message
    return found


def play(push: np.ndarray) -> np.ndarray:
    """Place of the block [m]: it follows the load at a distance of the bound, both over the stiffness."""
    x, found = 0.0, []
    for force in push:
        x = float(np.clip(x, (force - BOUND) / STIFFNESS, (force + BOUND) / STIFFNESS))
        found.append(x)
    return np.array(found)


@pytest.mark.parametrize("step", [0.02, 0.05, 1.0])
def test_a_joint_that_rubs_plays(step: float) -> None:
    """It sticks and slips as the play operator says, whatever the load step; it loses the bound times its way."""
    result = static(rail(), 5.0, step)
    x = result.history.joints["guide"].coordinate
    expected = play(np.interp(result.time, TIMES, LOAD * SIGNS))
    assert np.abs(x - expected).max() < ROUND_OFF
    lost = BOUND * np.concatenate([[0.0], np.cumsum(np.abs(np.diff(expected)))])
    assert np.abs(result.energy["friction"] + lost).max() < 1e-9 * lost[-1]
    assert not np.any(result.energy["damping"])


def test_a_regularised_law_plays_where_loads_take_long() -> None:
    """The slip speed is that of the load steps: 25 mm/s at most, far above the slip velocity, far below none at all."""
    result = static(rail(RegularisedCoulomb(0.0, slip_velocity=1e-9)), 5.0, 0.05)
    expected = play(np.interp(result.time, TIMES, LOAD * SIGNS))
    assert np.abs(result.history.joints["guide"].coordinate - expected).max() < 1e-8


def test_more_than_friction_holds_is_no_equilibrium() -> None:
    result = wf.static(rail(spring=0.0), 1.0, step=0.1, progress=False)
    assert result.status == "no_equilibrium" and "block" in result.message
    assert result.time[-1] == pytest.approx(0.4)  # 20 N of 50 N
    assert np.abs(result.history.joints["guide"].coordinate).max() < ROUND_OFF


def test_friction_of_a_joint_holds_what_a_run_in_time_finds() -> None:
    """Pushed to 50 N and back to 35 N in statics: it is held there 5 N short of the bound, and stays in time."""
    scene = rail()
    stages = [wf.Stage("push", 1.3, 0.1, kind="static"), wf.Stage("wait", 0.2, 1e-3)]
    scene.forces[-1].components = forces.PointForce(
        scene.bodies[0].at(ORIGIN), (Table([0.0, 1.0, 1.3, 2.0], [0.0, 50.0, 35.0, 35.0]), 0.0, 0.0)
    ).components
    result = wf.simulate(scene, stages, progress=False)
    assert result.status == "completed", result.message
    x = result.history.joints["guide"].coordinate
    assert x[10] == pytest.approx(0.03, abs=ROUND_OFF)
    assert np.abs(x[10:] - 0.03).max() < 1e-9


STEEL = Material(210e9, 0.3, 7800.0)
BALL = surfaces.Sphere(radius=0.01, axis_point=ORIGIN, axis_direction=(0.0, 0.0, 1.0))
FLOOR = surfaces.Plane(origin=ORIGIN, outward=(1.0, 0.0, 0.0))
PRESS, COEFFICIENT, STROKE = 100.0, 0.3, 4e-6  # N, m


def test_a_lumped_contact_sticks_and_slips_by_displacements() -> None:
    """A ball under a constant load that a drive moves to and fro: its friction is a spring that yields at the bound."""
    scene = Scene(gravity=ORIGIN)
    floor = scene.ground.surface(FLOOR, name="floor")
    ball = scene.add_rigid_body(
        0.03, (1e-6, 1e-6, 1e-6), name="ball", position=(0.01, 0.0, 0.0), surfaces={"skin": BALL}
    )  # fmt: skip
    cart = scene.add_rigid_body(0.1, (1e-4, 1e-4, 1e-4), name="cart", position=(0.01, 0.0, 0.0))
    scene.add(joints.Prismatic(cart.at(ORIGIN), ball.at(ORIGIN), axis=(1, 0, 0), name="lift"))
    way = scene.add(joints.Prismatic(scene.ground.at((0.01, 0, 0)), cart.at(ORIGIN), axis=(0, 1, 0), name="way"))
    scene.add(joints.Drive(way, Table(TIMES, STROKE * SIGNS, hold=True), quantity="position"))
    scene.add(forces.PointForce(ball.at(ORIGIN), (-PRESS, 0.0, 0.0)))
    law = laws.HertzPoint(STEEL, STEEL)
    scene.add(LumpedContact(ball["skin"], floor, law=law, friction=COEFFICIENT, name="foot"))
    result = static(scene, 5.0, 0.05)
    moved = np.interp(result.time, TIMES, STROKE * SIGNS)
    force = -result.history.joints["way"].force[:, 1]
    force = force * np.sign(force[1])
    stiffness = abs(force[1] / moved[1])
    assert stiffness * STROKE > 3.0 * COEFFICIENT * PRESS  # it slips
    expected, f = [0.0], 0.0
    for step in np.diff(moved):
        f = float(np.clip(f + stiffness * step, -COEFFICIENT * PRESS, COEFFICIENT * PRESS))
        expected.append(f)
    assert np.abs(force - np.array(expected)).max() < 1e-7 * COEFFICIENT * PRESS
    assert result.energy["friction"][-1] < -COEFFICIENT * PRESS * STROKE
    defect = result.energy["numerical"] + result.energy["contact_grid"]
    assert np.abs(defect).max() < 1e-6 * result.energy["drive_work"].max()


@pytest.fixture(scope="module", params=["body_fixed", "contact_fixed"])
def rubbing(request: pytest.FixtureRequest) -> Scene:
    """Two flexible rollers on each other: pressed together, then the lower one rotated to and fro. Pressures and
    tractions are on the grid of the material, or on cells that travel with the patch."""
    body = roller_body(
        120, layers=4, axial=3, grading=1.6, order=1, max_frequency=15e3, tangential=True,
        contact_fixed=request.param == "contact_fixed", cache=False,
    )  # fmt: skip
    scene = Scene()
    lower = scene.add_body(body, name="lower")
    upper = scene.add_body(body, name="upper", position=(0.0, 0.0, 0.1))
    contact = scene.add(Contact(lower["rim"], upper["rim"], friction=0.2, name="nip", grid=request.param))
    scene.close_gap(contact, along=(0.0, 0.0, 1.0))
    place = upper["bore"].world_point()
    cart = scene.add_rigid_body(1.0, (1e-3, 1e-3, 1e-3), name="cart", position=place)
    axle = scene.add(joints.Revolute(scene.ground, lower["bore"], axis=(0, 1, 0), name="axle"))
    guide = scene.add(joints.Prismatic(scene.ground, cart.at(ORIGIN), axis=(0, 0, 1), name="guide"))
    other = scene.add(joints.Revolute(cart.at(ORIGIN), upper["bore"], axis=(0, 1, 0), name="other"))
    turn = Table([0.0, 1.0, 2.0, 4.0, 6.0], [0.0, 0.0, 4e-3, -4e-3, 4e-3], hold=True)
    for joint, signal in ((guide, Ramp(0.0, -2e-4, duration=1.0)), (axle, turn), (other, 0.0)):
        scene.add(joints.Drive(joint, signal, quantity="position"))
    return scene


def test_surfaces_that_rub_go_round_a_loop(rubbing: Scene) -> None:
    """Loops after the first quarter are closed: going down is going up rotated by half a turn (Masing), its slope at
    the turning points that of the start; at the ends all of the patch slips, at mu p."""
    result = static(rubbing, 6.0, 0.05)
    force = result.history.contacts["nip"].force
    share = force[:, 0] / np.where(force[:, 2] == 0.0, 1.0, force[:, 2])
    first, down, up = share[20:41], share[40:81], share[80:121]
    assert np.abs(share).max() == pytest.approx(0.2, rel=2e-3)
    # cells that travel read their history between those of before
    travels = result.history.contacts["nip"].cells is not None
    assert np.abs(down + up).max() < (2e-3 if travels else 1e-6)
    assert np.abs((first - first[0]) - 0.5 * (down[0] - down[::2])[:21]).max() < 5e-3
    lost = -np.diff(result.energy["friction"][[40, 80, 120]])
    assert lost[0] == pytest.approx(lost[1], rel=1e-3)
    turned = result.history.joints["axle"].coordinate[80:121]
    torque = result.history.joints["axle"].torque[80:121, 1]
    other = np.diff(result.energy["strain"][[80, 120]] + result.energy["contact"][[80, 120]])
    assert abs(np.trapezoid(torque, turned)) == pytest.approx(lost[1] + other[0], rel=2e-2)


@pytest.mark.parametrize("rubbing", ["body_fixed"], indirect=True)
def test_a_static_run_with_friction_goes_on_bit_for_bit(rubbing: Scene) -> None:
    """The state at the end, tractions and their history included, is that of the run in one go."""
    whole = static(rubbing, 1.8, 0.1)
    rest = static(rubbing, 0.6, 0.1, start=static(rubbing, 1.2, 0.1))
    forces_of = [r.history.contacts["nip"].force[-1] for r in (whole, rest)]
    assert np.array_equal(*forces_of)
    for name in ("traction", "elastic_before", "pressure", "q", "r"):
        assert np.array_equal(whole.history.checkpoint[name], rest.history.checkpoint[name]), name
    assert abs(forces_of[0][0]) > 0.1 * abs(forces_of[0][2])


@pytest.mark.parametrize("rubbing", ["body_fixed"], indirect=True)
def test_tractions_stay_when_a_run_in_time_begins(rubbing: Scene) -> None:
    """Loads go on without a jump, drives stand: the tangential force is what the static run has left."""
    stages = [wf.Stage("load", 7.0, 0.1, kind="static"), wf.Stage("wait", 0.002, 1e-4)]
    result = wf.simulate(rubbing, stages, progress=False)
    assert result.status == "completed", result.message
    force = result.history.contacts["nip"].force
    assert np.abs(force[71:] - force[70]).max() < 1e-6 * np.abs(force[70]).max()
    assert abs(force[70, 0]) > 0.15 * abs(force[70, 2])


def test_history_is_committed_by_whole_steps_alone() -> None:
    """The word `commit` is set by accepted load steps and steps in time, not by the proximal steps of an equilibrium;
    that commits once, by hand, what remembers: joints do, which in an equilibrium have nothing to remember."""
    engine, stone = Engine(rail()), Scene()
    stone.add_rigid_body(1.0, (1.0, 1.0, 1.0), name="stone")
    assert engine.graph.remembers and not Engine(stone).graph.remembers
    engine.static_step(1.0)
    assert engine.word("accept")[0] == 1 and engine.word("commit")[0] == 0
    before = engine.state.slipping.numpy().copy()
    engine.commit()
    assert np.array_equal(engine.state.slipping.numpy(), before) and engine.word("commit")[0] == 0
    engine.clock(tau=1.0)
    engine.control(every=1)
    for mode in (k.LOADING, k.DYNAMIC):
        engine.enter(mode, 0.1)
        engine.replay(1)
        assert engine.word("accept")[0] == 1 and engine.word("commit")[0] == 1


def pulled_roller(press: float, friction: float, most: float) -> Scene:
    """A roller pressed on a plane by `press` [N] and pulled along it, within a second, by `most` of what friction
    bears; a cart on guides holds its bore, so that it does not turn."""
    scene = Scene(gravity=ORIGIN)
    floor = scene.ground.surface(surfaces.Plane(origin=(0, 0, -RADIUS), outward=(0, 0, 1)), name="floor")
    body = roller_body(
        120,
        layers=4,
        axial=3,
        grading=1.6,
        order=1,
        max_frequency=15e3,
        tangential=True,
        contact_fixed=False,
        cache=True,
    )
    roller = scene.add_body(body, name="roller")
    place = roller["bore"].world_point()
    slide, cart = (
        scene.add_rigid_body(1.0, (1e-3, 1e-3, 1e-3), name=name, position=place) for name in ("slide", "cart")
    )
    scene.add(joints.Prismatic(scene.ground.at(place), slide.at(ORIGIN), axis=(0, 0, 1), name="lift"))
    scene.add(joints.Prismatic(slide.at(ORIGIN), cart.at(ORIGIN), axis=(1, 0, 0), name="way"))
    scene.add(joints.Fixed(cart.at(ORIGIN), roller["bore"], name="grip"))
    scene.add(Contact(roller["rim"], floor, friction=friction, name="nip", grid="body_fixed"))
    scene.add(forces.PointForce(cart.at(ORIGIN), (Table([0.0, 1.0], [0.0, most * friction * press]), 0.0, -press)))
    return scene


def test_a_patch_that_sticks_holds_a_force() -> None:
    """Pulled by nearly what friction bears, a roller is held by tractions that are the pull."""
    result = static(pulled_roller(CLAMP, 0.3, 0.9), 1.0, 0.25)
    force = result.history.contacts["nip"].force
    np.testing.assert_allclose(np.abs(force[:, 0]), 0.27 * CLAMP * result.time, atol=BALANCED * CLAMP)
    np.testing.assert_allclose(np.abs(force[:, 2]), CLAMP, rtol=BALANCED)
    x = result.history.bodies["cart"].position[:, 0]
    assert np.all(np.diff(x, 2) > 0.0), "the patch gives more where more of it slips"
