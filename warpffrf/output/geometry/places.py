r"""Positions of cells that move with a patch, in the chart of the contact's first surface.

Cells are equal strips across, 2 W/columns of arc wide and counted from the middle of the patch, by rows along the
meridian (`CellHistory`). With the radius R_c of the surface at the middle of the rows a strip spans h = 2 W/(columns
R_c) of theta, on every row, and

    theta_j = theta_start + pitch column + (j - (columns - 1)/2) h.

On a helical surface, whose line of contact is inclined, each row is counted from a column of its own: `shift`.

Integrals over the rows are those of the true surface, by a rule that is exact to round-off.

Grid places. Positions on a surface's contact grid, windows inserted into the whole grid, and rotation of vectors.

Poses. Poses of the two bodies of a contact, and the relative curvature of their true surfaces at the contact.

Every shape has a chart (theta, z), an outward normal n away from the material, and unit tangents with `e_theta x t_z =
n`. Outside of a body e_theta points to increasing theta, on an inside form (bore, ring, cup) to decreasing theta, with
`side` = +1, -1. A plane counts theta in metres along e_theta and has the metric radius 1, so that arc = radius * theta
everywhere.

Near a common point with a common normal the undeformed gap of two surfaces is `1/2 x.(K1 + K2).x`, each tensor `K =
k_theta e_theta e_theta + k_z t_z t_z` in the common tangent plane, convex positive.
"""

from __future__ import annotations

from collections.abc import Mapping
from functools import cached_property
from typing import Any

import numpy as np

from warpffrf.model.reduced.contact_grid import GAUSS_PER_ROW
from warpffrf.online.history.history import CellHistory

ON_LINE = 1e-6  # of the width, or length, of all cells: round-off of the chart on the end planes of a body


