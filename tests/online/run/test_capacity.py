"""Room for active nodes: what is short of it comes again with more; only what the capacity forbids fails."""

from __future__ import annotations

import sys
from pathlib import Path as FilePath
from typing import Any

import numpy as np
import pytest

import warpffrf as wf
from same_histories import unlike
from warpffrf.model import forces, joints, surfaces
from warpffrf.model.contact import Contact
from warpffrf.model.errors import InputError
from warpffrf.model.scene import Scene
from warpffrf.online import Engine, find_equilibrium, run
from warpffrf.online.arrays.scratch import Scratch, scratch_for
from warpffrf.online.compile import capacity
from warpffrf.online.start.consistent import start_consistently
from warpffrf.online.vibrations.eigenmodes import find_modes
from warpffrf_kernels.core import control as k

sys.path.insert(0, str(FilePath(__file__).parents[1]))
from made_bodies import made_body

LOAD = 1e7  # N: ten nodes under each ball
STEP = 1e-4


def plate_on_balls(
    places: tuple[float, ...],
    *,
    load: float = 0.0,
    height: float = 0.0,
    speed: float = 0.0,
    capacity: int | None = None,
) -> Scene:
    """A plate on a vertical guide, 15 by 7 shape functions below, `height` above rigid balls at `places` along it
    [m]."""
    plane = surfaces.Plane(origin=(0.0, 0.0, -0.02), outward=(0.0, 0.0, -1.0), direction=(0.0, 1.0, 0.0))
    body = made_body(plane, np.linspace(-6e-3, 6e-3, 7), pitch=2e-3, columns=15)
    scene = Scene()
    plate = scene.add_body(body, name="plate", position=(0.0, 0.0, height), velocity=(0.0, 0.0, -speed))
    scene.add(joints.Prismatic(scene.ground, plate["hold"], axis=(0, 0, 1), name="guide"))
    scene.add(forces.PointForce(plate["hold"], (0.0, 0.0, -load)))
    for i, x in enumerate(places):
        ball = surfaces.Sphere(radius=0.06, axis_point=(x, 0.0, -0.08), axis_direction=(0.0, 1.0, 0.0))
        port = scene.ground.surface(ball, name=f"ball {i}")
        scene.add(Contact(plate["face"], port, name=f"pair {i}", overlap=1.0, capacity=capacity))
    return scene


@pytest.fixture
def little(monkeypatch: pytest.MonkeyPatch) -> None:
    """Room for one node of each pair, to begin with."""
    monkeypatch.setattr(capacity, "LEAST_SLOTS", 1)
    monkeypatch.setattr(capacity, "USUAL_PATCH", 10**6)


def test_modes_about_a_given_state_have_room_for_its_patch(little: None) -> None:
    """The engine that linearises has made no step in which its room could have grown."""
    scene = plate_on_balls((-7e-3, 6e-3), load=LOAD)
    rest = find_equilibrium(scene)
    assert all(np.count_nonzero(pair.pressure) > 3 for pair in rest.contacts.values())
    about, own = find_modes(scene, 4, about=rest), find_modes(scene, 4)
    np.testing.assert_allclose(about.eigenvalues, own.eigenvalues, rtol=1e-9)


def test_an_iteration_that_overshoots_the_capacity_is_no_failure() -> None:
    """A plate that drops on a ball with a step that does not resolve it: the first iterate closes far more nodes than
    any state does. A capacity that holds these states is enough: the step is halved, and the plate leaves as fast."""
    told = run(plate_on_balls((0.0,), height=2e-5, speed=5.0, capacity=8), 10 * STEP, step=STEP, progress=False)
    free = run(plate_on_balls((0.0,), height=2e-5, speed=5.0), 10 * STEP, step=STEP, progress=False)
    assert told.status == free.status == "completed", told.message
    assert told.counters["rejected_steps"] > 0
    speed = [np.linalg.norm(h.bodies["plate"].velocity[-1]) for h in (told, free)]
    assert speed[0] == pytest.approx(speed[1], rel=0.01) == pytest.approx(5.0, rel=0.01)  # modes keep the rest


