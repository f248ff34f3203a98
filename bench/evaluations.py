"""Quadratures "full" and "reduced" against the law at FE nodes.

`python bench/evaluations.py [--json FILE] [--errors | --times | --layers]`

*Errors* of "full" and "reduced" against "at nodes", two rollers with a stiff layer between them rolling over each other
at a constant approach: force, pressure and stress, on finer and finer meshes, with two layers, on equal and unequal
grids.
*Times* of a step with 8,000 local modes, all three in the same run: "at nodes" with each of its linear solvers, of
which "full" is the conventional one, a dense LU of all coordinates in each iteration, and "low_rank" condenses the
local modes; without options only the latter, and no errors. *Layers*: "reduced" against "full" under laws whose yield
is no constant, which are evaluated at points. See `bench/studies/contact/evaluations.py`.
"""

from __future__ import annotations

import argparse
import json
from pathlib import Path
from typing import Any

import numpy as np

from references import monolithic
from scenes.rollers import PAIR
from studies.contact.evaluations import (
    OPTIONS,
    SEPARATED,
    STEP,
    STIFFER,
    compare,
    layer_of,
    node_means,
    points_of,
    run_at_nodes,
    run_quadrature,
    scene_of,
    step_seconds,
    surface_norm,
    tread,
)
from studies.speed.step_time import RADIUS
from warpffrf.model.laws import ExponentialAsperities, NonlinearLayer
from warpffrf.output.result import Result
from warpffrf.study.machine import machine

SAMPLING_ERROR = 0.01
HARD = 300.0  # a layer that is hardly there; `STIFFER` is one as penalties are chosen
# sectors, layers, axial, columns of the tread, approach [m]
MESHES = ((2400, 17, 4, 120, 40e-6), (2400, 17, 4, 140, 60e-6), (3840, 20, 4, 200, 40e-6), (3840, 20, 4, 220, 60e-6))
OTHER = {2400: (2000, 16), 3840: (3200, 19)}  # sectors and layers of an upper roller with a wider grid
SWING, RATE, STEPS = 0.01, 10.0, 15  # rad, rad/s: the patch runs over four to six columns
SERIES = (960, 14, 8, 444, 60e-6)  # 444 x 9 shape functions, 3,996 a roller
COLUMNS_A_STEP = 0.25
SEPARATED_STEPS, ROUNDS = 150, 15  # the fastest round counts, all in turn: other work on the machine only slows down
FULL_STEPS = {"low_rank": 10, "modified": 2, "full": 1}
SHORT_STEPS = {"low_rank": 3}  # of a run without options, which leaves the dense variants out
LAYER_SERIES = (960, 14, 8, 60, 60e-6)
POWER, POWER_DEPTH = 1.5, 1e-6  # of the power law; where it has the pressure of the linear layer [m]
ASPERITIES = (1e6, 1e-6)  # Pa, m: seven decay lengths to the pressure here
HALF_WIDTH = 0.45  # over sqrt(approach R), about: where the stress points lie


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--json", type=Path, help="write machine, versions and rows to this file")
    parser.add_argument("--errors", action="store_true", help="errors only, a minute")
    parser.add_argument("--times", action="store_true", help="times only, some minutes")
    parser.add_argument("--layers", action="store_true", help="layers only, a minute")
    given = parser.parse_args()
    found: dict[str, Any] = machine()
    short = not (given.errors or given.times or given.layers)
    if given.errors:
        found["errors"] = errors()
    if given.times or short:
        found["times"] = times(found["unit_seconds"], FULL_STEPS if given.times else SHORT_STEPS)
    if given.layers or short:
        found["layers"] = under_layers(found["unit_seconds"])
    if given.json:
        given.json.write_text(json.dumps(found, indent=1) + "\n")


def errors() -> list[dict[str, Any]]:
    """Errors on all meshes; printed as they come."""
    print("sectors  upper  approach  layer  columns a half-width  quadrature  points  force  pressure  stress")
    rows = []
    for sectors, layers, axial, columns, approach in MESHES:
        half_width = HALF_WIDTH * float(np.sqrt(approach * RADIUS))
        body = tread(
            columns, sectors=sectors, layers=layers, axial=axial, sampling_error=SAMPLING_ERROR, half_width=half_width
        )
        wide, deep = OTHER[sectors]
        other = tread(int(columns * wide / sectors), sectors=wide, layers=deep, axial=axial)
        for stiffer, second in ((STIFFER, None), (HARD, None), (STIFFER, other)):
            upper = sectors if second is None else wide
            for one in compare(body, approach, SWING, RATE, STEPS, stiffer, second):
                row = {"sectors": sectors, "upper": upper, "approach": approach, "layer": stiffer, **one.row()}
                rows.append(row)
                print(
                    f"{sectors:7d} {upper:6d} {approach * 1e6:6.0f} um {stiffer:6.0f} {one.half_width:21.1f} "
                    f"{one.quadrature:>11s} {one.points:7d} {one.force:6.2%} {one.pressure:9.2%} {one.stress:7.2%}",
                    flush=True,
                )
    return rows


