r"""The power of a depth, p = k d^n, with a slope that does not vanish at touch.

For n > 1 the slope n k d^(n-1) is zero at d = 0: the inverse y(p) = (p/k)^(1/n) has an infinite one there, which no
compliance can hold. The power is taken of a depth that begins at `SHIFT` instead,

    P(d) = k [(d + e)^n - e^n],      e = SHIFT,
    W(d) = k {[(d + e)^(n+1) - e^(n+1)]/(n + 1) - e^n d},
    y(p) = (p/k + e^n)^(1/n) - e,    y' = (p/k + e^n)^(1/n - 1)/(n k),

which differs from k d^n by the fraction n e/d: 1.5e-6 at a depth of a micrometre and n = 1.5. At n = 1 it is k d.
"""

from __future__ import annotations

from typing import Any, ClassVar

import numpy as np

from warpffrf.model.errors import InputError, require_number
from warpffrf.model.laws.curves.curve import Curve

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
