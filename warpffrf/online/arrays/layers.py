"""Shapes of the arrays that layers between surfaces need (`warpffrf_kernels.layers.weak_layer`); none without a
layer."""

from __future__ import annotations

from typing import Any

import numpy as np
from warpffrf_kernels.core.model import Model


def layer_points(m: Model) -> int:
    """Points of a pair's window at which the laws of layers are evaluated, the most of all pairs."""
    if not m.layers.count:
        return 0
    return (m.window.columns + 1) * int(m.layers.point_count.numpy().max())


def slot_flexibility(m: Model, work: Any, count: int) -> np.ndarray:
    """E (count, count) [m^3/Pa] of the hats in the first `count` slots of world 0, at the last linearisation."""
    E = np.zeros((count, count))
    kinds, first = m.layers.kind.numpy(), m.pairs.first.numpy()
    pairs, hats = work.slot_mode.numpy()[0, :count].T
    slot_of, tangent = work.slot_of.numpy()[0], work.layer_tangent.numpy()[0]
    rows = m.surfaces.rows.numpy()[first]
    for i, (pair, hat) in enumerate(zip(pairs, hats, strict=True)):
        if not kinds[pair]:
            continue
        column, row = divmod(int(hat), int(rows[pair]))
        for n in range(9):
            c, r = column + n // 3 - 1, row + n % 3 - 1
            if 0 <= c < m.window.columns and 0 <= r < rows[pair]:
                j = slot_of[pair, c * rows[pair] + r]
                if j >= 0:
                    E[i, j] = tangent[pair, hat, n]
    return E
