"""Whether a run keeps its memory: what the process has resident, looked at while the run is under way.

A run builds and compiles first, saves rows, and copies these at its end. So the first quarter of the time is left out,
and its rows count as growth; where the operating system does not tell (`/proc/self/statm`, Linux) nothing is found.
"""

from __future__ import annotations

import os
import threading
import time
from types import TracebackType

EVERY = 0.2  # s
SETTLED = 0.25  # of the time
STATM = "/proc/self/statm"
MB = 1e6


def resident() -> float | None:
    """Memory [MB] that the process has resident, None where it is unknown."""
    try:
        with open(STATM, encoding="ascii") as file:
            return int(file.read().split()[1]) * os.sysconf("SC_PAGE_SIZE") / MB
    except (OSError, ValueError, IndexError):
        return None


class MemoryWatch:
    """Looks every `EVERY` seconds while its block runs; `grown` [MB] afterwards."""

    def __init__(self) -> None:
        self.samples: list[tuple[float, float]] = []
        self._over = threading.Event()
        self._thread = threading.Thread(target=self._look, daemon=True)

    def __enter__(self) -> MemoryWatch:
        self._thread.start()
        return self

    def __exit__(
        self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None
    ) -> None:
        self._over.set()
        self._thread.join()

    def _look(self) -> None:
        while True:
            if (size := resident()) is not None:
                self.samples.append((time.perf_counter(), size))
            if self._over.wait(EVERY):
                return

    @property
    def grown(self) -> float:
        """Largest size after the first quarter of the time, less that at its end [MB]; NaN where it is unknown."""
        if not self.samples:
            return float("nan")
        begin, end = self.samples[0][0], self.samples[-1][0]
        later = [size for t, size in self.samples if t >= begin + SETTLED * (end - begin)]
        return max(later) - later[0]
