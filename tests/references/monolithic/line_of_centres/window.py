"""The window of the first grid used by a pair with parallel-axes kinematics: all active tests, and a margin."""

from __future__ import annotations

from typing import Any

import numpy as np

from references.monolithic.core.equations import Trial
from references.monolithic.core.state import Layout
from references.monolithic.line_of_centres.pair import MARGIN, PairData, PairState, pair_state


def windowed(
    system: Any, n: int, data: PairData, trial: Trial, carried: dict[int, float]
) -> tuple[PairState, np.ndarray]:
    """The pair with all active tests inside its window, MARGIN columns from the ends."""
    layout = system.layout
    q_a, q_b = (_coordinates(layout, trial, side.body, surface) for side, surface in zip(
        (data.a, data.b), system.surfaces[n], strict=True
    ))  # fmt: skip
    while True:
        pair = pair_state(data, trial.r, trial.A, q_a, q_b)
        place = {int(k): i for i, k in enumerate(pair.number)}
        s = np.zeros(len(pair.number))
        known = True
        for number, value in carried.items():
            at = place.get(number)
            if at is None:
                known = False
                continue
            s[at] = value
        at = np.flatnonzero(s > 0.0)
        if system.assembled:
            at = np.flatnonzero(pair.gap < 0.0)
        x = pair.points.column
        middle = 0.5 * float(pair.frame.x_a[0] + pair.frame.x_a[-1])
        reach = float(np.abs(x[at] - middle).max(initial=0.0))
        if (known and reach + MARGIN <= data.half) or data.half >= data.widest:
            return pair, s
        data.half = max(2 * data.half, int(reach) + MARGIN) if known else 2 * data.half


def _coordinates(layout: Layout, trial: Trial, body: int, surface: int) -> np.ndarray:
    start = layout.local_start[surface]
    return np.concatenate([trial.q[layout.body_modes(body)], trial.q[start : start + layout.local_count[surface]]])
