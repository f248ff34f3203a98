"""Step time against the number of pairs on one surface: `python bench/step_vs_pairs.py [--json FILE] [--steps N]`.

A driven roller with one to eight others around it, without and with friction. *Per pair* is the time of a step over
that of one pair alone times the number of pairs, in the same run: above 1 is what the pairs cost each other.
"""

from __future__ import annotations

import argparse
import json
from pathlib import Path
from typing import Any

from warpffrf.model import mesh
from warpffrf.model.surfaces import Cylinder
from warpffrf.offline import reduce
from warpffrf.online import run
from warpffrf.study.step_time import machine
from warpffrf.verification.scenes.planets import planets
from warpffrf.verification.scenes.rollers import STEEL

PAIRS = (1, 2, 4, 8)
LOAD, FRICTION, CREEPAGE = 100e3, 0.3, 2e-3  # N on a width of 10 mm, -, -
STEP = 1e-4  # s
ROUNDS = 2


def timed(body: Any, pairs: int, friction: float, steps: int) -> dict[str, Any]:
    """Figures of the fastest of a few runs: other work on the machine only slows down."""
    scene = planets(body, pairs, LOAD, friction=friction, creepage=CREEPAGE)
    runs = [run(scene, steps * STEP, step=STEP, start="equilibrium", progress=False) for _ in range(ROUNDS)]
    best = min(runs, key=lambda h: h.counters["seconds_in_graph"])
    c = best.counters
    return {
        "pairs": pairs, "friction": friction, "status": best.status,
        "active": sum(float(contact.active_hats.mean()) for contact in best.contacts.values()),
        "iterations": c["mean_iterations"], "seconds_per_step": c["seconds_in_graph"] / max(c["steps"], 1),
    }  # fmt: skip


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--json", type=Path, help="write machine, versions and rows to this file")
    parser.add_argument("--steps", type=int, default=100)
    given = parser.parse_args()
    about = machine()
    body = reduce(
        mesh.roller(0.05, 0.015, 0.01, sectors=240, layers=5, axial=4, grading=1.6, order=1), STEEL,
        interfaces={"bore": "rigid"}, contact={"rim": Cylinder()}, modes=20, tangential=True, progress=False,
    )  # fmt: skip
    rows = [timed(body, pairs, friction, given.steps) for friction in (0.0, FRICTION) for pairs in PAIRS]
    print(f"U = {about['unit_seconds'] * 1e6:.1f} us")
    print("friction  pairs  active  iterations  us/step   U/step  per pair  status")
    for row in rows:
        alone = next(r for r in rows if r["friction"] == row["friction"] and r["pairs"] == 1)
        row["per_pair"] = row["seconds_per_step"] / (row["pairs"] * alone["seconds_per_step"])
        print(
            f"{row['friction']:8.1f} {row['pairs']:6d} {row['active']:7.1f} {row['iterations']:11.2f} "
            f"{row['seconds_per_step'] * 1e6:8.1f} {row['seconds_per_step'] / about['unit_seconds']:8.2f} "
            f"{row['per_pair']:9.2f}  {row['status']}"
        )
    if given.json:
        given.json.write_text(json.dumps({**about, "rows": rows}, indent=1) + "\n")


if __name__ == "__main__":
    main()
