"""What a sweep costs against its runs: `python bench/sweep_rows.py [--json FILE] [--rows N] [--rounds N] [--table N]`.

*processes*: the pendulum that comes with the package, N rows of 15,000 steps each, on one process and on two, in turn;
wall time of a sweep, what processes are forked from being there already, and whether the bits are the same. On a
machine that others use wall times say little; CPU seconds, of one process against the mean of two, say more.
*overhead*: what a row takes beyond its run, in this process (parameters, scene, outputs, its file, progress), and the
set-up of row 2 to N. *table*: a table of many rows of 4 numbers and 2 histories of 101 steps, made without runs: its
size, what it takes to write, to open, and to read a number and a history of every row.
"""

from __future__ import annotations

import argparse
import importlib
import json
import os
import shutil
import tempfile
import time
from pathlib import Path
from typing import Any

import numpy as np

import warpffrf as wf
from warpffrf.study.machine import machine
from warpffrf.study.sweeps.folder import Folder
from warpffrf.study.sweeps.job import Answer, Value
from warpffrf.study.sweeps.table import Table

ROWS, ROUNDS, TABLE = 64, 3, 10_000
STEPS, HISTORIES, NUMBERS = 101, 2, 4  # of a row of the table
LONG = ("simulate.duration=15.0", "simulate.save_every=150")
PENDULUM = Path(wf.__file__).parent / "examples" / "pendulum" / "pendulum.toml"
CLOCK, PROCESS = "cpu", "process"  # CPU seconds of the process after a row, and its number
OUTPUTS: dict[str, Any] = {
    "lowest": "min(body_position_z[bob])",
    "height": "body_position_z[bob]",
    "swing": "range(body_position_x[bob])",
}
CLOCKS: dict[str, Any] = {CLOCK: lambda result: time.process_time(), PROCESS: lambda result: os.getpid()}


def swept(folder: Path, rows: int, workers: int) -> tuple[Any, float]:
    """A sweep of `rows` rows, and its wall seconds."""
    begin = time.perf_counter()
    found = wf.study.sweep(
        PENDULUM,
        {"arm": f"0.3:0.6:{rows}"},
        settings=LONG,
        outputs={**OUTPUTS, **CLOCKS},
        store=folder,
        workers=workers,
        overwrite=True,
        progress=False,
    )
    return found, time.perf_counter() - begin


def cpu_seconds(found: Any) -> float:
    """CPU seconds of a process in a sweep: of one those of all rows, of two the mean, with what they need to begin."""
    clock, process = found[CLOCK], found[PROCESS]
    if len(set(process)) == 1:
        return float(np.ptp(clock)) * len(clock) / (len(clock) - 1)  # from the end of the first row on
    return float(np.mean([clock[process == one].max() for one in set(process)]))


def processes(folder: Path, rows: int, rounds: int) -> dict[str, Any]:
    """One process against two, in turn."""
    walls: dict[int, list[float]] = {1: [], 2: []}
    shares: dict[int, list[float]] = {1: [], 2: []}
    bits: set[bytes] = set()
    for workers in walls:  # what begins once
        swept(folder / f"{workers}", 2 * workers, workers)
    for _ in range(rounds):
        for workers, times in walls.items():
            found, wall = swept(folder / f"{workers}", rows, workers)
            times.append(wall)
            shares[workers].append(cpu_seconds(found))
            bits.add(b"".join(found[name].tobytes() for name in OUTPUTS))
    ratios = [one / two for one, two in zip(walls[1], walls[2], strict=True)]
    both = {"walls_1": walls[1], "walls_2": walls[2], "ratio": float(np.median(ratios)), "same_bits": len(bits) == 1}
    return {**both, "cpu_ratio": float(np.median(shares[1]) / np.median(shares[2]))}


def overhead(folder: Path, rows: int) -> dict[str, float]:
    """Seconds of a row beyond its run, of its set-up, and of its file."""
    few, wall_of_few = swept(folder, 2, 1)
    once = wall_of_few - float(few["wall_seconds"].sum())
    found, wall = swept(folder, rows, 1)
    begin, work = time.perf_counter(), Folder(folder)
    for n in range(rows):
        work.keep(Answer(n, "completed", values={"height": Value(np.zeros(STEPS), ("time",))}, time=np.zeros(STEPS)))
    kept = time.perf_counter() - begin
    return {
        "seconds_once": once,
        "seconds_beyond_a_run": (wall - float(found["wall_seconds"].sum()) - once) / (rows - 2),
        "set_up_seconds": float(np.median(found["set_up_seconds"][1:])),
        "largest_set_up_seconds": float(found["set_up_seconds"][1:].max()),
        "seconds_to_keep": kept / rows,
    }


