"""Runs at the pace of a clock, which here is one of the test: no test depends on that of the machine."""

from __future__ import annotations

import numpy as np
import pytest

import warpffrf as wf
from warpffrf.output.pace import Pace

STEP = 1e-3
TICK = 1e-4  # s, what a sleep is short of what was asked for


class Clock:
    """A clock that goes on by `costs` [s], one for each step, and by sleeping, which ends early once."""

    def __init__(self, costs: list[float]) -> None:
        self.now, self.costs, self.slept = 100.0, list(costs), 0.0

    def sleep(self, seconds: float) -> None:
        assert seconds > 0.0
        part = seconds if seconds <= TICK else seconds - 0.5 * TICK
        self.now += part
        self.slept += part

    def step(self, sim: wf.Simulation) -> None:
        self.now += self.costs.pop(0)


def rotor(clock: Clock, limit: float = 1.0) -> wf.Simulation:
    rig = wf.Scene()
    body = rig.add_rigid_body(1.0, (0.1, 0.2, 0.1), name="rotor")
    rig.add(wf.joints.Revolute(rig.ground, body, axis=(0, 1, 0), name="shaft"))
    load = wf.signals.Table([0.0, 5 * STEP, 6 * STEP, 1.0], [1.0, 1.0, limit, limit])
    rig.add(wf.forces.PointTorque(body, (load, (0, 1, 0)), name="load"))
    return wf.Simulation(rig, step=STEP, before_step=clock.step)


def test_late_steps_are_counted_and_made_up_for() -> None:
    """Deadlines are those of the begin: after a step that is late by 0.5 ms, one of 0.6 ms is late by 0.1 ms."""
    costs = [0.4e-3, 1.5e-3, 0.6e-3, 0.2e-3, 2.0e-3, 0.1e-3]
    clock = Clock(costs)
    sim = rotor(clock)
    assert sim.pace is None
    pace = Pace(clock=lambda: clock.now, sleep=clock.sleep)
    assert sim.run(6 * STEP, real_time=pace) == wf.Status.COMPLETED
    assert sim.pace is pace
    ready, late = 0.0, []
    for n, cost in enumerate(costs):
        ready = max(ready, n * STEP) + cost
        late.append(ready - (n + 1) * STEP)
    assert [lateness > 0.0 for lateness in late] == [False, True, True, False, True, True]
    assert pace.steps == 6
    assert pace.overruns == 4
    assert pace.worst == pytest.approx(max(late), rel=1e-9)
    assert pace.busy == pytest.approx(sum(costs), rel=1e-9)
    assert pace.load == pytest.approx(sum(costs) / (6 * STEP), rel=1e-9)
    assert "6 steps, 4 overruns, the worst 1 ms late, load 80 %" in str(pace)


def test_fast_steps_wait_and_have_the_numbers_of_others() -> None:
    clock, other = Clock([1e-5] * 20), Clock([0.0] * 20)
    sim, fast = rotor(clock), rotor(other)
    pace = Pace(clock=lambda: clock.now, sleep=clock.sleep)
    sim.run(20 * STEP, real_time=pace)
    fast.run(20 * STEP)
    assert pace.overruns == 0
    assert clock.now - 100.0 == pytest.approx(20 * STEP, rel=1e-9)
    assert clock.slept == pytest.approx(20 * (STEP - 1e-5), rel=1e-9)
    name = "body_angular_velocity_y[rotor]"
    assert np.array_equal(sim.outputs[name], fast.outputs[name])


def test_a_failure_ends_the_run() -> None:
    clock = Clock([0.0] * 10)
    sim = rotor(clock, limit=1e305)
    pace = Pace(clock=lambda: clock.now, sleep=clock.sleep)
    assert sim.run(10 * STEP, real_time=pace) != wf.Status.COMPLETED
    assert pace.steps == 6
    with pytest.raises(wf.InputError, match="it has ended"):
        sim.run(STEP, real_time=pace)


def test_the_clock_of_the_machine() -> None:
    """A run takes at least as long as it simulates; how late steps are is not looked at."""
    clock = Clock([0.0] * 5)
    sim = rotor(clock)
    sim.run(5 * STEP, real_time=True)
    assert sim.pace is not None
    assert sim.pace.steps == 5
    assert sim.pace.simulated == pytest.approx(5 * STEP)
    with pytest.raises(wf.InputError, match="real_time must be True or False"):
        sim.run(STEP, real_time=2.0)  # type: ignore[arg-type]
