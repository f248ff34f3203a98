"""Runs by the integrators for checks that are stopped go on bit for bit, and can be looked at meanwhile."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import pytest
from test_unfinished import first_rows, kept, same
from unfinished_runs import CHECKS, STEP, top

import warpffrf as wf
from warpffrf.output.simulate import simulate

ARRAYS = ("time", "energy", "bodies", "joints", "contacts", "forces", "sensors", "step_size", "iterations")


def check(scene: Any, folder: Path, steps: int, step: float, **options: Any) -> None:
    """Interrupted, looked at, and gone on with."""
    found, whole = kept(folder, scene, steps, step, **options)
    rows = len(found.time)
    assert 0 < rows < len(whole.time) and found.status == "unfinished"
    for name in ARRAYS:
        assert same(first_rows(getattr(whole.history, name), rows), getattr(found.history, name), name) == []
    results = folder / "run.h5"
    again = simulate(scene, steps * step, step=step, progress=False, results=results, resume=True, **options)
    assert same(whole.history, again.history) == []
    assert again.history.counters["steps"] == whole.history.counters["steps"]
    assert again.history.counters["mean_iterations"] == whole.history.counters["mean_iterations"]
    assert [path.name for path in folder.iterdir()] == ["run.h5"]


@pytest.mark.parametrize("name", CHECKS)
def test_a_check_goes_on_bit_for_bit(name: str, tmp_path: Path) -> None:
    check(top(), tmp_path, 40, STEP, options=wf.RunOptions(integrator=CHECKS[name], save_every=3))
