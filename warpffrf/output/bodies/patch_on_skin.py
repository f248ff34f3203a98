r"""Fields of a contact patch at points of either body, and the tangential loads on both.

Fields are given on the grid of a contact's first surface. A skin node of the first body has its position there in the
chart. A node of the second body is transformed rigidly to the first body's user frame by the poses of both, and takes
the chart coordinates of the nearest point: within the patch the surfaces coincide up to the elastic approach.

The tangential force of a cell, `A (tau_1 e_theta + tau_2 t_z)`, loads that cell of the first surface. On the second
surface its opposite, in world axes, is distributed bilinearly to the four nodes around the cell, along the second
surface's own e_theta and t_z. The weights add up to one: the second body carries the same force except for the angle
between the tangent planes of the two undeformed surfaces, x/R at a distance x from the centre of the patch.

Cells that move with the patch lie between the nodes of either grid: their forces are distributed to nodes on both
bodies, and a point of the skin has the values of the cell that contains it.
"""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import numpy as np

from warpffrf.model.reduced.contact_grid import meridian_gram
from warpffrf.output.geometry.places import (
    CellPlaces,
    GridPlaces,
    Pose,
    SkinSurface,
    grid_theta_offset,
    spread,
    tangents,
)
from warpffrf.output.geometry.scene_view import PairView

NEAR = 0.25  # of the window's length: nodes of the second surface farther from the first are ignored


def cell_areas(surface: Any) -> np.ndarray:
    """(rows,) m2 of the cells of one column of the surface's contact grid."""
    return surface.grid.pitch * meridian_gram("cells", surface.shape, np.asarray(surface.grid.z)).diagonal()


def poses(pair: PairView, bodies: dict[str, Any], i: int) -> tuple[Pose, Pose]:
    """Poses of the first and the second body of `pair` at saved step `i`."""
    return Pose.of(bodies, pair.first_body.name, i), Pose.of(bodies, pair.second_body.name, i)


class PatchOnSkin:
    """Fields of one contact's patch at the skin nodes of its first or second body."""

    def __init__(self, pair: PairView, history: Any, on: SkinSurface, points: np.ndarray, *, first: bool) -> None:
        """history: of the run; on: which of `points` (n, 3) [m, user frame] lie on the body's contact surface; first:
        whether the body is the contact's first one."""
        self.pair, self.on, self.points, self.is_first = pair, on, points, first
        self.contact, self.bodies = history.contacts[pair.name], history.bodies
        self._at: tuple[int, GridPlaces] | None = None

    def places(self, i: int) -> GridPlaces:
        """Positions of the nodes of the contact surface on the first surface's grid at saved step `i`."""
        if self.is_first:
            return self.on.places
        if self._at is None or self._at[0] != i:
            first, second = poses(self.pair, self.bodies, i)
            moved = first.to_user(second.to_world(self.points[self.on.nodes]))
            surface = self.pair.first
            middle = float(surface.shape.radius_at(0.5 * (surface.grid.z[0] + surface.grid.z[-1])))
            length = middle * float(surface.grid.pitch) * self.contact.pressure.shape[1]
            self._at = i, GridPlaces(surface, moved, NEAR * length)
        return self._at[1]

    def scalar(self, i: int, window: np.ndarray) -> np.ndarray:
        """(n,) bilinear values of a `window` (columns, rows) of saved step `i` at all points, zero outside of the
        patch."""
        return self._spread(i, window, GridPlaces.interpolate)

    def nearest(self, i: int, window: np.ndarray) -> np.ndarray:
        """(n,) values of the cell that contains each point, zero outside of the patch; for fields that cannot be
        averaged."""
        return self._spread(i, window, GridPlaces.nearest)

    def _spread(self, i: int, window: np.ndarray, at: Callable[[GridPlaces, np.ndarray], np.ndarray]) -> np.ndarray:
        places = self.places(i)
        found = np.zeros(len(self.points))
        nodes = self.on.nodes if self.is_first else self.on.nodes[places.inside]
        found[nodes] = at(places, spread(self.pair.first, self.contact.first_column[i], window))
        return found

    def traction(self, i: int) -> np.ndarray:
        """(n, 3) Pa, tangential traction on this body at all points, its user axes."""
        tau = self.contact.friction.traction[i]
        around, along = self.scalar(i, tau[0]), self.scalar(i, tau[1])
        found = np.zeros((len(self.points), 3))
        hit = np.flatnonzero((around != 0.0) | (along != 0.0))
        if not len(hit):
            return found
        first, second = poses(self.pair, self.bodies, i)
        points = self.points[hit] if self.is_first else first.to_user(second.to_world(self.points[hit]))
        shape = self.pair.first.shape
        e_theta, t_z = tangents(shape, *shape.chart(points)[:2])
        vectors = around[hit, None] * e_theta + along[hit, None] * t_z
        found[hit] = vectors if self.is_first else -second.turned_back(first.turned(vectors))
        return found


