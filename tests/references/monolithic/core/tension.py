"""Pretensions: which of them are locked in a step, and the residuals of their rows.

Each has a row c and a multiplier lam after those of the joints. Until it is locked lam is given, and the row is
(lam - F(t))/max(|F|, 1 N) = 0; then it is the constraint c - c_lock = 0, c_lock the value at the beginning of the first
step that begins at `lock_at` or later and ends later. Locking stops a moving length, as an impact does: that
step and the one after it have no memory of accelerations (`run`).
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from references.monolithic.core.description import SceneData
from references.monolithic.core.integrator import BEGIN, PROJECT, Formula
from references.monolithic.core.state import State

SAME_TIME = 1e-9  # of the step: round-off of sums of steps relative to nominal times
LEAST_FORCE = 1.0  # N: lower limit of the reference force


@dataclass(frozen=True, eq=False)
class Tensions:
    """At the end of a step: rows (t,) of the multipliers, which are locked, at which length, else their force."""

    rows: np.ndarray
    holds: np.ndarray
    length: np.ndarray
    force: np.ndarray

    @property
    def scale(self) -> np.ndarray:
        """Reference values of multipliers (t,) [N]."""
        return np.maximum(np.abs(self.force), LEAST_FORCE)


def tensions_of(data: SceneData, state: State, formula: Formula, time: float) -> Tensions:
    """The pretensions of the step from `state` to `time`; the phases of a start lock nothing."""
    lock_at, slack = np.array([t.lock_at for t in data.tensions]), SAME_TIME * formula.h
    locked = state.locked[:, 0] > 0.0
    if formula.coefficients is not BEGIN and formula.coefficients is not PROJECT:
        locked = locked | ((state.time >= lock_at - slack) & (time > lock_at + slack))
    return Tensions(
        np.array([t.row for t in data.tensions], dtype=np.intp), locked, state.locked[:, 1],
        np.array([float(t.force(time)) for t in data.tensions]),
    )  # fmt: skip
