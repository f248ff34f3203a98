"""Functions of time for drives and forces, all in piecewise polynomials (`warpffrf.model.pieces`).

Sines of an angle are not polynomials. They are represented by quintic pieces that match value, slope and curvature at
both ends, so that the signal is twice differentiable; the error of a piece of length h is max |s^(6)| h^6/46080. Pieces
are halved until the error is below TOLERANCE of the amplitude: 32 pieces per period of a sine.
"""

from __future__ import annotations

import os
from pathlib import Path
from typing import Any

import numpy as np

from warpffrf.model.arguments import Matrix, Vector
from warpffrf.model.errors import InputError, require_array, require_number, unknown_name
from warpffrf.model.files.paths import read_named
from warpffrf.model.messages.named_arguments import named_arguments
from warpffrf.model.pieces import TERMS, Constant, Input, Polynomial, Signal, SignalLike, as_signal, require_fixed

__all__ = [
    "Chirp",
    "Constant",
    "Harmonics",
    "Input",
    "Polynomial",
    "Ramp",
    "Signal",
    "SignalLike",
    "Sine",
    "SmoothStep",
    "Step",
    "Table",
    "from_csv",
    "short_path",
]


def __dir__() -> list[str]:
    return __all__


TOLERANCE = 2e-9  # of the sum of the amplitudes: error of the pieces of a sine
FIRST = 0.25 * np.pi  # rad of the highest order, of pieces that are then halved
MOST_PIECES = 1 << 18  # of a signal: 16 MiB of coefficients
CYCLE = 1e-9  # of a period: the last time of a table that is this near to its end is the end


@named_arguments
class _Transition(Signal):
    """From one value to another within `duration` after `delay` [s]; shapes differ in their polynomial in x in [0,
    1]."""

    shape: tuple[float, ...]  # coefficients of x, x^2, ...

    def __init__(self, start_value: float, end_value: float, *, duration: float, delay: float = 0.0) -> None:
        label = type(self).__name__
        self.start_value = require_number(start_value, f"{label}: start_value")
        self.end_value = require_number(end_value, f"{label}: end_value")
        self.duration = require_number(duration, f"{label}: duration", positive=True)
        self.delay = require_number(delay, f"{label}: delay", non_negative=True)
        shortest, most = self.duration ** len(self.shape), max(map(abs, self.shape))
        if shortest == 0.0 or not np.isfinite((self.end_value - self.start_value) * most / shortest):
            raise InputError(f"{label}: duration {self.duration:g} s is too short to be computed with; make it longer")

    def polynomial(self) -> tuple[np.ndarray, np.ndarray]:
        T = self.duration
        c = np.zeros((2, TERMS))
        c[0, 0], c[1, 0] = self.start_value, self.end_value
        for k, a in enumerate(self.shape, start=1):
            c[0, k] = (self.end_value - self.start_value) * a / T**k
        return self.delay + T * np.arange(3.0), c


class Ramp(_Transition):
    """Linear from `start_value` to `end_value` [unit of the driven quantity] within `duration` after `delay` [s],
    constant before and after."""

    shape = (1.0,)


class SmoothStep(_Transition):
    """Quintic 6 x^5 - 15 x^4 + 10 x^3 from `start_value` to `end_value` [unit of the driven quantity], x = (t -
    delay)/duration with duration and delay [s]; twice differentiable.

    >>> round(float(wf.signals.SmoothStep(0.0, 100.0, duration=0.02)(0.01)), 3)  # half-way at half of the time
    50.0
    """

    shape = (0.0, 0.0, 10.0, -15.0, 6.0)


