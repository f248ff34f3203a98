"""Scenes side by side in the worlds of one graph: each has the bits that it has alone, and failures, refusals and
interruptions are those of one world.

`tests/kernels/test_small_scenes_in_worlds.py` does the same with every kind of scene.
"""

from __future__ import annotations

import threading
from pathlib import Path
from typing import Any

import numpy as np
import pytest

import warpffrf as wf
from same_histories import unlike
from scenes.rollers import guided_pair, roller_body
from warpffrf.model.errors import InputError
from warpffrf.model.reduced.body import ReducedBody
from warpffrf.online.arrays.views import Views
from warpffrf.online.compile.scene import compile_scene
from warpffrf.online.engine import Engine
from warpffrf.online.settings import Settings
from warpffrf.online.step import graph
from warpffrf.online.step.graph import StepGraph
from warpffrf.online.warp_lock import WARP_LOCK
from warpffrf.online.worlds import Ended, Meeting, SharedEngine

STEP, STEPS = 1e-3, 8
LEDGER = 1e-4  # of the energy: second order in the step, 4e-5 is found
REST: dict[str, Any] = {"start": "equilibrium"}


def swing(
    mass: float = 2.0, load: Any = 3.0, stiffness: float = 40.0, friction: float = 0.05, speed: float = 0.0
) -> wf.Scene:
    """A bob on an arm in a hinge that rubs, on a spring, pulled along."""
    scene = wf.Scene(gravity=(0, 0, -9.81))
    bob = scene.add_rigid_body(
        mass, (0.01, 0.01, 0.01), name="bob", position=(0.5, 0, 0), angular_velocity=(0, speed, 0),
        velocity=(0, 0, -0.5 * speed),
    )  # fmt: skip
    hinge = scene.add(wf.joints.Revolute(scene.ground, bob.at((-0.5, 0, 0)), axis=(0, 1, 0), name="hinge"))
    scene.add(wf.forces.RevoluteFriction(hinge, friction, pin_radius=0.01))
    scene.add(wf.forces.SpringDamper(scene.ground.at((0.5, 0, 0.3)), bob.at((0, 0, 0)), stiffness, 1.0, name="spring"))
    scene.add(wf.forces.PointForce(bob.at((0, 0, 0)), (0.0, 0.0, load), name="pull"))
    return scene


def apart(scene: wf.Scene, kind: str = "dynamic", **options: Any) -> wf.Result:
    return (wf.static if kind == "static" else wf.simulate)(scene, STEPS * STEP, step=STEP, progress=False, **options)


def beside(scenes: list[wf.Scene], **options: Any) -> list[wf.Result]:
    return wf.simulate_worlds(scenes, STEPS * STEP, step=STEP, progress=False, **options)


def assert_alike(scenes: list[wf.Scene], **options: Any) -> list[wf.Result]:
    """The runs of `scenes` side by side, which are those one by one."""
    found = beside(scenes, **options)
    for scene, result in zip(scenes, found, strict=True):
        alone = apart(scene, **options)
        assert unlike(alone.history, result.history) == []
        counts = [name for name in alone.history.counters if "seconds" not in name]
        assert [alone.history.counters[n] for n in counts] == [result.history.counters[n] for n in counts]
        assert alone.history.options == result.history.options
    return found


def swings() -> list[wf.Scene]:
    """They differ in each number, and in how many pieces their loads have."""
    table = wf.signals.Table((0.0, 2e-3, 4e-3, 1.0), (0.0, 5.0, -5.0, 0.0))
    return [swing(), swing(mass=3.0), swing(load=table), swing(stiffness=400.0), swing(friction=0.4), swing(speed=2.0)]


def test_each_world_has_the_bits_of_its_scene_alone() -> None:
    found = assert_alike(swings())
    last = [tuple(result.body("bob").position[-1]) for result in found]
    assert len(set(last)) == len(last)
    assert found[0].error_budget() == apart(swings()[0]).error_budget()  # of the scene alone, as its marks say
    smooth = [result for i, result in enumerate(found) if i != 2]  # that load jumps by its size within two steps
    assert all(np.abs(result.energy_residual).max() < LEDGER * result.energy_scale for result in smooth)


def test_worlds_come_to_rest_each_by_itself() -> None:
    assert_alike(
        [swing(friction=0.0, stiffness=c) for c in (40.0, 4e5)],
        **REST,
        options=wf.RunOptions(local_modes="quasi_static"),
    )


def test_static_runs_and_options_go_to_all_worlds() -> None:
    assert_alike(
        [swing(friction=0.0, stiffness=c) for c in (40.0, 4e3)], kind="static", options=wf.RunOptions(save_every=3)
    )
    options = wf.RunOptions(step_error=1e-7, integrator=wf.integrators.HHT(alpha=-0.1), energy_tolerance=1e-3)
    assert_alike(swings()[:2], options=options)


@pytest.fixture(scope="module")
def small_body() -> ReducedBody:
    return roller_body(60, layers=2, axial=2, grading=1.6, max_frequency=12e3, tangential=True, cache=False)


