"""Whole runs with the retained matrix factored sparsely and as one block: the same motion and reactions, to
round-off."""

from __future__ import annotations

import numpy as np
import pytest
from one_block import in_one_block

from warpffrf.model import joints
from warpffrf.model.scene import Scene
from warpffrf.online import History, engine, run
from warpffrf.online.compile.retained_pattern import pattern_of

MOVED = 1e-12  # m, rotations: round-off of coordinates of order 1, and some steps of its growth
PULLED = 3e-8  # of the largest force: a position's round-off of 1e-16 m over h^2 = 1e-6 s2, at the start over 1e-14 s2
LENGTH = 0.2  # m
SAG = 1.0  # rad: slope of the closed chain at its ends; a straight one is a singular pose


def links(count: int, *, closed: bool) -> Scene:
    """A spatial chain from the ground, its joints in turn spherical and revolute; closed: its end is held too."""
    scene = Scene(gravity=(0.0, 1.0, -9.81))
    slope = SAG * np.linspace(-1.0, 1.0, count) * closed
    along = LENGTH * np.stack([np.cos(slope), 0.0 * slope, np.sin(slope)], axis=1)
    ends = np.concatenate([np.zeros((1, 3)), np.cumsum(along, axis=0)])
    bodies = [
        scene.add_rigid_body(
            0.3, (1e-4, 1e-3, 1e-3), name=f"b{i}", position=0.5 * (ends[i] + ends[i + 1]),
            rotation=(0.0, -np.sin(0.5 * slope[i]), 0.0, np.cos(0.5 * slope[i])),
        )
        for i in range(count)
    ]  # fmt: skip
    for i in range(count + closed):
        a = bodies[i - 1].at((0.5 * LENGTH, 0.0, 0.0)) if i else scene.ground
        b = bodies[i].at((-0.5 * LENGTH, 0.0, 0.0)) if i < count else scene.ground
        if i % 2 and i < count:
            scene.add(joints.Revolute(a, b, axis=(0.0, np.cos(0.4 * i), np.sin(0.4 * i))))
        else:
            scene.add(joints.Spherical(a, b))
    return scene


def hub() -> Scene:
    """A body on the ground's axle that carries five others, each free on its own axle."""
    scene = Scene(gravity=(0.0, 0.0, -9.81))
    middle = scene.add_rigid_body(2.0, (0.02, 0.02, 0.03), name="hub", angular_velocity=(0.0, 0.0, 3.0))
    scene.add(joints.Revolute(scene.ground, middle.at((0.0, 0.0, 0.0)), axis=(0, 0, 1)))
    for i in range(5):
        angle = 2.0 * np.pi * i / 5
        at = np.array([0.3 * np.cos(angle), 0.3 * np.sin(angle), 0.0])
        velocity = np.cross((0.0, 0.0, 3.0), at)
        arm = scene.add_rigid_body(
            0.4, (1e-3, 1e-3, 1e-3), name=f"arm{i}", position=at + (0.0, 0.0, -0.1), velocity=velocity,
            angular_velocity=(0.0, 0.0, 3.0),
        )  # fmt: skip
        axis = (-np.sin(angle), np.cos(angle), 0.0)
        scene.add(joints.Revolute(middle.at(at), arm.at((0.0, 0.0, 0.1)), axis=axis))
    return scene


SCENES = {"chain": lambda: links(6, closed=False), "loop": lambda: links(6, closed=True), "hub": hub}


def motion(history: History) -> dict[str, np.ndarray]:
    """What is compared."""
    assert history.status == "completed", history.message
    bodies, held = history.bodies.values(), history.joints.values()
    return {
        "position": np.stack([b.position for b in bodies]),
        "rotation": np.stack([b.rotation for b in bodies]),
        "force": np.stack([j.force for j in held]),
        "torque": np.stack([j.torque for j in held]),
    }


@pytest.mark.parametrize("name", SCENES)
def test_runs_agree_with_a_dense_factor(name: str, monkeypatch: pytest.MonkeyPatch) -> None:
    history = run(SCENES[name](), 0.1, step=1e-3, save_every=10, progress=False)
    assert history.counters["dense_fallbacks"] == 0
    sparse = motion(history)
    monkeypatch.setattr(engine, "pattern_of", lambda compiled: in_one_block(pattern_of(compiled)))
    dense = motion(run(SCENES[name](), 0.1, step=1e-3, save_every=10, progress=False))
    largest = np.abs(dense["force"]).max()
    allowed = {"position": MOVED, "rotation": MOVED, "force": PULLED * largest, "torque": PULLED * largest * LENGTH}
    for what, value in dense.items():
        worst = np.abs(value - sparse[what]).max()
        print(f"{name}, {what}: {worst:.1e}, allowed {allowed[what]:.1e}")
        assert worst < allowed[what], what