@named_arguments
class Table(Signal):
    """Values at increasing times [s], joined linearly or by a cubic spline; the end values hold outside.

    A run beyond these times is refused unless `hold` is set, with which the end values apply there. The spline has zero
    slope at both ends and so continues into the held values without a kink. period, duration: both [s], for one cycle
    of a periodic quantity: from any time to that time plus `period` it is the same, until `duration`. The value at the
    end of a cycle is the first one, whether the table has it or not. Raises `InputError` for NaN or infinite entries,
    naming the first.

    >>> load = wf.signals.Table([0.0, 0.1, 0.3], [0.0, 500.0, 500.0])  # s, N
    >>> float(load(0.05))
    250.0
    >>> pulses = wf.signals.Table([0.0, 0.1, 0.3], [0.0, 500.0, 500.0], period=0.4, duration=2.0)
    >>> round(float(pulses(1.25)), 6)  # as at 0.05 s
    250.0
    """

    def __init__(
        self,
        times: Vector,
        values: Vector,
        *,
        cubic: bool = False,
        hold: bool = False,
        period: float | None = None,
        duration: float | None = None,
    ) -> None:
        for label, entries in (("times", times), ("values", values)):
            try:
                array = np.asarray(entries, dtype=np.float64)
            except (TypeError, ValueError):
                raise InputError(f"signal table: {label} must be numbers, got {entries!r}") from None
            bad = np.flatnonzero(~np.isfinite(array))
            if len(bad):
                raise InputError(f"signal table: {label}[{bad[0]}] is {array.ravel()[bad[0]]}, numbers must be finite")
        self.times = require_array(times, "signal table: times", (None,))
        if len(self.times) < 2:
            raise InputError("signal table: at least two times are needed; for one value use a number")
        self.values = require_array(values, "signal table: values", (len(self.times),))
        if np.any(np.diff(self.times) <= 0.0):
            at = int(np.flatnonzero(np.diff(self.times) <= 0.0)[0])
            raise InputError(f"signal table: times must increase, times[{at + 1}] does not")
        self.cubic, self.hold, self.period = bool(cubic), bool(hold), period
        if period is not None:
            self._repeat(duration)
        elif duration is not None:
            raise InputError("signal table: duration is of a table that repeats; give its period too")
        elif not self.hold:
            self.covers = float(self.times[0]), float(self.times[-1])

    def _repeat(self, duration: float | None) -> None:
        """Extend the table by its cycles from zero or before to `duration` [s]."""
        P = self.period = require_number(self.period, "signal table: period", positive=True)
        if duration is None:
            raise InputError("signal table: a table with a period needs the duration [s] for which it repeats")
        end = require_number(duration, "signal table: duration", positive=True)
        t, v = self.times, self.values
        if t[-1] - t[0] > P * (1.0 + CYCLE):
            raise InputError(f"signal table: its times span {t[-1] - t[0]:g} s, more than the period of {P:g} s")
        cycle = t - t[0] < P * (1.0 - CYCLE)
        t, v = t[cycle], v[cycle]
        first, last = np.floor(min(-t[0] / P, 0.0)), np.ceil(max((end - t[0]) / P, 1.0))
        if (last - first) * len(t) > MOST_PIECES:
            raise InputError(f"signal table: {end:g} s require more than {MOST_PIECES} pieces; shorten duration")
        shifts = P * np.arange(first, last)
        self.times = np.append((shifts[:, None] + t).ravel(), t[0] + P * last)
        self.values = np.append(np.tile(v, len(shifts)), v[0])
        self.covers = (-np.inf, np.inf if self.hold else end)

    def polynomial(self) -> tuple[np.ndarray, np.ndarray]:
        t, v = self.times, self.values
        c = np.zeros((len(t), TERMS))
        c[:, 0] = v
        if self.cubic:
            from scipy.interpolate import CubicSpline

            ends = "clamped" if self.period is None else "periodic"
            c[:-1, :4] = CubicSpline(t, v, bc_type=ends).c[::-1].T
        else:
            c[:-1, 1] = np.diff(v) / np.diff(t)
        return np.append(t, 2.0 * t[-1] - t[-2]), c


