"""Static runs against closed forms and single equilibria: load cycles, large deflections, contact, snapping, and what a
run in time makes of them."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest
from film_scenes import bearing

import warpffrf as wf
from scenes.rollers import Path, guided_pair, prescribed_pair
from warpffrf.model import forces, joints, sensors
from warpffrf.model.errors import InputError
from warpffrf.model.material import Material
from warpffrf.model.mesh import box
from warpffrf.model.reduced.body import ReducedBody
from warpffrf.model.scene import Scene
from warpffrf.model.signals import Constant, Ramp, Table
from warpffrf.offline import ReductionOptions, reduce
from warpffrf.online.engine import Engine
from warpffrf.output.simulate import StagedResult
from warpffrf_kernels.core import control as k

LENGTH, WIDTH, HEIGHT, YOUNG, DENSITY = 1.0, 0.03, 0.01, 210e9, 7850.0  # m, Pa, kg/m3
MOST_ITERATIONS = 5  # of a load step: it takes 4, of Newton's method that converges quadratically
BENDING = YOUNG * WIDTH * HEIGHT**3 / 12.0  # N m2
BALANCED = 1e-8  # forces balance to 1e-9 of the largest one
ORIGIN = (0.0, 0.0, 0.0)


def cycle(amplitude: float) -> Table:
    """Up, down to the opposite, and up again, in 5 s."""
    return Table([0.0, 1.0, 3.0, 5.0], amplitude * np.array([0.0, 1.0, -1.0, 1.0]), hold=True)


def at(signal: Table, times: np.ndarray) -> np.ndarray:
    return np.interp(times, signal.times, signal.values)


@pytest.fixture(scope="module")
def beam() -> ReducedBody:
    """A bar along y, 20 modes."""
    return reduce(
        box((WIDTH, LENGTH, HEIGHT), (1, 24, 1), order=2), Material(YOUNG, 0.0, DENSITY),
        interfaces={"y_min": "rigid", "y_max": "rigid"}, modes=20, options=ReductionOptions(stiffening=True),
        progress=False,
    )  # fmt: skip


def cantilever(beam: ReducedBody, load: Any, *, stiffening: bool = False, spring: float = 0.0) -> Scene:
    """A force along z at its tip, which a spring to the ground above may hold as well."""
    scene = Scene(gravity=ORIGIN)
    bar = scene.add_body(beam, name="bar", position=(0.0, 0.5 * LENGTH, 0.0), stiffening=stiffening)
    scene.add(joints.Fixed(scene.ground, bar["y_min"], name="root"))
    scene.add(forces.PointForce(bar["y_max"], (0.0, 0.0, load), name="load"))
    if spring:
        top = scene.ground.at((0.0, LENGTH, 1.0))
        scene.add(forces.SpringDamper(top, bar["y_max"], stiffness=spring, damping=3.0, name="spring"))
    scene.add(sensors.Position(bar["y_max"], name="tip"))
    return scene


def static(scene: Scene, duration: float, step: float, **options: Any) -> wf.Result:
    found = wf.static(scene, duration, step=step, progress=False, **options)
    assert found.status == "completed", found.message
    return found


def tip(result: wf.Result) -> np.ndarray:
    """Displacement (T, 3) [m]."""
    return result.history.sensors["tip"].values - np.array([0.0, LENGTH, 0.0])


def test_a_load_cycle_of_a_beam_and_a_spring(beam: ReducedBody) -> None:
    """The tip follows the load in proportion at all steps, by the sum of both stiffnesses, 3 EI/L^3 of the beam but for
    its shear. The load is small: what turns do, of second order, is 1e-10 of the deflection."""
    load, spring = 0.05, 5e4
    own = load / tip(wf.equilibrium(cantilever(beam, load)))[-1, 2]
    assert own == pytest.approx(3.0 * BENDING / LENGTH**3, rel=1e-3)
    signal = cycle(load)
    result = static(cantilever(beam, signal, spring=spring), 5.0, 0.02)
    assert result.time == pytest.approx(0.02 * np.arange(251), abs=1e-12)
    expected = at(signal, result.time) / (own + spring)
    assert np.abs(tip(result)[:, 2] - expected).max() < BALANCED * load / own
    bar = result.history.bodies["bar"]
    for values in (bar.velocity, bar.angular_velocity, bar.acceleration, bar.modal_velocity):
        assert not np.any(values)
    work = 0.5 * at(signal, result.time) * expected
    assert np.abs(result.energy["force_work"] - work).max() < BALANCED * work.max()
    assert np.abs(result.energy["numerical"]).max() < BALANCED * work.max()
    assert not np.any(result.energy["damping"])


def test_a_large_deflection_is_the_equilibrium_of_each_load(beam: ReducedBody) -> None:
    signal = cycle(BENDING / LENGTH**2)
    result = static(cantilever(beam, signal, stiffening=True), 5.0, 0.1)
    for row in (3, 10, 18, 37, 50):
        alone = wf.equilibrium(cantilever(beam, float(at(signal, result.time[row])), stiffening=True))
        assert np.abs(tip(result)[row] - tip(alone)[0]).max() < BALANCED * LENGTH
    assert tip(result)[10, 2] == pytest.approx(0.301721, rel=6e-3)  # elastica, P L^2/EI = 1


@pytest.mark.parametrize(("load", "parts", "deflection"), [(2.0, 1, 0.493457), (2.0, 2, 0.493457), (4.0, 4, 0.669964)])
def test_the_elastica_is_found_at_once(load: float, parts: int, deflection: float) -> None:
    """A cantilever in several bodies, P L^2/EI = `load`; one body is a beam of quadratic bending, 1.5 % off by then."""
    part = reduce(
        box((WIDTH, LENGTH / parts, HEIGHT), (1, 24 // parts, 1), order=2), Material(YOUNG, 0.0, DENSITY),
        interfaces={"y_min": "rigid", "y_max": "rigid"}, modes=10, options=ReductionOptions(stiffening=True),
        progress=False,
    )  # fmt: skip
    scene = Scene(gravity=ORIGIN)
    port = scene.ground
    for i in range(parts):
        body = scene.add_body(part, name=f"{i}", position=(0.0, (i + 0.5) * LENGTH / parts, 0.0), stiffening=True)
        scene.add(joints.Fixed(port, body["y_min"]))
        port = body["y_max"]
    scene.add(forces.PointForce(port, (0.0, 0.0, load * BENDING / LENGTH**2)))
    scene.add(sensors.Position(port, name="tip"))
    scene.add(sensors.Position(scene.bodies[0]["y_min"], name="root"))
    found = wf.equilibrium(scene)
    assert found.status == "completed", found.message
    assert tip(found)[0, 2] == pytest.approx(deflection, rel=0.015 if parts == 1 else 2e-3)
    assert np.abs(found.history.sensors["root"].values).max() < 1e-12


def test_five_hundred_load_steps(beam: ReducedBody) -> None:
    """Each takes few iterations: the load path is smooth, and Newton begins at the equilibrium before."""
    result = static(cantilever(beam, cycle(BENDING / LENGTH**2), stiffening=True), 5.0, 0.01)
    assert result.history.counters["steps"] == 500
    assert result.history.iterations.max() <= MOST_ITERATIONS


def test_contact_pressed_by_a_drive_is_the_equilibrium_of_each_place(plain_body: ReducedBody) -> None:
    """Touch, press, lift off, and press again: no history."""
    approach = np.array([0.0, 5e-5, 1e-4, 2e-4, 1.2e-4, -2e-5, 1e-4])
    result = static(prescribed_pair(plain_body, plain_body, Path.of(approach)), 6.0, 1.0)
    (contact,) = result.history.contacts.values()
    for row, depth in enumerate(approach):
        (alone,) = wf.equilibrium(
            prescribed_pair(plain_body, plain_body, Path.of(depth))
        ).history.contacts.values()  # fmt: skip
        assert np.abs(contact.force[row] - alone.force[0]).max() < BALANCED * np.abs(contact.force).max()
        assert contact.pressure[row].max() == pytest.approx(alone.pressure[0].max(), rel=BALANCED, abs=1e-3)
    assert contact.force[5, 2] == 0.0 and abs(contact.force[3, 2]) > 1e5


def test_what_contact_leaves_free_stays_where_it_is(plain_body: ReducedBody) -> None:
    """Rollers free on their axles, pressed by a load that rises and falls."""
    load = Table([0.0, 5.0, 10.0], [20e3, 200e3, 50e3], hold=True)
    result = static(guided_pair(plain_body, plain_body, load=load), 10.0, 1.0)
    alone = wf.equilibrium(guided_pair(plain_body, plain_body, load=200e3))
    for name, body in result.history.bodies.items():
        assert np.abs(body.position[5] - alone.history.bodies[name].position[0]).max() < 1e-12
        assert np.abs(body.rotation - body.rotation[0]).max() < 1e-12
    assert any("free to turn" in note for note in result.history.notes)


def test_a_free_roller_that_a_load_turns_finds_no_equilibrium(plain_body: ReducedBody) -> None:
    """At rest under a load that presses alone; then a torque about its axle, which nothing answers, turns it."""
    scene = guided_pair(plain_body, plain_body, load=20e3)
    torque = Table([0.0, 1.0, 2.0], [0.0, 0.0, 10.0])
    scene.add(forces.PointTorque(scene.bodies[0]["bore"], (0.0, torque, 0.0), name="twist"))
    result = wf.static(scene, 2.0, step=0.5, progress=False)
    assert result.status == "no_equilibrium"
    assert "body 'lower'" in result.message
    assert result.time[-1] == pytest.approx(1.0)


def truss(load: Any, *, stiffness: float = 1e4, half: float = 1.0, rise: float = 0.2) -> Scene:
    """Two springs that lean against each other, with a load along z on their apex (von Mises)."""
    scene = Scene(gravity=ORIGIN)
    apex = scene.add_rigid_body(1.0, (0.01, 0.01, 0.01), name="apex", position=(0.0, 0.0, rise))
    scene.add(joints.Prismatic(scene.ground.at(ORIGIN), apex.at(ORIGIN), axis=(0, 0, 1), name="guide"))
    for x in (-half, half):
        spring = forces.SpringDamper(scene.ground.at((x, 0, 0)), apex.at(ORIGIN), stiffness=stiffness, damping=0.0)
        scene.add(spring)
    scene.add(forces.PointForce(apex.at(ORIGIN), (0.0, 0.0, load)))
    return scene


def test_a_truss_snaps_through_and_stays_there() -> None:
    stiffness, half, rise = 1e4, 1.0, 0.2

    def push(z: np.ndarray) -> np.ndarray:
        """Load along z that holds the apex at the height z."""
        return 2.0 * stiffness * (1.0 - np.hypot(half, rise) / np.hypot(half, z)) * z

    limit = push(np.linspace(0.0, rise, 10001)).min()
    signal = Table([0.0, 1.0, 2.0], [0.0, 2.0 * limit, 0.0], hold=True)
    result = static(truss(signal), 2.0, 0.02)
    z, load = result.history.bodies["apex"].position[:, 2], at(signal, result.time)
    assert np.abs(push(z) - load).max() < BALANCED * stiffness * (np.hypot(half, rise) - half)
    before = (result.time < 1.0) & (load > limit)
    assert np.all(z[before] > 0.0) and np.all(z[result.time > 0.55] < 0.0)
    assert z[-1] == pytest.approx(-rise, rel=BALANCED)
    assert any("has snapped" in note for note in result.history.notes)


def stop(push: Any) -> Scene:
    """A block on a guide, held by nothing but a spring that gives way: it goes slack at 20 mm."""
    scene = Scene(gravity=ORIGIN)
    block = scene.add_rigid_body(1.0, (0.01, 0.01, 0.01), name="block")
    guide = scene.add(joints.Prismatic(scene.ground.at(ORIGIN), block.at(ORIGIN), axis=(1, 0, 0), name="guide"))
    law = forces.ForceTable([(-1.0, -20.0), (-0.02, -20.0), (0.02, 20.0), (1.0, 20.0)])
    scene.add(forces.JointSpringDamper(guide, stiffness=law, name="spring"))
    scene.add(forces.PointForce(block.at(ORIGIN), (push, 0.0, 0.0), name="push"))
    return scene


def test_a_load_that_nothing_carries_is_named_when_it_comes() -> None:
    """Up to 20 N the spring carries the load, 1000 N/m; what was found until then is kept."""
    result = wf.static(stop(Ramp(0.0, 30.0, duration=3.0)), 3.0, step=0.1, progress=False)
    assert result.status == "no_equilibrium"
    assert "body 'block' does not come to rest" in result.message
    t = float(result.message.split("t = ")[1].split(" s")[0])
    assert 1.99 < t < 2.01
    assert 1.85 < result.time[-1] < 2.01
    x = result.history.joints["guide"].coordinate
    assert np.abs(x - 0.01 * result.time).max() < BALANCED * 0.02


def test_a_load_step_that_fails_is_halved(beam: ReducedBody) -> None:
    """In one step the tip is bent by more than Newton's method can follow; the end is the equilibrium all the same."""
    load = 12.0 * BENDING / LENGTH**2
    whole = static(cantilever(beam, Ramp(0.0, load, duration=1.0), stiffening=True), 1.0, 1.0)
    many = static(cantilever(beam, Ramp(0.0, load, duration=1.0), stiffening=True), 1.0, 0.02)
    assert whole.history.counters["rejected_steps"] > 0 and whole.history.counters["steps"] > 1
    assert len(whole.time) == 2
    assert np.abs(tip(whole)[-1] - tip(many)[-1]).max() < BALANCED * LENGTH
    assert any("halved" in note for note in whole.history.notes)


