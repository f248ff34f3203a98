"""Scenes as worlds of one graph, and one after another: `python bench/worlds.py [--worlds N] [--device cuda:0]`.

Short runs of scenes that differ in numbers: a swing (one rigid body on a hinge, a spring and a load), a chain of ten
links, and two rollers pressed together, from their equilibrium. *apart*: `simulate` for each, *together*: one
`simulate_worlds`; both in this process, in turn, with kernels that are compiled; the fastest of the rounds counts.
Times are wall times over the number of runs: *set-up* (compiling scenes, arrays, graph), *graph* (its steps), and
*finish* (history and notes); *rest* is what the host does for start and steps. *times*: apart over together, of the
whole. *differs*: the largest difference of what the two have saved, over the largest value of that quantity.
"""

from __future__ import annotations

import argparse
import json
import time
from collections.abc import Callable, Sequence
from pathlib import Path
from typing import Any

import numpy as np

from scenes.rollers import guided_pair, roller_body
from warpffrf.model import forces, joints, signals
from warpffrf.model.scene import Scene
from warpffrf.output.options import RunOptions
from warpffrf.output.result import Result
from warpffrf.output.simulate import simulate
from warpffrf.output.worlds import simulate_worlds
from warpffrf.study.machine import machine

WORLDS, ROUNDS = 64, 2
LINKS, LENGTH = 10, 0.1  # of the chain; m
PARTS = {"set-up": "build_seconds", "graph": "seconds_in_graph", "finish": "finish_seconds"}


def swings(count: int) -> list[Scene]:
    """Other masses, stiffnesses and loads."""
    found = []
    for x in np.linspace(0.0, 1.0, count):
        scene = Scene(gravity=(0.0, 0.0, -9.81))
        bob = scene.add_rigid_body(2.0 + x, (0.01, 0.01, 0.01), name="bob", position=(0.5, 0.0, 0.0))
        scene.add(joints.Revolute(scene.ground, bob.at((-0.5, 0.0, 0.0)), axis=(0, 1, 0)))
        scene.add(forces.SpringDamper(scene.ground.at((0.5, 0.0, 0.3)), bob.at((0.0, 0.0, 0.0)), 40.0 * (1.0 + x), 1.0))
        scene.add(forces.PointForce(bob.at((0.0, 0.0, 0.0)), (0.0, 0.0, signals.Ramp(0.0, 5.0 * x, duration=0.02))))
        found.append(scene)
    return found


def chains(count: int) -> list[Scene]:
    """Let go with other speeds of the last link."""
    found = []
    for speed in np.linspace(0.0, 1.0, count):
        scene = Scene(gravity=(0.0, 0.0, -9.81))
        above = scene.ground.at((0.0, 0.0, 0.0))
        for i in range(LINKS):
            place = ((i + 0.5) * LENGTH, 0.0, 0.0)
            turning = {"angular_velocity": (0, speed, 0), "velocity": (0, 0, -0.5 * LENGTH * speed)}
            link = scene.add_rigid_body(
                0.2, (2e-5, 2e-4, 2e-4), name=f"link {i}", position=place, **(turning if i == LINKS - 1 else {})
            )
            scene.add(joints.Revolute(above, link.at((-0.5 * LENGTH, 0.0, 0.0)), axis=(0, 1, 0)))
            above = link.at((0.5 * LENGTH, 0.0, 0.0))
        found.append(scene)
    return found


def rollers(count: int) -> list[Scene]:
    """Other loads and speeds."""
    body = roller_body(84, layers=3, axial=2, order=1, grading=1.6, max_frequency=15e3)
    cases = zip(np.linspace(50e3, 100e3, count), np.linspace(20.0, 60.0, count), strict=True)
    return [guided_pair(body, body, load=load, speed=speed, ramp=0.02) for load, speed in cases]


CASES: dict[str, tuple[Callable[[int], list[Scene]], float, int, str]] = {
    "swings": (swings, 1e-3, 50, "initial"),
    "chains": (chains, 1e-3, 50, "initial"),
    "rollers": (rollers, 1e-4, 20, "equilibrium"),
}
"""Scenes, step [s], how many, and start."""


