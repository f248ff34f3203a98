"""Step time against active cells of a patch.

`python bench/step/step_vs_cells.py [--json FILE] [--steps N] [--rounds N]`.

Two hollow rollers of 8 mm hexahedra roll on each other at a constant approach, half of the contact a twentieth of an
element wide. Cells travel with the patch; the mesh stays the same, and the number of cells varies from row to row.
"""

from __future__ import annotations

import argparse
import json
from pathlib import Path

import numpy as np

from scenes.rollers import PAIR, STEEL
from studies.speed.step_time import StepTime, measured
from warpffrf.model import joints, signals
from warpffrf.model.contact import Contact
from warpffrf.model.mesh import roller
from warpffrf.model.reduced.body import ReducedBody
from warpffrf.model.scene import Scene
from warpffrf.model.surfaces import Cylinder
from warpffrf.offline import ContactGrid, reduce
from warpffrf.online import run
from warpffrf.study.machine import machine

RADIUS, BORE, WIDTH = 0.05, 0.015, 0.02  # m
SECTORS = 40
APPROACH = 20e-6  # m
STEP = 1e-4  # s
TURN = 2.0 * 2.0 * np.pi / SECTORS / 6e-3  # rad/s: two elements in 60 steps
CELLS = ((8, 8), (10, 12), (11, 21), (15, 21), (19, 27), (27, 41), (41, 61), (61, 91))  # strips, rows


def body() -> ReducedBody:
    """A roller of eight-node hexahedra, its far field with it."""
    mesh = roller(RADIUS, BORE, WIDTH, sectors=SECTORS, layers=4, axial=3, order=1)
    return reduce(
        mesh, STEEL, interfaces={"bore": "rigid"}, contact={"rim": Cylinder()}, max_frequency=12e3,
        grid=ContactGrid(contact_fixed=True), progress=False,
    )  # fmt: skip


def rolling_pair(one: ReducedBody, cells: tuple[int, int]) -> Scene:
    """Two of them with axles at the distance 2 R - APPROACH, both driven to roll on each other."""
    scene = Scene(gravity=(0, 0, 0))
    lower = scene.add_body(one, name="lower")
    upper = scene.add_body(one, name="upper", position=(0, 0, 2 * RADIUS - APPROACH))
    for placed, sense in ((lower, 1.0), (upper, -1.0)):
        axle = scene.add(joints.Revolute(scene.ground, placed["bore"], axis=(0, 1, 0)))
        ramp = signals.Ramp(0.0, sense * TURN, duration=10.0 * STEP)
        scene.add(joints.Drive(axle, ramp, quantity="velocity"))
    scene.add(Contact(lower["rim"], upper["rim"], name=PAIR, grid="contact_fixed", cells=cells))
    return scene


def time_cells(one: ReducedBody, cells: tuple[int, int], *, steps: int, rounds: int) -> StepTime:
    """The fastest of a few runs: other work on the machine only slows down."""
    scene = rolling_pair(one, cells)
    histories = [
        run(scene, steps * STEP, step=STEP, start="equilibrium", progress=False) for _ in range(rounds)
    ]  # fmt: skip
    return min((measured(h, one.local_modes) for h in histories), key=lambda r: r.seconds_per_step)


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--json", type=Path, help="write machine, versions and rows to this file")
    parser.add_argument("--steps", type=int, default=1000)
    parser.add_argument("--rounds", type=int, default=3)
    given = parser.parse_args()
    about = machine()
    unit = about["unit_seconds"]
    one = body()
    rows = []
    for cells in CELLS:
        found = time_cells(one, cells, steps=given.steps, rounds=given.rounds).row()
        rows.append({"table": "cells", "cells": cells, "unit_seconds": unit, **found})
    print(f"U = {unit * 1e6:.1f} us")
    print("  cells  active  retained columns  iterations  factorisations  us/step   U/step  status")
    for r in rows:
        place = f"{r['cells'][0]:3d}x{r['cells'][1]:<3d} {r['active_nodes']:7.1f} {r['retained_columns']:14d}"
        counts = f"{r['iterations']:11.2f} {r['factorisations']:15.2f}"
        print(f"{place} {counts} {r['seconds_per_step'] * 1e6:8.1f} {r['seconds_per_step'] / unit:8.2f}  {r['status']}")
    if given.json:
        given.json.write_text(json.dumps({**about, "rows": rows}, indent=1) + "\n")


if __name__ == "__main__":
    main()
