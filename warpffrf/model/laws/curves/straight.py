"""A straight line through touch, p = k d: its yield p/k is a constant."""

from __future__ import annotations

from typing import Any, ClassVar

import numpy as np

from warpffrf.model.laws.curves.curve import Curve


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
