"""Processes of this machine, of which files tell."""

from __future__ import annotations

import os


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
