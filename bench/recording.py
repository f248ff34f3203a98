"""What recorded runs leave in their process: `python bench/recording.py [--json FILE] [--runs N]`.

A rigid body falls, the run is recorded and written as results; threads, open files and memory of the process after
every 50 runs. All stay the same: a sweep over thousands of recorded runs is one process.
"""

from __future__ import annotations

import argparse
import gc
import json
import tempfile
from pathlib import Path

import psutil

import warpffrf as wf
from warpffrf.study.machine import machine

RUNS = 150
EVERY = 50
WARM = 10  # runs before the first figures: imports, pools and caches


def recorded_run(folder: Path) -> None:
    """Ten steps of a falling body, to two files that are removed again."""
    scene = wf.Scene(gravity=(0, 0, -9.81))
    scene.add_rigid_body(1.0, (1, 1, 1), name="block")
    files = [folder / "run.h5", folder / "run.rrd"]
    wf.simulate(scene, 0.01, step=1e-3, results=files[0], record=files[1], progress=False)
    for file in files:
        file.unlink()


def figures(runs: int) -> dict:
    """Of the process, after so many runs."""
    gc.collect()
    me = psutil.Process()
    return {
        "runs": runs,
        "threads": me.num_threads(),
        "open_files": me.num_fds() if hasattr(me, "num_fds") else None,
        "megabytes": me.memory_info().rss / 1e6,
    }


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--json", type=Path, help="write machine, versions and rows to this file")
    parser.add_argument("--runs", type=int, default=RUNS)
    given = parser.parse_args()
    rows = []
    print("runs  threads  files     MB")
    with tempfile.TemporaryDirectory() as folder:
        for n in range(WARM + given.runs + 1):
            if n >= WARM and (n - WARM) % EVERY == 0:
                rows.append(row := figures(n - WARM))
                print(
                    f"{row['runs']:4d} {row['threads']:8d} {row['open_files']!s:>6s} {row['megabytes']:6.1f}",
                    flush=True,
                )
            recorded_run(Path(folder))
    if given.json:
        given.json.write_text(json.dumps({**machine(), "rows": rows}, indent=1) + "\n")
    if rows[-1]["threads"] > rows[0]["threads"]:
        raise SystemExit("recorded runs leave threads behind")


if __name__ == "__main__":
    main()