@named_arguments
class Step(_Transition):
    """From `start_value` to `end_value` [unit of the driven quantity] at once, at the time `at` [s]."""

    shape = (0.0,)

    def __init__(self, start_value: float, end_value: float, *, at: float) -> None:
        super().__init__(start_value, end_value, duration=1.0, delay=at)

    def polynomial(self) -> tuple[np.ndarray, np.ndarray]:
        breaks, c = super().polynomial()
        return breaks - self.duration, c


@named_arguments
class Harmonics(Signal):
    """A Fourier series over an angle: mean + sum over n of cosines[n-1] cos(n angle) + sines[n-1] sin(n angle).

    angle: [rad], a signal of time, as `Ramp(0, 200, duration=1)` or the `position()` of a drive; duration [s]: time
    span of the representation, accurate to TOLERANCE (2e-9) of the sum of its amplitudes; a longer run is refused.
    Raises `InputError` where more than 262144 pieces are required.

    >>> mesh = wf.signals.Harmonics((0.0, 3.0), angle=wf.signals.Ramp(0, 6.0, duration=0.1), duration=0.1)
    >>> round(float(mesh(0.05)), 6)  # 3 cos(2 * 3 rad)
    2.880511
    """

    def __init__(
        self, cosines: Vector, sines: Vector = (), *, angle: SignalLike, duration: float, mean: float = 0.0
    ) -> None:
        label = type(self).__name__
        self.cosines = require_array(cosines, f"{label}: cosines", (None,))
        self.sines = require_array(sines, f"{label}: sines", (None,))
        self.angle = require_fixed(as_signal(angle, f"{label}: angle"), f"{label}: angle")
        self.duration = require_number(duration, f"{label}: duration", positive=True)
        self.mean = require_number(mean, f"{label}: mean")
        self.covers = (-np.inf, self.duration)

    def polynomial(self) -> tuple[np.ndarray, np.ndarray]:
        breaks, c = self.angle._from_zero()
        inner = breaks[(breaks > 0.0) & (breaks < self.duration)]
        ends = np.concatenate([[0.0], inner, [self.duration]])
        owner = np.minimum(np.arange(len(ends) - 1), len(c) - 1)
        orders = max(len(self.cosines), len(self.sines), 1)
        powers = np.arange(1, TERMS)
        fastest = np.sum(powers * np.abs(c[owner, 1:]) * np.diff(ends)[:, None] ** (powers - 1), axis=1)
        counts = np.maximum(np.ceil(fastest * np.diff(ends) * orders / FIRST - 1e-9), 1.0)
        self._require_few(float(counts.sum()))
        parts = [np.linspace(ends[i], ends[i + 1], int(n), endpoint=False) for i, n in enumerate(counts)]
        owner = np.repeat(owner, counts.astype(int))
        at = np.append(np.concatenate(parts), self.duration)
        pair = [np.pad(series, (0, orders - len(series))) for series in (self.cosines, self.sines)]
        allowed = TOLERANCE * float(np.hypot(*pair).sum())
        x = np.array([0.25, 0.5, 0.75])
        while True:
            self._require_few(len(owner))
            h = np.diff(at)
            left, right = self._at(at[:-1] - breaks[owner], c[owner]), self._at(at[1:] - breaks[owner], c[owner])
            found = _quintic(h, left, right)
            middle = (found[:, None] * (x * h[:, None])[..., None] ** np.arange(TERMS)).sum(axis=-1)
            exact = np.stack([self._at(at[:-1] + s * h - breaks[owner], c[owner])[0] for s in x], axis=1)
            coarse = np.abs(middle - exact).max(axis=1) > allowed
            if not coarse.any():
                return at, found
            at = np.sort(np.append(at, (at[:-1] + 0.5 * h)[coarse]))
            owner = np.repeat(owner, np.where(coarse, 2, 1))

    def _at(self, tau: np.ndarray, c: np.ndarray) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
        """The series (n,), its slope [1/s] and curvature [1/s^2], `tau` [s] into pieces `c` (n, 8) of the angle."""
        k = np.arange(TERMS)
        p = tau[:, None] ** k
        angle = (c * p).sum(axis=1)
        speed = (c[:, 1:] * k[1:] * p[:, :-1]).sum(axis=1)
        change = (c[:, 2:] * k[2:] * k[1:-1] * p[:, :-2]).sum(axis=1)
        value, first, second = np.full_like(tau, self.mean), np.zeros_like(tau), np.zeros_like(tau)
        for amplitudes, phase in ((self.cosines, 0.0), (self.sines, -0.5 * np.pi)):
            for n, amplitude in enumerate(amplitudes, start=1):
                value += amplitude * np.cos(n * angle + phase)
                first -= amplitude * n * np.sin(n * angle + phase)
                second -= amplitude * n**2 * np.cos(n * angle + phase)
        return value, first * speed, second * speed**2 + first * change

    def _require_few(self, pieces: float) -> None:
        if not pieces <= MOST_PIECES:
            raise InputError(
                f"{type(self).__name__}: {self.duration:g} s require more than {MOST_PIECES} pieces; shorten duration"
            )


