"""Where the time of a step goes: `python bench/step/step_profile.py [--json FILE] [--rounds N] [--step S] [--rows N]`.

The two-roller demo, spun up and loaded as in `docs/speed_error.md`: pressures on nodes of its mesh, on as many cells as
are chosen by themselves that travel with the patch, and on fewer of them over a mesh of 4 mm, which keep within 1 % of
force and 2 % of pressure.

A step is one recorded graph, in which nothing can be timed from outside. So it is recorded once more with a launch
after every kernel that reads the cycle counter of the processor and adds what has passed since the one before to the
number of that kernel. What such a launch costs itself is measured by one that follows another, and taken off. Shares
are those of this graph, of each kernel the least of some rounds, as other work on the machine only adds; microseconds
are shares of a step of the graph without the counter, the fastest of all rounds. U is timed in the same run.

Kernels count that have nothing to do in a world whose loop has ended: what they show then is what their launch costs.
"""

# pyright: reportInvalidTypeForm=false

from __future__ import annotations

import argparse
import json
from collections.abc import Iterator
from contextlib import contextmanager, nullcontext
from pathlib import Path
from typing import Any

import warp as wp

from demos import two_rollers as demo
from warpffrf.model.reduced.body import ReducedBody
from warpffrf.model.scene import Scene
from warpffrf.online import History, run
from warpffrf.online.checkpoint import restore
from warpffrf.online.engine import Engine
from warpffrf.online.step import phases, program
from warpffrf.online.step.graph import StepGraph
from warpffrf.online.step.launches import Launch
from warpffrf.online.warp_start import quiet
from warpffrf.study.machine import machine

LOAD_STEP = 0.008  # s, into the spin-up
DURATION = 0.024  # s
MOST_KERNELS = 400  # launches of a step that are listed separately
CHUNK = 200  # steps of a replay
WARM_UP = 4  # steps that do not count
COARSE = demo.Size(sectors=80, layers=8, axial=5)  # hexahedra of 4 mm
SCENES: dict[str, tuple[demo.Size, str, tuple[int, int] | None]] = {
    "nodes of the mesh": (demo.QUICK, "body_fixed", None),
    "cells, as many as are chosen": (demo.QUICK, "contact_fixed", None),
    "9 x 7 cells over 4 mm": (COARSE, "contact_fixed", (9, 7)),
}
BETWEEN, COUNTER = ("between", "steps and chunks"), ("counter", "a launch that reads it")
PHASES = {  # of `online.step.phases`, as a reader of docs/method.md knows them
    "begin predict remember": "prediction",
    "move load": "bodies, joints, loads",
    "locate shift cells": "gaps: place, area, wrench, splines",
    "displace close slide sum push": "displacements and forces of contact",
    "balance store mean unbalanced": "is it balanced?",
    "assemble eliminate": "retained matrix",
    "assemble_compliance condense": "compliance G, gradients L",
    "solve_normal": "factor, pressures, retained increments",
    "increase back_substitute correct recover advance": "increments, active set",
    "solve_tangential": "tractions",
}  # all others: what ends an attempt
AFTER = "ledger, state, record"

wp.set_module_options({"enable_backward": False})


@wp.func_native("return (int64_t)__builtin_readcyclecounter();")
def cycles() -> wp.int64: ...


@wp.kernel
def read_counter(
    place: int, last: wp.array(dtype=wp.int64), spent: wp.array(dtype=wp.int64), calls: wp.array(dtype=int)
):
    """Adds the cycles since `last` to those of a place."""
    now = cycles()
    spent[place] = spent[place] + now - last[0]
    calls[place] = calls[place] + 1
    last[0] = cycles()


