"""Time and memory of the reduction: `python bench/offline.py [--json FILE] [--large] [--solver NAME] [--solvers]`.

Each row is reduced in a process of its own, without cache, so that its peak memory is its own. `--solver` reduces the
general rows with another solver than the default. `--solvers` times the sparse solvers that are installed on the
stiffness of a block: the hardest shape, no separator is small.
"""

from __future__ import annotations

import argparse
import json
import multiprocessing
import os
import sys
import time
from pathlib import Path

ROWS = [
    {"name": "hex8", "sectors": 960, "layers": 15, "axial": 6, "order": 1, "general": False},
    {"name": "hex8, 8 per half-width", "sectors": 2880, "layers": 20, "axial": 6, "order": 1, "general": False},
    {"name": "hex27", "sectors": 480, "layers": 7, "axial": 3, "order": 2, "general": False},
    {"name": "hex8", "sectors": 60, "layers": 6, "axial": 4, "order": 1, "general": True},
]
LARGE = [
    {"name": "hex27, large", "sectors": 480, "layers": 10, "axial": 6, "order": 2, "general": False},
    {"name": "hex8, medium", "sectors": 120, "layers": 8, "axial": 6, "order": 1, "general": True},
    {"name": "hex8, 100,000 dofs", "sectors": 120, "layers": 16, "axial": 15, "order": 1, "general": True, "modes": 50},
]
BLOCK_NODES = 33  # along each edge: 107,811 dofs
SMALL_BLOCK_NODES = 18
SIDES = 64  # right-hand sides
LIBRARIES = ("numpy", "scipy", "scikit-fem", "scikit-sparse", "pypardiso")  # whose versions are written down
MAX_FREQUENCY = 20e3  # Hz, as the two-roller demo


def peak_memory() -> float | None:
    """Peak resident memory of this process [byte], None where the platform does not tell."""
    try:
        import resource
    except ImportError:
        return None
    unit = 1 if sys.platform == "darwin" else 1024
    return float(resource.getrusage(resource.RUSAGE_SELF).ru_maxrss * unit)


def measure(row: dict, solver: str | None = None) -> dict:
    """Reduce one roller and return the row with its figures; `solver` is that of the general rows."""
    from warpffrf.model.material import Material
    from warpffrf.model.mesh import roller
    from warpffrf.model.surfaces import Cylinder
    from warpffrf.offline import ReductionOptions, reduce

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
    start = time.perf_counter()
    body = reduce(
        mesh,
        Material(210e9, 0.3, 7850.0),
        interfaces={"bore": "rigid"},
        contact={"rim": Cylinder()},
        max_frequency=None if "modes" in row else MAX_FREQUENCY,
        modes=row.get("modes"),
        options=ReductionOptions(periodic=False if row["general"] else None, solver=solver if row["general"] else None),
        cache=False,
        progress=False,
    )
    return {
        **row,
        "path": body.report["path"],
        "solver": body.report.get("solver"),
        "dofs": body.report["dofs"],
        "local_modes": body.local_modes,
        "global_modes": len(body.frequencies),
        "seconds": time.perf_counter() - start,
        "peak_bytes": peak_memory(),
        "stage_seconds": body.report["stage_seconds"],
        "eigenvalue_ratio": body.report["contact"]["rim"]["eigenvalue_ratio"],
    }


def block_stiffness(nodes: int):
    """K (n, n) of a steel cube of `nodes` hex8 nodes along each edge, held at one face; places (n, 3) of its dofs."""
    import numpy as np

    from warpffrf.model.material import Material
    from warpffrf.offline.fe import Assignment, assemble

    axis = np.linspace(0.0, 0.1, nodes)
    points = np.stack(np.meshgrid(axis, axis, axis, indexing="ij"), axis=-1).reshape(-1, 3)
    number = np.arange(nodes**3).reshape(nodes, nodes, nodes)
    corners = [(0, 0, 0), (1, 0, 0), (1, 1, 0), (0, 1, 0), (0, 0, 1), (1, 0, 1), (1, 1, 1), (0, 1, 1)]
    cells = np.stack(
        [number[a : a + nodes - 1, b : b + nodes - 1, c : c + nodes - 1].ravel() for a, b, c in corners], axis=1
    )
    of_cell = Assignment((Material(210e9, 0.3, 7850.0),), {"hex8": np.zeros(len(cells), dtype=np.int64)})
    K = assemble(points, {"hex8": cells}, of_cell)[0]
    free = np.repeat(points[:, 0] > 0.0, 3)
    return K[free][:, free], np.repeat(points, 3, axis=0)[free]


