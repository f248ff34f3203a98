"""A step of the separated solver against one of every monolithic variant: `python bench/separated_vs_monolithic.py`.

Two scenes, each with about 500 local modes a roller, and the same step and coefficients for all: *tread*, two rollers
with fine grids on part of the rim (`tread_body`) that roll to and fro on each other at a constant approach; *demo*, the
two-roller demo on a coarse mesh. Reported are the time of a step, how many times that of the separated solver it is,
the largest difference of the contact force, and the share of a step spent in BLAS and LAPACK (`dgetrf`, `dgetrs` and
the `dgemm` of the contact stiffness, timed inside the run; other matrix products are not counted).

Variants: full (dense LU in each iteration), modified (kept LU), low_rank (local coordinates condensed, contact of low
rank), each with the weak law of the separated solver ("hats") and with a stiff layer at every FE node ("nodes").

`--columns N`: treads of N columns, 5 N local modes or so a roller, alone (without *demo*): the curve over modes. Steps
are timed from a state that the settling has left, so that 20 of them are enough (`--steps 20`); `--law` and `--rounds`
shorten what dense matrices of many thousand rows make long.

`--series` instead: the force of the two laws on treads of finer and finer grids, and what the layer does to it.
"""

from __future__ import annotations

import argparse
import json
import time
from collections.abc import Sequence
from pathlib import Path
from typing import Any

import numpy as np
from scipy.linalg import blas, lapack

from demos import two_rollers
from references import monolithic
from references.monolithic.core import linear
from references.monolithic.core.linear import VARIANTS
from references.monolithic.line_of_centres.pair import LAWS, STIFFER, default_layer
from scenes.rollers import PAIR
from studies.speed.step_time import swinging_pair, tread_body
from warpffrf.online import GeneralizedAlpha, run
from warpffrf.study.machine import machine

SECTORS, LAYERS, AXIAL = 1920, 18, 4  # near-square cells, about five elements a half-width, as in the demo
COLUMNS = 100  # with 5 shape functions each: 495 local modes a roller
APPROACH = 60e-6  # m: about 45 active nodes
RATE = 20.0  # rad/s
SWING = 0.08  # rad: the patch stays on the tread
STEP = 1e-4  # s
DEMO = two_rollers.Size(sectors=100, layers=7, axial=4)  # 500 shape functions
SERIES = ((960, 14, 8, 56), (1920, 18, 4, 100), (2880, 20, 4, 150), (3840, 22, 4, 200))  # sectors ... columns
STIFF = 100.0  # times the default layer
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
    parser.add_argument("--steps", type=int, default=15)
    parser.add_argument("--columns", type=int, help="of the tread, which is then the only scene")
    parser.add_argument("--law", action="append", choices=LAWS, help="of the monolithic variants; repeat, all if none")
    parser.add_argument("--rounds", type=int, default=ROUNDS, help="how often each is run, the fastest counts")
    parser.add_argument("--series", action="store_true", help="forces of the two laws instead of times")
    given = parser.parse_args()
    about = machine()
    if given.series:
        found: dict[str, Any] = {"series": series()}
    else:
        duration = given.steps * STEP
        body = tread_body(given.columns or COLUMNS, sectors=SECTORS, layers=LAYERS, axial=AXIAL, modes=0)
        scenes = {"tread": swinging_pair(body, APPROACH, SWING, RATE, duration)}
        if given.columns is None:
            scenes["demo"] = two_rollers.build(DEMO, progress=False)
            for contact in scenes["demo"].contacts:
                contact.grid = "body_fixed"  # the reference has no other; its coarse mesh would get contact-fixed cells
        print(f"U = {about['unit_seconds'] * 1e6:.1f} us")
        how = given.steps, about["unit_seconds"], given.rounds, given.law or list(LAWS)
        found = {name: compare(name, scene, *how) for name, scene in scenes.items()}
    if given.json:
        given.json.write_text(json.dumps({**about, **found}, indent=1) + "\n")