class Cycles:
    """Cycles and calls of each (phase, kernel) of the graphs that are recorded inside `counted`."""

    def __init__(self) -> None:
        self.places: dict[tuple[str, str], int] = {BETWEEN: 0, COUNTER: 1}
        self.last = wp.zeros(1, dtype=wp.int64, device="cpu")
        self.spent = wp.zeros(MOST_KERNELS, dtype=wp.int64, device="cpu")
        self.calls = wp.zeros(MOST_KERNELS, dtype=int, device="cpu")
        self.phase = ""

    def read(self, place: tuple[str, str]) -> None:
        """Record a launch that books what has passed since the last one on `place`."""
        number = self.places.setdefault(place, len(self.places))
        wp.launch(read_counter, dim=1, inputs=[number, self.last, self.spent, self.calls], device="cpu")

    def forget(self) -> None:
        """Begin anew."""
        self.spent.zero_()
        self.calls.zero_()

    def found(self) -> dict[tuple[str, str], tuple[float, int]]:
        """(cycles, calls) of each place, without those of the counter and between steps."""
        spent, calls = self.spent.numpy(), self.calls.numpy()
        own = spent[1] / max(int(calls[1]), 1)
        return {
            place: (float(spent[n]) - own * int(calls[n]), int(calls[n]))
            for place, n in self.places.items()
            if place not in (BETWEEN, COUNTER)
        }


@contextmanager
def counted(cycles_of: Cycles) -> Iterator[None]:
    """Graphs that are recorded inside read the counter after every launch."""
    go, run_phases, record = Launch.go, program.Program.run, StepGraph.__init__

    def counted_record(self: StepGraph, *about: Any, **options: Any) -> None:
        Launch.go, program.Program.run = counted_go, counted_run
        try:
            record(self, *about, **options)
        finally:
            Launch.go, program.Program.run = go, run_phases

    def counted_go(self: Launch, arrays: Any, sizes: Any, device: str) -> None:
        if cycles_of.phase == "begin" and self.label.endswith("begin_step"):
            cycles_of.read(BETWEEN)
            cycles_of.read(COUNTER)
        go(self, arrays, sizes, device)
        cycles_of.read((cycles_of.phase, self.label))

    def counted_run(self: program.Program, names: Any) -> None:
        for name in names:
            cycles_of.phase = name
            run_phases(self, (name,))

    with quiet():
        wp.load_module(device="cpu")  # nothing is compiled while a graph is recorded
    StepGraph.__init__ = counted_record
    try:
        yield
    finally:
        StepGraph.__init__ = record


def scene_of(roller: ReducedBody, grid: str, cells: tuple[int, int] | None) -> Scene:
    """The demo with pressures on one of the grids."""
    scene = demo.machine(roller, load_step_at=LOAD_STEP)
    contact = scene.contacts[0]
    contact.grid = grid
    if grid == "contact_fixed":
        contact.cells = cells
    return scene


def stepped(scene: Scene, start: History, step: float, steps: int, cycles_of: Cycles | None = None) -> float:
    """Seconds of a step in the graph, over `steps` of them from where `start` has ended."""
    with counted(cycles_of) if cycles_of is not None else nullcontext():
        engine = Engine(scene)
        done = restore(engine, start.checkpoint, step)
        engine.control(every=1)
        last = done + steps
        done = _go_to(engine, done + WARM_UP)  # there is room for all cells afterwards, and the graph is the last one
        if cycles_of is not None:
            cycles_of.forget()
        engine.seconds_in_graph = 0.0
        while done < last:
            done = _go_to(engine, min(done + CHUNK, last))
    return engine.seconds_in_graph / (steps - WARM_UP)


def _go_to(engine: Engine, target: int) -> int:
    engine.control(target=target)
    engine.replay(2 * CHUNK)
    done = int(engine.word("step")[0])
    if done != target:
        raise RuntimeError(f"the demo has ended at step {done} on its way to {target}")
    return target


