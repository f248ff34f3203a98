"""Who runs the rows of a sweep, behind one interface: rows go in, a `concurrent.futures.Future` of answers comes back.

    Here         this process, one row after the other
    Processes    processes of our own, each with a device: the default for several workers, and needs nothing else
    Elsewhere    anybody with the `submit` of concurrent.futures
    Cluster      dask.distributed on this machine or many (`cluster`)

A process that has used Warp cannot be forked. So ours are forks of one that has done nothing but import what workers
need, which takes seconds (where the system cannot fork, each imports it). Each is a pool of one: one that dies is known
by the row that it had, the others go on, and a new one takes its place at once. Ctrl-C does not reach them, they are
ended by us.
"""

from __future__ import annotations

import importlib
import multiprocessing
import os
import pickle
import threading
import time
from collections.abc import Sequence
from concurrent.futures import BrokenExecutor, CancelledError, Future, ProcessPoolExecutor
from multiprocessing.connection import wait
from typing import Any, Protocol

from warpffrf import __version__
from warpffrf.model.errors import InputError
from warpffrf.model.messages.progress import deaf_children
from warpffrf.study.sweeps.errand import answers
from warpffrf.study.sweeps.job import Answer, Job, Numbered
from warpffrf.study.sweeps.parcel import Parcel

WORKER = "warpffrf sweep worker"  # name of our processes
LEAST_OPEN = 64  # rows sent at once, where it is not known how many workers there are
DYING = 0.1  # s from when a process no longer answers to when the system says that it has ended


METHOD = "forkserver" if "forkserver" in multiprocessing.get_all_start_methods() else "spawn"
IMPORTED = ("warpffrf.study.sweeps.job", "warpffrf.scene_file")

_Context: Any = type(multiprocessing.get_context(METHOD))


class WorkerDied(Exception):
    """A worker ended without an answer."""


Answers = Future[list[Answer]]


def found_by(future: Answers) -> list[Answer]:
    """The answers of a future that is done. A KeyboardInterrupt that comes out of it is not the user's: SIGTERM has
    asked that worker alone to end, which is `WorkerDied`."""
    if isinstance(future.exception(), KeyboardInterrupt):
        raise WorkerDied
    return future.result()


class Crew(Protocol):
    """Runs rows. `capacity`: how many futures may be open at once."""

    @property
    def capacity(self) -> int:
        """How many futures may be open."""
        ...

    def submit(self, rows: Numbered) -> Answers:
        """Have these rows run."""
        ...

    def collect(self, future: Answers) -> list[Answer]:
        """The answers of a future that is done. Raises `WorkerDied`, after which the rows may be submitted again, and
        `InputError` where no worker can do anything."""
        ...

    def close(self) -> None:
        """End what still runs."""
        ...


class Here:
    """This process."""

    capacity = 1

    def __init__(self, job: Job, device: str | None) -> None:
        self.job, self.device = job, device

    def submit(self, rows: Numbered) -> Answers:
        """Runs them at once."""
        future: Answers = Future()
        future.set_result(self.job.answers(rows, self.device))
        return future

    def collect(self, future: Answers) -> list[Answer]:
        """What was found."""
        return future.result()

    def close(self) -> None:
        """Nothing runs."""


class _Named(_Context):
    """Starts processes by the name of ours, and keeps them at hand."""

    def __init__(self) -> None:
        super().__init__()
        self.started: list[Any] = []
        if METHOD == "forkserver":
            self.set_forkserver_preload(list(IMPORTED))

    def Process(self, *args: Any, **options: Any) -> Any:
        options["name"] = WORKER
        process = super().Process(*args, **options)
        self.started.append(process)
        return process


class _Worker:
    """A pool of one process, on one device."""

    def __init__(self, device: str | None) -> None:
        self.device, self.context = device, _Named()
        self.pool = ProcessPoolExecutor(1, mp_context=self.context, initializer=_end_with_the_sweep)
        with deaf_children():
            self.ready = self.pool.submit(_begin, dict(os.environ))

    def end(self) -> None:
        """End it at once: it has nothing to keep."""
        for process in self.context.started:
            process.kill()
        self.pool.shutdown(wait=True, cancel_futures=True)


