"""Launches of a step, and what each occupies: `python bench/launches.py [--json FILE] [--scenes NAME ...]`.

For each scene: how often a step launches each kernel, counted while the graph replays (loops by the rounds that they
really took), and the threads of a launch in one world: entries of its axes, times the lanes of a block. A kernel with
*one thread* has neither; one with *one lane* has a block, but a loop that its first lane runs while the others wait.

Of the kernels on which the CPU spends most of its time (`--heaviest`): registers, spilled bytes and shared memory for
compute capability 9.0, as `ptxas -v` reports them of the PTX that NVRTC makes here; no GPU is needed. Without `ptxas`
on the path (CUDA toolkit) this table is left out. It takes minutes: up to one for each module.
"""

from __future__ import annotations

import argparse
import ast
import functools
import inspect
import json
import re
import shutil
import statistics
import subprocess
import tempfile
import textwrap
from collections.abc import Callable
from math import prod
from pathlib import Path
from typing import Any

import warp as wp

import warpffrf as wf
from on_device import pair, pendulums, rollers
from scenes.film_bearing import GROOVE, bearing, bore
from scenes.planets import planets
from step.step_profile import Cycles, counted
from warpffrf.online import Engine
from warpffrf.online.start.consistent import start_consistently
from warpffrf.online.start.static_equilibrium import settle
from warpffrf.online.step import phases
from warpffrf.online.step.launches import Launch
from warpffrf.online.step.program import Program
from warpffrf.study.machine import machine
from warpffrf_kernels.core import control as k
from warpffrf_kernels.core.scalars import BLOCK

STEP, WARM_UP, STEPS = 1e-4, 20, 40
AT_REST = ("20 hinged rods", "oil film")  # start without an equilibrium
ARCH = 90  # compute capability 9.0
SHARED = 227 * 1024  # B of a block on it
BALLS = wf.bearings.BallGeometry(elements=20, ball_diameter=12.7e-3, pitch_diameter=0.11, clearance=15e-6)
REPORT = re.compile(
    r"entry function '(\w+)'.*?(\d+) bytes stack frame, (\d+) bytes spill stores, (\d+) bytes spill loads"
    r".*?Used (\d+) registers(?:.*?(\d+) bytes smem)?",
    re.DOTALL,
)


def film() -> wf.Scene:
    """A shaft in an elastic bore with an oil film."""
    return bearing(bore((32, 7)), (8e3, 1e3), feeds=[GROOVE])


def lumped() -> wf.Scene:
    """Twenty balls between rigid rings, the inner one free in its plane under a radial force."""
    scene = wf.Scene(gravity=(0, 0, 0))
    ring = scene.add_bearing("b", BALLS, first=(0, 0, 1), outer=scene.ground).inner
    scene.add(wf.joints.Planar(scene.ground.at((0, 0, 0)), ring, axis=(0, 1, 0)))
    scene.add(wf.forces.PointForce(ring, (1e3, 0.0, 5e3)))
    return scene


def all_scenes() -> dict[str, Callable[[], wf.Scene]]:
    """What is counted, by name."""
    return {
        "20 hinged rods": lambda: pendulums(small=False),
        "two rollers": lambda: pair(0.0),
        "two rollers, friction": lambda: pair(0.3),
        "nine rollers, friction": lambda: planets(rollers()[0], 8, 100e3, friction=0.3, creepage=2e-3),
        "oil film": film,
        "bearing of 20 balls, lumped": lumped,
    }


def walks_alone(kernel: Any) -> bool:
    """Whether a kernel of a block has a loop for its first lane only."""

    def first_only(test: ast.expr) -> bool:
        return isinstance(test, ast.Compare) and ast.unparse(test) == "lane == 0"

    tree = ast.parse(textwrap.dedent(inspect.getsource(kernel.func)))
    alone = [node for node in ast.walk(tree) if isinstance(node, ast.If) and first_only(node.test)]
    return any(
        isinstance(inner, ast.While) for node in alone for statement in node.body for inner in ast.walk(statement)
    )


