"""Dry friction in joints against closed forms and event-driven solutions: stick, slip, what presses, what is lost."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from scipy.integrate import solve_ivp
from scipy.optimize import brentq

import warpffrf as wf
from warpffrf.model import forces, joints
from warpffrf.model.errors import InputError
from warpffrf.model.friction import RegularisedCoulomb
from warpffrf.model.integrators import HHT, GeneralizedAlpha, Newmark, RungeKutta4
from warpffrf.model.reduced.body import ReducedBody
from warpffrf.model.scene import Scene
from warpffrf.online import run
from warpffrf.online.history.history import History

G, MASS, ARM, INERTIA = 9.81, 2.0, 0.5, 0.05  # of the pendulum: m/s2, kg, m, kg m2 about the centre of mass
WEIGHT = MASS * G * ARM
STICK, SLIP = 1, 2
SOLVED = 1e-9  # of the forces at hand: what Newton's method leaves
AGREE = 1e-4  # rad, of turning points and where it stops, at a step of 1 ms
HELD = 1e-6  # of friction that holds: round-off of positions over h^2, as of all reactions
ROUND_OFF = 1e-12


def pendulum(start: float, friction: float = 0.0, *, pin_radius: float = 0.0, load_independent: float = 0.0) -> Scene:
    """A rod on a pin, held at `start` [rad] from the vertical."""
    scene = Scene(gravity=(0.0, -G, 0.0))
    rod = scene.add_rigid_body(
        MASS, (INERTIA, 0.01, INERTIA), name="rod", position=(ARM * np.sin(start), -ARM * np.cos(start), 0.0),
        rotation=(0.0, 0.0, np.sin(0.5 * start), np.cos(0.5 * start)),
    )  # fmt: skip
    pin = scene.add(joints.Revolute(scene.ground.at((0, 0, 0)), rod.at((0.0, ARM, 0.0)), axis=(0, 0, 1), name="pin"))
    scene.add(
        forces.RevoluteFriction(pin, friction, pin_radius=pin_radius, load_independent=load_independent, name="rub")
    )
    return scene


def root(function: Callable[[float], float], low: float, high: float) -> float:
    found: Any = brentq(function, low, high, xtol=1e-15)
    return float(found)


def angle(history: History, start: float) -> np.ndarray:
    return start + history.joints["pin"].coordinate


def turning_points(theta: np.ndarray) -> list[float]:
    """The first value, those where the motion turns round, and the last."""
    moves = np.flatnonzero(np.abs(np.diff(theta)) > ROUND_OFF)
    signs = np.sign(np.diff(theta))[moves]
    turns = moves[1:][signs[1:] != signs[:-1]]
    return [float(theta[0]), *(float(theta[i]) for i in turns), float(theta[-1])]


def settled(scene: Scene, duration: float, step: float = 1e-3, **options: Any) -> History:
    history = run(scene, duration, step=step, progress=False, **options)
    assert history.status == "completed", history.message
    assert np.all(np.diff(history.energy["friction"]) <= 0.0)  # it never gives
    return history


# --- a pendulum


def test_a_constant_torque_takes_the_closed_form_from_every_swing_and_stops_where_it_holds() -> None:
    """m g l (cos b - cos a) = T (|a| + |b|) of each swing from a to b, until m g l sin|a| <= T."""
    torque, start = 0.8, 1.0
    known = [start]
    while WEIGHT * np.sin(abs(known[-1])) > torque:
        a, side = abs(known[-1]), np.sign(known[-1])

        def left(b: float, a: float = a) -> float:  # b counts on the other side; negative where it stops before
            return WEIGHT * (np.cos(b) - np.cos(a)) - torque * (a + b)

        known.append(-float(side) * root(left, -0.999 * a, a))
    history = settled(pendulum(start, load_independent=torque), 5.0)
    theta = angle(history, start)
    found = turning_points(theta)
    assert len(found) == len(known) > 6
    assert found == pytest.approx(known, abs=AGREE)
    loss = -np.diff(WEIGHT * (1.0 - np.cos(found)))
    assert loss == pytest.approx(torque * np.abs(np.diff(known)), rel=AGREE, abs=AGREE * WEIGHT)
    rub = history.forces["rub"].friction
    assert rub is not None and rub.state[-1] == STICK
    assert history.forces["rub"].torque[-1, 2] == pytest.approx(WEIGHT * np.sin(theta[-1]), rel=HELD)
    assert history.energy["friction"][-1] == pytest.approx(-torque * np.abs(np.diff(known)).sum(), rel=AGREE)


PIN = {"friction": 0.3, "pin_radius": 0.05, "load_independent": 0.2}


def swings(start: float, friction: float, pin_radius: float, load_independent: float) -> list[float]:
    """Turning points of the pendulum whose reaction presses, three swings: between two turns the torque has one sign,
    and the angular acceleration that goes with it is found by a root finder."""

    def acceleration(theta: float, omega: float, sign: float) -> float:
        def off(alpha: float) -> float:
            across = np.hypot(
                MASS * (G * np.sin(theta) + ARM * alpha), MASS * (G * np.cos(theta) + ARM * omega * omega)
            )
            torque = load_independent + friction * pin_radius * across
            return (INERTIA + MASS * ARM * ARM) * alpha + WEIGHT * np.sin(theta) + sign * torque

        return root(off, -1e3, 1e3)

    points = [start]
    for _ in range(3):
        side = float(np.sign(points[-1]))

        def turns(_: float, y: np.ndarray, side: float = side) -> float:
            return side * y[1]

        turns.terminal, turns.direction = True, 1.0  # pyright: ignore
        begin = acceleration(points[-1], 0.0, -side)
        first = 1e-6  # s, off the turning point
        found = solve_ivp(
            lambda _, y, side=side: [y[1], acceleration(y[0], y[1], -side)], (0.0, 5.0),
            [points[-1] + 0.5 * begin * first**2, begin * first], events=turns, rtol=1e-10, atol=1e-12,
        )  # fmt: skip
        points.append(float(found.y[0, -1]))
    return points


@pytest.fixture(scope="module")
def known_swings() -> list[float]:
    return swings(1.0, **PIN)


INTEGRATORS = {
    "generalized_alpha": GeneralizedAlpha(),
    "annihilating": GeneralizedAlpha(0.0),
    "projected": GeneralizedAlpha(0.8, project_velocities=True),
    "hht": HHT(-0.1),
    "trapezoidal": Newmark(),
}


@pytest.mark.parametrize("integrator", INTEGRATORS.values(), ids=INTEGRATORS)
def test_the_reaction_presses_the_pin(integrator: Any, known_swings: list[float]) -> None:
    """Turning points of the event-driven solution, to second order of the step."""
    errors = []
    for step in (4e-3, 1e-3):
        history = settled(pendulum(1.0, **PIN), 2.5, step, integrator=integrator)
        found = turning_points(angle(history, 1.0))
        errors.append(np.abs(np.array(found[1:4]) - known_swings[1:]).max())
        assert history.counters["restarted_steps"] <= 4 * len(known_swings)
    assert errors[1] < AGREE and errors[1] < errors[0] / 8.0  # 16 but for where in a step they turn


def test_within_the_cone_it_does_not_creep() -> None:
    """At rest off the vertical, 2000 steps; friction is what weight asks for."""
    history = settled(pendulum(0.03, **PIN), 2.0)
    assert np.ptp(history.joints["pin"].coordinate) < 1e-15
    rub = history.forces["rub"].friction
    assert rub is not None and np.all(rub.state == STICK) and not rub.power.any()
    assert history.forces["rub"].torque[:, 2] == pytest.approx(np.full(2001, WEIGHT * np.sin(0.03)), rel=SOLVED)
    bound = PIN["friction"] * PIN["pin_radius"] * MASS * G + PIN["load_independent"]
    assert rub.bound == pytest.approx(np.full(2001, bound / PIN["pin_radius"]), rel=SOLVED)
    assert history.energy["friction"][-1] == 0.0


def test_it_holds_as_soon_as_it_stops() -> None:
    """No ringing of friction after a stop: two steps later it is what the weight asks for, and stays so."""
    for integrator in INTEGRATORS.values():
        history = settled(pendulum(1.0, load_independent=4.0), 0.9, integrator=integrator)
        rub = history.forces["rub"].friction
        assert rub is not None
        stop = int(np.argmax(rub.state == STICK))
        assert 0 < stop < 880 and np.all(rub.state[stop:] == STICK)
        held = WEIGHT * np.sin(angle(history, 1.0)[-1])
        assert history.forces["rub"].torque[stop + 2 :, 2] == pytest.approx(held, rel=HELD)
        assert np.abs(history.bodies["rod"].angular_velocity[stop + 2 :, 2]).max() < SOLVED


def test_a_run_begins_with_the_friction_of_its_first_row() -> None:
    """Acceleration and friction at t = 0 of a pendulum that is let go, and of one that swings."""
    for omega in (0.0, 2.0):
        scene = pendulum(1.0, **PIN)
        rod = scene.bodies[0]
        rod.angular_velocity = np.array([0.0, 0.0, omega])
        rod.velocity = omega * ARM * np.array([np.cos(1.0), np.sin(1.0), 0.0])
        history = settled(scene, 0.01)
        alpha, torque = history.bodies["rod"].angular_acceleration[0, 2], history.forces["rub"].torque[0, 2]
        load = MASS * np.hypot(G * np.sin(1.0) + ARM * alpha, G * np.cos(1.0) + ARM * omega**2)
        way = -1.0 if omega > 0.0 else 1.0
        assert torque == pytest.approx(way * (0.2 + 0.3 * 0.05 * load), rel=SOLVED)
        inertia = INERTIA + MASS * ARM**2
        assert inertia * alpha == pytest.approx(torque - WEIGHT * np.sin(1.0), rel=SOLVED)


def test_the_ledger_closes_at_second_order() -> None:
    left = []
    for step in (2e-3, 1e-3):
        energy = settled(pendulum(1.0, **PIN), 2.5, step).energy
        held = sum(energy[line] - energy[line][0] for line in ("kinetic", "potential"))
        assert held - energy["friction"] - energy["numerical"] == pytest.approx(0.0 * held, abs=ROUND_OFF)
        left.append(np.abs(energy["numerical"]).max())
    assert left[1] < 1e-4 * WEIGHT and left[1] < left[0] / 3.0


# --- what presses


def incline(slope: float, friction: Any) -> Scene:
    scene = Scene(gravity=(0.0, 0.0, -G))
    block = scene.add_rigid_body(MASS, (0.01, 0.02, 0.03), name="block")
    along = (np.cos(slope), 0.0, -np.sin(slope))
    rail = scene.add(joints.Prismatic(scene.ground.at((0, 0, 0)), block.at((0, 0, 0)), axis=along, name="rail"))
    scene.add(forces.PrismaticFriction(rail, friction, name="rub"))
    return scene


def test_a_block_on_an_incline_sticks_below_the_friction_angle_and_slides_above() -> None:
    mu = 0.4
    for beyond in (-1e-3, 1e-3):
        slope = np.arctan(mu) + beyond
        history = settled(incline(slope, mu), 0.5)
        acceleration = max(G * (np.sin(slope) - mu * np.cos(slope)), 0.0)
        expected = 0.5 * acceleration * history.time**2
        assert history.joints["rail"].coordinate == pytest.approx(expected, abs=ROUND_OFF)
        rub = history.forces["rub"].friction
        assert rub is not None and np.all(rub.state == (SLIP if beyond > 0.0 else STICK))


def test_a_law_without_stick_creeps_down_at_its_share_of_the_slip_velocity() -> None:
    """v = v_slip tan(slope)/mu."""
    mu, slow, slope = 0.4, 0.05, 0.2
    history = settled(incline(slope, RegularisedCoulomb(mu, slow)), 0.5)
    rub = history.forces["rub"].friction
    assert rub is not None and rub.state[-1] == STICK  # below the slip velocity
    assert rub.slip_velocity[-1] == pytest.approx([slow * np.tan(slope) / mu, 0.0], rel=1e-9)


@pytest.mark.parametrize("offset", [0.0, 0.02, 0.2])
def test_bending_presses_on_both_ends_of_a_guide(offset: float) -> None:
    """A slide whose centre of mass lies `offset` along the guide: its ends carry m g (1/2 -+ offset/L)."""
    mu, length, push = 0.3, 0.1, 40.0
    scene = Scene(gravity=(0.0, 0.0, -G))
    slide = scene.add_rigid_body(MASS, (0.01, 0.02, 0.03), name="slide", position=(offset, 0.0, 0.0))
    rail = scene.add(
        joints.Prismatic(scene.ground.at((0, 0, 0)), slide.at((-offset, 0.0, 0.0)), axis=(1, 0, 0), name="rail")
    )
    scene.add(forces.PrismaticFriction(rail, mu, bearing_length=length, load_independent=1.0, name="rub"))
    scene.add(forces.PointForce(slide.at((0, 0, 0)), (push, 0.0, 0.0)))
    history = settled(scene, 0.05)
    ends = MASS * G * (abs(0.5 + offset / length) + abs(0.5 - offset / length))
    assert history.bodies["slide"].acceleration[1:, 0] == pytest.approx((push - 1.0 - mu * ends) / MASS, rel=SOLVED)


def test_flanks_carry_a_moment_about_the_guide() -> None:
    mu, radius, side, push = 0.3, 0.05, 0.04, 60.0
    scene = Scene(gravity=(0.0, 0.0, -G))
    slide = scene.add_rigid_body(MASS, (0.01, 0.02, 0.03), name="slide", position=(0.0, side, 0.0))
    rail = scene.add(
        joints.Prismatic(scene.ground.at((0, 0, 0)), slide.at((0.0, -side, 0.0)), axis=(1, 0, 0), name="rail")
    )
    scene.add(forces.PrismaticFriction(rail, mu, flank_radius=radius, name="rub"))
    scene.add(forces.PointForce(slide.at((0, 0, 0)), (push, 0.0, 0.0)))
    history = settled(scene, 0.05)
    bound = mu * MASS * G * (1.0 + side / radius)
    assert history.bodies["slide"].acceleration[1:, 0] == pytest.approx((push - bound) / MASS, rel=SOLVED)


def test_a_thrust_brakes_a_wheel_and_stops_it() -> None:
    """omega^2/(2 alpha) until it stands, alpha = mu r m g/J."""
    mu, radius, omega, J = 0.2, 0.1, 20.0, 0.02
    scene = Scene(gravity=(0.0, 0.0, -G))
    wheel = scene.add_rigid_body(MASS, (0.02, 0.02, J), name="wheel", angular_velocity=(0.0, 0.0, omega))
    axle = scene.add(joints.Revolute(scene.ground.at((0, 0, 0)), wheel.at((0, 0, 0)), axis=(0, 0, 1), name="axle"))
    scene.add(forces.RevoluteFriction(axle, mu, thrust_radius=radius, name="collar"))
    alpha = mu * radius * MASS * G / J
    history = settled(scene, omega / alpha + 0.1)
    turned = history.joints["axle"].coordinate
    assert turned[-1] == pytest.approx(omega**2 / (2.0 * alpha), abs=alpha * 1e-6)  # a step h: alpha h^2
    assert history.energy["friction"][-1] == pytest.approx(-0.5 * J * omega**2, rel=1e-5)


def test_a_driven_joint_is_not_pressed_by_its_drive() -> None:
    """A disc rotated at constant speed: the drive's torque is the friction, the weight alone presses the pin."""
    mu, radius, omega = 0.2, 0.03, 5.0
    scene = Scene(gravity=(0.0, -G, 0.0))
    disc = scene.add_rigid_body(MASS, (0.01, 0.01, 0.02), name="disc", angular_velocity=(0.0, 0.0, omega))
    pin = scene.add(joints.Revolute(scene.ground.at((0, 0, 0)), disc.at((0, 0, 0)), axis=(0, 0, 1), name="pin"))
    scene.add(joints.Drive(pin, omega))
    scene.add(forces.RevoluteFriction(pin, mu, pin_radius=radius, name="rub"))
    history = settled(scene, 0.2)
    torque = mu * radius * MASS * G
    assert history.forces["rub"].torque[:, 2] == pytest.approx(-torque, rel=SOLVED)
    assert history.joints["pin"].torque[:, 2] == pytest.approx(torque, rel=1e-8)
    work = torque * omega * history.time
    assert history.energy["drive_work"] == pytest.approx(work, rel=1e-8, abs=ROUND_OFF)
    assert history.energy["friction"] == pytest.approx(-work, rel=1e-8, abs=ROUND_OFF)


