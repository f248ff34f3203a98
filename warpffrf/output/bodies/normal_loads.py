r"""Normal loads of one contact on one of its bodies: outward nodal forces, and the pressure at points of its skin.

A pressure given at nodes of the contact grid acts inwards on the first surface and `f = -M p`, with the Gram matrix `M
= M_theta (x) M_z` of the shape functions on the true surface,

    M_theta = pitch/6 [1 4 1],     M_z[k, l] = int zeta_k zeta_l R(z) sqrt(1 + R'(z)^2) dz;

on the second surface the run recorded nodal forces, positive inwards, and `f = -load_second`. For display the second
surface's pressure is `load_i / int psi_i dA` (the row-summed Gram matrix: positive, and exact for a constant).

For a pressure on cells that move with the patch, the force of each cell, minus pressure times area, acts at its centre;
on the second body at the corresponding point by the poses of both. It is distributed to the nodes as in the simulation,
by the splines B and the transform Z of the surface (`model.far_splines`),

    f = -Z^T B^T (A p),

which preserves the force and its first and second moments. The nodal pressure is then wider than that of the cells; its
correction near the patch is in `patch_stress`. Points of the skin have the bilinear value between the centres of the
surrounding cells.

The pressure of an oil film is given at nodes, and acts on its first surface as that of a contact; for a flexible second
surface there are nodal forces too.

Matched faces. Fields of a small-sliding contact at the nodes of the skin of either of its bodies.

The first face carries the tractions of the contact's cells, the second face of a pair the opposite ones, and the second
face of another body the forces on its own cells (`model.small_sliding.face_loads`) over their areas, so that both
bodies carry the same force also for different meshes. A node has the mean of the adjacent cells (`SkinNodes`); the
state is that of the one nearest to sliding.

Small-sliding loads. The forces of small-sliding contacts on one flexible body at saved steps, as inputs of its
responses.

Pressure and traction of a cell times its area are its forces s on the second face; `model.small_sliding.face_loads`
converts them to the cells of a body. Skin and stress follow from these and the body's local responses, beyond its
global modes.
"""

from __future__ import annotations

from abc import ABC, abstractmethod
from typing import Any

import numpy as np
import scipy.sparse as sp

from warpffrf.model.small_sliding import matched_surface
from warpffrf.model.small_sliding.matched_surface import places
from warpffrf.online.history.history import History, SmallSlidingHistory
from warpffrf.output.bodies.patch_on_skin import NEAR, poses
from warpffrf.output.geometry.places import CellPlaces, SkinSurface, grid_theta_offset, spread, wrapped
from warpffrf.output.geometry.scene_view import BodyView, FilmView, PairView, SceneView, SmallSlidingView
from warpffrf.output.geometry.skin_nodes import SkinNodes


def node_forces(surface: Any, values: np.ndarray) -> np.ndarray:
    """`M values`: nodal forces (columns, rows) [N] of nodal values (columns, rows) [Pa] on the surface's whole grid."""
    pitch = surface.grid.pitch
    if surface.grid.periodic:
        around = pitch / 6.0 * (np.roll(values, 1, axis=0) + 4.0 * values + np.roll(values, -1, axis=0))
    else:
        padded = np.pad(values, ((1, 1), (0, 0)))
        around = pitch / 6.0 * (padded[:-2] + 4.0 * padded[1:-1] + padded[2:])
    return around @ surface.gram_z.T


def node_areas(surface: Any) -> np.ndarray:
    """int psi_i dA of one column's nodes (rows,) [m^2]; all columns inside the surface are equal."""
    return surface.grid.pitch * surface.gram_z.sum(axis=1)


class NormalLoads(ABC):
    """Normal loads of one contact on its first or second body."""

    def __init__(self, pair: PairView, history: Any, *, first: bool) -> None:
        """history: of the run; first: whether the body is the contact's first one."""
        self.pair, self.first = pair, first
        self.contact, self.bodies = history.contacts[pair.name], history.bodies
        self.surface = pair.first if first else pair.second

    @abstractmethod
    def forces(self, i: int) -> np.ndarray:
        """Outward nodal forces (columns, rows) [N] on the body's surface at saved step `i`."""

    @abstractmethod
    def pressure(self, i: int, on: SkinSurface, points: np.ndarray) -> np.ndarray:
        """Pressure [Pa] at those of `points` (n, 3) [m, user frame] that are `on` the body's surface, saved step
        `i`."""


