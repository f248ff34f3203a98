"""The unwrapped patch as a picture: e_theta of the first surface to the right, its axis up, one window for a run.

Pressure is bilinear between the nodes of the contact grid; fields of friction and pressures on cells are constant on
the cells, as computed.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np

from warpffrf.output.contact.cell_result import CellContactResult
from warpffrf.output.plots.colors import largest

PATCH_VIEW = 3.0  # half-widths (largest of the run) shown to either side


@dataclass(frozen=True)
class MapWindow:
    """Extent of a patch map: x from -reach to reach [m] along e_theta from the line of centres, z from low to high
    [m]."""

    reach: float
    low: float
    high: float

    def x(self, width: int) -> np.ndarray:
        """x: (width,) m, pixel centres, left to right."""
        return self.reach * (2.0 * (np.arange(width) + 0.5) / width - 1.0)

    def z(self, height: int) -> np.ndarray:
        """z: (height,) m, pixel centres, from top to bottom."""
        return self.high - (self.high - self.low) * (np.arange(height) + 0.5) / height


def map_window(contact: Any, rows: np.ndarray) -> MapWindow:
    """The window that contains the patch in all saved `rows`: the whole width of a line contact; for a point contact as
    many half-widths along the axis as across."""
    low, high = contact.ends
    rows = np.asarray(rows)[contact.touching[rows]]
    width = contact.half_widths[rows]
    width = width[np.all(np.isfinite(width), axis=1)]
    if not len(width):
        return MapWindow(contact.window, low, high)
    reach = PATCH_VIEW * largest([contact.half_width[rows] if contact.patch_kind == "line" else width[:, 0]])
    if contact.patch_kind == "point":
        middle = contact.center_of_pressure[rows][:, 1]
        low = max(low, float(np.nanmin(middle - PATCH_VIEW * width[:, 1])))
        high = min(high, float(np.nanmax(middle + PATCH_VIEW * width[:, 1])))
    return MapWindow(reach, low, high)


def node_map(contact: Any, i: int, values: np.ndarray, window: MapWindow, shape: tuple[int, int]) -> np.ndarray:
    """(height, width) of nodal `values` (columns, rows) at saved step `i`, interpolated bilinearly, zero outside of the
    grid's window."""
    arc, values = _rightwards(contact, i, values)
    z = contact.z
    y = window.z(shape[0])
    across = np.stack([np.interp(window.x(shape[1]), arc, p, left=0.0, right=0.0) for p in values.T])
    k = np.clip(np.searchsorted(z, y, side="right") - 1, 0, max(len(z) - 2, 0))
    k1 = np.minimum(k + 1, len(z) - 1)
    t = np.where(k1 > k, (y - z[k]) / np.where(k1 > k, z[k1] - z[k], 1.0), 0.0)[:, None]
    return (1.0 - t) * across[k] + t * across[k1]


def cell_map(contact: Any, i: int, values: np.ndarray, window: MapWindow, shape: tuple[int, int]) -> np.ndarray:
    """(height, width) of `values` (columns, rows) that are constant on the cells at saved step `i`, zero outside of
    them."""
    values = _rightwards(contact, i, values)[1]
    arc, z = contact.cell_lines(i)
    x = np.sort(contact.side * arc)
    column, inside = _lying_in(x, window.x(shape[1]))
    row, beside = _lying_in(z, window.z(shape[0]))
    picture = values[column[None, :], row[:, None]]
    return np.where(inside[None, :] & beside[:, None], picture, np.zeros((), values.dtype))


def pressure_map(contact: Any, i: int, values: np.ndarray, window: MapWindow, shape: tuple[int, int]) -> np.ndarray:
    """(height, width) of the pressure `values` (columns, rows) on the contact's own grid at saved step `i`."""
    on_cells = isinstance(contact, CellContactResult)
    return (cell_map if on_cells else node_map)(contact, i, values, window, shape)


def _lying_in(lines: np.ndarray, at: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Indices of the cells between the ascending `lines` that contain the positions `at`, the nearest cell for
    positions outside of all, and which positions are inside."""
    cell = np.searchsorted(lines, at, side="right") - 1
    return np.clip(cell, 0, len(lines) - 2), (at >= lines[0]) & (at <= lines[-1])


def pixels(contact: Any, i: int, window: MapWindow, shape: tuple[int, int]) -> np.ndarray:
    """(columns, rows, 2) x, y [pixels from the upper left corner] of the grid's nodes or cell centres, on a map of
    `shape` at saved step `i`."""
    x = (contact.side * contact.arc[i] / window.reach + 1.0) * 0.5 * shape[1]
    y = (window.high - contact.rows[i]) / max(window.high - window.low, 1e-300) * shape[0]
    return np.stack(np.meshgrid(x, y, indexing="ij"), axis=-1)


def _rightwards(contact: Any, i: int, values: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Positions (columns,) [m] along e_theta, ascending, and the values in that order."""
    step = 1 if contact.side > 0.0 else -1
    return contact.side * contact.arc[i][::step], np.asarray(values)[::step]
