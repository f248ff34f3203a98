r"""The grid of tractions on a contact surface: bilinear shape functions of its nodes ("nodes"), or constants on
cells around its nodes ("cells").

Both are non-negative and add up to one, so that coefficients >= 0 mean a traction >= 0 everywhere. Bilinear functions
are continuous and overlap; a cell extends half way to the neighbouring nodes, `[theta_j - pitch/2, theta_j + pitch/2] x
[(z_k-1 + z_k)/2, (z_k + z_k+1)/2]`, cut at the outermost rows, and its Gram matrix is diagonal. Cells *between* the
nodes are unsuitable: on a mesh as fine as the grid a checkerboard of them loads no node, and the compliance is
singular.

On a plane the chart is (theta, z) too, theta a length [m] there and its metric radius 1: statements on angles and rad
below then apply in metres.

Functions are numbered column by column, so that neighbours on the surface are neighbours in memory: a window of w
columns of a dense compliance is one contiguous run of w rows of it, a copy of whole runs of entries.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np

from warpffrf.model.errors import unknown_name

KINDS = ("nodes", "cells")
GAUSS_PER_ROW = 6  # points between two grid rows: a crown's measure is not polynomial, six points leave 1e-14 of it


def require_kind(kind: str, name: str = "traction") -> str:
    """`kind`, one of `KINDS`; raises `InputError` with the `name` of the argument otherwise."""
    if not isinstance(kind, str) or kind not in KINDS:
        raise unknown_name(name, kind, KINDS)
    return kind


def cell_edges(z: np.ndarray) -> np.ndarray:
    """Edges (rows + 1,) of the cells around the nodes `z` (rows,): half way between them, and the outermost ones."""
    return np.concatenate([z[:1], 0.5 * (z[1:] + z[:-1]), z[-1:]])


@dataclass(frozen=True, eq=False)
class SurfaceGrid:
    """Bilinear functions or cells over the chart (theta, z).

    Node (j, k) lies at `theta_start + j*pitch`, `z[k]`; its function has the flat index `j*rows + k`. `periodic`: the
    columns close over the full revolution; otherwise they cover an arc, and all supports lie inside the contact
    surface.
    """

    e_0: np.ndarray  # (3,) direction of theta = 0, user axes
    theta_start: float  # rad
    pitch: float  # rad
    columns: int
    periodic: bool
    z: np.ndarray  # (rows,) m, ascending
    columns_per_sector: int
    kind: str = "nodes"

    def __post_init__(self) -> None:
        require_kind(self.kind)

    @property
    def rows(self) -> int:
        """Functions along the meridian."""
        return len(self.z)

    @property
    def theta(self) -> np.ndarray:
        """Angles of the columns (columns,) [rad]."""
        return self.theta_start + self.pitch * np.arange(self.columns)

    def gram_theta(self) -> np.ndarray:
        """M_theta (columns, columns) [rad]: int psi_j psi_j' dtheta."""
        n = self.columns
        if self.kind == "cells":
            return self.pitch * np.eye(n)
        M = np.zeros((n, n))
        j = np.arange(n)
        M[j, j] = 2.0 / 3.0 * self.pitch
        if self.periodic:
            np.add.at(M, (j, (j + 1) % n), self.pitch / 6.0)
            np.add.at(M, ((j + 1) % n, j), self.pitch / 6.0)
        else:
            M[j[:-1], j[1:]] = M[j[1:], j[:-1]] = self.pitch / 6.0
        return M

    def along_theta(self, field: np.ndarray) -> np.ndarray:
        """M_theta times the `field` (columns, ...), without the matrix."""
        if self.kind == "cells":
            return self.pitch * field
        out = 2.0 / 3.0 * self.pitch * field
        if self.periodic:
            return out + self.pitch / 6.0 * (np.roll(field, 1, axis=0) + np.roll(field, -1, axis=0))
        out[1:] += self.pitch / 6.0 * field[:-1]
        out[:-1] += self.pitch / 6.0 * field[1:]
        return out

    def gram_z(self, shape: Any) -> np.ndarray:
        """M_z (rows, rows) [m^2/rad], see `meridian_gram`."""
        return meridian_gram(self.kind, shape, self.z)


def meridian_gram(kind: str, shape: Any, z: np.ndarray) -> np.ndarray:
    """M_z (rows, rows) [m^2/rad]: int psi_k psi_k' R(z) sqrt(1 + R'(z)^2) dz of the functions on the nodes `z` [m].

    `shape` is a resolved surface (`measure_at`). The Gram matrix of the surface is
    `M = M_theta (x) M_z` [m^2], `M f`: coefficients of a traction to forces.
    """
    lines = cell_edges(z) if kind == "cells" else z
    x, w = np.polynomial.legendre.leggauss(GAUSS_PER_ROW)
    s = 0.5 * (x + 1.0)
    step = np.diff(lines)
    points = lines[:-1, None] + step[:, None] * s
    measure = 0.5 * step[:, None] * w * shape.measure_at(points)
    if kind == "cells":
        return np.diag(measure.sum(axis=1))
    rows = len(z)
    grid_nodes = np.stack([1.0 - s, s])
    M = np.zeros((rows, rows))
    local = np.einsum("aq,bq,eq->eab", grid_nodes, grid_nodes, measure)
    for a in range(2):
        for b in range(2):
            np.add.at(M, (np.arange(rows - 1) + a, np.arange(rows - 1) + b), local[:, a, b])
    return M
