"""Runs that are stopped, by whatever, lose no more than the last interval, and go on bit for bit."""

from __future__ import annotations

import copy
import functools
import os
import signal
import socket
import subprocess
import sys
import threading
import time
from collections.abc import Iterator
from pathlib import Path
from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest
import unfinished_runs
from unfinished_runs import FEW, KEEP_EVERY, STEP, pendulum

import warpffrf as wf
from scenes.rollers import guided_pair, roller_body
from warpffrf.model.errors import InputError
from warpffrf.model.files.paths import lives
from warpffrf.model.messages import progress
from warpffrf.model.messages.checkpoints import Plan, Unfinished
from warpffrf.online.history.history import History
from warpffrf.online.periodic_checkpoint import Keeping
from warpffrf.output import outputs
from warpffrf.output.files import unfinished

PROGRAM = Path(__file__).parents[1] / "unfinished_runs.py"
BEFORE_LONG = 100.0  # s, before a program has started and said something
TIMES = ("build_seconds", "seconds_in_graph", "loop_seconds", "finish_seconds")  # counters of the clock


def same(a: Any, b: Any, path: str = "") -> list[str]:
    """Where two histories, or parts of them, differ by a bit."""
    if isinstance(a, np.ndarray):
        return [] if a.dtype == b.dtype and a.tobytes() == b.tobytes() else [path]
    if isinstance(a, dict):
        return [x for key in {**a, **b} for x in same(a[key], b[key], f"{path}/{key}")]
    if hasattr(a, "__dataclass_fields__"):
        names = [name for name in vars(a) if name not in ("scene", "counters", "options", "samples", "budget")]
        return [x for name in names for x in same(getattr(a, name), getattr(b, name), f"{path}/{name}")]
    return [] if a == b else [path]


def counters(history: History) -> dict[str, float]:
    return {name: value for name, value in history.counters.items() if name not in TIMES}


simulate = functools.partial(unfinished_runs.simulate, steps=FEW)


