r"""Interface of a curve of pressure against depth.

p = P(d) rises from zero at the depth `begins`, negative for a layer that acts at a distance, and stores the energy W(d)
= int P dd. The separated solver requires the inverse y = P^-1, evaluated on the device by the *form* of the curve and
its numbers (`warpffrf_kernels.layers.layer_laws.FORMS`). Checks on the host and references of the tests use the methods
below, which share no code with the device. P must rise strictly, with a slope that is nowhere zero: curves whose slope
would vanish at touch are shifted by a negligible depth, which their description states.

Straight. A straight line through touch, p = k d, with the constant compliance 1/k.

Power. The power of a depth, p = k d^n, with a slope that does not vanish at touch.

For n > 1 the slope n k d^(n-1) is zero at d = 0: the inverse y(p) = (p/k)^(1/n) has an infinite one there, which no
compliance can represent. The power is taken of a depth that begins at `SHIFT` instead,

    P(d) = k [(d + e)^n - e^n],      e = SHIFT,
    W(d) = k {[(d + e)^(n+1) - e^(n+1)]/(n + 1) - e^n d},
    y(p) = (p/k + e^n)^(1/n) - e,    y' = (p/k + e^n)^(1/n - 1)/(n k),

which differs from k d^n by the fraction n e/d: 1.5e-6 at a depth of a micrometre and n = 1.5. At n = 1 it is k d.

Exponential. An exponential of the gap, cut off: p = p_0 exp(-g/lambda) from the gap g = `end` inwards.

The curve is shifted to zero at its end,

    P(d) = p_0 [exp(d/lambda) - eps],      eps = exp(-end/lambda),
    W(d) = lambda P(d) - p_0 eps (end + d),
    y(p) = lambda ln(p/p_0 + eps),         y' = lambda/(p + p_0 eps),

so that the pressure errs by eps p_0.

Table. Points with straight pieces between them: pressure, slope and energy follow from the table alone, without
overshoot. The last piece is extrapolated.
"""

from __future__ import annotations

from abc import ABC, abstractmethod
from typing import Any, ClassVar

import numpy as np

from warpffrf.model.errors import InputError, require_number


class Curve(ABC):
    """A curve p = P(d). Depths d [m] of any shape; below `begins` there is no pressure.

    form: its name on the device. compliance [m/Pa]: of a straight line through touch, which is constant and part of
    the bodies' compliance; 0 of all others. e_folding [m]: the depth over which the pressure grows by the
    factor e, of exponential curves; else 0. convex: whether its slope never decreases.
    """

    form: ClassVar[str]
    compliance: float = 0.0
    e_folding: float = 0.0
    convex: bool = True

    @property
    def begins(self) -> float:
        """The depth [m] from which on there is a pressure."""
        return 0.0

    @property
    def numbers(self) -> tuple[float, ...]:
        """Parameters of the form on the device, in its order."""
        return ()

    @property
    def table(self) -> np.ndarray:
        """Depth [m], pressure [Pa] and energy [J/m^2] (n, 3) of a tabulated curve, of others none."""
        return np.zeros((0, 3))

    @abstractmethod
    def pressure(self, depth: Any) -> np.ndarray:
        """P [Pa]."""

    @abstractmethod
    def slope(self, depth: Any) -> np.ndarray:
        """P' [Pa/m]; 0 up to `begins`."""

    @abstractmethod
    def energy(self, depth: Any) -> np.ndarray:
        """W [J/m^2]."""

    @abstractmethod
    def yielding(self, pressure: Any) -> tuple[np.ndarray, np.ndarray]:
        """Depth y [m] under pressures [Pa], of any shape, `begins` below 0, and its derivative y' [m/Pa]."""


class Straight(Curve):
    """p = stiffness * depth; stiffness [Pa/m]."""

    form: ClassVar[str] = "straight"

    def __init__(self, stiffness: float) -> None:
        self.stiffness = stiffness
        self.compliance = 1.0 / stiffness

    def pressure(self, depth: Any) -> np.ndarray:
        return self.stiffness * np.maximum(np.asarray(depth, float), 0.0)

    def slope(self, depth: Any) -> np.ndarray:
        return np.where(np.asarray(depth, float) > 0.0, self.stiffness, 0.0)

    def energy(self, depth: Any) -> np.ndarray:
        return 0.5 * self.stiffness * np.maximum(np.asarray(depth, float), 0.0) ** 2

    def yielding(self, pressure: Any) -> tuple[np.ndarray, np.ndarray]:
        p = np.maximum(np.asarray(pressure, float), 0.0)
        return p * self.compliance, np.full_like(p, self.compliance)


SHIFT = 1e-12  # m: far below the depth of any layer (an atom has 1e-10 m), far above round-off of its powers


class Power(Curve):
    """p = stiffness * depth^exponent; stiffness [Pa/m^exponent], exponent at least 1."""

    form: ClassVar[str] = "power"

    def __init__(self, stiffness: float, exponent: float) -> None:
        self.stiffness, self.exponent = stiffness, exponent

    @property
    def numbers(self) -> tuple[float, ...]:
        """Stiffness, exponent, shift, and its power."""
        return self.stiffness, self.exponent, SHIFT, SHIFT**self.exponent

    def pressure(self, depth: Any) -> np.ndarray:
        d = np.maximum(np.asarray(depth, float), 0.0)
        return self.stiffness * ((d + SHIFT) ** self.exponent - SHIFT**self.exponent)

    def slope(self, depth: Any) -> np.ndarray:
        d, n = np.asarray(depth, float), self.exponent
        return np.where(d > 0.0, n * self.stiffness * (np.maximum(d, 0.0) + SHIFT) ** (n - 1.0), 0.0)

    def energy(self, depth: Any) -> np.ndarray:
        d, n = np.maximum(np.asarray(depth, float), 0.0), self.exponent
        return self.stiffness * (((d + SHIFT) ** (n + 1.0) - SHIFT ** (n + 1.0)) / (n + 1.0) - SHIFT**n * d)

    def yielding(self, pressure: Any) -> tuple[np.ndarray, np.ndarray]:
        k, n = self.stiffness, self.exponent
        whole = np.maximum(np.asarray(pressure, float), 0.0) / k + SHIFT**n
        depth = whole ** (1.0 / n)
        return depth - SHIFT, depth / (n * k * whole)


