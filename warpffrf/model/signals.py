"""Functions of time for drives and forces, all of them piecewise polynomials.

Every signal is reduced to breaks t_0 < ... < t_n and coefficients c (n, 8): on piece i

    s(t) = sum_k c[i, k] (t - t_i)^k,     t_i <= t < t_(i+1);

the last piece extends to infinity, before t_0 the value at t_0 holds. Drives need the antiderivative of a velocity,
which is exact in this form: S = sum_k c_k (t - t_i)^(k+1) / (k+1) + S(t_i). Degree 7 leaves room for two integrations
of the quintic smooth step 6 x^5 - 15 x^4 + 10 x^3, whose first and second derivatives vanish at both ends.
"""

from __future__ import annotations

from functools import cached_property
from math import comb
from typing import Any, TypeAlias

import numpy as np

from warpffrf.model.arguments import Matrix, Vector
from warpffrf.model.errors import InputError, require_array, require_number
from warpffrf.model.messages.named_arguments import named_arguments

__all__ = [
    "Constant",
    "Polynomial",
    "Ramp",
    "Signal",
    "SignalLike",
    "SmoothStep",
    "Table",
]


def __dir__() -> list[str]:
    return __all__


TERMS = 8  # coefficients of a piece: degree up to 7
SAMPLES = 9  # points of a piece where it is looked at


@named_arguments
class Signal:
    """A function of time [s]; call it with a time or an array of times."""

    def polynomial(self) -> tuple[np.ndarray, np.ndarray]:
        """Breaks (n+1,) [s] and coefficients (n, 8) in ascending powers of (t - breaks[i]); see the module."""
        raise TypeError(f"{type(self).__name__} does not say what its pieces are")

    def samples(self, begin: float = -np.inf, end: float = np.inf) -> tuple[np.ndarray, np.ndarray]:
        """Values and slopes [1/s], both (pieces, SAMPLES), at even times of each piece that reaches into `begin` to
        `end` [s]."""
        breaks, c = self._pieces
        inside = (breaks[1:] > begin) & (breaks[:-1] < end)
        x = np.diff(breaks)[inside][:, None, None] * np.linspace(0.0, 1.0, SAMPLES)[:, None]
        powers = np.arange(TERMS)
        terms = c[inside][:, None]
        return (terms * x**powers).sum(axis=-1), ((terms * powers)[..., 1:] * x ** powers[:-1]).sum(axis=-1)

    @cached_property
    def _pieces(self) -> tuple[np.ndarray, np.ndarray]:
        return self.polynomial()

    def __call__(self, t: float | Vector) -> np.ndarray:
        """Value at times `t` [s], any shape."""
        breaks, c = self._pieces
        t = np.asarray(t, dtype=np.float64)
        piece = np.clip(np.searchsorted(breaks, t, side="right") - 1, 0, len(c) - 1)
        tau = np.maximum(t - breaks[piece], 0.0)
        value = np.zeros_like(tau)
        for k in reversed(range(TERMS)):
            value = value * tau + c[piece, k]
        return value

    def integral(self) -> Polynomial:
        """The antiderivative that is zero at t = 0, for t >= 0. Raises `InputError` above degree 6."""
        breaks, c = self._from_zero()
        if np.any(c[:, -1] != 0.0):
            raise InputError(f"signal: a polynomial of degree {TERMS - 1} cannot be integrated once more")
        C = np.zeros_like(c)
        C[:, 1:] = c[:, :-1] / np.arange(1, TERMS)
        for i in range(1, len(C)):
            C[i, 0] = np.polynomial.polynomial.polyval(breaks[i] - breaks[i - 1], C[i - 1])
        return Polynomial(breaks, C)

    def scaled(self, factor: float) -> Signal:
        """The signal times a `factor` [-]."""
        breaks, c = self._pieces
        return Polynomial(breaks, c * require_number(factor, "signal: factor"))

    def describe(self) -> dict[str, Any]:
        """Plain numbers that define the signal, for hashing."""
        breaks, c = self._pieces
        return {"breaks": breaks.tolist(), "coefficients": c.tolist()}

    def _from_zero(self) -> tuple[np.ndarray, np.ndarray]:
        """The same function for t >= 0 with the first break at 0."""
        breaks, c = self._pieces
        if breaks[0] > 0.0:
            held = np.zeros((1, TERMS))
            held[0, 0] = c[0, 0]
            return np.concatenate([[0.0], breaks]), np.concatenate([held, c])
        first = int(np.clip(np.searchsorted(breaks, 0.0, side="right") - 1, 0, len(c) - 1))
        moved = c[first:].copy()
        moved[0] = _shifted(c[first], -breaks[first])
        ends = breaks[first + 1 :] if breaks[first + 1] > 0.0 else np.array([1.0])
        return np.concatenate([[0.0], ends]), moved


