"""Progress with the remaining time: a bar on a terminal and in a notebook, periodic log lines elsewhere.

The remaining time is extrapolated from the rate since the first count. Earlier work, such as compilation of kernels,
occurs once and is not part of a step.

Console. Lines on stderr while `reduce`, `simulate` and similar functions run, unless the application has configured
logging.

All messages go through the logger "warpffrf" and its children: activities and the notes of a run at INFO, doubts at
WARNING, details at DEBUG. An application that has handlers, of its own or by `logging.basicConfig`, receives the
records as configured and nothing else happens. Where there is none, Python itself prints warnings (its
`logging.lastResort`); while a function of `speaking` runs, the lines at INFO are printed as well, by a handler that
exists as long as that function runs. Output is switched off by `progress=False` for one call, and permanently by

    logging.getLogger("warpffrf").setLevel("WARNING")

which is what `warpffrf.quiet()` does; `"ERROR"` silences warnings too.

Interruption. Ctrl-C, and SIGTERM, which is treated as Ctrl-C: interrupted work keeps its results so far.

Both raise KeyboardInterrupt where it is expected, between two chunks of steps, and wait where a file or the result is
being finished. Handlers can be set in the main thread alone; in others both contexts do nothing.

An interrupted run returns a result, with which the script continues. After Ctrl-C it may start further runs; SIGTERM
requests the end of the process, so that a script may still store its results, and exits where it would start another
run.
"""

from __future__ import annotations

import logging
import signal
import sys
import threading
import time
import warnings
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from contextvars import ContextVar
from types import FrameType
from typing import Any

from tqdm import TqdmWarning, tqdm

from warpffrf.model.messages.named_arguments import named_arguments
from warpffrf.model.messages.reprs import printable

log = logging.getLogger("warpffrf")
FIRST_LINE = 3.0  # s until the first log line without a terminal: shorter work needs none
LOG_INTERVAL = 10.0  # s between log lines
UNTIMED = "{l_bar}{bar}| {n_fmt}/{total_fmt}, {elapsed} so far"  # of a bar without remaining time


class Progress:
    """Counts towards `total`, from `done`; silent unless `enabled`. `unit`: what is counted, in the singular; timed:
    the units take equal times, so that their rate predicts the remaining time."""

    def __init__(
        self, label: str, total: int, *, enabled: bool, unit: str = "step", done: int = 0, timed: bool = True
    ) -> None:
        self.label, self.total, self.unit, self.done, self.timed = label, total, unit, done, timed
        self.first: tuple[int, float] | None = None  # done, and when, as the first of them was counted
        self.next = time.monotonic() + FIRST_LINE
        make = _bar()
        self.bar = None
        if enabled and make is not None:
            self.bar = make(
                total=total, initial=done, desc=printable(label), unit=unit, leave=False,
                bar_format=None if timed else UNTIMED,
            )  # fmt: skip
        self.logs = enabled and make is None

    def update(self, done: int) -> None:
        """Set the number of units done so far."""
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
        """End the display."""
        if self.bar is not None:
            self.bar.close()


def _bar() -> type[tqdm] | None:
    """The bar of a terminal, or of a notebook, which has widgets with ipywidgets and text without; None elsewhere."""
    if "ipykernel.zmqshell" in sys.modules:
        with warnings.catch_warnings():
            warnings.simplefilter("ignore", TqdmWarning)  # without ipywidgets
            from tqdm.auto import tqdm as bar
        return bar
    terminal = sys.stderr is not None and sys.stderr.isatty()  # None: a process without a standard error
    return tqdm if terminal else None


notes = logging.getLogger("warpffrf.notes")  # of finished runs: a report has them too

_lowest: ContextVar[int | None] = ContextVar("lowest level heard inside of speaking", default=None)


