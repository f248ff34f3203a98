"""Step time against the number of pairs: `python bench/step/step_vs_pairs.py [--json FILE] [--steps N] [--only NAME]`.

*sun*: a driven roller with one to eight others around it, all on its one surface; *rings*: rollers between two rings,
two pairs each. Without and with friction. *Per pair* is the time of a step over that of one pair alone times the number
of pairs, in the same run: above 1 is what the pairs cost each other. One pair of the rings is the mean of one roller on
the inner and one in the outer ring.
"""

from __future__ import annotations

import argparse
import json
from collections.abc import Callable
from pathlib import Path
from typing import Any

from scenes.flat_settings import reduce_flat
from scenes.planets import planets
from scenes.rollers import STEEL
from scenes.two_rings import two_rings
from warpffrf.model import mesh
from warpffrf.model.scene import Scene
from warpffrf.model.surfaces import Bore, Cylinder
from warpffrf.offline import ContactGrid, reduce
from warpffrf.online import run
from warpffrf.study.machine import machine

LOAD, FRICTION, CREEPAGE = 100e3, 0.3, 2e-3  # N on a width of 10 mm, -, -
RADIUS, ROLLER, INTERFERENCE, WIDTH = 0.05, 0.009, 2e-4, 0.01  # m
STEP = 1e-4  # s
ROUNDS = 2


def suns() -> dict[int, list[Callable[[float], Scene]]]:
    """Scenes by the number of pairs, as functions of the coefficient of friction."""
    body = reduce(
        mesh.roller(RADIUS, 0.015, WIDTH, sectors=240, layers=5, axial=4, grading=1.6, order=1), STEEL,
        interfaces={"bore": "rigid"}, contact={"rim": Cylinder()}, modes=20,
        grid=ContactGrid(tangential=True, contact_fixed=False), progress=False,
    )  # fmt: skip
    return {
        pairs: [lambda mu, pairs=pairs: planets(body, pairs, LOAD, friction=mu, creepage=CREEPAGE)]
        for pairs in (1, 2, 4, 8)
    }


def rings() -> dict[int, list[Callable[[float], Scene]]]:
    """The same of rollers between rings."""
    cells: dict[str, Any] = {"layers": 4, "axial": 4, "grading": 1.6, "order": 1}
    options: dict[str, Any] = {"tangential": True, "contact_fixed": False, "progress": False}
    bore = RADIUS + 2.0 * ROLLER - INTERFERENCE
    roller, inner = (
        reduce_flat(
            mesh.roller(radius, hole, WIDTH, sectors=sectors, **cells), STEEL, interfaces={"bore": "rigid"},
            contact={"rim": Cylinder()}, modes=modes, **options,
        )
        for radius, hole, sectors, modes in ((ROLLER, 0.003, 120, 10), (RADIUS, 0.035, 480, 20))
    )  # fmt: skip
    outer = reduce_flat(
        mesh.sleeve(bore, 0.085, WIDTH, sectors=480, **cells), STEEL, interfaces={"outside": "rigid"},
        contact={"bore": Bore()}, modes=20, **options,
    )  # fmt: skip

    def scene(count: int, *names: str) -> Callable[[float], Scene]:
        return lambda mu: two_rings(
            inner, roller, outer, count, rings=names, friction=mu, creepage=CREEPAGE if mu else 0.0
        )

    found = {2 * count: [scene(count, "inner", "outer")] for count in (4, 9, 18)}
    return {1: [scene(1, "inner"), scene(1, "outer")], **found}


SCENES = {"sun": suns, "rings": rings}


def timed(scene: Scene, steps: int) -> dict[str, Any]:
    """Figures of the fastest of a few runs: other work on the machine only slows down."""
    runs = [run(scene, steps * STEP, step=STEP, start="equilibrium", progress=False) for _ in range(ROUNDS)]
    best = min(runs, key=lambda h: h.counters["seconds_in_graph"])
    c = best.counters
    return {
        "status": best.status, "active": sum(float(contact.active_nodes.mean()) for contact in best.contacts.values()),
        "iterations": c["mean_iterations"], "seconds_per_step": c["seconds_in_graph"] / max(c["steps"], 1),
    }  # fmt: skip


def table(name: str, friction: float, steps: int, unit: float) -> list[dict[str, Any]]:
    """Rows of one family of scenes, printed as they come."""
    rows: list[dict[str, Any]] = []
    for pairs, scenes in SCENES[name]().items():
        found = [timed(make(friction), steps) for make in scenes]
        mean = {key: sum(f[key] for f in found) / len(found) for key in ("active", "iterations", "seconds_per_step")}
        row = {"scene": name, "friction": friction, "pairs": pairs, "status": found[-1]["status"], **mean}
        alone = rows[0] if rows else row
        row["per_pair"] = row["seconds_per_step"] / (pairs * alone["seconds_per_step"])
        rows.append(row)
        print(
            f"{name:6s} {friction:8.1f} {pairs:6d} {row['active']:7.1f} {row['iterations']:11.2f} "
            f"{row['seconds_per_step'] * 1e6:8.1f} {row['seconds_per_step'] / unit:8.2f} "
            f"{row['per_pair']:9.2f}  {row['status']}",
            flush=True,
        )
    return rows


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--json", type=Path, help="write machine, versions and rows to this file")
    parser.add_argument("--steps", type=int, default=60)
    parser.add_argument("--only", choices=SCENES, help="one family of scenes")
    given = parser.parse_args()
    about = machine()
    print(f"U = {about['unit_seconds'] * 1e6:.1f} us")
    print("scene  friction  pairs  active  iterations  us/step   U/step  per pair  status")
    rows = [
        row
        for name in ([given.only] if given.only else SCENES)
        for friction in (0.0, FRICTION)
        for row in table(name, friction, given.steps, about["unit_seconds"])
    ]
    if given.json:
        given.json.write_text(json.dumps({**about, "rows": rows}, indent=1) + "\n")


if __name__ == "__main__":
    main()