def test_a_drive_is_where_its_signal_says(beam: ReducedBody) -> None:
    """A prescribed displacement of the tip, and the reaction that it takes: 3 EI/L^3 times it."""
    signal = cycle(1e-4)
    scene = cantilever(beam, 0.0)
    head = scene.add_rigid_body(1.0, (0.01, 0.01, 0.01), name="head", position=(0.0, LENGTH, 0.0))
    scene.add(joints.Revolute(scene.bodies[0]["y_max"], head.at(ORIGIN), axis=(1, 0, 0), name="pin"))
    guide = joints.Prismatic(scene.ground.at((0.0, LENGTH, 0.0)), head.at(ORIGIN), axis=(0, 0, 1), name="guide")
    # the chord shortens with the square of the deflection: the head slides along the bar, too
    slide = scene.add_rigid_body(1.0, (0.01, 0.01, 0.01), name="slide", position=(0.0, LENGTH, 0.0))
    guide = scene.add(
        joints.Prismatic(scene.ground.at((0.0, LENGTH, 0.0)), slide.at(ORIGIN), axis=(0, 0, 1), name="guide")
    )
    scene.add(joints.Prismatic(slide.at(ORIGIN), head.at(ORIGIN), axis=(0, 1, 0), name="way"))
    scene.add(joints.Drive(guide, signal, quantity="position"))
    result = static(scene, 5.0, 0.1)
    expected = at(signal, result.time)
    assert np.abs(result.history.joints["guide"].coordinate - expected).max() < 1e-14
    assert np.abs(tip(result)[:, 2] - expected).max() < 1e-12
    force = result.history.joints["guide"].force[:, 2]
    stiffness = force[10] / expected[10]
    assert abs(stiffness) == pytest.approx(3.0 * BENDING / LENGTH**3, rel=1e-3)
    assert np.abs(force - stiffness * expected).max() < 1e-6 * np.abs(force).max()  # turns of the root, second order
    work = result.energy["drive_work"]
    assert np.abs(work - result.energy["strain"]).max() < 1e-6 * work.max()


