r"""Flow factors of rough walls in the form required by Newton's method: values and slopes at gaps, by differences.

Isotropic walls by the fits of Patir and Cheng as printed (phi_p = 1 - 0.9 exp(-0.56 H), H > 0.5), implemented
separately from the model; any others as functions of the gap.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np

Array = np.ndarray
Function = Callable[[Array], Array]
STEP = 1e-6  # of a gap, for differences


@dataclass(frozen=True)
class RoughWalls:
    """Factors of the flow by pressure around and along, and the lag [m], at gaps (n,) [m]."""

    flow_around: Function
    flow_along: Function
    lag_at: Function

    def around(self, gap: Array) -> tuple[Array, Array]:
        """Factor and its slope [1/m]."""
        return _with_slope(self.flow_around, gap)

    def along(self, gap: Array) -> tuple[Array, Array]:
        return _with_slope(self.flow_along, gap)

    def lag(self, gap: Array) -> tuple[Array, Array]:
        """Lag [m] and its slope."""
        return _with_slope(self.lag_at, gap)

    @classmethod
    def smooth(cls) -> RoughWalls:
        return cls(np.ones_like, np.ones_like, np.zeros_like)

    @classmethod
    def isotropic(cls, deviation: float, second: float = 0.0) -> RoughWalls:
        """Of the deviations [m] of the resting wall and of the sliding one, isotropic."""
        s = float(np.hypot(deviation, second))
        apart = (deviation**2 - second**2) / s**2

        def flow(gap: Array) -> Array:
            return 1.0 - 0.9 * np.exp(-0.56 * np.maximum(gap / s, 0.5))

        def lag(gap: Array) -> Array:
            H = gap / s
            x = np.clip(H, 1.0, 5.0)
            thin = 1.899 * x**0.98 * np.exp(-0.92 * x + 0.05 * x**2) * np.minimum(H, 1.0)
            return apart * s * np.where(H <= 5.0, thin, 1.126 * np.exp(-0.25 * H))

        return cls(flow, flow, lag)


def _with_slope(of: Function, gap: Array) -> tuple[Array, Array]:
    step = STEP * gap
    return of(gap), (of(gap + step) - of(gap - step)) / (2.0 * step)
