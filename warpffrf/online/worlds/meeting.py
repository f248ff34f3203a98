"""Threads that do together what none of them does alone: each waits until all others have come.

Each run of many is a thread with the code of a single run. When it wants what the graph does for all of them, it comes
to the meeting and leaves the turn (`warpffrf.online.turn`) until all that still run have come, too; the last one does
it for everybody. Between two meetings they go on one at a time, as everything in Warp does.
"""

from __future__ import annotations

import threading
from collections.abc import Callable
from typing import Any

from warpffrf.online.turn import TURN

Together = Callable[[dict[int, Any]], None]


class Ended(BaseException):
    """Raised in a run whose work nobody wants any more, as another one has raised an error."""


class Meeting:
    """A meeting of `count` threads, numbered from 0."""

    def __init__(self, count: int) -> None:
        self._changed = threading.Condition()
        self._coming = set(range(count))  # those that will come again
        self._brought: dict[int, Any] = {}
        self._together: Together | None = None
        self._held = 0  # meetings so far
        self.error: BaseException | None = None  # of the last one
        self._ends: type[BaseException] | None = None

    def come(self, number: int, brings: Any, together: Together) -> None:
        """Wait for the others; the last to come calls `together` with what each has brought, by number. An error of
        this is raised in all. The thread has the turn before and after."""
        with self._changed:
            self._raise_end()
            self._brought[number], self._together = brings, together
            held = self._held
            last = len(self._brought) == len(self._coming)
        if last:
            self._hold()
        else:
            with TURN.left(), self._changed:
                self._changed.wait_for(lambda: self._held > held)
        self._raise_end()
        if self.error is not None:
            raise self.error

    def leave(self, number: int) -> None:
        """This thread comes no more; where it was the one that all waited for, they meet now. Without the turn."""
        with TURN:
            with self._changed:
                self._coming.discard(number)
                last = bool(self._brought) and len(self._brought) == len(self._coming)
            if last:
                self._hold()

    def end(self, how: type[BaseException]) -> None:
        """From now on whoever comes, or waits and is met, raises `how`, once for each thread and meeting."""
        with self._changed:
            self._ends = how

    def _raise_end(self) -> None:
        if self._ends is not None:
            raise self._ends

    def _hold(self) -> None:
        """The meeting, with the turn."""
        together, brought = self._together, self._brought
        self._brought, self.error = {}, None
        try:
            if together is not None and self._ends is None:
                together(brought)
        except BaseException as error:
            self.error = error
        with self._changed:
            self._held += 1
            self._changed.notify_all()
