r"""The yield of a layer on the host: depth under a pressure and its derivative, what
`warpffrf_kernels.layers.layer_laws` has.

    power         y = (p/k + e^n)^(1/n) - e,               y' = (p/k + e^n)^(1/n - 1)/(n k)
    exponential   y = lambda ln(p/p_0 + exp(-g_end/lambda)),  y' = lambda/(p + p_0 exp(-g_end/lambda))
    table         straight between its points, and on beyond the last

At rest: the damping of a layer is left out. A point that is not pressed yields by the depth at which pressure begins.
"""

from __future__ import annotations

import numpy as np

from warpffrf.model.laws.layer import Curve


def yield_of(curve: Curve, pressure: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Depth y [m] of a `warpffrf.model.laws.Curve` under pressures p [Pa], 0 taken for negative ones, and y' [m/Pa]."""
    p = np.maximum(np.asarray(pressure, dtype=np.float64), 0.0)
    if curve.form == "power":
        k, n, shift = curve.numbers
        whole = p / k + shift**n
        depth = whole ** (1.0 / n)
        return depth - shift, depth / (n * k * whole)
    if curve.form == "exponential":
        p_0, length, end = curve.numbers
        whole = p / p_0 + np.exp(-end / length)
        return length * np.log(whole), length / (p_0 * whole)
    depths, pressures = curve.table.T
    piece = np.clip(np.searchsorted(pressures, p, side="right") - 1, 0, len(pressures) - 2)
    slope = (np.diff(depths) / np.diff(pressures))[piece]
    return depths[piece] + slope * (p - pressures[piece]), slope
