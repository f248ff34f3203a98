"""Times at which cycles begin and end, and what there is between saved steps."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from warpffrf.model.errors import InputError

SAME = 1e-9  # of the run: times that differ by less are one


def cycle_times(time: np.ndarray, cycles: float | Sequence[float] | np.ndarray, label: str) -> np.ndarray:
    """Begins and ends (n + 1,) [s] of n cycles: of a period [s] the whole ones from the first saved time on, else the
    times given. Raises `InputError`, naming `label`, for a period that is not positive or longer than the run, and
    times that do not ascend."""
    given = np.asarray(cycles, dtype=float)
    span = float(time[-1] - time[0]) if len(time) else 0.0
    if given.ndim == 0:
        period = float(given)
        if not np.isfinite(period) or period <= 0.0:
            raise InputError(f"{label}: the period of a cycle must be positive, got {period:g} s")
        count = int(np.floor(span / period * (1.0 + SAME)))
        if count < 1:
            raise InputError(f"{label}: a cycle of {period:g} s is longer than the {span:g} s that were saved")
        return np.minimum(time[0] + period * np.arange(count + 1), time[-1])
    if given.ndim != 1 or len(given) < 2 or not np.all(np.diff(given) > 0.0):
        raise InputError(f"{label}: give the period of a cycle, or ascending times at which cycles begin and end")
    return given


def value_at(time: np.ndarray, values: np.ndarray, at: np.ndarray, label: str) -> np.ndarray:
    """`values` (T, ...) at the times `at` (n,) [s], straight between saved steps: (n, ...). Raises `InputError`, naming
    `label`, for times outside of the run."""
    if not len(time):
        raise InputError(f"{label}: the run has no saved row")
    slack = SAME * max(float(time[-1] - time[0]), abs(float(time[-1])))
    if not np.all((at >= time[0] - slack) & (at <= time[-1] + slack)):
        raise InputError(
            f"{label}: the saved steps go from {time[0]:g} to {time[-1]:g} s, and "
            f"{', '.join(f'{t:g}' for t in np.ravel(at))} s are asked for"
        )
    if len(time) == 1:
        return np.repeat(values, len(at), axis=0)
    after = np.clip(np.searchsorted(time, at), 1, len(time) - 1)
    share = np.clip((at - time[after - 1]) / (time[after] - time[after - 1]), 0.0, 1.0)
    share = share.reshape(-1, *[1] * (values.ndim - 1))
    return values[after - 1] * (1.0 - share) + values[after] * share


def piece(time: np.ndarray, values: np.ndarray, begin: float, end: float, label: str) -> tuple[np.ndarray, np.ndarray]:
    """Times and `values` (T, ...) from `begin` to `end` [s], both among them, with the saved steps between."""
    ends = value_at(time, values, np.array([begin, end]), label)
    inside = (time > begin) & (time < end)
    return (
        np.concatenate([[begin], time[inside], [end]]),
        np.concatenate([ends[:1], values[inside], ends[1:]]),
    )
