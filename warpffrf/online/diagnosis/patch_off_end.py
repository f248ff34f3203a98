"""Patches of crowned line contacts that run off an end, found during a run.

The point where a crown touches is known beforehand, the extent of its patch under load is not: rows are fine about the
crown only, and a peak at an end is lost in a row that is as long as several half-widths. A run in which a patch reaches
an end is restarted with rows that are also fine at the ends of all crowns [`PatchPlan.of`, `off_end`], and with more of
them where cells= does not prescribe the number. Checkpoints record this [`Engine.checkpoint`], and runs continued from
them have the same cells. A run continued from one with other cells keeps these, and `cell_notes` reports what they do
not resolve.
"""

from __future__ import annotations

import logging

import numpy as np

from warpffrf.online.diagnosis.border_notes import BORDER
from warpffrf.online.engine import Engine

log = logging.getLogger("warpffrf")


class OffEnd(Exception):
    """A patch of a crown runs off an end, and its rows are fine about the crown only."""


class EndWatch:
    """Evaluates the saved rows of `engine`; `keeps`: a run that keeps its cells in any case."""

    def __init__(self, engine: Engine, *, keeps: bool = False) -> None:
        self.engine, self.looked = engine, len(engine.chunks[0])
        plans = {} if keeps else engine.compiled.patches
        self.plans = {i: plan for i, plan in plans.items() if plan.crowned and not plan.off_end}

    def look(self) -> None:
        """Raises `OffEnd` where rows that were saved since the last call have more than `BORDER` of the largest
        pressure at an end.
        """
        fresh, self.looked = self.engine.chunks[0][self.looked :], len(self.engine.chunks[0])
        for i, plan in self.plans.items():
            rows = len(plan.z)
            for chunk in fresh:
                pressure = chunk["saved_pressure"][:, i, : plan.columns * rows].reshape(-1, plan.columns, rows)
                if np.any(shares_at_ends(pressure) > BORDER):
                    log.info("a patch of a crown runs off an end: begun anew, with rows that are fine there, too")
                    raise OffEnd


def shares_at_ends(pressure: np.ndarray) -> np.ndarray:
    """Shares of the largest pressure in the first and in the last row, of pressures (T, strips, rows), (T, 2)."""
    by_row = pressure.max(axis=1)
    return by_row[:, [0, -1]] / np.maximum(by_row.max(axis=1), np.finfo(float).tiny)[:, None]