def counts(scene: wf.Scene, static: bool) -> tuple[Program, dict[tuple[str, str], tuple[float, int]]]:
    """The program of a scene, and (cycles, calls) of each kernel of each phase in `STEPS` steps."""
    cycles = Cycles()
    with counted(cycles):
        engine = Engine(scene)
        if static and not settle(engine):
            raise RuntimeError("no equilibrium")
        engine.initial_rates()
        start_consistently(engine, STEP)
        engine.control(every=WARM_UP + STEPS)
        engine.enter(k.DYNAMIC, STEP, target=WARM_UP)
        engine.replay(8 * WARM_UP)
        cycles.forget()
        engine.control(target=WARM_UP + STEPS)
        engine.replay(8 * STEPS)
    if engine.word("status").any() or (engine.word("step") != WARM_UP + STEPS).any():
        raise RuntimeError(f"status {engine.word('status')[0]} at step {engine.word('step')[0]}")
    return engine.graph.program, cycles.found()


def census(make: Callable[[], wf.Scene], static: bool, rounds: int) -> list[dict[str, Any]]:
    """A row for each kernel of each phase: calls per step, threads, and the share of the time on the CPU, of which the
    least of some rounds counts: other work on the machine only adds."""
    program, first = counts(make(), static)
    found = [first, *(counts(make(), static)[1] for _ in range(rounds - 1))]
    least = {place: (max(min(one[place][0] for one in found), 0.0), calls) for place, (_, calls) in first.items()}
    total = sum(spent for spent, _ in least.values())
    rows = {}
    for phase, parts in program.parts.items():
        for launch, _ in phases.launches(parts, program.sizes):
            spent, calls = least.get((phase, launch.label), (0.0, 0))
            row = {"phase": phase, **about(launch, program.sizes), "calls": calls / STEPS, "share": spent / total}
            rows.setdefault((phase, launch.label), row)
    return [row for row in rows.values() if row["calls"] > 0]


def about(launch: Launch, sizes: Any) -> dict[str, Any]:
    """A launch as a row."""
    entries = prod(sizes[axis] for axis in launch.over)
    return {
        "kernel": launch.label,
        "module": launch.kernel.module.name,
        "over": " x ".join(launch.over),
        "threads": entries * (BLOCK if launch.block else 1),
        "one_thread": not launch.block and launch.over in (("world",), ("one",)),
        "one_lane": launch.block and walks_alone(launch.kernel),
    }


def summary(rows: list[dict[str, Any]]) -> dict[str, Any]:
    """Figures of a scene. The median is over the launches of a step."""
    sizes = [row["threads"] for row in rows for _ in range(max(round(row["calls"] * STEPS), 0))]
    return {
        "launches": sum(row["calls"] for row in rows),
        "kernels": len({row["kernel"] for row in rows}),
        "median_threads": statistics.median(sizes),
        "one_thread": sorted({row["kernel"] for row in rows if row["one_thread"]}),
        "one_lane": sorted({row["kernel"] for row in rows if row["one_lane"]}),
        "launches_of_one_thread": sum(row["calls"] for row in rows if row["one_thread"]),
    }


def heaviest(tables: dict[str, list[dict[str, Any]]], count: int) -> dict[str, str]:
    """The modules of the kernels with the largest share of a step, the mean over the scenes, by kernel."""
    share: dict[str, float] = {}
    module = {}
    for rows in tables.values():
        for row in rows:
            share[row["kernel"]] = share.get(row["kernel"], 0.0) + row["share"] / len(tables)
            module[row["kernel"]] = row["module"]
    first = sorted(share, key=lambda kernel: -share[kernel])[:count]
    return {kernel: module[kernel] for kernel in first}


def occupancy(kernels: dict[str, str]) -> list[dict[str, Any]]:
    """Registers, spills and shared memory of kernels, by module of each."""
    compiled = {name: compiled_module(name) for name in dict.fromkeys(kernels.values())}
    return [{"kernel": kernel, **compiled[module][kernel.rsplit(".", 1)[-1]]} for kernel, module in kernels.items()]


@functools.cache
def accepted() -> str:
    """The newest version of PTX that `ptxas` reads: 9.0 for CUDA 13.0. NVRTC may declare a newer one."""
    said = subprocess.run(["ptxas", "--version"], capture_output=True, text=True, check=True).stdout
    major, minor = re.findall(r"release (\d+)\.(\d+)", said)[0]
    return f"{int(major) - 4}.{minor}"


