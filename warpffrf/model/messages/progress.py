"""Progress with the time left: a bar on a terminal, a log line now and then elsewhere.

The time left is that of what is left at the pace since the first count. What comes before that, as kernels that are
compiled, comes once, and is no time of a step.
"""

from __future__ import annotations

import logging
import sys
import time

from tqdm import tqdm

from warpffrf.model.messages.printable import printable

log = logging.getLogger("warpffrf")
FIRST_LINE = 3.0  # s until the first log line off a terminal: what is over by then needs none
LOG_INTERVAL = 10.0  # s between log lines
UNTIMED = "{l_bar}{bar}| {n_fmt}/{total_fmt}, {elapsed} so far"  # of a bar that does not say what is left


class Progress:
    """Counts towards `total`, from `done`; silent unless `enabled`. `unit`: what is counted, in the singular; timed:
    the units are alike, so that their pace says how long the rest takes."""

    def __init__(
        self, label: str, total: int, *, enabled: bool, unit: str = "step", done: int = 0, timed: bool = True
    ) -> None:
        self.label, self.total, self.unit, self.done, self.timed = label, total, unit, done, timed
        self.first: tuple[int, float] | None = None  # done, and when, as the first of them was counted
        self.next = time.monotonic() + FIRST_LINE
        terminal = sys.stderr is not None and sys.stderr.isatty()  # None: a process without a standard error
        self.bar = None
        if enabled and terminal:
            self.bar = tqdm(
                total=total, initial=done, desc=printable(label), unit=unit, leave=False,
                bar_format=None if timed else UNTIMED,
            )  # fmt: skip
        self.logs = enabled and not terminal

    def update(self, done: int) -> None:
        """Steps done so far."""
        now = time.monotonic()
        if self.first is None and done > self.done:
            self.first = done, now
            if self.bar is not None:
                self.bar.reset()  # its clock
                self.bar.initial = self.bar.n = self.bar.last_print_n = done
                self.bar.refresh()
        elif self.bar is not None:
            self.bar.update(done - self.done)
        self.done = done
        if self.logs and now > self.next and self.first is not None and done < self.total:
            counted, begin = self.first
            left = ""
            if self.timed and done > counted:
                left = f", about {(now - begin) / (done - counted) * (self.total - done):.0f} s left"
            log.info("%s: %d of %d %ss%s", self.label, done, self.total, self.unit, left)
            self.next = now + LOG_INTERVAL

    def close(self) -> None:
        """End of the work."""
        if self.bar is not None:
            self.bar.close()
