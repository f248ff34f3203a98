r"""Pressure functions of a film, with the points where its equation is evaluated.

`Nodes`: all free nodes of a grid, each with its own cavity volume. `Strips`: hat functions around, polynomials along,

    phi_jm = psi_j(theta) (1 - zeta^2) (zeta^m - c_m),      zeta = -1 .. 1 along,   m = 0, 2, ..., or 0, 1, 2, ...

which have zero pressure at both edges, with one cavity volume per column, uniform over the width, and few Gauss points
per strip between columns, one around and two along for each of the n powers. c_0 = 0, and the others make the axial
mean of all but m = 0 vanish. So the cavity volume of a column is the multiplier of a non-negative mean pressure: it
enters the equation of m = 0 alone, whose pressure it replaces; the others are always free, and are zero for uniform gap
and cavity.

Surface motion is given at nodes in either case: `to_nodes` gives pressures there, `between` gaps at the points.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np
import scipy.sparse as sp

from references.films.grid import FilmGrid

Array = np.ndarray
Sparse = Any


@dataclass(frozen=True)
class Basis:
    """at (points, 2) [m], weights (points,) [m2]; value, slope_x, slope_z (points, unknowns); between (points, nodes);
    to_hats (nodes, unknowns); `beside` (voids,): the unknown replaced by a cavity volume, whose
    equation alone it enters; area (voids,) [m2], and outflows (voids, voids) [m] of cavities per speed around, for both
    signs of it."""

    at: Array
    weights: Array
    value: Sparse
    slope_x: Sparse
    slope_z: Sparse
    between: Sparse
    to_nodes: Sparse
    beside: Array
    area: Array
    outflows: tuple[Sparse, Sparse]

    @property
    def unknowns(self) -> int:
        """Of the pressure."""
        return self.value.shape[1]

    def outflow(self, u: float) -> Sparse:
        """(voids, voids) [m2/s] with the speed u [m/s] around."""
        return abs(u) * (self.outflows[0] if u >= 0.0 else self.outflows[1])


def grid_nodes(grid: FilmGrid, free: Array) -> Basis:
    """The `free` (nodes,) bool ones of a grid."""
    number = np.flatnonzero(free)
    of = sp.csr_matrix((np.ones(len(number)), (number, np.arange(len(number)))), shape=(grid.count, len(number)))
    return Basis(
        grid.at, grid.weights, grid.value @ of, grid.slope_x @ of, grid.slope_z @ of, grid.value, of,
        np.arange(len(number)), grid.area[number],
        (grid.outflow(1.0)[number][:, number], grid.outflow(-1.0)[number][:, number]),
    )  # fmt: skip


def strips(grid: FilmGrid, free: Array, powers: tuple[int, ...]) -> Basis:
    """Polynomials of `powers` m on the `free` (columns,) bool ones of a grid that goes around."""
    if grid.period is None:
        raise ValueError("strips go around")
    pitch, half = grid.period / grid.columns, 0.5 * float(grid.z[-1] - grid.z[0])
    middle, n = 0.5 * float(grid.z[-1] + grid.z[0]), len(powers)
    zeta, w = np.polynomial.legendre.leggauss(2 * n)
    columns = np.arange(grid.columns)
    after = (columns + 1) % grid.columns
    at = np.stack(
        [np.repeat(grid.x + 0.5 * pitch, 2 * n), np.tile(middle + half * zeta, grid.columns)], axis=1
    )  # fmt: skip
    whole = np.array([0.0 if m % 2 else 2.0 / (m + 1) - 2.0 / (m + 3) for m in powers])  # of (1 - zeta^2) zeta^m
    if powers[0] != 0:
        raise ValueError("the first power is 0")
    even = np.eye(n)
    even[0, 1:] = -whole[1:] / whole[0]
    along = np.stack([(1.0 - zeta**2) * zeta**m for m in powers], axis=1) @ even  # (2n, n)
    slopes = np.stack(
        [m * zeta ** max(m - 1, 0) * (m > 0) - (m + 2) * zeta ** (m + 1) for m in powers], axis=1
    ) @ even  # fmt: skip

    def operator(left: float, right: float, profile: Array) -> Sparse:
        """(points, columns n) of values left and right of the middle of a strip times a profile along."""
        around = sp.coo_matrix(
            (np.repeat([left, right], grid.columns), (np.tile(columns, 2), np.concatenate([columns, after]))),
            shape=(grid.columns, grid.columns),
        )
        return sp.kron(around, profile).tocsr()

    kept = np.repeat(free, n)
    at_rows = ((grid.z - middle) / half)[:, None]
    in_rows = ((1.0 - at_rows**2) * at_rows ** np.array(powers)[None, :]) @ even
    to_nodes = sp.kron(sp.identity(grid.columns), in_rows).tocsr()
    turned = sp.csr_matrix((np.ones(grid.columns), (after, columns)), shape=(grid.columns, grid.columns))
    identity = sp.identity(grid.columns, format="csr")
    first, second = (half * whole[0] * (identity - carried).tocsr()[free][:, free] for carried in (turned, turned.T))
    in_z = sp.csr_matrix(np.array([np.interp(middle + half * zeta, grid.z, row) for row in np.eye(grid.rows)]).T)
    around = sp.csr_matrix(
        (np.full(2 * grid.columns, 0.5), (np.tile(columns, 2), np.concatenate([columns, after]))),
        shape=(grid.columns, grid.columns),
    )
    voids = int(np.count_nonzero(free))
    return Basis(
        at, np.tile(half * w, grid.columns) * pitch, operator(0.5, 0.5, along)[:, kept],
        operator(-1.0 / pitch, 1.0 / pitch, along)[:, kept], operator(0.5 / half, 0.5 / half, slopes)[:, kept],
        sp.kron(around, in_z).tocsr(), to_nodes[:, kept], n * np.arange(voids), np.full(voids, pitch * half * whole[0]),
        (first, second),
    )  # fmt: skip
