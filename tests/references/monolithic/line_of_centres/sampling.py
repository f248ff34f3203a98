r"""Tests of a contact law: weak tests by the functions of the first grid, or the FE nodes of the first surface.

Both are functions on points of the first surface: point p lies at the grid column x_p and in the axial section s(p);
its weight in test i is T_pi (>= 0). The gap of test i is `g_i = sum_p T_pi g_p`, and a unit of its multiplier is the
pressure T_pi at p.

    nodes    Gauss points of the cells, T_pi = weight dA psi_i: weak gaps, the law of the separated solver
    nodes   p = i the nodes of the finite elements, T = 1: gaps at nodes, the multiplier is the force of a node

The body's own displacement enters test i as `W_i.u`, u nodal coefficients: W = Gram matrix M of the grid, or the shape
functions at the FE nodes (there the normal displacement is that of the same trace functions).
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np
from scipy import sparse

ON_SURFACE = 1e-6  # of the radius: nodes lie on the true surface to the round-off of the mesh file
SAME_STATION = 1e-9  # of the width: axial positions that differ by less are one section
THETA_POINTS, Z_POINTS = 3, 2  # Gauss points of a cell, those of the separated solver


@dataclass(frozen=True, eq=False)
class Tests:
    """n tests on P points: T^T (n, P) sparse, its entries as `test`, `point`, `value` (m,), their sums by section (n,
    S), and the areas (n,) of the tests."""

    transposed: Any
    test: np.ndarray
    point: np.ndarray
    value: np.ndarray
    by_station: np.ndarray
    area: np.ndarray


def _tests(transposed: Any, station: np.ndarray, stations: int, area: np.ndarray | None) -> Tests:
    entries = transposed.tocoo()
    pick = sparse.csr_matrix((np.ones(len(station)), (np.arange(len(station)), station)), (len(station), stations))
    by_station = np.asarray((transposed @ pick).todense())
    areas = by_station.sum(axis=1) if area is None else area
    return Tests(transposed.tocsr(), entries.row, entries.col, entries.data, by_station, areas)


@dataclass(frozen=True, eq=False)
class Points:
    """Points: x (P,) [columns], station (P,); their tests, the numbers of the tests (n,) and the columns (n,) of
    these."""

    x: np.ndarray
    station: np.ndarray
    tests: Tests
    number: np.ndarray
    column: np.ndarray


class NodalTests:
    """The nodes of the first grid, numbered column by column over the whole grid."""

    def __init__(self, surface: Any) -> None:
        grid, shape = surface.grid, surface.shape
        self.grid, self.gram_z = grid, surface.gram_z
        xz, wz = _gauss(Z_POINTS)
        step = np.diff(grid.z)
        self.z = (grid.z[:-1, None] + step[:, None] * xz).ravel()
        measure = shape.radius_at(self.z) * np.sqrt(1.0 + shape.slope_at(self.z) ** 2)
        weight = (step[:, None] * wz).ravel() * measure
        cell, at = np.repeat(np.arange(len(step)), Z_POINTS), np.tile(xz, len(step))
        self.along = np.zeros((len(self.z), grid.rows))
        n = np.arange(len(cell))
        self.along[n, cell], self.along[n, cell + 1] = (1.0 - at) * weight, at * weight
        self.kept: dict[tuple[int, bytes], Tests] = {}

    def own(self, field: np.ndarray) -> np.ndarray:
        """W times `field` (nodes, n): weak displacements."""
        grid = self.grid
        u = field.reshape(grid.columns, grid.rows, -1)
        return np.einsum("kl,jlm->jkm", self.gram_z, grid.along_theta(u)).reshape(field.shape)

    def points(self, middle: float, half: int, faces: np.ndarray) -> Points:
        """Points and tests of the columns within `half` of the column `middle`; sections facing nothing weigh 0."""
        grid = self.grid
        centre = int(np.floor(middle + 0.5))
        columns = np.arange(centre - half, centre + half + 1)
        if not grid.periodic:
            columns = columns[(columns >= 0) & (columns < grid.columns)]
        cells = np.arange(columns[0] - 1, columns[-1] + 1)
        xt, _ = _gauss(THETA_POINTS)
        x, S = (cells[:, None] + xt).ravel(), len(self.z)
        station = np.tile(np.arange(S), len(x))
        key = (len(columns), faces.tobytes())
        if key not in self.kept:
            along = sparse.csr_matrix((self.along * faces[:, None]).T)
            around = sparse.csr_matrix(self._around(len(columns)).T)
            self.kept[key] = _tests(sparse.kron(around, along, format="csr"), station, S, None)
        number = (np.mod(columns, grid.columns)[:, None] * grid.rows + np.arange(grid.rows)).ravel()
        return Points(np.repeat(x, S), station, self.kept[key], number, np.repeat(columns.astype(float), grid.rows))

    def _around(self, columns: int) -> np.ndarray:
        """Weights (points around, columns): column n has the cells n and n + 1 below and above it."""
        xt, wt = _gauss(THETA_POINTS)
        around, n = np.zeros((columns + 1, THETA_POINTS, columns)), np.arange(columns)
        around[n, :, n] = xt * wt
        around[n + 1, :, n] = (1.0 - xt) * wt
        return self.grid.pitch * around[: columns + 1].reshape(-1, columns)


class NodeTests:
    """The nodes of the body's skin that lie on the contact surface, and their shares of its area."""

    def __init__(self, surface: Any, skin: Any) -> None:
        grid, shape = surface.grid, surface.shape
        self.grid = grid
        theta, z, distance = shape.chart(skin.points)
        on = np.abs(distance) < ON_SURFACE * shape.radius
        width = grid.z[-1] - grid.z[0]
        on &= (z > grid.z[0] - SAME_STATION * width) & (z < grid.z[-1] + SAME_STATION * width)
        offset = np.arctan2(grid.e_0 @ shape.e_1, grid.e_0 @ shape.e_0)
        self.turn = 2.0 * np.pi / grid.pitch
        self.x = np.mod((theta[on] - offset - grid.theta_start) / grid.pitch, self.turn)
        if not grid.periodic:  # nodes beyond the arc that the grid covers have no trace
            covered = np.mod(self.x, self.turn) <= grid.columns - 1
            on[np.flatnonzero(on)[~covered]] = False
            self.x = self.x[covered]
        places, self.station = np.unique(np.round((z[on] - grid.z[0]) / (SAME_STATION * width)), return_inverse=True)
        self.z = grid.z[0] + places * SAME_STATION * width
        self.share = _shares(skin, on)[on]
        self.grid_nodes = _node_values(grid, self.x, self.z[self.station])

    def own(self, field: np.ndarray) -> np.ndarray:
        """W times `field` (nodes, n): displacements of the FE nodes."""
        return self.grid_nodes @ field

    def points(self, middle: float, half: int, faces: np.ndarray) -> Points:
        """Nodes within `half` columns of `middle` that face the other surface."""
        x = self.x - self.turn * np.floor((self.x - middle) / self.turn + 0.5)
        chosen = np.flatnonzero((np.abs(x - middle) <= half) & faces[self.station])
        one = sparse.identity(len(chosen), format="csr")
        tests = _tests(one, self.station[chosen], len(self.z), self.share[chosen])
        return Points(x[chosen], self.station[chosen], tests, chosen, x[chosen])


