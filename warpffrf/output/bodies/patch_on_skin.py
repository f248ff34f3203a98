r"""Fields of a contact patch at points of either body, and the tangential loads on both.

Fields live on the grid of a pair's first surface. A skin node of the first body has its place there in the chart. A
node of the second is carried into the first body's user frame by the poses of both, rigidly, and takes the chart of the
nearest point: within the patch the surfaces coincide up to the elastic approach.

The tangential force of a cell, `A (tau_1 e_theta + tau_2 t_z)`, loads that cell of the first surface. On the second its
opposite, in world axes, is shared bilinearly between the four nodes about the cell's place there, along the second's
own e_theta and t_z. The weights add up to one: the second carries the same force but for the angle between the tangent
planes of the two undeformed surfaces, x/R at a distance x from the middle of the patch.
"""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import numpy as np

from warpffrf.model.contact_grid import meridian_gram
from warpffrf.output.geometry.grid_places import GridPlaces, SkinSurface, grid_theta_offset, spread
from warpffrf.output.geometry.poses import Pose, tangents
from warpffrf.output.geometry.scene_view import PairView

NEAR = 0.25  # of the window's length: nodes of the second surface farther from the first do not take part


def cell_areas(surface: Any) -> np.ndarray:
    """(rows,) m2 of the cells of one column of the surface's contact grid."""
    return surface.grid.pitch * meridian_gram("cells", surface.shape, np.asarray(surface.grid.z)).diagonal()


def poses(pair: PairView, bodies: dict[str, Any], i: int) -> tuple[Pose, Pose]:
    """Poses of the first and the second body of `pair` at saved step `i`."""
    return Pose.of(bodies, pair.first_body.name, i), Pose.of(bodies, pair.second_body.name, i)


class PatchOnSkin:
    """Fields of one pair's patch at the skin nodes of its first or second body."""

    def __init__(self, pair: PairView, history: Any, on: SkinSurface, points: np.ndarray, *, first: bool) -> None:
        """history: the run's; on: which of `points` (n, 3) [m, user frame] lie on the body's contact surface; first:
        whether the body is the pair's first one."""
        self.pair, self.on, self.points, self.is_first = pair, on, points, first
        self.contact, self.bodies = history.contacts[pair.name], history.bodies
        self._at: tuple[int, GridPlaces] | None = None

    def places(self, i: int) -> GridPlaces:
        """Where the nodes of the contact surface are on the first surface's grid at saved step `i`."""
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
        """(n,) bilinear values of a `window` (columns, rows) of saved step `i` at all points, zero off the patch."""
        return self._spread(i, window, GridPlaces.interpolate)

    def nearest(self, i: int, window: np.ndarray) -> np.ndarray:
        """(n,) values of the cell that each point lies in, zero off the patch; for what cannot be averaged."""
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


def tangential_forces(pair: PairView, contact: Any, bodies: dict[str, Any], i: int, *, first: bool) -> np.ndarray:
    """Tangential forces (2, columns, rows) [N] on the whole grid of the pair's first or second surface, along its own
    e_theta and t_z, at saved step `i`."""
    surface = pair.first
    forces = contact.friction.traction[i] * cell_areas(surface)
    start = contact.first_column[i]
    if first:
        return np.stack([spread(surface, start, part) for part in forces])
    grid, shape, other = surface.grid, surface.shape, pair.second
    found = np.zeros((2, other.grid.columns, len(other.grid.z)))
    j, k = np.nonzero(np.any(forces != 0.0, axis=0))
    if not len(j):
        return found
    theta = grid.theta_start + grid_theta_offset(surface) + grid.pitch * (int(start) + j)
    z = np.asarray(grid.z)[k]
    own, its = poses(pair, bodies, i)
    e_theta, t_z = tangents(shape, theta, z)
    vectors = its.turned_back(own.turned(-(forces[0, j, k][:, None] * e_theta + forces[1, j, k][:, None] * t_z)))
    points = its.to_user(own.to_world(shape.point(theta, z)))
    places = GridPlaces(other, points, np.inf)
    axes = tangents(other.shape, *other.shape.chart(points)[:2])[:, places.inside]
    for d in range(2):
        components = np.einsum("nc,nc->n", axes[d], vectors[places.inside])
        np.add.at(found[d], (places.columns, places.rows), places.weights * components)
    return found
