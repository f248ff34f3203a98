"""A step of the separated solver beside one of every monolithic variant: `python bench/separated_vs_monolithic.py`.

Two rollers with about 500 local modes each (`tread_body`) roll to and fro on each other at a constant approach; the
same scene, step and coefficients for all. Reported are the time of a step, how many times that of the separated solver
it is, the largest difference of the contact force, and the share of a step spent in BLAS and LAPACK (`dgetrf`, `dgetrs`
and the `dgemm` of the contact stiffness, timed inside the run; other matrix products are not counted).

Variants: full (dense LU in each iteration), modified (kept LU), low_rank (local coordinates condensed, contact of low
rank), each with the weak law of the separated solver ("hats") and with a stiff layer at every FE node ("nodes").
"""

from __future__ import annotations

import argparse
import json
import time
from pathlib import Path
from typing import Any

import numpy as np
from scipy.linalg import blas, lapack

from warpffrf import monolithic
from warpffrf.monolithic import linear
from warpffrf.monolithic.contact import LAWS
from warpffrf.monolithic.linear import VARIANTS
from warpffrf.online import GeneralizedAlpha, run
from warpffrf.study.rollers import PAIR
from warpffrf.study.step_time import machine, swinging_pair, tread_body

COLUMNS = 56  # of 960, with 9 hats each: 504 local modes a roller
APPROACH = 60e-6  # m: about 45 active modes
RATE = 20.0  # rad/s
SWING = 0.08  # rad: the patch stays on the tread
STEP = 1e-4  # s
RHO = 0.8
ROUNDS = 3


class Timed:
    """Routines of `lapack` and `blas` that add up the time spent in them."""

    def __init__(self) -> None:
        self.seconds = 0.0

    def __getattr__(self, name: str) -> Any:
        routine = getattr(lapack, name, None) or getattr(blas, name)

        def call(*args: Any, **more: Any) -> Any:
            begin = time.perf_counter()
            found = routine(*args, **more)
            self.seconds += time.perf_counter() - begin
            return found

        return call


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--json", type=Path, help="write machine, versions and rows to this file")
    parser.add_argument("--steps", type=int, default=30)
    given = parser.parse_args()
    about = machine()
    unit = about["unit_seconds"]
    body = tread_body(COLUMNS, modes=0)
    duration = given.steps * STEP
    scene = swinging_pair(body, APPROACH, SWING, RATE, duration)
    for item in scene.bodies:
        item.level = "constant"
    histories, best = [], {}
    for _ in range(ROUNDS):  # all in turn, the fastest of each counts: other work on the machine only slows down
        histories.append(
            run(scene, duration, step=STEP, start="equilibrium", integrator=GeneralizedAlpha(RHO), progress=False)
        )
        for law in LAWS:
            for variant in VARIANTS:
                row = measure(scene, duration, variant, law)
                known = best.get((law, variant))
                if known is None or row["seconds_per_step"] < known["seconds_per_step"]:
                    best[(law, variant)] = row
    separated = min(histories, key=lambda h: h.counters["seconds_in_graph"])
    base = separated.counters["seconds_in_graph"] / given.steps
    force = separated.contacts[PAIR].force
    size = float(np.linalg.norm(force, axis=1).max())
    print(f"U = {unit * 1e6:.1f} us, {body.local_modes} local modes a roller, {separated.status}, force {size:.0f} N")
    print(f"separated        {base * 1e6:10.1f} us/step {base / unit:8.2f} U   "
          f"{separated.iterations[1:].mean():.2f} iterations, "
          f"{separated.contacts[PAIR].active_modes.mean():.1f} active")  # fmt: skip
    print("variant    law     unknowns   us/step    times  iterations  factors    BLAS  equations  contact  force off")
    rows = list(best.values())
    for row in rows:
        mine = row.pop("force")
        row["force_off"] = float(np.abs(mine - force[2 : 2 + len(mine)]).max() / size) if len(mine) else None
        row["times"] = row["seconds_per_step"] / base
        print(
            f"{row['variant']:10s} {row['law']:6s} {row['unknowns']:9.0f} {row['seconds_per_step'] * 1e6:9.0f} "
            f"{row['times']:8.0f} {row['iterations']:11.2f} {row['factorisations']:8.2f} {row['blas_share']:7.1%} "
            f"{row['equations_share']:10.1%} {row['contact_share']:8.1%} {row['force_off']:10.2e} {row['status']}"
        )
    same = [r for r in rows if r["law"] == "hats"]
    fastest = min(rows, key=lambda r: r["seconds_per_step"])
    print(f"fastest: {fastest['variant']}, {fastest['law']}: {fastest['times']:.0f} times the separated step; "
          f"of the same law: {min(r['times'] for r in same):.0f} times")  # fmt: skip
    if given.json:
        found = {**about, "separated_seconds_per_step": base, "rows": rows}
        given.json.write_text(json.dumps(found, indent=1) + "\n")


def measure(scene: Any, duration: float, variant: str, law: str) -> dict[str, Any]:
    """Run one variant."""
    timed = Timed()
    linear.lapack = linear.blas = timed  # type: ignore[assignment]
    try:
        # the settling of the start is not counted: it is run first, then the steps are timed
        warm = monolithic.run(
            scene, STEP, step=STEP, start="equilibrium", variant=variant, law=law, progress=False,
            integrator=monolithic.generalized_alpha(RHO),
        )  # fmt: skip
        timed.seconds = 0.0
        history = monolithic.run(
            scene, duration - STEP, step=STEP, start=warm, variant=variant, law=law, progress=False,
            integrator=monolithic.generalized_alpha(RHO),
        )  # fmt: skip
    finally:
        linear.lapack, linear.blas = lapack, blas
    c = history.counters
    done = max(int(c["steps"]), 1)
    return {
        "variant": variant, "law": law, "status": history.status, "unknowns": c["unknowns"],
        "seconds_per_step": c["loop_seconds"] / done, "iterations": c["mean_iterations"],
        "factorisations": c["factorisations"] / done, "blas_share": timed.seconds / c["loop_seconds"],
        "equations_share": c.get("equations_seconds", 0.0) / c["loop_seconds"],
        "contact_share": c.get("contact_seconds", 0.0) / c["loop_seconds"], "force": history.contacts[PAIR].force,
    }  # fmt: skip


if __name__ == "__main__":
    main()
