"""What it costs to keep a run on the way: `python bench/checkpoint_cost.py [--json FILE] [--seconds S]
[--save-every N]`.

The two rollers of the demo, on its coarser mesh, long enough to take the given seconds; in turn without results,
with the parts kept as often as `simulate` does by itself, and as often as it may (KEEP_EVERY next to nothing). Times
are those of the loop over steps, while a thread writes the parts. Each round begins with another of the three;
what is over is the median of the rounds, each against its own run that is not kept.
"""

from __future__ import annotations

import argparse
import json
import tempfile
import time
from pathlib import Path
from statistics import median

from demos import two_rollers
from warpffrf.model.messages.checkpoints import Unfinished
from warpffrf.output import outputs
from warpffrf.output.files.unfinished import UnfinishedRun
from warpffrf.output.options import RunOptions
from warpffrf.output.simulate import simulate
from warpffrf.study.machine import machine

EVERY = {"not kept": None, "as it is": outputs.KEEP_EVERY, "as often as it may": 1e-3}  # s
NEVER = 1e9  # s
TRIED = 500  # steps, to find how many take the seconds


class Watch:
    """How long the thread of a run wrote, how often, and how much; seconds of the clock, and of the processor."""

    def __init__(self) -> None:
        self.parts, self.seconds, self.bytes, self.processor = 0, 0.0, 0, 0.0
        write, watch = UnfinishedRun._write, self

        def timed(self: UnfinishedRun, run: Unfinished) -> None:
            begin, busy = time.monotonic(), time.thread_time()
            write(self, run)
            watch.seconds += time.monotonic() - begin
            watch.processor += time.thread_time() - busy
            watch.parts += 1
            watch.bytes = sum(file.stat().st_size for file in self.folder.iterdir())

        UnfinishedRun._write = timed


def measure(scene, steps: int, every: float | None, folder: Path, watch: Watch, save_every: int) -> dict:
    """Loop seconds of a run, and what was written on the way."""
    watch.parts, watch.seconds, watch.bytes, watch.processor = 0, 0.0, 0, 0.0
    outputs.KEEP_EVERY = every or NEVER
    result = simulate(
        scene, steps * two_rollers.STEP, step=two_rollers.STEP, start="equilibrium", progress=False, overwrite=True,
        options=RunOptions(save_every=save_every), results=None if every is None else folder / "run.h5",
    )  # fmt: skip
    seconds = result.history.counters["loop_seconds"]
    spent = {"writing": watch.seconds, "processor": watch.processor}
    return {"seconds": seconds, "parts": watch.parts, **spent, "megabytes": watch.bytes / 1e6}


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--json", type=Path, help="write machine, versions and rows to this file")
    parser.add_argument("--rounds", type=int, default=1)
    parser.add_argument("--seconds", type=float, default=22.0)
    parser.add_argument("--save-every", type=int, default=1)
    given = parser.parse_args()
    watch, rows = Watch(), []
    scene = two_rollers.build(two_rollers.QUICK)
    with tempfile.TemporaryDirectory() as name:
        folder = Path(name)
        steps = int(given.seconds / (measure(scene, TRIED, None, folder, watch, given.save_every)["seconds"] / TRIED))
        for number in range(given.rounds):
            turn = [*EVERY][number % len(EVERY) :] + [*EVERY][: number % len(EVERY)]
            for kept in turn:
                row = measure(scene, steps, EVERY[kept], folder, watch, given.save_every)
                rows.append({"kept": kept, "round": number, **row})
    print(f"{steps} steps; medians of {given.rounds} rounds")
    print("kept                  seconds  over not kept  parts  writing s  of CPU     MB")
    base = {row["round"]: row["seconds"] for row in rows if row["kept"] == "not kept"}
    for kept in EVERY:
        own = [row for row in rows if row["kept"] == kept]
        seconds, writing, busy = (median(row[key] for row in own) for key in ("seconds", "writing", "processor"))
        over = median(row["seconds"] / base[row["round"]] - 1.0 for row in own)
        counts = f"{own[-1]['parts']:6d} {writing:10.2f} {busy:7.2f} {own[-1]['megabytes']:6.1f}"
        print(f"{kept:20s} {seconds:8.2f} {over:+13.1%} {counts}")
    if given.json:
        given.json.write_text(json.dumps({**machine(), "steps": steps, "rows": rows}, indent=1) + "\n")


if __name__ == "__main__":
    main()