def differs(found: Result, reference: Result) -> float:
    """The largest difference of motions, forces and energies, relative to the largest value of its quantity."""
    pairs: list[tuple[np.ndarray, np.ndarray]] = []
    for name, body in reference.history.bodies.items():
        own = found.history.bodies[name]
        pairs += [(getattr(own, n), getattr(body, n)) for n in ("position", "velocity", "angular_velocity", "modal")]
    for name, contact in reference.history.contacts.items():
        pairs.append((found.history.contacts[name].pressure, contact.pressure))
    pairs += [(found.history.energy[name], line) for name, line in reference.history.energy.items()]
    return max((float(np.abs(a - b).max() / np.abs(b).max()) for a, b in pairs if b.size and np.any(b)), default=0.0)


def one_by_one(scenes: Sequence[Scene], duration: float, **options: Any) -> list[Result]:
    return [simulate(scene, duration, **options) for scene in scenes]


def measured(
    run: Callable[..., list[Result]], scenes: list[Scene], duration: float, options: dict[str, Any]
) -> tuple[dict[str, float], list[Result]]:
    """Seconds per run of the whole and its parts, and the results."""
    begin = time.perf_counter()
    found = run(scenes, duration, **options)
    whole = time.perf_counter() - begin
    if any(result.status != "completed" for result in found):
        raise RuntimeError("; ".join({f"{result.status}: {result.message}" for result in found}))
    times = {"whole": whole / len(found)}
    for part, counter in PARTS.items():
        each = [result.history.counters[counter] for result in found]
        of_all = run is simulate_worlds and part != "finish"  # set-up and graph are those of all
        times[part] = max(each) / len(found) if of_all else float(np.mean(each))
    times["rest"] = times["whole"] - sum(times[part] for part in PARTS)
    return times, found


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--worlds", type=int, default=WORLDS)
    parser.add_argument("--rounds", type=int, default=ROUNDS)
    parser.add_argument("--device", default="cpu")
    parser.add_argument("--cases", nargs="*", default=list(CASES), choices=list(CASES), metavar="NAME")
    parser.add_argument("--json", type=Path, help="write machine, versions and rows to this file")
    given = parser.parse_args()
    print(f"{given.worlds} runs on {given.device}, ms a run")
    print("scenes    steps           whole   set-up    graph   finish     rest   times  differs")
    rows = []
    for name in given.cases:
        build, step, steps, start = CASES[name]
        scenes = build(given.worlds)
        options: dict[str, Any] = {
            "step": step,
            "start": start,
            "progress": False,
            "options": RunOptions(device=given.device),
        }
        simulate(scenes[0], steps * step, **options)  # compiles the kernels
        rounds = []
        for _ in range(given.rounds):
            rounds.append([measured(how, scenes, steps * step, options) for how in (one_by_one, simulate_worlds)])
        apart, together = (min((pair[i] for pair in rounds), key=lambda one: one[0]["whole"]) for i in (0, 1))
        times = apart[0]["whole"] / together[0]["whole"]
        difference = max(differs(a, b) for a, b in zip(together[1], apart[1], strict=True))
        for how, (seconds, _) in (("apart", apart), ("together", together)):
            times_of = {f"{part}_seconds_per_step": value / steps for part, value in seconds.items()}
            rows.append({"scene": name, "case": how, "runs": given.worlds, "steps": steps, **times_of})
            columns = " ".join(f"{1e3 * seconds[part]:8.2f}" for part in ("whole", *PARTS, "rest"))
            ends = f"{times:7.2f}  {difference:.1e}" if how == "together" else ""
            print(f"{name:9} {steps:5}  {how:7} {columns} {ends}".rstrip(), flush=True)
        rows[-1] |= {"times": times, "differs": difference}
    if given.json:
        given.json.parent.mkdir(parents=True, exist_ok=True)
        given.json.write_text(json.dumps({**machine(), "rows": rows}, indent=1) + "\n")


if __name__ == "__main__":
    main()
