"""Processes of this machine, of which files tell."""

from __future__ import annotations

import os
from typing import IO

try:
    import fcntl
except ImportError:  # without it two processes that write one thing are not told apart
    fcntl = None


def lives(process: int) -> bool:
    """Whether a process of that number runs on this machine, as far as can be told without touching it."""
    if os.name != "posix":  # there a signal of 0 is one that ends a process
        return True
    try:
        os.kill(process, 0)
    except ProcessLookupError:
        return False
    except (OSError, OverflowError):  # it is another user's, or no number of a process
        return True
    return True


def locked(stream: IO[str]) -> bool:
    """Lock an open file that no other process has locked, until it is closed; whether that was so."""
    if fcntl is None:
        return True
    try:
        fcntl.flock(stream, fcntl.LOCK_EX | fcntl.LOCK_NB)
    except OSError:
        return False
    return True
