r"""Pressure functions of a film: bilinear ones of the grid, or linear ones at the FE nodes of the first surface.

Both are functions psi_i with a position each, given at points with weights w (m^2 of the true surface) by sparse
matrices of values and of slopes along the surface. Displacements are those of the grid's nodes at the points. Cavity
volumes are lumped, m_i m^2 each, and cross the faces between neighbours i and j, whose normal [m] points from i to j
and has the length of the face.

    nodes    tensor products, 3 x 2 Gauss points per cell, boxes around the nodes: the law of the separated solver
    nodes   P1 on the triangles of the skin in the chart, six points each, boxes between perpendicular
            bisectors around the nodes, without faces across the diagonals of rectangles, so that cavities do not
            spread across the flow; the nodes of the rim of the triangulation are fixed
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np
from scipy import sparse

from references.monolithic.line_of_centres.sampling import ON_SURFACE, _node_values
from warpffrf.model.errors import InputError
from warpffrf.model.reduced.contact_grid import cell_edges

AROUND, ALONG = 3, 2  # Gauss points of a cell
# six points of degree four on a triangle (Dunavant 1985): h^3 of a gap that is linear, times a slope
NEAR, FAR = (0.445948490915965, 0.223381589678011), (0.091576213509771, 0.109951743655322)  # place, weight
NO_FACE = 1e-9  # of the side that it crosses: round-off of a right angle
AT_END = 1e-6  # of a grid spacing: nodes on the outermost lines of a grid lie on it despite round-off

Array = np.ndarray


@dataclass(frozen=True, eq=False)
class Basis:
    """theta, z, weight [m2] (points,); value, around, along (points, functions) sparse, the latter two slopes [1/m];
    deform (points, nodes) sparse; of the functions: place (theta, z), held, given [Pa], fed by a feed, area [m2]; faces
    (faces, 2) functions and their normals (faces, 2) [m] around and along; to_grid (nodes, functions) sparse."""

    theta: Array
    z: Array
    weight: Array
    value: Any
    around: Any
    along: Any
    deform: Any
    place: Array
    held: Array
    given: Array
    fed: Array
    area: Array
    faces: Array
    normals: Array
    to_grid: Any

    @property
    def functions(self) -> int:
        """Their number."""
        return len(self.held)


def metric(shape: Any, z: Array) -> tuple[Array, Array]:
    """R [m], of a plane 1, and length of the meridian over z, at z."""
    radius = np.broadcast_to(np.asarray(shape.radius_at(z), dtype=float), np.shape(z))
    steep = 0.0 if shape.profile().planar else np.asarray(shape.slope_at(z), dtype=float)
    return radius, np.broadcast_to(np.sqrt(1.0 + steep**2), np.shape(z))


# --- nodes


def _line(nodes: int, closed: bool, count: int) -> tuple[Array, Array, Any, Any]:
    """On a line of nodes with unit spacing: cell and position (points,) in it of `count` Gauss points per cell, values
    and slopes (points, nodes)."""
    x, _ = np.polynomial.legendre.leggauss(count)
    cells = nodes if closed else nodes - 1
    cell, at = np.repeat(np.arange(cells), count), np.tile(0.5 * (x + 1.0), cells)
    row = np.arange(len(cell))
    where = (np.concatenate([row, row]), np.concatenate([cell, (cell + 1) % nodes]))
    values, ones = np.concatenate([1.0 - at, at]), np.ones(len(cell))
    shape = (len(cell), nodes)
    value = sparse.csr_matrix((values, where), shape=shape)
    return cell, at, value, sparse.csr_matrix((np.concatenate([-ones, ones]), where), shape=shape)


def bilinear_basis(film: Any) -> Basis:
    """The bilinear functions of the grid of `film`."""
    shape, grid = film.a.surface.shape, film.grid
    columns, rows = grid.columns, grid.rows
    cell, u, across, rise = _line(columns, grid.periodic, AROUND)
    line, v, along, climb = _line(rows, False, ALONG)
    step = np.diff(grid.z)[line]
    z = grid.z[line] + v * step
    radius, stretch = metric(shape, z)
    w_around = np.tile(0.5 * np.polynomial.legendre.leggauss(AROUND)[1], columns if grid.periodic else columns - 1)
    w_along = np.tile(0.5 * np.polynomial.legendre.leggauss(ALONG)[1], rows - 1)
    value = sparse.kron(across, along, format="csr")
    held, given = film.held()
    fed = np.zeros((columns, rows), dtype=bool)
    for feed in film.feeds:
        fed |= feed.nodes(shape, film.theta, grid.z)[0]
    area, faces, normals = _boxes(grid, shape)
    places = np.meshgrid(film.theta, grid.z, indexing="ij")
    return Basis(
        np.repeat(film.theta[cell] + u * grid.pitch, len(z)), np.tile(z, len(cell)),
        np.outer(grid.pitch * w_around, w_along * step * radius * stretch).ravel(), value,
        sparse.kron(rise / grid.pitch, sparse.diags(1.0 / radius) @ along, format="csr"),
        sparse.kron(across, sparse.diags(1.0 / (step * stretch)) @ climb, format="csr"), value,
        np.stack([x.ravel() for x in places], axis=1), held.ravel(), given.ravel(), fed.ravel(), area, faces, normals,
        sparse.identity(columns * rows, format="csr"),
    )  # fmt: skip


def _boxes(grid: Any, shape: Any) -> tuple[Array, Array, Array]:
    """Areas of the boxes around nodes, faces between them, and the faces' normals."""
    columns, rows = grid.columns, grid.rows
    number = np.arange(columns * rows).reshape(columns, rows)
    edges = cell_edges(grid.z)
    wide = np.full(columns, grid.pitch)
    if not grid.periodic:
        wide[[0, -1]] *= 0.5
    radius, stretch = metric(shape, 0.5 * (edges[1:] + edges[:-1]))
    length = np.diff(edges) * stretch
    behind = np.roll(number, -1, axis=0)
    last = columns if grid.periodic else columns - 1
    around = np.stack([number[:last], behind[:last]], axis=-1).reshape(-1, 2)
    along = np.stack([number[:, :-1], number[:, 1:]], axis=-1).reshape(-1, 2)
    across = np.zeros((len(around), 2))
    across[:, 0] = np.tile(length, last)
    lengthwise = np.zeros((len(along), 2))
    lengthwise[:, 1] = np.outer(wide, metric(shape, edges[1:-1])[0]).ravel()
    return np.outer(wide, length * radius).ravel(), np.vstack([around, along]), np.vstack([across, lengthwise])


