r"""Pressure and tangent of any layer law at a node, as a function of its gap and closing rate.

With the depth d = -g, the elastic curve P(d) of the law and chi its damping (`warpffrf.model.laws.layers`)

    p = max(P(d) (1 + chi d_dot), 0),        d_dot = (g_before - g)/h,
    dp/dg = -P'(d) (1 + chi d_dot) - P(d) chi/h    where p > 0,      W = int P dd.

The rate is the gap's increment over the step over its size h: no velocity of a coordinate is used.

Exponentials. Newton's method on p_0 exp(-g/lambda) leaves a gap that is too deep by one lambda per iteration, and
a step from an open gap goes thousands deep. So the law is linearised not at g but at a gap g^ that follows it,

    g^ = g where g > g^_before,      g^ = g^_before - lambda ln(1 + (g^_before - g)/lambda) else,

which is the step of Newton's method for the inverse law g(p) of the layer: the pressure grows
linearly. (Circuit simulators limit the voltage of a diode in this way.) After convergence g^ equals g.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np

DEEPEST = 100.0  # decay lengths: squares of e^100 times a pressure are finite, and no body withstands that


@dataclass(frozen=True, eq=False)
class LayerPressure:
    """At nodes (k,): pressure [Pa], its derivative by the gap at the end of the step [Pa/m], elastic energy [J/m^2],
    and dissipation of the layer in the step [J/m^2], not negative."""

    pressure: np.ndarray
    slope: np.ndarray
    energy: np.ndarray
    lost: np.ndarray


def reach(law: Any) -> float:
    """The gap [m] below which the law has a pressure: 0, positive for asperities, and of either sign for a table."""
    return -law.curve.begins


def followed(law: Any, gap: np.ndarray, before: np.ndarray) -> np.ndarray:
    """g^ (k,) [m] of the module docstring from that of the iteration before; the gap itself for other laws."""
    length = law.curve.e_folding
    if not length:
        return gap
    start = np.minimum(before, reach(law))  # beyond its end the law is zero
    return np.where(gap < start, start - length * np.log1p(np.maximum(start - gap, 0.0) / length), gap)


def layer_pressure(law: Any, gap: np.ndarray, before: np.ndarray, h: float, *, moving: bool) -> LayerPressure:
    """The law at gaps (k,) [m] that were `before` [m] a step h [s] ago; without `moving` nothing has a rate."""
    chi, curve = law.chi if moving else 0.0, law.curve
    if curve.e_folding:  # a trial state may be arbitrary
        gap = np.maximum(gap, -DEEPEST * curve.e_folding)
    elastic, slope, energy = curve.pressure(-gap), curve.slope(-gap), curve.energy(-gap)
    if chi == 0.0:
        return LayerPressure(elastic, -slope, energy, np.zeros_like(elastic))
    rate = (before - gap) / h
    factor = 1.0 + chi * rate
    pressing = factor > 0.0
    pressure = np.where(pressing, elastic * factor, 0.0)
    by_gap = np.where(pressing, -slope * factor - elastic * chi / h, 0.0)
    return LayerPressure(pressure, by_gap, energy, (pressure - elastic) * rate * h)
