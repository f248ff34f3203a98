"""Step time against local modes per roller: `python bench/step/step_vs_modes.py [--json FILE] [--steps N] [--large]`.

Same mesh, contact grid, approach and speed; the arc of the rim that carries nodes grows, and the patch runs over fresh
nodes. `--large`: to 16,000 local modes on a mesh with twice as many cells around; its reductions take minutes.
"""

from __future__ import annotations

import argparse
import json
from pathlib import Path

from studies.speed.step_time import StepTime, time_swing, tread_body
from warpffrf.study.machine import machine

SECTORS, COLUMNS = 960, (56, 222, 889)  # with 9 nodes each: 504, 1,998 and 8,001 local modes
LARGE_SECTORS, LARGE_COLUMNS = 1920, (56, 222, 889, 1778)  # to 16,002
APPROACH = 60e-6  # m: about 45 active nodes
ROUNDS = 3  # the fastest counts: other work on the machine only slows down


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--json", type=Path, help="write machine, versions and rows to this file")
    parser.add_argument("--steps", type=int, default=2000)
    parser.add_argument("--large", action="store_true", help="to 16,000 local modes, on a finer mesh")
    given = parser.parse_args()
    sectors, columns = (LARGE_SECTORS, LARGE_COLUMNS) if given.large else (SECTORS, COLUMNS)
    about = machine()
    unit = about["unit_seconds"]
    bodies = [tread_body(count, sectors=sectors) for count in columns]
    best: dict[int, StepTime] = {}
    for _ in range(ROUNDS):
        for body in bodies:
            found = time_swing(body, approach=APPROACH, steps=given.steps)
            if body.local_modes not in best or found.seconds_per_step < best[body.local_modes].seconds_per_step:
                best[body.local_modes] = found
    rows = [{**found.row(), "unit_seconds": unit} for found in best.values()]
    print(f"U = {unit * 1e6:.1f} us")
    print("local modes  active  retained columns  iterations  us/step   U/step  outside graph  status")
    for r in rows:
        steps = f"{r['seconds_per_step'] * 1e6:8.1f} {r['seconds_per_step'] / unit:8.2f}"
        counts = f"{r['local_modes']:11d} {r['active_nodes']:7.1f} {r['retained_columns']:14d} {r['iterations']:11.2f}"
        print(f"{counts} {steps} {r['outside_graph']:13.1%}  {r['status']}")
    print(f"last over first: {rows[-1]['seconds_per_step'] / rows[0]['seconds_per_step']:.3f}")
    if given.json:
        given.json.write_text(json.dumps({**about, "rows": rows}, indent=1) + "\n")


if __name__ == "__main__":
    main()
