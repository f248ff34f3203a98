"""Life of a bearing under the load spectrum of its saved steps."""

from __future__ import annotations

from typing import Any

import numpy as np
from numpy.typing import ArrayLike

from warpffrf.model.bearings.modified_life import DutyLife, life_of_points, reliability_factor
from warpffrf.model.errors import InputError, require_array


def duty_life(
    bearing: Any, shares: ArrayLike, speed: ArrayLike, capacity: float | None, static_capacity: float | None,
    kappa: ArrayLike | None, contamination: ArrayLike | None, reliability: float, turning: str,
) -> DutyLife:  # fmt: skip
    """See `BearingResult.duty_life`."""
    label, count = f"bearing {bearing.name!r}: duty_life", len(bearing.time)

    def of_rows(value: ArrayLike, name: str) -> np.ndarray:
        return require_array(value if np.ndim(value) else np.full(count, value), f"{label}: {name}", (count,))

    share, speeds = require_array(shares, f"{label}: shares", (count,)), of_rows(speed, "speed [rad/s]")
    if np.any(share < 0.0):
        raise InputError(f"{label}: shares of the time must not be negative, got {share.min():g}")
    loads = np.maximum(bearing.inner_load, bearing.outer_load).max(axis=1, initial=0.0)
    worn = np.flatnonzero((loads > 0.0) & (share * speeds != 0.0))
    life = np.full(count, np.inf)
    if kappa is None and contamination is None:
        a_1 = reliability_factor(reliability)
        life[worn] = [a_1 * bearing.reference_life(capacity, i, turning=turning).revolutions for i in worn]
    elif kappa is None or contamination is None:
        raise InputError(f"{label}: give kappa and contamination, for the modified life, or neither")
    else:
        ratio, clean = of_rows(kappa, "kappa"), of_rows(contamination, "contamination")
        life[worn] = [
            bearing.modified_life(
                capacity,
                static_capacity,
                kappa=ratio[i],
                contamination=clean[i],
                reliability=reliability,
                row=i,
                turning=turning,
            ).revolutions  # fmt: skip
            for i in worn
        ]
    return life_of_points(share, speeds, life)
