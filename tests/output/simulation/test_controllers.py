r"""Controllers compared with independent solutions of the same sampled loops.

The recursions are written out here for a PID with backward-free exact sampling: with the error e_n at the samples, the
integral grows by T e_n, the filter state by (1 - exp(-T/T_f)) (e_n - x_f). The command u_n is reached at the end of the
step that begins at the sample, linearly.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from typing import Any

import numpy as np
import pytest
from scipy.integrate import solve_ivp
from scipy.signal import cont2discrete, dlsim

import warpffrf as wf

INERTIA = 0.2  # kg m2
SPEED = "body_angular_velocity_y[rotor]"
EXACT = 1e-11  # round-off, over hundreds of steps of a loop that is stable


@dataclass
class Recursion:
    """A PID with the sample time `T` [s], `limits` and anti-windup."""

    kp: float
    ki: float
    kd: float
    filter_time: float
    T: float
    limits: tuple[float, float] = (-np.inf, np.inf)
    integral: float = 0.0
    filtered: float = 0.0

    def __call__(self, error: float) -> float:
        wanted = self.kp * error + self.ki * self.integral
        wanted += self.kd * (error - self.filtered) / self.filter_time
        found = min(max(wanted, self.limits[0]), self.limits[1])
        if (wanted - found) * error * self.ki <= 0.0:
            self.integral += self.T * error
        self.filtered += (1.0 - np.exp(-self.T / self.filter_time)) * (error - self.filtered)
        return found


def motor(torque: wf.signals.Input) -> wf.Scene:
    rig = wf.Scene()
    body = rig.add_rigid_body(1.0, (0.1, INERTIA, 0.1), name="rotor")
    rig.add(wf.joints.Revolute(rig.ground, body, axis=(0, 1, 0), name="shaft"))
    rig.add(wf.forces.PointTorque(body, (torque, (0, 1, 0)), name="motor"))
    return rig


GAINS = {"kp": 3.0, "ki": 20.0, "kd": 0.02, "filter_time": 0.02}
TRAPEZIA = wf.RunOptions(integrator=wf.integrators.Newmark())  # exact for a velocity under a piecewise linear torque


@pytest.mark.parametrize(("every", "limits"), [(1, None), (3, None), (2, (-5.0, 5.0))])
def test_speed_of_a_motor(every: int, limits: tuple[float, float] | None) -> None:
    """A speed controlled with and without limits, sampled every step and less often, compared with the exact solution
    of the sampled loop; the limits are reached, and the integral does not wind up."""
    step, steps = 2e-3, 600
    torque = wf.signals.Input("torque")
    pid = wf.control.PID(
        SPEED, torque, reference=wf.signals.Step(0.0, 10.0, at=0.051), every=every, limits=limits, **GAINS
    )
    sim = wf.Simulation(motor(torque), step=step, controllers=[pid], options=TRAPEZIA)
    sim.run(steps * step)
    law = Recursion(**GAINS, T=step * every, limits=limits or (-np.inf, np.inf))
    speeds, commands = [0.0], [0.0]
    for n in range(steps):
        command = law((10.0 if n * step >= 0.051 else 0.0) - speeds[-1]) if n % every == 0 else commands[-1]
        speeds.append(speeds[-1] + 0.5 * step * (commands[-1] + command) / INERTIA)
        commands.append(command)
    found = sim.result()
    assert np.abs(found.force("motor").torque[:, 1] - commands).max() <= EXACT * np.abs(commands).max()
    assert np.abs(found.body("rotor").angular_velocity[:, 1] - speeds).max() <= EXACT * 10.0
    if limits is not None:
        assert max(commands) == limits[1]
        assert max(speeds) < 12.0  # of 10 rad/s; with a wound-up integral it would be beyond 14


MASS, ARM, GRAVITY = 1.5, 0.4, 9.81


def pendulum(torque: wf.signals.Input) -> wf.Scene:
    """A point-like mass at an arm that hangs below its hinge, its inertia about the hinge MASS ARM^2 + 0.01."""
    rig = wf.Scene(gravity=(0, 0, -GRAVITY))
    body = rig.add_rigid_body(MASS, (0.01, 0.01, 0.01), name="bob", position=(0, 0, -ARM))
    rig.add(wf.joints.Revolute(rig.ground, body, axis=(0, 1, 0), point=(0, 0, 0), name="hinge"))
    rig.add(wf.forces.PointTorque(body, (torque, (0, 1, 0)), name="motor"))
    return rig


def swung(step: float, every: int, steps: int, law: Callable[[float], float], goal: wf.signals.Signal) -> np.ndarray:
    """Angles at the ends of steps by an explicit method of order 8, step by step between the kinks."""
    J = MASS * ARM**2 + 0.01
    y, angles, commands = np.zeros(2), [0.0], [0.0]
    for n in range(steps):
        before, after = commands[-1], law(float(goal(n * step)) - y[0]) if n % every == 0 else commands[-1]

        def rates(t: float, x: np.ndarray, a: float = before, b: float = after) -> list[float]:
            return [x[1], (a + (b - a) * t / step - MASS * GRAVITY * ARM * np.sin(x[0])) / J]

        y = solve_ivp(rates, (0.0, step), y, method="DOP853", rtol=1e-12, atol=1e-13).y[:, -1]
        angles.append(y[0])
        commands.append(after)
    return np.array(angles)


def test_angle_of_a_pendulum() -> None:
    """A pendulum that a PID swings to 1 rad in samples of 8 ms, compared with an integration of its equation of motion
    with the recursion above: the error falls with the square of the step, to less than 1e-6 rad."""
    sample, goal, duration = 8e-3, wf.signals.SmoothStep(0.0, 1.0, duration=0.3), 0.4
    gains: dict[str, Any] = {"kp": 30.0, "ki": 40.0, "kd": 4.0, "filter_time": 0.02}
    errors = []
    for every in (8, 16, 32):
        step, steps = sample / every, round(duration / sample) * every
        torque = wf.signals.Input("torque")
        pid = wf.control.PID("joint_coordinate[hinge]", torque, reference=goal, every=every, **gains)
        sim = wf.Simulation(pendulum(torque), step=step, controllers=[pid])
        sim.run(steps * step)
        angles = swung(step, every, steps, Recursion(**gains, T=sample), goal)
        errors.append(float(np.abs(sim.result().joint("hinge").coordinate - angles).max()))
    assert errors[1] < 0.35 * errors[0]
    assert errors[2] < 0.35 * errors[1]
    assert errors[2] < 1e-6


def test_blocks_are_their_discrete_forms() -> None:
    """A transfer function, a state space with two measures and a curve, driven by signals that the rotor does not
    influence: compared with scipy's simulation of the sampled system."""
    step, steps = 1e-2, 50
    names = ("lead", "both", "curve", "gain")
    inputs = [wf.signals.Input(name) for name in names]
    rig = wf.Scene()
    body = rig.add_rigid_body(1.0, (0.1, 0.2, 0.1), name="rotor")
    shaft = rig.add(wf.joints.Revolute(rig.ground, body, axis=(0, 1, 0), name="shaft"))
    rig.add(wf.joints.Drive(shaft, wf.signals.SmoothStep(0.0, 8.0, duration=0.3), quantity="velocity"))
    for one in inputs:
        rig.add(wf.forces.PointTorque(body, (one, (0, 1, 0)), name=one.name))
    angle = "joint_coordinate[shaft]"
    A, B, C, D = [[-3.0, 1.0], [0.0, -20.0]], [[1.0, 0.5], [0.0, 2.0]], [[1.0, 1.0]], [[0.0, 0.1]]
    sim = wf.Simulation(rig, step=step, controllers=[
        wf.control.TransferFunction([0.1, 1.0], [0.02, 1.0], measure=angle, target="lead"),
        wf.control.StateSpace(A, B, C, D, measures=[SPEED, angle], targets=["both"], references=[1.0, 0.0],
                              initial=[0.2, -0.1]),
        wf.control.Table([-1.0, 0.0, 0.5], [0.0, 1.0, 3.0], measure=angle, target="curve", reference=0.7),
        wf.control.TransferFunction([2.0], [4.0], measure=angle, target="gain"),
    ])  # fmt: skip
    sim.run(steps * step)
    found = sim.result()
    angles, speeds = found.joint("shaft").coordinate, found.body("rotor").angular_velocity[:, 1]
    torques = {name: found.force(name).torque[1:, 1] for name in names}

    def simulated(system: tuple[Any, ...], e: np.ndarray, x0: Any = None) -> np.ndarray:
        return dlsim(cont2discrete(tuple(np.atleast_2d(m) for m in system), step, method="zoh"), e, x0=x0)[1].ravel()

    lead = simulated(([[-50.0]], [[1.0]], [[50.0 - 250.0]], [[5.0]]), angles[:-1, None])
    assert torques["lead"] == pytest.approx(lead, rel=1e-9, abs=1e-12)
    both = simulated((A, B, C, D), np.stack([1.0 - speeds[:-1], -angles[:-1]], axis=1), x0=[0.2, -0.1])
    assert torques["both"] == pytest.approx(both, rel=1e-9, abs=1e-12)
    assert torques["curve"] == pytest.approx(np.interp(0.7 - angles[:-1], [-1.0, 0.0, 0.5], [0.0, 1.0, 3.0]), rel=1e-12)
    assert torques["gain"] == pytest.approx(0.5 * angles[:-1], rel=1e-12)


def test_a_function_before_every_step() -> None:
    """It is called after the controllers, and may set inputs: a bang-bang control."""
    torque, load = wf.signals.Input("torque"), wf.signals.Input("load")
    rig = motor(torque)
    rig.add(wf.forces.PointTorque(rig.body("rotor"), (load, (0, -1, 0)), name="load"))
    seen = []

    def switch(sim: wf.Simulation) -> None:
        seen.append((sim.time, sim.inputs["torque"]))
        sim.inputs["load"] = 1.0 if sim.outputs[SPEED] > 2.0 else 0.0

    gain = wf.control.Table([0.0, 1.0], [1.5, 1.5], measure=SPEED, target=torque)
    sim = wf.Simulation(rig, step=1e-2, controllers=[gain], before_step=switch)
    sim.run(0.5)
    assert [t for t, _ in seen] == pytest.approx(1e-2 * np.arange(50))
    assert all(value == 1.5 for _, value in seen)
    applied = sim.result().force("load").torque[:, 1]
    assert set(np.unique(applied)) == {-1.0, 0.0}
    assert sim.outputs[SPEED] == pytest.approx(2.0, abs=1.0)
