"""Workers of a sweep: the same bits whoever runs a row, workers that die, what is reported of those that cannot
work."""

from __future__ import annotations

import pickle
import signal
import subprocess
import sys
import textwrap
import threading
import time
from concurrent.futures import Future, ThreadPoolExecutor
from functools import partial
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from sweep_scenes import IN_TIME, bob, deadly_bob

import warpffrf as wf
from warpffrf.model.errors import InputError
from warpffrf.study.sweeps import executors, job, packing, sweep
from warpffrf.study.sweeps.executors import WorkerDied
from warpffrf.study.sweeps.folder import Folder
from warpffrf.study.sweeps.job import Value
from warpffrf.study.sweeps.payload import Payload
from warpffrf.study.sweeps.scenes import FunctionScenes

STIFFNESS = {"stiffness": "1000:6000:6"}
NAME = "body_position_z[bob]"
FOLDER = Path(__file__).resolve().parent
PAYLOAD = Payload(b"", "", "", {})  # of workers that run nothing


def run(store: Path, parameters: Any = STIFFNESS, scene: Any = bob, **options: Any) -> Any:
    return wf.study.sweep(
        scene, parameters, outputs=[NAME], store=store, run=IN_TIME, progress=False, **options
    )  # fmt: skip


@pytest.fixture(scope="module")
def alone(tmp_path_factory: Any) -> np.ndarray:
    return run(tmp_path_factory.mktemp("alone") / "s")[NAME]


@pytest.mark.slow
def test_two_processes_give_the_same_bits_also_where_one_is_killed(tmp_path: Path, alone: np.ndarray) -> None:
    """A row that takes its worker with it twice, by a kill and by SIGTERM, is run a third time, and the others are not
    touched."""
    scene = partial(deadly_bob, folder=str(tmp_path), times=3)  # the first by the parent would be ours: see below
    (tmp_path / "death 0").touch()
    found = run(tmp_path / "s", scene=scene, workers=2)
    assert sorted(mark.name for mark in tmp_path.glob("death *")) == ["death 0", "death 1", "death 2"]
    assert found.counts == {"completed": 6} and np.array_equal(found[NAME], alone)


@pytest.mark.slow  # three processes more
def test_a_row_that_kills_its_worker_every_time_is_a_row_with_a_message(tmp_path: Path, alone: np.ndarray) -> None:
    found = run(tmp_path / "s", scene=partial(deadly_bob, folder=str(tmp_path), times=9), workers=2)
    assert found.counts == {"completed": 5, "lost": 1}
    (row,) = found.failed()
    assert row["stiffness"] == 2000 and "died 3 times" in row["message"]
    others = [0, 2, 3, 4, 5]
    assert np.array_equal(found[NAME][others], alone[others]) and np.isnan(found[NAME][1]).all()


class Dying:
    """A executor whose workers die at some rows."""

    capacity = 2

    def __init__(self, *rows: int) -> None:
        self.rows, self.packs = rows, []

    def submit(self, rows: Any) -> Any:
        future: Any = Future()
        future.set_result([number for number, _ in rows])
        self.packs.append(future.result())
        return future

    def collect(self, future: Any) -> list[job.Answer]:
        if set(future.result()) & set(self.rows):
            raise WorkerDied
        return [job.Answer(n, "completed", values={"y": Value(np.array(1.0))}) for n in future.result()]

    def close(self) -> None:
        pass


def dispatched(tmp_path: Path, executor: Any, worlds: int) -> dict[str, int]:
    """The statuses of six rows."""
    from warpffrf.study.sweeps.design import design_of

    design, folder = design_of({"x": "1:6:6"}, None), Folder(tmp_path / "s")
    about = {"kind": "warpffrf sweep", "count": 6, "parameters": {"x": ""}, "outputs": {}}
    folder.begin(about, design, overwrite=True, resume=False)
    try:
        sweep._run(executor, list(enumerate(design.rows)), worlds, folder, 6, False)
    finally:
        folder.release()
    return wf.study.open_sweep(tmp_path / "s").counts


def test_rows_of_a_worker_that_died_go_out_again_one_by_one(tmp_path: Path) -> None:
    executor = Dying(4)
    assert dispatched(tmp_path, executor, worlds=3) == {"completed": 5, "lost": 1}
    assert executor.packs[:2] == [[0, 1, 2], [3, 4, 5]] and sorted(executor.packs[2:]) == [[3], [4], [4], [4], [5]]


def test_workers_that_all_die_are_reported_before_all_rows_are_lost(tmp_path: Path) -> None:
    with pytest.raises(InputError, match="workers die before any row has been run"):
        dispatched(tmp_path, Dying(*range(6)), worlds=1)


class Ended:
    """A worker that only says whether it was ended."""

    def __init__(self, *_: Any) -> None:
        self.ended = False

    def end(self) -> None:
        self.ended = True