# --- nodes


def node_basis(film: Any) -> Basis:
    """Linear functions at the nodes of the first body's skin that lie on the grid of `film`. Raises `InputError` if
    there are none, and for feeds that cover none of them."""
    surface, skin = film.a.surface, film.a.body.reduced.surface
    grid, shape = surface.grid, surface.shape
    theta, z, x, on = _nodes(film, skin.points)
    triangles = skin.triangles[on[skin.triangles].all(axis=1)]
    used, corner = np.unique(triangles, return_inverse=True)
    corner = corner.reshape(-1, 3)
    period = 0.0 if shape.profile().planar or not grid.periodic else 2.0 * np.pi
    if not len(used):
        raise InputError(
            f"{film.label}: at_nodes has its pressures at the nodes of {film.a.label}, and no facet of the "
            "body's skin lies on its grid; reduce the body again, or use at_nodes=False"
        )
    theta, z, x = theta[used], np.clip(z[used], grid.z[0], grid.z[-1]), x[used]
    if not grid.periodic:
        x = np.clip(x, 0.0, grid.columns - 1)
    n, t = len(used), len(corner)
    at = np.stack([theta[corner], z[corner]], axis=2)  # (t, 3, 2)
    if period:
        at[:, :, 0] -= period * np.round((at[:, :, 0] - at[:, :1, 0]) / period)
    bary, part = _rule()
    points = np.einsum("qc,tcd->tqd", bary, at).reshape(-1, 2)
    sides = at[:, 1:] - at[:, :1]
    twice = sides[:, 0, 0] * sides[:, 1, 1] - sides[:, 0, 1] * sides[:, 1, 0]
    radius, stretch = metric(shape, points[:, 1])
    weight = np.outer(0.5 * np.abs(twice), part).ravel() * radius * stretch
    opposite = np.roll(at, -1, axis=1) - np.roll(at, -2, axis=1)  # side across from each corner
    slopes = np.stack([opposite[:, :, 1], -opposite[:, :, 0]], axis=2) / twice[:, None, None]
    rows = np.repeat(np.arange(t * len(part)), 3)
    owner = np.repeat(corner, len(part), axis=0).ravel()

    def matrix(values: Array) -> Any:
        return sparse.csr_matrix((values.ravel(), (rows, owner)), shape=(t * len(part), n))

    value = matrix(np.tile(bary, (t, 1)))
    around = matrix(np.repeat(slopes[:, :, 0], len(part), axis=0) / radius[:, None])
    along = matrix(np.repeat(slopes[:, :, 1], len(part), axis=0) / stretch[:, None])
    faces, normals, rim = _bisectors(corner, at, shape)
    held = np.zeros(n, dtype=bool)
    held[rim] = True
    given = np.where(held, film.ambient_pressure, 0.0)
    fed = np.zeros(n, dtype=bool)
    for number, feed in enumerate(film.feeds, start=1):
        found = feed.covers(shape, theta, z)
        if not feed.reaches_ends:
            found &= ~held | fed
        if not found.any():
            raise InputError(
                f"{film.label}: feed {number}, the {feed.label}, lies between the nodes of {film.a.label}, where "
                "at_nodes has its pressures; make it wider, or use at_nodes=False"
            )
        given[found] = feed.pressure
        fed |= found
    return Basis(
        points[:, 0], points[:, 1], weight, value, around, along, value @ _node_values(grid, x, z),
        np.stack([theta, z], axis=1), held | fed, given, fed, np.asarray(value.T @ weight), faces, normals,
        _to_grid(film, corner, at, n, period),
    )  # fmt: skip


