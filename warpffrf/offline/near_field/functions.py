"""The functions of a contact grid as unit loads on a surface that is laid flat: hats, and cells of tangential ones."""

from __future__ import annotations

from typing import Any

import numpy as np

from warpffrf.model.mesh import Mesh
from warpffrf.model.reduced.contact_grid import ContactGrid
from warpffrf.offline.contact.traction_fields import ContactFacets
from warpffrf.offline.near_field.charts import FlatChart
from warpffrf.offline.near_field.exact import PointLoads

Array = np.ndarray
GAUSS = 3  # points on either side of a node and direction, of loads as the cut faces see them: those are REACH away


class SpreadFunctions:
    """The functions of a contact `grid`, hats or cells, on a resolved `shape`: their areas, and unit loads spread over
    them as forces at points."""

    def __init__(self, shape: Any, grid: ContactGrid) -> None:
        self.shape, self.grid = shape, grid
        x, w = np.polynomial.legendre.leggauss(GAUSS)
        x, w = 0.5 * (x + 1.0), 0.5 * w
        share, value = (1.0, 1.0 - x) if grid.kind == "hats" else (0.5, np.ones(GAUSS))  # of the step to the next node
        reach = share * np.diff(grid.z)
        rows = grid.rows
        self._z = np.repeat(grid.z[:, None], 2 * GAUSS, axis=1)
        self._z_weight = np.zeros((rows, 2 * GAUSS))
        for here, side, beyond in (
            (np.s_[1:, :GAUSS], -1.0, grid.z[1:, None]),
            (np.s_[:-1, GAUSS:], 1.0, grid.z[:-1, None]),
        ):
            self._z[here] = beyond + side * reach[:, None] * x
            self._z_weight[here] = w * value * reach[:, None] * shape.measure_at(self._z[here])
        self.area = grid.pitch * grid.gram_z(shape).sum(axis=1)  # (rows,) [m^2] of the functions of a column
        self._z_weight /= self._z_weight.sum(axis=1)[:, None]
        self._turn = grid.pitch * share * np.concatenate([-x, x])
        self._turn_weight = share * np.concatenate([w * value, w * value])

    def point_loads(self, chart: FlatChart, columns: Array, rows: Array) -> PointLoads:
        """Functions of `columns` x `rows` (row fastest) as unit forces at points of the chart."""
        g = self.grid
        shape = (len(columns), len(rows), len(self._turn), self._z.shape[1])
        theta = (g.theta_start + g.pitch * columns)[:, None, None, None] + self._turn[:, None]
        z = self._z[rows][:, None, :]
        s, t = chart.on_surface(np.broadcast_to(theta, shape), np.broadcast_to(z, shape))
        force = np.broadcast_to(self._turn_weight[:, None] * self._z_weight[rows][:, None, :], shape)
        return PointLoads(*(np.ascontiguousarray(v).reshape(len(columns) * len(rows), -1) for v in (s, t, force)))


class NearFunctions:
    """The hats of a contact `grid` on the facets of set `name`, and the cells of a grid `tangential` on the same nodes
    where there is one."""

    def __init__(
        self, mesh: Mesh, name: str, shape: Any, grid: ContactGrid, tangential: ContactGrid | None = None
    ) -> None:
        self.mesh, self.shape, self.grid, self.name = mesh, shape, grid, name
        self.surface = mesh.facets(name)
        self.facets = ContactFacets.of(mesh.points, self.surface, shape)
        self.edge = self.facets.chart.edge
        around = grid.pitch * float(np.max(shape.radius_at(grid.z)))
        self.spacing = max(self.edge, around, float(np.max(np.diff(grid.z))))  # [m]
        self.hats = SpreadFunctions(shape, grid)
        self.cells = None if tangential is None else SpreadFunctions(shape, tangential)

    @property
    def blocks(self) -> list[tuple[str, SpreadFunctions, SpreadFunctions]]:
        """Parts of the compliance: name, functions of the displacement, functions of the force."""
        found = [("nn", self.hats, self.hats)]
        if self.cells is not None:
            found += [("tt", self.cells, self.cells), ("tn", self.cells, self.hats)]
        return found
