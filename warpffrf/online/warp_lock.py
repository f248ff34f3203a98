"""Lock that admits one thread at a time to Warp, except for the replay of graphs.

Warp has one capture per process, which records every launch of every thread; loading a module is not thread-safe
either. A thread that builds arrays, captures, launches or copies therefore holds the lock, from the start of a run to
its end, and releases it while its graph replays, which takes most of the time: a replay is native code that works on
the arrays of its own graph, and Python's lock is not held.

Replays are serialised as well on a GPU, whose one stream is captured, and in debug builds and with blocks of lanes on
the CPU, where kernels address their shared memory by a static pointer (`shared_tile_storage` of Warp's tile.h). Other
CPU kernels keep that pointer but never dereference it, as none here has tiles (`tests/kernels/test_no_tiles.py`).
"""

from __future__ import annotations

import os
import threading
from collections.abc import Iterator
from contextlib import ContextDecorator, contextmanager

import warp as wp


def replays_side_by_side(device: str) -> bool:
    """Whether graphs may replay on `device` in several threads at once, as Warp is configured now."""
    return wp.get_device(device).is_cpu and wp.config.mode != "debug" and not wp.config.enable_cpu_blocks


class WarpLock(ContextDecorator):
    """A reentrant lock that a thread may release temporarily, however often it has acquired it."""

    def __init__(self) -> None:
        self._lock = threading.Lock()
        self._owner, self._depth = 0, 0

    def __enter__(self) -> None:
        if not self._mine():
            self._lock.acquire()
            self._owner = threading.get_ident()
        self._depth += 1

    def __exit__(self, *_: object) -> None:
        self._depth -= 1
        if not self._depth:
            self._owner = 0
            self._lock.release()

    @contextmanager
    def left(self) -> Iterator[None]:
        """Release it temporarily; no effect if this thread does not hold it."""
        if not self._mine():
            yield
            return
        depth, self._depth, self._owner = self._depth, 0, 0
        self._lock.release()
        try:
            yield
        finally:
            interruption = self._wait()
            self._owner, self._depth = threading.get_ident(), depth
            if interruption is not None:
                raise interruption

    def _wait(self) -> KeyboardInterrupt | None:
        """Acquire the lock, also after an interruption, because the code that follows needs it too."""
        interruption = None
        while True:
            try:
                self._lock.acquire()
                return interruption
            except KeyboardInterrupt as error:
                interruption = error

    def _mine(self) -> bool:
        return self._owner == threading.get_ident()


WARP_LOCK = WarpLock()
if hasattr(os, "register_at_fork"):  # a child forked in the middle of a capture could never end it
    os.register_at_fork(
        before=WARP_LOCK.__enter__, after_in_parent=WARP_LOCK.__exit__, after_in_child=WARP_LOCK.__exit__
    )
