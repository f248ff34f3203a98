"""Inputs: values set between steps are reached at the end of the next one, as a Table through them would be."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

import warpffrf as wf

STEP = 1e-3  # s
STEPS = 40
EXACT = 1e-12  # round-off of the same numbers summed in another order
RNG = np.random.default_rng(5)
# NaN: not set before this step; not before the first one, where a table begins with its slope, an input without
JUMPS = np.where(np.arange(STEPS) % 3 == 1, RNG.uniform(-2.0, 2.0, STEPS), np.nan)
SMOOTH = np.where(np.arange(STEPS) > 0, 0.05 * (1.0 - np.cos(0.1 * np.arange(STEPS))), np.nan)  # rad


def held(initial: float, values: np.ndarray) -> np.ndarray:
    """Values at the ends of steps (STEPS + 1,) of an input that begins with `initial`."""
    found = [initial]
    for value in values:
        found.append(found[-1] if np.isnan(value) else value)
    return np.array(found)


def table(initial: float, values: np.ndarray = JUMPS) -> wf.signals.Table:
    """The same as a signal of time."""
    return wf.signals.Table(STEP * np.arange(STEPS + 1), held(initial, values), hold=True)


def stepped(scene: wf.Scene, values: np.ndarray, options: wf.RunOptions) -> wf.Result:
    sim = wf.Simulation(scene, step=STEP, options=options)
    for value in values:
        if not np.isnan(value):
            sim.inputs["u"] = value
        sim.step()
    return sim.result()


def rotor() -> tuple[wf.Scene, wf.joints.Joint]:
    rig = wf.Scene()
    body = rig.add_rigid_body(1.0, (0.1, 0.2, 0.1), name="rotor", position=(0, 0, 0))
    return rig, rig.add(wf.joints.Revolute(rig.ground, body, axis=(0, 1, 0), name="shaft"))


def forced(signal: wf.signals.Signal) -> wf.Scene:
    rig, _ = rotor()
    rig.add(wf.forces.PointTorque(rig.body("rotor"), (signal, (0, 2, 0)), name="motor"))
    rig.add(wf.forces.PointTorque(rig.body("rotor"), (0, signal, 0), name="second"))
    return rig


def driven(signal: wf.signals.Signal, quantity: str) -> wf.Scene:
    rig, shaft = rotor()
    rig.add(wf.joints.Drive(shaft, signal, quantity=quantity, name="motor"))  # type: ignore[arg-type]
    return rig


def sprung(signal: wf.signals.Signal) -> wf.Scene:
    rig = wf.Scene()
    body = rig.add_rigid_body(1.0, (0.1, 0.2, 0.1), name="rotor")
    guide = rig.add(wf.joints.Prismatic(rig.ground, body, axis=(1, 0, 0), name="guide"))
    rig.add(wf.forces.JointSpringDamper(guide, stiffness=1e3, damping=1.0, preload=signal, name="spring"))
    return rig


SCENES = {
    "force": (forced, 0.5, JUMPS),
    "velocity": (lambda s: driven(s, "velocity"), 0.5, JUMPS),
    "preload": (sprung, 0.5, JUMPS),
}


@pytest.mark.parametrize("kind", SCENES)
def test_inputs_are_tables_through_their_values(kind: str) -> None:
    """Of loads, drives and preloads; also in the forces and coordinates of the result."""
    build, initial, values = SCENES[kind]
    options = wf.RunOptions(project_start=True)
    found = stepped(build(wf.signals.Input("u", initial)), values, options).history
    scene = build(table(initial, values))
    known = wf.simulate(scene, STEPS * STEP, step=STEP, progress=False, options=options).history
    for name, force in known.forces.items():
        scale = np.abs(force.torque).max() + np.abs(force.force).max()
        assert np.abs(found.forces[name].torque - force.torque).max() <= EXACT * scale
        assert np.abs(found.forces[name].force - force.force).max() <= EXACT * scale
    for name, joint in known.joints.items():
        assert np.abs(found.joints[name].coordinate - joint.coordinate).max() <= EXACT
    for line in ("kinetic", "drive_work", "force_work"):
        scale = max(float(np.abs(values).max()) for values in known.energy.values())
        assert np.abs(found.energy[line] - known.energy[line]).max() <= 1e-9 * scale


def test_velocity_of_a_drive_is_integrated_exactly() -> None:
    """The angle of a shaft with a prescribed velocity: the sum of the trapezia, over several revolutions."""
    scene = driven(wf.signals.Input("speed", 2000.0), "velocity")
    sim = wf.Simulation(scene, step=STEP, options=wf.RunOptions(project_start=True))
    speeds = 2000.0 + 500.0 * RNG.uniform(-1.0, 1.0, STEPS)  # rad/s, 13 revolutions
    for speed in speeds:
        sim.inputs["speed"] = speed
        sim.step()
    ends = np.concatenate([[2000.0], speeds])
    angle = np.concatenate([[0.0], np.cumsum(0.5 * STEP * (ends[1:] + ends[:-1]))])
    assert np.abs(sim.result().joint("shaft").coordinate - angle).max() <= EXACT * angle[-1]
    assert sim.outputs["joint_coordinate[shaft]"] == pytest.approx(angle[-1], rel=EXACT)


def test_positions_are_met_at_the_ends_of_steps() -> None:
    """Samples of a smooth angle: the coordinate is exact, and the speed that of the angle to the order of the step."""
    found = stepped(driven(wf.signals.Input("u"), "position"), SMOOTH, wf.RunOptions())
    assert np.abs(found.joint("shaft").coordinate - held(0.0, SMOOTH)).max() <= EXACT
    speed = 0.05 * 0.1 / STEP * np.sin(0.1 * np.arange(STEPS))  # rad/s, up to 5
    late = slice(20, STEPS)  # the first samples have a jump of the acceleration
    assert np.abs(found.body("rotor").angular_velocity[1:, 1] - speed)[late].max() < 0.02


def test_halved_steps_find_the_ramp() -> None:
    """With steps that are all halved several times by their local error, the motion converges to that of the ramp,
    which a spring-mass system under a piecewise linear force has in closed form."""
    mass, stiffness = 1.0, 4e4
    force = wf.signals.Input("push")
    rig = wf.Scene()
    body = rig.add_rigid_body(mass, (0.1, 0.1, 0.1), name="mass")
    guide = rig.add(wf.joints.Prismatic(rig.ground, body, axis=(1, 0, 0), name="guide"))
    rig.add(wf.forces.JointSpringDamper(guide, stiffness=stiffness, name="spring"))
    rig.add(wf.forces.PointForce(body, (force, (1, 0, 0)), name="push"))
    step, w = 5e-3, np.sqrt(stiffness / mass)  # one radian a step
    sim = wf.Simulation(rig, step=step, options=wf.RunOptions(step_error=1e-11))
    x, v, last = 0.0, 0.0, 0.0
    for value in (100.0, -50.0, -50.0, 80.0):
        sim.inputs["push"] = value
        assert sim.step() == wf.Status.COMPLETED
        slope = (value - last) / step / stiffness
        x0, v0 = x - last / stiffness, v - slope
        c, s = np.cos(w * step), np.sin(w * step)
        x, v = x0 * c + v0 / w * s + value / stiffness, -x0 * w * s + v0 * c + slope
        last = value
    assert sim.result().history.counters["steps"] > 500
    assert sim.outputs["joint_coordinate[guide]"] == pytest.approx(x, abs=1e-6 * 100.0 / stiffness * 100)


def test_simulate_holds_the_initial_value() -> None:
    """In an equilibrium, and in a run, where it has the bits of the number itself."""
    rest = wf.equilibrium(sprung(wf.signals.Input("u", 3.0)), progress=False)
    assert rest.joint("guide").coordinate[0] == pytest.approx(-3.0 / 1e3, rel=1e-9)  # preload over stiffness
    constant = forced(wf.signals.Constant(0.5))
    both = [wf.simulate(s, 0.01, step=STEP, progress=False) for s in (forced(wf.signals.Input("u", 0.5)), constant)]
    assert np.array_equal(both[0].body("rotor").rotation, both[1].body("rotor").rotation)


def test_values_go_through_files(tmp_path: Path) -> None:
    """A results file keeps the values of inputs: a run continued from it has them."""
    rig = forced(wf.signals.Input("u", 0.5))
    sim = wf.Simulation(rig, step=STEP)
    sim.inputs["u"] = -1.5
    sim.run(5 * STEP)
    path = f"{tmp_path}/run.h5"
    sim.result().save(path)
    again = wf.Simulation(rig, step=STEP, start=path)
    assert again.inputs["u"] == -1.5
    again.run(5 * STEP)
    sim.run(5 * STEP)
    name = "body_angular_velocity_y[rotor]"
    assert again.outputs[name] == sim.outputs[name]


SCENE_FILE = """
[signals.push]
kind = "input"
name = "motor torque"
initial = 1.5
unit = "N m"

[bodies.rotor]
mass = 1.0
inertia_tensor = [0.1, 0.2, 0.1]

[joints.shaft]
kind = "revolute"
a = "ground"
b = "rotor"
axis = [0, 1, 0]

[forces.motor]
kind = "point_torque"
port = "rotor"
torque = ["push", [0, 1, 0]]

[forces.second]
kind = "point_torque"
port = "rotor"
torque = [0, "push", 0]
"""


def test_inputs_of_scene_files(tmp_path: Path) -> None:
    """One input by its name in two forces; twice 1.5 N m on 0.2 kg m2."""
    path = tmp_path / "rig.toml"
    path.write_text(SCENE_FILE, encoding="utf-8")
    sim = wf.Simulation(wf.load_scene(path).scene, step=STEP)
    assert dict(sim.inputs) == {"motor torque": 1.5} and sim.inputs.units == {"motor torque": "N m"}
    sim.run(0.1)
    assert sim.outputs["body_angular_velocity_y[rotor]"] == pytest.approx(1.5, rel=1e-9)
