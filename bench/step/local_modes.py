"""Step time against local modes with inertia: `python bench/step/local_modes.py [--json FILE] [--steps N] [--counts
N]`.

Two rollers swing to and fro on each other at a constant approach (`studies.speed.step_time`). The lowest n local modes
of each contact surface get inertia, by HHT or by the exact step; the others follow the load without, as all do with
`quasi_static`, whose cost does not depend on how many there are. All runs of a round follow one another, so that other
work on the machine hits them alike; the fastest of the rounds counts.
"""

from __future__ import annotations

import argparse
import json
from pathlib import Path

from studies.speed.step_time import StepTime, time_swing, tread_body
from warpffrf.online import LocalModes
from warpffrf.study.machine import machine

SECTORS = 480  # 4,320 local modes of each roller, 9 a sector
COUNTS = (0, 50, 100, 200, 500, 1000, 2000)
TREATMENTS = ("hht", "exponential")
APPROACH = 60e-6  # m: about 18 active nodes
ROUNDS = 3  # the fastest counts: other work on the machine only slows down


def runs(counts: list[int]) -> list[LocalModes]:
    """What is timed: `quasi_static`, then every treatment with every number of modes."""
    return [LocalModes(), *(LocalModes(name, count=n) for n in counts for name in TREATMENTS)]


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--json", type=Path, help="write machine, versions and rows to this file")
    parser.add_argument("--steps", type=int, default=300)
    parser.add_argument("--counts", type=int, nargs="*", default=list(COUNTS), help="local modes with inertia")
    given = parser.parse_args()
    about = machine()
    unit = about["unit_seconds"]
    body = tread_body(None, sectors=SECTORS, local_dynamics=True)
    cases = runs(given.counts)
    best: dict[int, StepTime] = {}
    for _ in range(ROUNDS):
        for i, local in enumerate(cases):
            found = time_swing(body, approach=APPROACH, steps=given.steps, local=local)
            if i not in best or found.seconds_per_step < best[i].seconds_per_step:
                best[i] = found
    print(f"U = {unit * 1e6:.1f} us, {body.local_modes} local modes of each roller")
    print("treatment     with inertia  active  iterations  us/step   U/step  status")
    rows = []
    for i, local in enumerate(cases):
        found, count = best[i], local.count or 0
        rows.append({"treatment": local.treatment, "count": count, **found.row(), "unit_seconds": unit})
        counts = f"{local.treatment:13s} {count:12d} {found.active_nodes:7.1f} {found.iterations:11.2f}"
        seconds = found.seconds_per_step
        print(f"{counts} {seconds * 1e6:8.1f} {seconds / unit:8.2f}  {found.status}")
    if given.json:
        given.json.write_text(json.dumps({**about, "rows": rows}, indent=1) + "\n")


if __name__ == "__main__":
    main()