def profile(scene: Scene, step: float, duration: float, rounds: int) -> dict[str, Any]:
    """Seconds of a step, its counts, and the share of every kernel."""
    steps = round(duration / step)
    counted_steps = steps - WARM_UP
    start = run(scene, step, step=step, start="equilibrium", progress=False)
    history = run(scene, duration, step=step, start=start, progress=False)
    seconds, counts = [], []
    for _ in range(rounds):
        seconds.append(stepped(scene, start, step, steps))
        cycles_of = Cycles()
        stepped(scene, start, step, steps, cycles_of)
        counts.append(cycles_of.found())
    found = {place: (max(min(c[place][0] for c in counts), 0.0), n) for place, (_, n) in counts[0].items()}
    total = sum(spent for spent, _ in found.values())
    return {
        "status": history.status,
        "seconds_per_step": min(seconds),
        "active": float(history.contacts[demo.PAIR].active_nodes.mean()),
        "iterations": float(history.iterations[1:].mean()),
        "solves": float(history.factorisations[1:].mean()),
        "launches_per_step": sum(calls for _, calls in found.values()) / counted_steps,
        "kernels": [
            {"phase": phase, "kernel": kernel, "calls_per_step": calls / counted_steps, "share": spent / total}
            for (phase, kernel), (spent, calls) in sorted(found.items(), key=lambda item: -item[1][0])
        ],
    }


def groups(kernels: list[dict[str, Any]]) -> dict[str, float]:
    """Share of each part of a step."""
    of = {phase: name for names, name in PHASES.items() for phase in names.split()}
    if not set(of) <= set(phases.PHASES):
        raise RuntimeError(f"no phases of a step: {', '.join(sorted(set(of) - set(phases.PHASES)))}")
    found = dict.fromkeys([*PHASES.values(), AFTER], 0.0)
    for row in kernels:
        found[of.get(row["phase"], AFTER)] += row["share"]
    return found


def show(name: str, found: dict[str, Any], unit: float, rows: int) -> None:
    """Print the tables of a scene."""
    seconds = found["seconds_per_step"]
    print(f"\n{name}: {seconds * 1e6:.1f} us = {seconds / unit:.2f} U a step, {found['active']:.1f} active, "
          f"{found['iterations']:.2f} iterations, {found['solves']:.2f} solves, "
          f"{found['launches_per_step']:.0f} launches; {found['status']}")  # fmt: skip
    print(f"{'part of a step':<48} {'share':>7} {'us':>8} {'U':>6}")
    for part, share in groups(found["kernels"]).items():
        print(f"{part:<48} {share:>7.1%} {share * seconds * 1e6:>8.1f} {share * seconds / unit:>6.2f}")
    print(f"{'kernel':<48} {'share':>7} {'us':>8} {'calls':>6}  phase")
    for row in found["kernels"][:rows]:
        print(f"{row['kernel']:<48} {row['share']:>7.1%} {row['share'] * seconds * 1e6:>8.1f} "
              f"{row['calls_per_step']:>6.2f}  {row['phase']}")  # fmt: skip


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--json", type=Path, help="write machine, versions and rows to this file")
    parser.add_argument("--rounds", type=int, default=3)
    parser.add_argument("--step", type=float, default=demo.STEP)
    parser.add_argument("--scenes", nargs="*", default=list(SCENES), choices=list(SCENES), metavar="NAME")
    parser.add_argument("--rows", type=int, default=20, help="kernels that are shown")
    given = parser.parse_args()
    about = machine()
    unit = about["unit_seconds"]
    sizes = {SCENES[name][0] for name in given.scenes}
    bodies = {size: demo.roller_body(size, contact_fixed=True, progress=False) for size in sizes}
    print(f"U = {unit * 1e6:.1f} us")
    rows = []
    for name in given.scenes:
        size, grid, cells = SCENES[name]
        found = profile(scene_of(bodies[size], grid, cells), given.step, DURATION, given.rounds)
        show(name, found, unit, given.rows)
        rows.append({"table": "profile", "name": name, "unit_seconds": unit, **found})
    if given.json:
        given.json.write_text(json.dumps({**about, "rows": rows}, indent=1) + "\n")


if __name__ == "__main__":
    main()