# --- a pin that turns and slides


def screw(inertia: float, radius: float = 0.03, mu: float = 0.3) -> Scene:
    scene = Scene(gravity=(0.0, 0.0, -G))
    pin = scene.add_rigid_body(
        MASS, (inertia, 0.02, 0.02), name="pin", velocity=(1.0, 0, 0), angular_velocity=(40.0, 0, 0)
    )
    bush = scene.add(joints.Cylindrical(scene.ground.at((0, 0, 0)), pin.at((0, 0, 0)), axis=(1, 0, 0), name="bush"))
    scene.add(forces.CylindricalFriction(bush, mu, pin_radius=radius, name="rub"))
    return scene


def test_a_pin_whose_mass_is_at_its_surface_slows_down_on_a_straight_helix() -> None:
    """With J = m r^2 the velocity of the surface keeps its direction and decays by mu g, until it stands."""
    radius, mu = 0.03, 0.3
    history = settled(screw(MASS * radius**2), 0.6)
    first = np.array([1.0, 40.0 * radius])
    speed = np.linalg.norm(first)
    expected = np.maximum(1.0 - mu * G * history.time / speed, 0.0)[:, None] * first
    rub = history.forces["rub"].friction
    assert rub is not None and rub.state[0] == SLIP and rub.state[-1] == STICK
    late = rub.state == STICK
    early = ~late
    early[np.argmax(late) - 3 :] = False  # it forgets for two steps as it stops
    assert rub.slip_velocity[early] == pytest.approx(expected[early], abs=1e-8)
    assert rub.traction[early] == pytest.approx(np.tile(-mu * MASS * G * first / speed, (early.sum(), 1)), rel=1e-7)
    assert history.time[np.argmax(late)] == pytest.approx(speed / (mu * G), abs=1e-3)


