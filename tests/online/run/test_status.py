"""What the engine says when it cannot go on, and that one world's failure stays its own."""

from __future__ import annotations

import re

import numpy as np
import pytest

from scenes.rollers import PAIR, guided_pair, roller_body
from warpffrf.model import forces, joints, signals
from warpffrf.model.errors import InputError
from warpffrf.model.material import Material
from warpffrf.model.reduced.body import ReducedBody
from warpffrf.model.scene import Scene
from warpffrf.online import Engine, Settings, find_equilibrium, run
from warpffrf.online.device import chosen_device
from warpffrf.online.run import MESSAGES, coarser, describe
from warpffrf.online.start import static_equilibrium
from warpffrf.online.start.consistent import start_consistently
from warpffrf.online.start.static_equilibrium import settle
from warpffrf.online.step.graph import StepGraph
from warpffrf_kernels.core import control as k

LOAD = 200e3  # N: some columns of nodes


def stepping_engine(scene: Scene, worlds: int, step: float = 1e-4, steps: int = 20) -> Engine:
    """An engine in its static state, ready for `steps` dynamic steps."""
    engine = Engine(scene, worlds=worlds)
    assert settle(engine)
    engine.initial_rates()
    start_consistently(engine)
    engine.control(mode=int(k.DYNAMIC), step=0, sub=0, level=0, every=1, target=steps)
    engine.clock(user_step=step)
    return engine


@pytest.mark.parametrize("array", ["v", "q", "r", "pressure"])
def test_a_failing_world_does_not_stop_the_others(plain_body: ReducedBody, array: str) -> None:
    """NaN in one world's state: that world reports not_finite, the others do what they do alone, bit for bit."""
    scene = guided_pair(plain_body, plain_body, load=LOAD, speed=20.0)
    engine, alone = stepping_engine(scene, 3), stepping_engine(scene, 1)
    values = getattr(engine.state, array).numpy().copy()
    values[1].reshape(-1)[-1 if array != "pressure" else 0] = np.nan
    if array == "pressure":
        values[1] = np.nan
    getattr(engine.state, array).assign(values)
    for e in (engine, alone):
        e.replay(400)
    status = engine.word("status")
    assert list(status[[0, 2]]) == [0, 0] and list(engine.word("step")[[0, 2]]) == [20, 20]
    if array != "pressure":  # pressures are found anew in every step
        assert describe(int(status[1]), 0)[0] == "not_finite"
    r = engine.state.r.numpy()
    assert np.array_equal(r[0], alone.state.r.numpy()[0]) and np.array_equal(r[0], r[2])
    assert np.array_equal(engine.state.pressure.numpy()[0], alone.state.pressure.numpy()[0])


@pytest.mark.parametrize("peak", [1e8, 1e100, 1e290])
def test_a_load_beyond_all_bounds_is_reported_and_results_are_kept(plain_body: ReducedBody, peak: float) -> None:
    load = signals.Table([0.0, 1e-3, 2e-3, 3e-3], [LOAD, LOAD, peak, peak])
    scene = guided_pair(plain_body, plain_body, load=load, speed=20.0)
    history = run(scene, 3e-3, step=1e-4, start="equilibrium", progress=False)
    assert history.status in ("capacity", "not_finite", "not_converged") and history.message
    assert 11 <= len(history.time) <= 15
    assert all(np.all(np.isfinite(values)) for values in history.energy.values())


def test_a_window_too_small_is_named_with_the_number_it_needs(plain_body: ReducedBody) -> None:
    """The capacity in the message, given to the contact, is enough."""
    scene = guided_pair(plain_body, plain_body, load=2e6, speed=20.0)
    scene.contacts[0].capacity = 8
    failed = find_equilibrium(scene)
    assert failed.status == "capacity" and "raise capacity of the contact to >=" in failed.message
    for _ in range(4):
        number = int(failed.message.split(">=")[1].split()[0])
        assert number > scene.contacts[0].capacity
        scene.contacts[0].capacity = number
        failed = find_equilibrium(scene)
        if failed.status == "completed":
            break
    assert failed.status == "completed", failed.message
    wide = guided_pair(plain_body, plain_body, load=2e6, speed=20.0)
    wide.contacts[0].capacity = 2 * number
    reference = find_equilibrium(wide)
    assert np.allclose(failed.contacts[PAIR].force, reference.contacts[PAIR].force, rtol=1e-9)


