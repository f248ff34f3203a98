"""Progress of a reduction: a bar with the remaining time on a terminal, log lines elsewhere.

Threads. The number of threads for work that NumPy does outside the interpreter's lock.

The threads of a BLAS spin while they wait for each other: on a shared machine they made a factorisation eight times
slower. The BLAS therefore has one thread, and whole tasks (blocks of loads, subtrees of an elimination) are distributed
over our own threads, which are joined only at the end.
"""

from __future__ import annotations

import logging
import os
import time
from collections.abc import Iterator, Sequence
from contextlib import contextmanager
from typing import TypeVar

from warpffrf.model.messages.progress import Progress as Bar

LONG = 1.0  # s: stages that take this long are logged at the level shown to every user
logger = logging.getLogger("warpffrf.offline")
Item = TypeVar("Item")


class Progress:
    """`track` shows the progress of a loop, unless `shown` is False; times of stages are logged in any case."""

    def __init__(self, shown: bool) -> None:
        self.shown = shown
        self.seconds: dict[str, float] = {}

    def track(self, items: Sequence[Item], stage: str) -> Iterator[Item]:
        """Yield `items`, timing the loop as `stage`; an interrupted loop closes its bar and raises."""
        start = time.perf_counter()
        bar = Bar(f"reduce: {stage}", len(items), enabled=self.shown, unit="part")
        try:
            for done, item in enumerate(items, start=1):
                yield item
                bar.update(done)
        finally:
            bar.close()
            self.add(stage, time.perf_counter() - start)

    @contextmanager
    def stage(self, name: str) -> Iterator[None]:
        """Time a block as stage `name`."""
        start = time.perf_counter()
        try:
            yield
        finally:
            self.add(name, time.perf_counter() - start)

    def add(self, stage: str, seconds: float) -> None:
        """Add `seconds` to `stage`."""
        self.seconds[stage] = self.seconds.get(stage, 0.0) + seconds
        logger.log(logging.INFO if seconds > LONG else logging.DEBUG, "reduce: %s took %.2f s", stage, seconds)


MOST = 16  # tasks are few and large; more threads would wait for memory


def worker_count() -> int:
    """Processors that this process may use, at most `MOST`."""
    if hasattr(os, "sched_getaffinity"):
        available = len(os.sched_getaffinity(0))
    else:
        available = os.cpu_count() or 1
    return max(1, min(available, MOST))