def test_friction_opposes_the_helix_whatever_the_inertia() -> None:
    """Against the equations of motion of the two velocities."""
    inertia, radius, mu = 0.02, 0.03, 0.3
    history = settled(screw(inertia), 0.3)

    def rates(_: float, y: np.ndarray) -> np.ndarray:
        return -mu * MASS * G * y / np.linalg.norm(y) * np.array([1.0 / MASS, radius**2 / inertia])

    exact = solve_ivp(rates, (0.0, 0.3), [1.0, 40.0 * radius], rtol=1e-11, atol=1e-13, t_eval=history.time)
    rub = history.forces["rub"].friction
    assert rub is not None and rub.slip_velocity == pytest.approx(exact.y.T, abs=1e-6)
    sizes = np.linalg.norm(rub.traction, axis=1) * np.linalg.norm(rub.slip_velocity, axis=1)
    assert np.sum(rub.traction * rub.slip_velocity, axis=1) == pytest.approx(-sizes, rel=1e-9)
    assert history.energy["friction"][-1] == pytest.approx(
        0.5 * MASS * (exact.y[0, -1] ** 2 - 1.0) + 0.5 * inertia * (exact.y[1, -1] ** 2 / radius**2 - 1600.0), rel=1e-6
    )


# --- machines


def four_bar(load_independent: float) -> Scene:
    """A four-bar linkage in a vertical plane, friction in all joints: sticking, they hold each other."""
    scene = Scene(gravity=(0.0, -G, 0.0))
    corners = np.array([(0.0, 0.0), (0.2, 0.5), (0.9, 0.6), (1.0, 0.0)])
    links = []
    for i in range(3):
        along = corners[i + 1] - corners[i]
        length, turn = float(np.linalg.norm(along)), float(np.arctan2(along[1], along[0]))
        body = scene.add_rigid_body(
            1.0, (1e-3, length**2 / 12.0, length**2 / 12.0), name=f"link {i}",
            position=(*(corners[i] + 0.5 * along), 0.0), rotation=(0, 0, np.sin(0.5 * turn), np.cos(0.5 * turn)),
        )  # fmt: skip
        links.append((body.at((-0.5 * length, 0, 0)), body.at((0.5 * length, 0, 0))))
    ends = [scene.ground.at((0, 0, 0)), *(port for link in links for port in link), scene.ground.at((1.0, 0, 0))]
    for i in range(4):
        hinge = scene.add(joints.Revolute(ends[2 * i], ends[2 * i + 1], axis=(0, 0, 1), name=f"hinge {i}"))
        scene.add(
            forces.RevoluteFriction(hinge, 0.1, pin_radius=0.01, load_independent=load_independent, name=f"rub {i}")
        )
    return scene