def _quintic(h: np.ndarray, left: tuple[np.ndarray, ...], right: tuple[np.ndarray, ...]) -> np.ndarray:
    """Coefficients (n, 8) of pieces of length `h` (n,) with value, slope and curvature (n,) at both ends."""
    c = np.zeros((len(h), TERMS))
    c[:, 0], c[:, 1], c[:, 2] = left[0], left[1], 0.5 * left[2]
    D = right[0] - left[0] - h * (left[1] + 0.5 * h * left[2])
    E, F = h * (right[1] - left[1] - h * left[2]), h**2 * (right[2] - left[2])
    c[:, 3], c[:, 4], c[:, 5] = (
        (10.0 * D - 4.0 * E + 0.5 * F) / h**3,
        (-15.0 * D + 7.0 * E - F) / h**4,
        (6.0 * D - 3.0 * E + 0.5 * F) / h**5,
    )
    return c


@named_arguments
class Sine(Harmonics):
    """mean + amplitude sin(2 pi frequency t + phase) with frequency [Hz] and phase [rad], for `duration` [s]; a longer
    run is refused. Represented as `Harmonics`.

    >>> round(float(wf.signals.Sine(2.0, 50.0, duration=0.1)(0.005)), 6)
    2.0
    """

    def __init__(
        self, amplitude: float, frequency: float, *, duration: float, phase: float = 0.0, mean: float = 0.0
    ) -> None:
        self.amplitude, self.frequency, self.phase, series = _sine("Sine", amplitude, frequency, phase)
        angle = Polynomial([0.0, 1.0], [[0.0, 2.0 * np.pi * self.frequency]])
        super().__init__(*series, angle=angle, duration=duration, mean=mean)


@named_arguments
class Chirp(Harmonics):
    """mean + amplitude sin(angle + phase) with a frequency that changes linearly in time from `start_frequency` to
    `end_frequency` [Hz] within `duration` [s]; phase [rad]. A longer run is refused. Represented as `Harmonics`."""

    def __init__(
        self,
        amplitude: float,
        start_frequency: float,
        end_frequency: float,
        *,
        duration: float,
        phase: float = 0.0,
        mean: float = 0.0,
    ) -> None:
        self.amplitude, self.start_frequency, self.phase, series = _sine("Chirp", amplitude, start_frequency, phase)
        self.end_frequency = require_number(end_frequency, "Chirp: end_frequency [Hz]", non_negative=True)
        length = require_number(duration, "Chirp: duration", positive=True)
        change = np.pi * (self.end_frequency - self.start_frequency) / length
        angle = Polynomial([0.0, length], [[0.0, 2.0 * np.pi * self.start_frequency, change]])
        super().__init__(*series, angle=angle, duration=length, mean=mean)


