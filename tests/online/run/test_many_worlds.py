"""Many scenes at once: equilibria, results that are passed on, and memory that is too small for all."""

from __future__ import annotations

import logging
from pathlib import Path
from typing import Any

import numpy as np
import pytest

import warpffrf as wf
from same_histories import unlike
from warpffrf.online import room_for_worlds
from warpffrf.online.compile.scene import compile_scene
from warpffrf.online.engine import Engine
from warpffrf.online.room_for_worlds import bytes_of_a_world, worlds_that_fit
from warpffrf.online.settings import Settings

MASS, GRAVITY = 2.0, 9.81  # kg, m/s2
MANY = 300


def hung(stiffness: float, load: float = 0.0) -> wf.Scene:
    """A bob in a guide on a spring, which rests at -(m g + load)/stiffness."""
    scene = wf.Scene(gravity=(0, 0, -GRAVITY))
    bob = scene.add_rigid_body(MASS, (0.1, 0.1, 0.1), name="bob")
    guide = scene.add(wf.joints.Prismatic(scene.ground, bob, axis=(0, 0, 1)))
    scene.add(wf.forces.JointSpringDamper(guide, stiffness=stiffness, damping=10.0))
    scene.add(wf.forces.PointForce(bob.at((0, 0, 0)), (0.0, 0.0, -load)))
    return scene


def bearing(clearance: float, load: float = 12e3) -> wf.Scene:
    """A roller bearing under a radial load [N], with diametral clearance [m]."""
    scene = wf.Scene(gravity=(0, 0, 0))
    geometry = wf.bearings.catalogue("NU 2210", clearance=clearance)
    made = scene.add_bearing(
        "NU", geometry, first=(0, 0, 1), outer=scene.ground,
        contact=wf.bearings.RollingContact(law=wf.laws.IsoLamina(geometry.roller_length)),
    )  # fmt: skip
    scene.add(wf.joints.Planar(scene.ground.at((0, 0, 0)), made.inner, axis=(0, 1, 0)))
    scene.add(wf.forces.PointForce(made.inner, (0, 0, load)))
    return scene


def test_equilibria_have_the_bits_of_each_alone() -> None:
    """Clearances from preload to play: other rollers carry, after other numbers of steps."""
    scenes = [bearing(clearance) for clearance in (-5e-6, 10e-6, 60e-6)]
    found = wf.equilibria(scenes, progress=False)
    for scene, result in zip(scenes, found, strict=True):
        alone = wf.equilibrium(scene, progress=False)
        assert unlike(alone.history, result.history) == [] and alone.history.options == result.history.options
    assert len({int(np.count_nonzero(result.bearing("NU").inner_load[-1])) for result in found}) == 3


def test_what_is_wanted_is_passed_on_as_runs_end(tmp_path: Path) -> None:
    """In the order of the scenes; the file of a world is complete when its result is passed on."""
    passed: list[int] = []

    def each(i: int, result: wf.Result) -> float:
        passed.append(i)
        assert (tmp_path / f"world_{i:03d}.h5").is_file()
        return float(result.body("bob").position[-1, 2])

    stiffness = (1e3, 2e3, 4e3)
    found = wf.equilibria([hung(k) for k in stiffness], each=each, results=tmp_path, progress=False)
    assert sorted(passed) == [0, 1, 2]
    np.testing.assert_allclose(found, [-MASS * GRAVITY / k for k in stiffness], rtol=1e-9)
    with pytest.raises(wf.InputError, match="^simulate_worlds: each must be a function"):
        wf.simulate_worlds([hung(1e3)], 1e-3, step=1e-3, each="last", progress=False)  # type: ignore[arg-type]


def test_a_world_that_fails_among_many_is_named(caplog: pytest.LogCaptureFixture) -> None:
    """Hundreds of scenes, one with a load that no number holds: its status, and the rest of all others."""
    stiffness = np.linspace(1e3, 4e3, MANY)
    scenes = [hung(k, load=1e300 if i == 123 else 0.0) for i, k in enumerate(stiffness)]
    with caplog.at_level(logging.WARNING, logger="warpffrf"):
        found = wf.equilibria(
            scenes, each=lambda i, run: (run.status, run.body("bob").position[:, 2].sum()), progress=False
        )
    failed = [i for i, (status, _) in enumerate(found) if status != "completed"]
    assert failed == [123] and sum(record.message.startswith("scene 123: ") for record in caplog.records) == 1
    others = np.delete(np.arange(MANY), failed)
    np.testing.assert_allclose(
        np.array([place for _, place in found])[others], -MASS * GRAVITY / stiffness[others], rtol=1e-9
    )


def test_worlds_run_in_batches_where_memory_is_short(
    monkeypatch: pytest.MonkeyPatch, caplog: pytest.LogCaptureFixture
) -> None:
    scenes, engines = [hung(k) for k in (1e3, 2e3, 3e3, 4e3, 5e3)], []
    whole = wf.simulate_worlds(scenes, 8e-3, step=1e-3, progress=False)
    compiled = compile_scene(scenes[0], Settings(), "cpu")
    size, _ = bytes_of_a_world(compiled, Settings().for_rows(8), None, None)
    begin = Engine._begin

    def noted(engine: Engine, scenes: Any, *arguments: Any) -> None:
        engines.append(len(scenes))
        begin(engine, scenes, *arguments)

    monkeypatch.setattr(Engine, "_begin", noted)
    monkeypatch.setattr(room_for_worlds, "free_memory", lambda device: int(2.5 * size / room_for_worlds.SHARE))
    with caplog.at_level(logging.WARNING, logger="warpffrf"):
        found = wf.simulate_worlds(scenes, 8e-3, step=1e-3, progress=False)
    assert (
        engines == [2, 2, 1] and [unlike(a.history, b.history) for a, b in zip(whole, found, strict=True)] == [[]] * 5
    )
    assert [record.message[:27] for record in caplog.records if record.levelno == logging.WARNING] == [
        "worlds: 2 of 5 fit at once ",
        "worlds: 2 of 3 fit at once ",
    ]
    monkeypatch.setattr(room_for_worlds, "free_memory", lambda device: 1)
    assert worlds_that_fit(compiled, Settings(), None, None, 5) == 1


def test_memory_of_worlds_is_that_of_the_declared_arrays() -> None:
    """Allocated bytes over the number of worlds, for the rows of the ring that the run needs."""
    scene, settings = bearing(20e-6), Settings().for_rows(1)
    size, _ = bytes_of_a_world(compile_scene(scene, settings, "cpu"), settings, None, None)
    assert settings.ring_rows == 3
    for worlds in (1, 5):
        engine = Engine(scene, worlds=worlds, settings=settings)
        arrays = {
            id(array): array.capacity
            for owner in (engine.state, engine.ring, engine.scratch)
            for name in owner.declarations
            for array in (getattr(owner, name),)
        }
        # what has no world axis, the conditions of loops, is there once
        assert worlds * size - 1e3 < sum(arrays.values()) <= worlds * size
    many, _ = bytes_of_a_world(compile_scene(scene, Settings(), "cpu"), Settings(), None, None)
    assert many > 30 * size  # the ring of a long run
