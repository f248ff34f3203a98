"""Springs that a stage replaces: the ledger stays closed, and the state keeps its meaning."""

from __future__ import annotations

import numpy as np
import pytest

import warpffrf as wf
from warpffrf.model import forces, joints
from warpffrf.online.stages import Stage

MASS, STIFFNESS, LENGTH = 2.0, 800.0, 0.5
ROUND_OFF = 1e-12  # of the energy at hand


def oscillator(**bushing: bool) -> wf.Scene:
    """A slider on a guide, pulled out, held by a spring; or by a bushing."""
    scene = wf.Scene(gravity=(0.0, 0.0, -9.81))
    slider = scene.add_rigid_body(MASS, (0.1, 0.1, 0.1), name="slider", position=(LENGTH + 0.1, 0.0, 0.0))
    scene.add(joints.Prismatic(scene.ground, slider.at((0, 0, 0)), axis=(1, 0, 0), name="guide"))
    scene.add(spring(scene, STIFFNESS, LENGTH))
    if bushing.get("bushing"):
        K = np.diag([300.0, 500.0, 500.0, 20.0, 20.0, 20.0])
        scene.add(forces.Bushing(scene.ground.at((0.6, 0, 0)), slider.at((0, 0, 0)), K, name="bushing"))
    return scene


def spring(scene: wf.Scene, stiffness: float, free_length: float) -> forces.SpringDamper:
    ports = scene.ground.at((0, 0, 0)), scene.body("slider").at((0, 0, 0))
    return forces.SpringDamper(*ports, stiffness, free_length=free_length, name="spring")


@pytest.mark.parametrize(("stiffness", "free_length"), [(3.0 * STIFFNESS, LENGTH), (STIFFNESS, LENGTH - 0.2)])
def test_a_spring_that_changes_is_booked_as_work(stiffness: float, free_length: float) -> None:
    """At the change the potential jumps by that of the new spring at the present length, and so does the work of
    forces; nothing else moves."""
    scene = oscillator(bushing=True)
    step = 2e-4
    stages = [
        Stage("soft", 0.1, step),
        Stage("changed", 0.1, step, {"forces": {"spring": spring(scene, stiffness, free_length)}}),
        Stage("back", 0.1, step),
    ]
    result = wf.simulate(scene, stages, progress=False)
    assert result.status == "completed"
    e, x = result.energy, result.body("slider").position[:, 0]
    scale = result.energy_scale
    jumps = []
    for at, (k0, l0), (k1, l1) in (
        (500, (STIFFNESS, LENGTH), (stiffness, free_length)),
        (1000, (stiffness, free_length), (STIFFNESS, LENGTH)),
    ):
        jump = 0.5 * k1 * (x[at] - l1) ** 2 - 0.5 * k0 * (x[at] - l0) ** 2
        jumps.append(jump)
        booked = e["force_work"][at + 1] - e["force_work"][at]
        assert booked == pytest.approx(jump, abs=ROUND_OFF * scale)
    assert abs(jumps[0]) > 0.05 * scale
    total = e["kinetic"] + e["potential"] - e["force_work"]
    assert np.abs(e["numerical"] - (total - total[0])).max() < ROUND_OFF * scale
    assert np.abs(e["numerical"]).max() < 2e-3 * scale


def test_a_stage_that_changes_nothing_is_the_run_in_one_go() -> None:
    scene = oscillator()
    whole = wf.simulate(scene, 0.02, step=1e-3, progress=False)
    same = {"forces": {"spring": spring(scene, STIFFNESS, LENGTH)}}
    stages = [Stage("one", 0.01, 1e-3), Stage("two", 0.01, 1e-3, same)]
    parts = wf.simulate(scene, stages, progress=False)
    assert np.array_equal(whole.body("slider").position, parts.body("slider").position)
    for line, values in whole.energy.items():
        assert np.array_equal(values, parts.energy[line]), line


def test_a_table_is_judged_by_the_stage_that_uses_it() -> None:
    scene = oscillator()
    port = scene.body("slider").at((0, 0, 0))
    table = wf.signals.Table([0.0, 0.015], [1.0, 2.0])
    scene.add(forces.PointForce(port, (table, 0.0, 0.0), name="push"))
    held = forces.PointForce(port, (2.0, 0.0, 0.0), name="held")
    stages = [Stage("one", 0.01, 1e-3), Stage("two", 0.01, 1e-3)]
    with pytest.raises(wf.InputError, match="'push': its signal covers 0 to 0.015 s, but 0.01 to 0.02 s"):
        wf.simulate(scene, stages, progress=False)
    stages[1] = Stage("two", 0.01, 1e-3, {"forces": {"push": held}})
    assert wf.simulate(scene, stages, progress=False).status == "completed"
