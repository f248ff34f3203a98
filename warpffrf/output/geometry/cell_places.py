r"""Where the cells are that travel with a patch, in the chart of the pair's first surface.

Cells are equal strips across, 2 W/columns of arc wide and counted from the middle of the patch, by rows along the
meridian (`CellHistory`). With the radius R_c of the surface at the middle of the rows a strip spans h = 2 W/(columns
R_c) of theta, on every row, and

    theta_j = theta_start + pitch column + (j - (columns - 1)/2) h.

Integrals over the rows are those of the true surface, by a rule that is exact to round-off.
"""

from __future__ import annotations

from functools import cached_property
from typing import Any

import numpy as np

from warpffrf.model.reduced.contact_grid import GAUSS_PER_ROW
from warpffrf.online.history.history import CellHistory
from warpffrf.output.geometry.grid_places import wrapped

ON_LINE = 1e-6  # of the width, or length, of all cells: round-off of the chart, on the end planes of a body


class CellPlaces:
    """Places of the cells of one pair on its first `surface`, one row a saved step."""

    def __init__(self, surface: Any, cells: CellHistory, columns: int) -> None:
        self.surface, self.cells, self.columns = surface, cells, columns

    @cached_property
    def z(self) -> np.ndarray:
        """(T, rows) m, middles of the rows."""
        return np.asarray(self.cells.z, dtype=float)

    @cached_property
    def z_edges(self) -> np.ndarray:
        """(T, rows + 1) m, the lines between the rows, and the outermost ones."""
        half = 0.5 * np.asarray(self.cells.length, dtype=float)
        return np.concatenate([self.z[:, :1] - half[:, :1], self.z + half], axis=1)

    @cached_property
    def middle(self) -> np.ndarray:
        """(T,) m, the middle of the rows."""
        return self.z.mean(axis=1)

    @cached_property
    def radius(self) -> np.ndarray:
        """(T,) metres of arc per unit of theta at the middle of the rows; 1 on a plane."""
        return np.asarray(self.surface.shape.radius_at(self.middle), dtype=float)

    @cached_property
    def width(self) -> np.ndarray:
        """(T,) m of arc, of a strip."""
        return 2.0 * np.asarray(self.cells.half_width, dtype=float) / self.columns

    @cached_property
    def pitch(self) -> np.ndarray:
        """(T,) rad (m on a plane), of a strip."""
        return self.width / self.radius

    @cached_property
    def offset(self) -> np.ndarray:
        """(columns,) strips from the middle of the patch to the middle of each strip."""
        return np.arange(self.columns) - 0.5 * (self.columns - 1)

    @cached_property
    def center(self) -> np.ndarray:
        """(T,) rad (m on a plane), theta of the middle of the patch on the surface's grid."""
        grid = self.surface.grid
        return grid.theta_start + grid.pitch * np.asarray(self.cells.column, dtype=float)

    @cached_property
    def theta(self) -> np.ndarray:
        """(T, columns) rad (m on a plane), middles of the strips on the surface's grid."""
        return self.center[:, None] + self.pitch[:, None] * self.offset

    @cached_property
    def theta_edges(self) -> np.ndarray:
        """(T, columns + 1) rad (m on a plane), the lines between the strips, and the outermost ones."""
        lines = np.arange(self.columns + 1) - 0.5 * self.columns
        return self.center[:, None] + self.pitch[:, None] * lines

    def cells_at(self, i: int, theta: np.ndarray, z: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """Numbers of the strip and the row (n,) in which places (theta on the surface's grid, z) (n,) lie at saved step
        `i`; -1, both, of places beside the cells."""
        theta = wrapped(self.surface, theta, float(self.center[i]))
        found, inside = [], np.ones(np.shape(theta), dtype=bool)
        for lines, at in ((self.theta_edges[i], theta), (self.z_edges[i], z)):
            slack = ON_LINE * (lines[-1] - lines[0])
            inside &= (at >= lines[0] - slack) & (at <= lines[-1] + slack)
            found.append(np.clip(np.searchsorted(lines, at, side="right") - 1, 0, len(lines) - 2))
        return np.where(inside, found[0], -1), np.where(inside, found[1], -1)

    @cached_property
    def _rule(self) -> tuple[np.ndarray, np.ndarray]:
        """Points z (T, rows, q) [m] and weights [m] of a rule over each row."""
        x, w = np.polynomial.legendre.leggauss(GAUSS_PER_ROW)
        half = 0.5 * np.asarray(self.cells.length, dtype=float)[..., None]
        return self.z[..., None] + half * x, half * w

    @cached_property
    def axial(self) -> np.ndarray:
        """(T, 3, rows): int z^n R sqrt(1 + R'^2) dz over each row, n = 0, 1, 2 [m2/rad, m3/rad, m4/rad]."""
        z, weight = self._rule
        weight = weight * self.surface.shape.measure_at(z)
        return np.stack([(weight * z**n).sum(axis=-1) for n in range(3)], axis=1)

    @cached_property
    def rings(self) -> np.ndarray:
        """(T, 3, rows) int R dz [m2], int R R' dz [m2], int (z + R R') R dz [m3] over each row."""
        z, weight = self._rule
        shape = self.surface.shape
        R, slope = shape.radius_at(z), shape.slope_at(z)
        return np.stack(
            [(weight * f).sum(axis=-1) for f in (R, R * slope, (z + R * slope) * R)],
            axis=1,
        )

    @cached_property
    def areas(self) -> np.ndarray:
        """(T, rows) m2, of the cells of one strip."""
        return self.pitch[:, None] * self.axial[:, 0]