def test_flexible_bodies_in_contact(small_body: ReducedBody) -> None:
    """Other loads, coefficients of friction and speeds, from equilibria that take other numbers of steps; tables of the
    bodies lie on the device once."""
    scenes = [
        guided_pair(small_body, small_body, load=load, friction=mu, speed=speed)
        for load, mu, speed in ((60e3, 0.3, 20.0), (90e3, 0.1, 20.0), (60e3, 0.3, 60.0))
    ]
    options: dict[str, Any] = {"step": 1e-4, "progress": False, **REST}
    engines = []
    begin = Engine._begin

    def noted(engine: Engine, *arguments: Any) -> None:
        engines.append(engine)
        begin(engine, *arguments)

    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(Engine, "_begin", noted)
        found = wf.simulate_worlds(scenes, 4e-4, **options)
    for scene, result in zip(scenes, found, strict=True):
        assert unlike(wf.simulate(scene, 4e-4, **options).history, result.history) == []
    models = [compiled.model for compiled in engines[0].scenes]
    assert len({id(m.responses.number) for m in models}) == len({id(m.surfaces.mode_normal) for m in models}) == 1
    assert len({id(m.pairs.friction) for m in models}) == 2


def test_kernels_of_worlds_are_compiled_in_sight(monkeypatch: pytest.MonkeyPatch) -> None:
    """Once for all: by the engine that they share, as far as the call shows its progress."""
    shown = []
    load = graph.load
    monkeypatch.setattr(graph, "load", lambda *args, progress: (shown.append(progress), load(*args, progress=progress)))
    for progress in (True, False):
        wf.simulate_worlds([swing(), swing(mass=3.0)], 2.0 * STEP, step=STEP, progress=progress)
    assert shown == [True, False]


def test_a_world_that_fails_stops_alone() -> None:
    """A load that no number holds, from the third step on."""
    sudden = wf.signals.Table((0.0, 3e-3, 3.1e-3, 1.0), (0.0, 0.0, 1e300, 1e300))
    found = assert_alike([swing(), swing(load=sudden), swing(mass=3.0)])
    assert [result.status for result in found] == ["completed", "not_finite", "completed"]
    with pytest.raises(wf.RunError, match="^scene 1: not_finite: .*'bob'") as caught:
        beside([swing(), swing(load=sudden)], check=True)
    assert [result.status for result in caught.value.result] == ["completed", "not_finite"]
    assert 1 < len(found[1].time) < len(found[0].time) == STEPS + 1 and "bob" in found[1].message


def test_scenes_of_other_kinds_are_refused_by_name() -> None:
    other = swing()
    other.add_rigid_body(1.0, (1.0, 1.0, 1.0), name="more")
    with pytest.raises(InputError, match="^scene 2 has 2 bodies, scene 0 has 1; worlds .* run this scene by itself"):
        beside([swing(), swing(), other])
    bare = swing()
    bare.forces.pop()
    with pytest.raises(InputError, match="^scene 1 has 2 forces, scene 0 has 3"):
        beside([swing(), bare])
    with pytest.raises(InputError, match=r"^scene 1 has 8 along 'row' \(constraints, .*scene 0 has 10"):
        beside([two_arms(0), two_arms(0, ball=True)])
    with pytest.raises(InputError, match="^the joints and forces of scene 1 are on other bodies"):
        beside([two_arms(0), two_arms(1)])


def two_arms(to: int, ball: bool = False) -> wf.Scene:
    """Two bobs, one on the ground, the other on the ground or on the first, on hinges, or that one on a ball."""
    scene = wf.Scene()
    first, second = (
        scene.add_rigid_body(1.0, (0.1, 0.1, 0.1), name=name, position=(0, 0, z))
        for name, z in (("low", 0.0), ("high", 1.0))
    )
    scene.add(wf.joints.Revolute(scene.ground, first.at((0, 0, 0)), axis=(0, 1, 0)))
    on = (scene.ground, first.at((0, 0, 1.0)))[to]
    at = second.at((0, 0, 0))
    scene.add(wf.joints.Spherical(on, at) if ball else wf.joints.Revolute(on, at, axis=(0, 1, 0)))
    return scene


def test_wrong_input_of_one_scene_is_that_of_the_call() -> None:
    wrong = swing()
    wrong.bodies[0].velocity[:] = (1.0, 0.0, 0.0)
    with pytest.raises(InputError, match="^scene 1: .*joint 'hinge'"):
        beside([swing(), wrong, swing()])
    with pytest.raises(InputError, match="a list of scenes is needed first"):
        wf.simulate_worlds([], 1.0, step=0.1)
    with pytest.raises(InputError, match="^simulate_worlds: scene 1: a Scene is needed first"):
        wf.simulate_worlds([swing(), "scene"], 1.0, step=0.1)  # type: ignore[list-item]
    with pytest.raises(InputError, match="RungeKutta4 steps without the graph"):
        beside([swing()], options=wf.RunOptions(integrator=wf.integrators.RungeKutta4()))
    with pytest.raises(InputError, match="step_error is for runs in time"):
        beside([swing()], kind="static", options=wf.RunOptions(step_error=1e-3))
    with pytest.raises(InputError, match="^device 'cuda:99' is not available here"):
        beside([swing()], options=wf.RunOptions(device="cuda:99"))