class CellPlaces:
    """Positions of the cells of one contact on its first `surface`, one row per saved step."""

    def __init__(self, surface: Any, cells: CellHistory, columns: int) -> None:
        self.surface, self.cells, self.columns = surface, cells, columns

    @cached_property
    def z(self) -> np.ndarray:
        """(T, rows) m, centres of the rows."""
        return np.asarray(self.cells.z, dtype=float)

    @cached_property
    def z_edges(self) -> np.ndarray:
        """(T, rows + 1) m, boundaries of the rows."""
        half = 0.5 * np.asarray(self.cells.length, dtype=float)
        return np.concatenate([self.z[:, :1] - half[:, :1], self.z + half], axis=1)

    @cached_property
    def middle(self) -> np.ndarray:
        """(T,) m, centre of the rows."""
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
        """(columns,) strips from the centre of the patch to the centre of each strip."""
        return np.arange(self.columns) - 0.5 * (self.columns - 1)

    @cached_property
    def center(self) -> np.ndarray:
        """(T,) rad (m on a plane), theta of the centre of the patch on the surface's grid."""
        grid = self.surface.grid
        return grid.theta_start + grid.pitch * np.asarray(self.cells.column, dtype=float)

    @cached_property
    def theta(self) -> np.ndarray:
        """(T, columns) rad (m on a plane), centres of the strips on the surface's grid, less the `shift` of the row."""
        return self.center[:, None] + self.pitch[:, None] * self.offset

    @cached_property
    def shift(self) -> np.ndarray:
        """(T, rows) rad (m on a plane), theta of the middle of each row from that of the patch."""
        return self.surface.grid.pitch * np.asarray(self.cells.row_shift, dtype=float)

    def shift_at(self, i: int, z: np.ndarray) -> np.ndarray:
        """`shift` at places z (n,) [m] at saved step `i`."""
        return np.interp(z, self.z[i], self.shift[i])

    @cached_property
    def theta_edges(self) -> np.ndarray:
        """(T, columns + 1) rad (m on a plane), boundaries of the strips."""
        lines = np.arange(self.columns + 1) - 0.5 * self.columns
        return self.center[:, None] + self.pitch[:, None] * lines

    def cells_at(self, i: int, theta: np.ndarray, z: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """Indices of the strip and the row (n,) that contain the positions (theta on the surface's grid, z) (n,) at
        saved step `i`; -1, both, for positions outside of the cells."""
        theta = wrapped(self.surface, theta - self.shift_at(i, z), float(self.center[i]))
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
        return np.stack([(weight * f).sum(axis=-1) for f in (R, R * slope, (z + R * slope) * R)], axis=1)

    @cached_property
    def areas(self) -> np.ndarray:
        """(T, rows) m2, of the cells of one strip."""
        return self.pitch[:, None] * self.axial[:, 0]


# A skin node belongs to a contact surface if its distance is within this fraction of the surface's radius, or twice the
# deviation of the fit: well above the fit's default tolerance (1e-5), below one layer of elements.
ON_SURFACE = 1e-4


def rotate(rotation: np.ndarray, vectors: np.ndarray) -> np.ndarray:
    """Vectors (n, 3) rotated by the unit quaternion (x, y, z, w): user axes to world axes."""
    u, w = np.asarray(rotation[:3]), float(rotation[3])
    t = 2.0 * np.cross(u, vectors)
    return vectors + w * t + np.cross(u, t)


def grid_theta_offset(surface: Any) -> float:
    """Angle [rad] from the shape's reference direction e_0 to the grid's: grid theta = shape theta - offset; 0 where
    theta is a length."""
    if surface.shape.profile().planar:
        return 0.0
    shape, e_0 = surface.shape, np.asarray(surface.grid.e_0)
    return float(np.arctan2(e_0 @ shape.e_1, e_0 @ shape.e_0))


def wrapped(surface: Any, theta: np.ndarray, about: float) -> np.ndarray:
    """theta within half a period of `about`; unchanged where it has none, as on a plane."""
    turn = surface.shape.profile().turn
    if not np.isfinite(turn):
        return theta
    return about + (theta - about + 0.5 * turn) % turn - 0.5 * turn


def spread(surface: Any, first_column: int, window: np.ndarray) -> np.ndarray:
    """A window (columns_w, rows) that starts at `first_column`, inserted into the whole grid (columns, rows), zero
    elsewhere."""
    grid = surface.grid
    whole = np.zeros((grid.columns, len(grid.z)))
    columns = int(first_column) + np.arange(len(window))
    if grid.periodic:
        np.add.at(whole, columns % grid.columns, window)
    else:
        inside = (columns >= 0) & (columns < grid.columns)
        whole[columns[inside]] = window[inside]
    return whole


class GridPlaces:
    """Positions of points on a surface's contact grid: bilinear weights on four nodes."""

    def __init__(self, surface: Any, points: np.ndarray, near: float) -> None:
        """points (n, 3) [m, user frame of the surface's body]; `inside` (n,) marks those no farther than `near` [m]
        from the surface and within its grid; the other attributes have a row for each of these."""
        grid = surface.grid
        theta, z, distance = surface.shape.chart(points)
        rows = np.asarray(grid.z, dtype=float)
        column = (np.asarray(theta) - grid_theta_offset(surface) - grid.theta_start) / grid.pitch
        if grid.periodic:
            column = column % grid.columns
        elif np.isfinite(turn := surface.shape.profile().turn):
            full_turn = turn / grid.pitch
            column = (column + 0.5) % full_turn - 0.5  # a node half a pitch before the first column still belongs to it
        slack = 1e-6 * max(rows[-1] - rows[0], 1e-300)  # round-off of the chart at the end planes
        on = (np.abs(distance) < near) & (z > rows[0] - slack) & (z < rows[-1] + slack)
        if not grid.periodic:
            on &= (column > -1.0) & (column < grid.columns)
        self.inside = on
        column, z = column[on], np.clip(z[on], rows[0], rows[-1])
        j = np.floor(column).astype(int)
        k = np.clip(np.searchsorted(rows, z, side="right") - 1, 0, max(len(rows) - 2, 0))
        k1 = np.minimum(k + 1, len(rows) - 1)
        s = column - j
        t = np.where(k1 > k, (z - rows[k]) / np.where(k1 > k, rows[k1] - rows[k], 1.0), 0.0)
        j0, j1 = j, j + 1
        if grid.periodic:
            j0, j1 = j0 % grid.columns, j1 % grid.columns
        inside0, inside1 = (j0 >= 0) & (j0 < grid.columns), (j1 >= 0) & (j1 < grid.columns)
        j0, j1 = np.clip(j0, 0, grid.columns - 1), np.clip(j1, 0, grid.columns - 1)
        self.columns = np.stack([j0, j1, j0, j1])
        self.rows = np.stack([k, k, k1, k1])
        weights = np.stack([(1 - s) * (1 - t), s * (1 - t), (1 - s) * t, s * t])
        self.weights = weights * np.stack([inside0, inside1, inside0, inside1])

    def interpolate(self, values: np.ndarray) -> np.ndarray:
        """Bilinear values of (columns, rows) at the points inside."""
        return (self.weights * values[self.columns, self.rows]).sum(axis=0)

    def nearest(self, values: np.ndarray) -> np.ndarray:
        """Values of (columns, rows) at the node nearest to each point inside."""
        best = np.argmax(self.weights, axis=0), np.arange(self.weights.shape[1])
        return values[self.columns[best], self.rows[best]]


class SkinSurface:
    """Skin nodes that lie on one contact surface, and their positions on its grid."""

    def __init__(self, surface: Any, points: np.ndarray) -> None:
        z = np.asarray(surface.grid.z, dtype=float)
        planar = surface.shape.profile().planar
        size = float(z[-1] - z[0]) if planar else float(surface.shape.radius_at(0.5 * (z[0] + z[-1])))
        near = max(ON_SURFACE * size, 2.0 * (getattr(surface.shape, "deviation", None) or 0.0))
        self.surface = surface
        self.places = GridPlaces(surface, points, near)
        self.nodes = np.flatnonzero(self.places.inside)

    def interpolate(self, values: np.ndarray) -> np.ndarray:
        """Bilinear interpolation of (columns, rows) at the surface's skin nodes."""
        return self.places.interpolate(values)


class Pose:
    """Position (3,) [m] and unit quaternion (4,) of a user frame in the world; the identity for the ground."""

    def __init__(self, position: Any = (0.0, 0.0, 0.0), rotation: Any = (0.0, 0.0, 0.0, 1.0)) -> None:
        self.position, self.rotation = np.asarray(position, float), np.asarray(rotation, float)

    @classmethod
    def of(cls, bodies: Mapping[str, Any], name: str, i: int) -> Pose:
        """Pose of the body called `name` at saved step `i`; a name without a motion is the ground."""
        motion = bodies.get(name)
        return cls() if motion is None else cls(motion.position[i], motion.rotation[i])

    def to_world(self, points: np.ndarray) -> np.ndarray:
        """Points (n, 3) [m] of the user frame in the world."""
        return self.position + rotate(self.rotation, points)

    def to_user(self, points: np.ndarray) -> np.ndarray:
        """World points (n, 3) [m] in the user frame."""
        return self.turned_back(np.asarray(points) - self.position)

    def turned(self, vectors: np.ndarray) -> np.ndarray:
        """Vectors (n, 3) in user axes -> world axes."""
        return rotate(self.rotation, vectors)

    def turned_back(self, vectors: np.ndarray) -> np.ndarray:
        """Vectors (n, 3) in world axes -> user axes."""
        return rotate(self.rotation * np.array([-1.0, -1.0, -1.0, 1.0]), vectors)


def tangents(shape: Any, theta: Any, z: Any) -> np.ndarray:
    """Unit vectors (2, n, 3) e_theta and t_z at chart coordinates theta [rad, m on a plane], z [m], each (n,); user
    axes."""
    theta, z = np.atleast_1d(theta), np.atleast_1d(z)
    return np.stack([np.broadcast_to(shape.around(theta, z), (*theta.shape, 3)), shape.along(theta, z)])


def relative_curvature(first: Any, second: Any, poses: tuple[Pose, Pose], theta: float, z: float) -> np.ndarray:
    """K1 + K2 (2, 2) [1/m] along (e_theta, t_z) of the shape `first` at its point (theta, z); `second` is evaluated at
    its nearest point."""
    point = np.asarray(first.point(theta, z)).reshape(1, 3)
    theta2, z2, _ = second.chart(poses[1].to_user(poses[0].to_world(point)))
    mine = poses[0].turned(tangents(first, theta, z)[:, 0])  # (2, 3), world
    turn = mine @ poses[1].turned(tangents(second, theta2, z2)[:, 0]).T  # the second's tangents in the first's
    own = np.diag([float(np.ravel(k)[0]) for k in first.curvatures(theta, z)])
    other = np.diag([float(np.ravel(k)[0]) for k in second.curvatures(theta2, z2)])
    return own + turn @ other @ turn.T
