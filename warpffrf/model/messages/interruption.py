"""Ctrl-C, and SIGTERM, which is taken as Ctrl-C: work that is asked to end keeps what it has.

Both raise KeyboardInterrupt where it is expected, between two chunks of steps, and wait where a file or the result is
being finished. Handlers can be set in the main thread alone; in others both contexts do nothing.

A run that was ended is a result, and the script that asked for it goes on with it. After Ctrl-C it may run more;
SIGTERM asks the process to end, so that a script may still store what it has, and ends where it would begin another
run.
"""

from __future__ import annotations

import logging
import signal
import threading
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from types import FrameType
from typing import Any

log = logging.getLogger("warpffrf")

Handler = Callable[[int, FrameType | None], Any] | signal.Handlers


class Asked:
    """Whether something was asked to end while it could not."""

    def __init__(self) -> None:
        self.asked = False

    def __bool__(self) -> bool:
        return self.asked


_process = Asked()  # by SIGTERM


@contextmanager
def _handled(handlers: dict[int, Handler]) -> Iterator[None]:
    """Signals handled in this way inside."""
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
    has come in an earlier such block, which went on."""
    free = _in_main_thread() and signal.getsignal(signal.SIGTERM) == signal.SIG_DFL
    if free and _process:
        log.error("SIGTERM has ended an earlier run: the process ends here, before another one begins")
        raise SystemExit(128 + signal.SIGTERM)
    with _handled({signal.SIGTERM: _interrupt} if free else {}):
        yield


def what_follows() -> str:
    """A clause on what comes after a run that was interrupted."""
    return "a script goes on after it" + (", and ends where it would begin another run (SIGTERM)" if _process else "")


@contextmanager
def deferred_interrupts() -> Iterator[Asked]:
    """What would raise KeyboardInterrupt waits for the end of the block, which tells it by the answer's truth; a second
    one comes through."""
    answer = Asked()

    def wait(number: int, frame: FrameType | None) -> None:
        _process.asked |= number == signal.SIGTERM
        if answer.asked:
            raise KeyboardInterrupt
        answer.asked = True
        log.warning("interrupted: what is there is being finished first; once more ends at once")

    own = (signal.default_int_handler, _interrupt)
    with _handled(
        {n: wait for n in (signal.SIGINT, signal.SIGTERM) if _in_main_thread() and signal.getsignal(n) in own}
    ):
        yield answer


@contextmanager
def deaf_children() -> Iterator[None]:
    """Processes that are started inside do not hear Ctrl-C, which a terminal sends to all of them: whoever started them
    ends them."""
    with _handled({signal.SIGINT: signal.SIG_IGN} if _in_main_thread() else {}):
        yield


def _in_main_thread() -> bool:
    return threading.current_thread() is threading.main_thread()
