"""Workers of dask.distributed, on this machine or many: a client of the user, or the address of a scheduler.

Rows go out a few ahead of each worker. A worker that is lost is noticed by the scheduler, which gives its rows to
others; a row that is lost with its worker `distributed.scheduler.allowed-failures` times more (3 if nothing else is
set) is given up, and run again here as one of a worker that died. Start workers with one thread each, for runs of one
process follow one another:

    dask scheduler
    dask worker tcp://HOST:8786 --nworkers 8 --nthreads 1 --preload warpffrf.study.sweeps.job
"""

from __future__ import annotations

import logging
from typing import Any

from warpffrf.model.errors import InputError
from warpffrf.study.sweeps.crews import Answers, Elsewhere, WorkerDied
from warpffrf.study.sweeps.job import Answer
from warpffrf.study.sweeps.parcel import Parcel

ANSWERS_IN = 10  # s that a scheduler has to answer in: one that is there does at once
AHEAD = 4  # rows sent for each worker: it need not wait for the next, and few are run again where it is lost

log = logging.getLogger("warpffrf")


class Cluster(Elsewhere):
    """The workers of a client; `own`: whether it was made here, and is closed here."""

    def __init__(self, parcel: Parcel, client: Any, own: bool) -> None:
        super().__init__(parcel, client.get_executor(pure=False))
        self.client, self.own = client, own
        if not _workers(client):
            log.warning("sweep: the scheduler has no worker yet; waiting for one: dask worker ADDRESS --nthreads 1")

    @property
    def capacity(self) -> int:
        """Some rows for each worker there is now: they come and go."""
        return AHEAD * max(1, _workers(self.client))

    def collect(self, future: Answers) -> list[Answer]:
        """The answers."""
        from distributed import KilledWorker

        try:
            return super().collect(future)
        except KilledWorker:
            raise WorkerDied from None

    def close(self) -> None:
        """Take back what was sent and not run yet."""
        self.executor.shutdown(wait=False)  # of this executor it means to cancel
        if self.own:
            self.client.close()


def _workers(client: Any) -> int:
    return len(client.scheduler_info(n_workers=-1)["workers"])


def client_at(address: str) -> Any:
    """A client of the scheduler at `address`. Raises `InputError` where distributed is not installed, and where
    nothing answers."""
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
