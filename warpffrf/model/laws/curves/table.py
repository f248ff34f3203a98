"""Points with straight pieces between them: pressure, slope and energy follow from the table alone, and nothing
overshoots it. The last piece goes on."""

from __future__ import annotations

from typing import Any, ClassVar

import numpy as np

from warpffrf.model.errors import InputError
from warpffrf.model.laws.curves.curve import Curve

MOST_POINTS = 1024  # a lookup on the device halves the table: ten looks


class Table(Curve):
    """Depths (n,) [m] and pressures (n,) [Pa] from 0 on, both rising strictly. Raises `InputError`."""

    form: ClassVar[str] = "table"

    def __init__(self, depths: np.ndarray, pressures: np.ndarray) -> None:
        rises = len(depths) > 1 and bool(np.all(np.diff(depths) > 0.0) and np.all(np.diff(pressures) > 0.0))
        if not rises or pressures[0] != 0.0 or len(depths) > MOST_POINTS:
            raise InputError(
                f"curves.Table: a table of {len(depths)} points that folds over itself, or does not begin at zero; "
                f"depths and pressures must rise strictly, the pressures from 0 on, in 2 to {MOST_POINTS} points"
            )
        pieces = 0.5 * (pressures[1:] + pressures[:-1]) * np.diff(depths)
        self._table = np.column_stack([depths, pressures, np.concatenate([[0.0], np.cumsum(pieces)])])
        self._slopes = np.diff(pressures) / np.diff(depths)
        self.convex = bool(np.all(np.diff(self._slopes) >= 0.0))

    @property
    def begins(self) -> float:
        return float(self._table[0, 0])

    @property
    def table(self) -> np.ndarray:
        return self._table

    def pressure(self, depth: Any) -> np.ndarray:
        d, i, t = self._place(depth)
        return np.where(d > t[0, 0], t[i, 1] + self._slopes[i] * (d - t[i, 0]), 0.0)

    def slope(self, depth: Any) -> np.ndarray:
        d, i, t = self._place(depth)
        return np.where(d > t[0, 0], self._slopes[i], 0.0)

    def energy(self, depth: Any) -> np.ndarray:
        d, i, t = self._place(depth)
        return np.where(d > t[0, 0], t[i, 2] + 0.5 * (t[i, 1] + self.pressure(d)) * (d - t[i, 0]), 0.0)

    def yielding(self, pressure: Any) -> tuple[np.ndarray, np.ndarray]:
        depths, pressures, _ = self._table.T
        p = np.maximum(np.asarray(pressure, float), 0.0)
        i = np.clip(np.searchsorted(pressures, p, side="right") - 1, 0, len(pressures) - 2)
        return depths[i] + (p - pressures[i]) / self._slopes[i], 1.0 / self._slopes[i]

    def _place(self, depth: Any) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
        """Depths, the pieces they lie on, and the table."""
        d, table = np.asarray(depth, float), self._table
        return d, np.clip(np.searchsorted(table[:, 0], d) - 1, 0, len(table) - 2), table