@pytest.fixture(autouse=True)
def kept_often(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(outputs, "KEEP_EVERY", KEEP_EVERY)


@functools.cache
def unstopped(case: str) -> wf.Result:
    """The run of `case` that nobody stops."""
    return simulate(case, None)


class Program:
    """A run in a process of its own, under way: it has kept its first part."""

    def __init__(self, server: subprocess.Popen[str], case: str, results: Path) -> None:
        pipe = results.parent.with_name(f"{results.parent.name}.pipe")
        os.mkfifo(pipe)
        assert server.stdin is not None and server.stdout is not None
        server.stdin.write(f"{case} {results} {pipe}\n")
        server.stdin.flush()
        self.pid = int(server.stdout.readline())
        self.stdout = pipe.open()
        for said in ("ready\n", "going\n"):
            assert self.stdout.readline() == said

    def send_signal(self, number: int) -> None:
        os.kill(self.pid, number)

    def ended(self) -> str:
        """What it has said since, when it is no more."""
        with self.stdout:
            said = self.stdout.read()
        until = time.monotonic() + BEFORE_LONG
        while lives(self.pid):
            assert time.monotonic() < until
            time.sleep(0.01)
        return said


@pytest.fixture(scope="module")
def server() -> Iterator[subprocess.Popen[str]]:
    command = [sys.executable, str(PROGRAM), "serve"]
    with subprocess.Popen(command, stdin=subprocess.PIPE, stdout=subprocess.PIPE, text=True) as process:
        assert process.stdout is not None and process.stdout.readline() == "ready\n"
        yield process


def stopped(server: subprocess.Popen[str], case: str, results: Path, number: int) -> str:
    """What the program says last when it is sent a signal."""
    program = Program(server, case, results)
    program.send_signal(number)
    said = program.ended()
    return said.split("\n")[-2] if "\n" in said else ""


@pytest.mark.parametrize("case", ["plain", "sparse", "adaptive", "stages", "static", "runge-kutta", "energy-momentum"])
def test_a_killed_run_goes_on_bit_for_bit(server: subprocess.Popen[str], case: str, tmp_path: Path) -> None:
    file = tmp_path / "run.h5"
    assert "status" not in stopped(server, case, file, signal.SIGKILL)
    left = sorted(path.name for path in tmp_path.iterdir())
    assert any(name.endswith(".h5.unfinished") for name in left) and "run.h5" not in left
    found, whole = simulate(case, file, resume=True), unstopped(case)
    assert same(whole.history, found.history) == [] and counters(whole.history) == counters(found.history)
    assert same(whole.history, wf.Result.load(file).history) == []
    files = ["run.fall.h5", "run.h5", "run.swing.h5"] if case == "stages" else ["run.h5"]
    assert sorted(path.name for path in tmp_path.iterdir()) == files


@pytest.mark.parametrize("number", [signal.SIGTERM, signal.SIGINT], ids=["SIGTERM", "Ctrl-C"])
def test_an_interrupted_run_is_written_and_goes_on(server: subprocess.Popen[str], number: int, tmp_path: Path) -> None:
    file = tmp_path / "run.h5"
    assert stopped(server, "plain", file, number) == "status interrupted 0"
    part, whole = wf.Result.load(file), unstopped("plain")
    assert 0 < len(part.time) < len(whole.time) and np.array_equal(part.time, whole.time[: len(part.time)])
    assert same(whole.history, simulate("plain", file, resume=True).history) == []
    assert [path.name for path in tmp_path.iterdir()] == ["run.h5"]


@pytest.mark.parametrize("number", [signal.SIGTERM, signal.SIGINT], ids=["SIGTERM", "Ctrl-C"])
def test_a_script_hears_what_a_signal_ends(
    number: signal.Signals, tmp_path: Path, monkeypatch: pytest.MonkeyPatch, caplog: pytest.LogCaptureFixture
) -> None:
    """A run that was ended is a result, and is written. After Ctrl-C a script runs more; SIGTERM ends it where it would
    begin the next run."""
    monkeypatch.setattr(progress, "_process", progress.Asked())
    before = signal.signal(signal.SIGINT, signal.default_int_handler)
    file, look = tmp_path / "run.h5", Keeping.look
    try:
        with monkeypatch.context() as signalled:
            signalled.setattr(Keeping, "look", lambda self: (look(self), signal.raise_signal(number)))
            part = simulate("plain", file)
        assert part.status == "interrupted" and wf.Result.load(file).status == "interrupted"
        assert "a script goes on after it" in caplog.text
        if number == signal.SIGINT:
            assert "SIGTERM" not in caplog.text and simulate("plain", None, steps=100).status == "completed"
        else:
            assert "ends where it would begin another run (SIGTERM)" in caplog.text
            with pytest.raises(SystemExit) as ended:
                simulate("plain", None, steps=100)
            assert ended.value.code == 143 and "before the next run" in caplog.text
    finally:
        signal.signal(signal.SIGINT, before)


def test_an_unfinished_run_can_be_looked_at_and_continued(server: subprocess.Popen[str], tmp_path: Path) -> None:
    file, folder = tmp_path / "run.h5", tmp_path / "run.h5.unfinished"
    stopped(server, "plain", file, signal.SIGKILL)
    with pytest.raises(InputError, match=r"run.h5' does not exist; '.*run.h5.unfinished' holds what"):
        wf.Result.load(file)
    part, whole = wf.Result.load(folder), unstopped("plain")
    assert part.status == "unfinished" and "resume=True" in part.message
    n = len(part.time)
    assert n > 0 and np.array_equal(part.body("arm").position, whole.body("arm").position[:n])
    rest = FEW * STEP - float(part.history.checkpoint["clk"]["time"][0])
    end = wf.simulate(pendulum(), rest, step=STEP, start=folder, progress=False).history
    assert same(whole.history.checkpoint, end.checkpoint) in ([], ["/ctl"])  # rows are counted from the start of each


def first_rows(value: Any, rows: int) -> Any:
    """The first saved rows of a history, or of a part of it."""
    if isinstance(value, np.ndarray):
        return value[:rows]
    if isinstance(value, dict):
        return {name: first_rows(member, rows) for name, member in value.items()}
    if hasattr(value, "__dataclass_fields__"):
        found = copy.copy(value)
        vars(found).update({name: first_rows(member, rows) for name, member in vars(value).items()})
        return found
    return value


def kept(folder: Path, scene: wf.Scene, steps: int, step: float, **options: Any) -> tuple[wf.Result, wf.Result]:
    """A run of some parts that is interrupted after half its steps, as its folder has it; and the whole run."""
    whole = wf.simulate(scene, steps * step, step=step, progress=False, **options)
    looked = 0

    def due(self: unfinished.UnfinishedRun) -> bool:
        nonlocal looked
        looked += 1
        if looked == 6:
            raise KeyboardInterrupt
        return True

    with pytest.MonkeyPatch.context() as context:
        context.setattr(unfinished.UnfinishedRun, "due", due)
        part = wf.simulate(scene, steps * step, step=step, progress=False, results=folder / "run.h5", **options)
    assert part.status == "interrupted"
    return wf.Result.load(folder / "run.h5.unfinished"), whole


def test_a_run_with_contact_reads_as_far_as_it_went(tmp_path: Path) -> None:
    """Pressures, friction, joints and energy are made of the rows and of the scene that the folder holds."""
    body = roller_body(120, layers=4, axial=2, grading=1.6, modes=2, tangential=True)
    scene = guided_pair(body, body, load=20e3, speed=1.0, friction=0.2)
    options: dict[str, Any] = {"start": "equilibrium"}
    found, whole = kept(tmp_path, scene, 100, STEP, **options)
    rows = len(found.time)
    assert 0 < rows < len(whole.time) and found.view.content_hash == scene.content_hash()
    for name in ("time", "energy", "bodies", "joints", "contacts", "forces", "sensors", "step_size", "iterations"):
        assert same(first_rows(getattr(whole.history, name), rows), getattr(found.history, name), name) == []
    again = wf.simulate(
        scene, 100 * STEP, step=STEP, progress=False, resume=True, results=tmp_path / "run.h5", **options
    )  # fmt: skip
    assert same(whole.history, again.history) == []


def test_damage_in_the_folder_is_named(server: subprocess.Popen[str], tmp_path: Path) -> None:
    file, folder = tmp_path / "run.h5", tmp_path / "run.h5.unfinished"
    stopped(server, "plain", file, signal.SIGKILL)
    for name in ("checkpoint.arrays", "part-000001.arrays", "scene.arrays"):
        whole = (folder / name).read_bytes()
        for data in (whole[: len(whole) // 2], whole[:-200] + b"?" + whole[-199:], b""):
            (folder / name).write_bytes(data)
            with pytest.raises(
                InputError, match=rf"unfinished run '.*': {name} is damaged .*; begin the run anew with"
            ):
                wf.Result.load(folder)
            if name != "scene.arrays":
                with pytest.raises(InputError, match=rf"unfinished run '.*': {name} is damaged .*; begin the run anew"):
                    simulate("plain", file, resume=True)
        (folder / name).write_bytes(whole)
    (folder / "part-000001.arrays").rename(folder / "elsewhere")
    with pytest.raises(InputError, match=r"part-000001.arrays is missing; begin the run anew"):
        wf.Result.load(folder)
    (folder / "elsewhere").rename(folder / "part-000001.arrays")
    assert same(unstopped("plain").history, simulate("plain", file, resume=True).history) == []


def test_a_scene_that_no_file_can_hold_can_be_gone_on_with(tmp_path: Path) -> None:
    scene = pendulum()
    scene.bodies[0].__dict__["told_by"] = lambda: "a program around it"
    with pytest.raises(
        InputError, match=r"cannot be converted to a scene \(it holds a builtins.function\); go on with the"
    ):
        kept(tmp_path, scene, 3000, STEP)
    options = {"step": STEP, "progress": False}
    found = wf.simulate(scene, 3000 * STEP, results=tmp_path / "run.h5", resume=True, **options)
    assert same(wf.simulate(scene, 3000 * STEP, **options).history, found.history) == []


def test_a_table_that_ends_with_the_run_serves_what_is_left_of_it(tmp_path: Path) -> None:
    scene, end = pendulum(), 3000 * STEP
    push = wf.signals.Table([0.0, end], [0.0, 1.0])
    scene.add(wf.forces.PointForce(scene.bodies[0].at((0.5, 0, 0)), (0.0, 0.0, push), name="push"))
    _, whole = kept(tmp_path, scene, 3000, STEP)
    found = wf.simulate(scene, end, step=STEP, progress=False, results=tmp_path / "run.h5", resume=True)
    assert same(whole.history, found.history) == []


def test_what_is_unfinished_is_not_lost_by_mistake(server: subprocess.Popen[str], tmp_path: Path) -> None:
    file = tmp_path / "run.h5"
    stopped(server, "plain", file, signal.SIGKILL)
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
    with pytest.raises(InputError, match="resume continues from the files of a run; give results"):
        simulate("sparse", None, resume=True)


def test_two_runs_into_one_file_are_distinguished(server: subprocess.Popen[str], tmp_path: Path) -> None:
    file = tmp_path / "run.h5"
    program = Program(server, "plain", file)
    try:
        program.send_signal(signal.SIGSTOP)
        with pytest.raises(InputError, match=rf"another run is writing '.*run.h5' \(process {program.pid} on "):
            simulate("plain", file, overwrite=True)
    finally:
        program.send_signal(signal.SIGCONT)
        program.ended()
    assert wf.Result.load(file).status == "completed"


def test_what_a_killed_writer_left_does_not_keep_the_folder(tmp_path: Path) -> None:
    """A file that was being written belongs to a process that is no more, and no part of it follows."""
    dead = subprocess.Popen([sys.executable, "-c", ""])
    dead.wait()
    folder = tmp_path / "run.h5.unfinished"
    folder.mkdir()
    host = socket.gethostname().replace(".", "-")
    (folder / f".part-000007.arrays.{host}.{dead.pid}.0123abcd.part").write_bytes(b"cut")
    (folder / "scene.arrays").write_bytes(b"of another run")
    assert simulate("plain", tmp_path / "run.h5", resume=True).status == "completed"
    assert [path.name for path in tmp_path.iterdir()] == ["run.h5"]


def test_a_process_without_threads_writes_by_itself(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    class NoThread(threading.Thread):
        def start(self) -> None:
            raise RuntimeError("can't start new thread")

    monkeypatch.setattr(unfinished, "threading", SimpleNamespace(Thread=NoThread))
    found, _ = kept(tmp_path, pendulum(), 3000, STEP)
    assert len(found.time) > 0


def test_a_full_disk_loses_no_result(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """Full while it runs, then at its end."""
    file = tmp_path / "run.h5"

    def full(*given: Any, **more: Any) -> None:
        raise OSError(28, "No space left on device")

    with monkeypatch.context() as context:
        context.setattr(unfinished, "write_arrays", full)
        found = simulate("sparse", file)
    assert found.status == "completed" and wf.Result.load(file).status == "completed"
    assert any("could not be saved during the run" in note for note in found.history.notes)
    with monkeypatch.context() as context:
        context.setattr("warpffrf.output.files.results.put_result", full)
        found = simulate("sparse", file, overwrite=True)
    (trouble,) = found.unwritten
    assert found.status == "completed" and "No space left on device" in trouble and trouble in found.report()
    assert same(found.history, simulate("sparse", file, resume=True).history) in ([], ["/notes"])


def test_what_goes_wrong_after_a_run_loses_no_result(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    for error, said in ((RuntimeError("File-writer thread"), "File-writer"), (KeyboardInterrupt(), "interrupted")):

        def failing(*_: Any, error: BaseException = error) -> Path:
            raise error

        monkeypatch.setattr(outputs, "_record", failing)
        found = simulate("sparse", None, record=tmp_path / "run.rrd")
        assert found.status == "completed" and said in found.unwritten[0]


def test_parts_are_kept_no_more_often_than_they_may_cost(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    clock = iter([0.0, 5.0, 7.0, 7.0, 8.0])
    monkeypatch.setattr(unfinished, "time", SimpleNamespace(monotonic=lambda: next(clock)))
    run = unfinished.UnfinishedRun(tmp_path / "run.h5", {}, KEEP_EVERY)
    monkeypatch.setattr(unfinished, "write_arrays", lambda *given: None)
    run.keep(Unfinished([{"saved_time": np.zeros(3)}], {}, Plan(0, 0, ())))
    run.settle()
    assert run.wait == 2.0 / unfinished.SHARE and not run.due()