def compare(name: str, scene: Any, steps: int, unit: float, rounds: int, laws: Sequence[str]) -> dict[str, Any]:
    """Time all variants with `laws` on `scene`, print and return their rows."""
    duration = steps * STEP
    for item in scene.bodies:
        item.level = "constant"
    histories, best = [], {}
    for _ in range(rounds):  # all in turn, the fastest of each counts: other work on the machine only slows down
        histories.append(
            run(scene, duration, step=STEP, start="equilibrium", integrator=GeneralizedAlpha(RHO), progress=False)
        )
        for law in laws:
            for variant in VARIANTS:
                row = measure(scene, duration, variant, law)
                known = best.get((law, variant))
                if known is None or row["seconds_per_step"] < known["seconds_per_step"]:
                    best[(law, variant)] = row
    separated = min(histories, key=lambda h: h.counters["seconds_in_graph"])
    base = separated.counters["seconds_in_graph"] / steps
    force = separated.contacts[PAIR].force
    size = float(np.linalg.norm(force, axis=1).max())
    print(f"{name}: {scene.bodies[0].reduced.local_modes} local modes a roller, {separated.status}, force {size:.0f} N")
    print(f"separated        {base * 1e6:10.1f} us/step {base / unit:8.2f} U   "
          f"{separated.iterations[1:].mean():.2f} iterations, "
          f"{separated.contacts[PAIR].active_nodes.mean():.1f} active")  # fmt: skip
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
    return {"separated_seconds_per_step": base, "rows": rows}


def series() -> list[dict[str, Any]]:
    """Forces of both laws while the rollers roll over several elements, on finer and finer grids."""
    print("sectors  elements a half-width  force of nodes  ripple  of nodes  ripple  mean off  worst off  layer")
    found = []
    for sectors, layers, axial, columns in SERIES:
        body = tread_body(columns, sectors=sectors, layers=layers, axial=axial, modes=0)
        stiff = STIFF * default_layer(body.contact_surfaces["tread"])
        forces, active = {}, 0.0
        for law, layer in (("hats", None), ("nodes", None), ("stiff", stiff)):
            scene = swinging_pair(body, APPROACH, SWING, RATE, 30 * STEP)
            for item in scene.bodies:
                item.level = "constant"
            history = monolithic.run(
                scene, 30 * STEP, step=STEP, start="equilibrium", variant="low_rank", progress=False,
                law="hats" if law == "hats" else "nodes", layer_stiffness=layer,
                integrator=GeneralizedAlpha(RHO),
            )  # fmt: skip
            if history.status != "completed":
                raise RuntimeError(f"{law}: {history.status}: {history.message}")
            forces[law] = np.linalg.norm(history.contacts[PAIR].force, axis=1)[1:]
            if law == "hats":
                active = float(history.contacts[PAIR].active.mean()) / (axial + 1)
        grid_nodes, nodes = forces["hats"], forces["nodes"]
        row = {
            "sectors": sectors, "elements": 0.5 * active,
            "hats": grid_nodes.mean(), "hats_ripple": np.ptp(grid_nodes) / grid_nodes.mean(),
            "nodes": nodes.mean(), "nodes_ripple": np.ptp(nodes) / nodes.mean(),
            "mean_off": nodes.mean() / grid_nodes.mean() - 1.0, "worst_off": np.abs(nodes / grid_nodes - 1.0).max(),
            "layer": nodes.mean() / forces["stiff"].mean() - 1.0, "layer_factor": STIFFER,
        }  # fmt: skip
        found.append({name: float(value) for name, value in row.items()})
        print(
            f"{sectors:7d} {row['elements']:22.1f} {row['hats']:14.1f} {row['hats_ripple']:7.2%} {row['nodes']:9.1f} "
            f"{row['nodes_ripple']:7.2%} {row['mean_off']:9.2%} {row['worst_off']:10.2%} {row['layer']:6.2%}",
            flush=True,
        )
    return found


def measure(scene: Any, duration: float, variant: str, law: str) -> dict[str, Any]:
    """Run one variant."""
    timed = Timed()
    linear.lapack = linear.blas = timed  # type: ignore[assignment]
    try:
        # the settling of the start is not counted: it is run first, then the steps are timed
        warm = monolithic.run(
            scene, STEP, step=STEP, start="equilibrium", variant=variant, law=law, progress=False,
            integrator=GeneralizedAlpha(RHO),
        )  # fmt: skip
        timed.seconds = 0.0
        history = monolithic.run(
            scene, duration - STEP, step=STEP, start=warm, variant=variant, law=law, progress=False,
            integrator=GeneralizedAlpha(RHO),
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
