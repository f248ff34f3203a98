"""Values of the functions of a contact grid at places of its surface."""

from __future__ import annotations

from typing import Any

import numpy as np
import scipy.sparse as sp

from warpffrf.model.reduced.stress_field import GridSpan
from warpffrf.offline.contact.contact_grid import wrapped
from warpffrf.offline.fe.assembly import Sparse

Array = np.ndarray
BORDER = 1e-6  # of a cell: a place this close to the border of two cells, as nodes of the mesh are, takes their mean


def grid_values(theta: Array, z: Array, grid: Any, span: GridSpan, turn: float) -> Sparse:
    """Hats or cells of `grid` at chart points theta [rad], z [m] (n,): csr (n, whole columns * rows).

    z is cut to the grid; on an arc, places beyond the whole grid have zeros. `turn`: `full_turn` of the shape.
    """
    lines, whole = grid.z, span.columns
    x = (theta - grid.theta_start) / grid.pitch + span.first
    if span.closed:
        x = x % whole
    else:
        x = wrapped(x, turn / grid.pitch, -0.5 * grid.pitch / turn)
    if getattr(grid, "kind", "hats") == "cells":
        margin = BORDER * np.min(np.diff(lines))
        sides = [(dx, dz) for dx in (-BORDER, BORDER) for dz in (-margin, margin)]
        column = np.stack([np.floor(x + dx).astype(np.int64) for dx, _ in sides], axis=1)
        row = np.stack([_interval(z + dz, lines) for _, dz in sides], axis=1)
        value = np.full(column.shape, 1.0 / len(sides))
    else:
        j, z = np.floor(x).astype(np.int64), np.clip(z, lines[0], lines[-1])
        k = _interval(z, lines)
        s, t = x - j, (z - lines[k]) / (lines[k + 1] - lines[k])
        column, row = np.stack([j, j, j + 1, j + 1], axis=1), np.stack([k, k + 1, k, k + 1], axis=1)
        value = np.stack([(1 - s) * (1 - t), (1 - s) * t, s * (1 - t), s * t], axis=1)
    if span.closed:
        column = column % whole
    else:
        value = np.where((column >= 0) & (column < whole), value, 0.0)
        column = np.clip(column, 0, whole - 1)
    point = np.repeat(np.arange(len(theta)), len(value.T))
    entries = (value.ravel(), (point, (column * grid.rows + row).ravel()))
    return sp.csr_matrix(entries, shape=(len(theta), whole * grid.rows))


def _interval(z: Array, lines: Array) -> Array:
    """Number of the interval between `lines` that holds z, the outermost for places beyond."""
    return np.clip(np.searchsorted(lines, z, side="right") - 1, 0, len(lines) - 2)
