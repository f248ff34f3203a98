"""Speed at equal error: `python bench/contact_fixed_vs_body_fixed.py [--json FILE] [--rounds N] [--steps N] [--large]`.

Two hollow steel rollers (R 50, bore 15, width 20 mm, bores held at the distance that 9 kN ask for) roll on each other.
Pressures on the contact grid of the material, on meshes made for the contact, and on contact-fixed cells,
on meshes that are not. Time is that of reducing the body and of a run, build and notes with it; errors are the largest
of force and of peak pressure at mid-width over the run, against full finite elements (`verification/coarse_rollers`).
Of each family the cheapest row that keeps within 1 % of force and 2 % of pressure counts.
"""

from __future__ import annotations

import argparse
import json
import time
from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np

from scenes.user_meshes import gmsh_roller
from studies.contact import coarse_rollers as cr
from warpffrf.model.mesh import Mesh
from warpffrf.model.mesh import roller as roller_mesh
from warpffrf.model.reduced.body import ReducedBody
from warpffrf.model.surfaces import Cylinder
from warpffrf.offline import ContactGrid, reduce
from warpffrf.output.simulate import simulate
from warpffrf.study.machine import machine

LOAD = 9e3  # N
STEP, SPEED = 1e-4, 0.8  # s, rad/s: an element of 4 mm in 1000 steps
BEGUN = 20  # steps in which the rollers begin to turn
FORCE, PRESSURE = 0.01, 0.02  # errors allowed
MATERIAL = (
    (900, 10, 4, 1.6),
    (1350, 6, 2, 2.2),
    (1600, 6, 2, 2.2),
    (1800, 6, 2, 2.2),
    (1800, 8, 3, 1.9),
    (1800, 10, 4, 1.6),
    (2700, 12, 4, 1.6),
)  # sectors, layers, cells along, growth of layers inwards; hex27
LARGE = ("hex27, 1800 sectors, 10 layers, 4 along", "hex27, 2700 sectors, 12 layers, 4 along", "tet10 of 4 mm, Gmsh")
PATCH: dict[str, tuple[Callable[[], Mesh], tuple[int, int] | None]] = {
    "hex8 of 8 mm, 7 x 7 cells": (lambda: cr.hexahedra(8e-3, 1), (7, 7)),
    "hex8 of 8 mm": (lambda: cr.hexahedra(8e-3, 1), None),
    "hex8 of 4 mm, 9 x 11 cells": (lambda: cr.hexahedra(4e-3, 1), (9, 11)),
    "hex8 of 4 mm": (lambda: cr.hexahedra(4e-3, 1), None),
    "hex27 of 4 mm": (lambda: cr.hexahedra(4e-3), None),
    "tet10 of 4 mm, Gmsh": (gmsh_roller, None),
}  # fmt: skip


def fine(sectors: int, layers: int, axial: int, growth: float) -> ReducedBody:
    """A roller for pressures on the material's grid."""
    mesh = roller_mesh(
        cr.R, cr.BORE, cr.WIDTH, sectors=sectors, layers=layers, axial=axial, grading=growth, order=2
    )  # fmt: skip
    return reduce(
        mesh, cr.STEEL, interfaces={"bore": "rigid"}, contact={"rim": Cylinder()}, modes=0,
        grid=ContactGrid(contact_fixed=False), cache=False, progress=False,
    )  # fmt: skip


def cases() -> dict[tuple[str, str], tuple[Callable[[], ReducedBody], dict[str, Any]]]:
    """By family and name how to get the body, and the options of the contact."""
    found: dict[tuple[str, str], tuple[Callable[[], ReducedBody], dict[str, Any]]] = {}
    for size in MATERIAL:
        name = "hex27, {} sectors, {} layers, {} along".format(*size)
        found["material", name] = (lambda size=size: fine(*size), {"grid": "body_fixed", "capacity": 6000})
    for name, (mesh, cells) in PATCH.items():
        found["patch", name] = (lambda mesh=mesh: cr.reduced(mesh()), {"grid": "contact_fixed", "cells": cells})
    return found


def measured(body_of: Callable[[], ReducedBody], contact: dict[str, Any], reference: Any, steps: int) -> dict[str, Any]:
    """Seconds and errors of one case."""
    begin = time.perf_counter()
    body = body_of()
    offline = time.perf_counter() - begin
    scene = cr.held(body, body, 2.0 * reference.approach, turning=SPEED, **contact)
    begin = time.perf_counter()
    result = simulate(scene, steps * STEP, step=STEP, start="equilibrium", progress=False)
    online = time.perf_counter() - begin
    if result.status != "completed":
        raise RuntimeError(result.message)
    pair: Any = result.contact(cr.PAIR)
    return {
        "dofs": int(body.report["dofs"]),
        "active": int(pair.history.active_nodes[-1]),
        "offline": offline,
        "online": online,
        "force": _largest(pair.force_magnitude[BEGUN:] / LOAD - 1.0),
        "pressure": _largest(pair.mid_peak_pressure[BEGUN:] / reference.middle - 1.0),
    }


def _largest(errors: np.ndarray) -> float:
    return float(errors[np.argmax(np.abs(errors))])


def seconds(row: dict[str, Any]) -> float:
    """Wall time of a row, offline and online [s]."""
    return row["offline"] + row["online"]


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--json", type=Path, help="write machine, versions and rows to this file")
    parser.add_argument("--rounds", type=int, default=1, help="of each case the fastest round counts")
    parser.add_argument("--steps", type=int, default=300)
    parser.add_argument("--large", action="store_true", help="add the three bodies that take longest to reduce")
    given = parser.parse_args()
    reference = cr.straight_reference(LOAD)
    every = {key: case for key, case in cases().items() if given.large or key[1] not in LARGE}
    for family in ("material", "patch"):  # kernels are compiled before anything is timed
        body_of, contact = next(value for (kind, _), value in every.items() if kind == family)
        measured(body_of, contact, reference, BEGUN + 1)
    rounds = [
        {key: measured(*case, reference, given.steps) for key, case in every.items()} for _ in range(given.rounds)
    ]  # fmt: skip
    rows = [
        {"table": family, "name": name, **min((r[family, name] for r in rounds), key=seconds)} for family, name in every
    ]
    print("grid      body                                       dofs  active  offline [s]  run [s]    force  pressure")
    for r in rows:
        print(f"{r['table']:9} {r['name']:36} {r['dofs']:10d} {r['active']:7d} {r['offline']:12.2f} {r['online']:8.2f} "
              f"{r['force']:+8.2%} {r['pressure']:+9.2%}")  # fmt: skip
    good = [r for r in rows if abs(r["force"]) < FORCE and abs(r["pressure"]) < PRESSURE]
    best = {family: min((r for r in good if r["table"] == family), key=seconds) for family in ("material", "patch")}
    ratio = seconds(best["material"]) / seconds(best["patch"])
    print(f"within {FORCE:.0%} of force and {PRESSURE:.0%} of pressure: "
          f"{best['material']['name']} {seconds(best['material']):.2f} s, {best['patch']['name']} "
          f"{seconds(best['patch']):.2f} s, {ratio:.1f} times less")  # fmt: skip
    if given.json:
        given.json.write_text(json.dumps({**machine(), "rows": rows, "ratio": ratio}, indent=1) + "\n")


if __name__ == "__main__":
    main()
