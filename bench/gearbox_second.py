"""A second of the gearbox at speed: `python bench/gearbox_second.py [--duration SECONDS] [--json FILE]`.

The demo `gearbox` with all bearings and meshes, `--duration 1` for the second: status, energy balance, time per step,
and the share of each package of kernels, which are timed one after another over the first steps (`roofline.timed`, less
20 us of Python each). Patches have the cells of the quick demo. High frequencies are damped more than in the demo,
spectral radius 0.5: balls without load rattle in their clearance, and nothing else takes that energy.
"""

from __future__ import annotations

import argparse
import json
import time
from collections import defaultdict
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np

import warpffrf as wf
from demos import gearbox
from roofline import timed
from warpffrf.study.machine import machine

DAMPED, SAMPLE = 0.5, 0.01  # spectral radius; s, of which the shares are
CALL = 2e-5  # s, of Python in a launch by itself


def run(duration: float) -> wf.Result:
    size = replace(gearbox.QUICK, duration=duration)
    options = wf.RunOptions(integrator=wf.integrators.GeneralizedAlpha(DAMPED), save_every=10)
    scene = gearbox.build(size, gearbox.SPEED)
    return wf.simulate(scene, duration, step=gearbox.STEP, start="equilibrium", options=options)


def shares() -> dict[str, float]:
    """Of the packages of kernels in the time of the first steps, the largest first."""
    with timed("cpu") as times:
        run(SAMPLE)
    spent: dict[str, float] = defaultdict(float)
    for launch, seconds in times.items():
        package = launch.kernel.module.name.split(".")[1]
        spent[package] += len(seconds) * max(float(np.median(seconds)) - CALL, 0.0)
    total = sum(spent.values())
    return {package: part / total for package, part in sorted(spent.items(), key=lambda item: -item[1])}


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--duration", type=float, default=0.05, help="s")
    parser.add_argument("--json", type=Path, help="write machine, versions and figures to this file")
    given = parser.parse_args()
    parts = shares()
    begin = time.perf_counter()
    result = run(given.duration)
    wall, counters = time.perf_counter() - begin, result.history.counters
    steps = round(result.time[-1] / gearbox.STEP)
    found: dict[str, Any] = {
        "status": str(result.status), "until": float(result.time[-1]), "wall": wall, "steps": steps,
        "attempts": counters["steps"] + counters["rejected_steps"], "iterations": counters["mean_iterations"],
        "seconds_a_step": counters["seconds_in_graph"] / steps, "parts": parts,
        "energy": float(np.abs(result.energy_residual).max()),
    }  # fmt: skip
    print(f"{found['status']} {result.message}: {found['until']:.4g} s in {wall:.0f} s")
    print(
        f"{steps} steps, {found['attempts']} attempts with halved ones, {1e3 * found['seconds_a_step']:.3g} ms a step"
    )
    print(f"energy balance closed to {found['energy']:.1e} of the largest energy")
    print(", ".join(f"{package} {part:.0%}" for package, part in parts.items() if part > 0.005))
    if given.json:
        given.json.write_text(json.dumps({**machine(), **found}, indent=1) + "\n")


if __name__ == "__main__":
    main()
