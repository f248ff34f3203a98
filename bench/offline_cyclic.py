"""Time and memory of the cyclic path on a fine roller: `python bench/offline_cyclic.py [--json FILE] [--large]`.

1.95 million dofs in quadratic cells, 21,000 normal local modes. Rows: normal tractions alone, with tangential ones in
cells and in nodes, and normal ones in complex arithmetic (a sector that is not its own mirror image, here bent around
the axis by a few degrees). Each row runs in a process of its own, so that its peak memory is its own.
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

ROWS = [
    {"name": "normal", "tangential": None, "bent": 0.0},
    {"name": "normal, tangential cells", "tangential": "cells", "bent": 0.0},
    {"name": "normal, tangential nodes", "tangential": "nodes", "bent": 0.0},
    {"name": "normal, complex", "tangential": None, "bent": 0.05},
]
SHORT = 2  # rows of a run without --large
SECTORS, LAYERS, AXIAL = 500, 15, 10
MAX_FREQUENCY = 20e3  # Hz, as the two-roller demo


def measure(row: dict) -> dict:
    """Reduce the roller and return the row with its figures."""
    from warpffrf.model.material import Material
    from warpffrf.model.mesh import Mesh, roller
    from warpffrf.model.surfaces import Cylinder
    from warpffrf.offline.cyclic.path import reduce_cyclic
    from warpffrf.offline.fe import assign
    from warpffrf.offline.interfaces import rigid_interfaces
    from warpffrf.offline.products import Limits, choose_path, resolve_shapes
    from warpffrf.offline.progress import Progress
    from warpffrf.offline.reduction import one_thread

    mesh = roller(0.05, 0.015, 0.02, sectors=SECTORS, layers=LAYERS, axial=AXIAL, order=2, half_width=0.58e-3)
    x, y, z = mesh.points.T
    angle = row["bent"] * np.hypot(x, z) / 0.05
    points = np.stack([np.cos(angle) * x + np.sin(angle) * z, y, np.cos(angle) * z - np.sin(angle) * x], axis=1)
    mesh = Mesh(points, mesh.cells, mesh.facet_sets, mesh.cyclic)
    stages = Progress(False)
    start = time.perf_counter()
    with one_thread():
        shapes = resolve_shapes(mesh, {"rim": Cylinder()})
        choice = choose_path(mesh, ["bore"], shapes)
        if choice.patterns is None:
            raise SystemExit(choice.reason)
        product = reduce_cyclic(
            mesh,
            assign(mesh, Material(210e9, 0.3, 7850.0)),
            rigid_interfaces(mesh, ["bore"]),
            [("rim", shapes["rim"], choice.patterns["rim"])],
            Limits(None, 2.0 * np.pi * MAX_FREQUENCY),
            {},
            stages,
            tangential=row["tangential"],
        )
    return {
        **row,
        "dofs": 3 * len(mesh.points),
        "local_modes": product.surfaces[0].grid.columns * product.surfaces[0].grid.rows,
        "global_modes": len(product.omega),
        "harmonics": product.facts["harmonics"],
        "seconds": time.perf_counter() - start,
        "peak_bytes": peak_memory(),
        "stage_seconds": dict(stages.seconds),
    }


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--json", type=Path, help="write machine, versions and rows to this file")
    parser.add_argument("--large", action="store_true", help="all rows; left out: the first two")
    options = parser.parse_args()
    os.environ.setdefault("OPENBLAS_NUM_THREADS", "1")  # inherited by the processes of the rows
    from warpffrf.study.machine import machine

    about, rows = machine(), []
    print(f"{'case':28} {'dofs':>9} {'local':>7} {'global':>7} {'harmonics':>10} {'seconds':>8} {'GiB':>6}")
    for row in ROWS if options.large else ROWS[:SHORT]:
        with multiprocessing.get_context("spawn").Pool(1) as pool:
            found = pool.apply(measure, (row,))
        rows.append(found)
        memory = "-" if found["peak_bytes"] is None else f"{found['peak_bytes'] / 2**30:.2f}"
        print(
            f"{found['name']:28} {found['dofs']:9} {found['local_modes']:7} {found['global_modes']:7} "
            f"{found['harmonics']:>10} {found['seconds']:8.1f} {memory:>6}"
        )
    if options.json:
        options.json.write_text(json.dumps({**about, "rows": rows}, indent=1) + "\n")


if __name__ == "__main__":
    main()