def times(unit: float, full_steps: dict[str, int]) -> list[dict[str, Any]]:
    """Times of a step of all three, "at nodes" by the steps of each variant, and their ratios; printed as they come."""
    sectors, layers, axial, columns, approach = SERIES
    body = tread(columns, sectors=sectors, layers=layers, axial=axial, sampling_error=SAMPLING_ERROR)
    pitch = 2.0 * np.pi / sectors
    rate, swing = COLUMNS_A_STEP * pitch / STEP, 0.4 * columns * pitch
    best: dict[str, dict[str, Any]] = {}
    for _ in range(ROUNDS):
        for name in SEPARATED:
            scene = scene_of(body, name, approach, swing, rate, SEPARATED_STEPS * STEP)
            result = run_quadrature(scene, SEPARATED_STEPS)
            seconds = step_seconds(result)
            if name not in best or seconds < best[name]["seconds_per_step"]:
                contact = result.history.contacts[PAIR]
                best[name] = {
                    "quadrature": name, "points": points_of(body, name), "seconds_per_step": seconds,
                    "active": float(contact.active_nodes.mean()),
                    "force": float(np.linalg.norm(contact.force[1])),
                    "iterations": result.history.counters["mean_iterations"],
                }  # fmt: skip
    print(f"U = {unit * 1e6:.1f} us, {2 * body.local_modes} local modes in the pair")
    print("quadrature        points  active  iterations     us/step       U/step   over full   over red.  force off")
    rows = []

    def add(row: dict[str, Any]) -> None:
        seconds = row["seconds_per_step"]
        row["over_full"] = seconds / best["full"]["seconds_per_step"]
        row["over_reduced"] = seconds / best["reduced"]["seconds_per_step"]
        row["force_off"] = abs(row["force"] / best["full"]["force"] - 1.0)
        rows.append(row)
        print(
            f"{row['quadrature']:16s} {row['points']:7d} {row['active']:7.1f} {row['iterations']:11.2f} "
            f"{seconds * 1e6:11.1f} {seconds / unit:12.2f} {row['over_full']:11.2f} {row['over_reduced']:11.2f} "
            f"{row['force_off']:10.2e}",
            flush=True,
        )

    for name in SEPARATED:
        add(best[name])
    scene = scene_of(body, "full", approach, swing, rate, SEPARATED_STEPS * STEP)
    start = monolithic.run(scene, STEP, start="equilibrium", variant="low_rank", at_nodes=True, **OPTIONS)
    for variant, steps in full_steps.items():
        result = run_at_nodes(scene, steps, start=start, variant=variant)
        contact = result.history.contacts[PAIR]
        add({
            "quadrature": f"at nodes, {variant}", "points": axial + 1, "seconds_per_step": step_seconds(result),
            "active": float(contact.active_nodes.mean()), "force": float(np.linalg.norm(contact.force[0])),
            "iterations": result.history.counters["mean_iterations"],
        })  # fmt: skip
    return rows


def under_layers(unit: float) -> list[dict[str, Any]]:
    """A step of "full" and "reduced" under three laws, and what few points change; printed as they come."""
    sectors, layers, axial, columns, approach = LAYER_SERIES
    body = tread(columns, sectors=sectors, layers=layers, axial=axial, sampling_error=SAMPLING_ERROR)
    pitch = 2.0 * np.pi / sectors
    rate, swing = COLUMNS_A_STEP * pitch / STEP, 0.4 * columns * pitch
    linear = layer_of(body)
    laws = {
        "linear": linear,
        "power": NonlinearLayer(linear.stiffness / POWER_DEPTH ** (POWER - 1.0), POWER),
        "asperities": ExponentialAsperities(*ASPERITIES),
    }
    seconds: dict[tuple[str, str], float] = {}
    results: dict[tuple[str, str], Result] = {}
    for _ in range(ROUNDS):
        for law in laws:
            for name in SEPARATED:
                scene = scene_of(body, name, approach, swing, rate, SEPARATED_STEPS * STEP)
                scene.contacts[0].law = laws[law]
                result = results[law, name] = run_quadrature(scene, SEPARATED_STEPS)
                seconds[law, name] = min(step_seconds(result), seconds.get((law, name), np.inf))
    print(f"U = {unit * 1e6:.1f} us")
    print("law         quadrature  points  active  iterations    us/step  over full  force off  pressure off")
    rows, gram = [], np.asarray(body.contact_surfaces["tread"].gram_z)
    for (law, name), result in results.items():
        full = results[law, "full"]
        contact, beside = result.history.contacts[PAIR], full.history.contacts[PAIR]
        force, reference = (np.linalg.norm(c.force, axis=1) for c in (contact, beside))
        pairs = zip(node_means(body, result, False), node_means(body, full, False), strict=True)
        row = {
            "law": law, "quadrature": name, "points": points_of(body, name),
            "active": float(contact.active_nodes.mean()), "iterations": result.history.counters["mean_iterations"],
            "seconds_per_step": seconds[law, name], "over_full": seconds[law, name] / seconds[law, "full"],
            "force_off": float(np.abs(force / reference - 1.0).max()),
            "pressure_off": max(surface_norm(p - q, gram) / surface_norm(q, gram) for p, q in pairs),
        }  # fmt: skip
        rows.append(row)
        print(
            f"{law:12s}{name:>10s} {row['points']:7d} {row['active']:7.1f} {row['iterations']:11.2f} "
            f"{seconds[law, name] * 1e6:10.1f} {row['over_full']:10.2f} {row['force_off']:10.2e} "
            f"{row['pressure_off']:13.2e}",
            flush=True,
        )
    return rows


if __name__ == "__main__":
    main()
