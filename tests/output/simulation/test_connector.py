"""A `Connector`: trials of a step leave nothing behind, accepted steps are those of a Simulation; tangents."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest

import warpffrf as wf

STEP = 1e-3
STIFFNESS, DAMPING, MASS = 2e3, 5.0, 0.5
OUTPUTS = ["sensor_z[load]", "joint_force[guide]"]


def machine(name: str = "lift") -> wf.Scene:
    """A driven piston that carries a mass on a spring-damper along z."""
    rig = wf.Scene()
    piston = rig.add_rigid_body(1.0, (0.1, 0.1, 0.1), name="piston")
    load = rig.add_rigid_body(MASS, (0.1, 0.1, 0.1), name="load", position=(0, 0, 0.1))
    guide = rig.add(wf.joints.Prismatic(rig.ground, piston, axis=(0, 0, 1), name="guide"))
    rig.add(wf.joints.Drive(guide, wf.signals.Input(name, unit="m"), quantity="position", name="lift"))
    second = rig.add(wf.joints.Prismatic(piston, load, axis=(0, 0, 1), name="second"))
    rig.add(wf.forces.JointSpringDamper(second, stiffness=STIFFNESS, damping=DAMPING, name="spring"))
    rig.add(wf.sensors.Position(load, name="load"))
    return rig


def connector() -> wf.Connector:
    return wf.Connector(wf.Simulation(machine(), step=STEP), inputs=["lift"], outputs=OUTPUTS)


def test_accepted_steps_are_those_of_a_simulation() -> None:
    """With other trials and tangents between them: the same bits."""
    one, sim = connector(), wf.Simulation(machine(), step=STEP)
    assert one.outputs.shape == (4,)
    for n in range(20):
        lift = 1e-4 * np.sin(0.3 * (n + 1))
        first = one([lift])
        one([lift + 1e-3])
        one.tangent([lift], 1e-5)
        assert np.array_equal(one([lift]), first)
        if n % 2:
            one.tangent([lift], 1e-5)  # accepted is the last call, whatever was tried after it
        one.accept()
        sim.inputs["lift"] = lift
        sim.step()
        assert one.time == pytest.approx(sim.time)
        assert np.array_equal(one.outputs, np.concatenate([np.ravel(sim.outputs[name]) for name in OUTPUTS]))
        assert one.values == [lift]


def test_tangents_of_a_linear_machine() -> None:
    """Secants of any size are the tangent, and the mass follows as by the closed form of a step that it begins at rest:
    the first terms of its series in the step."""
    one = connector()
    rise = 1e-5
    tangent = one.tangent([0.0], rise)
    assert tangent.shape == (4, 1)
    secant = (one([3 * rise]) - one([0.0])) / (3 * rise)
    assert tangent[0, 0] == pytest.approx(secant[0], rel=1e-6)
    wn, share = np.sqrt(STIFFNESS / MASS), 1e-3  # of the spring-damper on a base that rises linearly
    z = DAMPING / (2.0 * MASS * wn)
    wd = wn * np.sqrt(1.0 - z * z)
    late = 50  # steps, of a ramp of this input
    for n in range(late):
        one([share * (n + 1) / late])
        one.accept()
    t, slope = late * STEP, share / (late * STEP)
    # x - y of a mass whose base moves with constant speed: that of a mass with an initial speed
    stretch = -slope / wd * np.exp(-z * wn * t) * np.sin(wd * t)
    assert one.outputs[0] == pytest.approx(0.1 + share + stretch, abs=2e-2 * share)


def test_wrong_calls() -> None:
    sim = wf.Simulation(machine(), step=STEP)
    made: list[tuple[Any, str]] = [
        (lambda: wf.Connector(sim, inputs=["lft"], outputs=OUTPUTS), "input 'lft' does not exist; did you mean 'lift'"),
        (lambda: wf.Connector(sim, inputs=["lift"], outputs=["load", "lod"]), "no quantity 'lod'"),
        (lambda: wf.Connector(sim, inputs="lift", outputs=OUTPUTS), "inputs must be a list"),
        (lambda: wf.Connector(sim, inputs=["lift"], outputs=[]), "outputs must be a list"),
        (lambda: wf.Connector(machine(), inputs=["lift"], outputs=OUTPUTS), "must be a Simulation"),  # type: ignore[arg-type]
        (lambda: connector().accept(), "no step to accept"),
        (lambda: connector()([np.nan]), "NaN or infinite"),
        (lambda: connector()([0.0, 1.0]), "must have shape"),
        (lambda: connector().tangent([0.0], 0.0), "changes must be positive"),
        (lambda: connector().tangent([0.0], np.nan), "changes must be positive"),
    ]
    for call, said in made:
        with pytest.raises(wf.InputError, match=said):
            call()


def test_a_trial_that_fails_can_be_followed_by_another() -> None:
    one, other = connector(), connector()
    one([1e-4])
    one.accept()
    other([1e-4])
    other.accept()
    with pytest.raises(wf.RunError, match="not_finite|not_converged"):
        one([1e200])
    assert np.array_equal(one([2e-4]), other([2e-4]))
