"""Step time against flexible bodies in contact: `python bench/step/step_vs_bodies.py [--json FILE] [--steps N]`.

A train of equal rollers side by side, axles at fixed distances that press each on the next, driven to roll on each
other: n bodies, n - 1 pairs, every inner roller in two. *Per body*: the time of a step over that of two rollers, times
2/n: above 1 is what the bodies cost each other.
"""

from __future__ import annotations

import argparse
import json
from pathlib import Path

import numpy as np

from studies.speed.step_time import RADIUS, tread_body
from warpffrf.model import joints, signals
from warpffrf.model.contact import Contact
from warpffrf.model.reduced.body import ReducedBody
from warpffrf.model.scene import Scene
from warpffrf.online import run
from warpffrf.study.machine import machine

SECTORS, LAYERS, AXIAL = 480, 8, 4
APPROACH = 40e-6  # m of each pair
STEP, RATE = 1e-4, 10.0  # s, rad/s: an eighth of a column a step
BODIES = (2, 4, 8, 16)
ROUNDS = 3  # the fastest counts: other work on the machine only slows down


def train(body: ReducedBody, count: int) -> Scene:
    """`count` rollers along x."""
    scene = Scene(gravity=(0.0, 0.0, 0.0))
    placed = []
    for i in range(count):
        one = scene.add_body(body, name=f"roller_{i}", position=(i * (2.0 * RADIUS - APPROACH), 0.0, 0.0))
        axle = scene.add(joints.Revolute(scene.ground, one["bore"], axis=(0, 1, 0)))
        ramp = signals.Ramp(0.0, (-1.0) ** i * RATE, duration=10.0 * STEP)
        scene.add(joints.Drive(axle, ramp, quantity="velocity"))
        placed.append(one)
    for before, after in zip(placed[:-1], placed[1:], strict=True):
        scene.add(Contact(before["rim"], after["rim"]))
    return scene


def time_train(body: ReducedBody, count: int, steps: int) -> dict:
    """Figures of the fastest of a few runs."""
    histories = [
        run(train(body, count), steps * STEP, step=STEP, start="equilibrium", progress=False) for _ in range(ROUNDS)
    ]
    best = min(histories, key=lambda h: h.counters["seconds_in_graph"])
    c = best.counters
    return {
        "bodies": count, "pairs": count - 1, "local_modes": body.local_modes, "status": best.status,
        "active": float(np.sum([contact.active_nodes.mean() for contact in best.contacts.values()])),
        "retained_columns": int(c["retained_columns"]), "iterations": c["mean_iterations"],
        "seconds_per_step": c["seconds_in_graph"] / max(c["steps"], 1),
    }  # fmt: skip


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--json", type=Path, help="write machine, versions and rows to this file")
    parser.add_argument("--steps", type=int, default=100)
    parser.add_argument("--bodies", type=int, nargs="*", default=list(BODIES))
    given = parser.parse_args()
    about = machine()
    unit = about["unit_seconds"]
    body = tread_body(None, sectors=SECTORS, layers=LAYERS, axial=AXIAL)
    print(f"U = {unit * 1e6:.1f} us, {body.local_modes} local modes a body")
    print("bodies  pairs  active  retained columns  iterations  us/step   U/step  per body  status")
    rows: list[dict] = []
    for count in given.bodies:
        row = time_train(body, count, given.steps)
        rows.append(row)
        first = rows[0]
        row["per_body"] = row["seconds_per_step"] / count / (first["seconds_per_step"] / first["bodies"])
        print(
            f"{count:6d} {row['pairs']:6d} {row['active']:7.1f} {row['retained_columns']:14d} "
            f"{row['iterations']:11.2f} "
            f"{row['seconds_per_step'] * 1e6:8.1f} {row['seconds_per_step'] / unit:8.2f} {row['per_body']:9.2f}  "
            f"{row['status']}",
            flush=True,
        )
    if given.json:
        given.json.write_text(json.dumps({**about, "rows": rows}, indent=1) + "\n")


if __name__ == "__main__":
    main()
