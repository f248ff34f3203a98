"""Step time against EXUDYN's: `python bench/against_exudyn.py [--json FILE] [--modes N ...] [--seconds S] [--ours]`.

The bar of `studies.speed.against_exudyn` with 10, 50 and 200 global modes (more by `--modes`), the same step,
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

from studies.speed import against_exudyn as study
from warpffrf.study.machine import machine

MODES = (10, 50, 200)  # 1,000 take EXUDYN many minutes: --modes 1000
STEP = 5e-4  # s
SECONDS = 2.0  # of a timed run of EXUDYN, if a step is fast enough
MOST = 800  # steps timed of EXUDYN
OURS = 1000  # steps of ours
TRAVEL, SAVE_EVERY = 1000, 10  # steps of a run that is compared, and of its output: the tip covers a metre
VISIBLE = 0.1  # of a run of two steps: the least that one step takes when guessing how many to time
SLOW = 20.0  # s of two steps: repeated once only
FEW = 5  # steps of ours with so many modes that they are not repeated: one takes long enough
ROUNDS = 3  # of both programs, the fastest counts
MANY = 200  # modes from which on EXUDYN gets the dense solver only; with fewer the faster one counts
SOLVERS = ("EigenDense", "EigenSparse")  # the reduced matrices of a flexible body are full


def their_step(rival: study.Rival, *, modified: bool, solver: str, seconds: float) -> dict:
    """Seconds of a step of EXUDYN and the steps it was taken from: a long run less one of a single step, each the
    fastest of its rounds. Not a number where other work on the machine took more than the steps did."""

    def timed(steps: int) -> float:
        return rival.solve(steps, STEP, modified=modified, solver=solver)[1]

    short, two = timed(1), timed(2)
    guess = max(two - short, VISIBLE * two)
    steps = int(np.clip(seconds / guess, 1, MOST))
    long = two if steps == 1 else timed(1 + steps)
    for _ in range(1 if two > SLOW else ROUNDS):
        short, long = min(short, timed(1)), min(long, timed(1 + steps))
    best = (long - short) / steps
    return {"seconds": best if best > 0.0 else np.nan, "steps": steps, "solver": solver}


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


def tip_error(mesh: study.Mesh, body: study.ReducedBody, fewer: study.ReducedBody, inertia: str) -> float:
    """Largest distance [m] of the tip of `fewer`, with the inertia level given, from that with all terms of `body`."""
    tips = [
        study.our_tip(
            study.our_run(study.our_scene(b, level), TRAVEL, STEP, SAVE_EVERY), mesh, study.nodal_modes(mesh, b)
        )
        for b, level in ((body, "full"), (fewer, inertia))
    ]
    return float(np.linalg.norm(tips[0] - tips[1], axis=1).max())


def row_of(mesh: study.Mesh, modes: int, seconds: float, *, alone: bool = False) -> dict:
    """All figures for one number of modes, ours before theirs; `alone`: ours only."""
    body = study.reduced_bar(mesh, modes)
    fewer = study.reduced_bar(mesh, modes, inertia_modes=None)
    row: dict = {"modes": modes, "inertia_modes": len(fewer.inertia_terms.first) if fewer.inertia_terms else 0}
    row["ours_all"] = our_step(body, "full", OURS if modes <= MANY else FEW)
    row["ours_lowest"] = our_step(fewer, "full", OURS)
    row["ours_constant"] = our_step(fewer, "constant", OURS)
    if row["inertia_modes"] < modes <= MANY:
        row["tip_error_lowest"] = tip_error(mesh, body, fewer, "full")
        row["tip_error_constant"] = tip_error(mesh, body, fewer, "constant")
    if alone:
        return row
    rival = study.rival(mesh, body, study.nodal_modes(mesh, body))
    for name, modified in (("full_newton", False), ("modified_newton", True)):
        tried = [
            their_step(rival, modified=modified, solver=solver, seconds=seconds)
            for solver in (SOLVERS if modes < MANY else SOLVERS[:1])
        ]
        row[name] = min(tried, key=lambda found: np.nan_to_num(found["seconds"], nan=np.inf))
    return row


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--json", type=Path, help="write machine, versions and rows to this file")
    parser.add_argument("--modes", type=int, nargs="*", default=list(MODES))
    parser.add_argument("--seconds", type=float, default=SECONDS, help="of a timed run of EXUDYN")
    parser.add_argument("--ours", action="store_true", help="time ours only")
    given = parser.parse_args()
    if find_spec("exudyn") is None and not given.ours:
        print('EXUDYN is not installed, nothing to compare with; pip install -e ".[verify]"')
        return
    about = machine()
    unit = about["unit_seconds"]
    mesh = study.bar()
    rows = []
    version = "" if given.ours else f" {study.version()}"
    names = ("full_newton", "modified_newton", "ours_all", "ours_lowest", "ours_constant")
    print(f"U = {unit * 1e6:.1f} us; us a step: EXUDYN{version}, then ours with inertia terms on all modes, on")
    print("the lowest ones, on none; the last three columns: full Newton, modified Newton over ours (all), and its U")
    print("modes  full Newton   modified  ours, all  lowest (modes)  none    full/all  modified/all   U")
    for modes in given.modes:
        row = {**row_of(mesh, modes, given.seconds, alone=given.ours), "unit_seconds": unit}
        rows.append(row)
        full, modified, every, lowest, none = (row.get(n, {}).get("seconds", np.nan) * 1e6 for n in names)
        print(
            f"{modes:5d} {full:12.0f} {modified:10.0f} {every:10.1f} {lowest:7.1f} ({row['inertia_modes']:4d})"
            f" {none:7.1f} {full / every:9.1f} {modified / every:11.1f} {every / unit * 1e-6:7.2f}",
            flush=True,
        )
        if "tip_error_lowest" in row:
            lowest, none = row["tip_error_lowest"], row["tip_error_constant"]
            print(f"      tip away from that with all terms: lowest {lowest:.2g} m, none {none:.2g} m", flush=True)
    if given.json:
        given.json.write_text(json.dumps({**about, "exudyn": version.strip(), "rows": rows}, indent=1) + "\n")


if __name__ == "__main__":
    main()