def require_exponent(value: Any, label: str) -> float:
    """`value` as an exponent of at least 1; raises `InputError` naming `label` and the law for softening layers."""
    number = require_number(value, label)
    if number < 1.0:
        raise InputError(
            f"{label} must be at least 1, got {number:g}; for a layer that softens use laws.TabulatedLayer"
        )
    return number


class Exponential(Curve):
    """p = pressure_at_zero * exp(depth/e_folding), [Pa] and [m], shifted to end at the gap `end` [m]."""

    form: ClassVar[str] = "exponential"

    def __init__(self, pressure_at_zero: float, e_folding: float, end: float) -> None:
        self.pressure_at_zero, self.e_folding, self.end = pressure_at_zero, e_folding, end

    @property
    def begins(self) -> float:
        return -self.end

    @property
    def numbers(self) -> tuple[float, ...]:
        """Pressure at zero gap, decay length, eps, the gap where it ends."""
        return self.pressure_at_zero, self.e_folding, float(np.exp(-self.end / self.e_folding)), self.end

    def pressure(self, depth: Any) -> np.ndarray:
        d = np.maximum(np.asarray(depth, float), self.begins)
        return self.pressure_at_zero * (np.exp(d / self.e_folding) - np.exp(-self.end / self.e_folding))

    def slope(self, depth: Any) -> np.ndarray:
        d, length = np.asarray(depth, float), self.e_folding
        steep = self.pressure_at_zero / length * np.exp(np.maximum(d, self.begins) / length)
        return np.where(d > self.begins, steep, 0.0)

    def energy(self, depth: Any) -> np.ndarray:
        d = np.maximum(np.asarray(depth, float), self.begins)
        shift = self.pressure_at_zero * np.exp(-self.end / self.e_folding)
        return self.e_folding * self.pressure(d) - shift * (self.end + d)

    def yielding(self, pressure: Any) -> tuple[np.ndarray, np.ndarray]:
        p_0, length, eps, _ = self.numbers
        whole = np.maximum(np.asarray(pressure, float), 0.0) / p_0 + eps
        return length * np.log(whole), length / (p_0 * whole)


MOST_POINTS = 1024  # a lookup on the device bisects the table: ten comparisons


class Table(Curve):
    """Depths (n,) [m] and pressures (n,) [Pa] from 0 on, both rising strictly. Raises `InputError`."""

    form: ClassVar[str] = "table"

    def __init__(self, depths: np.ndarray, pressures: np.ndarray) -> None:
        rises = len(depths) > 1 and bool(np.all(np.diff(depths) > 0.0) and np.all(np.diff(pressures) > 0.0))
        if not rises or pressures[0] != 0.0 or len(depths) > MOST_POINTS:
            raise InputError(
                f"curves.Table: a table of {len(depths)} points is not monotonic or does not begin at zero; depths "
                f"and pressures must rise strictly, the pressures from 0 on, in 2 to {MOST_POINTS} points"
            )
        pieces = 0.5 * (pressures[1:] + pressures[:-1]) * np.diff(depths)
        self._table = np.column_stack([depths, pressures, np.concatenate([[0.0], np.cumsum(pieces)])])
        self._slopes = np.diff(pressures) / np.diff(depths)
        self.convex = bool(np.all(np.diff(self._slopes) >= 0.0))

    @property
    def begins(self) -> float:
        return float(self._table[0, 0])

    @property
    def table(self) -> np.ndarray:
        return self._table

    def pressure(self, depth: Any) -> np.ndarray:
        d, i, t = self._place(depth)
        return np.where(d > t[0, 0], t[i, 1] + self._slopes[i] * (d - t[i, 0]), 0.0)

    def slope(self, depth: Any) -> np.ndarray:
        d, i, t = self._place(depth)
        return np.where(d > t[0, 0], self._slopes[i], 0.0)

    def energy(self, depth: Any) -> np.ndarray:
        d, i, t = self._place(depth)
        return np.where(d > t[0, 0], t[i, 2] + 0.5 * (t[i, 1] + self.pressure(d)) * (d - t[i, 0]), 0.0)

    def yielding(self, pressure: Any) -> tuple[np.ndarray, np.ndarray]:
        depths, pressures, _ = self._table.T
        p = np.maximum(np.asarray(pressure, float), 0.0)
        i = np.clip(np.searchsorted(pressures, p, side="right") - 1, 0, len(pressures) - 2)
        return depths[i] + (p - pressures[i]) / self._slopes[i], 1.0 / self._slopes[i]

    def _place(self, depth: Any) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
        """Depths, the pieces they lie on, and the table."""
        d, table = np.asarray(depth, float), self._table
        return d, np.clip(np.searchsorted(table[:, 0], d) - 1, 0, len(table) - 2), table