def measure_solver(name: str, nodes: int) -> dict:
    """Factor and solve time of one solver, blocks of `SIDES` right-hand sides."""
    import numpy as np
    from threadpoolctl import threadpool_limits

    from warpffrf.offline.solvers import factorise

    K, places = block_stiffness(nodes)
    F = np.random.default_rng(0).standard_normal((K.shape[0], SIDES))
    with threadpool_limits(limits=1, user_api="blas"):
        start = time.perf_counter()
        factor = factorise(K, places, name)
        factored = time.perf_counter()
        x = factor.solve(F)
        end = time.perf_counter()
    return {
        "name": name,
        "dofs": K.shape[0],
        "factor_seconds": factored - start,
        "seconds_a_side": (end - factored) / SIDES,
        "factor_bytes": factor.bytes,
        "residual": float(np.abs(K @ x - F).max() / np.abs(F).max()),
    }


def solver_table(context, nodes: int) -> list[dict]:
    """Rows of all installed solvers, printed as they come."""
    from warpffrf.offline.solvers import installed

    print(f"{'solver':14} {'dofs':>8} {'factor s':>9} {'ms a side':>10} {'factors GiB':>12} {'residual':>9}")
    rows = []
    for name in installed():
        with context.Pool(1) as pool:
            row = pool.apply(measure_solver, (name, nodes))
        rows.append(row)
        print(
            f"{name:14} {row['dofs']:8d} {row['factor_seconds']:9.2f} {1e3 * row['seconds_a_side']:10.2f} "
            f"{row['factor_bytes'] / 2**30:12.2f} {row['residual']:9.1e}"
        )
    return rows


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--json", type=Path, help="write machine, versions and rows to this file")
    parser.add_argument("--large", action="store_true", help="add the rows that take minutes")
    parser.add_argument("--solver", help="solver of the general rows; left out: the default")
    parser.add_argument("--solvers", action="store_true", help="time the sparse solvers (with --large at full size)")
    options = parser.parse_args()
    os.environ.setdefault("OPENBLAS_NUM_THREADS", "1")  # inherited by the processes of the rows
    from warpffrf.model.reduced.body import library_versions
    from warpffrf.study.machine import machine

    rows = []
    context = multiprocessing.get_context("spawn")
    head = f"{'case':24} {'path':8} {'solver':14} {'dofs':>9} {'local':>7} {'global':>7} {'seconds':>8} {'GiB':>6}"
    print(head, flush=True)
    for row in ROWS + (LARGE if options.large else []):
        with context.Pool(1) as pool:
            done = pool.apply(measure, (row, options.solver))
        rows.append(done)
        memory = "" if done["peak_bytes"] is None else f"{done['peak_bytes'] / 2**30:.2f}"
        print(
            f"{done['name']:24} {done['path']:8} {done['solver'] or '-':14} {done['dofs']:9d} {done['local_modes']:7d} "
            f"{done['global_modes']:7d} {done['seconds']:8.2f} {memory:>6}"
        )
    solvers = solver_table(context, BLOCK_NODES if options.large else SMALL_BLOCK_NODES) if options.solvers else []
    if options.json:
        about = machine()
        versions = {**about["versions"], **library_versions(LIBRARIES)}
        options.json.write_text(
            json.dumps({**about, "versions": versions, "rows": rows, "solvers": solvers}, indent=1) + "\n"
        )


if __name__ == "__main__":
    main()
