"""Saved times that runs of different steps have in common; nothing is interpolated between saved steps.

With steps h_i all h_i = I/n_i for whole n_i, and rows are those at the times k I, k = 0, 1, ... The interval I is the
least multiple of the coarsest step that all steps divide, times a whole number where that would save more than
MOST_ROWS rows.
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from warpffrf.model.errors import InputError

MOST_ROWS = 200  # pressure fields of more would say no more of an error, and fill a folder
MOST_MULTIPLES = 1000  # of the coarsest step, in search of one that all steps divide
WHOLE = 1e-9  # relative: steps are written as decimals, and their ratios are whole to round-off
SAME = 1e-6  # of the interval: times of a run are sums of steps, or products, to round-off


def divides(step: float, interval: float) -> bool:
    """Whether `interval` [s] is a whole number of steps of `step` [s]."""
    count = interval / step
    return round(count) >= 1 and abs(count - round(count)) <= WHOLE * count


def common_interval(steps: Sequence[float], duration: float) -> float:
    """The interval [s] of the rows of runs with `steps` [s] over `duration` [s]. Raises `InputError` for steps that
    have none in common, and for a duration that is shorter than it."""
    coarsest = max(steps)
    for n in range(1, MOST_MULTIPLES + 1):
        if all(divides(step, n * coarsest) for step in steps):
            break
    else:
        shown = ", ".join(f"{step:g}" for step in sorted(set(steps), reverse=True))
        raise InputError(
            f"speed_error: the steps {shown} s have no times in common within {MOST_MULTIPLES} of the coarsest; take "
            "steps in ratios of small whole numbers, such as halves"
        )
    interval = n * coarsest
    if interval > duration * (1.0 + WHOLE):
        raise InputError(
            f"speed_error: the steps meet only every {interval:g} s, which is longer than the run of {duration:g} s; "
            "take steps in ratios of small whole numbers, or a longer run"
        )
    rows = int(np.floor(duration / interval + SAME))
    return interval * max(1, -(-rows // MOST_ROWS))


def check_interval(interval: float, steps: Sequence[float], duration: float) -> float:
    """`interval` as given by the user; raises `InputError` where a step does not divide it or the run is shorter."""
    for step in steps:
        if not divides(step, interval):
            raise InputError(
                f"speed_error: saved_every {interval:g} s is no whole number of steps of {step:g} s; give a multiple "
                "of all steps"
            )
    if interval > duration * (1.0 + WHOLE):
        raise InputError(f"speed_error: saved_every {interval:g} s is longer than the run of {duration:g} s")
    return interval


def saved_times(interval: float, duration: float) -> np.ndarray:
    """(T,) s from the start of a run, the common times."""
    return interval * np.arange(int(np.floor(duration / interval + SAME)) + 1)


def common_rows(time: np.ndarray, interval: float, duration: float) -> np.ndarray | None:
    """Rows (T,) of a run's `time` (n,) [s] that stand at the common times; None where one is missing."""
    wanted = saved_times(interval, duration)
    if not len(time):
        return None
    since = np.asarray(time) - time[0]
    at = np.clip(np.searchsorted(since, wanted - SAME * interval), 0, len(since) - 1)
    return at if np.all(np.abs(since[at] - wanted) <= SAME * interval) else None