def test_joints_that_hold_each_other_in_a_loop() -> None:
    """Four stuck joints of a loop with one freedom: their forces are not determined, its rest is."""
    history = settled(four_bar(0.5), 0.5)
    assert max(np.abs(history.joints[f"hinge {i}"].coordinate).max() for i in range(4)) < ROUND_OFF
    assert any("'rub 0'" in note and "'rub 3'" in note and "order" in note for note in history.notes)
    free = settled(four_bar(0.05), 1.0)
    at_hand = np.ptp(free.energy["potential"])
    assert at_hand > 1.0 and np.abs(free.energy["numerical"]).max() < 0.02 * at_hand


def test_friction_that_the_order_of_adding_decides_is_named() -> None:
    """A door on two hinges, either of which may carry it; on one hinge its load is determined."""

    def notes(heights: tuple[float, ...]) -> list[str]:
        scene = Scene(gravity=(0.0, 0.0, -G))
        door = scene.add_rigid_body(20.0, (1.0, 2.0, 1.0), name="door", position=(0.5, 0, 0))
        for z in heights:
            ends = scene.ground.at((0, 0, z)), door.at((-0.5, 0, z))
            hinge = scene.add(joints.Revolute(*ends, axis=(0, 0, 1), name=f"hinge {z}"))
        scene.add(forces.RevoluteFriction(hinge, 0.3, pin_radius=0.01, thrust_radius=0.01, name="rub"))
        return settled(scene, 2e-3).notes

    for heights in ((0.4, -0.4), (-0.4, 0.4)):
        both = ", ".join(f"'hinge {z}'" for z in heights)
        assert any(
            f"friction 'rub': the constraints do not determine how the joints {both}" in n for n in notes(heights)
        )
    assert not any("do not determine" in note for note in notes((0.4,)))