def test_results_are_written_into_a_folder(tmp_path: Path) -> None:
    found = beside(swings()[:2], results=tmp_path / "runs")
    files = sorted((tmp_path / "runs").iterdir())
    assert [file.name for file in files] == ["world_000.h5", "world_001.h5"]
    for file, result in zip(files, found, strict=True):
        assert np.array_equal(wf.Result.load(file).body("bob").position, result.body("bob").position)
    with pytest.raises(InputError, match="exists"):
        beside(swings()[:2], results=tmp_path / "runs")


def test_a_folder_has_no_worlds_of_an_earlier_call(tmp_path: Path) -> None:
    """What the first call has left is removed where it may be replaced; what it did not write stays."""
    beside(swings()[:2], results=tmp_path)
    (tmp_path / "world_000.h5").unlink()
    with pytest.raises(InputError, match=r"world_001\.h5' exists"):
        beside(swings()[:1], results=tmp_path)
    (tmp_path / "world_view.h5").write_text("of somebody else")
    beside(swings()[:1], results=tmp_path, overwrite=True)
    assert sorted(file.name for file in tmp_path.iterdir()) == ["world_000.h5", "world_view.h5"]
    (tmp_path / "world_007.h5").write_text("of somebody else")
    with pytest.raises(InputError, match=r"world_007\.h5' was not written by warpffrf"):
        beside(swings()[:1], results=tmp_path, overwrite=True)


def test_an_interruption_keeps_what_all_worlds_have(monkeypatch: pytest.MonkeyPatch) -> None:
    launches, replay = 0, StepGraph.replay

    def interrupted(graph: StepGraph, budget: Any) -> float:
        nonlocal launches
        seconds = replay(graph, budget)
        launches += int(np.max(budget) > 1)
        if launches == 3:
            raise KeyboardInterrupt
        return seconds

    monkeypatch.setattr(StepGraph, "replay", interrupted)
    found = beside(swings()[:3])
    assert [result.status for result in found] == ["interrupted"] * 3
    assert all(1 < len(result.time) < STEPS + 1 for result in found)


def test_an_interruption_while_runs_begin_ends_them(monkeypatch: pytest.MonkeyPatch) -> None:
    """The first run waits for a second one that is never started."""
    start = threading.Thread.start

    def interrupted(thread: threading.Thread) -> None:
        if thread.name == "world 1":
            raise KeyboardInterrupt
        start(thread)

    monkeypatch.setattr(threading.Thread, "start", interrupted)
    with pytest.raises(KeyboardInterrupt):
        beside([swing(), swing(), swing()])
    assert not any(thread.name.startswith("world") for thread in threading.enumerate())


class Counted:
    """An array of another device, which counts its copies to the host."""

    def __init__(self, values: np.ndarray) -> None:
        self.values, self.shape, self.copies = values, values.shape, 0

    def __getitem__(self, places: slice) -> Counted:
        return Counted(self.values[places])

    def numpy(self) -> np.ndarray:
        self.copies += 1
        return self.values.copy()


def test_all_worlds_read_one_copy_until_they_are_stepped() -> None:
    used = Settings()
    scenes = [compile_scene(swing(), used, "cpu") for _ in range(2)]
    engine = SharedEngine(scenes, used, None, None, False)
    array = Counted(np.arange(6.0))
    worlds = [Views(w, 2, ("place",), engine.on_host) for w in range(2)]
    for views in worlds:
        views.see({"place": array})
        views.touched = False

    def read() -> list[list[float]]:
        return [views.numpy("place").tolist() for views in worlds]

    assert read() == read() == [[0.0, 1.0, 2.0], [3.0, 4.0, 5.0]] and array.copies == 1
    worlds[1].touched, array.values = True, array.values + 1.0
    assert read() == [[0.0, 1.0, 2.0], [4.0, 5.0, 6.0]] and array.copies == 1  # its own part, by itself
    engine.attempt({})
    assert read()[0] == [1.0, 2.0, 3.0] and array.copies == 2


def test_whoever_leaves_is_not_waited_for() -> None:
    """Three threads meet, one leaves after the first meeting, one raises at the second; nobody hangs."""
    meeting, met, ended = Meeting(range(3)), [], []

    def work(i: int) -> None:
        try:
            with WARP_LOCK:
                meeting.come(i, 10 * i, lambda brought: met.append(brought))
                if i == 0:
                    return
                meeting.come(i, i, lambda brought: met.append(brought))
                if i == 1:
                    meeting.end(Ended)
                meeting.come(i, i, lambda brought: met.append(brought))
        except Ended:
            ended.append(i)
        finally:
            meeting.leave(i)

    threads = [threading.Thread(target=work, args=(i,), daemon=True) for i in range(3)]
    for thread in threads:
        thread.start()
    for thread in threads:
        thread.join(10.0)
    assert not any(thread.is_alive() for thread in threads)
    assert met == [{0: 0, 1: 10, 2: 20}, {1: 1, 2: 2}] and sorted(ended) == [1, 2]
