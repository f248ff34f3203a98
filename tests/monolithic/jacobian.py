"""Jacobian of the monolithic system by central differences, from its residuals alone."""

from __future__ import annotations

import copy
from typing import Any

import numpy as np

from references.monolithic.core.equations import Increment
from references.monolithic.core.integrator import Formula
from references.monolithic.core.linear import dense_jacobian
from references.monolithic.core.state import State
from references.monolithic.newton import Evaluation, System, evaluate

ROUND_OFF = 1e-15  # of the largest residual: sums of some hundred terms


def analytic(system: System, e: Evaluation) -> np.ndarray:
    """K (size, size) as the solver puts it together, contact stiffness of law "nodes" included."""
    turnings, stiffness = [], []
    for pair, s in zip(e.pairs, e.pressures, strict=True):
        active = np.flatnonzero(s > 0.0)
        turnings.append((pair, pair.turning(active, s[active])))
        if system.assembled:
            gradient, force = pair.rows(active)
            stiffness.append((pair.data.columns, force, gradient, pair.softness[active]))
    return dense_jacobian(system.layout, e.balance, turnings, stiffness)


def differences(
    system: System,
    state: State,
    formula: Formula,
    x: Increment,
    time: float,
    carried: list[Any],
    sizes: np.ndarray,
    count: int | None = None,
) -> tuple[np.ndarray, list[np.ndarray]]:
    """dr/dz (size, count) and, per pair, dg/dz (tests, count) by steps `sizes` (size,) of the first `count` unknowns;
    turns are body-fixed."""
    layout = system.layout
    T_inverse = evaluate(system, state, formula, x, time, carried).trial.T_inverse
    columns, slopes = [], [[] for _ in system.pairs]
    for n in range(layout.size if count is None else count):
        found = []
        for sign in (1.0, -1.0):
            z = np.zeros(layout.size)
            z[n] = sign * sizes[n]
            moved = copy.deepcopy(x)
            moved.add(z, layout, T_inverse)
            found.append(evaluate(system, state, formula, moved, time, carried))
        columns.append((found[0].residual - found[1].residual) / (2.0 * sizes[n]))
        for m, slope in enumerate(slopes):
            slope.append((found[0].pairs[m].gap - found[1].pairs[m].gap) / (2.0 * sizes[n]))
    return np.array(columns).T, [np.array(s).T for s in slopes]


def worst_entry(K: np.ndarray, reference: np.ndarray, sizes: np.ndarray, residual: np.ndarray, agree: float) -> float:
    """Largest difference of two Jacobians as a fraction of the largest entry of its row after scaling by the steps
    `sizes`; entries that only the round-off of the `residual` decides count by that, at the tolerance `agree`."""
    scaled, other = K * sizes, reference * sizes
    largest = np.abs(other).max(axis=1, keepdims=True)
    blur = ROUND_OFF * max(float(np.abs(residual).max()), 1.0) / agree
    return float((np.abs(scaled - other) / np.maximum(largest, blur)).max())
