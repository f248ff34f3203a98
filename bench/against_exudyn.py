"""Step time beside EXUDYN's: `python bench/against_exudyn.py [--json FILE] [--modes N ...] [--seconds S]`.

The bar of `warpffrf.study.against_exudyn` with 10, 50 and 200 global modes (more by `--modes`), the same step,
integrator and spectral radius in both programs, one thread, nothing written. EXUDYN: full Newton (a Jacobian every
iteration) and its modified Newton (a Jacobian at the start, and when convergence is slow), with the faster of its
linear solvers. Ours: with the same inertia terms on *all* modes, as EXUDYN has them; with those of the lowest modes
only, as many as `reduce` takes by itself; and without (`constant`). EXUDYN's times are differences of two runs, ours
the time in the step graph.
"""

from __future__ import annotations

import argparse
import json
from importlib.util import find_spec
from pathlib import Path

import numpy as np

from warpffrf.study import against_exudyn as study
from warpffrf.study.step_time import machine

MODES = (10, 50, 200)  # 1,000 take EXUDYN many minutes: --modes 1000
STEP = 5e-4  # s
SECONDS = 2.0  # of a timed run of EXUDYN, if a step is fast enough
MOST = 800  # steps timed of EXUDYN
OURS = 1000  # steps of ours
FEW = 5  # steps; a run of fewer is not repeated: one step then takes long enough
ROUNDS = 3  # of both programs, the fastest counts
MANY = 200  # modes from which on EXUDYN gets the dense solver only; with fewer the faster one counts
SOLVERS = ("EigenDense", "EigenSparse")  # the reduced matrices of a flexible body are full


def their_step(rival: study.Rival, *, modified: bool, solver: str, seconds: float) -> dict:
    """Seconds of a step of EXUDYN, and the steps it was taken from: the difference of a short run and a long one."""
    short = rival.solve(1, STEP, modified=modified, solver=solver)[1]
    guess = max(rival.solve(2, STEP, modified=modified, solver=solver)[1] - short, 1e-5)
    steps = int(np.clip(seconds / guess, 1, MOST))
    if steps <= FEW:
        return {"seconds": guess, "steps": 1, "solver": solver}
    best = np.inf
    for _ in range(ROUNDS):
        short = rival.solve(1, STEP, modified=modified, solver=solver)[1]
        best = min(best, (rival.solve(1 + steps, STEP, modified=modified, solver=solver)[1] - short) / steps)
    return {"seconds": best, "steps": steps, "solver": solver}


def our_step(body: study.ReducedBody, inertia: str, steps: int) -> dict:
    """Seconds of a step of ours, and its iterations."""
    best: dict = {}
    for _ in range(ROUNDS if steps > FEW else 1):
        history = study.our_run(study.our_scene(body, inertia), steps, STEP, steps)
        if history.status != "completed":
            raise SystemExit(f"ours with {len(body.frequencies)} modes: {history.status}: {history.message}")
        c = history.counters
        seconds = c["seconds_in_graph"] / c["steps"]
        if not best or seconds < best["seconds"]:
            best = {"seconds": seconds, "iterations": c["mean_iterations"], "steps": c["steps"]}
    return best


def row_of(mesh: study.Mesh, modes: int, seconds: float) -> dict:
    """All figures for one number of modes, ours before theirs."""
    body = study.reduced_bar(mesh, modes)
    fewer = study.reduced_bar(mesh, modes, inertia_modes=None)
    row: dict = {"modes": modes, "inertia_modes": len(fewer.inertia_terms.first) if fewer.inertia_terms else 0}
    row["ours_all"] = our_step(body, "full", OURS if modes <= MANY else FEW)
    row["ours_lowest"] = our_step(fewer, "full", OURS)
    row["ours_constant"] = our_step(fewer, "constant", OURS)
    rival = study.rival(mesh, body, study.nodal_modes(mesh, body))
    for name, modified in (("full_newton", False), ("modified_newton", True)):
        tried = [
            their_step(rival, modified=modified, solver=solver, seconds=seconds)
            for solver in (SOLVERS if modes < MANY else SOLVERS[:1])
        ]
        row[name] = min(tried, key=lambda found: found["seconds"])
    return row


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--json", type=Path, help="write machine, versions and rows to this file")
    parser.add_argument("--modes", type=int, nargs="*", default=list(MODES))
    parser.add_argument("--seconds", type=float, default=SECONDS, help="of a timed run of EXUDYN")
    given = parser.parse_args()
    if find_spec("exudyn") is None:
        print('EXUDYN is not installed, nothing to compare with; pip install -e ".[verify]"')
        return
    about = machine()
    unit = about["unit_seconds"]
    mesh = study.bar()
    rows = []
    names = ("full_newton", "modified_newton", "ours_all", "ours_lowest", "ours_constant")
    print(
        f"U = {unit * 1e6:.1f} us; us a step: EXUDYN {study.version()}, then ours with inertia terms on all modes, on"
    )
    print("the lowest ones, on none; the last three columns: full Newton, modified Newton over ours (all), and its U")
    print("modes  full Newton   modified  ours, all  lowest (modes)  none    full/all  modified/all   U")
    for modes in given.modes:
        row = {**row_of(mesh, modes, given.seconds), "unit_seconds": unit}
        rows.append(row)
        full, modified, every, lowest, none = (row[n].get("seconds", np.nan) * 1e6 for n in names)
        print(
            f"{modes:5d} {full:12.0f} {modified:10.0f} {every:10.1f} {lowest:7.1f} ({row['inertia_modes']:4d})"
            f" {none:7.1f} {full / every:9.1f} {modified / every:11.1f} {every / unit * 1e-6:7.2f}",
            flush=True,
        )
    if given.json:
        given.json.write_text(json.dumps({**about, "exudyn": study.version(), "rows": rows}, indent=1) + "\n")


if __name__ == "__main__":
    main()