def test_friction_at_an_interface_of_a_flexible_body(plain_body: ReducedBody) -> None:
    """A flexible roller that turns in its bore: its angular momentum is lost by the torque of friction."""
    torque, omega = 0.5, 30.0
    scene = Scene()
    roller = scene.add_body(plain_body, name="roller", inertia="constant", angular_velocity=(0.0, omega, 0.0))
    axle = scene.add(joints.Revolute(scene.ground, roller["bore"], axis=(0, 1, 0), name="axle"))
    scene.add(forces.RevoluteFriction(axle, 0.0, load_independent=torque, name="rub"))
    J = roller.inertia[1, 1]
    history = settled(scene, 0.5 * omega * J / torque, 0.5 * omega * J / torque / 200)
    assert history.bodies["roller"].angular_velocity[-1, 1] == pytest.approx(0.5 * omega, rel=1e-4)
    assert history.forces["rub"].torque[1:, 1] == pytest.approx(-torque, rel=SOLVED)


# --- around a run


def test_a_run_that_is_continued_gives_the_same_bits() -> None:
    """Also from among steps that forget, and from one that sticks."""
    scene = pendulum(1.0, load_independent=4.0)
    whole = settled(scene, 0.9)
    rub = whole.forces["rub"].friction
    assert rub is not None
    stop = int(np.argmax(rub.state == STICK))
    for steps in (stop, stop + 1, stop + 20):
        first = settled(scene, steps * 1e-3)
        second = settled(scene, (900 - steps) * 1e-3, start=first)
        assert np.array_equal(second.bodies["rod"].rotation[-1], whole.bodies["rod"].rotation[-1])
        assert np.array_equal(second.forces["rub"].torque[-1], whole.forces["rub"].torque[-1])


