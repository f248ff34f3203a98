r"""One contact whose pressure is constant on cells that move with the patch, `CellHistory`.

With strips of width w at x_j along the arc the sums over the section are

    P' = w sum_j p_j,      c = sum_j p_j x_j / sum_j p_j,      m2 = sum_j p_j (x_j - c)^2 / sum_j p_j,

and half-widths follow from second moments as on nodes of the contact grid (`result`). The gap is evaluated at the
centre of each cell, and the pressure there is a sample of a smooth function: with the own moment w^2/12 of a strip in
m2, as for a pressure constant on strips, the Hertz half-width on nine strips is 1.5 % too large, without it 0.6 %
(tests/output, `test_half_width_on_strips`). The largest pressure is a sample up to half a strip from the peak and
depends on the position of the strips: between two of eight strips it is 0.8 % below the Hertz peak. The reported peak
is that of the parabola through the largest cell and its neighbours across, for a point contact also along the meridian.
A line contact, whose pressure rises towards free ends, has no parabola along its rows. Fields are those of the cells.
"""

from __future__ import annotations

from functools import cached_property

import numpy as np

from warpffrf.output.contact.hertz import flexible_sides
from warpffrf.output.contact.pair_result import LineMoments, PairResult, section_moments
from warpffrf.output.contact.patch_moments import CellMoments, PatchMeasure
from warpffrf.output.contact.stress_error import StressError, unknown
from warpffrf.output.geometry.places import CellPlaces

LEAST = 0.5  # strips: half of the minimum of one strip per patch


def peak_above(before: np.ndarray, largest: np.ndarray, after: np.ndarray) -> np.ndarray:
    """Rise of the parabola through three equally spaced samples above the middle one, the largest [its unit]; 0 if a
    neighbour is zero (the pressure ends there, without a parabola)."""
    bend = 2.0 * largest - before - after
    inside = (before > 0.0) & (after > 0.0) & (bend > 0.0)
    return np.where(inside, (after - before) ** 2 / (8.0 * np.where(inside, bend, 1.0)), 0.0)