def test_a_mechanism_without_load_path_is_named() -> None:
    scene = Scene(gravity=(0.0, 0.0, -9.81))
    scene.add_rigid_body(1.0, (0.1,) * 3, name="stone")
    try:
        rest = find_equilibrium(scene)
    except InputError as error:
        assert "'stone'" in str(error) and "no load path" in str(error)
    else:
        assert rest.status != "completed" and "stone" in rest.message and "load path" in rest.message


def test_a_sliding_body_without_spring_is_named() -> None:
    """A joint that leads to the ground but carries nothing along the guide."""
    scene = Scene(gravity=(0.0, 0.0, -9.81))
    slider = scene.add_rigid_body(1.0, (0.1,) * 3, name="slider")
    scene.add(joints.Prismatic(scene.ground, slider.at((0, 0, 0)), axis=(0, 0, 1)))
    rest = find_equilibrium(scene)
    assert rest.status != "completed" and "load path" in rest.message


@pytest.mark.parametrize("load, stiffness, status, said", [
    (1e3, 0.0, "not_converged", r"body '\w+' still moves by \S+ m, towards contact '.*', which is open; begin nearer"),
    (-1e3, 0.0, "no_equilibrium", "is free to .* drive it there.*no load path"),
    (1e3, 1e6, "not_converged", r"body '\w+' still moves by \S+ m, although that is resisted; begin nearer"),
])  # fmt: skip
def test_an_iteration_that_did_not_converge_is_no_mechanism(
    plain_body: ReducedBody, monkeypatch: pytest.MonkeyPatch, load: float, stiffness: float, status: str, said: str
) -> None:
    """Too few steps to close the gap below a roller, or to settle on its spring; without a spring, a load away from the
    other roller has no load path."""
    monkeypatch.setattr(static_equilibrium, "MOST_STEPS", 1)
    rest = find_equilibrium(guided_pair(plain_body, plain_body, load=load, stiffness=stiffness, gap=1e-3, gravity=0.0))
    assert rest.status == status and re.search(said, rest.message), rest.message
    assert ("no load path" in rest.message) == (status == "no_equilibrium")


def test_redundant_constraints_are_named_and_left_out() -> None:
    scene = Scene()
    door = scene.add_rigid_body(1.0, (0.1,) * 3, name="door")
    for name, z in (("upper hinge", 0.5), ("lower hinge", -0.5)):
        scene.add(joints.Revolute(scene.ground, door.at((0, 0, z)), axis=(0, 0, 1), name=name))
    assert "lower hinge" in str(scene.check())
    history = run(scene, 0.1, step=1e-3, progress=False)
    assert history.status == "completed"
    assert any("redundant" in note and "lower hinge" in note for note in history.notes)


@pytest.mark.parametrize("arguments, message", [
    ({"step": 0.0}, "step"), ({"step": -1e-3}, "step"), ({"step": 1e-3, "duration": 0.0}, "duration"),
    ({"step": 1.0, "duration": 0.1}, "longer than the duration"), ({"step": 1e-3, "save_every": 0}, "save_every"),
    ({"step": 1e-3, "device": "cuda:7"}, "not available"),
])  # fmt: skip
def test_wrong_arguments_are_refused(arguments: dict, message: str) -> None:
    scene = Scene()
    scene.add_rigid_body(1.0, (0.1,) * 3, name="body")
    with pytest.raises(InputError, match=message):
        run(scene, arguments.pop("duration", 0.1), progress=False, **arguments)


def test_an_empty_scene_is_refused() -> None:
    with pytest.raises(InputError, match="no bodies"):
        run(Scene(), 0.1, step=1e-3, progress=False)


def test_halved_steps_are_reported(plain_body: ReducedBody) -> None:
    """A hard landing at a long step that is to be accurate: it is halved, the run completes and its notes say so."""
    scene = guided_pair(plain_body, plain_body, load=0.0, stiffness=0.0, damping=0.0, gap=1e-3)
    history = run(scene, 0.02, step=1e-3, step_error=1e-6, progress=False)
    assert history.status == "completed"
    assert history.counters["rejected_steps"] > 0
    assert any("halved" in note for note in history.notes)
    assert len(history.time) == 21 and np.allclose(np.diff(history.time), 1e-3)  # user steps are kept