class CellsOnSkin(PatchOnSkin):
    """Fields of a contact whose tractions are given on cells that move with the patch."""

    def __init__(self, pair: PairView, history: Any, on: SkinSurface, points: np.ndarray, *, first: bool) -> None:
        super().__init__(pair, history, on, points, first=first)
        self.cells = CellPlaces(pair.first, self.contact.cells, self.contact.pressure.shape[1])
        self._found: tuple[int, np.ndarray, np.ndarray, np.ndarray] | None = None

    def _in_cells(self, i: int) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
        """Nodes of the skin that lie in cells at saved step `i`, and the strip and row of each."""
        if self._found is None or self._found[0] != i:
            surface, points = self.pair.first, self.points[self.on.nodes]
            if not self.is_first:
                first, second = poses(self.pair, self.bodies, i)
                points = first.to_user(second.to_world(points))
            theta, z, distance = surface.shape.chart(points)
            strip, row = self.cells.cells_at(i, theta - grid_theta_offset(surface), z)
            hit = (strip >= 0) & (np.abs(distance) < NEAR * self.cells.width[i] * self.cells.columns)
            self._found = i, self.on.nodes[hit], strip[hit], row[hit]
        return self._found[1:]

    def scalar(self, i: int, window: np.ndarray) -> np.ndarray:
        """(n,) values of the cell that contains each point, zero outside of the patch."""
        nodes, strip, row = self._in_cells(i)
        found = np.zeros(len(self.points))
        found[nodes] = window[strip, row]
        return found

    def nearest(self, i: int, window: np.ndarray) -> np.ndarray:
        """As `scalar`."""
        return self.scalar(i, window)


def patch_on_skin(pair: PairView, history: Any, on: SkinSurface, points: np.ndarray, *, first: bool) -> PatchOnSkin:
    """The fields of `pair` at `points`, see `PatchOnSkin`, by the grid of its tractions in `history`."""
    kind = PatchOnSkin if history.contacts[pair.name].cells is None else CellsOnSkin
    return kind(pair, history, on, points, first=first)


def _cell_forces(pair: PairView, contact: Any, i: int) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """theta of the first surface's shape and z (n,) of the cells with tractions at saved step `i`, and their forces (2,
    n) [N] on the first body along e_theta and t_z."""
    surface, traction = pair.first, contact.friction.traction[i]
    j, k = np.nonzero(np.any(traction != 0.0, axis=0))
    if contact.cells is None:
        grid = surface.grid
        theta, z = grid.theta_start + grid.pitch * (int(contact.first_column[i]) + j), np.asarray(grid.z)[k]
        areas = cell_areas(surface)
    else:
        places = CellPlaces(surface, contact.cells, traction.shape[1])
        theta, z, areas = places.theta[i, j] + places.shift[i, k], places.z[i, k], places.areas[i]
    return theta + grid_theta_offset(surface), z, areas[k] * traction[:, j, k]


def tangential_forces(pair: PairView, contact: Any, bodies: dict[str, Any], i: int, *, first: bool) -> np.ndarray:
    """Tangential forces (2, columns, rows) [N] on the whole grid of the contact's first or second surface, along its
    own e_theta and t_z, at saved step `i`."""
    surface = pair.first
    if first and contact.cells is None:
        forces = contact.friction.traction[i] * cell_areas(surface)
        return np.stack([spread(surface, contact.first_column[i], part) for part in forces])
    shape, on = surface.shape, surface if first else pair.second
    found = np.zeros((2, on.grid.columns, len(on.grid.z)))
    theta, z, forces = _cell_forces(pair, contact, i)
    if not len(theta):
        return found
    e_theta, t_z = tangents(shape, theta, z)
    vectors, points = forces[0][:, None] * e_theta + forces[1][:, None] * t_z, shape.point(theta, z)
    if not first:
        own, its = poses(pair, bodies, i)
        vectors, points = its.turned_back(own.turned(-vectors)), its.to_user(own.to_world(points))
    places = GridPlaces(on, points, np.inf)
    axes = tangents(on.shape, *on.shape.chart(points)[:2])[:, places.inside]
    for d in range(2):
        components = np.einsum("nc,nc->n", axes[d], vectors[places.inside])
        np.add.at(found[d], (places.columns, places.rows), places.weights * components)
    return found