def compiled_module(name: str) -> dict[str, dict[str, int]]:
    """Of each kernel of a module, by key."""
    module = wp.get_module(name)
    before = module.options["block_dim"]
    module.options["block_dim"] = BLOCK
    try:
        with tempfile.TemporaryDirectory() as folder:
            wp.compile_aot_module(module, arch=ARCH, module_dir=folder, use_ptx=True)
            (ptx,), (meta,) = Path(folder).glob("*.ptx"), Path(folder).glob("*.meta")
            source = ptx.read_text(encoding="utf-8").rstrip("\0")  # Warp writes the terminating zero too
            ptx.write_text(re.sub(r"^\.version .*$", f".version {accepted()}", source, count=1, flags=re.MULTILINE))
            command = ["ptxas", "-v", f"-arch=sm_{ARCH}", str(ptx), "-o", str(Path(folder) / "cubin")]
            report = subprocess.run(command, capture_output=True, text=True, check=True).stderr
            dynamic = {key: int(size) for key, size in json.loads(meta.read_text()).items() if "smem" in key}
    finally:
        module.options["block_dim"] = before
    found = {}
    for entry, stack, stored, loaded, registers, shared in REPORT.findall(report):
        key = re.sub(r"_[0-9a-f]{8}_cuda_kernel_forward$", "", entry)
        own = max((size for label, size in dynamic.items() if label.startswith(entry)), default=0)
        found[key] = {
            "registers": int(registers), "spilled_bytes": int(stored) + int(loaded), "stack_bytes": int(stack),
            "shared_bytes": int(shared or 0) + own,
        }  # fmt: skip
    return found


def show(name: str, rows: list[dict[str, Any]], figures: dict[str, Any], most: int) -> None:
    """Print the table of a scene."""
    print(
        f"\n{name}: {figures['launches']:.0f} launches per step, {figures['launches_of_one_thread']:.0f} of one thread"
    )
    print(f"{'kernel':<44} {'phase':<20} {'over':<24} {'threads':>8} {'calls':>7} {'share':>7}")
    for row in sorted(rows, key=lambda row: -row["share"])[:most]:
        note = "  one thread" if row["one_thread"] else "  one lane" if row["one_lane"] else ""
        print(f"{row['kernel']:<44} {row['phase']:<20} {row['over']:<24} {row['threads']:>8} {row['calls']:>7.2f} "
              f"{row['share']:>7.1%}{note}")  # fmt: skip


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--json", type=Path, help="write machine, versions and rows to this file")
    parser.add_argument("--scenes", nargs="*", metavar="NAME", help="only these")
    parser.add_argument("--rounds", type=int, default=2, help="runs of a scene")
    parser.add_argument("--heaviest", type=int, default=10, help="kernels whose registers are reported")
    parser.add_argument("--rows", type=int, default=400, help="kernels that are shown of a scene")
    given = parser.parse_args()
    made = all_scenes()
    tables, figures = {}, {}
    for name in given.scenes or made:
        tables[name] = census(made[name], name not in AT_REST, given.rounds)
        figures[name] = summary(tables[name])
        show(name, tables[name], figures[name], given.rows)
    registers: list[dict[str, Any]] = []
    if given.heaviest and shutil.which("ptxas") is None:
        print("\nregisters: not measured, there is no ptxas on the path")
    elif given.heaviest:
        registers = occupancy(heaviest(tables, given.heaviest))
        print(f"\n{'heaviest kernels, sm_90':<44} {'registers':>9} {'spilled B':>9} {'stack B':>8} {'shared B':>8}")
        for row in registers:
            print(f"{row['kernel']:<44} {row['registers']:>9} {row['spilled_bytes']:>9} {row['stack_bytes']:>8} "
                  f"{row['shared_bytes']:>8}{'' if row['shared_bytes'] <= SHARED else '  does not fit'}")  # fmt: skip
    print(f"\n{'scene':<30} {'launches':>8} {'kernels':>8} {'median threads':>15} {'one thread':>11} {'one lane':>9}")
    for name, of in figures.items():
        print(f"{name:<30} {of['launches']:>8.0f} {of['kernels']:>8} {of['median_threads']:>15.0f} "
              f"{len(of['one_thread']):>11} {len(of['one_lane']):>9}")  # fmt: skip
    if given.json:
        rows = [{"scene": name, **of, "kernels_of_it": tables[name]} for name, of in figures.items()]
        given.json.write_text(json.dumps({**machine(), "rows": rows, "sm_90": registers}, indent=1) + "\n")


if __name__ == "__main__":
    main()