@pytest.mark.parametrize("middle", [7, 10])
def test_a_run_continues_bit_for_bit(plain_body: ReducedBody, middle: int) -> None:
    scene = guided_pair(plain_body, plain_body, load=LOAD, speed=40.0, ramp=1e-3)
    whole = run(scene, 20e-4, step=1e-4, start="equilibrium", progress=False)
    first = run(scene, middle * 1e-4, step=1e-4, start="equilibrium", progress=False)
    rest = run(scene, (20 - middle) * 1e-4, step=1e-4, start=first, progress=False)
    assert rest.status == "completed"
    assert rest.time[-1] == whole.time[-1]
    for name, values in whole.checkpoint.items():
        if name not in ("ctl", "clk"):
            assert np.array_equal(values, rest.checkpoint[name]), name
    assert np.array_equal(whole.contacts[PAIR].pressure[-1], rest.contacts[PAIR].pressure[-1])
    for line, values in whole.energy.items():
        assert values[-1] == rest.energy[line][-1], line


def test_saving_every_third_step_changes_nothing(plain_body: ReducedBody) -> None:
    scene = guided_pair(plain_body, plain_body, load=LOAD, speed=40.0, ramp=1e-3)
    every = run(scene, 12e-4, step=1e-4, start="equilibrium", progress=False)
    third = run(scene, 12e-4, step=1e-4, start="equilibrium", save_every=3, progress=False)
    assert np.array_equal(every.time[::3], third.time)
    assert np.array_equal(every.contacts[PAIR].force[::3], third.contacts[PAIR].force)


def test_a_ring_smaller_than_the_run_loses_no_row(plain_body: ReducedBody) -> None:
    scene = guided_pair(plain_body, plain_body, load=LOAD, speed=40.0, ramp=1e-3)
    small = run(scene, 30e-4, step=1e-4, start="equilibrium", progress=False, settings=Settings(ring_rows=5))
    large = run(scene, 30e-4, step=1e-4, start="equilibrium", progress=False)
    assert np.array_equal(small.time, large.time)
    assert np.array_equal(small.contacts[PAIR].force, large.contacts[PAIR].force)


def test_forces_at_interfaces_balance(plain_body: ReducedBody) -> None:
    """A point force on a flexible interface, held by a joint at the same interface: the reaction is its opposite."""
    scene = Scene()
    body = scene.add_body(plain_body, name="body")
    scene.add(joints.Fixed(scene.ground, body["bore"], name="clamp"))
    scene.add(forces.PointForce(body["bore"], (300.0, -200.0, 500.0)))
    rest = find_equilibrium(scene)
    assert rest.status == "completed", rest.message
    assert np.allclose(rest.joints["clamp"].force[-1], (-300.0, 200.0, -500.0), rtol=1e-8)


def test_every_failure_bit_has_a_message() -> None:
    """Bits are powers of two; UNDERFLOW only goes with another one."""
    names = ("NOT_CONVERGED", "CYCLING", "CAPACITY", "NOT_FINITE", "SINGULAR", "ENERGY", "INDEFINITE", "STENCIL",
             "STEP_ERROR", "ROOM", "GAIN", "PASSED", "LEAPT", "NOT_AT_REST", "TRACTIONS",
             "TOO_HOT")  # fmt: skip
    bits = {int(getattr(k, name)) for name in names}
    assert bits == {int(bit) for bit in MESSAGES}
    assert bits | {int(k.UNDERFLOW)} == {1 << i for i in range(len(names) + 1)}
    for bit in bits:
        status, message = describe(bit | int(k.UNDERFLOW), 40)
        assert status and "halved as often as allowed" in message and "{" not in message
    assert describe(int(k.UNDERFLOW), 0)[0] == "step_underflow"


def test_a_soft_body_starts() -> None:
    """Modes that follow their inertia alone at the tiny step of the start, pushed by a joint force only: balanced."""
    rubber = Material(1e6, 0.3, 1000.0)
    body = roller_body(24, layers=2, axial=1, max_frequency=60.0, material=rubber, cache=False)
    scene = Scene()
    free = scene.add_body(body, name="free")
    scene.add(forces.PointForce(free["bore"], (1.0, 2.0, 0.0)))
    history = run(scene, 1e-2, step=1e-3, progress=False)
    assert history.status == "completed", history.message
    center = history.bodies["free"].position[-1]
    assert np.allclose(center, 0.5e-4 * np.array([1.0, 2.0, 0.0]) / body.mass, rtol=1e-3, atol=1e-12)