def test_a_preloaded_beam_rings_when_it_is_let_go(beam: ReducedBody) -> None:
    """Stages: bent by a load at its tip, then without it. The first frequency is 1.875^2/(2 pi L^2) root(EI/rho A); the
    swing back is the deflection, but for what higher modes, 3 % of the deflection, do meanwhile."""
    period = 2.0 * np.pi / 1.875104**2 * LENGTH**2 * np.sqrt(DENSITY * WIDTH * HEIGHT / BENDING)
    scene = cantilever(beam, Ramp(0.0, 1.0, duration=1.0))
    none = forces.PointForce(scene.bodies[0]["y_max"], (0.0, 0.0, 0.0), name="load")
    stages = [
        wf.Stage("bend", 1.0, 0.1, kind="static"),
        wf.Stage("ring", 2.0 * period, period / 400, {"forces": {"load": none}}),
    ]
    result = wf.simulate(scene, stages, progress=False)
    assert result.status == "completed", result.message
    assert isinstance(result, StagedResult)
    bent, ringing = tip(result.stages["bend"])[-1, 2], tip(result.stages["ring"])[:, 2]
    at_half = ringing[np.abs(result.stages["ring"].time - 1.0 - 0.5 * period) < 0.1 * period].min()
    assert at_half == pytest.approx(-bent, rel=0.05)
    again = ringing[np.abs(result.stages["ring"].time - 1.0 - period) < 0.1 * period].max()
    assert again == pytest.approx(bent, rel=0.05)
    assert np.all(np.diff(result.time) > 0.0)  # no row stands twice
    total = result.energy["kinetic"] + result.energy["strain"]
    assert total[11:] == pytest.approx(total[10], rel=5e-3)  # what the integrator takes of the higher modes
    assert result.energy["force_work"][-1] == pytest.approx(total[10], rel=1e-6)


