"""Runs of benchmarks compared with stored ones: what is the same, what is flagged, what only one of them has."""

from __future__ import annotations

import copy
import json
import subprocess
import sys
from pathlib import Path

import pytest

from studies.speed.stored_runs import compare, lines, machine_id, measured, read, store
from warpffrf.study.machine import processor

MACHINE = {"processor": "Maker(R) Chip-7 @ 3.0 GHz", "cores": 2}
RUN = {
    "machine": MACHINE,
    "versions": {"numpy": "2.4"},
    "unit_seconds": 4e-5,
    "rows": [
        {"scene": "chain", "bodies": 5, "seconds_per_step": 8e-5, "iterations": 2.0, "status": "completed"},
        {"scene": "chain", "bodies": 20, "seconds_per_step": 2e-4, "iterations": 2.1, "status": "completed"},
    ],
    "solvers": [{"name": "superlu", "factor_seconds": 2.0, "peak_bytes": 2.0e9, "unit_seconds": 5e-5}],
}


def test_quantities_are_in_units_of_their_own_run() -> None:
    found = measured(RUN)
    assert found["scene chain, bodies 5", "seconds_per_step"] == pytest.approx(2.0)
    assert found["scene chain, bodies 20", "seconds_per_step"] == pytest.approx(5.0)
    assert found["solvers, name superlu", "factor_seconds"] == pytest.approx(2.0 / 5e-5)
    assert found["solvers, name superlu", "peak_bytes"] == 2.0e9
    assert len(found) == 4


def test_rows_that_say_the_same_are_numbered() -> None:
    row = {"scene": "chain", "seconds_per_step": 1e-4}
    found = measured({"unit_seconds": 1e-4, "rows": [row, {**row, "seconds_per_step": 2e-4}]})
    assert found == {("scene chain", "seconds_per_step"): 1.0, ("scene chain #2", "seconds_per_step"): 2.0}


def test_a_slower_machine_is_no_slower_program() -> None:
    slow = copy.deepcopy(RUN)
    slow["unit_seconds"] *= 2.0
    for row in slow["rows"] + slow["solvers"]:
        for name in ("seconds_per_step", "factor_seconds", "unit_seconds"):
            if name in row:
                row[name] *= 2.0
    found = compare({"s": slow}, {"s": RUN})
    assert [one.ratio for one in found.compared] == pytest.approx([1.0] * 4) and not found.flagged


def test_what_is_slower_or_larger_is_flagged() -> None:
    now = copy.deepcopy(RUN)
    now["rows"][1]["seconds_per_step"] *= 1.3
    now["solvers"][0]["peak_bytes"] *= 1.2
    found = compare({"s": now}, {"s": RUN}, slower=0.25, larger=0.1)
    assert [(one.quantity, round(one.ratio, 3)) for one in found.flagged] == [
        ("seconds_per_step", 1.3), ("peak_bytes", 1.2),
    ]  # fmt: skip
    assert not compare({"s": now}, {"s": RUN}, slower=0.35, larger=0.25).flagged
    assert sum("more than" in line for line in lines(found)) == 2


def test_what_only_one_run_has_is_said() -> None:
    now = copy.deepcopy(RUN)
    now["rows"][0]["bodies"] = 7
    found = compare({"s": now, "t": RUN}, {"s": RUN})
    assert found.new == ["s: scene chain, bodies 7 (seconds_per_step)", "t"]
    assert found.gone == ["s: scene chain, bodies 5 (seconds_per_step)"]
    assert len(found.compared) == 3


def test_a_machine_is_its_processor_and_cores() -> None:
    assert machine_id(MACHINE) == "maker-r-chip-7-3-0-ghz-2-cores"
    assert machine_id({"processor": "", "cores": None}) == "unknown-processor-unknown-cores"
    assert processor()


def test_runs_are_stored_and_read(tmp_path: Path) -> None:
    own = store({"a": RUN, "b": RUN}, tmp_path)
    assert own.name == machine_id(MACHINE)
    assert read(own) == {"a": RUN, "b": RUN}
    other = {**RUN, "machine": {**MACHINE, "cores": 4}}
    with pytest.raises(ValueError, match="2 machines"):
        store({"a": RUN, "b": other}, tmp_path)
    (own / "c.json").write_text("[1]")
    with pytest.raises(ValueError, match=r"c\.json: no run"):
        read(own)


def test_the_script_compares_and_stores(tmp_path: Path) -> None:
    script = Path(__file__).resolve().parents[2] / "bench" / "compare_runs.py"
    run, stored = tmp_path / "run", tmp_path / "stored"

    def called(*more: str) -> subprocess.CompletedProcess[str]:
        command = [sys.executable, str(script), "--run", str(run), "--stored", str(stored), *more]
        return subprocess.run(command, capture_output=True, text=True, check=False)

    assert "no JSON files" in called().stderr
    run.mkdir()
    (run / "a.json").write_text(json.dumps(RUN))
    first = called()
    assert first.returncode == 0 and "no stored run" in first.stdout
    assert called("--store").returncode == 0
    assert called().returncode == 0
    slow = copy.deepcopy(RUN)
    slow["rows"][0]["seconds_per_step"] *= 2.0
    (run / "a.json").write_text(json.dumps(slow))
    again = called()
    assert again.returncode == 1 and "more than 25%" in again.stdout
