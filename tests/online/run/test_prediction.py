"""Where the iteration of a step starts: increments, pressures and tractions."""

from __future__ import annotations

import numpy as np
import pytest

from scenes.rollers import guided_pair, roller_body
from warpffrf.model.scene import Scene
from warpffrf.online import Engine, run
from warpffrf.online.checkpoint import restore

STEP = 1e-4  # s
STEPS = 30
EXACT = 1e-12  # of an increment: round-off of sums of three terms


def constant_acceleration(engine: Engine) -> np.ndarray:
    """Increments (bodies, 6) of constant acceleration in an attempt that has begun, by the equations of `motion`."""
    rule = engine.state.clk.numpy()[0]["retained"]  # of this attempt
    alpha_m, beta = float(rule["alpha_m"]), float(rule["beta"])
    found = []
    for name in ("v", "omega"):
        v = getattr(engine.state, name).numpy()[0]
        rate, a = (getattr(engine.scratch, name + tail).numpy()[0] for tail in ("_rate0", "_alg0"))
        end = (rate - alpha_m * a) / (1.0 - alpha_m)
        found.append(STEP * v + STEP**2 * ((0.5 - beta) * a + beta * end))
    return np.hstack(found)


def increments(engine: Engine) -> np.ndarray:
    return np.hstack([engine.scratch.dx.numpy()[0], engine.scratch.psi.numpy()[0]])


def begun(engine: Engine, phases: tuple[str, ...]) -> None:
    """Run the phases that begin an attempt."""
    engine.scratch.budget.assign(np.array([3], dtype=np.int32))
    engine.graph.program.run(("count", "begin", "predict", "remember", *phases))


def steps(scene: Scene, count: int) -> tuple[Engine, int]:
    """An engine after a number of steps."""
    start = run(scene, count * STEP, step=STEP, start="equilibrium", progress=False)
    assert start.status == "completed"
    engine = Engine(scene)
    done = restore(engine, start.checkpoint, STEP)
    engine.control(every=1)
    return engine, done


def test_free_fall_is_predicted_by_its_acceleration() -> None:
    scene = Scene(gravity=(0.0, 0.0, -9.81))
    scene.add_rigid_body(1.0, (1.0, 1.0, 1.0), name="stone", velocity=(1.0, 0.0, 0.0))
    start = run(scene, 5 * STEP, step=STEP, progress=False)
    engine = Engine(scene)
    done = restore(engine, start.checkpoint, STEP)
    engine.control(target=done + 1, every=1)
    begun(engine, ())
    expected = constant_acceleration(engine)
    assert engine.state.steady.numpy()[0, 0, 0] == 0
    assert np.abs(increments(engine) - expected).max() <= EXACT * np.abs(expected).max()


def test_rolling_is_predicted_by_what_predicted_the_last_step() -> None:
    """Either prediction is the one with the smaller error before, and both together err less than accelerations."""
    body = roller_body(480, layers=10, axial=2, grading=1.4, modes=4)
    engine, done = steps(guided_pair(body, body, load=100e3, speed=20.0, ramp=1e-3), 2 * STEPS)
    by_acceleration, chosen = [], []
    last = np.hstack([engine.state.v_mean.numpy()[0], engine.state.omega_mean.numpy()[0]])
    steady = engine.state.steady.numpy()[0].copy()
    for n in range(1, STEPS + 1):
        engine.control(target=done + n)
        begun(engine, ())
        plain, predicted = constant_acceleration(engine), increments(engine)
        expected = np.where(np.repeat(steady != 0, 3, axis=1), STEP * last, plain)
        assert np.abs(predicted - expected).max() <= EXACT * np.abs(expected).max()
        engine.replay(20)
        found = increments(engine)
        errors = [np.abs(guess - found).reshape(-1, 2, 3) for guess in (STEP * last, plain)]
        size = [np.linalg.norm(e, axis=2) for e in errors]
        steady = engine.state.steady.numpy()[0].copy()
        clear = np.abs(size[0] - size[1]) > EXACT * np.abs(found).max()
        assert np.array_equal((steady != 0)[clear], (size[0] < size[1])[clear])
        last = found / STEP
        by_acceleration.append(np.abs(plain - found)[:, 4].max())
        chosen.append(np.abs(predicted - found)[:, 4].max())
    assert np.mean(chosen) < np.mean(by_acceleration)


@pytest.mark.parametrize("cells", [(9, 7), (24, 18)], ids=["matrix", "no matrix"])
def test_pressures_and_tractions_continue_their_change(cells: tuple[int, int]) -> None:
    body = roller_body(80, layers=6, axial=4, modes=0, tangential=True, contact_fixed=True)
    scene = guided_pair(body, body, load=20e3, speed=20.0, ramp=1e-2, friction=0.3)
    scene.contacts[0].grid, scene.contacts[0].cells = "contact_fixed", cells
    engine, done = steps(scene, 12)
    engine.control(target=done + 2)
    engine.replay(20)
    state, scratch = engine.state, engine.scratch
    assert scratch.patch_steady.numpy()[0, 0] == 1 and scratch.traction_steady.numpy()[0, 0] == 1
    changes = [scratch.patch_change.numpy()[0, 0].copy(), scratch.traction_change.numpy()[0, 0].copy()]
    engine.control(target=done + 3)
    begun(engine, ("move", "load", "locate", "shift", "cells"))
    for name, change in zip(("pressure", "traction"), changes, strict=True):
        now, before = getattr(state, name).numpy()[0, 0], getattr(scratch, name + "_before").numpy()[0, 0]
        assert np.abs(change).max() > 0.0
        went_on = now[: len(change)] - before[: len(change)]
        assert np.abs(went_on - change).max() <= 1e-9 * np.abs(before).max(), name
