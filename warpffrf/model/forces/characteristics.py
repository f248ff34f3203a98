r"""Characteristics: forces of springs and dampers that are nonlinear in deformation or rate.

    ForcePolynomial   F = k_1 x + k_2 x^2 + k_3 x^3 + ...
    PowerLaw          F = c sgn(x) |x|^n
    ForceTable        points, joined linearly or smoothly; play, stops, kinks

They replace a stiffness or a damping: `SpringDamper(a, b, stiffness=PowerLaw(1e9, 1.5))`.

Characteristic. Common to all characteristics: a piecewise force over one coordinate x, with its exact potential.

x is a deformation [m or rad] or a rate [m/s or rad/s], F a force [N] or torque [N m]. On piece i, b_i <= x < b_(i+1),
with xi = x - o_i from an origin o_i of its own,

    F(x)  = sum_k c_ik xi^k  +  a_i sgn(xi) |xi|^p_i,                     k < 8,  p_i >= 1
    F'(x) = sum_k k c_ik xi^(k-1)  +  a_i p_i |xi|^(p_i - 1),
    V(x)  = V_i + sum_k c_ik xi^(k+1)/(k+1)  +  a_i |xi|^(p_i + 1)/(p_i + 1),

the first piece from minus infinity on, the last without end, and the V_i such that V is continuous and V(0) = 0: V is
the energy that a spring stores from x = 0 on. F should be continuous; its slope may jump. A linear law is one piece
with c_1 alone. Any law that such pieces represent exactly is a new kind in one file, also for the device
(`warpffrf_kernels.constraints.characteristics` evaluates the pieces of all kinds).

Polynomial. A force that is a polynomial of deformation or rate without a constant term, F = k_1 x + k_2 x^2 + k_3 x^3 +
...

k_1 and k_3 > 0 make the hardening spring of Duffing's oscillator, k_3 < 0 a softening one; even powers act differently
in tension and compression.

Power law. A force that is an odd power of deformation or rate, F = c sgn(x) |x|^n.

n = 2 over the rate is drag, c v |v|; n = 3/2 over the deformation is the closing of two balls. For n > 1 the slope is
zero at x = 0: there is no stiffness there, and vibrations about it have no frequency of their own.

Table. A force given by a table over deformation or rate, from a measurement or another program.

Between the points it is linear, or cubic with the slopes of Fritsch and Butland (SIAM J. Sci. Stat. Comput. 5, 1984):
without kinks, and without overshooting, so that forces that increase from point to point increase everywhere. Beyond
the ends it is extrapolated linearly with the end slope; a run that has left the table reports it. Play and stops are
tables: [(-2e-3, -1e4), (-1e-3, 0), (1e-3, 0), (2e-3, 1e4)] leaves 1 mm of play to either side, before stops of 10 N/um.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, field
from functools import cached_property
from typing import Any, ClassVar

import numpy as np

from warpffrf.model.errors import InputError, require_array, require_number
from warpffrf.model.messages.named_arguments import named_arguments

TERMS = 8  # coefficients of a piece: degree up to 7
ORDERS = np.arange(TERMS)
JUMP = 1e-9  # of the largest slope where pieces meet: less is round-off
ROUND_OFF = 1e-12  # of the largest force: remainder of sums of table entries that should be zero


@dataclass(frozen=True, eq=False)
class Pieces:
    """n pieces of a characteristic, F(x) = sum_k coefficient[k] xi^k + power sgn(xi) |xi|^exponent [N, N m], xi = x -
    origin.

    breaks (n-1,) [m, rad; of a rate m/s, rad/s]: where one ends and the next begins, rising. origin (n,) likewise;
    coefficient (n, 8) and power (n,) in N or N m over powers of x; exponent (n,) [-] at least 1. Without a power, power
    is 0 and exponent 1.
    """

    breaks: np.ndarray
    origin: np.ndarray
    coefficient: np.ndarray
    power: np.ndarray
    exponent: np.ndarray
    constant: np.ndarray = field(init=False)  # (n,): V_i, J

    def __post_init__(self) -> None:
        V = np.zeros(len(self.origin))
        home = int(np.searchsorted(self.breaks, 0.0, side="right"))
        V[home] = -self._primitive(home, 0.0)
        for i in range(home + 1, len(V)):
            b = self.breaks[i - 1]
            V[i] = V[i - 1] + self._primitive(i - 1, b) - self._primitive(i, b)
        for i in range(home - 1, -1, -1):
            b = self.breaks[i]
            V[i] = V[i + 1] + self._primitive(i + 1, b) - self._primitive(i, b)
        object.__setattr__(self, "constant", V)

    def _primitive(self, i: Any, x: Any) -> np.ndarray:
        """V - V_i of pieces i at x, of one shape."""
        xi = np.asarray(x - self.origin[i])
        polynomial = np.sum(self.coefficient[i] / (ORDERS + 1) * xi[..., None] ** (ORDERS + 1), axis=-1)
        return polynomial + self.power[i] * np.abs(xi) ** (self.exponent[i] + 1.0) / (self.exponent[i] + 1.0)

    def place(self, x: Any) -> tuple[np.ndarray, np.ndarray]:
        """The indices (n,) of the pieces that the x (n,) [m, rad; of a rate m/s, rad/s] lie on, and their distances
        (n,) from the origins of these."""
        x = np.asarray(x, dtype=np.float64)
        i = np.searchsorted(self.breaks, x, side="right")
        return i, x - self.origin[i]


class Characteristic:
    """A nonlinear force over one coordinate. A subclass defines `kind`, `pieces` and `describe`. `ends`: range of the
    arguments, beyond which it is extrapolated linearly; infinite for a formula.
    """

    kind: ClassVar[str] = ""

    @property
    def ends(self) -> tuple[float, float]:
        """The smallest and largest argument [m, rad, m/s or rad/s] of its definition."""
        return (-np.inf, np.inf)

    @cached_property
    def pieces(self) -> Pieces:
        """The pieces that define it."""
        raise TypeError(f"{type(self).__name__} does not define its pieces")

    @property
    def vanishes(self) -> bool:
        """Whether it is zero everywhere."""
        return not np.any(self.pieces.coefficient) and not np.any(self.pieces.power)

    def force(self, x: Any) -> np.ndarray:
        """F [N or N m] at the arguments x, any shape."""
        i, xi = self.pieces.place(x)
        p = self.pieces
        polynomial = np.sum(p.coefficient[i] * xi[..., None] ** ORDERS, axis=-1)
        return polynomial + p.power[i] * np.sign(xi) * np.abs(xi) ** p.exponent[i]

    def slope(self, x: Any) -> np.ndarray:
        """dF/dx [N/m, N m/rad; of a rate N s/m, N m s/rad] at the arguments x, any shape; where it jumps, that of the
        side of larger x."""
        return self._slope(*self.pieces.place(x))

    def _slope(self, i: np.ndarray, xi: np.ndarray) -> np.ndarray:
        p = self.pieces
        polynomial = np.sum(p.coefficient[i][..., 1:] * ORDERS[1:] * xi[..., None] ** ORDERS[:-1], axis=-1)
        return polynomial + p.power[i] * p.exponent[i] * np.abs(xi) ** (p.exponent[i] - 1.0)

    def energy(self, x: Any) -> np.ndarray:
        """V [J], the integral of F from 0 to x, any shape."""
        i, _ = self.pieces.place(x)
        return self.pieces.constant[i] + self.pieces._primitive(i, np.asarray(x, dtype=np.float64))

    def has_kink(self, x: float, within: float) -> bool:
        """Whether the slope jumps at a distance of at most `within` from x [m, rad; of a rate m/s, rad/s]."""
        breaks, after = self.pieces.breaks, np.arange(1, len(self.pieces.origin))
        slopes = np.array([self._slope(i, breaks - self.pieces.origin[i]) for i in (after - 1, after)])
        jumps = np.abs(slopes[1] - slopes[0]) > JUMP * np.abs(slopes).max(initial=0.0)
        return bool(np.any(jumps & (np.abs(breaks - x) <= within)))

    def sign_changes(self) -> np.ndarray:
        """Arguments (n,) [m, rad; of a rate m/s, rad/s], increasing, between and beyond which the signs of F and x do
        not change."""
        p = self.pieces
        marks = [0.0, *p.breaks, *p.origin]
        for coefficient, origin, power in zip(p.coefficient, p.origin, p.power, strict=True):
            if not power:
                roots = np.roots(coefficient[::-1])
                marks += (origin + roots.real[roots.imag == 0.0]).tolist()
        return np.unique(marks)

    def describe(self) -> dict[str, Any]:
        """Plain data for hashing."""
        raise TypeError(f"{type(self).__name__} does not describe itself")


@named_arguments
@dataclass(frozen=True)
class ForcePolynomial(Characteristic):
    """F = k_1 x + k_2 x^2 + ... with `coefficients` (k_1, k_2, ...) [N/m, N/m^2, ...; of torques and angles N m/rad,
    ...], seven at most. Raises `InputError`."""

    coefficients: Sequence[float]
    kind: ClassVar[str] = "force_polynomial"

    def __post_init__(self) -> None:
        k = require_array(self.coefficients, "ForcePolynomial: coefficients", (None,))
        if not 1 <= len(k) < TERMS:
            raise InputError(f"ForcePolynomial: 1 to {TERMS - 1} coefficients are needed, got {len(k)}")
        object.__setattr__(self, "coefficients", tuple(k.tolist()))

    @cached_property
    def pieces(self) -> Pieces:
        c = np.zeros((1, TERMS))
        c[0, 1 : len(self.coefficients) + 1] = self.coefficients
        return Pieces(np.zeros(0), np.zeros(1), c, np.zeros(1), np.ones(1))

    def describe(self) -> dict[str, Any]:
        return {"kind": self.kind, "coefficients": list(self.coefficients)}


@named_arguments
@dataclass(frozen=True)
class PowerLaw(Characteristic):
    """F = coefficient * sgn(x) |x|^exponent; coefficient [N/m^exponent, N (s/m)^exponent, N m/rad^exponent ...]
    positive, exponent at least 1. Raises `InputError`."""

    coefficient: float
    exponent: float
    kind: ClassVar[str] = "power_law"

    def __post_init__(self) -> None:
        coefficient = require_number(self.coefficient, "PowerLaw: coefficient", positive=True)
        exponent = require_number(self.exponent, "PowerLaw: exponent")
        if exponent < 1.0:
            raise InputError(
                f"PowerLaw: exponent must be at least 1, got {exponent:g}: the slope at zero would be infinite; use a "
                "ForceTable that is straight through zero"
            )
        object.__setattr__(self, "coefficient", coefficient)
        object.__setattr__(self, "exponent", exponent)

    @cached_property
    def pieces(self) -> Pieces:
        one = np.ones(1)
        return Pieces(np.zeros(0), np.zeros(1), np.zeros((1, TERMS)), self.coefficient * one, self.exponent * one)

    def describe(self) -> dict[str, Any]:
        return {"kind": self.kind, "coefficient": self.coefficient, "exponent": self.exponent}


@named_arguments
@dataclass(frozen=True)
class ForceTable(Characteristic):
    """Forces over deformation or rate: `points` (n, 2), n >= 2, of x [m, rad, m/s or rad/s], increasing, and F
    [N or N m]; linear between them, or `smooth`. A force at x = 0 is a preload, which no damper may have. Raises
    `InputError`, of a table that is not monotonic with the two points."""

    points: Any
    smooth: bool = False
    kind: ClassVar[str] = "force_table"

    def __post_init__(self) -> None:
        table = require_array(self.points, "ForceTable: points", (None, 2))
        if len(table) < 2:
            raise InputError(f"ForceTable: at least two points are needed, got {len(table)}")
        falls = np.diff(table[:, 0]) <= 0.0
        if np.any(falls):
            i = int(np.argmax(falls))
            raise InputError(
                f"ForceTable: the table is not monotonic, x must rise from point to point, got {table[i, 0]:g} and "
                f"then {table[i + 1, 0]:g} (points {i} and {i + 1}); sort it, and give a jump a little width"
            )
        if not isinstance(self.smooth, (bool, np.bool_)):
            raise InputError(f"ForceTable: smooth must be True or False, got {self.smooth!r}")
        object.__setattr__(self, "points", tuple((x, F) for x, F in table.tolist()))
        object.__setattr__(self, "smooth", bool(self.smooth))

    @property
    def ends(self) -> tuple[float, float]:
        return self.points[0][0], self.points[-1][0]

    @cached_property
    def pieces(self) -> Pieces:
        x, F = np.array(self.points).T
        if self.smooth:
            from scipy.interpolate import PchipInterpolator

            cubic = PchipInterpolator(x, F)
            lines = np.zeros((len(x) + 1, TERMS))
            lines[1:-1, :4] = cubic.c[::-1].T
            lines[[0, -1], 0], lines[[0, -1], 1] = F[[0, -1]], cubic.derivative()(x[[0, -1]])
            breaks, origin = x, np.concatenate([x[:1], x])
        else:
            lines = np.zeros((len(x) - 1, TERMS))
            lines[:, 0], lines[:, 1] = F[:-1], np.diff(F) / np.diff(x)
            breaks, origin = x[1:-1], x[:-1]
        return Pieces(breaks, origin, lines, np.zeros(len(origin)), np.ones(len(origin)))

    def describe(self) -> dict[str, Any]:
        return {"kind": self.kind, "points": [list(point) for point in self.points], "smooth": self.smooth}


CHARACTERISTICS = {kind.kind: kind for kind in (ForcePolynomial, PowerLaw, ForceTable)}

__all__ = ["CHARACTERISTICS", "Characteristic", "ForcePolynomial", "ForceTable", "Pieces", "PowerLaw"]
