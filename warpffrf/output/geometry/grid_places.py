"""Places on a surface's contact grid, windows put into the whole grid, and turning of vectors."""

from __future__ import annotations

from typing import Any

import numpy as np

# A skin node belongs to a contact surface when it lies within this part of the surface's radius of it, or within
# twice the deviation of the fit: well above the fit's default tolerance (1e-5), below one layer of elements.
ON_SURFACE = 1e-4


def rotate(rotation: np.ndarray, vectors: np.ndarray) -> np.ndarray:
    """Vectors (n, 3) turned by the unit quaternion (x, y, z, w): user axes to world axes."""
    u, w = np.asarray(rotation[:3]), float(rotation[3])
    t = 2.0 * np.cross(u, vectors)
    return vectors + w * t + np.cross(u, t)


def grid_theta_offset(surface: Any) -> float:
    """Angle [rad] from the shape's reference direction e_0 to the grid's: grid theta = shape theta - offset; 0 on a
    plane, whose theta is a length."""
    if surface.shape.kind == "plane":
        return 0.0
    shape, e_0 = surface.shape, np.asarray(surface.grid.e_0)
    return float(np.arctan2(e_0 @ shape.e_1, e_0 @ shape.e_0))


def wrapped(surface: Any, theta: np.ndarray, about: float) -> np.ndarray:
    """theta within half a turn of the place `about`; as it is on a plane, whose theta is a length."""
    if surface.shape.kind == "plane":
        return theta
    return about + (theta - about + np.pi) % (2.0 * np.pi) - np.pi


def spread(surface: Any, first_column: int, window: np.ndarray) -> np.ndarray:
    """A window (columns_w, rows) that starts at `first_column`, put into the whole grid (columns, rows), zero
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
    """Where points lie on a surface's contact grid: bilinear weights on four nodes."""

    def __init__(self, surface: Any, points: np.ndarray, near: float) -> None:
        """points (n, 3) [m, user frame of the surface's body]; `inside` (n,) tells those no farther than `near` [m]
        from the surface and within its grid; the other attributes have a row for each of these."""
        grid = surface.grid
        theta, z, distance = surface.shape.chart(points)
        rows = np.asarray(grid.z, dtype=float)
        column = (np.asarray(theta) - grid_theta_offset(surface) - grid.theta_start) / grid.pitch
        if grid.periodic:
            column = column % grid.columns
        elif surface.shape.kind != "plane":
            full_turn = 2.0 * np.pi / grid.pitch
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
    """Which skin nodes lie on one contact surface, and their places on its grid."""

    def __init__(self, surface: Any, points: np.ndarray) -> None:
        z = np.asarray(surface.grid.z, dtype=float)
        plane = surface.shape.kind == "plane"
        size = float(z[-1] - z[0]) if plane else float(surface.shape.radius_at(0.5 * (z[0] + z[-1])))
        near = max(ON_SURFACE * size, 2.0 * (getattr(surface.shape, "deviation", None) or 0.0))
        self.surface = surface
        self.places = GridPlaces(surface, points, near)
        self.nodes = np.flatnonzero(self.places.inside)

    def interpolate(self, values: np.ndarray) -> np.ndarray:
        """Hat interpolation of (columns, rows) at the surface's skin nodes."""
        return self.places.interpolate(values)
