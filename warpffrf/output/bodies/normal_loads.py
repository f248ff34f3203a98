r"""Normal loads of one contact pair on one of its bodies: outward hat forces, and the pressure at points of its skin.

Where the pressure stands on hats, it pushes inwards on the pair's first surface and `f = -M p`, with the hat Gram
matrix `M = M_theta (x) M_z` on the true surface,

    M_theta = pitch/6 [1 4 1],     M_z[k, l] = int zeta_k zeta_l R(z) sqrt(1 + R'(z)^2) dz;

on the second surface the run recorded hat forces, positive inwards, and `f = -load_second`. For colours the second
surface's pressure is `load_i / int psi_i dA` (the row-summed Gram matrix: positive, and exact for a constant).

Where it stands on cells that travel with the patch, each one's force, minus pressure times area, acts at its middle; on
the second body at the place that the poses of both carry it to. It goes to the hats as it does in the simulation, over
the splines B and the transform Z of the surface (`model.far_splines`),

    f = -Z^T B^T (A p),

which keeps the force, its first and its second moments. The hats' own pressure is then wider than the cells'; what that
does near the patch is in `patch_stress`. Points of the skin take the bilinear value between the middles of the cells
around them.

The pressure of an oil film stands on hats, and pushes on its first surface as that of a contact; of a second one that
yields there are hat forces too.
"""

from __future__ import annotations

from abc import ABC, abstractmethod
from typing import Any

import numpy as np

from warpffrf.output.bodies.patch_on_skin import NEAR, poses
from warpffrf.output.geometry.cell_places import CellPlaces
from warpffrf.output.geometry.grid_places import SkinSurface, grid_theta_offset, spread, wrapped
from warpffrf.output.geometry.scene_view import FilmView, PairView


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


class NormalLoads(ABC):
    """Normal loads of one pair on its first or second body."""

    def __init__(self, pair: PairView, history: Any, *, first: bool) -> None:
        """history: the run's; first: whether the body is the pair's first one."""
        self.pair, self.first = pair, first
        self.contact, self.bodies = history.contacts[pair.name], history.bodies
        self.surface = pair.first if first else pair.second

    @abstractmethod
    def forces(self, i: int) -> np.ndarray:
        """Outward hat forces (columns, rows) [N] on the body's surface at saved step `i`."""

    @abstractmethod
    def pressure(self, i: int, on: SkinSurface, points: np.ndarray) -> np.ndarray:
        """Pressure [Pa] at those of `points` (n, 3) [m, user frame] that are `on` the body's surface, saved step
        `i`."""


class HatLoads(NormalLoads):
    """Of a pressure on the hats of the first body's contact grid."""

    def forces(self, i: int) -> np.ndarray:
        """Outward hat forces (columns, rows) [N]."""
        contact = self.contact
        if self.first:
            return -hat_forces(self.surface, self._coefficients(i))
        return -spread(self.surface, contact.first_column_second[i], contact.load_second[i])

    def pressure(self, i: int, on: SkinSurface, points: np.ndarray) -> np.ndarray:
        """Pressure [Pa] at the points on the surface, bilinear between hats."""
        return on.interpolate(self._coefficients(i) if self.first else -self.forces(i) / hat_areas(self.surface))

    def _coefficients(self, i: int) -> np.ndarray:
        return spread(self.surface, self.contact.first_column[i], self.contact.pressure[i])


