"""Functions of time in pieces: what all signals have in common, and values from outside.

Every signal is reduced to breaks t_0 < ... < t_n and coefficients c (n, 8): on piece i

    s(t) = sum_k c[i, k] (t - t_i)^k,     t_i <= t < t_(i+1);

the last piece extends to infinity; before t_0 the value at t_0 applies. Drives need the antiderivative of a velocity,
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

TERMS = 8  # coefficients of a piece: degree up to 7
SAMPLES = 9  # evaluation points per piece


@named_arguments
class Signal:
    """A function of time [s]; call it with a time or an array of times.

    A user-defined signal is a subclass with `polynomial`. `covers`: first and last time [s] of its range; a run beyond
    it is refused.
    """

    covers: tuple[float, float] = (-np.inf, np.inf)

    def polynomial(self) -> tuple[np.ndarray, np.ndarray]:
        """Breaks (n+1,) [s] and coefficients (n, 8) in ascending powers of (t - breaks[i]); see the module."""
        raise TypeError(f"{type(self).__name__} does not define its pieces")

    def samples(self, begin: float = -np.inf, end: float = np.inf) -> tuple[np.ndarray, np.ndarray]:
        """Values and slopes [1/s], both (pieces, SAMPLES), at equidistant times of each piece that overlaps `begin` to
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
        found = Polynomial(breaks, c * require_number(factor, "signal: factor"))
        found.covers = self.covers
        return found

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
        moved[0] = shifted(c[first], -breaks[first])
        ends = breaks[first + 1 :] if breaks[first + 1] > 0.0 else np.array([1.0])
        return np.concatenate([[0.0], ends]), moved


def shifted(c: np.ndarray, d: float) -> np.ndarray:
    """Coefficients about an origin shifted by `d`: sum_k c_k (x + d)^k by the binomial theorem."""
    out = np.zeros_like(c)
    for k in range(TERMS):
        for j in range(k + 1):
            out[j] += c[k] * comb(k, j) * d ** (k - j)
    return out


@named_arguments
class Polynomial(Signal):
    """A signal given by its pieces: `breaks` (n+1,) [s] increasing, `coefficients` (n, up to 8) of powers of t - break,
    in units of the quantity over s^k. Raises `InputError` for breaks that do not increase and inconsistent shapes."""

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

    def __call__(self, t: float | Vector) -> np.ndarray:
        return np.zeros(np.shape(t)) + self.value


@named_arguments
class FromInput(Signal):
    """`factor` times the `source`, an `Input`, integrated `integrals` times from t = 0."""

    def __init__(self, source: Input, factor: float, integrals: int) -> None:
        self.source, self.factor, self.integrals = source, factor, integrals

    def polynomial(self) -> tuple[np.ndarray, np.ndarray]:
        return self.following(Constant(self.source.initial)).polynomial()

    def following(self, values: Signal) -> Signal:
        """The signal if the input takes these `values` [its unit] over time."""
        for _ in range(self.integrals):
            values = values.integral()
        return values.scaled(self.factor)

    def integral(self) -> FromInput:
        """The antiderivative that is zero at t = 0."""
        return FromInput(self.source, self.factor, self.integrals + 1)

    def scaled(self, factor: float) -> Signal:
        """The signal times a `factor` [-]; a constant where that is zero, so that nothing follows the input there."""
        whole = self.factor * require_number(factor, "signal: factor")
        return FromInput(self.source, whole, self.integrals) if whole else Constant(0.0)

    def describe(self) -> dict[str, Any]:
        """Plain data that define the signal, for hashing."""
        found = {"input": self.source.name, "factor": self.factor, "integrals": self.integrals}
        return {**found, "initial": self.source.initial}


@named_arguments
class Input(FromInput):
    """A value from outside, called `name`, that a `Simulation` sets between its steps; everywhere else it keeps its
    `initial` value [unit of the quantity].

    A value that is set at a time t is reached at the end of the step that begins there, linearly, also within halved
    steps, and then holds. unit: of the value, as text. Usable wherever a signal is; one Input may be used several
    times. Raises `InputError`.

    >>> torque = wf.signals.Input("motor torque", unit="N m")
    >>> float(torque(0.5))
    0.0
    """

    def __init__(self, name: str, initial: float = 0.0, *, unit: str = "") -> None:
        if not isinstance(name, str) or not name:
            raise InputError(f"Input: name must be a text that is not empty, got {name!r}")
        if not isinstance(unit, str):
            raise InputError(f"Input {name!r}: unit must be a text, got {unit!r}")
        super().__init__(self, 1.0, 0)
        self.name, self.unit = name, unit
        self.initial = require_number(initial, f"Input {name!r}: initial")


def require_fixed(signal: Signal, label: str) -> Signal:
    """`signal`, whose pieces are used once; raises `InputError` for one that depends on an `Input`."""
    if isinstance(signal, FromInput):
        raise InputError(
            f"{label} cannot depend on the Input {signal.source.name!r}: it is evaluated once, before the run; give a "
            "signal of time, and let forces and drives have the Input"
        )
    return signal


SignalLike: TypeAlias = Signal | float  # a number is a constant signal


def as_signal(value: Any, name: str) -> Signal:
    """`value` itself if it is a signal, a `Constant` if it is a number, else `InputError` naming `name`."""
    if isinstance(value, Signal):
        return value
    if isinstance(value, type) and issubclass(value, Signal):
        raise InputError(f"{name} is the class {value.__name__}; create an instance, signals.{value.__name__}(...)")
    if isinstance(value, (str, bytes)) or callable(value) or np.ndim(value):
        raise InputError(f"{name} must be a number or a signal, got {value!r}; {_cure(value)}")
    return Constant(require_number(value, name))


def _cure(value: Any) -> str:
    """Advice how to specify a function of time that was given as `value`."""
    if callable(value):
        return (
            "a function of time is sampled into a table, signals.Table(times, [f(t) for t in times], cubic=True), or "
            "is one of signals.Sine, Chirp, Harmonics, Ramp, SmoothStep, Polynomial"
        )
    if isinstance(value, (str, bytes)):
        return "signals are objects, signals.Table(times, values), signals.Ramp(0.0, 1.0, duration=0.1)"
    return "values over time are signals.Table(times, values)"
