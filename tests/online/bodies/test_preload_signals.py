"""A preload that changes with time draws the sides of the joint together by its signal, in addition to the spring."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import numpy as np
import pytest

import warpffrf as wf
from references.monolithic import results as monolithic

ORIGIN, AXIS = (0.0, 0.0, 0.0), (0.0, 0.0, 1.0)
MASS, STIFFNESS, DAMPING, PUSH = 2.0, 5000.0, 20.0, 40.0
RISE = wf.signals.SmoothStep(0.0, PUSH, duration=0.02)
SAME = 1e-6  # of the largest: the pull is a row whose softness the iteration takes back by a millionth a time


def scene(joint: type, force: str) -> wf.Scene:
    """A body on a joint along or about z with a spring: minus the signal as its preload, or the signal as a load."""
    made = wf.Scene()
    body = made.add_rigid_body(MASS, (MASS, MASS, MASS), name="body")
    held = made.add(joint(made.ground, body.at(ORIGIN), axis=AXIS, name="guide"))
    preload = RISE.scaled(-1.0) if force == "preload" else 0.0
    made.add(wf.forces.JointSpringDamper(held, STIFFNESS, DAMPING, preload=preload, name="spring"))
    if force == "load":
        load = wf.forces.PointForce if joint is wf.joints.Prismatic else wf.forces.PointTorque
        made.add(load(body.at(ORIGIN), (RISE, AXIS), name="load"))
    return made


@pytest.mark.parametrize("joint", [wf.joints.Prismatic, wf.joints.Revolute])
@pytest.mark.parametrize("simulate", [wf.simulate, monolithic.simulate], ids=["engine", "monolithic"])
def test_it_moves_as_a_load_does(joint: type, simulate: Callable[..., wf.Result]) -> None:
    integrator = wf.integrators.HHT(alpha=-0.3)
    chosen: dict[str, Any] = {"integrator": integrator}
    if simulate is wf.simulate:
        chosen = {"options": wf.RunOptions(**chosen)}
    runs = {}
    for force in ("preload", "load"):
        run = simulate(scene(joint, force), 0.05, step=5e-4, progress=False, **chosen)
        assert run.status == "completed"
        runs[force] = run
    moved = {force: run.joint("guide").coordinate for force, run in runs.items()}
    assert np.abs(moved["load"]).max() > 0.5 * PUSH / STIFFNESS
    np.testing.assert_allclose(moved["preload"], moved["load"], atol=SAME * np.abs(moved["load"]).max())
    part = "force" if joint is wf.joints.Prismatic else "torque"
    spring, load = (getattr(runs["load"].force(name), part) for name in ("spring", "load"))
    np.testing.assert_allclose(getattr(runs["preload"].force("spring"), part), spring + load, atol=SAME * PUSH)
    if simulate is wf.simulate:
        works = [run.energy["force_work"] for run in runs.values()]
        np.testing.assert_allclose(*works, atol=1e-5 * np.abs(works[1]).max())


def test_rest_and_hash() -> None:
    """At rest the preload is that of time 0, and a scene with another signal is another scene."""
    made = scene(wf.joints.Prismatic, "preload")
    made.forces[0].preload = wf.signals.Ramp(-PUSH, -2.0 * PUSH, duration=1.0)
    rest = wf.equilibrium(made)
    assert rest.joint("guide").coordinate[0] == pytest.approx(PUSH / STIFFNESS, rel=1e-6)
    assert made.content_hash() != scene(wf.joints.Prismatic, "preload").content_hash()


def test_a_stage_keeps_the_kind_of_preload() -> None:
    made = scene(wf.joints.Prismatic, "preload")
    constant = wf.forces.JointSpringDamper(made.joint("guide"), STIFFNESS, preload=PUSH)
    with pytest.raises(wf.InputError, match="its preload a number or a signal as before"):
        wf.Stage("a", 0.1, 0.01, {"forces": {"spring": constant}}).scene(made)
