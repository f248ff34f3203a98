"""Step time with friction: `python bench/step/friction_step.py [--json FILE] [--steps N] [--large]`.

Two rollers roll on each other at a constant load, the upper one a little slower, so that part of the patch sticks and
part slips. Rows: the same pair without friction, with friction at a creepage that leaves half of it sticking, and in
gross sliding; on cells of a fine grid bound to the material, and on contact-fixed cells over a mesh of
4 mm. Fastest of a few runs, in one process; U as everywhere (`warpffrf.study.machine`).
"""

from __future__ import annotations

import argparse
import json
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import warpffrf as wf
from warpffrf.online.compile import strips
from warpffrf.study.machine import machine, unit_seconds

RADIUS, BORE = 0.05, 0.015  # m
STEEL = wf.Material(210e9, 0.3, 7850.0, name="steel")
FRICTION = 0.3
SPEED = 10.0  # rad/s
ROUNDS = 3
# creepage over that of the limit of gross sliding, mu a/R': Q/(mu P) = 1 - (1 - x)^2
CASES = {"frictionless": (0.0, 0.5), "stick and slip": (FRICTION, 0.5), "sliding": (FRICTION, 3.0)}


@dataclass(frozen=True)
class Rollers:
    """A pair: `width` and half-width of the contact [m], mesh, cells of a patch or None for the grid of the material;
    `steps` a crossing of the patch."""

    name: str
    width: float
    half_width: float
    mesh: dict[str, Any]
    cells: tuple[int, int] | None
    steps: int


ROLLERS = (
    # three rows of nodes; eight columns in the half-width
    Rollers("grid", 0.005, 1.5e-3, {"sectors": 1680, "layers": 10, "axial": 2, "grading": 1.6, "order": 1}, None, 16),
    Rollers("patch", 0.02, 0.4e-3, {"sectors": 78, "layers": 8, "axial": 5, "order": 1}, (13, 10), 10),
    Rollers("patch", 0.02, 0.4e-3, {"sectors": 78, "layers": 8, "axial": 5, "order": 1}, (26, 20), 20),
)
LARGE = Rollers("patch", 0.02, 0.4e-3, {"sectors": 78, "layers": 8, "axial": 5, "order": 1}, (40, 30), 20)


def body(pair: Rollers) -> wf.ReducedBody:
    """A roller with tangential modes."""
    mesh = wf.mesh.roller(RADIUS, BORE, pair.width, **pair.mesh)
    return wf.reduce(
        mesh, STEEL, interfaces={"bore": "rigid"}, contact={"rim": wf.surfaces.Cylinder()}, modes=0,
        grid=wf.ContactGrid(tangential=True, contact_fixed=pair.cells is not None), progress=False,
    )  # fmt: skip


def scene(pair: Rollers, roller: wf.ReducedBody, friction: float, saturation: float) -> wf.Scene:
    """The pair, both bores driven, the upper one on a guide under the load that gives the half-width."""
    modulus = STEEL.youngs_modulus / (2.0 * (1.0 - STEEL.poisson_ratio**2))
    load = 3.141592653589793 * modulus * pair.half_width**2 / (4.0 * 0.5 * RADIUS) * pair.width
    creepage = saturation * FRICTION * pair.half_width / (0.5 * RADIUS)
    found, slower, at = wf.Scene(gravity=(0, 0, 0)), -SPEED * (1.0 - creepage), (0.0, 0.0, 2.0 * RADIUS)
    lower = found.add_body(roller, name="lower", angular_velocity=(0, SPEED, 0))
    upper = found.add_body(roller, name="upper", position=at, angular_velocity=(0, slower, 0))
    carriage = found.add_rigid_body(1.0, (1e-3, 1e-3, 1e-3), name="carriage", position=at)
    first = found.add(wf.joints.Revolute(found.ground, lower["bore"], axis=(0, 1, 0), name="first"))
    second = found.add(wf.joints.Revolute(carriage.at((0, 0, 0)), upper["bore"], axis=(0, 1, 0), name="second"))
    found.add(wf.joints.Prismatic(found.ground, carriage.at((0, 0, 0)), axis=(0, 0, 1), name="guide"))
    found.add(wf.forces.PointForce(carriage.at((0, 0, 0)), (0.0, 0.0, -load)))
    found.add(wf.joints.Drive(first, SPEED, quantity="velocity"))
    found.add(wf.joints.Drive(second, slower, quantity="velocity"))
    grid = "body_fixed" if pair.cells is None else "contact_fixed"
    found.add(wf.Contact(lower["rim"], upper["rim"], friction=friction, name="pair", grid=grid, cells=pair.cells))
    return found


def measure(pair: Rollers, roller: wf.ReducedBody, friction: float, saturation: float, steps: int) -> dict:
    """The fastest of a few runs: other work on the machine only slows down."""
    step = 2.0 * pair.half_width / pair.steps / (SPEED * RADIUS)
    best: dict = {"seconds_per_step": float("inf")}
    for _ in range(ROUNDS):
        result = wf.simulate(
            scene(pair, roller, friction, saturation), steps * step, step=step, start="equilibrium", progress=False
        )
        seconds = result.history.counters["seconds_in_graph"] / steps
        contact = result.history.contacts["pair"]
        if seconds < best["seconds_per_step"]:
            rubbing = contact.friction
            best = {
                "seconds_per_step": seconds, "status": result.status, "active": int(contact.active_nodes[-1]),
                "iterations": float(result.history.iterations[steps // 2 :].mean()),
                "stick": 0 if rubbing is None else int((rubbing.state[-1] == 1).sum()),
                "slip": 0 if rubbing is None else int((rubbing.state[-1] == 2).sum()),
                "rejected": result.history.counters["rejected_steps"],
            }  # fmt: skip
    return best


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--json", type=Path, help="write machine, versions and rows to this file")
    parser.add_argument("--steps", type=int, default=100)
    parser.add_argument("--large", action="store_true", help="only 40 x 30 cells, by strips and by blocks")
    given = parser.parse_args()
    about = machine()
    rows = []
    for pair in [LARGE] if given.large else ROLLERS:
        roller = body(pair)
        for fewest in (strips.FEWEST, 10**6) if given.large else (strips.FEWEST,):
            strips.FEWEST = fewest
            for name, (friction, saturation) in CASES.items():
                found = measure(pair, roller, friction, saturation, given.steps)
                unit = min(unit_seconds(), about["unit_seconds"])
                rows.append({"cells": pair.name, "case": name, "unit_seconds": unit, **found})
    print("cells  case            active  stick  slip  iterations  us/step   U/step  halved  status")
    for r in rows:
        counts = f"{r['active']:6d} {r['stick']:6d} {r['slip']:5d} {r['iterations']:11.2f}"
        time = f"{r['seconds_per_step'] * 1e6:8.1f} {r['seconds_per_step'] / r['unit_seconds']:8.2f}"
        print(f"{r['cells']:6s} {r['case']:15s} {counts} {time} {r['rejected']:7.0f}  {r['status']}")
    if given.json:
        given.json.write_text(json.dumps({**about, "rows": rows}, indent=1) + "\n")


if __name__ == "__main__":
    main()
