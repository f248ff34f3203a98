"""Workers of dask.distributed, on this machine or many: a client of the user, or the address of a scheduler.

A few rows are sent ahead to each worker. The scheduler detects a lost worker and gives its rows to others; a row that
loses `distributed.scheduler.allowed-failures` further workers (3 by default) is abandoned by the scheduler and handled
here as a row of a dead worker. Start workers with one thread each, because runs of one process are sequential:

    dask scheduler
    dask worker tcp://HOST:8786 --nworkers 8 --nthreads 1 --preload warpffrf.study.sweeps.job
"""

from __future__ import annotations

import logging
from typing import Any

from warpffrf.model.errors import InputError
from warpffrf.study.sweeps.executors import Answers, Elsewhere, WorkerDied
from warpffrf.study.sweeps.job import Answer
from warpffrf.study.sweeps.payload import Payload

ANSWERS_IN = 10  # s for the scheduler to answer: a running one answers at once
AHEAD = 4  # rows sent per worker: it need not wait for the next, and few are repeated if it is lost

log = logging.getLogger("warpffrf")


class Cluster(Elsewhere):
    """The workers of a client; `own`: whether it was created here, and is closed here."""

    def __init__(self, payload: Payload, client: Any, own: bool) -> None:
        super().__init__(payload, client.get_executor(pure=False))
        self.client, self.own = client, own
        if not _workers(client):
            log.warning("sweep: the scheduler has no worker yet; waiting for one: dask worker ADDRESS --nthreads 1")

    @property
    def capacity(self) -> int:
        """A few rows for each present worker; their number may change."""
        return AHEAD * max(1, _workers(self.client))

    def collect(self, future: Answers) -> list[Answer]:
        """The answers of a finished future."""
        from distributed import KilledWorker

        try:
            return super().collect(future)
        except KilledWorker:
            raise WorkerDied from None

    def close(self) -> None:
        """Cancel rows that have not been run."""
        self.executor.shutdown(wait=False)  # cancels only the futures of this executor
        if self.own:
            self.client.close()


def _workers(client: Any) -> int:
    return len(client.scheduler_info(n_workers=-1)["workers"])


def client_at(address: str) -> Any:
    """A client of the scheduler at `address`. Raises `InputError` if distributed is not installed, and if nothing
    answers."""
    try:
        from distributed import Client
    except ImportError as error:
        raise InputError(
            "sweep: a scheduler needs dask.distributed: pip install 'warpffrf[cluster]'; or take processes of this "
            "machine, workers=2"
        ) from error
    try:
        return Client(address, timeout=ANSWERS_IN)
    except (OSError, ValueError, ImportError) as error:
        raise InputError(
            f"sweep: no scheduler answers at {address!r} ({error or type(error).__name__}); start one with: dask "
            "scheduler, and give the address that it prints, as tcp://HOST:8786"
        ) from None
