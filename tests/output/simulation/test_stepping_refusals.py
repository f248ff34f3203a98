"""Wrong calls of a `Simulation` raise `InputError` with the thing and the cure, and leave it as it was."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest

import warpffrf as wf

SPEED = "body_angular_velocity_y[rotor]"


def rotor(torque: wf.signals.SignalLike) -> wf.Scene:
    rig = wf.Scene()
    body = rig.add_rigid_body(1.0, (0.1, 0.2, 0.1), name="rotor")
    rig.add(wf.joints.Revolute(rig.ground, body, axis=(0, 1, 0), name="shaft"))
    rig.add(wf.forces.PointTorque(body, (torque, (0, 1, 0)), name="motor"))
    rig.add(wf.sensors.Velocity(body, name="rim"))
    return rig


@pytest.fixture
def torque() -> wf.signals.Input:
    return wf.signals.Input("motor torque", 1.0)


@pytest.fixture
def sim(torque: wf.signals.Input) -> wf.Simulation:
    return wf.Simulation(rotor(torque), step=1e-3)


@pytest.mark.parametrize("value", [np.nan, np.inf, -np.inf, "3", None, True, [1.0, 2.0], 10**400])
def test_values_from_outside(sim: wf.Simulation, value: Any) -> None:
    with pytest.raises(wf.InputError, match="input 'motor torque' must be"):
        sim.inputs["motor torque"] = value
    assert sim.inputs["motor torque"] == 1.0
    assert sim.step() == wf.Status.COMPLETED


def test_unknown_names(sim: wf.Simulation, torque: wf.signals.Input) -> None:
    with pytest.raises(wf.InputError, match="input 'motor torqu' does not exist; did you mean 'motor torque'"):
        sim.inputs["motor torqu"] = 1.0
    with pytest.raises(wf.InputError, match="'load'"):
        wf.Simulation(rotor(torque), step=1e-3, inputs={"load": 1.0})
    with pytest.raises(wf.InputError, match="no quantity 'rin'"):
        _ = sim.outputs["rin"]
    with pytest.raises(wf.InputError, match="no quantity 'sensor_w"):
        wf.Simulation(rotor(torque), step=1e-3, outputs=["sensor_w[rim]"])
    with pytest.raises(wf.InputError, match="cannot be removed"):
        del sim.inputs["motor torque"]


@pytest.mark.parametrize("duration", [0.0, -1.0, np.nan, np.inf, 1e-4, 2.5e-3, "1"])
def test_durations(sim: wf.Simulation, duration: Any) -> None:
    with pytest.raises(wf.InputError, match=r"duration|step"):
        sim.run(duration)
    assert sim.time == 0.0


@pytest.mark.parametrize("step", [0.0, -1e-3, np.nan])
def test_steps(torque: wf.signals.Input, step: float) -> None:
    with pytest.raises(wf.InputError, match="Simulation: step"):
        wf.Simulation(rotor(torque), step=step)


def test_after_a_failure(torque: wf.signals.Input) -> None:
    """A step that fails returns its status; the next one raises; an earlier state goes on, with the bits it had."""
    sim = wf.Simulation(rotor(torque), step=1e-3)
    sim.run(5e-3)
    state = sim.state
    sim.run(5e-3)
    there = sim.outputs[SPEED]
    sim.inputs["motor torque"] = 1e305
    status = sim.step()
    assert status != wf.Status.COMPLETED
    assert sim.status == status
    assert sim.result().status == status
    assert sim.message
    for call in (sim.step, lambda: sim.run(1e-3)):
        with pytest.raises(wf.InputError, match="it has ended at t = 0.01 s"):
            call()
    sim.state = state
    assert sim.status == wf.Status.COMPLETED
    assert sim.inputs["motor torque"] == 1.0
    sim.run(5e-3)
    assert sim.outputs[SPEED] == there


def test_failed_starts(torque: wf.signals.Input) -> None:
    """A rotor that nothing holds has no equilibrium under a torque."""
    sim = wf.Simulation(rotor(torque), step=1e-3, start="equilibrium")
    assert sim.status == wf.Status.NO_EQUILIBRIUM
    for call in (sim.step, lambda: sim.state, lambda: sim.outputs[SPEED]):
        with pytest.raises(wf.InputError, match="equilibrium"):
            call()


def test_states_of_others(sim: wf.Simulation, torque: wf.signals.Input) -> None:
    """Of another scene, damaged, and with another controller: refused before anything changes."""
    sim.run(5e-3)
    state = sim.state
    two = rotor(torque)
    two.add_rigid_body(1.0, (0.1, 0.1, 0.1), name="second")
    wrong: list[Any] = [
        wf.Simulation(two, step=1e-3).state,
        state | {"v": np.full_like(state["v"], np.nan)},
        {name: array for name, array in state.items() if name != "omega"},
        {},
        None,
        b"state",
    ]
    for other in wrong:
        with pytest.raises(wf.InputError, match="state"):
            sim.state = other
    assert sim.time == pytest.approx(5e-3)
    pid = wf.control.PID(SPEED, torque, kp=1.0, ki=1.0)
    with pytest.raises(wf.InputError, match="other controllers"):
        wf.Simulation(rotor(torque), step=1e-3, controllers=[pid]).state = state


def test_beyond_the_end_of_a_signal(torque: wf.signals.Input) -> None:
    scene = rotor(torque)
    load = wf.signals.Table([0.0, 3e-3], [0.0, 1.0])
    scene.add(wf.forces.PointTorque(scene.body("rotor"), (load, (0, 1, 0)), name="load"))
    sim = wf.Simulation(scene, step=1e-3)
    with pytest.raises(wf.InputError, match="'load': its signal covers 0 to 0.003 s"):
        sim.run(4e-3)
    for _ in range(3):
        sim.step()
    with pytest.raises(wf.InputError, match="'load': its signal covers"):
        sim.step()


def test_a_reference_that_ends(torque: wf.signals.Input) -> None:
    pid = wf.control.PID(SPEED, torque, kp=1.0, reference=wf.signals.Table([0.0, 3e-3], [0.0, 1.0]))
    sim = wf.Simulation(rotor(torque), step=1e-3, controllers=[pid])
    assert sim.run(4e-3) == wf.Status.COMPLETED  # of the steps that begin at 0 to 3 ms
    with pytest.raises(wf.InputError, match="reference of a controller ends before t = 0.004 s"):
        sim.step()


def test_a_position_whose_velocity_jumps() -> None:
    """Steps up to the jump are made, as by `simulate`; the next one is refused, also after an earlier state."""
    scene = wf.Scene()
    body = scene.add_rigid_body(1.0, (0.1, 0.2, 0.1), name="rotor")
    shaft = scene.add(wf.joints.Revolute(scene.ground, body, axis=(0, 1, 0)))
    kinked = wf.signals.Table([0.0, 3e-3, 6e-3], [0.0, 0.0, 1e-3], hold=True)
    scene.add(wf.joints.Drive(shaft, kinked, quantity="position", name="push"))
    sim = wf.Simulation(scene, step=1e-3)
    begun = sim.state
    for _ in range(2):
        sim.run(3e-3)
        for take in (sim.step, lambda: sim.run(2e-3)):
            with pytest.raises(wf.InputError, match="'push': the prescribed position jumps in velocity .* t = 0.003 s"):
                take()
        assert sim.time == pytest.approx(3e-3)
        sim.state = begun


def test_two_inputs_of_one_name(torque: wf.signals.Input) -> None:
    scene = rotor(torque)
    other = wf.signals.Input("motor torque", 2.0)
    scene.add(wf.forces.PointTorque(scene.body("rotor"), (other, (0, 1, 0)), name="load"))
    with pytest.raises(wf.InputError, match="two different Inputs"):
        wf.Simulation(scene, step=1e-3)


def test_inputs_themselves(torque: wf.signals.Input) -> None:
    for name, initial in (("", 0.0), (3, 0.0), ("u", np.nan), ("u", "1")):
        with pytest.raises(wf.InputError, match="Input"):
            wf.signals.Input(name, initial)  # type: ignore[arg-type]
    with pytest.raises(wf.InputError, match="Harmonics: angle cannot depend on the Input 'motor torque'"):
        wf.signals.Harmonics((1.0,), angle=torque, duration=1.0)
    with pytest.raises(wf.InputError, match="cam: lift cannot depend on the Input"):
        wf.surfaces.cam(torque, base_radius=0.02)


def test_controllers_that_do_not_fit(torque: wf.signals.Input) -> None:
    PID, Space, Function, Table = (
        wf.control.PID, wf.control.StateSpace, wf.control.TransferFunction, wf.control.Table
    )  # fmt: skip
    one = {"measures": [SPEED], "targets": [torque]}
    cases: list[tuple[Any, str]] = [
        (lambda: PID(SPEED, torque, kd=1.0), "filter_time"),
        (lambda: PID(SPEED, torque, kp=np.nan), "PID: kp"),
        (lambda: PID(SPEED, torque, kp=1.0, limits=(1.0, -1.0)), "limits"),
        (lambda: PID(SPEED, 3.0, kp=1.0), "target"),  # pyright: ignore[reportArgumentType]
        (lambda: Space([[1.0, 0.0]], [[1.0]], [[1.0]], [[0.0]], **one), "A must be square"),
        (lambda: Space([[-1.0]], [[1.0, 1.0]], [[1.0]], [[0.0]], **one), "StateSpace: B"),
        (lambda: Space([], [], [], [[1.0]], references=[1.0, 2.0], **one), "2 references for 1 measures"),
        (lambda: Function([1.0, 0.0, 0.0], [1.0, 1.0], measure=SPEED, target=torque), "higher degree"),
        (lambda: Function([1.0], [0.0], measure=SPEED, target=torque), "higher degree|zero"),
        (lambda: Table([0.0, 0.0], [1.0, 2.0], measure=SPEED, target=torque), "errors"),
    ]
    for make, said in cases:
        with pytest.raises(wf.InputError, match=said):
            make()
    scene = rotor(torque)
    for controllers, said in (
        ([PID("rim", torque, kp=1.0)], "several components"),
        ([PID("spin", torque, kp=1.0)], "no quantity 'spin'"),
        ([PID(SPEED, "load", kp=1.0)], "'load'"),
        ([PID(SPEED, torque, kp=1.0)] * 2, "set by controller 0 already"),
        ([torque], "wf.control"),
    ):
        with pytest.raises(wf.InputError, match=said):
            wf.Simulation(scene, step=1e-3, controllers=controllers)  # type: ignore[arg-type]


def test_unstable_loops_are_named(torque: wf.signals.Input) -> None:
    """A loop that diverges ends with a status or with an InputError, never otherwise."""
    block = wf.control.StateSpace([[1e4]], [[1.0]], [[1e200]], [[0.0]], measures=[SPEED], targets=[torque])
    sim = wf.Simulation(rotor(torque), step=1e-3, controllers=[block])
    try:
        assert sim.run(0.1) != wf.Status.COMPLETED
    except wf.InputError as error:
        assert "NaN or infinite" in str(error)


def test_integrators_for_checks(torque: wf.signals.Input) -> None:
    with pytest.raises(wf.InputError, match="RungeKutta4 is for checks"):
        wf.Simulation(rotor(torque), step=1e-3, options=wf.RunOptions(integrator=wf.integrators.RungeKutta4()))