def test_a_worker_whose_answer_cannot_be_read_is_ended_too() -> None:
    executor, worker, future = executors.Processes(PAYLOAD, []), Ended(), Future()
    executor.busy[future] = worker  # type: ignore[assignment]
    future.set_exception(pickle.UnpicklingError("no answer"))
    with pytest.raises(pickle.UnpicklingError):
        executor.collect(future)
    executor.close()
    assert worker.ended


def test_workers_start_again_where_what_forks_them_was_killed(monkeypatch: Any) -> None:
    """The connection to it is refused once, then another one is there; where none is, those that began are ended."""
    begun: list[Ended] = []
    refused = [2]

    class Begun(Ended):
        def __init__(self, *_: Any) -> None:
            super().__init__()
            if len(begun) == 1 and refused[0]:
                refused[0] -= 1
                raise ConnectionRefusedError
            begun.append(self)

    monkeypatch.setattr(executors, "_Worker", Begun)
    monkeypatch.setattr(executors, "DYING", 0.0)
    with pytest.raises(ConnectionRefusedError):
        executors.Processes(PAYLOAD, [None, None])
    assert [worker.ended for worker in begun] == [True]
    begun.clear()
    refused[0] = 1
    assert executors.Processes(PAYLOAD, [None, None]).free == begun and len(begun) == 2


def test_runs_of_an_executor_that_have_not_begun_are_taken_back_at_the_end(tmp_path: Path, monkeypatch: Any) -> None:
    """Ctrl-C comes as the second row is collected, with the others sent."""
    sent: list[Any] = []

    class Slow:
        def submit(self, call: Any, payload: Any, rows: Any, device: Any) -> Any:
            sent.append(Future())
            if len(sent) <= 2:
                sent[-1].set_result([job.Answer(rows[0][0], "completed", values={NAME: Value(np.array(1.0))})])
            return sent[-1]

    collect = executors.Elsewhere.collect

    def interrupted(self: Any, future: Any) -> Any:
        if future is sent[0]:
            return collect(self, future)
        raise KeyboardInterrupt

    monkeypatch.setattr(executors.Elsewhere, "collect", interrupted)
    assert run(tmp_path / "s", workers=Slow()).status == "unfinished"
    assert [future.cancelled() for future in sent] == [False, False, True, True, True, True]


def test_a_worker_of_an_executor_that_is_asked_to_end_does_not_end_the_sweep(tmp_path: Path) -> None:
    """Its KeyboardInterrupt comes back as the answer of its row, which is run again."""
    asked = []

    class Asked(ThreadPoolExecutor):
        def submit(self, call: Any, payload: Any, rows: Any, *rest: Any) -> Any:
            if rows[0][0] != 2 or asked:
                return super().submit(call, payload, rows, *rest)
            asked.append(Future())
            asked[0].set_exception(KeyboardInterrupt())
            return asked[0]

    with Asked(1) as pool:
        assert run(tmp_path / "s", workers=pool).counts == {"completed": 6} and asked


def test_any_executor_will_do(tmp_path: Path, alone: np.ndarray) -> None:
    """Threads of one process: they take turns."""
    with ThreadPoolExecutor(2) as pool:
        assert np.array_equal(run(tmp_path / "s", workers=pool)[NAME], alone)
    with pytest.raises(InputError, match="an executor, got None"):
        run(tmp_path / "t", workers=None)


def test_reduced_bodies_travel_by_their_hash(tmp_path: Path) -> None:
    """A builder that holds a body is a payload of some hundred bytes, and the body comes out as it was."""
    from warpffrf.study.sweeps.packing import opened, packed

    body = wf.reduce(
        wf.mesh.box((0.1, 0.02, 0.02), (6, 2, 2)),
        wf.Material(210e9, 0.3, 7850.0),
        interfaces={"x_min": "rigid"},
        modes=4,
        cache=False,
    )
    payload = packed(job.Job(FunctionScenes(partial(_with_body, body=body)), {}), tmp_path / "bodies")
    assert [file.stem for file in (tmp_path / "bodies").iterdir()] == [body.content_hash()]
    assert len(payload.content) < 2000
    scenes: Any = opened(payload).scenes
    assert scenes.function.keywords["body"].content_hash() == body.content_hash()


def _with_body(stiffness: float, body: Any) -> Any:
    return bob(stiffness)


def test_what_cannot_be_sent_is_reported_before_anything_runs(tmp_path: Path) -> None:
    lock = threading.Lock()
    with pytest.raises(InputError, match="cannot be sent to other processes"):
        run(tmp_path / "s", scene=lambda stiffness: (lock, bob(stiffness))[1], workers=2)


def test_workers_with_other_versions_are_named(tmp_path: Path, monkeypatch: Any) -> None:
    """The payload says versions that the worker does not have."""
    monkeypatch.setattr(packing, "versions", lambda: {**job.versions(), "numpy": "1.0"})
    packed = packing.packed(job.Job(partial(bob), {}), tmp_path)  # type: ignore[arg-type]
    monkeypatch.undo()
    (answer,) = packing.answers_of(packed, [(0, {})], None)
    assert answer.status == job.OTHER_VERSIONS and answer.message.endswith("here 1.0")

    class Foreign:
        def submit(self, call: Any, *rest: Any) -> Any:
            future: Any = Future()
            future.set_result([job.Answer(0, job.OTHER_VERSIONS, "warp 1.18, here 1.19", host="blade7")])
            return future

    with pytest.raises(InputError, match="worker on blade7 has other versions .warp 1.18.*install the same"):
        run(tmp_path / "s", workers=Foreign())


