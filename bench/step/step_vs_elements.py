"""Step time against rolling elements.

`python bench/step/step_vs_elements.py [--json FILE] [--elements N ...] [--rounds N]`.

Cylindrical roller bearings with rigid rings, rollers of laminae by ISO/TS 16281, friction on raceways and in the
pockets of a cage, under a radial load, the inner ring at 1,000 rpm. The pitch diameter grows with the number of
rollers, so that these are as far apart as before. *Per element*: the time of a step over that of the first row, times
the ratio of the numbers of elements: above 1 is what elements cost each other. The last row is one whole revolution
with 12 rollers, its wall time with all that a run does, and what its energy balance lacks of the energy at hand.
"""

from __future__ import annotations

import argparse
import json
import time
from pathlib import Path

import numpy as np

from warpffrf.model import forces, friction, joints, signals
from warpffrf.model.bearings import PocketCage, RollerGeometry, RollingContact
from warpffrf.model.scene import Scene
from warpffrf.online import History, run
from warpffrf.output.options import RunOptions
from warpffrf.output.simulate import simulate
from warpffrf.study.machine import machine

DIAMETER, LENGTH, SPACING, CLEARANCE = 0.01, 0.0096, 14.4e-3, 20e-6  # m; spacing along the pitch circle
LOAD, SPEED = 4000.0, 1000.0 * np.pi / 30.0  # N, rad/s
TRACTION = friction.RegularisedCoulomb(0.05, 0.01)
STEP, STEPS, SAVE_EVERY = 5e-5, 60, 10  # s: a third of a degree of the ring
ELEMENTS, REVOLUTION = (6, 12, 24, 36), 12
ROUNDS = 3  # the fastest counts: other work on the machine only slows down


def bearing(count: int) -> Scene:
    """With `count` rollers, that begin to roll."""
    scene = Scene()
    one = scene.add_bearing(
        "b",
        RollerGeometry(
            elements=count, roller_diameter=DIAMETER, roller_length=LENGTH, pitch_diameter=count * SPACING / np.pi,
            clearance=CLEARANCE,
        ),
        first=(0, 0, 1), outer=scene.ground, cage=PocketCage(0.2e-3, friction=TRACTION),
        contact=RollingContact(friction=TRACTION),
    )  # fmt: skip
    center = one.inner.at((0, 0, 0))
    plane = scene.add(joints.Planar(scene.ground.at((0, 0, 0)), center, axis=(0, 1, 0), name="plane"))
    scene.add(joints.Drive(plane, signals.Constant(SPEED), name="drive"))
    scene.add(forces.PointForce(center, (0.0, 0.0, LOAD), name="load"))
    one.roll(SPEED)
    return scene


def time_bearing(count: int, rounds: int) -> dict:
    """Figures of the fastest of a few runs."""
    histories: list[History] = []
    for _ in range(rounds):
        scene = bearing(count)
        histories.append(
            run(scene, STEPS * STEP, step=STEP, start="equilibrium", save_every=SAVE_EVERY, progress=False)
        )
        if histories[-1].status != "completed":
            raise SystemExit(f"{count} elements: {histories[-1].status}: {histories[-1].message}")
    c = min(histories, key=lambda h: h.counters["seconds_in_graph"]).counters
    return {
        "elements": count, "retained_columns": int(c["retained_columns"]), "iterations": c["mean_iterations"],
        "steps": int(c["steps"]), "rejected_steps": int(c["rejected_steps"]),
        "seconds_per_step": c["seconds_in_graph"] / max(c["steps"], 1),
    }  # fmt: skip


def revolution(count: int) -> dict:
    """One turn of the inner ring."""
    begun = time.perf_counter()
    result = simulate(
        bearing(count),
        2.0 * np.pi / SPEED,
        step=STEP,
        start="equilibrium",
        options=RunOptions(save_every=SAVE_EVERY),
        progress=False,
    )
    wall = time.perf_counter() - begun
    if result.status != "completed":
        raise SystemExit(f"one revolution: {result.status}: {result.message}")
    found = result.bearing("b")
    return {
        "elements": count, "wall_seconds": wall, "steps": int(result.history.counters["steps"]),
        "energy_lacking": float(np.ptp(result.energy_residual)),
        "friction_torque": float(found.friction_torque[len(found.time) // 2 :].mean()),
    }  # fmt: skip


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--json", type=Path, help="write machine, versions and rows to this file")
    parser.add_argument("--elements", type=int, nargs="*", default=list(ELEMENTS))
    parser.add_argument("--rounds", type=int, default=ROUNDS)
    given = parser.parse_args()
    about = machine()
    unit = about["unit_seconds"]
    print(f"U = {unit * 1e6:.1f} us")
    print("elements  retained columns  iterations  us/step   U/step  per element")
    rows: list[dict] = []
    for count in given.elements:
        row = time_bearing(count, given.rounds)
        rows.append(row)
        first = rows[0]
        row["per_element"] = row["seconds_per_step"] / count / (first["seconds_per_step"] / first["elements"])
        print(
            f"{count:8d} {row['retained_columns']:14d} {row['iterations']:11.2f} {row['seconds_per_step'] * 1e6:8.1f} "
            f"{row['seconds_per_step'] / unit:8.2f} {row['per_element']:12.2f}",
            flush=True,
        )
    turn = revolution(REVOLUTION)
    print(
        f"one revolution, {turn['elements']} rollers: {turn['wall_seconds']:.1f} s for {turn['steps']} steps, energy "
        f"lacking {turn['energy_lacking']:.1e}, friction {turn['friction_torque']:.3f} N m"
    )
    if given.json:
        given.json.write_text(json.dumps({**about, "rows": rows, "revolution": turn}, indent=1) + "\n")


if __name__ == "__main__":
    main()
