"""A parameter along an axis: numbers as they are, texts and truth values beside each other; rows that make a grid."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np

from warpffrf.model.errors import unknown_name
from warpffrf.study.sweeps.reading.values import Table

WIDE = 8.0  # largest over least value of an axis that may be logarithmic
FEW = 12  # values that all have a tick, where there is room between them
APART = 0.13  # of the axis, from one tick to the next


@dataclass(frozen=True, eq=False)
class Axis:
    """Parameter `name` at positions (run,); `words`: of texts what stands at 0, 1, 2, ..., None for numbers."""

    name: str
    positions: np.ndarray
    words: tuple[str, ...] | None = None

    @property
    def distinct(self) -> np.ndarray:
        """Its values, each once, rising."""
        return np.unique(self.positions)

    @property
    def is_log(self) -> bool:
        """Whether its values spread over a logarithmic scale: its middle value is nearer the geometric mean of its
        ends."""
        at = self.distinct
        if self.words is not None or len(at) < 3 or at[0] <= 0.0 or at[-1] < WIDE * at[0]:
            return False
        middle = float(np.median(at))
        return abs(middle - np.sqrt(at[0] * at[-1])) < abs(middle - 0.5 * (at[0] + at[-1]))

    def text(self, position: float) -> str:
        """The value at a position."""
        return f"{position:.4g}" if self.words is None else self.words[int(position)]

    def dress(self, ax: Any, side: str) -> None:
        """Label and scale of the "x" or "y" axis of matplotlib axes."""
        label, scale, ticks = (getattr(ax, f"set_{side}{what}") for what in ("label", "scale", "ticks"))
        label(self.name)
        if self.is_log:
            scale("log")
        at = self.distinct
        if self.words is not None or (len(at) <= FEW and self._apart(at) >= APART):
            ticks(at, [self.text(position) for position in at])
            if self.is_log:
                ticks([], minor=True)

    def _apart(self, at: np.ndarray) -> float:
        """The least distance of two values over the length of the axis."""
        shown = np.log(at) if self.is_log else at
        return float(np.diff(shown).min() / np.ptp(shown)) if len(at) > 1 else 1.0


def axis_of(table: Table, name: str) -> Axis:
    """The parameter as an axis. Raises `InputError` for an unknown one."""
    if name not in table.parameter_names:
        raise unknown_name("sweep: parameter", name, table.parameter_names)
    column = table[name]
    if column.dtype != object and column.dtype != bool:
        return Axis(name, column.astype(float))
    texts = column.astype(str)
    words, positions = np.unique(texts, return_inverse=True)
    return Axis(name, positions.astype(float), tuple(map(str, words)))


def axes_of(table: Table, rows: np.ndarray) -> list[Axis]:
    """The parameters in which the `rows` (run,) differ."""
    found = [axis_of(table, name) for name in table.parameter_names]
    return [axis for axis in found if len(np.unique(axis.positions[rows])) > 1]


def grid_places(axes: Sequence[Axis], rows: np.ndarray) -> tuple[list[np.ndarray], np.ndarray] | None:
    """The values of each axis, and where on their grid each of the `rows` (run,) stands: (rows, axes) whole numbers.
    None where the rows are not a whole grid, every combination once."""
    if not axes:
        return None
    values, places = zip(*(np.unique(axis.positions[rows], return_inverse=True) for axis in axes), strict=True)
    places = np.stack(places, axis=1)
    size = int(np.prod([len(v) for v in values]))
    if len(places) != size or len(np.unique(places, axis=0)) != size:
        return None
    return list(values), places
