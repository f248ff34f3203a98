"""Progress of a reduction: a bar with the time left on a terminal, a log line elsewhere."""

from __future__ import annotations

import logging
import sys
import time
from collections.abc import Iterable, Iterator
from contextlib import contextmanager
from typing import TypeVar

logger = logging.getLogger("warpffrf.offline")
Item = TypeVar("Item")


class Progress:
    """`track` shows how far a loop is; with `shown` False, or off a terminal, it only logs the time of each stage."""

    def __init__(self, shown: bool) -> None:
        self.bar = shown and sys.stderr is not None and sys.stderr.isatty()
        self.seconds: dict[str, float] = {}

    def track(self, items: Iterable[Item], stage: str) -> Iterator[Item]:
        """Yield `items`, timing the loop as `stage`; an interrupted loop closes its bar and raises as usual."""
        start = time.perf_counter()
        try:
            if self.bar:
                from tqdm import tqdm

                yield from tqdm(items, desc=f"reduce: {stage}", leave=False, file=sys.stderr)
            else:
                yield from items
        finally:
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
        """Count `seconds` for `stage`."""
        self.seconds[stage] = self.seconds.get(stage, 0.0) + seconds
        logger.info("%s: %.2f s", stage, seconds)