def test_a_world_that_is_not_short_keeps_what_is_recorded_of_it(little: None) -> None:
    """Two worlds, a small patch in one, one in the other for which room is made at the start: the first row of each is
    that of the world alone."""
    scene = plate_on_balls((0.0,), height=-3e-4)
    heights = (-3e-5, -2e-3)
    engine = Engine(scene, worlds=2)
    alone = [Engine(scene) for _ in heights]
    for e, own in ((engine, heights), *((e, (height,)) for e, height in zip(alone, heights, strict=True))):
        r = e.state.r.numpy().copy()
        r[:, 0, 2] += np.asarray(own) + 3e-4
        e.state.r.assign(r)
        start_consistently(e)
        e.enter(k.DYNAMIC, STEP, target=0)
        e.save_now()
        assert not np.any(e.word("status"))
    assert alone[0].compiled.model.capacity.slots < alone[1].compiled.model.capacity.slots
    for w, e in enumerate(alone):
        for name, rows in e.saved().items():
            np.testing.assert_array_equal(engine.saved(w)[name], rows, name)


def test_a_run_without_memory_for_more_keeps_what_it_has(little: None, monkeypatch: pytest.MonkeyPatch) -> None:
    """The plate falls on the balls; there is no memory for more nodes than one of each pair."""
    asked = []

    def refused(*arguments: Any) -> Scratch:
        asked.append(1)
        if len(asked) > 1:
            raise MemoryError
        return scratch_for(*arguments)

    monkeypatch.setattr("warpffrf.online.engine.scratch_for", refused)
    history = run(
        plate_on_balls((-7e-3, 6e-3), height=1e-4, speed=1.0, load=LOAD), 20 * STEP, step=STEP, progress=False
    )
    assert (
        history.status == "memory"
        and "memory does not suffice for" in history.message
        and "spacing=" in history.message
    )
    assert len(history.time) >= 1 and np.all(np.isfinite(history.bodies["plate"].position))


def test_a_world_without_memory_leaves_the_others_their_room(little: None, monkeypatch: pytest.MonkeyPatch) -> None:
    """Three plates fall on balls, and there is memory for ten nodes: the first wants 45 at once and ends by itself, the
    second gets its five later, the third needs none. Each run is that of the scene alone, with as much memory."""

    def scarce(scenes: Any, sizes: Any, state: Any) -> Scratch:
        if sizes["slot"] > 10:
            raise MemoryError
        return scratch_for(scenes, sizes, state)

    monkeypatch.setattr("warpffrf.online.engine.scratch_for", scarce)
    falls = ((2e-5, 5.0), (1e-4, 0.5), (1e-4, 0.2))
    scenes = [plate_on_balls((0.0,), height=height, speed=speed) for height, speed in falls]
    found = wf.simulate_worlds(scenes, 6 * STEP, step=STEP, progress=False)
    assert [result.status for result in found] == ["memory", "completed", "completed"]
    assert "memory does not suffice for 45 active nodes or cells" in found[0].message
    for scene, result in zip(scenes, found, strict=True):
        alone = wf.simulate(scene, 6 * STEP, step=STEP, progress=False)
        assert unlike(alone.history, result.history) == []


def test_room_for_one_world_is_no_more_attempts_for_another(little: None) -> None:
    """Three attempts of each: the plate that falls fast comes again with more room, the one that is far away has made
    its three steps."""
    engine = Engine(plate_on_balls((0.0,), height=2e-5), worlds=2)
    r, v = engine.state.r.numpy().copy(), engine.state.v.numpy().copy()
    r[1, 0, 2] += 1.0
    v[0, 0, 2] = -5.0
    engine.state.r.assign(r)
    engine.state.v.assign(v)
    start_consistently(engine)
    slots = engine.compiled.model.capacity.slots
    engine.enter(k.DYNAMIC, STEP, target=100)
    engine.control(every=1)
    engine.replay(3)
    assert engine.compiled.model.capacity.slots > slots
    assert engine.word("step")[1] == 3


def test_worlds_whose_room_may_grow_to_other_sizes_are_refused(little: None) -> None:
    """They begin with one slot a pair; the second pair of scene 1 is to have no more."""
    scenes = [plate_on_balls((-7e-3, 6e-3)) for _ in range(2)]
    scenes[1].contacts[1].capacity = 1
    with pytest.raises(InputError, match=r"^the contacts of scene 1 allow \d+ active nodes.* of scene 0 \d+; worlds"):
        wf.simulate_worlds(scenes, STEP, step=STEP, progress=False)
