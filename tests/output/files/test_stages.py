"""Runs in parts: stages, and continuing from a checkpoint, are bit for bit the run in one go."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest
from numpy.lib.recfunctions import drop_fields

import warpffrf as wf
from scenes.rollers import guided_pair, roller_body
from warpffrf.online import GeneralizedAlpha
from warpffrf.online.stages import Stage
from warpffrf.output.simulate import StagedResult, simulate

STEP = 1e-4
GRAVITY = (0.0, 0.0, -9.81)


@pytest.fixture(scope="module")
def rolling() -> wf.Scene:
    """Two flexible rollers that are pressed together and roll: contact, joints, drives, a force, a spring."""
    body = roller_body(120, layers=4, axial=3, grading=1.6, order=1, max_frequency=15e3, cache=False)
    return guided_pair(body, body, load=200e3, speed=20.0)


def falling(push: float = 0.0, name: str = "push") -> wf.Scene:
    """A rigid stone in free flight, with a constant force."""
    scene = wf.Scene(gravity=GRAVITY)
    stone = scene.add_rigid_body(2.0, (1, 2, 3), name="stone")
    scene.add(wf.forces.PointForce(stone.at((0, 0, 0)), (push, 0, 0), name=name))
    return scene


def assert_same_state(a: wf.Result, b: wf.Result) -> None:
    """Every array of the checkpoint, bit for bit, but for the number of rows that were saved on the way."""
    for name, array in a.history.checkpoint.items():
        other = b.history.checkpoint[name]
        if name == "ctl":
            array, other = (drop_fields(words, "saved") for words in (array, other))
        assert np.array_equal(array, other), name


def assert_same(a: wf.Result, b: wf.Result) -> None:
    """The state, and every row of `a` among those of `b`, bit for bit: `b` has more where its parts end."""
    assert_same_state(a, b)
    rows = np.isin(b.time, a.time)
    assert np.array_equal(a.time, b.time[rows])
    for name in a.history.contacts:
        assert np.array_equal(a.history.contacts[name].pressure, b.history.contacts[name].pressure[rows])
    for name, body in a.history.bodies.items():
        for field, array in vars(body).items():
            assert np.array_equal(array, getattr(b.history.bodies[name], field)[rows]), field
    assert all(np.array_equal(a.energy[k], b.energy[k][rows]) for k in a.energy)


@pytest.fixture(scope="module")
def whole(rolling: wf.Scene) -> wf.Result:
    return simulate(
        rolling, 20 * STEP, step=STEP, start="equilibrium", options=wf.RunOptions(save_every=2), progress=False
    )


def test_a_run_continued_from_its_file_is_the_run_in_one_go(
    rolling: wf.Scene, whole: wf.Result, tmp_path: Path
) -> None:
    for steps in (1, 7):  # 7: between two saved rows
        first = simulate(
            rolling, steps * STEP, step=STEP, start="equilibrium", options=wf.RunOptions(save_every=2), progress=False
        )
        file = first.save(tmp_path / f"first{steps}.h5")
        rest = simulate(
            rolling, (20 - steps) * STEP, step=STEP, start=file, options=wf.RunOptions(save_every=2), progress=False
        )
        assert_same_state(whole, rest)
        assert first.time[-1] == pytest.approx(steps * STEP, rel=1e-12)
        assert np.array_equal(np.concatenate([first.time[:-1], rest.time]), whole.time)


def test_stages_with_one_step_are_the_run_in_one_go(rolling: wf.Scene, whole: wf.Result, tmp_path: Path) -> None:
    stages = [Stage("press", 3 * STEP, STEP), Stage("turn", 10 * STEP, STEP), Stage("roll", 7 * STEP, STEP)]
    file = tmp_path / "run.h5"
    result = simulate(
        rolling, stages, start="equilibrium", options=wf.RunOptions(save_every=2), results=file, progress=False
    )
    assert isinstance(result, StagedResult) and list(result.stages) == ["press", "turn", "roll"]
    assert_same(whole, result)
    assert result.history.counters["steps"] == whole.history.counters["steps"] == 20
    again = simulate(
        rolling,
        7 * STEP,
        step=STEP,
        start=tmp_path / "run.turn.h5",
        options=wf.RunOptions(save_every=2),
        progress=False,
    )
    assert_same(result.stages["roll"], again)
    assert np.array_equal(wf.Result.load(file).time, result.time)
    assert np.setdiff1d(result.time, whole.time) == pytest.approx([3 * STEP, 13 * STEP])  # the ends of stages


def test_an_equilibrium_is_continued_as_a_start_in_equilibrium(rolling: wf.Scene, whole: wf.Result) -> None:
    rest = wf.equilibrium(rolling)
    assert_same(
        whole, simulate(rolling, 20 * STEP, step=STEP, start=rest, options=wf.RunOptions(save_every=2), progress=False)
    )


def test_a_stage_has_its_own_step_and_options() -> None:
    stages = [Stage("fine", 0.01, 1e-3), Stage("coarse", 0.02, 2e-3, {"save_every": 5})]
    result = simulate(falling(), stages, progress=False)
    assert result.time == pytest.approx([*np.linspace(0.0, 0.01, 11), 0.02, 0.03])
    z = result.body("stone").position[:, 2]  # generalized-alpha is exact for a constant force
    assert z == pytest.approx(-0.5 * 9.81 * result.time**2, abs=1e-12)


def test_loads_of_a_stage_act_in_it_alone() -> None:
    """m x'' = F(t): 4 N, then 10 N with gravity off, then 4 N again, from rest."""
    scene = falling(4.0)
    stone = scene.body("stone")
    strong = wf.forces.PointForce(stone.at((0, 0, 0)), (10.0, 0, 0))
    change = {"gravity": (0, 0, 0), "forces": {"push": strong}, "integrator": GeneralizedAlpha(1.0)}
    stages = [Stage("one", 0.1, 1e-4), Stage("two", 0.1, 1e-4, change), Stage("three", 0.1, 1e-4)]
    result = simulate(scene, stages, progress=False)
    v = result.body("stone").velocity
    at = [int(np.argmin(np.abs(result.time - t))) for t in (0.1, 0.2, 0.3)]
    # a load that jumps costs one step of its acceleration at most
    assert v[at, 0] == pytest.approx(np.cumsum([0.2, 0.5, 0.2]), abs=10.0 / 2.0 * 1e-4)
    assert v[at, 2] == pytest.approx([-0.981, -0.981, -1.962], abs=2 * 9.81 * 1e-4)
    assert scene.gravity == pytest.approx(GRAVITY) and scene.forces[0].components[0](0.0) == 4.0
    # the end belongs to the scene, whatever the stages did
    assert simulate(scene, 1e-3, step=1e-4, start=result, progress=False).status == "completed"


def test_a_stage_that_fails_ends_the_run_and_keeps_what_there_is() -> None:
    scene = falling()
    endless = wf.forces.PointForce(scene.body("stone").at((0, 0, 0)), (1e308, 0, 0))
    stages = [Stage("good", 0.01, 1e-3), Stage("bad", 0.01, 1e-3, {"forces": {"push": endless}}), Stage("no", 1, 1e-3)]
    result = simulate(scene, stages, progress=False)
    assert isinstance(result, StagedResult) and list(result.stages) == ["good", "bad"]
    assert result.status != "completed" and result.message.startswith("stage 'bad': ")
    assert result.time[:11] == pytest.approx(np.linspace(0.0, 0.01, 11))


def test_wrong_stages_are_refused() -> None:
    scene, one = falling(), Stage("one", 1e-2, 1e-3)
    stone = scene.body("stone")
    spring = wf.forces.SpringDamper(stone.at((0, 0, 0)), scene.ground.at((0, 0, 1)), 1.0)
    elsewhere = wf.forces.PointForce(stone.at((0, 0, 1)), (1, 0, 0))
    for stages, said in [
        ([], "at least one"),
        ("one", "or a list of Stage"),
        ([one, one], "two stages are called 'one'"),
        ([Stage("x", 1, 1, {"forces": {"pull": spring}})], "'pull' does not exist; known: 'push'"),
        ([Stage("x", 1, 1, {"forces": {"push": spring}})], "only be replaced by one of that kind"),
        ([Stage("x", 1, 1, {"forces": {"push": elsewhere}})], "only be replaced by one of that kind"),
        ([Stage("x", 1, 1, {"gravity": (0, 0)})], "gravity must have shape"),
        ([Stage("x", 1, 1, {"local_modes": "guess"})], "local_modes 'guess' does not exist"),
    ]:
        with pytest.raises(wf.InputError, match=said):
            simulate(scene, stages, progress=False)  # pyright: ignore[reportArgumentType]
    for arguments, said in [
        (("", 1, 1), "non-empty"),
        (("x", 0, 1), "duration must be greater"),
        (("x", 1, -1), "step must be greater"),
        (("x", 1, 1, {"joints": {}}), "override 'joints' does not exist"),
    ]:
        with pytest.raises(wf.InputError, match=said):
            Stage(*arguments)
    for options, said in [
        ({"duration": 1.0}, "give step, or accuracy=, or a list of Stage"),
        ({"duration": one, "step": 1e-3}, "or a list of Stage"),
        ({"duration": [one], "step": 1e-3}, "leave that of the run out"),
        ({"duration": [one], "start": "there.h5"}, "does not exist"),
    ]:
        with pytest.raises(wf.InputError, match=said):
            simulate(scene, **options)


def test_a_checkpoint_of_another_scene_or_damaged_is_refused() -> None:
    scene = falling()
    result = simulate(scene, 1e-2, step=1e-3, progress=False)
    with pytest.raises(wf.InputError, match="result of another scene"):
        simulate(falling(3.0), 1e-2, step=1e-3, start=result, progress=False)
    checkpoint = dict(result.history.checkpoint)
    damaged = checkpoint["clk"].copy()
    damaged["time"] = np.nan
    for damage, said in [
        ({}, "no checkpoint"),
        ({k: v for k, v in checkpoint.items() if k != "lam"}, "lacks lam"),
        ({**checkpoint, "r": checkpoint["r"][:, :0]}, "r of the checkpoint is"),
        ({k: v for k, v in checkpoint.items() if "_rate" not in k}, "RungeKutta4 or EnergyMomentum"),
        ({**checkpoint, "clk": damaged}, "it is damaged"),
    ]:
        result.history.checkpoint = damage
        with pytest.raises(wf.InputError, match=said):
            simulate(scene, 1e-2, step=1e-3, start=result, progress=False)


def test_gravity_that_changes_between_stages_leaves_the_ledger_closed() -> None:
    """The jump of the potential is work of forces; the checkpoint left behind is that of the scene's own gravity."""
    scene = falling(4.0)
    scene.body("stone").position = (0.0, 0.0, 3.0)
    stages = [Stage("one", 0.1, 1e-3), Stage("two", 0.1, 1e-3, {"gravity": (0, 0, -1.0)}), Stage("three", 0.1, 1e-3)]
    result = simulate(scene, stages, progress=False)
    assert isinstance(result, StagedResult)
    more = simulate(scene, 0.1, step=1e-3, start=result.stages["two"], progress=False)
    assert more.energy["potential"][-1] == result.energy["potential"][-1]
    z = result.body("stone").position[:, 2]
    size = 2.0 * 9.81 * 3.0
    assert result.energy["potential"][105] == pytest.approx(2.0 * z[105], abs=1e-12 * size)
    for run in (result, more):  # the load itself jumps: half a step of its work is the integrator's
        assert np.abs(run.energy["numerical"]).max() < 1e-3 * size


