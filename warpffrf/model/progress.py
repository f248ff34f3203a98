"""Progress with the time left: a bar on a terminal, a log line now and then elsewhere."""

from __future__ import annotations

import logging
import sys
import time

from tqdm import tqdm

from warpffrf.model.printable import printable

log = logging.getLogger("warpffrf")
FIRST_LINE = 3.0  # s until the first log line off a terminal: what is over by then needs none
LOG_INTERVAL = 10.0  # s between log lines


class Progress:
    """Counts towards `total`; silent unless `enabled`. `unit`: what is counted, in the singular."""

    def __init__(self, label: str, total: int, *, enabled: bool, unit: str = "step") -> None:
        self.label, self.total, self.unit, self.done, self.begin = label, total, unit, 0, time.monotonic()
        self.next = self.begin + FIRST_LINE
        terminal = sys.stderr is not None and sys.stderr.isatty()  # None: a process without a standard error
        self.bar = tqdm(total=total, desc=printable(label), unit=unit, leave=False) if enabled and terminal else None
        self.logs = enabled and not terminal

    def update(self, done: int) -> None:
        """Steps done so far."""
        if self.bar is not None:
            self.bar.update(done - self.done)
        self.done = done
        now = time.monotonic()
        if self.logs and now > self.next and 0 < done < self.total:
            left = (now - self.begin) / done * (self.total - done)
            log.info("%s: %d of %d %ss, about %.0f s left", self.label, done, self.total, self.unit, left)
            self.next = now + LOG_INTERVAL

    def close(self) -> None:
        """End of the work."""
        if self.bar is not None:
            self.bar.close()
