"""How many threads share work that NumPy does outside the interpreter's lock.

The threads of a BLAS spin while they wait for each other: on a machine that others use too they made a factorisation
eight times slower. Here a BLAS has one thread, and whole tasks (blocks of loads, subtrees of an elimination) are given
to threads of our own, which nothing but the end of the work joins.
"""

from __future__ import annotations

import os

MOST = 16  # tasks are few and large; more threads would wait for memory


def worker_count() -> int:
    """Processors that this process may use, at most `MOST`."""
    if hasattr(os, "sched_getaffinity"):
        available = len(os.sched_getaffinity(0))
    else:
        available = os.cpu_count() or 1
    return max(1, min(available, MOST))