def _started(device: str | None) -> _Worker:
    """A worker. The process that they are forked from may have been killed, which the first try finds out; the second
    comes from another one."""
    try:
        return _Worker(device)
    except (OSError, EOFError):
        time.sleep(DYING)
        return _Worker(device)


def _end_with_the_sweep() -> None:
    """What a worker does at once: it listens for the end of the sweep's process. One that is killed ends nobody, and
    its workers would wait for rows for ever, with what they hold of a GPU."""
    sweep = multiprocessing.parent_process()
    if sweep is None:
        raise RuntimeError("no process of a sweep started this one")

    def listen(sentinel: int) -> None:
        wait([sentinel])
        os._exit(1)

    threading.Thread(target=listen, args=(sweep.sentinel,), daemon=True).start()


def _begin(environment: dict[str, str]) -> None:
    """What a worker does first: what it was forked from may be older than variables of its environment."""
    os.environ.update(environment)
    for module in IMPORTED:
        importlib.import_module(module)


class Processes:
    """A process of this machine for each of `devices`, None: the device of the run."""

    def __init__(self, parcel: Parcel, devices: Sequence[str | None]) -> None:
        self.parcel, self.capacity = parcel, len(devices)
        self.free: list[_Worker] = []
        self.busy: dict[Answers, _Worker] = {}
        try:
            for device in devices:
                self.free.append(_started(device))
        except BaseException:
            self.close()
            raise

    def submit(self, rows: Numbered) -> Answers:
        """A worker that is free runs them."""
        worker = self.free.pop(0)
        try:
            future = worker.pool.submit(answers, self.parcel, rows, worker.device)
        except BrokenExecutor as error:  # it has died while it was idle
            future = Future()
            future.set_exception(error)
        self.busy[future] = worker
        return future

    def collect(self, future: Answers) -> list[Answer]:
        """The answers; a worker that has died, or was asked to end, is replaced."""
        worker = self.busy.pop(future)
        try:
            found = found_by(future)
        except (BrokenExecutor, WorkerDied):
            begun = worker.ready.done() and worker.ready.exception() is None
            worker.end()
            if not begun:
                raise InputError(
                    "sweep: a worker process ended before it had begun; a script must call sweep below the line "
                    "if __name__ == '__main__':, because every worker reads the script; or run it here, workers=1"
                ) from None
            self.free.append(_started(worker.device))
            raise WorkerDied from None
        except BaseException:  # it lives, and `close` ends it
            self.free.append(worker)
            raise
        self.free.append(worker)
        return found

    def close(self) -> None:
        """Ends all processes."""
        for worker in (*self.free, *self.busy.values()):
            worker.end()
        self.free.clear()
        self.busy.clear()


def refuse_in_workers() -> None:
    """Raises `InputError` in a process that `Processes` has started, whose script comes to its sweep again."""
    if multiprocessing.current_process().name == WORKER:
        raise InputError(
            "sweep: a worker process has come to the sweep that started it, because it reads the script; put the call "
            "below the line if __name__ == '__main__':"
        )


class Elsewhere:
    """An executor that somebody else has set up; it is not shut down."""

    def __init__(self, parcel: Parcel, executor: Any) -> None:
        self.parcel, self.executor = parcel, executor
        self.open: set[Answers] = set()

    @property
    def capacity(self) -> int:
        """So many that no worker waits."""
        return LEAST_OPEN

    def submit(self, rows: Numbered) -> Answers:
        """Any worker runs them."""
        future = self.executor.submit(answers, self.parcel, rows, None)
        self.open.add(future)
        return future

    def collect(self, future: Answers) -> list[Answer]:
        """The answers."""
        self.open.discard(future)
        try:
            return found_by(future)
        except CancelledError:
            raise InputError("sweep: the executor has cancelled runs; go on with resume=True, on another one") from None
        except BrokenExecutor as error:
            raise InputError(
                f"sweep: the executor given is broken ({error}); go on with resume=True, on another one"
            ) from None
        except (ImportError, AttributeError, pickle.UnpicklingError) as error:
            raise InputError(
                f"sweep: workers cannot open what is sent to them ({error}); install warpffrf {__version__} there too"
            ) from None

    def close(self) -> None:
        """Takes back what has not begun; the executor itself belongs to others."""
        for future in self.open:
            future.cancel()
        self.open.clear()