def _gauss(count: int) -> tuple[np.ndarray, np.ndarray]:
    """Gauss points and weights on (0, 1)."""
    x, w = np.polynomial.legendre.leggauss(count)
    return 0.5 * (x + 1.0), 0.5 * w


def _shares(skin: Any, on: np.ndarray) -> np.ndarray:
    """Area (n,) of each skin point: a third of the triangles around it that lie on the surface."""
    triangles = skin.triangles[on[skin.triangles].all(axis=1)]
    corners = skin.points[triangles]
    area = 0.5 * np.linalg.norm(np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0]), axis=1)
    share = np.zeros(len(skin.points))
    np.add.at(share, triangles.ravel(), np.repeat(area / 3.0, 3))
    return share


def _node_values(grid: Any, x: np.ndarray, z: np.ndarray) -> Any:
    """Values (points, nodes) of all shape functions at grid columns x and axial positions z."""
    column, row, u, v, _ = cells_of(grid, x, z)
    data, i, j = [], [], []
    for step, part in ((0, 1.0 - u), (1, u)):
        for up, piece in ((0, 1.0 - v), (1, v)):
            at = column + step
            inside = np.ones(len(at), dtype=bool) if grid.periodic else (at >= 0) & (at < grid.columns)
            i.append(np.flatnonzero(inside))
            j.append((np.mod(at, grid.columns) * grid.rows + row + up)[inside])
            data.append((part * piece)[inside])
    shape = (len(x), grid.columns * grid.rows)
    return sparse.csr_matrix((np.concatenate(data), (np.concatenate(i), np.concatenate(j))), shape=shape)


def cells_of(
    grid: Any, x: np.ndarray, z: np.ndarray
) -> tuple[np.ndarray, np.ndarray, np.ndarray, np.ndarray, np.ndarray]:
    """Column and row of the cell that contains (x, z), local coordinates (u, v) in it, and dv/dz (0 beyond the ends,
    where the field continues as constant)."""
    column = np.floor(x).astype(np.intp)
    row = np.clip(np.searchsorted(grid.z, z, side="right") - 1, 0, grid.rows - 2)
    step = grid.z[row + 1] - grid.z[row]
    v = (z - grid.z[row]) / step
    slope = np.where((v >= 0.0) & (v <= 1.0), 1.0 / step, 0.0)
    return column, row, x - column, np.clip(v, 0.0, 1.0), slope
