"""Step time of many rigid bodies and joints: `python bench/rigid_bodies.py [--json FILE] [--steps N] [--bodies N]`.

Scenes without flexible bodies or contact, one world: a step is the retained system and what is around it. *chain*: a
pendulum of links that swings in space, its joints in turn spherical and revolute. *loop*: the same links hang between
two points of the ground, one joint more, so that every body is part of a closed loop. *planar*: revolute joints only,
axes parallel, the scene with the most rows of the three.
"""

from __future__ import annotations

import argparse
import json
from collections.abc import Callable
from pathlib import Path

import numpy as np

from warpffrf.model import joints
from warpffrf.model.scene import Scene
from warpffrf.online import run
from warpffrf.study.machine import machine

LENGTH, MASS = 0.1, 0.2  # m, kg: a slender link
INERTIA = (2e-5, MASS * LENGTH**2 / 12.0, MASS * LENGTH**2 / 12.0)  # kg m2
STEP = 1e-3  # s: some 60 steps in the shortest period of a link
BODIES = 20
SLOPE = 0.3  # rad by which the links' axes are rotated from one to the next, so that the motion is spatial
SAG = 0.6  # of the loop: its ends are this fraction of its length apart
STEPS = 200  # of a run: some 30 ms
ROUNDS = 10  # short runs; the fastest counts, as for U: other work on the machine only slows down
SAVE_EVERY = 100  # steps: recording is no part of the figure


def links(scene: Scene, count: int, directions: np.ndarray) -> list:
    """`count` links end to end along unit `directions` (count, 3), all in the plane y = 0; returns the bodies."""
    points = np.concatenate([np.zeros((1, 3)), np.cumsum(LENGTH * directions, axis=0)])
    bodies = []
    for i in range(count):
        half = 0.5 * np.arctan2(-directions[i, 2], directions[i, 0])
        bodies.append(
            scene.add_rigid_body(
                MASS,
                INERTIA,
                name=f"link_{i}",
                position=0.5 * (points[i] + points[i + 1]),
                rotation=(0.0, np.sin(half), 0.0, np.cos(half)),
            )
        )
    return bodies


def _ports(scene: Scene, bodies: list, i: int) -> tuple:
    """The two sides of joint i: the end of the link before it and the beginning of the one after it, or the ground."""
    before = bodies[i - 1].at((0.5 * LENGTH, 0.0, 0.0)) if i > 0 else scene.ground
    after = bodies[i].at((-0.5 * LENGTH, 0.0, 0.0)) if i < len(bodies) else scene.ground
    return before, after


def chain(count: int) -> Scene:
    """Let go from the horizontal."""
    scene = Scene(gravity=(0.0, 0.0, -9.81))
    bodies = links(scene, count, np.tile([1.0, 0.0, 0.0], (count, 1)))
    for i in range(count):
        if i % 2:
            axis = (0.0, np.cos(SLOPE * i), np.sin(SLOPE * i))
            scene.add(joints.Revolute(*_ports(scene, bodies, i), axis=axis))
        else:
            scene.add(joints.Spherical(*_ports(scene, bodies, i)))
    return scene


def planar(count: int) -> Scene:
    """Let go from the horizontal, all axes parallel."""
    scene = Scene(gravity=(0.0, 0.0, -9.81))
    bodies = links(scene, count, np.tile([1.0, 0.0, 0.0], (count, 1)))
    for i in range(count):
        scene.add(joints.Revolute(*_ports(scene, bodies, i), axis=(0, 1, 0)))
    return scene


def loop(count: int) -> Scene:
    """Hung up at both ends, in the shape of an arc, with joints spherical and revolute in turn; swings under its
    weight."""
    scene = Scene(gravity=(0.0, 3.0, -9.81))
    angle = np.arccos(SAG) * np.linspace(-1.0, 1.0, count)
    bodies = links(scene, count, np.stack([np.cos(angle), 0.0 * angle, np.sin(angle)], axis=1))
    for i in range(count + 1):
        if 0 < i < count and i % 2:
            axis = (0.0, np.cos(SLOPE * i), np.sin(SLOPE * i))
            scene.add(joints.Revolute(*_ports(scene, bodies, i), axis=axis))
        else:
            scene.add(joints.Spherical(*_ports(scene, bodies, i)))
    return scene


SCENES: dict[str, Callable[[int], Scene]] = {"chain": chain, "planar": planar, "loop": loop}


def time_scene(name: str, count: int, steps: int) -> dict:
    """Figures of `steps` steps of a scene: the fastest and the middle one of many short runs."""
    times = []
    for _ in range(ROUNDS):
        scene = SCENES[name](count)
        history = run(scene, steps * STEP, step=STEP, save_every=SAVE_EVERY, progress=False)
        times.append(history.counters["seconds_in_graph"] / max(history.counters["steps"], 1))
        if history.status != "completed":
            raise SystemExit(f"{name}, {count} bodies: {history.status}: {history.message}")
    c = history.counters
    return {
        "scene": name,
        "bodies": count,
        "joints": len(scene.joints),
        "rows": int(c["retained_columns"]) - 6 * count,
        "seconds_per_step": min(times),
        "middle_seconds_per_step": float(np.median(times)),
        "iterations": c["mean_iterations"],
        "steps": int(c["steps"]),
        "rejected_steps": int(c["rejected_steps"]),
        "dense_fallbacks": int(c.get("dense_fallbacks", 0)),
    }


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--json", type=Path, help="write machine, versions and rows to this file")
    parser.add_argument("--steps", type=int, default=STEPS)
    parser.add_argument("--bodies", type=int, nargs="*", default=[5, BODIES])
    given = parser.parse_args()
    about = machine()
    unit = about["unit_seconds"]
    rows = [time_scene(name, count, given.steps) for count in given.bodies for name in SCENES]
    print(f"U = {unit * 1e6:.1f} us")
    print("scene   bodies  joints  rows  iterations  fallbacks  us/step   U/step  middle U/step")
    for r in rows:
        r["unit_seconds"] = unit
        counts = f"{r['scene']:8s}{r['bodies']:6d} {r['joints']:7d} {r['rows']:5d} {r['iterations']:11.2f}"
        best, middle = (r[name] / unit for name in ("seconds_per_step", "middle_seconds_per_step"))
        print(f"{counts} {r['dense_fallbacks']:10d} {r['seconds_per_step'] * 1e6:8.1f} {best:8.2f} {middle:14.2f}")
    if given.json:
        given.json.write_text(json.dumps({**about, "rows": rows}, indent=1) + "\n")


if __name__ == "__main__":
    main()
