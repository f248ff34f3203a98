"""Time and memory of `reduce` against dofs and loads: `python bench/offline_scaling.py [--json FILE] [--large]`.

Both paths, *cyclic* and *general*, in two series each: *dofs* grow with the mesh at (nearly) the same number of loads,
*loads* with the arc of the rim that carries nodes on the same mesh. Each row is reduced in a process of its own,
without cache. *Power*: of seconds in what grows, from the row before; sizes at which fixed costs rule have small ones.
"""

from __future__ import annotations

import argparse
import json
import multiprocessing
import os
import time
from pathlib import Path

import numpy as np

from offline import peak_memory

# path, series, sectors, layers, axial, columns that carry nodes; a whole rim where they are all sectors
ROWS = [
    *(("cyclic", "dofs", 480, layers, 4, 480) for layers in (4, 8, 16, 32)),
    *(("cyclic", "loads", 480, 8, 8, columns) for columns in (60, 120, 240, 480)),
    *(("general", "dofs", 60, layers, 4, 30) for layers in (4, 8, 16)),
    *(("general", "loads", 120, 8, 6, columns) for columns in (15, 30, 60, 118)),
]
LARGE = [
    *(("cyclic", "dofs", 960, layers, 8, 960) for layers in (8, 16, 32)),
    *(("general", "dofs", 120, layers, 8, 30) for layers in (8, 16)),
]
MODES = 10


def measure(row: tuple[str, str, int, int, int, int]) -> dict:
    """Reduce one roller and return its figures."""
    from scenes.rollers import STEEL
    from studies.speed.step_time import BORE, RADIUS, WIDTH
    from warpffrf.model.mesh import roller
    from warpffrf.model.surfaces import Cylinder
    from warpffrf.offline import ContactGrid, ReductionOptions, reduce

    path, series, sectors, layers, axial, columns = row
    mesh = roller(RADIUS, BORE, WIDTH, sectors=sectors, layers=layers, axial=axial, order=1)
    name = "rim"
    if columns < sectors:
        half = 0.5 * (columns + 1) * 2.0 * np.pi / sectors
        mesh, name = mesh.select("arc", "rim", lambda x: np.abs(np.arctan2(-x[:, 2], x[:, 0])) < half), "arc"
    start = time.perf_counter()
    body = reduce(
        mesh, STEEL, interfaces={"bore": "rigid"}, contact={name: Cylinder()}, modes=MODES,
        grid=ContactGrid(contact_fixed=False), options=ReductionOptions(periodic=False if path == "general" else None),
        cache=False, progress=False,
    )  # fmt: skip
    seconds = time.perf_counter() - start
    return {
        "path": body.report["path"], "table": series, "sectors": sectors, "layers": layers,
        "dofs": int(body.report["dofs"]), "local_modes": body.local_modes, "seconds": seconds,
        "peak_bytes": peak_memory(),
    }  # fmt: skip


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--json", type=Path, help="write machine, versions and rows to this file")
    parser.add_argument("--large", action="store_true", help="add the rows that take minutes")
    given = parser.parse_args()
    os.environ.setdefault("OPENBLAS_NUM_THREADS", "1")  # inherited by the processes of the rows
    from warpffrf.study.machine import machine

    about, rows = machine(), []
    before: dict | None = None
    print(f"U = {about['unit_seconds'] * 1e6:.1f} us")
    print("path     series      dofs  loads  seconds  power    GiB")
    for case in ROWS + (LARGE if given.large else []):
        with multiprocessing.get_context("spawn").Pool(1) as pool:
            row = pool.apply(measure, (case,))
        grows = "dofs" if row["table"] == "dofs" else "local_modes"
        power = "-"
        if before is not None and all(before[k] == row[k] for k in ("path", "table")) and row[grows] > before[grows]:
            row["power"] = float(np.log(row["seconds"] / before["seconds"]) / np.log(row[grows] / before[grows]))
            power = f"{row['power']:.2f}"
        memory = "-" if row["peak_bytes"] is None else f"{row['peak_bytes'] / 2**30:.2f}"
        counts = f"{row['path']:8s} {row['table']:6s} {row['dofs']:9d} {row['local_modes']:6d}"
        print(f"{counts} {row['seconds']:8.2f} {power:>6s} {memory:>6s}", flush=True)
        rows.append(row)
        before = row
    if given.json:
        given.json.write_text(json.dumps({**about, "rows": rows}, indent=1) + "\n")


if __name__ == "__main__":
    main()
