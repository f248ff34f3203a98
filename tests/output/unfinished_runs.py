"""Runs that are to be stopped, as a program of its own: `python unfinished_runs.py CASE RESULTS [KEEP_EVERY]`.

It says "ready", "going" whenever a part is kept, and its status at the end.
"""

from __future__ import annotations

import os
import resource
import signal
import sys
from pathlib import Path
from typing import Any

import warpffrf as wf
from warpffrf.model.integrators import EnergyMomentum, RungeKutta4
from warpffrf.model.keeping import Unfinished
from warpffrf.output.files.unfinished import UnfinishedRun

STEP, STEPS = 1e-4, 30_000
CHECKS = {"runge-kutta": RungeKutta4(), "energy-momentum": EnergyMomentum()}
OPTIONS: dict[str, Any] = {"progress": False, "keep_every": 0.02}


def pendulum() -> wf.Scene:
    """An arm on a hinge, with a spring."""
    scene = wf.Scene()
    arm = scene.add_rigid_body(1.0, (0.1, 0.1, 0.1), name="arm", position=(0.5, 0.0, 0.0))
    scene.add(wf.joints.Revolute(scene.ground.at((0, 0, 0)), arm.at((-0.5, 0, 0)), axis=(0, 1, 0), name="hinge"))
    scene.add(wf.forces.JointSpringDamper(scene.joints[0], 20.0, name="spring"))
    return scene


def top() -> wf.Scene:
    """A free body that tumbles."""
    scene = wf.Scene()
    scene.add_rigid_body(1.0, (0.1, 0.2, 0.3), name="top", velocity=(1.0, 0.0, 2.0), angular_velocity=(0.1, 9.0, 0.2))
    return scene


def simulate(case: str, results: Path | None, **more: Any) -> wf.Result:
    """The run of `case`: in one go, in stages, or from one equilibrium to the next."""
    options = OPTIONS | more
    if case == "stages":
        half = 0.5 * STEPS * STEP
        parts = [wf.Stage("swing", half, STEP), wf.Stage("fall", half, STEP, {"gravity": (0.0, 0.0, -3.0)})]
        return wf.simulate(pendulum(), stages=parts, results=results, **options)
    if case in CHECKS:
        return wf.simulate(
            top(), STEPS / 4 * STEP, step=STEP, integrator=CHECKS[case], save_every=3, results=results, **options
        )
    if case == "static":
        return wf.simulate(pendulum(), STEPS * STEP, step=STEP, kind="static", results=results, **options)
    every = {"sparse": 7, "recorded": 100}.get(case, 1)
    if case == "recorded" and results is not None:
        options["record"] = results.with_suffix(".rrd")
    step_error = 1e-7 if case == "adaptive" else None
    return wf.simulate(
        pendulum(), STEPS * STEP, step=STEP, save_every=every, step_error=step_error, results=results, **options
    )  # fmt: skip


def reduced(results: Path) -> wf.ReducedBody:
    """A body by the general path, with a cache beside `results`."""
    os.environ["WARPFFRF_CACHE"] = str(results.parent / "cache")
    mesh = wf.mesh.box((0.1, 0.05, 0.02), (10, 6, 4))
    steel = wf.Material(210e9, 0.3, 7850.0)
    return wf.reduce(mesh, steel, interfaces={"x_min": "rigid"}, contact={"z_max": wf.surfaces.Plane()}, progress=False)


def main() -> None:
    write = UnfinishedRun._write

    def and_say(self: UnfinishedRun, run: Unfinished) -> None:
        write(self, run)
        print("going", flush=True)

    UnfinishedRun._write = and_say
    signal.signal(
        signal.SIGINT, signal.default_int_handler
    )  # of tests that a shell runs in the background it is ignored
    case, results = sys.argv[1], Path(sys.argv[2])
    every = float(sys.argv[3]) if len(sys.argv) > 3 else OPTIONS["keep_every"]
    if limit := os.environ.get("FILE_LIMIT"):  # bytes: as on a full disk, writing more fails
        resource.setrlimit(resource.RLIMIT_FSIZE, (int(limit), int(limit)))
    print("ready", flush=True)
    if case == "reduced":
        reduced(results).save(results, overwrite=True)
        return
    result = simulate(case, results, keep_every=every)
    print("status", result.status, len(result.unwritten), flush=True)


if __name__ == "__main__":
    main()
