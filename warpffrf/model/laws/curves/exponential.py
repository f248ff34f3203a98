r"""An exponential of the gap that ends, p = p_0 exp(-g/lambda) from the gap g = `end` inwards.

The curve is shifted to zero at its end,

    P(d) = p_0 [exp(d/lambda) - eps],      eps = exp(-end/lambda),
    W(d) = lambda P(d) - p_0 eps (end + d),
    y(p) = lambda ln(p/p_0 + eps),         y' = lambda/(p + p_0 eps),

so that the pressure errs by eps p_0.
"""

from __future__ import annotations

from typing import Any, ClassVar

import numpy as np

from warpffrf.model.laws.curves.curve import Curve


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