def test_what_is_no_scene_no_integrator_and_no_number_is_refused() -> None:
    with pytest.raises(wf.InputError, match="a Scene is needed"):
        simulate(None, 1.0, step=0.1)  # pyright: ignore[reportArgumentType]
    with pytest.raises(wf.InputError, match="a Scene is needed"):
        wf.equilibrium(None)  # pyright: ignore[reportArgumentType]
    with pytest.raises(wf.InputError, match="save_every must be a whole number"):
        simulate(falling(), 1e-2, step=1e-3, options=wf.RunOptions(save_every=2.5), progress=False)  # type: ignore[arg-type]
    wrong = [Stage("a", 1e-2, 1e-3, {"integrator": "alpha"})]
    with pytest.raises(wf.InputError, match="stage 'a': integrator must be"):
        simulate(falling(), wrong, progress=False)
    with pytest.raises(wf.InputError, match="rho_inf must be a number"):
        GeneralizedAlpha(rho_inf="high")  # type: ignore[arg-type]
    with pytest.raises(wf.InputError, match="duration must be a number"):
        Stage("a", "0.5", 1)  # type: ignore[arg-type]


def test_report_says_over_what_iterations_are_counted() -> None:
    assert "iterations per step" in simulate(falling(), 1e-2, step=1e-3, progress=False).report()
    assert (
        "iterations per saved row"
        in simulate(falling(), 1e-2, step=1e-3, options=wf.RunOptions(save_every=5), progress=False).report()
    )


def test_angles_of_joints_go_on_counting_their_turns_over_stages() -> None:
    scene = wf.Scene()
    wheel = scene.add_rigid_body(1.0, (0.1, 0.1, 0.1), name="wheel", angular_velocity=(0.0, 0.0, 20.0))
    scene.add(wf.joints.Revolute(scene.ground, wheel.at((0.0, 0.0, 0.0)), axis=(0, 0, 1), name="hinge"))
    result = wf.simulate(scene, [wf.Stage("first", 0.5, 1e-2), wf.Stage("second", 0.5, 1e-2)], progress=False)
    hinge = result.joint("hinge")
    assert hinge.names == ("rotation",)
    # a free wheel keeps its rate: the angle is exact but for round-off of the projection at the start
    assert hinge.named("rotation") == pytest.approx(20.0 * result.time, abs=1e-6)