class Lines(logging.Handler):
    """Writes each record as one line to the current standard error, above a progress bar if there is one."""

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
    """Lines of threads inside `speaking`; of others, such as one in the background, warnings. On the logger while any
    thread is inside and no other handler receives the records."""

    def __init__(self) -> None:
        super().__init__()
        self.calls, self.sets_level = 0, False

    def emit(self, record: logging.LogRecord) -> None:
        """Write the record if it is meant for its thread."""
        lowest = _lowest.get()
        if record.levelno >= (logging.WARNING if lowest is None else lowest):
            super().emit(record)

    def enter(self) -> None:
        """Count one more call, in any thread."""
        with _lock:
            self.calls += 1
            if self.calls == 1 and not log.hasHandlers():
                log.addHandler(self)
                self.sets_level = log.level == logging.NOTSET
                if self.sets_level:
                    log.setLevel(logging.INFO)

    def leave(self) -> None:
        """Count one call less."""
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
    """From now on only warnings and errors go to stderr, no lines about activities.

    The same as `logging.getLogger("warpffrf").setLevel("WARNING")`; `progress=False` does it for one call.
    """
    log.setLevel(logging.WARNING)


@contextmanager
def speaking(shown: bool = True) -> Iterator[None]:
    """Lines of the logger "warpffrf" go to stderr inside, where the application does not receive them.

    shown: False for warnings and errors alone. Calls may be nested, where the quietest one applies, and be made
    in several threads.
    """
    token = _lowest.set(max(_lowest.get() or logging.INFO, logging.INFO if shown else logging.WARNING))
    _heard.enter()
    try:
        yield
    finally:
        _heard.leave()
        _lowest.reset(token)


Handler = Callable[[int, FrameType | None], Any] | signal.Handlers


class Asked:
    """Whether an interruption was requested while it could not take place."""

    def __init__(self) -> None:
        self.asked = False

    def __bool__(self) -> bool:
        return self.asked


_process = Asked()  # by SIGTERM


@contextmanager
def _handled(handlers: dict[int, Handler]) -> Iterator[None]:
    """Installs the signal `handlers` inside."""
    before = {number: signal.signal(number, handler) for number, handler in handlers.items()}
    try:
        yield
    finally:
        for number, handler in before.items():
            signal.signal(number, handler)


def _interrupt(number: int, frame: FrameType | None) -> None:
    _process.asked = True
    raise KeyboardInterrupt


@contextmanager
def terminated_as_interrupted() -> Iterator[None]:
    """SIGTERM raises KeyboardInterrupt inside, unless the program has a handler of its own. Raises SystemExit where it
    came in an earlier such block, after which the program continued."""
    free = _in_main_thread() and signal.getsignal(signal.SIGTERM) == signal.SIG_DFL
    if free and _process:
        log.error("SIGTERM stopped an earlier run: the process exits before the next run")
        raise SystemExit(128 + signal.SIGTERM)
    with _handled({signal.SIGTERM: _interrupt} if free else {}):
        yield


def what_follows() -> str:
    """A clause on what follows an interrupted run."""
    return "a script goes on after it" + (", and ends where it would begin another run (SIGTERM)" if _process else "")


@contextmanager
def deferred_interrupts() -> Iterator[Asked]:
    """Signals that raise KeyboardInterrupt are deferred to the end of the block; the answer is true if one came. A
    second one is raised at once."""
    answer = Asked()

    def wait(number: int, frame: FrameType | None) -> None:
        _process.asked |= number == signal.SIGTERM
        if answer.asked:
            raise KeyboardInterrupt
        answer.asked = True
        log.warning("interrupted: completing the results so far; interrupt again to stop at once")

    own = (signal.default_int_handler, _interrupt)
    with _handled(
        {n: wait for n in (signal.SIGINT, signal.SIGTERM) if _in_main_thread() and signal.getsignal(n) in own}
    ):
        yield answer


@contextmanager
def deaf_children() -> Iterator[None]:
    """Processes that are started inside ignore Ctrl-C, which a terminal sends to all of them: their parent ends
    them."""
    with _handled({signal.SIGINT: signal.SIG_IGN} if _in_main_thread() else {}):
        yield


def _in_main_thread() -> bool:
    return threading.current_thread() is threading.main_thread()