def table(folder: Path, rows: int) -> dict[str, float]:
    """A table of many rows: bytes, and seconds to write, to open and to read of it."""
    random = np.random.default_rng(0)
    times = np.linspace(0.0, 1.0, STEPS)
    made = Table.empty(["x", "y"], [{"x": float(n), "y": n % 7} for n in range(rows)])
    for n in range(rows):
        values = {f"number_{k}": Value(random.random(()), (), "N") for k in range(NUMBERS)}
        values |= {f"history_{k}": Value(random.random(STEPS), ("time",), "m") for k in range(HISTORIES)}
        made.add(Answer(n, "completed", "", values, times, {}, 0.1, 0.1, "cpu", "host", "warpffrf 0.1.0, warp 1.19.0"))
    folder.mkdir()
    about = {"kind": "warpffrf sweep", "count": rows, "parameters": {"x": "", "y": ""}, "outputs": {}, "title": "table"}
    (folder / "sweep.json").write_text(json.dumps(about))
    found: dict[str, float] = {}

    def timed(what: str, call: Any) -> Any:
        begin = time.perf_counter()
        value = call()
        found[f"seconds_to_{what}"] = time.perf_counter() - begin
        return value

    file = Folder(folder).table
    timed("write", lambda: made.write(file))
    opened = timed("open", lambda: wf.study.open_sweep(folder))
    for module in ("h5netcdf", "xarray"):  # seconds, once a process
        importlib.import_module(module)
    data = timed("open_in_xarray", opened.to_xarray)
    timed("read_a_number", lambda: data["number_0"].values)
    timed("read_a_history", lambda: data["history_1"].values)
    data.close()
    timed("read_a_number_alone", lambda: opened["number_1"])
    return {"rows": rows, "bytes": file.stat().st_size, **found}


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--json", type=Path, help="write machine, versions and figures to this file")
    parser.add_argument("--rows", type=int, default=ROWS)
    parser.add_argument("--rounds", type=int, default=ROUNDS)
    parser.add_argument("--table", type=int, default=TABLE)
    given = parser.parse_args()
    load = os.getloadavg()[0] if hasattr(os, "getloadavg") else float("nan")
    about: dict[str, Any] = {**machine(), "load_before": load}
    folder = Path(tempfile.mkdtemp())
    try:
        about["processes"] = both = processes(folder, given.rows, given.rounds)
        about["overhead"] = over = overhead(folder / "over", given.rows)
        about["table"] = kept = table(folder / "table", given.table)
    finally:
        shutil.rmtree(folder)
    print(f"load average {load:.1f} before")
    walls = ", ".join(f"{a:.1f} and {b:.1f}" for a, b in zip(both["walls_1"], both["walls_2"], strict=True))
    print(f"{given.rows} rows on one process and on two: {walls} s; {both['ratio']:.2f} times", end="")
    print(f", {both['cpu_ratio']:.2f} by CPU seconds", end="")
    print(f", bits {'the same' if both['same_bits'] else 'DIFFER'}")
    beyond, file = over["seconds_beyond_a_run"], over["seconds_to_keep"]
    print(f"a sweep beyond its rows {over['seconds_once']:.2f} s, a row beyond its run {beyond * 1e3:.2f} ms", end="")
    print(f", its file {file * 1e3:.2f} ms")
    print(f"set-up of row 2 on: median {over['set_up_seconds']:.3f} s, largest {over['largest_set_up_seconds']:.3f} s")
    print(f"table of {kept['rows']} rows: {kept['bytes'] / kept['rows']:.0f} bytes a row")
    for name in (name for name in kept if name.startswith("seconds")):
        print(f"  {name.replace('_', ' '):28s}{kept[name]:8.3f}")
    if given.json:
        given.json.write_text(json.dumps(about, indent=1) + "\n")


if __name__ == "__main__":
    main()
