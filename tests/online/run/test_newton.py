"""Convergence of the merged Newton iteration, seen in the residuals it records."""

from __future__ import annotations

import numpy as np
import pytest

from scenes.rollers import PAIR, Path, guided_pair, prescribed_pair
from warpffrf.model.reduced.body import ReducedBody
from warpffrf.online import Engine, Settings, run
from warpffrf.online.start.static_equilibrium import settle
from warpffrf_kernels.core import control as k

ROUND_OFF = 1e-10  # residuals below this are round-off of the joint equations
# the tangent leaves out how the grids' phases follow a tilt: then the tail is linear, with this factor at most
FIXED_PHASE = 0.02
# residual <= QUADRATIC * (residual before)^2: a turn of 0.03 rad in one step bends joint equations by its square, which
# is large compared with a penetration of 1e-4 m; measured 0.001 to 2300
QUADRATIC = 5e3


def residuals(engine: Engine) -> np.ndarray:
    """Residuals of the last attempt, one an iteration, from the second on (the first is not balanced)."""
    count = int(engine.word("iteration")[0])
    return engine.scratch.residual_history.numpy()[0, 1 : count + 1].copy()


def static(engine: Engine) -> None:
    engine.rates_to_zero()
    engine.static_step(1.0)


@pytest.mark.parametrize("case", ["deep", "tilted", "crowned"])
def test_residuals_fall_quadratically(plain_body: ReducedBody, crowned_body: ReducedBody, case: str) -> None:
    """One static step from the undeformed pose to a deep approach."""
    second = crowned_body if case == "crowned" else plain_body
    tilt = 2e-3 if case == "tilted" else 0.0
    approach = 400e-6 if case == "deep" else 200e-6
    path = Path.of([approach], 0.03, 0.02)
    settings = Settings(window_strain=0.2, residual_tolerance=ROUND_OFF)
    engine = Engine(prescribed_pair(plain_body, second, path, tilt=tilt), settings=settings)
    static(engine)
    assert engine.word("status")[0] == 0
    r = residuals(engine)
    print(f"{case}: " + " ".join(f"{x:.1e}" for x in r))
    assert len(r) <= 8 and r[-1] <= ROUND_OFF
    for before, after in zip(r[:-1], r[1:], strict=True):
        if after > ROUND_OFF:
            assert after < max(QUADRATIC * before**2, FIXED_PHASE * before if tilt else 0.0)


def test_steps_of_a_rolling_pair_take_few_iterations(plain_body: ReducedBody) -> None:
    """Mean at most 4, never more than 12, and the iterations of the rows add up to the counters."""
    for step in (1e-5, 1e-4, 1e-3):
        scene = guided_pair(plain_body, plain_body, load=300e3, speed=60.0, ramp=5e-3)
        history = run(scene, 50 * step, step=step, start="equilibrium", progress=False)
        assert history.status == "completed"
        assert history.counters["mean_iterations"] <= 4.0 and history.counters["max_iterations"] <= 12
        assert history.iterations[1:].sum() == pytest.approx(
            history.counters["mean_iterations"] * history.counters["steps"]
        )
        assert np.all(history.factorisations[1:] >= history.iterations[1:])


def test_balance_holds_to_the_promised_tolerance(plain_body: ReducedBody) -> None:
    """Equilibrium of a loaded pair: the joint below carries what the contact brings, to 1e-8 of the contact force."""
    scene = guided_pair(plain_body, plain_body, load=200e3, speed=20.0)
    history = run(scene, 1e-3, step=1e-3, start="equilibrium", progress=False)
    F = history.contacts[PAIR].force[0]
    weight = plain_body.mass * 9.81
    assert history.joints["axle"].force[0, 2] == pytest.approx(-F[2] + weight, rel=1e-8)


def test_one_change_at_a_time_finds_the_same_contact(plain_body: ReducedBody) -> None:
    """The safeguard from the first solve on: the same nodes and pressures, in more solves."""
    scene = guided_pair(plain_body, plain_body, load=200e3, speed=20.0)
    engines = [Engine(scene, settings=Settings(max_inner=n)) for n in (40, 0)]
    assert all(settle(engine) for engine in engines)
    free, guarded = (engine.state.pressure.numpy()[0] * engine.state.active.numpy()[0] for engine in engines)
    assert np.array_equal(free > 0.0, guarded > 0.0)
    assert np.abs(free - guarded).max() < 1e-8 * free.max()
    assert engines[1].word("pending_solves")[0] > engines[0].word("pending_solves")[0]


def test_cycling_and_too_few_iterations_are_reported(plain_body: ReducedBody) -> None:
    """With one correction of the set allowed, a landing of many nodes cannot settle: the status says so."""
    path = Path.of([300e-6], 0.03, 0.02)
    few = Settings(max_inner=1, max_guarded=0, window_strain=0.2)
    engine = Engine(prescribed_pair(plain_body, plain_body, path), settings=few)
    static(engine)
    assert int(engine.word("status")[0]) & int(k.CYCLING)
    engine = Engine(
        prescribed_pair(plain_body, plain_body, path), settings=Settings(max_iterations=1, window_strain=0.2)
    )
    static(engine)
    assert int(engine.word("status")[0]) & int(k.NOT_CONVERGED)