def _sine(label: str, amplitude: Any, frequency: Any, phase: Any) -> tuple[float, float, float, tuple[Any, Any]]:
    """Checked numbers, and the cosine and sine of the series of one order."""
    a = require_number(amplitude, f"{label}: amplitude")
    f = require_number(frequency, f"{label}: frequency [Hz]", non_negative=True)
    p = require_number(phase, f"{label}: phase [rad]")
    return a, f, p, ((a * np.sin(p),), (a * np.cos(p),))


@named_arguments
def from_csv(
    path: str | os.PathLike[str],
    *,
    time: int | str = 0,
    value: int | str = 1,
    time_factor: float = 1.0,
    factor: float = 1.0,
    cubic: bool = False,
    hold: bool = False,
    period: float | None = None,
    duration: float | None = None,
) -> Table:
    """The `Table` of two columns of the text file `path`: times [s] and values.

    time, value: the columns, numbers from 0, or names in the first line. time_factor, factor: what both columns are
    multiplied by, to have SI units: 1e-3 for a column in ms or mm, pi/30 for revolutions per minute, and 1/(6 n) for a
    column of angles [deg] at n revolutions per minute instead of times. Columns are separated by semicolons, commas or
    blanks; lines that begin with # are ignored. cubic, hold, period [s], duration [s]: as in `Table`. Raises
    `InputError` for a file that cannot be read, a missing column, and entries that are not numbers, with their line.
    """
    file = Path(path).expanduser()
    text = read_named(file, "from_csv: table").decode("utf-8-sig", errors="replace")
    lines = [(n, s) for n, s in enumerate(text.splitlines(), start=1) if s.strip() and not s.lstrip().startswith("#")]
    separator = next((s for s in ";," if lines and s in lines[0][1]), None)
    rows = [(number, [word.strip() for word in line.split(separator)]) for number, line in lines]
    names: list[str] = []
    if rows and not _is_number(rows[0][1][0]):
        names = rows.pop(0)[1]
    columns = []
    for label, given in (("time", time), ("value", value)):
        if isinstance(given, str) and given not in names:
            raise unknown_name(f"from_csv: {file.name!r}: {label}", given, names)
        columns.append(names.index(given) if isinstance(given, str) else given)
    found = np.zeros((2, len(rows)))
    for i, (number, words) in enumerate(rows):
        for k, column in enumerate(columns):
            if not 0 <= column < len(words) or not _is_number(words[column]):
                raise InputError(f"from_csv: {file.name!r}: line {number} has no number in column {column}")
            found[k, i] = float(words[column])
    found[0] *= require_number(time_factor, "from_csv: time_factor", positive=True)
    found[1] *= require_number(factor, "from_csv: factor")
    return Table(*found, cubic=cubic, hold=hold, period=period, duration=duration)


def _is_number(word: str) -> bool:
    try:
        float(word)
    except ValueError:
        return False
    return True


@named_arguments
def short_path(points: Matrix) -> np.ndarray:
    """An order (n,) of the `points` (n, k) of a spectrum, such as their forces, for load steps of `static`, which take
    fewer iterations if they are short: the first point, then always the nearest one that is left. Columns count by
    their range.

    Raises `InputError` for points that are no table of finite numbers, or none.

    >>> wf.signals.short_path([[0.0], [3.0], [1.0], [2.0]]).tolist()
    [0, 2, 3, 1]
    """
    table = require_array(points, "short_path: points", (None, None))
    if not len(table):
        raise InputError("short_path: points is empty; give at least one point")
    span = np.ptp(table, axis=0)
    scaled = table[:, span > 0.0] / span[span > 0.0]
    order, left = [0], np.arange(1, len(table))
    while len(left):
        nearest = int(np.argmin(np.sum((scaled[left] - scaled[order[-1]]) ** 2, axis=1)))
        order.append(int(left[nearest]))
        left = np.delete(left, nearest)
    return np.array(order)
