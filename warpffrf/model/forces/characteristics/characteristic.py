r"""What all characteristics have in common: a force over one coordinate x, piece by piece, with its exact potential.

x is a deformation [m or rad] or a rate [m/s or rad/s], F a force [N] or torque [N m]. On piece i, b_i <= x < b_(i+1),
with xi = x - o_i from an origin o_i of its own,

    F(x)  = sum_k c_ik xi^k  +  a_i sgn(xi) |xi|^p_i,                     k < 8,  p_i >= 1
    F'(x) = sum_k k c_ik xi^(k-1)  +  a_i p_i |xi|^(p_i - 1),
    V(x)  = V_i + sum_k c_ik xi^(k+1)/(k+1)  +  a_i |xi|^(p_i + 1)/(p_i + 1),

the first piece from minus infinity on, the last without end, and the V_i such that V is continuous and V(0) = 0: V is
the energy that a spring stores from x = 0 on. F should be continuous; its slope may jump. A linear law is one piece
with c_1 alone. Anything that such pieces say exactly is a new kind in one file, for the device too
(`warpffrf_kernels.constraints.characteristics` evaluates the pieces of all kinds).
"""

from __future__ import annotations

from dataclasses import dataclass, field
from functools import cached_property
from typing import Any, ClassVar

import numpy as np

TERMS = 8  # coefficients of a piece: degree up to 7
ORDERS = np.arange(TERMS)
JUMP = 1e-9  # of the largest slope where pieces meet: less is round-off
ROUND_OFF = 1e-12  # of the largest force: what sums of the numbers of a table leave where it should be zero


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
        """The numbers (n,) of the pieces that the x (n,) [m, rad; of a rate m/s, rad/s] lie on, and their distances
        (n,) from the origins of these."""
        x = np.asarray(x, dtype=np.float64)
        i = np.searchsorted(self.breaks, x, side="right")
        return i, x - self.origin[i]


class Characteristic:
    """A force over one coordinate, other than in proportion to it. A subclass gives `kind`, `pieces` and `describe`.

    `ends`: between these arguments it is given, beyond them it goes on straight; infinite where a formula gives it.
    """

    kind: ClassVar[str] = ""

    @property
    def ends(self) -> tuple[float, float]:
        """The least and the largest argument [m, rad, m/s or rad/s] at which it is given."""
        return (-np.inf, np.inf)

    @cached_property
    def pieces(self) -> Pieces:
        """The pieces that say all of it."""
        raise TypeError(f"{type(self).__name__} does not say what its pieces are")

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
        """Arguments (n,) [m, rad; of a rate m/s, rad/s], rising, between which the signs of F and of x do not change,
        nor beyond the outermost."""
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