class NodeLoads(NormalLoads):
    """Loads of a pressure at the nodes of the first body's contact grid."""

    def forces(self, i: int) -> np.ndarray:
        """Outward nodal forces (columns, rows) [N]."""
        contact = self.contact
        if self.first:
            return -node_forces(self.surface, self._coefficients(i))
        return -spread(self.surface, contact.first_column_second[i], contact.load_second[i])

    def pressure(self, i: int, on: SkinSurface, points: np.ndarray) -> np.ndarray:
        """Pressure [Pa] at the points on the surface, bilinear between nodes."""
        return on.interpolate(self._coefficients(i) if self.first else -self.forces(i) / node_areas(self.surface))

    def _coefficients(self, i: int) -> np.ndarray:
        return spread(self.surface, self.contact.first_column[i], self.contact.pressure[i])


class CellLoads(NormalLoads):
    """Loads of a pressure on cells that move with the patch."""

    def __init__(self, pair: PairView, history: Any, *, first: bool) -> None:
        super().__init__(pair, history, first=first)
        self.places = CellPlaces(pair.first, self.contact.cells, self.contact.pressure.shape[1])

    def forces(self, i: int) -> np.ndarray:
        """Outward nodal forces (columns, rows) [N]."""
        splines, grid = self.surface.splines, self.surface.grid
        pressure = self.contact.pressure[i]
        j, k = np.nonzero(pressure)
        if not len(j):
            return np.zeros((grid.columns, grid.rows))
        push = pressure[j, k] * self.places.areas[i, k]
        theta, z = self.on_surface(i, self.places.theta[i, j] + self.places.shift[i, k], self.places.z[i, k])
        on_splines = splines.around(theta).T @ (push[:, None] * splines.along(z))
        return -splines.theta_transform.T @ on_splines @ splines.z_transform

    def on_surface(self, i: int, theta: np.ndarray, z: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """Coordinates (theta on its grid, z) (n,) on the body's surface of, or opposite to, points (n,) of the first
        surface at saved step `i`."""
        if self.first:
            return theta, z
        shape = self.pair.first.shape
        own, other = poses(self.pair, self.bodies, i)
        points = other.to_user(own.to_world(shape.point(theta + grid_theta_offset(self.pair.first), z)))
        there, z, _ = self.surface.shape.chart(points)
        grid = self.surface.grid
        return wrapped(self.surface, there - grid_theta_offset(self.surface), float(np.mean(grid.theta[[0, -1]]))), z

    def pressure(self, i: int, on: SkinSurface, points: np.ndarray) -> np.ndarray:
        """Pressure [Pa] at the points on the surface, bilinear between cell centres, 0 outside of the cells."""
        points, places, first = points[on.nodes], self.places, self.pair.first
        if not self.first:
            own, other = poses(self.pair, self.bodies, i)
            points = own.to_user(other.to_world(points))
        theta, z, distance = first.shape.chart(points)
        center = float(places.center[i])
        theta = wrapped(first, theta - grid_theta_offset(first) - places.shift_at(i, z), center)
        column = (theta - center) / places.pitch[i] - places.offset[0] + 1.0  # with an empty strip in front
        lines = places.z_edges[i]
        row = np.interp(z, places.z[i], np.arange(len(lines) - 1.0))
        width = places.width[i] * places.columns
        inside = (np.abs(distance) < NEAR * width) & (column > 0.0) & (column < places.columns + 1.0)
        inside &= (z > lines[0] - 1e-6 * width) & (z < lines[-1] + 1e-6 * width)  # includes nodes on the end planes
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
    """Loads of the pressure of an oil film and of its asperities on its first body, or on a flexible second one."""

    def __init__(self, pair: FilmView, history: Any, *, first: bool = True) -> None:
        self.pair, self.first, self.surface = pair, first, pair.first if first else pair.second
        self.film = history.films[pair.name]

    def forces(self, i: int) -> np.ndarray:
        """Outward nodal forces (columns, rows) [N]."""
        return -node_forces(self.surface, self._whole(i)) if self.first else -self.film.load_second[i]

    def pressure(self, i: int, on: SkinSurface, points: np.ndarray) -> np.ndarray:
        """Pressure [Pa] at the points on the surface, bilinear between nodes; on the second surface nodal forces over
        nodal areas."""
        if self.first:
            return on.interpolate(self._whole(i))
        area = node_forces(self.surface, np.ones(self.film.load_second.shape[1:]))
        return on.interpolate(self.film.load_second[i] / area)

    def _whole(self, i: int) -> np.ndarray:
        return self.film.pressure[i] + self.film.asperity[i]


def film_loads(films: Any, history: Any, body: str) -> list[FilmLoads]:
    """Loads of all `films`, views of a scene, on one flexible body, on either side."""
    found = []
    for film in films:
        if film.first_body.name == body:
            found.append(FilmLoads(film, history))
        elif film.second_body.name == body and history.films[film.name].load_second is not None:
            found.append(FilmLoads(film, history, first=False))
    return found


def normal_loads(pair: PairView, history: Any, *, first: bool) -> NormalLoads:
    """The loads of `pair` on its first or second body, by the grid of its pressure in `history`."""
    kind = NodeLoads if history.contacts[pair.name].cells is None else CellLoads
    return kind(pair, history, first=first)


Array = np.ndarray


class MatchedFace:
    """One face of a small-sliding contact on the skin of its body."""

    def __init__(
        self,
        contact: SmallSlidingHistory,
        view: SmallSlidingView,
        tractions: sp.csr_matrix,
        normals: Array,
        at: sp.csr_matrix,
        owner: Array,
    ) -> None:
        """tractions (3 k, 3 c): from the forces of the contact's cells to tractions on the k cells of the face, user
        axes; normals (k, 3) of these, outwards; at (n, k): means of cells at nodes; owner (k,): the contact cell that
        gives each its state, -1 none."""
        self._small_sliding, self._area, self._tractions, self._normals = contact, view.area, tractions, normals
        self._at, self._owner = at, owner
        self.rubs = view.friction > 0.0

    def _on_cells(self, i: int) -> tuple[Array, Array]:
        """Pressure (k,) and tangential traction (k, 3) [Pa]."""
        t = (self._tractions @ cell_forces(self._small_sliding, self._area, i)).reshape(-1, 3)
        pressure = -np.einsum("ki,ki->k", t, self._normals)
        return pressure, t + pressure[:, None] * self._normals

    def pressure(self, i: int) -> Array:
        """Pressure (n,) [Pa] at all nodes of the skin, zero outside of the face, at saved step `i`."""
        return self._at @ self._on_cells(i)[0]

    def traction(self, i: int) -> Array:
        """Tangential traction (n, 3) [Pa] on this body, user axes, at saved step `i`."""
        return self._at @ self._on_cells(i)[1]

    def state(self, i: int) -> Array:
        """State (n,) of the cells around each node, the largest of 0 open, 1 stick, 2 slip, at saved step `i`."""
        own = np.where(self._owner >= 0, self._small_sliding.state[i][self._owner], 0)
        around = sp.csr_matrix((own[self._at.indices], self._at.indices, self._at.indptr), self._at.shape, copy=True)
        return around.max(axis=1).toarray().ravel().astype(np.int8)


def faces_on_skin(history: History, view: SceneView, body: str, points: Array, triangles: Array) -> list[MatchedFace]:
    """All faces of small-sliding contacts on a flexible body with the skin `points` (n, 3) [m, user frame], `triangles`
    (t, 3)."""
    skin, found = SkinNodes(points, triangles), []
    for name, contact in view.small_sliding.items():
        own = history.small_sliding[name]
        if contact.first_body.name == body:
            corners, cell = contact.triangles
            every = np.arange(len(contact.cell))
            out = _vectors(contact.frames, -1.0 / contact.area)
            found.append(
                MatchedFace(own, contact, out, contact.frames[:, 0], skin.on(corners, cell, len(every)), every)
            )
            if contact.first.pair:
                across = skin.across(corners, cell, contact.first.gap[contact.cell])
                found.append(MatchedFace(own, contact, -out, -contact.frames[:, 0], across, every))
        if contact.second is not None and contact.second_body.name == body:
            found.append(_on_partner(own, contact, skin))
    return found


def _on_partner(history: SmallSlidingHistory, contact: SmallSlidingView, skin: SkinNodes) -> MatchedFace:
    """The second face, of another body."""
    face = contact.second
    own = places(contact.second_body.reduced.matched)[contact.second_surface_name]
    tractions = sp.csr_matrix(_vectors(face.frames, 1.0 / face.area) @ on_second(contact)[own])
    carried = sp.csc_matrix(contact.weights.multiply(contact.area[:, None]))
    most = np.asarray(carried.argmax(axis=0)).ravel()
    owner = np.where(carried.max(axis=0).toarray().ravel() > 0.0, most, -1)
    at = skin.on(face.triangles, face.cell, face.cells)
    return MatchedFace(history, contact, tractions, face.frames[:, 0], at, owner)


def _vectors(frames: Array, factor: Array) -> sp.csr_matrix:
    """(3 k, 3 k) from components along the rows of frames (k, 3, 3) to vectors, times factor (k,)."""
    return sp.csr_matrix(sp.block_diag(list(np.swapaxes(frames, 1, 2) * factor[:, None, None]), format="csr"))


def cell_forces(contact: SmallSlidingHistory, area: np.ndarray, i: int) -> np.ndarray:
    """Forces (3 c,) [N] of the cells with `area` (c,) [m2] on the second face, along their frames, at saved step
    `i`."""
    return (np.column_stack([contact.pressure[i], -contact.traction[i]]) * area[:, None]).ravel()


def on_first(contact: SmallSlidingView) -> sp.csr_matrix:
    """P (N, 3 c) of `face_loads` on the contact's first body."""
    return matched_surface.on_own(contact.first_body.reduced.matched, contact.first_surface_name, contact.cell)


def on_second(contact: SmallSlidingView) -> sp.csr_matrix:
    """P (N, 3 c) on the second body, which must be another flexible one."""
    small_sliding = contact.second_body.reduced.matched
    return matched_surface.on_partner(
        small_sliding, contact.second_surface_name, contact.weights, contact.partner_frames
    )


class SmallSlidingLoads:
    """Loads of all small-sliding contacts of a body."""

    def __init__(self, history: History, view: SceneView, body: str) -> None:
        """body: name of a flexible one."""
        self._parts: list[tuple[SmallSlidingHistory, np.ndarray, sp.csr_matrix]] = []
        for name, contact in view.small_sliding.items():
            if contact.first_body.name == body:
                self._parts.append((history.small_sliding[name], contact.area, on_first(contact)))
            if contact.second is not None and contact.second_body.name == body:
                self._parts.append((history.small_sliding[name], contact.area, on_second(contact)))

    def forces(self, i: int) -> np.ndarray | None:
        """Forces (N,) [N] on all cells of the body's small-sliding contacts, in the order of
        `ReducedBody.small_sliding`, at saved step `i`; None for a body without any in the scene."""
        parts = [P @ cell_forces(contact, area, i) for contact, area, P in self._parts]
        return np.sum(parts, axis=0) if parts else None


def left_out(bodies: Any) -> list[str]:
    """A line for each of the `bodies`, views, whose skin has no response to the forces of its small-sliding
    contacts."""
    return [
        _left_out(body)
        for body in bodies
        if body.reduced and body.reduced.matched and body.reduced.surface.matched is None
    ]


def _left_out(body: BodyView) -> str:
    return (
        f"the skin of '{body.name}' moves by its modes alone: its local response to the forces of its matched faces "
        "was left out of its file as too large; surfaces.Matched(size=, growth=) makes fewer cells"
    )