def test_results_say_whether_a_joint_sticks(tmp_path: Path) -> None:
    result = wf.simulate(pendulum(1.0, load_independent=4.0), duration=0.9, step=1e-3, progress=False)
    assert "force 'rub'" in result.report() and "sticks at the end, stuck in" in result.report()
    again = wf.Result.load(result.save(tmp_path / "run.h5"))
    here, there = result.force("rub").friction, again.force("rub").friction
    assert here is not None and there is not None
    for name in ("state", "slip_velocity", "traction", "bound", "power"):
        assert np.array_equal(getattr(here, name), getattr(there, name))
    data = again.to_xarray()
    assert data["joint_traction"].sel(joint_friction="rub", slip="around").values[-1] == here.traction[-1, 1]
    assert data["joint_friction_state"].values[-1, 0] == STICK
    booked = -result.history.energy["friction"][-1]
    assert np.sum(here.power * result.history.step_size) == pytest.approx(booked, rel=1e-9)


SCENE = """
[bodies.rod]
mass = 2.0
inertia_tensor = [0.05, 0.01, 0.05]
[joints.pin]
kind = "revolute"
a = "ground"
b = { body = "rod", point = [0, 0.5, 0] }
axis = [0, 0, 1]
[forces.rub]
kind = "revolute_friction"
joint = "pin"
friction = { kind = "regularised_coulomb", coefficient = 0.3, slip_velocity = 0.01 }
pin_radius = 0.05
"""


