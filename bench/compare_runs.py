"""This run of the benchmarks against the stored one: `python bench/compare_runs.py [--run FOLDER] [--store]`.

Reads what the scripts wrote to out/bench and the last stored run of the same machine, bench/stored/MACHINE, and prints
one table: times in U of their own run, memory as it is (`studies.speed.stored_runs`). Ends with 1 where something is
slower or larger than tolerated. `--store` puts this run in the place of the stored one instead; do that on a quiet
machine.
"""

from __future__ import annotations

import argparse
import sys
from pathlib import Path

from studies.speed.stored_runs import LARGER, SLOWER, compare, lines, machine_id, read, store

STORED = Path(__file__).resolve().parent / "stored"


def main() -> int:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--run", type=Path, default=Path("out/bench"), help="folder of this run's JSON files")
    parser.add_argument("--stored", type=Path, default=STORED, help="folder of the stored runs")
    parser.add_argument("--store", action="store_true", help="store this run")
    parser.add_argument("--slower", type=float, default=SLOWER, help="tolerated fraction of a time in U")
    parser.add_argument("--larger", type=float, default=LARGER, help="tolerated fraction of a memory")
    given = parser.parse_args()
    now = read(given.run) if given.run.is_dir() else {}
    if not now:
        raise SystemExit(f"--run {given.run}: no JSON files of benchmarks there; `make bench` writes them to out/bench")
    if given.store:
        print(f"stored in {store(now, given.stored)}")
        return 0
    (own, *others) = {machine_id(document["machine"]) for document in now.values()}
    if others:
        raise SystemExit(f"--run {given.run}: runs of several machines: {', '.join([own, *others])}")
    if not (given.stored / own).is_dir():
        print(f"no stored run of {own}; `make bench-store` stores this one")
        return 0
    found = compare(now, read(given.stored / own), slower=given.slower, larger=given.larger)
    print("\n".join(lines(found)))
    print(f"{len(found.compared)} quantities, {len(found.flagged)} above what is tolerated")
    return int(bool(found.flagged))


if __name__ == "__main__":
    sys.exit(main())
