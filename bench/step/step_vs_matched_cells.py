"""Step time against active cells of a joint interface.

`python bench/step/step_vs_matched_cells.py [--json FILE] [--steps N] [--large]`.

A plate lies on another one, pressed by its weight so that all cells are closed, and is shaken along its plane. A weak
shaking lets few cells slip, and few change in a step; a strong one moves the border of slip through the joint. --large
adds 1,200 cells, whose bodies take half a minute to reduce.
"""

from __future__ import annotations

import argparse
import json
from pathlib import Path
from typing import Any

import numpy as np

from scenes.rollers import STEEL
from warpffrf.model import forces, joints, signals
from warpffrf.model.contact import Contact
from warpffrf.model.mesh import box
from warpffrf.model.reduced.body import ReducedBody
from warpffrf.model.scene import Scene
from warpffrf.model.surfaces import Matched
from warpffrf.offline import reduce
from warpffrf.online import run
from warpffrf.study.machine import machine

SIZE = (0.2, 0.15, 0.01)  # m
GRAVITY = 2e5  # m/s2: presses with some 15 MPa
FRICTION = 0.3
PERIOD = 2e-3  # s, of the shaking; steps are a two-hundredth of it
SHAKEN = (0.0, 0.02, 0.05)  # force over weight
CELLS, LARGE = ((10, 8), (20, 15)), ((40, 30),)
MODES = 10  # of each plate


def plate(cells: tuple[int, int], face: str) -> ReducedBody:
    """A plate of eight-node hexahedra with a joint interface face, held at the other face or pulled at its end."""
    interface = {"z_min": "rigid"} if face == "z_max" else {"x_max": "average"}
    return reduce(
        box(SIZE, (*cells, 2), order=1),
        STEEL,
        interfaces=interface,
        contact={"face": Matched(first=face)},
        modes=MODES,
        progress=False,
    )


def shaken(lower: ReducedBody, upper: ReducedBody, part: float) -> Scene:
    """The upper plate on the lower one, pulled to and fro by a `part` of its weight."""
    scene = Scene(gravity=(0.0, 0.0, -GRAVITY))
    base = scene.add_body(lower, name="base", position=(0.0, 0.0, 0.5 * SIZE[2]))
    top = scene.add_body(upper, name="top", position=(0.0, 0.0, 1.5 * SIZE[2]), damping=0.02)
    scene.add(joints.Fixed(scene.ground, base["z_min"]))
    scene.add(Contact(top["face"], base["face"], sliding="small", friction=FRICTION, name="lap"))
    t = np.linspace(0.0, 4.0 * PERIOD, 161)
    pull = part * upper.mass * GRAVITY * np.sin(2.0 * np.pi * t / PERIOD)
    along, across = signals.Table(t, pull), signals.Table(t, 0.3 * pull)
    scene.add(forces.PointForce(top["x_max"], (along, across, 0.0)))
    return scene


def timed(scene: Scene, steps: int) -> dict[str, Any]:
    """One run; the time is that of the graph, without what leads to the equilibrium."""
    step = PERIOD / 200.0
    short, long = (run(scene, n * step, step=step, start="equilibrium", progress=False) for n in (5, steps))
    state = long.small_sliding["lap"].state
    seconds = (long.counters["seconds_in_graph"] - short.counters["seconds_in_graph"]) / (steps - 5)
    return {
        "closed": int(np.count_nonzero(state[-1])), "slipping": float(np.mean(np.sum(state == 2, axis=1))),
        "changes": float(np.mean(np.sum(np.diff(state, axis=0) != 0, axis=1))),
        "iterations": float(long.counters["mean_iterations"]), "seconds_per_step": seconds, "status": long.status,
    }  # fmt: skip


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--json", type=Path, help="write machine, versions and rows to this file")
    parser.add_argument("--steps", type=int, default=200)
    parser.add_argument("--large", action="store_true", help="1,200 cells, too")
    given = parser.parse_args()
    about = machine()
    unit = about["unit_seconds"]
    rows = []
    for cells in (*CELLS, *(LARGE if given.large else ())):
        lower, upper = plate(cells, "z_max"), plate(cells, "z_min")
        for part in SHAKEN:
            found = timed(shaken(lower, upper, part), given.steps)
            rows.append({"table": "lap", "cells": cells, "shaken": part, "unit_seconds": unit, **found})
    print(f"U = {unit * 1e6:.1f} us")
    print(" cells  shaken  closed  slipping  changes a step  iterations   us/step   U/step  status")
    for r in rows:
        place = f"{r['cells'][0] * r['cells'][1]:6d} {r['shaken']:7.2f} {r['closed']:7d} {r['slipping']:9.1f}"
        counts = f"{r['changes']:15.2f} {r['iterations']:11.2f}"
        print(f"{place} {counts} {r['seconds_per_step'] * 1e6:9.1f} {r['seconds_per_step'] / unit:8.2f}  {r['status']}")
    if given.json:
        given.json.write_text(json.dumps({**about, "rows": rows}, indent=1) + "\n")


if __name__ == "__main__":
    main()