def _beside(values: np.ndarray, at: np.ndarray) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Samples (T,) of values (T, n) before, at and after the positions `at` (T,); 0 beyond the ends."""
    padded, steps = np.pad(values, ((0, 0), (1, 1))), np.arange(len(values))
    return padded[steps, at], padded[steps, at + 1], padded[steps, at + 2]


class CellContactResult(PairResult):
    """One contact whose pressure is given on cells that move with the patch, see `PairResult`; arrays have one row per
    saved step."""

    loaded = "cells"

    @cached_property
    def places(self) -> CellPlaces:
        """Positions of the cells in the chart of the first surface."""
        return CellPlaces(self.view.first, self.history.cells, self.history.pressure.shape[1])

    @property
    def z(self) -> np.ndarray:
        """(T, rows) m, centres of the rows along the axis of the first surface."""
        return self.places.z

    @property
    def rows(self) -> np.ndarray:
        """(T, rows) m, `z`."""
        return self.places.z

    @property
    def spacing(self) -> np.ndarray:
        """(T,) m of arc, width of a strip."""
        return self.places.width

    @property
    def window(self) -> float:
        """Half the arc [m] covered by the strips, the longest of the run."""
        return 0.5 * self.history.pressure.shape[1] * float(np.max(self.spacing, initial=0.0))

    @cached_property
    def _beside_center(self) -> np.ndarray:
        """(T,) rad, centre of the patch from the line of centres."""
        grid = self.view.first.grid
        column = self.history.cells.column - self.history.center_column
        turn = self.view.first.shape.profile().turn / grid.pitch
        if np.isfinite(turn):  # modulo the columns of the full revolution: the shortest way round
            column = (column + 0.5 * turn) % turn - 0.5 * turn
        return grid.pitch * column

    @cached_property
    def arc(self) -> np.ndarray:
        """(T, columns) m, centres of the strips along the circle through the middle of the rows, from the line of
        centres."""
        middle = self.places.radius * self._beside_center
        return middle[:, None] + self.spacing[:, None] * self.places.offset

    @property
    def cell_areas(self) -> np.ndarray:
        """(T, rows) m2, of the cells of one strip; they vary with the width of the patch."""
        return self.places.areas

    @cached_property
    def patch_center(self) -> np.ndarray:
        """(T, 2) theta and z, centre of the cells, for a point contact at the height of the centre of pressure."""
        z = self.places.middle
        if self.patch_kind == "point":
            z = np.where(self.touching, self.moments.center[:, 1], z)
        return np.stack([self.places.center, z], axis=1)

    @property
    def creep_place(self) -> np.ndarray:
        """(T, 2) theta and z, centre of the cells."""
        return np.stack([self.places.center, self.places.middle], axis=1)

    def cell_lines(self, i: int) -> tuple[np.ndarray, np.ndarray]:
        """Lines arc (columns + 1,) and z (rows + 1,) [m] between the cells of saved step `i`."""
        arc, half = self.arc[i], 0.5 * self.spacing[i]
        return np.append(arc - half, arc[-1:] + half), self.places.z_edges[i]

    @property
    def theta(self) -> np.ndarray:
        """(T, columns) rad (m on a plane), centres of the strips on the first surface's grid."""
        return self.places.theta

    def reaches_ends(self, i: int) -> bool:
        """True if the patch of saved step `i` reaches both ends of an arc: beyond the outermost columns of its grid,
        whose spacing on a coarse mesh is large compared with a patch."""
        grid = self.view.first.grid
        columns = np.flatnonzero(np.any(self.history.pressure[i] > 0.0, axis=1))
        if grid.periodic or not len(columns):
            return False
        edges = self.places.theta_edges[i]
        return bool(edges[columns[0]] < grid.theta[0] and edges[columns[-1] + 1] > grid.theta[-1])

    # --- pressure ---

    @property
    def mean_pressure(self) -> np.ndarray:
        """(T, columns, rows) Pa, pressure of each cell."""
        return self.history.pressure

    @cached_property
    def moments(self) -> CellMoments:
        """Load, centre and covariance of the whole patch."""
        theta = self._beside_center[:, None] + self.places.pitch[:, None] * self.places.offset
        return CellMoments(PatchMeasure(self.view.first), self.places, self.history.pressure, theta)

    @cached_property
    def _line(self) -> LineMoments:
        found = section_moments(self.arc, self.mid_pressure, self.spacing, 0.0)
        least = LEAST * self.spacing * (self.mid_pressure.max(axis=1) > 0.0)
        return found._replace(half_width=np.maximum(found.half_width, least))

    @cached_property
    def patch_area(self) -> np.ndarray:
        """(T,) m2, area of the cells with positive pressure: to within half a cell along the edge of the patch."""
        return ((self.history.pressure > 0.0).sum(axis=1) * self.places.areas).sum(axis=1)

    @cached_property
    def peak_pressure(self) -> np.ndarray:
        """(T,) Pa, largest pressure in the patch, by parabolas through the largest cell (see the module)."""
        p = self.history.pressure
        flat = p.reshape(len(p), p.shape[1] * p.shape[2])
        steps, (j, k) = np.arange(len(p)), np.unravel_index(np.argmax(flat, axis=1), p.shape[1:])
        around = _beside(p[steps, :, k], j)
        found = around[1] + peak_above(*around)
        if self.patch_kind == "point":
            found = found + peak_above(*_beside(p[steps, j], k))
        return np.maximum(found, 0.0)

    @cached_property
    def mid_peak_pressure(self) -> np.ndarray:
        """(T,) Pa, largest pressure in the section of `mid_pressure`, by the parabola through its largest cell: for
        comparison with Hertz."""
        found = _beside(self.mid_pressure, np.argmax(self.mid_pressure, axis=1))
        return np.maximum(found[1] + peak_above(*found), 0.0)

    def pressure_resultants(self) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
        """For the cells: (T,) [-], (T,) [rad] and (T, 3, rows) [m2, m2, m3], see `PairResult`."""
        return 2.0 * np.sin(0.5 * self.places.pitch), self.places.pitch, self.places.rings

    def stress_errors(self, i: int) -> dict[str, StressError]:
        """NaN with the reason: the rule counts nodes in the half-width, but the cells of such a contact are finer than
        the mesh, whose stress is corrected by the half-space below them."""
        why = (
            "its rule is that of a pressure on the contact grid, and this one is on cells that travel with the "
            'patch; compare with Contact(..., grid="body_fixed") on a fine mesh'
        )
        return {body.name: unknown(self, why) for body, _ in flexible_sides(self.view)}
