"""Pretensions: which of them hold their length in a step, and what their rows ask for.

Each has a row c and a multiplier lam behind those of the joints. Until it is locked lam is given, and the row reads
(lam - F(t))/max(|F|, 1 N) = 0; then it is the constraint c - c_lock = 0, c_lock the value where the step began that is
the first to begin at `lock_at` or later and to end later. Locking stops a length that moves, as an impact does: that
step and the one after it remember no accelerations (`run`).
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from references.monolithic.core.description import SceneData
from references.monolithic.core.integrator import BEGIN, PROJECT, Formula
from references.monolithic.core.state import State

SAME_TIME = 1e-9  # of the step: what sums of steps leave of times that were meant to agree
LEAST_FORCE = 1.0  # N: a pull is not measured against less


@dataclass(frozen=True, eq=False)
class Tensions:
    """At the end of a step: rows (t,) of the multipliers, which of them hold, at which length, else how they pull."""

    rows: np.ndarray
    holds: np.ndarray
    length: np.ndarray
    force: np.ndarray

    @property
    def scale(self) -> np.ndarray:
        """What multipliers are measured by (t,) [N]."""
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