def test_a_pressure_left_by_a_failed_attempt_does_not_end_the_run(plain_body: ReducedBody) -> None:
    """The active set of a rejected attempt is kept, but not what is not a number."""
    engine = stepping_engine(guided_pair(plain_body, plain_body, load=LOAD, speed=20.0), 1)
    pressure = engine.state.pressure.numpy().copy()
    pressure[0, 0, np.flatnonzero(engine.state.active.numpy()[0, 0])] = np.nan
    engine.state.pressure.assign(pressure)
    engine.replay(400)
    assert engine.word("status")[0] == 0 and engine.word("step")[0] == 20


def test_a_spring_obeys_its_law_in_every_accepted_state() -> None:
    """A mass swings past the anchor of an unstretched spring: force equals stiffness times stretch, also where the
    first linearisation sees no stretch at all."""
    stiffness, length = 1e3, 1.0
    scene = Scene()
    bob = scene.add_rigid_body(2.0, (0.1,) * 3, name="bob", position=(length, 0, 0), velocity=(0, 3.0, 0))
    scene.add(forces.SpringDamper(scene.ground.at((0, 0, 0)), bob.at((0, 0, 0)), stiffness, free_length=length))
    engine = Engine(scene)
    engine.initial_rates()
    start_consistently(engine)
    engine.control(mode=int(k.DYNAMIC), step=0, sub=0, level=0, every=1)
    engine.clock(user_step=1e-2)
    for step in range(1, 40):
        engine.control(target=step)
        engine.replay(40)
        force = engine.state.lam.numpy()[0, 0]
        stretch = np.linalg.norm(engine.state.r.numpy()[0, 0]) - length
        assert force == pytest.approx(stiffness * stretch, rel=1e-8, abs=1e-9)
    assert engine.word("status")[0] == 0


def test_ctrl_c_keeps_the_results_so_far(monkeypatch: pytest.MonkeyPatch) -> None:
    """The interrupt comes right after a chunk, before its rows are taken out of the ring: none is lost."""
    scene = Scene(gravity=(0.0, 0.0, -9.81))
    scene.add_rigid_body(1.0, (1.0, 1.0, 1.0), name="stone")
    launches = 0
    replay = StepGraph.replay

    def interrupted(graph: StepGraph, budget: int) -> float:
        nonlocal launches
        seconds = replay(graph, budget)
        launches += budget > 1  # chunks, not the start and what is saved in between
        if launches == 3:
            raise KeyboardInterrupt
        return seconds

    monkeypatch.setattr(StepGraph, "replay", interrupted)
    history = run(scene, 1000.0, step=1e-3, progress=False)
    assert history.status == "interrupted" and "kept" in history.message
    steps = len(history.time) - 1
    assert 0 < steps < 1_000_000 and steps == history.counters["steps"]
    assert history.bodies["stone"].position[-1, 2] == pytest.approx(-0.5 * 9.81 * history.time[-1] ** 2, rel=1e-9)


def test_a_duration_that_is_no_multiple_of_the_step_is_named() -> None:
    scene = Scene()
    scene.add_rigid_body(1.0, (1.0, 1.0, 1.0), name="stone")
    history = run(scene, 0.0104, step=1e-3, progress=False)
    assert history.time[-1] == pytest.approx(0.01)
    assert any("no multiple of the step: 10 steps" in note for note in history.notes)
    assert not any("multiple" in note for note in run(scene, 0.01, step=1e-3, progress=False).notes)


def test_the_usual_device_is_that_of_the_environment(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.delenv("WARPFFRF_DEVICE", raising=False)
    assert chosen_device(None) == "cpu"
    monkeypatch.setenv("WARPFFRF_DEVICE", "cuda:7")
    assert chosen_device("cpu") == "cpu"
    with pytest.raises(InputError, match=r"device 'cuda:7' \(WARPFFRF_DEVICE\) is not available here"):
        chosen_device(None)


def test_the_cure_of_a_grid_that_is_too_fine_is_that_of_its_kind(plain_body: ReducedBody) -> None:
    """ContactGrid(spacing=) coarsens the grid on a body, cells= those that travel with a patch."""
    engine = Engine(guided_pair(plain_body, plain_body, load=LOAD))
    assert coarser(engine) == "coarsen the contact grid, ContactGrid(spacing=)"
    engine.compiled.patches[0] = object()  # type: ignore[assignment]
    for bit in (k.INDEFINITE, k.CYCLING, k.ROOM):
        message = describe(int(bit), 9, coarser(engine))[1]
        assert "take fewer cells (cells= of the contact)" in message and "spacing" not in message
