"""Load spectra of rigid bearings: `python bench/duty_cycle.py [--json FILE] [--points N]`.

20 balls, and 20 rollers of 30 laminae, under radial loads of random size within 35 degrees of the first element, each
an equilibrium of `wf.static`. *ms* is CPU time of the run with its set-up, kernels being loaded, over the points;
*order*: the points as drawn, these in the order of `signals.short_path`, or loads and angles each in ascending order.
*pressures* and *lives* are CPU seconds of the patches of all points, and of the modified life by `duty_life`.
"""

from __future__ import annotations

import argparse
import json
import time
from pathlib import Path
from typing import Any

import numpy as np

import warpffrf as wf
from warpffrf.study.machine import machine

POINTS = 300
LEAST, MOST, SPREAD = 1e3, 9e3, 0.6  # N, rad
BALLS = wf.bearings.BallGeometry(elements=20, ball_diameter=12.7e-3, pitch_diameter=0.11, clearance=15e-6)
ROLLERS = wf.bearings.RollerGeometry(
    elements=20, roller_diameter=0.01, roller_length=0.01, pitch_diameter=0.08, clearance=15e-6
)


def bearing(kind: str, points: int, order: str) -> wf.Scene:
    """The bearing "b", its inner ring free in its plane."""
    scene = wf.Scene(gravity=(0, 0, 0))
    if kind == "balls":
        ring = scene.add_bearing("b", BALLS, first=(0, 0, 1), outer=scene.ground).inner
    else:
        laminae = wf.bearings.RollingContact(law=wf.laws.IsoLamina(ROLLERS.roller_length))
        ring = scene.add_bearing("b", ROLLERS, first=(0, 0, 1), outer=scene.ground, contact=laminae).inner
    scene.add(wf.joints.Planar(scene.ground.at((0, 0, 0)), ring, axis=(0, 1, 0)))
    rng, number = np.random.default_rng(1), np.arange(float(points))
    angle, load = rng.uniform(-SPREAD, SPREAD, points), rng.uniform(LEAST, MOST, points)
    if order == "ascending":
        load, angle = np.sort(load), np.sort(angle)
    elif order == "short path":
        path = wf.signals.short_path(load[:, None] * np.stack([np.sin(angle), np.cos(angle)], axis=1))
        load, angle = load[path], angle[path]
    parts = [wf.signals.Table(number, load * way(angle)) for way in (np.sin, np.cos)]
    scene.add(wf.forces.PointForce(ring, (parts[0], 0.0, parts[1])))
    return scene


def run(kind: str, points: int, order: str) -> dict[str, Any]:
    """Figures of a spectrum."""
    wf.static(bearing(kind, 2, "ascending"), 1.0, step=1.0, progress=False)
    used = time.process_time()
    scene = bearing(kind, points, order)
    result = wf.static(scene, points - 1.0, step=1.0, progress=False)
    row: dict[str, Any] = {"table": "duty cycle", "kind": kind, "order": order}
    row["seconds_per_point"] = (time.process_time() - used) / points
    row["status"], row["points"] = result.status, points
    row["iterations"] = result.history.counters["mean_iterations"]
    found = result.bearing("b")
    for name, evaluate in (
        ("pressures", lambda: found.peak_pressure),
        ("lives", lambda: found.duty_life(np.full(points, 1.0 / points), 100.0, kappa=1.5, contamination=0.5)),
    ):
        used = time.process_time()
        evaluate()
        row[f"{name}_seconds"] = time.process_time() - used
    return row


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--json", type=Path, help="write machine, versions and rows to this file")
    parser.add_argument("--points", type=int, default=POINTS)
    given = parser.parse_args()
    about, rows = machine(), []
    print(f"U = {about['unit_seconds'] * 1e6:.1f} us")
    print(f"{'kind':<8} {'order':<10} {'ms/point':>9} {'U':>6} {'iterations':>10} {'pressures':>9} lives")
    for kind in ("balls", "rollers"):
        for order in ("as drawn", "short path", "ascending"):
            row = run(kind, given.points, order)
            rows.append(row)
            step = row["seconds_per_point"]
            print(
                f"{kind:<8} {row['order']:<10} {1e3 * step:>9.2f} {step / about['unit_seconds']:>6.1f} "
                f"{row['iterations']:>10.2f} {row['pressures_seconds']:>9.3f} "
                f"{row['lives_seconds']:.3f}  {row['status']}",
                flush=True,
            )
    if given.json:
        given.json.write_text(json.dumps({**about, "rows": rows}, indent=1) + "\n")


if __name__ == "__main__":
    main()
