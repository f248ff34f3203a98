"""Moments of lumped contacts in runs: rolling out, turning back, pivoting, against closed forms and the equation of
motion; the ledger, and runs that go on."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest
from lumped_scenes import HERTZ, ORIGIN, STEEL
from scipy.integrate import solve_ivp

from warpffrf.model import forces, laws, signals, surfaces
from warpffrf.model.errors import InputError
from warpffrf.model.lumped_contact import LumpedContact
from warpffrf.model.scene import Scene
from warpffrf.online import Engine, History, find_equilibrium, run
from warpffrf.online.load_steps import run_static
from warpffrf.online.vibrations.eigenmodes import find_modes

RADIUS, GRAVITY, MASS = 0.01, 9.81, 0.03
LINE = laws.PalmgrenLine(0.012, 2)
TURN = 0.5 * MASS * RADIUS**2  # kg m2: a solid roller
LEVER = 1e-4
CREEP = laws.RegularisedCoulomb(0.3, 1e-4)
MODULUS = 0.5 * STEEL.plane_strain_modulus
SLOPES = 1e-4  # of eigenvalues: the heave of the roller, which moves with them
EXACT = 1e-6  # of steps with constant accelerations, and the sinking in of nanometres in radii


def on_floor(law: Any, *, inertia: float = TURN, **contact: Any) -> Scene:
    """A roller, or of a point law a ball, that lies on a floor as deep as its weight presses it."""
    scene = Scene(gravity=(0.0, 0.0, -GRAVITY))
    floor = scene.ground.surface(surfaces.Plane(origin=ORIGIN, outward=(0, 0, 1)), name="floor")
    kind = surfaces.Cylinder if law.by_laminae else surfaces.Sphere
    skin = kind(radius=RADIUS, axis_point=ORIGIN, axis_direction=(0, 1, 0))
    body = scene.add_rigid_body(MASS, (inertia,) * 3, name="body", position=(0, 0, RADIUS), surfaces={"skin": skin})
    found = scene.add(LumpedContact(body["skin"], floor, law=law, name="contact", **contact)).approach()
    body.position = np.array([0.0, 0.0, RADIUS - (MASS * GRAVITY / found.stiffness) ** (1.0 / found.exponent)])
    return scene


def rolling(scene: Scene, speed: float) -> Scene:
    scene.bodies[0].velocity = np.array([speed, 0.0, 0.0])
    scene.bodies[0].angular_velocity = np.array([0.0, speed / RADIUS, 0.0])
    return scene


def done(scene: Scene, duration: float, steps: int, **options: Any) -> History:
    history = run(scene, duration, step=duration / steps, progress=False, **options)
    assert history.status == "completed", history.message
    assert history.counters["rejected_steps"] == 0
    return history


def kinetic(history: History) -> np.ndarray:
    return history.energy["kinetic"]


@pytest.mark.parametrize("friction", [0.3, CREEP])
def test_a_roller_rolls_out(friction: Any) -> None:
    """It slows down by e g/(r (1 + J/(m r^2))) until it rests, and friction has taken what it had."""
    speed, slows = 0.02, LEVER * GRAVITY / (RADIUS * (1.0 + TURN / (MASS * RADIUS**2)))
    resistance = laws.RollingResistanceArm(LEVER, 0.02)
    history = done(rolling(on_floor(LINE, friction=friction, rolling_resistance=resistance), speed), 0.4, 100)
    v, t = history.bodies["body"].velocity[:, 0], history.time
    way = t < 0.8 * speed / slows
    np.testing.assert_allclose(v[way], speed - slows * t[way], atol=1e-4 * speed)  # what sticks swings at the start
    assert abs(np.polyfit(t[way][10:], v[way][10:], 1)[0] / -slows - 1.0) < 1e-4
    assert v.min() > -1e-6 * speed and v[-1] < 1e-2 * speed  # it never turns back
    moment = history.lumped_contacts["contact"].moment
    np.testing.assert_allclose(moment[5:][way[5:], 1], -LEVER * MASS * GRAVITY, rtol=1e-4)
    assert np.abs(moment[:, [0, 2]]).max() < 1e-9 * np.abs(moment).max()
    assert history.energy["friction"][-1] == pytest.approx(kinetic(history)[-1] - kinetic(history)[0], rel=1e-4)
    assert np.abs(history.energy["numerical"]).max() < 1e-4 * kinetic(history)[0]
    assert np.all(np.diff(history.energy["friction"]) <= 0.0)


def test_a_roller_that_is_pushed_to_and_fro() -> None:
    """Its moment changes sign twice; against the equation of motion."""
    duration, resistance = 0.16, laws.RollingResistanceArm(LEVER, 0.5)
    scene = on_floor(LINE, friction=CREEP, rolling_resistance=resistance)
    push = signals.Table((0.0, 0.02, 0.06, 0.1, 0.16), (0.0, 0.02, -0.03, 0.03, 0.0))
    scene.add(forces.PointForce(scene.bodies[0].at(ORIGIN), (push, 0.0, 0.0), name="push"))
    history = done(scene, duration, 160)
    mass, bound = MASS + TURN / RADIUS**2, LEVER * MASS * GRAVITY / RADIUS

    def rate(t: float, v: np.ndarray) -> list[float]:
        return [(float(push(t)) - bound * np.clip(v[0] / (0.5 * RADIUS), -1.0, 1.0)) / mass]

    exact: Any = solve_ivp(rate, (0.0, duration), [0.0], t_eval=history.time, rtol=1e-9, atol=1e-12, max_step=1e-4)
    v = history.bodies["body"].velocity[:, 0]
    assert exact.y[0].max() > RADIUS and exact.y[0].min() < -0.5 * RADIUS  # beyond 0.5 rad/s to either side
    assert np.abs(v - exact.y[0]).max() < 1e-2 * np.abs(v).max()  # of first order in the steps where the sign changes


@pytest.mark.parametrize("slow", [False, True])
def test_a_ball_that_pivots_on_a_floor(slow: bool) -> None:
    """Fast, M = 3 pi/16 mu F a; slow, M = 2 mu F a^2/5 w/v_slip, and its turning falls by exp(-t/T)."""
    inertia, mu, F = 0.4 * MASS * RADIUS**2, 0.2, MASS * GRAVITY
    a = (0.75 * F * RADIUS / MODULUS) ** (1.0 / 3.0)
    T = 0.01  # s
    creep = 0.4 * mu * F * a**2 * T / inertia if slow else 1e-7
    begin = creep / a if slow else 1.0  # two thirds of where both meet
    scene = on_floor(HERTZ, inertia=inertia, friction=laws.RegularisedCoulomb(mu, creep), spin=True)
    scene.bodies[0].angular_velocity = np.array([0.0, 0.0, begin])
    if slow:
        history = done(scene, 2.0 * T, 50)
        exact = begin * np.exp(-history.time / T)
        within = 1e-3  # of second order in steps of T/25
    else:
        slows = 3.0 * np.pi / 16.0 * mu * F * a / inertia
        history = done(scene, 0.5 * begin / slows, 10)
        exact, within = begin - slows * history.time, EXACT
    np.testing.assert_allclose(history.bodies["body"].angular_velocity[:, 2], exact, atol=within * begin)
    assert history.energy["friction"][-1] == pytest.approx(kinetic(history)[-1] - kinetic(history)[0], rel=1e-3)


def test_a_scene_without_moments_pays_nothing() -> None:
    """No places, and no launches."""
    plain, turning = Engine(on_floor(HERTZ, friction=CREEP)), Engine(on_floor(HERTZ, friction=CREEP, spin=True))
    names = [[launch.label for launch in e.graph.program.launches()] for e in (plain, turning)]
    assert [e.graph.program.sizes["lumped_moment"] for e in (plain, turning)] == [0, 1]
    assert not [name for name in names[0] if "moments" in name] and len(names[1]) == len(names[0]) + 2


def test_a_run_with_moments_goes_on_bit_for_bit() -> None:
    scene = rolling(
        on_floor(HERTZ, friction=CREEP, spin=True, rolling_resistance=laws.RollingHysteresis(0.1, 1.0)), 0.1
    )
    scene.bodies[0].angular_velocity = np.array([1.0, 10.0, 5.0])
    whole = run(scene, 2e-3, step=1e-4, progress=False)
    half = run(scene, 1e-3, step=1e-4, progress=False)
    rest = run(scene, 1e-3, step=1e-4, start=half, progress=False)
    for name in ("position", "rotation", "angular_velocity"):
        np.testing.assert_array_equal(getattr(rest.bodies["body"], name)[-1], getattr(whole.bodies["body"], name)[-1])
    assert np.all(whole.lumped_contacts["contact"].moment[-1] != 0.0)


def test_rest_says_that_rolling_resistance_does_not_act() -> None:
    scene = on_floor(LINE, friction=0.3, rolling_resistance=laws.RollingResistanceArm(LEVER, 1.0))
    found = find_equilibrium(scene)
    assert found.status == "completed", found.message
    assert "rolling resistance of 'contact' does not act in the equilibrium, which has no rolling" in found.notes
    with pytest.raises(InputError, match="rolling resistance of 'contact' holds nothing at rest"):
        find_equilibrium(scene, friction=True)


def test_a_static_run_says_that_rolling_resistance_does_not_act() -> None:
    scene = on_floor(LINE, friction=CREEP, rolling_resistance=laws.RollingResistanceArm(LEVER, 1.0))
    found = run_static(scene, 1.0, step=1.0, progress=False)
    assert found.status == "completed", found.message
    assert [note for note in found.notes if "has no rolling" in note] == [
        "rolling resistance of 'contact' does not act in a static run, which has no rolling"
    ]


def test_modes_of_a_roller_that_rolls_have_its_moment() -> None:
    """Creep f = -c (v - r w), c = mu F/v_slip, and the moment -s w, s = e F/w_r, which both act about a state of
    motion: (m v', J w') = -((c, -c r), (-c r, c r^2 + s)) (v, w). At rest neither acts."""
    lever, beyond, F = 2e-3, 2.5, MASS * GRAVITY  # rolls with 2 rad/s; its creep stays below the bound
    c, s = CREEP.coefficient * F / CREEP.slip_velocity, lever * F / beyond
    D = np.array([[c, -c * RADIUS], [-c * RADIUS, c * RADIUS**2 + s]])
    exact = np.linalg.eigvals(-D / np.array([[MASS], [TURN]]))

    def scene() -> Scene:
        return rolling(
            on_floor(LINE, friction=CREEP, rolling_resistance=laws.RollingResistanceArm(lever, beyond)), 0.02
        )

    for about in ("initial", done(scene(), 1e-4, 5)):
        found = find_modes(scene(), about=about)
        for value in exact:
            assert np.abs(found.eigenvalues - value).min() < SLOPES * abs(value)
        assert not any("does not act" in note for note in found.notes)
        assert any("rolling resistance of 'contact' damps small motions" in note for note in found.notes)
    assert exact.max() == pytest.approx(-s / (TURN + MASS * RADIUS**2), rel=1e-2)  # it rolls out
    resting = find_modes(scene())
    assert np.abs(np.real(resting.eigenvalues)).max() < 1e-9  # round-off of motions at 33 kHz
    assert "rolling resistance of 'contact' does not act in eigenmodes, which has no rolling" in resting.notes
