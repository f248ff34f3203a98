"""Saved rows of a run: one ring per array, written by the step and read by the host between chunks.

Frames are those of the state: centres of mass, body axes. `warpffrf.online.history.record` builds a History from them.
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from warpffrf.online.arrays.declaration import Arrays
from warpffrf_kernels.core.ring import (
    SavedBooks,
    SavedContact,
    SavedFilms,
    SavedFriction,
    SavedJointFriction,
    SavedLumped,
    SavedMatched,
    SavedMotion,
)  # fmt: skip

SavedRows = dict[str, np.ndarray]
"""Saved rows of one world by array name, time first."""


class Ring(
    SavedBooks, SavedMotion, SavedJointFriction, SavedContact, SavedFriction, SavedLumped, SavedFilms, SavedMatched,
    Arrays, carried=True,
):  # fmt: skip
    """Quantities that are saved of the steps of every world."""

    def on_host(self) -> SavedRows:
        """All arrays, world axis first: views on the CPU, one copy each from another device."""
        return {name: self.read(name) for name in self.declarations}


def taken(ring: SavedRows, world: int, rows: range) -> SavedRows:
    """Copies of these rows of a world, counted from the first row ever saved; `ring`: from `Ring.on_host`."""
    n = ring["saved_time"].shape[1]
    if rows.step == 1 and len(rows) and rows.start % n + len(rows) <= n:
        begin = rows.start % n
        return {name: array[world, begin : begin + len(rows)].copy() for name, array in ring.items()}
    at = np.asarray(rows, dtype=int) % n
    return {name: array[world, at] for name, array in ring.items()}


def joined(chunks: Sequence[SavedRows]) -> SavedRows:
    """Rows of all chunks (at least one), which lose their arrays: rows may fill the memory, but not twice."""
    if len(chunks) == 1:
        return chunks[0]
    found: SavedRows = {}
    for name in list(chunks[0]):
        lengths, of_row = [len(chunk[name]) for chunk in chunks], chunks[0][name]
        found[name] = np.empty((sum(lengths), *of_row.shape[1:]), of_row.dtype)
        del of_row
        for chunk, end in zip(chunks, np.cumsum(lengths), strict=True):
            part = chunk.pop(name)
            found[name][end - len(part) : end] = part
    return found
