"""A `Simulation` has the numbers of `simulate`, whichever way it is stepped, and those of its states."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import numpy as np
import pytest

import warpffrf as wf
from demos import ball_impact, journal_bearing, rolling_friction, slider_crank
from same_histories import steps_alone, unlike
from warpffrf.online import stepping
from warpffrf.output.files.table import quantity
from warpffrf.output.simulation import CONTROLLER

QUICK: dict[str, Any] = {"progress": False}
ROUNDED = 1e-12  # turns of an angle are added in another order


def rods() -> tuple[wf.Scene, float, int, dict[str, Any]]:
    return slider_crank.build(slider_crank.QUICK, **QUICK), slider_crank.STEP, 60, {}


def impact() -> tuple[wf.Scene, float, int, dict[str, Any]]:
    return ball_impact.build(ball_impact.FULL, **QUICK), ball_impact.DURATION / 40, 30, {}


def rolling() -> tuple[wf.Scene, float, int, dict[str, Any]]:
    size = rolling_friction.QUICK
    options = wf.RunOptions(save_every=4)
    return rolling_friction.build(size, **QUICK), size.step, 14, {"start": "equilibrium", "options": options}


def film() -> tuple[wf.Scene, float, int, dict[str, Any]]:
    step = np.radians(6.0) / journal_bearing.SPEED
    return journal_bearing.build(**QUICK), step, 16, {"start": "equilibrium"}


Case = Callable[[], tuple[wf.Scene, float, int, dict[str, Any]]]


@pytest.mark.parametrize("case", [rods, impact, rolling, film], ids=lambda case: case.__name__)
def test_steps_are_those_of_simulate(case: Case) -> None:
    """One by one, and in parts with a result in between: every array of the History, and its notes."""
    scene, step, count, options = case()
    whole = steps_alone(wf.simulate(scene, count * step, step=step, progress=False, **options).history)
    one = wf.Simulation(scene, step=step, **options)
    for _ in range(count):
        assert one.step() == wf.Status.COMPLETED
    assert one.time == whole.time[-1]
    assert unlike(steps_alone(one.result().history), whole) == []
    parts = wf.Simulation(scene, step=step, **options)
    parts.run((count // 3) * step)
    state = parts.state
    parts.result()
    parts.run((count - count // 3) * step)
    assert unlike(steps_alone(parts.result().history), whole) == []
    end = parts.state
    parts.state = state
    for _ in range(count - count // 3):
        parts.step()
    assert unlike(parts.state, end) == []


def rotor(torque: wf.signals.SignalLike) -> wf.Scene:
    """A rigid rotor of 0.2 kg m2 about y."""
    rig = wf.Scene()
    body = rig.add_rigid_body(1.0, (0.1, 0.2, 0.1), name="rotor")
    rig.add(wf.joints.Revolute(rig.ground, body, axis=(0, 1, 0), name="shaft"))
    rig.add(wf.forces.PointTorque(body, (torque, (0, 1, 0)), name="motor"))
    rig.add(wf.sensors.Velocity(body.at((0.1, 0, 0)), name="rim"))
    return rig


def test_state_has_inputs_and_controllers() -> None:
    """100 steps from a state, with a controller and changing inputs, twice: the same bits, also in another
    Simulation."""
    torque, load = wf.signals.Input("torque", 1.0), wf.signals.Input("load")
    rig = rotor(torque)
    rig.add(wf.forces.PointTorque(rig.body("rotor"), (load, (0, -1, 0)), name="load"))
    speed = "body_angular_velocity_y[rotor]"

    def begun() -> wf.Simulation:
        pid = wf.control.PID(speed, torque, reference=20.0, kp=2.0, ki=5.0, kd=0.01, filter_time=0.01, limits=(-4, 4))
        return wf.Simulation(rig, step=1e-3, controllers=[pid])

    def goes_on(sim: wf.Simulation) -> dict[str, np.ndarray]:
        for n in range(100):
            if n % 7 == 0:
                sim.inputs["load"] = 0.1 * n
            sim.step()
        return sim.state

    first = begun()
    first.run(0.03)
    state = first.state
    assert f"{CONTROLLER}0" in state
    end = goes_on(first)
    first.state = state
    assert unlike(goes_on(first), end) == []
    other = begun()
    other.state = state
    assert unlike(goes_on(other), end) == []
    assert len(other.result().time) == 101  # rows begin at the state


def test_outputs_are_those_of_the_result() -> None:
    """After every step, by sensor, by column and by history; a state has its own; save_every thins the rows alone."""
    torque = wf.signals.Input("torque", 3.0)
    names = ["rim", "sensor_z[rim]", "body_angular_velocity_y[rotor]", "body_position[rotor]", "joint_force[shaft]",
             "energy[kinetic]", "applied_torque_y[motor]", "joint_coordinate[shaft]"]  # fmt: skip
    sim = wf.Simulation(rotor(torque), step=2e-2, outputs=names, options=wf.RunOptions(save_every=7))
    seen: dict[str, list[Any]] = {name: [] for name in names}
    for n in range(40):
        for name in names:
            seen[name].append(sim.outputs[name])
        if n == 20:
            state, there = sim.state, [sim.outputs[name] for name in names]
        if n == 30:
            sim.result()
        sim.inputs["torque"] = 5.0 + float(np.cos(n))
        sim.step()
    fine = wf.Simulation(rotor(torque), step=2e-2)
    for n in range(40):
        fine.inputs["torque"] = 5.0 + float(np.cos(n))
        fine.step()
    result = fine.result()
    assert np.ptp(seen["joint_coordinate[shaft]"]) > 2.0  # rad
    for name in names:
        values = result.sensor("rim").values if name == "rim" else quantity(result, name).values
        np.testing.assert_allclose(np.array(seen[name]), values[:40], rtol=ROUNDED, atol=0.0, err_msg=name)
    kept = [*range(0, 40, 7), 40]
    assert np.array_equal(sim.result().time, result.time[kept])
    assert np.array_equal(sim.result().force("motor").torque, result.force("motor").torque[kept])
    assert list(sim.outputs) == names
    sim.state = state
    for name, value in zip(names, there, strict=True):
        assert np.array_equal(sim.outputs[name], value), name


def test_turns_are_counted() -> None:
    """The coordinate of a joint counts its revolutions, also where it is read late, and after a state."""
    sim = wf.Simulation(rotor(40.0), step=1e-2)  # 200 rad/s2
    sim.run(2.0)
    angle = sim.outputs["joint_coordinate[shaft]"]
    assert angle == pytest.approx(sim.result().joint("shaft").coordinate[-1], rel=ROUNDED)
    assert angle == pytest.approx(400.0, rel=1e-9)  # rad, of a constant acceleration, for which the method is exact
    state = sim.state
    sim.run(1.0)
    later = sim.outputs["joint_coordinate[shaft]"]
    sim.state = state
    assert sim.outputs["joint_coordinate[shaft]"] == pytest.approx(angle, rel=ROUNDED)
    for _ in range(100):
        sim.step()
    assert sim.outputs["joint_coordinate[shaft]"] == pytest.approx(later, rel=ROUNDED)


def test_goes_on_from_a_result() -> None:
    """From an earlier run with the values its inputs had, as simulate does."""
    torque = wf.signals.Input("torque", 1.0)
    rig = rotor(torque)
    sim = wf.Simulation(rig, step=1e-3)
    sim.inputs["torque"] = 5.0
    sim.run(0.05)
    begun = sim.result()
    sim.run(0.05)
    again = wf.Simulation(rig, step=1e-3, start=begun)
    assert again.inputs["torque"] == 5.0
    assert again.outputs["body_angular_velocity_y[rotor]"] == begun.body("rotor").angular_velocity[-1, 1]
    again.run(0.05)
    held = wf.simulate(rig, 0.05, step=1e-3, start=begun, progress=False)
    there = sim.result().body("rotor").angular_velocity[-1, 1]
    assert again.outputs["body_angular_velocity_y[rotor]"] == there == held.body("rotor").angular_velocity[-1, 1]
    assert np.all(held.force("motor").torque[:, 1] == 5.0)


def test_steps_on_another_device(monkeypatch: pytest.MonkeyPatch) -> None:
    """The words of a device that is not the host are copied: the same bits, rows and outputs."""
    torque = wf.signals.Input("torque", 1.0)
    ends = []
    for in_place in (True, False):
        monkeypatch.setattr(stepping, "replays_side_by_side", lambda _, here=in_place: here)
        sim = wf.Simulation(rotor(torque), step=1e-3, options=wf.RunOptions(save_every=3))
        for n in range(stepping.LOOK + 10):
            sim.inputs["torque"] = float(np.sin(n))
            sim.step()
        ends.append((sim.state, steps_alone(sim.result().history), sim.outputs["rim"], sim.time))
    assert unlike(ends[0], ends[1]) == []
