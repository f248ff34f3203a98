"""Memory of a run: `python bench/memory.py [--json FILE]`.

Peak resident memory of processes that do one thing each: import, a rigid body that falls, two rollers in contact with
more and more local modes (their bodies reduced beforehand and read from files), and a run that saves more and more
rows.
*Over import* is what is the run's own; figures do not depend on what else the machine does.
"""

from __future__ import annotations

import argparse
import json
import multiprocessing
import os
import tempfile
from pathlib import Path
from typing import Any

from offline import peak_memory

COLUMNS = (56, 222, 889)  # of 960, with 9 nodes each, as in step_vs_modes
APPROACH, STEP, STEPS = 60e-6, 1e-4, 200  # m, s, -
SAVED = (100, 1000, 10000)  # rows of the falling body


def imported() -> None:
    """Import all that a run needs."""
    import warpffrf.output.simulate  # noqa: F401


def falls(rows: int) -> None:
    """A rigid body that falls, with every step saved."""
    import warpffrf as wf

    scene = wf.Scene(gravity=(0, 0, -9.81))
    scene.add_rigid_body(1.0, (1, 1, 1), name="block")
    wf.simulate(scene, rows * 1e-4, step=1e-4, progress=False)


def rolls(file: str) -> None:
    """Two rollers of the file in contact."""
    from studies.speed.step_time import time_swing
    from warpffrf.model.reduced.body import ReducedBody

    time_swing(ReducedBody.load(file), approach=APPROACH, steps=STEPS, step=STEP)


def make(columns: int, file: str) -> int:
    """Reduce a roller to a file; its local modes."""
    from studies.speed.step_time import tread_body

    body = tread_body(columns)
    body.save(file)
    return body.local_modes


def measured(what: Any, *given: Any) -> tuple[float | None, Any]:
    """Peak memory [byte] of a process that calls `what`, and what that returns."""
    with multiprocessing.get_context("spawn").Pool(1) as pool:
        value = pool.apply(what, given)
        return pool.apply(peak_memory), value


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--json", type=Path, help="write machine, versions and rows to this file")
    given = parser.parse_args()
    os.environ.setdefault("OPENBLAS_NUM_THREADS", "1")  # inherited by the processes
    base, _ = measured(imported)
    if base is None:
        raise SystemExit("this system does not tell the peak memory of a process; nothing was measured")
    rows: list[dict[str, Any]] = [{"case": "import", "peak_bytes": base}]
    for saved in SAVED:
        rows.append({"case": "rigid body falls", "saved": saved, "peak_bytes": measured(falls, saved)[0]})
    with tempfile.TemporaryDirectory() as folder:
        for columns in COLUMNS:
            file = str(Path(folder) / f"{columns}.h5")
            modes = measured(make, columns, file)[1]
            rows.append({"case": "two rollers", "local_modes": modes, "peak_bytes": measured(rolls, file)[0]})
    print("case              local modes  saved rows  peak MB  over import")
    for row in rows:
        own = (row["peak_bytes"] - base) / 1e6
        counts = f"{row.get('local_modes', '-')!s:>12s} {row.get('saved', '-')!s:>11s}"
        print(f"{row['case']:17s}{counts} {row['peak_bytes'] / 1e6:8.1f} {own:12.1f}")
    if given.json:
        from warpffrf.study.machine import machine

        given.json.write_text(json.dumps({**machine(), "rows": rows}, indent=1) + "\n")


if __name__ == "__main__":
    main()
