"""Time and memory of the reduction: `python bench/offline.py [--json FILE] [--large]`.

Each row is reduced in a process of its own, without cache, so that its peak memory is its own.
"""

from __future__ import annotations

import argparse
import json
import multiprocessing
import os
import platform
import sys
import time
from pathlib import Path

ROWS = [
    {"name": "cyclic hex8", "sectors": 960, "layers": 15, "axial": 6, "order": 1, "general": False},
    {"name": "cyclic hex8, 8 per half-width", "sectors": 2880, "layers": 20, "axial": 6, "order": 1, "general": False},
    {"name": "cyclic hex27", "sectors": 480, "layers": 7, "axial": 3, "order": 2, "general": False},
    {"name": "general hex8", "sectors": 60, "layers": 6, "axial": 4, "order": 1, "general": True},
]
LARGE = [
    {"name": "cyclic hex27, large", "sectors": 480, "layers": 10, "axial": 6, "order": 2, "general": False},
    {"name": "general hex8, large", "sectors": 120, "layers": 8, "axial": 6, "order": 1, "general": True},
]
MAX_FREQUENCY = 20e3  # Hz, as the two-roller demo


def peak_memory() -> float | None:
    """Peak resident memory of this process [byte], None where the platform does not tell."""
    try:
        import resource
    except ImportError:
        return None
    unit = 1 if sys.platform == "darwin" else 1024
    return float(resource.getrusage(resource.RUSAGE_SELF).ru_maxrss * unit)


def measure(row: dict) -> dict:
    """Reduce one roller and return the row with its figures."""
    from dataclasses import replace

    from warpffrf.model.material import Material
    from warpffrf.model.mesh import roller
    from warpffrf.model.surfaces import Cylinder
    from warpffrf.offline import reduce

    mesh = roller(
        0.05,
        0.015,
        0.02,
        sectors=row["sectors"],
        layers=row["layers"],
        axial=row["axial"],
        order=row["order"],
        half_width=0.3e-3 * 960 / row["sectors"],
    )
    if row["general"]:
        mesh = replace(mesh, cyclic=None)
    start = time.perf_counter()
    body = reduce(
        mesh,
        Material(210e9, 0.3, 7850.0),
        interfaces={"bore": "rigid"},
        contact={"rim": Cylinder()},
        max_frequency=MAX_FREQUENCY,
        cache=False,
        progress=False,
    )
    return {
        **row,
        "path": body.report["path"],
        "dofs": body.report["dofs"],
        "local_modes": body.local_modes,
        "global_modes": len(body.frequencies),
        "seconds": time.perf_counter() - start,
        "peak_bytes": peak_memory(),
        "stage_seconds": body.report["stage_seconds"],
        "eigenvalue_ratio": body.report["contact"]["rim"]["eigenvalue_ratio"],
    }


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--json", type=Path, help="write machine, versions and rows to this file")
    parser.add_argument("--large", action="store_true", help="add the rows that take minutes")
    options = parser.parse_args()
    os.environ.setdefault("OPENBLAS_NUM_THREADS", "1")  # inherited by the processes of the rows
    from warpffrf.model.reduced_body import library_versions

    rows = []
    context = multiprocessing.get_context("spawn")
    print(f"{'case':32} {'dofs':>9} {'local':>7} {'global':>7} {'seconds':>8} {'GiB':>6}")
    for row in ROWS + (LARGE if options.large else []):
        with context.Pool(1) as pool:
            done = pool.apply(measure, (row,))
        rows.append(done)
        memory = "" if done["peak_bytes"] is None else f"{done['peak_bytes'] / 2**30:.2f}"
        print(
            f"{done['name']:32} {done['dofs']:9d} {done['local_modes']:7d} {done['global_modes']:7d} "
            f"{done['seconds']:8.2f} {memory:>6}"
        )
    if options.json:
        machine = {
            "machine": platform.machine(),
            "processor": platform.processor(),
            "system": platform.platform(),
            "cores": os.cpu_count(),
        }
        versions = {"python": platform.python_version(), **library_versions(("numpy", "scipy", "scikit-fem"))}
        options.json.write_text(json.dumps({"machine": machine, "versions": versions, "rows": rows}, indent=1))


if __name__ == "__main__":
    main()
