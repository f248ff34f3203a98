"""What it costs to keep a run on the way: `python bench/keeping.py [--json FILE] [--seconds S] [--save-every N]`.

The two rollers of the demo, on its coarser mesh, long enough to take the given seconds; in turn without results,
with the parts kept as often as `simulate` does by itself, and as often as it may (keep_every next to nothing). Times
are those of the loop over steps, in which parts are written; the share spent is that of writing, at least.
"""

from __future__ import annotations

import argparse
import json
import tempfile
import time
from pathlib import Path
from statistics import median

from warpffrf.demos import two_rollers
from warpffrf.online.arrays.ring import SavedRows
from warpffrf.online.history.history import History
from warpffrf.online.keeping import Plan
from warpffrf.output.files.unfinished import UnfinishedRun
from warpffrf.output.outputs import KEEP_EVERY
from warpffrf.output.simulate import simulate
from warpffrf.study.step_time import machine

EVERY = {"not kept": None, "as it is": KEEP_EVERY, "as often as it may": 1e-3}  # s
NEVER = 1e9  # s
TRIED = 500  # steps, to find how many take the seconds


class Watch:
    """How long `UnfinishedRun.keep` took, and how often."""

    def __init__(self) -> None:
        self.parts, self.seconds, self.bytes = 0, 0.0, 0
        keep, watch = UnfinishedRun.keep, self

        def timed(self: UnfinishedRun, history: History, rows: SavedRows, plan: Plan) -> bool:
            begin = time.monotonic()
            done = keep(self, history, rows, plan)
            watch.seconds += time.monotonic() - begin
            watch.parts += 1
            watch.bytes = sum(file.stat().st_size for file in self.folder.iterdir())
            return done

        UnfinishedRun.keep = timed


def measure(scene, steps: int, every: float | None, folder: Path, watch: Watch, save_every: int) -> dict:
    """Loop seconds of a run, and what was written on the way."""
    watch.parts, watch.seconds, watch.bytes = 0, 0.0, 0
    result = simulate(
        scene, steps * two_rollers.STEP, step=two_rollers.STEP, start="equilibrium", progress=False, overwrite=True,
        save_every=save_every, results=None if every is None else folder / "run.h5", keep_every=every or NEVER,
    )  # fmt: skip
    seconds = result.history.counters["loop_seconds"]
    return {"seconds": seconds, "parts": watch.parts, "writing": watch.seconds, "megabytes": watch.bytes / 1e6}


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
        for _ in range(given.rounds):
            rows += [
                {"kept": kept, **measure(scene, steps, every, folder, watch, given.save_every)}
                for kept, every in EVERY.items()
            ]
    print(f"{steps} steps; medians of {given.rounds} rounds")
    print("kept                  seconds  over not kept  parts  writing s     MB")
    base = median(row["seconds"] for row in rows if row["kept"] == "not kept")
    for kept in EVERY:
        own = [row for row in rows if row["kept"] == kept]
        seconds, writing = (median(row[key] for row in own) for key in ("seconds", "writing"))
        counts = f"{own[-1]['parts']:6d} {writing:10.2f} {own[-1]['megabytes']:6.1f}"
        print(f"{kept:20s} {seconds:8.2f} {seconds / base - 1.0:+13.1%} {counts}")
    if given.json:
        given.json.write_text(json.dumps({**machine(), "steps": steps, "rows": rows}, indent=1) + "\n")


if __name__ == "__main__":
    main()
