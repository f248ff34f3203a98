"""Runs that are stopped, by whatever, lose no more than the last interval, and go on bit for bit."""

from __future__ import annotations

import signal
import subprocess
import sys
from pathlib import Path
from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest
from unfinished_runs import OPTIONS, STEP, STEPS, pendulum, simulate

import warpffrf as wf
from warpffrf.model.errors import InputError
from warpffrf.online.history.history import History
from warpffrf.output import outputs
from warpffrf.output.files import unfinished

PROGRAM = Path(__file__).with_name("unfinished_runs.py")
BEFORE_LONG = 100.0  # s, before a program has started and said something
TIMES = ("build_seconds", "seconds_in_graph", "loop_seconds", "finish_seconds")  # counters of the clock


def same(a: Any, b: Any, path: str = "") -> list[str]:
    """Where two histories, or parts of them, differ by a bit."""
    if isinstance(a, np.ndarray):
        return [] if a.dtype == b.dtype and a.tobytes() == b.tobytes() else [path]
    if isinstance(a, dict):
        return [x for key in {**a, **b} for x in same(a[key], b[key], f"{path}/{key}")]
    if hasattr(a, "__dataclass_fields__"):
        names = [name for name in vars(a) if name not in ("scene", "counters", "options", "marks", "budget")]
        return [x for name in names for x in same(getattr(a, name), getattr(b, name), f"{path}/{name}")]
    return [] if a == b else [path]


def counters(history: History) -> dict[str, float]:
    return {name: value for name, value in history.counters.items() if name not in TIMES}


def started(case: str, results: Path) -> subprocess.Popen[str]:
    """The program under way: it has kept its first part."""
    program = subprocess.Popen([sys.executable, str(PROGRAM), case, str(results)], stdout=subprocess.PIPE, text=True)
    assert program.stdout is not None
    for said in ("ready\n", "going\n"):
        assert program.stdout.readline() == said
    return program


def stopped(case: str, results: Path, number: int) -> str:
    """What the program says last when it is sent a signal."""
    program = started(case, results)
    program.send_signal(number)
    said, _ = program.communicate(timeout=BEFORE_LONG)
    return said.split("\n")[-2] if "\n" in said else ""


@pytest.mark.parametrize("case", ["plain", "sparse", "adaptive", "stages"])
def test_a_killed_run_goes_on_bit_for_bit(case: str, tmp_path: Path) -> None:
    file = tmp_path / "run.h5"
    assert "status" not in stopped(case, file, signal.SIGKILL)
    left = sorted(path.name for path in tmp_path.iterdir())
    assert any(name.endswith(".h5.unfinished") for name in left) and "run.h5" not in left
    found, whole = simulate(case, file, resume=True), simulate(case, None)
    assert same(whole.history, found.history) == [] and counters(whole.history) == counters(found.history)
    assert same(whole.history, wf.Result.load(file).history) == []
    files = ["run.fall.h5", "run.h5", "run.swing.h5"] if case == "stages" else ["run.h5"]
    assert sorted(path.name for path in tmp_path.iterdir()) == files


@pytest.mark.parametrize("number", [signal.SIGTERM, signal.SIGINT], ids=["SIGTERM", "Ctrl-C"])
def test_an_interrupted_run_is_written_and_goes_on(number: int, tmp_path: Path) -> None:
    file = tmp_path / "run.h5"
    assert stopped("plain", file, number) == "status interrupted 0"
    part, whole = wf.Result.load(file), simulate("plain", None)
    assert 0 < len(part.time) < len(whole.time) and np.array_equal(part.time, whole.time[: len(part.time)])
    assert same(whole.history, simulate("plain", file, resume=True).history) == []
    assert [path.name for path in tmp_path.iterdir()] == ["run.h5"]


def test_an_unfinished_run_can_be_looked_at_and_continued(tmp_path: Path) -> None:
    file, folder = tmp_path / "run.h5", tmp_path / "run.h5.unfinished"
    stopped("plain", file, signal.SIGKILL)
    with pytest.raises(InputError, match=r"run.h5' does not exist; '.*run.h5.unfinished' holds what"):
        wf.Result.load(file)
    part, whole = wf.Result.load(folder), simulate("plain", None)
    assert part.status == "unfinished" and "resume=True" in part.message
    n = len(part.time)
    assert n > 0 and np.array_equal(part.body("arm").position, whole.body("arm").position[:n])
    rest = STEPS * STEP - float(part.history.checkpoint["clk"]["time"][0])
    end = wf.simulate(pendulum(), rest, step=STEP, start=folder, progress=False).history
    assert same(whole.history.checkpoint, end.checkpoint) in ([], ["/ctl"])  # rows are counted from the start of each