def _shifted(c: np.ndarray, d: float) -> np.ndarray:
    """Coefficients about an origin moved by `d`: sum_k c_k (x + d)^k by the binomial theorem."""
    out = np.zeros_like(c)
    for k in range(TERMS):
        for j in range(k + 1):
            out[j] += c[k] * comb(k, j) * d ** (k - j)
    return out


@named_arguments
class Polynomial(Signal):
    """A signal given by its pieces: `breaks` (n+1,) [s] increasing, `coefficients` (n, up to 8) of powers of t - break,
    in units of the quantity over s^k. Raises `InputError` for breaks that do not increase and shapes that do not
    fit."""

    def __init__(self, breaks: Vector, coefficients: Matrix) -> None:
        self.breaks = require_array(breaks, "signal: breaks", (None,))
        given = require_array(coefficients, "signal: coefficients", (len(self.breaks) - 1, None))
        if len(given) < 1 or given.shape[1] > TERMS:
            raise InputError(f"signal: at least one piece of at most {TERMS} coefficients, got {given.shape}")
        if np.any(np.diff(self.breaks) <= 0.0):
            raise InputError("signal: breaks must increase")
        self.coefficients = np.zeros((len(given), TERMS))
        self.coefficients[:, : given.shape[1]] = given

    def polynomial(self) -> tuple[np.ndarray, np.ndarray]:
        return self.breaks, self.coefficients


@named_arguments
class Constant(Signal):
    """The same value at all times."""

    def __init__(self, value: float) -> None:
        self.value = require_number(value, "constant: value")

    def polynomial(self) -> tuple[np.ndarray, np.ndarray]:
        c = np.zeros((1, TERMS))
        c[0, 0] = self.value
        return np.array([0.0, 1.0]), c


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
    """Linear from `start_value` to `end_value` [unit of what it drives] within `duration` after `delay` [s], constant
    before and after."""

    shape = (1.0,)


class SmoothStep(_Transition):
    """Quintic 6 x^5 - 15 x^4 + 10 x^3 from `start_value` to `end_value` [unit of what it drives], x = (t -
    delay)/duration with duration and delay [s]; twice differentiable.

    >>> round(float(wf.signals.SmoothStep(0.0, 100.0, duration=0.02)(0.01)), 3)  # half-way at half of the time
    50.0
    """

    shape = (0.0, 0.0, 10.0, -15.0, 6.0)


@named_arguments
class Table(Signal):
    """Values at increasing times [s], joined linearly or by a cubic spline; the end values hold outside.

    A run that goes beyond the times is refused unless `hold` says that the end values are meant to hold there.
    The spline has zero slope at both ends, so that it meets the held values without a kink. Raises `InputError` for NaN
    or infinite entries, naming the first.

    >>> load = wf.signals.Table([0.0, 0.1, 0.3], [0.0, 500.0, 500.0])  # s, N
    >>> float(load(0.05))
    250.0
    """

    def __init__(self, times: Vector, values: Vector, *, cubic: bool = False, hold: bool = False) -> None:
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
        self.cubic, self.hold = bool(cubic), bool(hold)

    def polynomial(self) -> tuple[np.ndarray, np.ndarray]:
        t, v = self.times, self.values
        c = np.zeros((len(t), TERMS))
        c[:, 0] = v
        if self.cubic:
            from scipy.interpolate import CubicSpline

            c[:-1, :4] = CubicSpline(t, v, bc_type="clamped").c[::-1].T
        else:
            c[:-1, 1] = np.diff(v) / np.diff(t)
        return np.append(t, 2.0 * t[-1] - t[-2]), c

    def scaled(self, factor: float) -> Table:
        """The table with its values times `factor`; still a table, so that a time it does not cover is noticed."""
        return Table(self.times, factor * self.values, cubic=self.cubic, hold=self.hold)


SignalLike: TypeAlias = Signal | float  # a number stands for itself at all times


def as_signal(value: Any, name: str) -> Signal:
    """`value` itself if it is a signal, a `Constant` if it is a number, else `InputError` naming `name`."""
    if isinstance(value, Signal):
        return value
    if isinstance(value, type) and issubclass(value, Signal):
        raise InputError(f"{name} is the class {value.__name__}; make a signal of it, signals.{value.__name__}(...)")
    if isinstance(value, (str, bytes)) or callable(value) or np.ndim(value):
        raise InputError(f"{name} must be a number or a signal, got {value!r}; {_cure(value)}")
    return Constant(require_number(value, name))


def _cure(value: Any) -> str:
    """How to say a function of time that came as `value`."""
    if callable(value):
        return (
            "a function of time is sampled into a table, signals.Table(times, [f(t) for t in times], cubic=True), or "
            "is one of signals.Ramp, SmoothStep, Polynomial"
        )
    if isinstance(value, (str, bytes)):
        return "signals are objects, signals.Table(times, values), signals.Ramp(0.0, 1.0, duration=0.1)"
    return "values over time are signals.Table(times, values)"