@pytest.mark.slow  # three processes that each load the package
def test_a_script_without_its_line_is_reported(tmp_path: Path) -> None:
    script = tmp_path / "script.py"
    script.write_text(
        textwrap.dedent(f"""
            import sys
            sys.path.insert(0, {str(FOLDER)!r})
            import warpffrf as wf
            from sweep_scenes import bob, IN_TIME
            wf.study.sweep(bob, {{"stiffness": [1e3, 2e3]}}, outputs=[{NAME!r}], store={str(tmp_path / "s")!r},
                           run=IN_TIME, workers=2)
        """)
    )
    told = subprocess.run([sys.executable, script], capture_output=True, text=True, check=False)
    assert told.returncode and told.stderr.strip().splitlines()[-1].count("if __name__ == '__main__':") == 1


@pytest.mark.slow  # likewise
@pytest.mark.parametrize("number", [signal.SIGTERM, signal.SIGKILL])
def test_a_sweep_that_is_ended_keeps_what_is_done_and_leaves_no_process(
    tmp_path: Path, alone: np.ndarray, number: int
) -> None:
    """The signal comes as soon as a row is kept; its workers end with the sweep, or they would hold its output open,
    and resume runs the rest."""
    store = tmp_path / "s"
    code = textwrap.dedent(f"""
        import sys
        sys.path.insert(0, {str(FOLDER)!r})
        import warpffrf as wf
        from sweep_scenes import bob, IN_TIME
        found = wf.study.sweep(bob, {STIFFNESS!r}, outputs=[{NAME!r}], store={str(store)!r}, run=IN_TIME, workers=2)
        print(found.status)
    """)
    process = subprocess.Popen([sys.executable, "-c", code], stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True)
    while process.poll() is None and not list((store / "runs").glob("*.arrays")):
        time.sleep(0.005)
    process.send_signal(number)
    out, err = process.communicate()
    assert out.strip() in ("unfinished", "completed", "" if number == signal.SIGKILL else "unfinished")
    found = wf.study.open_sweep(store)  # the last rows may have been quicker than the signal
    assert found.counts.get("completed", 0) >= 1
    if out.strip() == "unfinished":
        assert "continue with resume=True" in err
    assert np.array_equal(run(store, resume=True)[NAME], alone)


def test_progress_counts_runs(tmp_path: Path, monkeypatch: Any) -> None:
    counted: list[int] = []

    class Bar:
        def __init__(self, label: str, total: int, **rest: Any) -> None:
            assert (label, total, rest["unit"], rest["done"]) == ("sweep", 6, "run", 0)

        def update(self, done: int) -> None:
            counted.append(done)

        def close(self) -> None:
            counted.append(-1)

    monkeypatch.setattr(sweep, "Progress", Bar)
    run(tmp_path / "s")
    assert counted == [1, 2, 3, 4, 5, 6, -1]


def test_worlds_of_one_graph_give_the_same_bits(tmp_path: Path, alone: np.ndarray) -> None:
    """Four of six rows at once, then two; a row that is wrong, or of another kind, leaves the others together."""
    found = run(tmp_path / "s", worlds=4)
    assert np.array_equal(found[NAME], alone) and found["worlds"].tolist() == [4, 4, 4, 4, 2, 2]
    found = run(tmp_path / "t", [{"stiffness": k} for k in (1000, -1, 2000)], worlds=3)
    assert found.counts == {"completed": 2, "refused": 1} and found["worlds"].tolist() == [2, 1, 2]
    assert np.array_equal(found[NAME][[0, 2]], alone[:2])


def test_worlds_that_fail_together_run_one_by_one(tmp_path: Path, alone: np.ndarray, monkeypatch: Any) -> None:
    """Whatever it is that they fail of: here memory."""
    from warpffrf.online import worlds

    def full(*_: Any, **rest: Any) -> Any:
        raise MemoryError("no memory for so many")

    monkeypatch.setattr(worlds, "SharedEngine", full)
    found = run(tmp_path / "s", worlds=3)
    assert np.array_equal(found[NAME], alone) and found["worlds"].tolist() == [1] * 6


def test_a_job_that_cannot_be_sent_asks_for_no_client(tmp_path: Path, monkeypatch: Any) -> None:
    asked: list[str] = []
    monkeypatch.setattr(sweep, "client_at", asked.append)
    lock = threading.Lock()
    with pytest.raises(InputError, match="cannot be sent to other processes"):
        run(tmp_path / "s", scene=lambda stiffness: (lock, bob(stiffness))[1], workers="tcp://127.0.0.1:1")
    assert not asked
