"""Step time against sampling points: `python bench/step/step_vs_points.py [--json FILE] [--steps N] [--rounds N]`.

One pair of treads under a stiff layer, a power law (its yield is evaluated at the points in every iteration): "full"
with all points of a strip, then "reduced" with those that `reduce` chose for smaller and smaller errors. All in turn.
"""

from __future__ import annotations

import argparse
import json
from pathlib import Path

import numpy as np

from scenes.rollers import PAIR
from studies.contact.evaluations import (
    STEP,
    layer_of,
    on_grid,
    points_of,
    run_quadrature,
    scene_of,
    step_seconds,
    surface_norm,
    tread,
)
from warpffrf.model.laws import NonlinearLayer
from warpffrf.model.reduced.body import ReducedBody
from warpffrf.study.machine import machine

SECTORS, LAYERS, AXIAL, COLUMNS = 960, 14, 8, 60
APPROACH = 60e-6  # m: about 45 active nodes
SAMPLING_ERRORS = (0.05, 0.01, 0.002)
POWER, POWER_DEPTH = 1.5, 1e-6  # of the law; where it has the pressure of the linear layer [m]
COLUMNS_A_STEP = 0.25


def power_layer(body: ReducedBody) -> NonlinearLayer:
    """The law between the rollers."""
    return NonlinearLayer(layer_of(body).stiffness / POWER_DEPTH ** (POWER - 1.0), POWER)


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--json", type=Path, help="write machine, versions and rows to this file")
    parser.add_argument("--steps", type=int, default=150)
    parser.add_argument("--rounds", type=int, default=5, help="the fastest counts")
    given = parser.parse_args()
    about = machine()
    unit = about["unit_seconds"]
    bodies = {
        error: tread(COLUMNS, sectors=SECTORS, layers=LAYERS, axial=AXIAL, sampling_error=error)
        for error in SAMPLING_ERRORS
    }
    law = power_layer(bodies[SAMPLING_ERRORS[0]])
    pitch = 2.0 * np.pi / SECTORS
    rate, swing = COLUMNS_A_STEP * pitch / STEP, 0.4 * COLUMNS * pitch
    cases = [("full", SAMPLING_ERRORS[0]), *(("reduced", error) for error in SAMPLING_ERRORS)]
    best: dict[tuple[str, float], float] = {}
    last = {}
    for _ in range(given.rounds):
        for name, error in cases:
            scene = scene_of(bodies[error], name, APPROACH, swing, rate, given.steps * STEP)
            scene.contacts[0].law = law
            result = last[name, error] = run_quadrature(scene, given.steps)
            best[name, error] = min(step_seconds(result), best.get((name, error), np.inf))
    gram = np.asarray(bodies[SAMPLING_ERRORS[0]].contact_surfaces["tread"].gram_z)
    pressures = {key: on_grid(bodies[key[1]], result) for key, result in last.items()}
    print(f"U = {unit * 1e6:.1f} us")
    print("quadrature  wanted error  points  active  iterations    us/step   U/step  pressure off")
    rows = []
    for key in cases:
        name, error = key
        pairs = zip(pressures[key], pressures[cases[0]], strict=True)
        row = {
            "quadrature": name, "points": points_of(bodies[error], name), "case": error if name == "reduced" else None,
            "active": float(last[key].history.contacts[PAIR].active_nodes.mean()),
            "iterations": last[key].history.counters["mean_iterations"], "seconds_per_step": best[key],
            "pressure_off": max(surface_norm(p - q, gram) / surface_norm(q, gram) for p, q in pairs),
        }  # fmt: skip
        rows.append(row)
        wanted = f"{error:.1%}" if name == "reduced" else "-"
        print(
            f"{name:10s} {wanted:>13s} {row['points']:7d} {row['active']:7.1f} {row['iterations']:11.2f} "
            f"{best[key] * 1e6:10.1f} {best[key] / unit:8.2f} {row['pressure_off']:13.2e}"
        )
    if given.json:
        given.json.write_text(json.dumps({**about, "rows": rows}, indent=1) + "\n")


if __name__ == "__main__":
    main()
