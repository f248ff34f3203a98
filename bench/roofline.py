"""What bounds each launch of a step: `python bench/roofline.py [--device cuda:0] [--scenes NAME ...] [--small]`.

The scenes of `on_device.py`, one world, one launch after another, each timed from its start to its end (events on a
GPU, the clock on a CPU), the least of all calls. *bytes*: the arrays that the kernel reads and writes according to its
source (`tests/launch_order`), of full length: the most that it can move, without constants of the scene. *peak*: what a
copy of a large array reaches on the same device in the same run; *empty*: a launch of a kernel that does nothing. A
launch is bound by

    launch    its time is less than three empty launches
    memory    its bytes take more than half of its time at the peak
    latency   neither: dependent loads, few lanes at work, or arithmetic; `ncu --set roofline` shows which

Times of launches one by one do not add up to those of a graph; shares of them are what the page shows. Flops are not
counted here. Where there is no such device it says so and ends.
"""

from __future__ import annotations

import argparse
import json
import time
from collections import defaultdict
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import Any

import warp as wp

from launch_order.check import bound_of
from on_device import CASES, Case
from warpffrf.model.errors import InputError
from warpffrf.online import Engine, engine
from warpffrf.online.device import chosen_device
from warpffrf.online.start.consistent import start_consistently
from warpffrf.online.start.static_equilibrium import settle
from warpffrf.online.step.graph import LaunchByLaunch
from warpffrf.online.step.launches import Launch
from warpffrf.online.warp_start import start_warp
from warpffrf.study.machine import machine
from warpffrf_kernels.core import control as k

WARM_UP, STEPS = 4, 10
COPIED = 1 << 26  # B, more than caches hold
ROUNDS = 20

wp.set_module_options({"enable_backward": False})


@wp.kernel
def do_nothing():
    pass


def timer(device: str) -> Callable[[Callable[[], object]], float]:
    """Seconds of a call on a device."""

    def on_gpu(call: Callable[[], object]) -> float:
        begin, end = wp.Event(device, enable_timing=True), wp.Event(device, enable_timing=True)
        wp.record_event(begin)
        call()
        wp.record_event(end)
        return 1e-3 * wp.get_event_elapsed_time(begin, end)

    def on_cpu(call: Callable[[], object]) -> float:
        begin = time.perf_counter()
        call()
        return time.perf_counter() - begin

    return on_gpu if wp.get_device(device).is_cuda else on_cpu


def peak(device: str) -> tuple[float, float]:
    """Bytes per second of a copy, read and written, and seconds of an empty launch."""
    clock = timer(device)
    a, b = (wp.zeros(COPIED, dtype=wp.uint8, device=device) for _ in range(2))
    copied = min(clock(lambda: wp.copy(b, a)) for _ in range(ROUNDS))
    empty = min(clock(lambda: wp.launch(do_nothing, dim=1, device=device)) for _ in range(ROUNDS))
    return 2.0 * COPIED / copied, empty


@contextmanager
def timed(device: str) -> Iterator[dict[Launch, list[float]]]:
    """Times of the launches of engines that are created inside, none of them recorded as a graph."""
    go, recorded, clock = Launch.go, engine.StepGraph, timer(device)
    found: dict[Launch, list[float]] = defaultdict(list)

    def clocked(self: Launch, *arguments: Any) -> None:
        found[self].append(clock(lambda: go(self, *arguments)))

    setattr(Launch, "go", clocked)  # noqa: B010
    setattr(engine, "StepGraph", LaunchByLaunch)  # noqa: B010
    try:
        yield found
    finally:
        setattr(Launch, "go", go)  # noqa: B010
        setattr(engine, "StepGraph", recorded)  # noqa: B010


def moved(launch: Launch, arrays: Any) -> int:
    """Bytes of the arrays that a launch reads, and of those that it writes."""
    bound = bound_of(launch)
    names = [*bound.read, *(bound.written | bound.changed)]
    return sum(arrays[name].size * wp.types.type_size_in_bytes(arrays[name].dtype) for name in names if name in arrays)


def rows_of(case: Case, device: str, small: bool) -> list[dict[str, Any]]:
    """A row for each launch of a step, the slowest first."""
    rate, empty = peak(device)
    with timed(device) as times:
        e = Engine(case.make(small), device=device)
        if case.rest and not settle(e):
            raise RuntimeError("no equilibrium")
        e.initial_rates()
        start_consistently(e, case.step)
        e.control(every=WARM_UP + STEPS)
        e.enter(k.DYNAMIC, case.step, target=WARM_UP)
        e.replay(8 * WARM_UP)
        times.clear()
        e.control(target=WARM_UP + STEPS)
        e.replay(8 * STEPS)
    if e.word("status").any() or (e.word("step") != WARM_UP + STEPS).any():
        raise RuntimeError(f"status {e.word('status')[0]} at step {e.word('step')[0]}")
    arrays = e.graph.program.arrays
    found = []
    for launch, spent in times.items():
        least, size = min(spent), moved(launch, arrays)
        bound = "launch" if least < 3.0 * empty else "memory" if size / rate > 0.5 * least else "latency"
        found.append({
            "kernel": launch.label, "calls": len(spent) / STEPS, "seconds": least, "bytes": size,
            "of_peak": size / rate / least, "bound": bound,
        })  # fmt: skip
    return sorted(found, key=lambda row: -row["seconds"] * row["calls"])


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--device", default="cuda:0")
    parser.add_argument("--scenes", nargs="*", metavar="NAME", help="only these")
    parser.add_argument("--small", action="store_true", help="small versions of the scenes")
    parser.add_argument("--rows", type=int, default=12, help="launches that are shown of a scene")
    parser.add_argument("--json", type=Path, help="write machine, versions and rows to this file")
    given = parser.parse_args()
    start_warp()
    try:
        device = chosen_device(given.device)
    except InputError as error:
        print(f"nothing measured: {error}")
        return
    rate, empty = peak(device)
    print(f"{device}: copies {rate / 1e9:.1f} GB/s, an empty launch {1e6 * empty:.1f} us")
    tables = {}
    for name in given.scenes or CASES:
        rows = tables[name] = rows_of(CASES[name], device, given.small)
        total = sum(row["seconds"] * row["calls"] for row in rows)
        by = {kind: sum(r["seconds"] * r["calls"] for r in rows if r["bound"] == kind) / total
              for kind in ("launch", "memory", "latency")}  # fmt: skip
        shares = ", ".join(f"{kind} {share:.0%}" for kind, share in by.items())
        launches = sum(row["calls"] for row in rows)
        print(f"\n{name}: {launches:.0f} launches, {1e6 * total:.0f} us a step, of which bound by {shares}")
        print(f"{'kernel':<44} {'calls':>6} {'us':>8} {'share':>6} {'kB':>9} {'of peak':>8}  bound by")
        for row in rows[: given.rows]:
            print(f"{row['kernel']:<44} {row['calls']:>6.1f} {1e6 * row['seconds']:>8.1f} "
                  f"{row['seconds'] * row['calls'] / total:>6.1%} {row['bytes'] / 1e3:>9.1f} {row['of_peak']:>8.1%}  "
                  f"{row['bound']}")  # fmt: skip
    if given.json:
        given.json.write_text(
            json.dumps({**machine(), "device": device, "peak": rate, "scenes": tables}, indent=1) + "\n"
        )


if __name__ == "__main__":
    main()