class CellLoads(NormalLoads):
    """Of a pressure on cells that travel with the patch."""

    def __init__(self, pair: PairView, history: Any, *, first: bool) -> None:
        super().__init__(pair, history, first=first)
        self.places = CellPlaces(pair.first, self.contact.cells, self.contact.pressure.shape[1])

    def forces(self, i: int) -> np.ndarray:
        """Outward hat forces (columns, rows) [N]."""
        splines, grid = self.surface.splines, self.surface.grid
        pressure = self.contact.pressure[i]
        j, k = np.nonzero(pressure)
        if not len(j):
            return np.zeros((grid.columns, grid.rows))
        push = pressure[j, k] * self.places.areas[i, k]
        theta, z = self.on_surface(i, self.places.theta[i, j], self.places.z[i, k])
        on_splines = splines.around(theta).T @ (push[:, None] * splines.along(z))
        return -splines.theta_transform.T @ on_splines @ splines.z_transform

    def on_surface(self, i: int, theta: np.ndarray, z: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """Places (theta on its grid, z) (n,) of the body's surface at, or opposite to, places (n,) of the first surface
        at saved step `i`."""
        if self.first:
            return theta, z
        shape = self.pair.first.shape
        own, other = poses(self.pair, self.bodies, i)
        points = other.to_user(own.to_world(shape.point(theta + grid_theta_offset(self.pair.first), z)))
        there, z, _ = self.surface.shape.chart(points)
        grid = self.surface.grid
        return wrapped(self.surface, there - grid_theta_offset(self.surface), float(np.mean(grid.theta[[0, -1]]))), z

    def pressure(self, i: int, on: SkinSurface, points: np.ndarray) -> np.ndarray:
        """Pressure [Pa] at the points on the surface, bilinear between the middles of cells, 0 beside them."""
        points, places, first = points[on.nodes], self.places, self.pair.first
        if not self.first:
            own, other = poses(self.pair, self.bodies, i)
            points = own.to_user(other.to_world(points))
        theta, z, distance = first.shape.chart(points)
        center = float(places.center[i])
        theta = wrapped(first, theta - grid_theta_offset(first), center)
        column = (theta - center) / places.pitch[i] - places.offset[0] + 1.0  # among strips with an empty one before
        lines = places.z_edges[i]
        row = np.interp(z, places.z[i], np.arange(len(lines) - 1.0))
        width = places.width[i] * places.columns
        inside = (np.abs(distance) < NEAR * width) & (column > 0.0) & (column < places.columns + 1.0)
        inside &= (z > lines[0] - 1e-6 * width) & (z < lines[-1] + 1e-6 * width)  # with nodes on the end planes
        padded = np.pad(self.contact.pressure[i], ((1, 1), (0, 1)))
        found = np.zeros(len(points))
        column, row = column[inside], row[inside]
        j, k = column.astype(int), row.astype(int)
        s, t = column - j, row - k
        found[inside] = (1.0 - t) * ((1.0 - s) * padded[j, k] + s * padded[j + 1, k]) + t * (
            (1.0 - s) * padded[j, k + 1] + s * padded[j + 1, k + 1]
        )
        return found


class FilmLoads(NormalLoads):
    """Of the pressure of an oil film, and of the asperities beside it, on its first body, or on the second if that
    yields."""

    def __init__(self, pair: FilmView, history: Any, *, first: bool = True) -> None:
        self.pair, self.first, self.surface = pair, first, pair.first if first else pair.second
        self.film = history.films[pair.name]

    def forces(self, i: int) -> np.ndarray:
        """Outward hat forces (columns, rows) [N]."""
        return -hat_forces(self.surface, self._whole(i)) if self.first else -self.film.load_second[i]

    def pressure(self, i: int, on: SkinSurface, points: np.ndarray) -> np.ndarray:
        """Pressure [Pa] at the points on the surface, bilinear between hats; of the second that of its hats' forces,
        even over each."""
        if self.first:
            return on.interpolate(self._whole(i))
        area = hat_forces(self.surface, np.ones(self.film.load_second.shape[1:]))
        return on.interpolate(self.film.load_second[i] / area)

    def _whole(self, i: int) -> np.ndarray:
        return self.film.pressure[i] + self.film.asperity[i]


def film_loads(films: Any, history: Any, body: str) -> list[FilmLoads]:
    """Of all `films`, views of a scene, on one flexible body, whichever of theirs it is."""
    found = []
    for film in films:
        if film.first_body.name == body:
            found.append(FilmLoads(film, history))
        elif film.second_body.name == body and history.films[film.name].load_second is not None:
            found.append(FilmLoads(film, history, first=False))
    return found


def normal_loads(pair: PairView, history: Any, *, first: bool) -> NormalLoads:
    """The loads of `pair` on its first or second body, as its pressure stands in `history`."""
    kind = HatLoads if history.contacts[pair.name].cells is None else CellLoads
    return kind(pair, history, first=first)