def test_a_run_in_time_under_the_same_loads_stays_at_rest(beam: ReducedBody) -> None:
    scene = cantilever(beam, Ramp(0.0, 500.0, duration=1.0), stiffening=True)
    held = wf.simulate(scene, 0.05, step=1e-4, start=static(scene, 1.0, 0.1), progress=False)
    assert held.status == "completed" and held.time[0] == pytest.approx(1.0001)
    moved = np.abs(tip(held) - tip(held)[0]).max(axis=0)
    assert np.all(moved[1:] < BALANCED * LENGTH)
    assert moved[0] < 1e-6 * LENGTH  # round-off sideways, which a bent beam lets grow


def test_a_static_run_gives_up_the_velocities_before_it(beam: ReducedBody) -> None:
    scene = cantilever(beam, Constant(1.0))
    stages = [wf.Stage("swing", 0.03, 1e-4), wf.Stage("rest", 0.5, 0.1, kind="static")]
    result = wf.simulate(scene, stages, progress=False)
    assert result.status == "completed", result.message
    assert isinstance(result, StagedResult)
    (note,) = [note for note in result.history.notes if "kinetic energy" in note]
    swing, rest = result.stages["swing"], result.stages["rest"]
    assert f"{swing.energy['kinetic'][-1]:.3g} J" in note
    assert np.abs(tip(rest) - tip(wf.equilibrium(scene))[0]).max() < BALANCED * LENGTH
    assert rest.energy["numerical"][0] < swing.energy["numerical"][-1]
    assert not np.any(rest.energy["kinetic"])


