"""What is kept of a run: histories and fields by their names, the same taken over time, or what a function says.

    contact_force_z[lower-upper]          the history, with the times of the run
    max(contact_peak_pressure[lower-upper])   its largest value
    last(contact_pressure[lower-upper])   a field at the last saved step

Names are those of `Result.to_dataframe`; a name without its component stands for all of them, and fields over places
have their names of the results file (`output/files/quantities.py`). Over time:

    max, min, first, last   of each entry             range       max - min
    mean                    (1/T) int v dt            amplitude   range / 2
    rms                     sqrt((1/T) int v^2 dt)

integrals by the trapezoidal rule over the T seconds that are saved; of a single saved step v itself. Entries that are
NaN at some times, as what a pair has only while it touches, are left out of max and min, and make a mean NaN.
"""

from __future__ import annotations

import re
import warnings
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np

from warpffrf.model.errors import InputError, unknown_name
from warpffrf.output.files.quantities import quantity
from warpffrf.study.sweeps.functions import word_of

TIME = "time"
MOST_AXES = 64  # of an array of NumPy
CALL = re.compile(r"\s*([A-Za-z_]\w*)\s*\((.*)\)\s*", re.DOTALL)


@dataclass(frozen=True, eq=False)
class Value:
    """What an output of one run is: an array, the names of its axes (`time` first where it has one), unit and frame."""

    array: np.ndarray
    dims: tuple[str, ...] = ()
    units: str = ""
    frame: str = ""


def _mean(time: np.ndarray, values: np.ndarray) -> np.ndarray:
    if len(time) < 2:
        return values[-1]
    return np.trapezoid(values, time, axis=0) / (time[-1] - time[0])


def _of_finite(take: Callable[..., np.ndarray]) -> Callable[[np.ndarray, np.ndarray], np.ndarray]:
    def found(time: np.ndarray, values: np.ndarray) -> np.ndarray:
        with warnings.catch_warnings():
            warnings.filterwarnings("ignore", message="All-NaN")  # never there: NaN says so
            return take(values, axis=0)

    return found


_largest, _least = _of_finite(np.nanmax), _of_finite(np.nanmin)


def _range(time: np.ndarray, values: np.ndarray) -> np.ndarray:
    return _largest(time, values) - _least(time, values)


REDUCTIONS: dict[str, Callable[[np.ndarray, np.ndarray], np.ndarray]] = {
    "max": _largest,
    "min": _least,
    "mean": _mean,
    "first": lambda time, values: values[0],
    "last": lambda time, values: values[-1],
    "rms": lambda time, values: np.sqrt(_mean(time, values**2)),
    "range": _range,
    "amplitude": lambda time, values: 0.5 * _range(time, values),
}


@dataclass(frozen=True)
class Named:
    """A quantity by its name, over time by `reduction`, or with its times where that is ""."""

    text: str
    quantity: str
    reduction: str

    def of(self, name: str, result: Any) -> Value:
        """The value in a run. Raises `NoQuantity` where the run does not have it."""
        found = quantity(result, self.quantity)
        if not self.reduction:
            return Value(found.values, (TIME, *found.dims), found.units, found.frame)
        if not len(result.time):
            return Value(np.full(found.values.shape[1:], np.nan), found.dims, found.units, found.frame)
        array = REDUCTIONS[self.reduction](result.time, np.asarray(found.values, dtype=float))
        return Value(np.asarray(array, dtype=float), found.dims, found.units, found.frame)


@dataclass(frozen=True)
class Asked:
    """What a function of the user, called `title`, makes of a result: a number or an array."""

    title: str
    function: Callable[[Any], Any]

    @property
    def text(self) -> str:
        """The name with a word for what the function does, by which a sweep that goes on tells another one."""
        return f"{self.title}, code {word_of(self.function)}"

    def of(self, name: str, result: Any) -> Value:
        """The value in a run. Raises `InputError` where the function gives neither a number nor an array of them."""
        given = self.function(result)
        try:
            array = np.asarray(given, dtype=float)
        except (TypeError, ValueError):
            raise InputError(f"output {name!r}: {self.title} must give a number or an array, got {given!r}") from None
        return Value(array, axes_of_function(name, array.ndim))


def axes_of_function(name: str, count: int) -> tuple[str, ...]:
    """What the axes of an array are called that a function gives for output `name`."""
    return tuple(f"{name}[{n}]" for n in range(count))


Output = Named | Asked


def outputs_of(given: Any, taken: Sequence[str]) -> dict[str, Output]:
    """The outputs, by name, that are `given` as {name: text or function} or as a list of texts; `taken`: names that
    stand for something else. Raises `InputError`."""
    if isinstance(given, str):
        given = [given]
    if not isinstance(given, Mapping):
        if not isinstance(given, Sequence) or not all(isinstance(one, str) for one in given):
            raise InputError(f"sweep: outputs must be {{name: text or function}}, or a list of texts, got {given!r}")
        given = {one: one for one in given}
    if not given:
        raise InputError("sweep: no output is asked for; give for example outputs=['max(energy[kinetic])']")
    found: dict[str, Output] = {}
    for name, what in given.items():
        if not isinstance(name, str) or not name or "/" in name or name in (".", ".."):
            raise InputError(f"sweep: {name!r} is no name of an output; give it another one, {{name: what}}")
        if name in taken:
            raise InputError(f"sweep: an output cannot be called {name!r}, which the table has already; rename it")
        if isinstance(what, str):
            found[name] = _named(name, what)
        elif callable(what):
            found[name] = Asked(getattr(what, "__name__", type(what).__name__) + "()", what)
        else:
            raise InputError(f"sweep: output {name!r} must be a text or a function of a result, got {what!r}")
    axes = {
        axis: name
        for name, one in found.items()
        if isinstance(one, Asked)
        for axis in axes_of_function(name, MOST_AXES)
    }
    for name in (*found, *taken):
        if name in axes:
            raise InputError(f"sweep: {name!r} is what an axis of output {axes[name]!r} is called; rename one of them")
    return found


def _named(name: str, text: str) -> Named:
    call = CALL.fullmatch(text)
    if call is None:
        return Named(text, text.strip(), "")
    if call[1] not in REDUCTIONS:
        raise unknown_name(f"sweep: output {name!r}: over time", call[1], REDUCTIONS)
    return Named(text, call[2].strip(), call[1])