def _nodes(film: Any, places: Array) -> tuple[Array, Array, Array, Array]:
    """theta, z and grid columns of points (n, 3), and which of them lie on the grid of `film`."""
    grid, shape = film.grid, film.a.surface.shape
    theta, z, distance = shape.chart(places)
    size = shape.size or max(float(grid.z[-1] - grid.z[0]), float(grid.pitch * grid.columns))
    step = np.diff(grid.z)
    on = np.abs(distance) < ON_SURFACE * size
    on &= (z > grid.z[0] - AT_END * step[0]) & (z < grid.z[-1] + AT_END * step[-1])
    x = (theta - film.theta[0]) / grid.pitch
    if not shape.profile().planar:
        turn = 2.0 * np.pi / grid.pitch
        x = x - turn * np.floor((x - 0.5 * (grid.columns - 1)) / turn + 0.5)
        theta = film.theta[0] + x * grid.pitch
    if not grid.periodic:
        on &= (x > -AT_END) & (x < grid.columns - 1 + AT_END)
    return theta, z, x, on


def _rule() -> tuple[Array, Array]:
    """Barycentric coordinates (6, 3) and weights (6,)."""
    bary, part = [], []
    for place, weight in (NEAR, FAR):
        for corner in range(3):
            row = np.full(3, place)
            row[corner] = 1.0 - 2.0 * place
            bary.append(row)
            part.append(weight)
    return np.array(bary), np.array(part) / np.sum(part)


def _bisectors(corner: Array, at: Array, shape: Any) -> tuple[Array, Array, Array]:
    """Faces of the boxes formed by perpendicular bisectors around nodes, their normals, and the nodes on the rim. A
    face is half a side times the cotangent of the opposite angle; negative lengths are set to zero."""
    scale = np.stack(metric(shape, at.mean(axis=1)[:, 1]), axis=1)
    pairs, sides, lengths = [], [], []
    for i, j, k in ((0, 1, 2), (1, 2, 0), (2, 0, 1)):
        a, b = (at[:, i] - at[:, k]) * scale, (at[:, j] - at[:, k]) * scale
        across = np.abs(a[:, 0] * b[:, 1] - a[:, 1] * b[:, 0])
        lengths.append(0.5 * np.sum(a * b, axis=1) / across)  # over that of the side
        forth = corner[:, i] < corner[:, j]
        sides.append(np.where(forth[:, None], b - a, a - b))
        pairs.append(np.sort(corner[:, [i, j]], axis=1))
    faces, first, number, count = np.unique(
        np.vstack(pairs), axis=0, return_index=True, return_inverse=True, return_counts=True
    )
    length = np.bincount(number.ravel(), np.concatenate(lengths), len(faces))
    length[length < NO_FACE] = 0.0
    return faces, length[:, None] * np.vstack(sides)[first], np.unique(faces[count == 1])


def _to_grid(film: Any, corner: Array, at: Array, nodes: int, period: float) -> Any:
    """(nodes, functions): values at the nodes of the grid, in the triangle that contains each."""
    grid = film.grid
    theta, z = (x.ravel() for x in np.meshgrid(film.theta, grid.z, indexing="ij"))
    a, b = at[:, 1] - at[:, 0], at[:, 2] - at[:, 0]
    twice = a[:, 0] * b[:, 1] - a[:, 1] * b[:, 0]
    rows, columns, values = [], [], []
    for m, place in enumerate(zip(theta, z, strict=True)):
        off = np.asarray(place) - at[:, 0]
        if period:
            off[:, 0] -= period * np.round(off[:, 0] / period)
        u = (off[:, 0] * b[:, 1] - off[:, 1] * b[:, 0]) / twice
        v = (a[:, 0] * off[:, 1] - a[:, 1] * off[:, 0]) / twice
        parts = np.stack([1.0 - u - v, u, v], axis=1)
        best = int(np.argmax(parts.min(axis=1)))
        part = np.maximum(parts[best], 0.0)
        rows += [m] * 3
        columns += list(corner[best])
        values += list(part / part.sum())
    return sparse.csr_matrix((values, (rows, columns)), shape=(len(theta), nodes))
