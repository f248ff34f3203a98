"""The reference as a Result, compared with those of `warpffrf.simulate`."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np
import pytest

from references import monolithic
from references.monolithic import results
from scenes.rollers import PAIR, guided_pair, roller_body
from warpffrf.model import forces, joints, sensors, signals
from warpffrf.model.errors import InputError
from warpffrf.model.scene import Scene
from warpffrf.online import GeneralizedAlpha, LocalModes, RungeKutta4
from warpffrf.output.options import RunOptions
from warpffrf.output.result import Result
from warpffrf.output.simulate import simulate

SAME = {"integrator": GeneralizedAlpha(0.8), "progress": False}
OF_ENGINE: dict[str, Any] = {"options": RunOptions(integrator=GeneralizedAlpha(0.8)), "progress": False}
CLOSE = 1e-6  # of the largest value: the two stop their iterations at 1e-9 or so of the forces, ten steps


@pytest.fixture(scope="module")
def roller() -> Any:
    return roller_body(96, layers=4, axial=3, grading=1.6, order=1, max_frequency=15e3, cache=False)


def pressing(roller: Any, **more: Any) -> Scene:
    """Rollers pressed together while they begin to roll, with a sensor."""
    load = signals.SmoothStep(4e3, 8e3, duration=1e-3)
    scene = guided_pair(roller, roller, **{"load": load, "speed": 40.0, "ramp": 2e-3, **more})
    for body in scene.bodies:
        body.level = "constant"
    scene.add(sensors.Position(scene.bodies[1]["bore"], name="bore"))
    return scene


@pytest.fixture(scope="module")
def both(roller) -> tuple[Result, Result]:
    scene = pressing(roller)
    a = simulate(scene, 1e-3, step=1e-4, start="equilibrium", **OF_ENGINE)
    b = results.simulate(scene, 1e-3, step=1e-4, start="equilibrium", variant="low_rank", **SAME)
    assert a.status == b.status == "completed", a.message + b.message
    return a, b


def off(x: Any, y: Any) -> float:
    """Largest difference over the largest value."""
    x, y = np.asarray(x), np.asarray(y)
    return float(np.abs(x - y).max() / max(np.abs(x).max(), 1e-300))


def test_what_a_result_holds_is_that_of_the_separated_solver(both: tuple[Result, Result]) -> None:
    a, b = both
    assert off(a.time, b.time) < 1e-12
    for name in ("lower", "upper"):
        assert off(a.body(name).position, b.body(name).position) < CLOSE
        assert off(a.body(name).modal, b.body(name).modal) < CLOSE
    for name in a.history.joints:
        x, y = a.joint(name), b.joint(name)
        assert x.names == y.names
        assert off(x.coordinate, y.coordinate) < CLOSE
    guide = next(name for name, force in a.history.forces.items() if force.deformation.size)
    for name in a.history.forces:
        x, y = a.force(name), b.force(name)
        assert off(x.force, y.force) < 10.0 * CLOSE and x.deformation.shape == y.deformation.shape
    assert off(a.force(guide).deformation, b.force(guide).deformation) < CLOSE
    assert off(a.sensor("bore").values, b.sensor("bore").values) < CLOSE
    assert off(a.energy["strain"], b.energy["strain"]) < 10.0 * CLOSE
    assert np.all(np.isnan(b.energy["numerical"]))


def test_contact_pictures_are_those_of_the_separated_solver(both: tuple[Result, Result]) -> None:
    """Pressure windows, the load on the second surface and what is derived from them."""
    x, y = (result.contact(PAIR) for result in both)
    size = np.abs(x.force).max()
    assert np.abs(x.torque - y.torque).max() < 10.0 * CLOSE * size * 0.05  # m: the torque is none
    for name in ("force", "approach", "half_width", "peak_pressure", "line_load"):
        assert off(getattr(x, name), getattr(y, name)) < 10.0 * CLOSE, name
    assert np.array_equal(x.active_nodes, y.active_nodes)
    # the separated solver takes the second force from loads that it interpolates along the width
    assert off(x.force_second, y.force_second) < 1e-3
    assert off(y.force, -y.force_second) < 1e-9
    columns = x.history.center_column - y.history.center_column
    turn = x.view.first.grid.columns
    assert np.abs(columns - turn * np.round(columns / turn)).max() < 1e-6
    skins = [result.skins()["upper"] for result in both]
    assert off(skins[0].pressure(5), skins[1].pressure(5)) < 1e-3  # single-precision recovery, interpolated loads
    assert off(skins[0].displacement(5), skins[1].displacement(5)) < 1e-4


def test_it_reports_plots_saves_and_records(both: tuple[Result, Result], tmp_path: Path) -> None:
    import matplotlib

    matplotlib.use("Agg")
    from warpffrf.output.recording.recorder import record

    result = both[1]
    text = result.report()
    assert "works of forces" in text
    assert result.summary() is not None
    loaded = Result.load(result.save(tmp_path / "r.h5"))
    assert off(result.contact(PAIR).mean_pressure, loaded.contact(PAIR).mean_pressure) == 0.0
    assert record(result, tmp_path / "r.rrd").frames == len(result.time)


def test_pressures_of_nodes_add_up_to_the_force(roller) -> None:
    scene = pressing(roller, speed=None)
    result = results.simulate(scene, 2e-4, step=1e-4, start="equilibrium", law="nodes", progress=False)
    assert result.status == "completed"
    contact = result.contact(PAIR)
    surface = contact.view.first
    area = surface.grid.pitch * surface.gram_z.sum(axis=1)
    total = (contact.history.pressure * area).sum(axis=(1, 2))
    # pressures act along the normal, the force is their sum along the line of centres: a patch of some columns
    assert total == pytest.approx(contact.force_magnitude, rel=1e-6)
    assert contact.history.load_second.sum(axis=(1, 2)) == pytest.approx(total, rel=1e-12)


def falling() -> Scene:
    scene = Scene(gravity=(0, 0, -9.81))
    scene.add_rigid_body(1.0, (0.1, 0.1, 0.1), name="stone")
    return scene


@pytest.mark.parametrize(
    ("more", "word"),
    [
        ({"local": "exponential"}, "exponential"),
        ({"integrator": RungeKutta4()}, "alpha_m"),
        ({"integrator": GeneralizedAlpha(0.8, project_velocities=True)}, "project"),
    ],
)
def test_what_it_does_not_support_is_refused(more: dict[str, Any], word: str) -> None:
    with pytest.raises(InputError, match=word):
        results.simulate(falling(), 1.0, **{"step": 0.1, "progress": False, **more})


@pytest.mark.parametrize(
    ("more", "word"),
    [
        ({"variant": "fast"}, "variant"),
        ({"law": "points"}, "law"),
        ({"tolerance": -1.0}, "tolerance"),
        ({"law": "hats", "layer_stiffness": 1e12}, "no layer"),
    ],
)
def test_wrong_choices_are_refused(more: dict[str, Any], word: str) -> None:
    with pytest.raises(InputError, match=word):
        monolithic.run(falling(), 1.0, step=0.1, progress=False, **more)


def test_velocities_that_joints_contradict_are_refused_or_projected() -> None:
    scene = Scene()
    body = scene.add_rigid_body(1.0, (0.1, 0.1, 0.1), name="a", position=(1, 0, 0), velocity=(0.0, 0.0, 1.0))
    scene.add(joints.Revolute(scene.ground, body.at((-1.0, 0.0, 0.0)), axis=(0, 1, 0), name="pivot"))
    with pytest.raises(InputError, match="pivot"):
        results.simulate(scene, 0.1, step=0.05, progress=False)
    result = results.simulate(scene, 0.1, step=0.05, progress=False, project_start=True)
    # the least change in kinetic energy keeps the momentum about the pivot: m v L = (J + m L^2) omega
    assert np.abs(result.body("a").angular_velocity[0]) == pytest.approx([0.0, 1.0 / 1.1, 0.0])


def test_springs_and_bushings_are_recorded_alike() -> None:
    scene = Scene(gravity=(0.0, 0.0, -9.81))
    body = scene.add_rigid_body(1.0, (0.02, 0.03, 0.025), name="a", angular_velocity=(1.0, 2.0, 0.5))
    stiffness, damping = np.diag([2e3] * 3 + [20.0] * 3), np.diag([5.0] * 3 + [0.05] * 3)
    scene.add(forces.Bushing(scene.ground.at((0.1, 0.0, 0.0)), body.at((0.1, 0.0, 0.0)), stiffness, damping, name="b"))
    scene.add(forces.SpringDamper(scene.ground.at((0, 0, 1.0)), body.at((0.0, 0.1, 0.0)), 300.0, 1.0, name="s"))
    scene.add(forces.PointForce(body.at((0.0, 0.2, 0.0)), (1.0, 0.0, 0.0), frame="body", name="p"))
    scene.add(sensors.InterfaceForce(body.at((0.1, 0.0, 0.0)), name="felt"))
    a = simulate(scene, 0.05, step=1e-3, **OF_ENGINE)
    b = results.simulate(scene, 0.05, step=1e-3, **SAME)
    for name in ("b", "s", "p"):
        x, y = a.force(name), b.force(name)
        for field in ("force", "torque", "deformation"):
            if getattr(x, field).size:
                assert off(getattr(x, field), getattr(y, field)) < CLOSE, (name, field)
    assert off(a.sensor("felt").values, b.sensor("felt").values) < CLOSE


def test_dynamic_local_modes_are_named_in_the_notes() -> None:
    from warpffrf.model.material import Material
    from warpffrf.model.mesh import roller
    from warpffrf.model.surfaces import Cylinder
    from warpffrf.offline import ReductionOptions, reduce

    mesh = roller(0.05, 0.015, 0.02, sectors=48, layers=3, axial=2, grading=1.6, order=1)
    body = reduce(
        mesh, Material(210e9, 0.3, 7850.0), interfaces={"bore": "rigid"}, contact={"rim": Cylinder()}, modes=4,
        cache=False, progress=False, options=ReductionOptions(local_dynamics=True),
    )  # fmt: skip
    scene = pressing(body, speed=None)
    result = results.simulate(
        scene, 1e-6, step=1e-6, start="equilibrium", variant="low_rank", local=LocalModes("hht", count=10), **SAME
    )
    assert result.status == "completed"
    assert any("local modes are dynamic" in note for note in result.history.notes)
    assert any("not HHT of their own" in note for note in result.history.notes)
