"""What a script hears: lines on stderr while `reduce`, `simulate` and their like work, unless the application has set
up logging.

Everything is said through the logger "warpffrf" and its children: what is being done and the notes of a run at INFO,
doubts at WARNING, details at DEBUG. An application that has handlers, of its own or by `logging.basicConfig`, gets the
records as it has asked for and nothing else happens. Where there is none, Python itself prints warnings (its
`logging.lastResort`); while a function of `speaking` works, the lines at INFO come as well, by a handler that lives as
long as that function. A script becomes quiet by `progress=False` for one call, and for good by

    logging.getLogger("warpffrf").setLevel("WARNING")

which is what `warpffrf.quiet()` does; `"ERROR"` silences warnings too.
"""

from __future__ import annotations

import logging
import sys
import threading
from collections.abc import Iterator
from contextlib import contextmanager
from contextvars import ContextVar

from tqdm import tqdm

from warpffrf.model.messages.named_arguments import named_arguments
from warpffrf.model.messages.printable import printable

log = logging.getLogger("warpffrf")
notes = logging.getLogger("warpffrf.notes")  # of finished runs: a report has them as well

_lowest: ContextVar[int | None] = ContextVar("lowest level heard inside of speaking", default=None)


class Lines(logging.Handler):
    """Writes each record as one line to the standard error of the moment, above a bar of progress if there is one."""

    def __init__(self, form: str = "%(message)s") -> None:
        super().__init__()
        self.setFormatter(logging.Formatter(form))

    def emit(self, record: logging.LogRecord) -> None:
        """Write the record where there is a standard error."""
        if sys.stderr is None:
            return
        try:
            tqdm.write(printable(self.format(record)), file=sys.stderr)
        except Exception:
            self.handleError(record)


class _Heard(Lines):
    """Lines of the threads that speak; of others, as of one in the background, warnings. On the logger while anybody
    speaks and nobody else receives what is said."""

    def __init__(self) -> None:
        super().__init__()
        self.calls, self.sets_level = 0, False

    def emit(self, record: logging.LogRecord) -> None:
        """Write the record where its thread hears it."""
        lowest = _lowest.get()
        if record.levelno >= (logging.WARNING if lowest is None else lowest):
            super().emit(record)

    def enter(self) -> None:
        """One call more, in any thread."""
        with _lock:
            self.calls += 1
            if self.calls == 1 and not log.hasHandlers():
                log.addHandler(self)
                self.sets_level = log.level == logging.NOTSET
                if self.sets_level:
                    log.setLevel(logging.INFO)

    def leave(self) -> None:
        """One call less."""
        with _lock:
            self.calls -= 1
            if not self.calls and self in log.handlers:
                log.removeHandler(self)
                if self.sets_level and log.level == logging.INFO:
                    log.setLevel(logging.NOTSET)


_lock = threading.Lock()
_heard = _Heard()


@named_arguments
def quiet() -> None:
    """From now on only warnings and errors go to stderr, no lines about what is being done.

    The same as `logging.getLogger("warpffrf").setLevel("WARNING")`; `progress=False` does it for one call.
    """
    log.setLevel(logging.WARNING)


@contextmanager
def speaking(shown: bool = True) -> Iterator[None]:
    """Lines of the logger "warpffrf" go to stderr inside, where the application does not receive them.

    shown: False for warnings and errors alone. Calls may stand in one another, then the quietest is followed, and in
    several threads.
    """
    token = _lowest.set(max(_lowest.get() or logging.INFO, logging.INFO if shown else logging.WARNING))
    _heard.enter()
    try:
        yield
    finally:
        _heard.leave()
        _lowest.reset(token)
