"""What a step from Python costs beyond its graph: `python bench/stepping.py [--json FILE] [--rounds R] [--steps N]`.

A rigid rotor with a torque, the smallest scene with an input, so that the graph is short: a `Simulation` that is only
stepped, with an input changed before every step, with outputs read after it, and with a PID; and `simulate`, whose
chunks of steps are one replay each. Time in the graph is that of the calls that replay it, in the same loop; what is
beyond is the rest, with the looks at the run every two hundred steps. The least of the rounds, in each of which every
loop runs once: other work on the machine only adds to it.
"""

from __future__ import annotations

import argparse
import json
import time
from collections.abc import Callable
from pathlib import Path
from typing import Any

import warp as wp

import warpffrf as wf
from warpffrf.study.machine import machine

STEP = 1e-3  # s
SPEED, ANGLE = "body_angular_velocity_y[rotor]", "joint_coordinate[shaft]"
spent = 0.0  # s in replays


def timed(replay: Callable[..., None]) -> Callable[..., None]:
    """`replay`, with its time added to `spent`."""

    def call(*args: Any, **options: Any) -> None:
        global spent
        begin = time.perf_counter()
        replay(*args, **options)
        spent += time.perf_counter() - begin

    return call


def rotor(torque: wf.signals.Input) -> wf.Scene:
    """A rotor about a fixed axis, under the torque."""
    rig = wf.Scene()
    body = rig.add_rigid_body(1.0, (0.1, 0.2, 0.1), name="rotor")
    rig.add(wf.joints.Revolute(rig.ground, body, axis=(0, 1, 0), name="shaft"))
    rig.add(wf.forces.PointTorque(body, (torque, (0, 1, 0))))
    return rig


def stepped(steps: int, each: Callable[[wf.Simulation, int], object], controlled: bool = False) -> tuple[float, float]:
    """Seconds of a loop over steps, and those in the graph."""
    global spent
    torque = wf.signals.Input("torque")
    pid = wf.control.PID(SPEED, torque, reference=10.0, kp=2.0, ki=5.0)
    sim = wf.Simulation(rotor(torque), step=STEP, controllers=[pid] if controlled else [])
    each(sim, 0)
    spent = 0.0
    begin = time.perf_counter()
    for n in range(steps):
        each(sim, n)
    return time.perf_counter() - begin, spent


def changed(sim: wf.Simulation, n: int) -> None:
    sim.inputs["torque"] = float(n % 7)
    sim.step()


def simulated(steps: int) -> tuple[float, float]:
    found = wf.simulate(rotor(wf.signals.Input("torque", 1.0)), steps * STEP, step=STEP, progress=False)
    counters = found.history.counters
    return counters["loop_seconds"], counters["seconds_in_graph"]


LOOPS: dict[str, Callable[[int], tuple[float, float]]] = {
    "sim.step()": lambda n: stepped(n, lambda sim, i: sim.step()),
    "an input changed": lambda n: stepped(n, changed),
    "a speed read": lambda n: stepped(n, lambda sim, i: (sim.step(), sim.outputs[SPEED])),
    "an angle read": lambda n: stepped(n, lambda sim, i: (sim.step(), sim.outputs[ANGLE])),
    "a PID of the speed": lambda n: stepped(n, lambda sim, i: sim.step(), controlled=True),
    "simulate": simulated,
}


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--json", type=Path, help="write machine, versions and rows to this file")
    parser.add_argument("--rounds", type=int, default=10)
    parser.add_argument("--steps", type=int, default=1000)
    given = parser.parse_args()
    wp.capture_launch = timed(wp.capture_launch)
    found: dict[str, list[tuple[float, float]]] = {name: [] for name in LOOPS}
    for _ in range(given.rounds):
        for name, loop in LOOPS.items():
            found[name].append(loop(given.steps))
    rows = []
    print(f"{given.steps} steps, the least of {given.rounds} rounds, us per step")
    print("loop                   whole  graph  beyond")
    for name, times in found.items():
        whole, graph = (1e6 * min(values) / given.steps for values in zip(*times, strict=True))
        beyond = 1e6 * min(whole - graph for whole, graph in times) / given.steps
        rows.append({"loop": name, "microseconds": whole, "graph": graph, "beyond": beyond})
        print(f"{name:20s} {whole:7.1f} {graph:6.1f} {beyond:7.1f}")
    if given.json:
        given.json.write_text(json.dumps({**machine(), "steps": given.steps, "rows": rows}, indent=1) + "\n")


if __name__ == "__main__":
    main()
