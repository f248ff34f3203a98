r"""The deformed skin of a body at a saved step, and the pressure on it.

    x_user = X + Phi_g(X) q + recover(f)

`recover` is the local modes' response to outward hat forces `f_i = int psi_i p dA`. On a pair's first surface the
pressure is known by its hat coefficients, pushes inwards, and `f = -M p` with the hat Gram matrix `M = M_theta (x)
M_z` on the true surface,

    M_theta = pitch/6 [1 4 1],     M_z[k, l] = int zeta_k zeta_l R(z) sqrt(1 + R'(z)^2) dz;

on the second surface the run recorded hat forces, positive inwards, and `f = -load_second`.
For colours the second surface's pressure is `load_i / int psi_i dA` (the row-summed Gram matrix: positive, and exact
for a constant).
"""

from __future__ import annotations

from typing import Any

import numpy as np

from warpffrf.output.scene_view import BodyView, SceneView

# A skin node belongs to a contact surface when it lies within this part of the surface's radius of it, or within
# twice the deviation of the fit: well above the fit's default tolerance (1e-5), below one layer of elements.
ON_SURFACE = 1e-4


def grid_theta_offset(surface: Any) -> float:
    """Angle [rad] from the shape's reference direction e_0 to the grid's: grid theta = shape theta - offset."""
    shape, e_0 = surface.shape, np.asarray(surface.grid.e_0)
    return float(np.arctan2(e_0 @ shape.e_1, e_0 @ shape.e_0))


def hat_forces(surface: Any, values: np.ndarray) -> np.ndarray:
    """`M values`: hat forces (columns, rows) [N] of hat coefficients (columns, rows) [Pa] on the surface's whole
    grid."""
    pitch = surface.grid.pitch
    if surface.grid.periodic:
        around = pitch / 6.0 * (np.roll(values, 1, axis=0) + 4.0 * values + np.roll(values, -1, axis=0))
    else:
        padded = np.pad(values, ((1, 1), (0, 0)))
        around = pitch / 6.0 * (padded[:-2] + 4.0 * padded[1:-1] + padded[2:])
    return around @ surface.gram_z.T


def hat_areas(surface: Any) -> np.ndarray:
    """int psi_i dA of one column's hats (rows,) [m^2]; the hats of all columns inside the surface are alike."""
    return surface.grid.pitch * surface.gram_z.sum(axis=1)


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


class SkinSurface:
    """Which skin nodes lie on one contact surface, and their bilinear weights on its grid."""

    def __init__(self, surface: Any, points: np.ndarray) -> None:
        grid = surface.grid
        self.surface = surface
        theta, z, distance = surface.shape.chart(points)
        rows = np.asarray(grid.z, dtype=float)
        column = (np.asarray(theta) - grid_theta_offset(surface) - grid.theta_start) / grid.pitch
        if grid.periodic:
            column = column % grid.columns
        else:
            full_turn = 2.0 * np.pi / grid.pitch
            column = (column + 0.5) % full_turn - 0.5  # a node half a pitch before the first column still belongs to it
        slack = 1e-6 * max(rows[-1] - rows[0], 1e-300)  # round-off of the chart at the end planes
        radius = float(surface.shape.radius_at(0.5 * (rows[0] + rows[-1])))
        near = max(ON_SURFACE * radius, 2.0 * (getattr(surface.shape, "deviation", None) or 0.0))
        on = (np.abs(distance) < near) & (z > rows[0] - slack) & (z < rows[-1] + slack)
        if not grid.periodic:
            on &= (column > -1.0) & (column < grid.columns)
        self.nodes = np.flatnonzero(on)
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
        """Hat interpolation of (columns, rows) at the surface's skin nodes."""
        return (self.weights * values[self.columns, self.rows]).sum(axis=0)


class Skin:
    """The skin of one flexible body over a run: displacement and pressure at saved step `i`."""

    def __init__(self, history: Any, view: SceneView, body: BodyView) -> None:
        self.history = history
        self.body = body
        self.points = np.asarray(body.reduced.surface.points, dtype=float)  # (n, 3) m, user frame, undeformed
        self.triangles = np.asarray(body.reduced.surface.triangles)  # (t, 3)
        self._modes = body.reduced.surface.modes  # (m, n, 3)
        self._pairs = [p for p in view.pairs.values() if body.name in (p.first_body.name, p.second_body.name)]
        self._on = {p.name: SkinSurface(self._surface(p), self.points) for p in self._pairs}

    def _surface(self, pair: Any) -> Any:
        return pair.first if pair.first_body.name == self.body.name else pair.second

    def _loads(self, pair: Any, i: int) -> tuple[np.ndarray, np.ndarray]:
        """Outward hat forces [N] and pressure coefficients [Pa], both (columns, rows), of one pair on this body."""
        contact = self.history.contacts[pair.name]
        surface = self._surface(pair)
        if pair.first_body.name == self.body.name:
            pressure = spread(surface, contact.first_column[i], contact.pressure[i])
            return -hat_forces(surface, pressure), pressure
        load = spread(surface, contact.first_column_second[i], contact.load_second[i])
        return -load, load / hat_areas(surface)

    def displacement(self, i: int) -> np.ndarray:
        """Elastic displacement (n, 3) [m] in user axes at saved step `i`."""
        q = self.history.bodies[self.body.name].modal[i]
        u = np.einsum("m,mnd->nd", q, self._modes) if len(q) else np.zeros_like(self.points)
        for pair in self._pairs:
            forces, _ = self._loads(pair, i)
            if np.any(forces):
                u = u + self._surface(pair).recover(forces)
        return u

    def pressure(self, i: int) -> np.ndarray:
        """Contact pressure (n,) [Pa] at the skin's nodes, zero off the contact surfaces, at saved step `i`."""
        p = np.zeros(len(self.points))
        for pair in self._pairs:
            on = self._on[pair.name]
            p[on.nodes] += on.interpolate(self._loads(pair, i)[1])
        return p


def rotate(rotation: np.ndarray, vectors: np.ndarray) -> np.ndarray:
    """Vectors (n, 3) turned by the unit quaternion (x, y, z, w): user axes to world axes."""
    u, w = np.asarray(rotation[:3]), float(rotation[3])
    t = 2.0 * np.cross(u, vectors)
    return vectors + w * t + np.cross(u, t)