def test_what_is_unfinished_is_not_lost_by_mistake(tmp_path: Path) -> None:
    file = tmp_path / "run.h5"
    stopped("plain", file, signal.SIGKILL)
    with pytest.raises(InputError, match="holds a run that has not ended; go on with resume=True"):
        simulate("plain", file)
    with pytest.raises(InputError, match=r"is of another run \(save_every was 1, is 7\)"):
        simulate("sparse", file, resume=True)
    assert simulate("sparse", file, overwrite=True).status == "completed"
    assert [path.name for path in tmp_path.iterdir()] == ["run.h5"]
    with pytest.raises(InputError, match="run.h5' exists"):
        simulate("sparse", file)
    with pytest.raises(InputError, match=r"is of another run \(save_every was 7, is 1\)"):
        simulate("plain", file, resume=True)


def test_a_finished_run_is_read(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    first = simulate("sparse", tmp_path / "run.h5", resume=True)
    monkeypatch.setattr("warpffrf.output.simulate.run", None)
    assert same(first.history, simulate("sparse", tmp_path / "run.h5", resume=True).history) == []
    with pytest.raises(InputError, match="resume goes on from what stands beside the results; give results"):
        simulate("sparse", None, resume=True)


def test_two_runs_into_one_file_are_told_apart(tmp_path: Path) -> None:
    file = tmp_path / "run.h5"
    program = started("plain", file)
    try:
        program.send_signal(signal.SIGSTOP)
        with pytest.raises(InputError, match=rf"another run is writing '.*run.h5' \(process {program.pid} on "):
            simulate("plain", file, overwrite=True)
    finally:
        program.send_signal(signal.SIGCONT)
        program.communicate(timeout=BEFORE_LONG)
    assert wf.Result.load(file).status == "completed"


def test_a_full_disk_loses_no_result(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """Full while it runs, then at its end."""
    file = tmp_path / "run.h5"

    def full(*given: Any, **more: Any) -> None:
        raise OSError(28, "No space left on device")

    with monkeypatch.context() as context:
        context.setattr(unfinished, "put_result", full)
        found = simulate("sparse", file)
    assert found.status == "completed" and wf.Result.load(file).status == "completed"
    assert any("could not be kept during the run" in note for note in found.history.notes)
    with monkeypatch.context() as context:
        context.setattr("warpffrf.output.files.results.put_result", full)
        found = simulate("sparse", file, overwrite=True)
    (trouble,) = found.unwritten
    assert found.status == "completed" and "No space left on device" in trouble and trouble in found.report()
    assert same(found.history, simulate("sparse", file, resume=True).history) in ([], ["/notes"])


def test_what_goes_wrong_after_a_run_loses_no_result(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    for error, said in ((RuntimeError("File-writer thread"), "File-writer"), (KeyboardInterrupt(), "interrupted")):

        def failing(result: wf.Result, path: Path, error: BaseException = error) -> Path:
            raise error

        monkeypatch.setattr(outputs, "_record", failing)
        found = simulate("sparse", None, record=tmp_path / "run.rrd")
        assert found.status == "completed" and said in found.unwritten[0]


def test_parts_are_kept_no_more_often_than_they_may_cost(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    history, clock = simulate("sparse", None).history, iter([0.0, 5.0, 7.0, 8.0])
    monkeypatch.setattr(unfinished, "time", SimpleNamespace(monotonic=lambda: next(clock)))
    run = unfinished.UnfinishedRun(tmp_path / "run.h5", {}, OPTIONS["keep_every"], wf.Result)
    monkeypatch.setattr(run, "_write_part", lambda *given: None)
    monkeypatch.setattr(run, "_write_checkpoint", lambda *given: None)
    run.keep(history, {}, unfinished.Plan(0, 0, ()))
    assert run.wait == 2.0 / unfinished.SHARE and not run.due()
