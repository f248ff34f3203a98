"""Runs that are to be stopped, as a program of its own: `python unfinished_runs.py CASE RESULTS [KEEP_EVERY]`.

It says "ready", "going" whenever a part is kept, and its status at the end. `python unfinished_runs.py serve` has
imported everything and loaded the kernels; for each line "CASE RESULTS PIPE" that it reads it forks a process, whose
number it says, that does the same at once in `FEW` steps and speaks into the pipe. That one rests for `REST` when its
first part is kept, so that whoever listens can stop it in time.
"""

from __future__ import annotations

import os
import resource
import signal
import sys
import time
from pathlib import Path
from typing import Any

import warpffrf as wf
from warpffrf.model.integrators import EnergyMomentum, RungeKutta4
from warpffrf.model.messages.checkpoints import Unfinished
from warpffrf.output import outputs
from warpffrf.output.files.unfinished import UnfinishedRun

STEP, STEPS = 1e-4, 30_000
FEW = 8_000  # steps of a run that is forked
REST = 2.0  # s
CHECKS = {"runge-kutta": RungeKutta4(), "energy-momentum": EnergyMomentum()}
OPTIONS: dict[str, Any] = {"progress": False}
KEEP_EVERY = 0.02  # s


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


def simulate(case: str, results: Path | None, steps: int = STEPS, **more: Any) -> wf.Result:
    """The run of `case`: in one go, in stages, or from one equilibrium to the next."""
    options = OPTIONS | more
    if case == "stages":
        half = 0.5 * steps * STEP
        parts = [wf.Stage("swing", half, STEP), wf.Stage("fall", half, STEP, {"gravity": (0.0, 0.0, -3.0)})]
        return wf.simulate(pendulum(), parts, results=results, **options)
    if case in CHECKS:
        return wf.simulate(
            top(),
            steps / 4 * STEP,
            step=STEP,
            options=wf.RunOptions(integrator=CHECKS[case], save_every=3),
            results=results,
            **options,
        )
    if case == "static":
        return wf.static(pendulum(), steps * STEP, step=STEP, results=results, **options)
    every = {"sparse": 7, "recorded": 100}.get(case, 1)
    if case == "recorded" and results is not None:
        options["record"] = results.with_suffix(".rrd")
    step_error = 1e-7 if case == "adaptive" else None
    return wf.simulate(
        pendulum(),
        steps * STEP,
        step=STEP,
        options=wf.RunOptions(save_every=every, step_error=step_error),
        results=results,
        **options,
    )


def reduced(results: Path) -> wf.ReducedBody:
    """A body by the general path, with a cache next to `results`."""
    os.environ["WARPFFRF_CACHE"] = str(results.parent / "cache")
    mesh = wf.mesh.box((0.1, 0.05, 0.02), (10, 6, 4))
    steel = wf.Material(210e9, 0.3, 7850.0)
    return wf.reduce(mesh, steel, interfaces={"x_min": "rigid"}, contact={"z_max": wf.surfaces.Plane()}, progress=False)


def say(what: str) -> None:
    print(what, flush=True)


def say_what_is_kept(rest: float = 0.0) -> None:
    """Say "going" for each part that is kept; the run rests for `rest` [s] when it looks whether another one is due."""
    write, due = UnfinishedRun._write, UnfinishedRun.due
    left = [rest]

    def and_say(self: UnfinishedRun, run: Unfinished) -> None:
        write(self, run)
        say("going")

    def after_rest(self: UnfinishedRun) -> bool:
        if self.parts:
            time.sleep(left.pop() if left else 0.0)
        return due(self)

    UnfinishedRun._write = and_say
    UnfinishedRun.due = after_rest


def program(case: str, results: Path, steps: int, every: float) -> None:
    """The program itself."""
    signal.signal(
        signal.SIGINT, signal.default_int_handler
    )  # of tests that a shell runs in the background it is ignored
    say("ready")
    if case == "reduced":
        reduced(results).save(results, overwrite=True)
        return
    outputs.KEEP_EVERY = every
    result = simulate(case, results, steps)
    say(f"status {result.status} {len(result.unwritten)}")


def serve() -> None:
    """Fork a program for each line of the standard input."""
    simulate("plain", None, FEW)
    signal.signal(signal.SIGCHLD, signal.SIG_IGN)  # whoever has ended is gone
    say("ready")
    for line in sys.stdin:
        case, results, pipe = line.split()
        if child := os.fork():
            say(str(child))
            continue
        signal.signal(signal.SIGCHLD, signal.SIG_DFL)
        os.dup2(os.open(pipe, os.O_WRONLY), 1)
        say_what_is_kept(REST)
        try:
            program(case, Path(results), FEW, KEEP_EVERY)
        finally:
            os._exit(0)


def main() -> None:
    if sys.argv[1] == "serve":
        serve()
        return
    every = float(sys.argv[3]) if len(sys.argv) > 3 else KEEP_EVERY
    if limit := os.environ.get("FILE_LIMIT"):  # bytes: as on a full disk, writing more fails
        resource.setrlimit(resource.RLIMIT_FSIZE, (int(limit), int(limit)))
    say_what_is_kept()
    program(sys.argv[1], Path(sys.argv[2]), STEPS, every)


if __name__ == "__main__":
    main()