def test_scene_files_know_it(tmp_path: Path) -> None:
    (tmp_path / "scene.toml").write_text(SCENE)
    (rub,) = wf.load_scene(tmp_path / "scene.toml").scene.forces
    assert rub.friction == RegularisedCoulomb(0.3, 0.01) and rub.pin_radius == 0.05 and rub.joint.name == "pin"


def test_friction_is_left_out_of_an_equilibrium_with_a_note() -> None:
    scene = pendulum(0.3, load_independent=5.0)
    history = run(scene, 0.01, step=1e-3, start="equilibrium", progress=False)
    assert angle(history, 0.3)[0] == pytest.approx(0.0, abs=1e-8)
    assert any("friction of 'rub' does not act in the equilibrium" in note for note in history.notes)


def test_what_cannot_rub_is_refused() -> None:
    scene = pendulum(0.3, load_independent=5.0)
    (pin,) = scene.joints
    with pytest.raises(InputError, match="acts on a prismatic joint, got revolute joint 'pin'"):
        forces.PrismaticFriction(pin, 0.3)
    with pytest.raises(InputError, match="acts on a revolute joint, got 0.3"):
        forces.RevoluteFriction(0.3, pin)  # pyright: ignore
    with pytest.raises(InputError, match="it has no friction"):
        forces.RevoluteFriction(pin, 0.3)
    with pytest.raises(InputError, match="in m/s; give it the pin_radius"):
        forces.RevoluteFriction(pin, RegularisedCoulomb(0.3, 0.01), load_independent=1.0)
    with pytest.raises(InputError, match="friction must be a coefficient"):
        forces.RevoluteFriction(pin, "dry", pin_radius=0.1)  # pyright: ignore[reportArgumentType]
    with pytest.raises(InputError, match="bearing_length"):
        forces.RevoluteFriction(pin, 0.3, pin_radius=0.1, bearing_length=0.0)
    with pytest.raises(InputError, match="only scenes of free bodies"):
        run(scene, 0.01, step=1e-3, integrator=RungeKutta4(), progress=False)
