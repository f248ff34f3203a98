"""Executors of the rows of a sweep, with one interface: rows are submitted, a `concurrent.futures.Future` of answers is
returned.

    Here         this process, one row after the other
    Processes    own processes, each with a device: the default for several workers, without further packages
    Elsewhere    any executor with the `submit` of concurrent.futures
    Cluster      dask.distributed on this machine or many (`cluster`)

A process that has used Warp cannot be forked. Workers are therefore forked from a process that has only imported the
required modules, which takes seconds (without fork, each worker imports them). Each worker is a pool of one process: a
dead worker is identified by its row, the others continue, and it is replaced at once. Ctrl-C does not reach workers;
they are ended here.
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
from warpffrf.study.sweeps.job import Answer, Job, Numbered
from warpffrf.study.sweeps.payload import Payload
from warpffrf.study.sweeps.task import answers

WORKER = "warpffrf sweep worker"  # name of the processes
LEAST_OPEN = 64  # rows sent at once if the number of workers is unknown
DYING = 0.1  # s between the last answer of a process and its end as reported by the system


METHOD = "forkserver" if "forkserver" in multiprocessing.get_all_start_methods() else "spawn"
IMPORTED = ("warpffrf.study.sweeps.job", "warpffrf.scene_file")

_Context: Any = type(multiprocessing.get_context(METHOD))


class WorkerDied(Exception):
    """A worker ended without an answer."""


Answers = Future[list[Answer]]


def found_by(future: Answers) -> list[Answer]:
    """The answers of a finished future. A KeyboardInterrupt raised by it is not the user's: SIGTERM has ended that
    worker alone, which is `WorkerDied`."""
    if isinstance(future.exception(), KeyboardInterrupt):
        raise WorkerDied
    return future.result()


class Executor(Protocol):
    """Executor of rows. `capacity`: number of futures that may be open at once."""

    @property
    def capacity(self) -> int:
        """Number of futures that may be open."""
        ...

    def submit(self, rows: Numbered) -> Answers:
        """Submit rows."""
        ...

    def collect(self, future: Answers) -> list[Answer]:
        """The answers of a finished future. Raises `WorkerDied`, after which the rows may be submitted again, and
        `InputError` if no worker can run anything."""
        ...

    def close(self) -> None:
        """End all running work."""
        ...


class Here:
    """Executor in this process."""

    capacity = 1

    def __init__(self, job: Job, device: str | None) -> None:
        self.job, self.device = job, device

    def submit(self, rows: Numbered) -> Answers:
        """Run the rows immediately."""
        future: Answers = Future()
        future.set_result(self.job.answers(rows, self.device))
        return future

    def collect(self, future: Answers) -> list[Answer]:
        """The answers."""
        return future.result()

    def close(self) -> None:
        """Nothing to end."""


class _Named(_Context):
    """Starts named processes, and keeps references to them."""

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
        """End the process immediately."""
        for process in self.context.started:
            process.kill()
        self.pool.shutdown(wait=True, cancel_futures=True)


def _started(device: str | None) -> _Worker:
    """Start a worker. The process that workers are forked from may have been killed, which the first attempt detects;
    the second attempt forks from a new one."""
    try:
        return _Worker(device)
    except (OSError, EOFError):
        time.sleep(DYING)
        return _Worker(device)


def _end_with_the_sweep() -> None:
    """Initialisation of a worker: wait for the end of the sweep's process. A killed process does not end its workers,
    which would wait for rows forever and keep their GPU memory."""
    sweep = multiprocessing.parent_process()
    if sweep is None:
        raise RuntimeError("no process of a sweep started this one")

    def listen(sentinel: int) -> None:
        wait([sentinel])
        os._exit(1)

    threading.Thread(target=listen, args=(sweep.sentinel,), daemon=True).start()


def _begin(environment: dict[str, str]) -> None:
    """Initialisation of a worker: environment variables may have changed since the parent process was started."""
    os.environ.update(environment)
    for module in IMPORTED:
        importlib.import_module(module)


class Processes:
    """A process of this machine for each of `devices`, None: the device of the run."""

    def __init__(self, payload: Payload, devices: Sequence[str | None]) -> None:
        self.payload, self.capacity = payload, len(devices)
        self.free: list[_Worker] = []
        self.busy: dict[Answers, _Worker] = {}
        try:
            for device in devices:
                self.free.append(_started(device))
        except BaseException:
            self.close()
            raise

    def submit(self, rows: Numbered) -> Answers:
        """Submit rows to a free worker."""
        worker = self.free.pop(0)
        try:
            future = worker.pool.submit(answers, self.payload, rows, worker.device)
        except BrokenExecutor as error:  # it died while it was idle
            future = Future()
            future.set_exception(error)
        self.busy[future] = worker
        return future

    def collect(self, future: Answers) -> list[Answer]:
        """The answers; a worker that died, or was asked to end, is replaced."""
        worker = self.busy.pop(future)
        try:
            found = found_by(future)
        except (BrokenExecutor, WorkerDied):
            begun = worker.ready.done() and worker.ready.exception() is None
            worker.end()
            if not begun:
                raise InputError(
                    "sweep: a worker process ended during its start; a script must call sweep below the line "
                    "if __name__ == '__main__':, because every worker reads the script; or run it here, workers=1"
                ) from None
            self.free.append(_started(worker.device))
            raise WorkerDied from None
        except BaseException:  # the worker is alive, and `close` ends it
            self.free.append(worker)
            raise
        self.free.append(worker)
        return found

    def close(self) -> None:
        """End all processes."""
        for worker in (*self.free, *self.busy.values()):
            worker.end()
        self.free.clear()
        self.busy.clear()


def refuse_in_workers() -> None:
    """Raises `InputError` in a process started by `Processes` whose script calls the sweep again."""
    if multiprocessing.current_process().name == WORKER:
        raise InputError(
            "sweep: a worker process reached the sweep call that started it, because it reads the script; put the call "
            "below the line if __name__ == '__main__':"
        )


class Elsewhere:
    """An executor provided by the user; it is not shut down."""

    def __init__(self, payload: Payload, executor: Any) -> None:
        self.payload, self.executor = payload, executor
        self.open: set[Answers] = set()

    @property
    def capacity(self) -> int:
        """Enough rows for all workers."""
        return LEAST_OPEN

    def submit(self, rows: Numbered) -> Answers:
        """Submit rows to any worker."""
        future = self.executor.submit(answers, self.payload, rows, None)
        self.open.add(future)
        return future

    def collect(self, future: Answers) -> list[Answer]:
        """The answers."""
        self.open.discard(future)
        try:
            return found_by(future)
        except CancelledError:
            raise InputError("sweep: the executor has cancelled runs; continue with resume=True on another") from None
        except BrokenExecutor as error:
            raise InputError(
                f"sweep: the given executor is broken ({error}); continue with resume=True, on another one"
            ) from None
        except (ImportError, AttributeError, pickle.UnpicklingError) as error:
            raise InputError(
                f"sweep: workers cannot open what is sent to them ({error}); install warpffrf {__version__} there too"
            ) from None

    def close(self) -> None:
        """Cancel rows that have not started; the executor itself is not closed."""
        for future in self.open:
            future.cancel()
        self.open.clear()