def test_a_static_run_goes_on_bit_for_bit(beam: ReducedBody) -> None:
    scene = cantilever(beam, cycle(BENDING / LENGTH**2), stiffening=True)
    whole = static(scene, 2.0, 0.05, options=wf.RunOptions(save_every=2))
    first = static(scene, 0.7, 0.05, options=wf.RunOptions(save_every=2))
    rest = static(scene, 1.3, 0.05, options=wf.RunOptions(save_every=2), start=first)
    for name, array in whole.history.checkpoint.items():
        if name not in ("ctl", "clk"):
            assert np.array_equal(array, rest.history.checkpoint[name]), name
    q = [r.history.bodies["bar"].modal for r in (whole, first, rest)]
    assert np.array_equal(q[0], np.concatenate([q[1], q[2]]))


def test_what_says_nothing_of_equilibria_is_refused(beam: ReducedBody) -> None:
    scene = cantilever(beam, 1.0)
    refused: dict[str, Any] = {
        "step_error": 1e-3,
        "integrator": wf.integrators.GeneralizedAlpha(),
        "energy_tolerance": 1e-3,
        "project_start": True,
    }
    for name, value in refused.items():
        with pytest.raises(InputError, match=f"static: {name} is for runs in time"):
            wf.static(scene, 1.0, step=0.1, options=wf.RunOptions(**{name: value}), progress=False)
    with pytest.raises(InputError, match="integrator"):
        wf.Stage("press", 1.0, 0.1, {"integrator": wf.integrators.GeneralizedAlpha()}, kind="static")
    with pytest.raises(InputError, match="'dynamic' or 'static'"):
        wf.Stage("press", 1.0, 0.1, kind="slow")


def test_an_interrupted_static_run_keeps_what_it_has(beam: ReducedBody, monkeypatch: pytest.MonkeyPatch) -> None:
    """Ctrl-C after some replays: rows up to there, from which it goes on."""
    scene = cantilever(beam, cycle(1.0))
    replay, calls = Engine.replay, []

    def interrupted(engine: Engine, attempts: int) -> float:
        seconds = replay(engine, attempts)
        if int(engine.word("mode")[0]) == int(k.LOADING) and engine.word("step")[0] > 0:
            calls.append(attempts)
        if len(calls) == 2:
            raise KeyboardInterrupt
        return seconds

    monkeypatch.setattr(Engine, "replay", interrupted)
    first = wf.static(scene, 5.0, step=1e-3, progress=False)
    monkeypatch.setattr(Engine, "replay", replay)
    assert first.status == "interrupted" and 4 < len(first.time) < 5001
    rest = static(scene, 5.0 - float(first.time[-1]), 1e-3, start=first)
    whole = static(scene, 5.0, 1e-3)
    # where it is interrupted depends on the machine, and the step of the rest, its duration over their number, is 1e-3
    # to round-off
    both, size = np.concatenate([tip(first), tip(rest)]), np.abs(tip(whole)).max()
    np.testing.assert_allclose(both, tip(whole), rtol=0.0, atol=1e-12 * size)


def test_the_budget_and_the_report_of_a_static_run(beam: ReducedBody) -> None:
    """Without friction nothing depends on the load steps, and no line refers to them."""
    result = static(cantilever(beam, cycle(1.0)), 5.0, 0.5)
    lines = result.error_budget()
    assert lines and not {line.source for line in lines} & {"time step", "energy ledger"}
    assert "energy residual" in result.report()


def test_films_are_refused() -> None:
    scene = bearing()
    with pytest.raises(InputError, match="carries by sliding and squeezing"):
        wf.static(scene, 1.0, step=0.1, progress=False)
