r"""Location of points in cells: the inverse of the isoparametric map.

A cell lies in the bounding box of its nodes, enlarged if it is curved. Cells are sorted into classes by the size of
that box (powers of two); in each class, a KD-tree of the centres gives the candidates, which are filtered by their
boxes, so that long thin cells are found as reliably as cubes. `x(xi) = sum_a N_a(xi) x_a = x` is then solved by
Newton's method from the middle of the reference cell.

Sectors. Stress operators of a rotationally periodic body: from the whole mesh to blocks between sectors.

Each sector's displacement u_s is given in its own axes A_s (columns), u = A_s u_s at its nodes, and the stress of a
point in sector s in the axes of that sector, sigma_s = A_s^T sigma A_s. An operator S on all nodes becomes

    sigma_s = sum_o S_o u_(s+o),      S_o = R(A_s^T) S A_(s+o),

R(A) the rotation of the six components; a point and its copies in other sectors have the same S_o. Nodal averaging of
linear cells reaches one cell beyond the point's own, patches of quadratic ones two: o covers all sectors that they
touch.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np
import scipy.sparse as sp

from warpffrf.model.errors import InputError
from warpffrf.model.mesh.elements import cell_kind
from warpffrf.model.reduced.stress_field import rotated, sector_frames
from warpffrf.offline.fe import Sparse

Array = np.ndarray
LINEAR = {"hex": "hex8", "wedge": "wedge6", "tet": "tet4"}  # the cell with straight edges on each domain
# Mid nodes this many times their distance from the straight cell: a quadratic map extends beyond its nodes by less
# than that distance along an edge, less than twice it on a face.
BULGE = 2.0
INSIDE = 1e-6  # reference coordinates: a point this far outside a cell, a millionth of it, lies on its face
# Of a cell's size: a point this close outside the mesh is moved onto it. The true circle lies pi/(4 N) of a cell
# outside the linear cells of a mesh with N cells around, 2 % at N = 40.
SNAP = 0.02
STEPS = 25  # of Newton's method; a cell that is not inverted needs about five
_CHUNK = 20_000  # pairs of point and cell processed together: bounds the memory to some tens of MB
CONVERGED = 1e-13  # reference coordinates, round-off
LIMIT = 2.0  # reference coordinates further out than this are clipped: outside, the map of a curved cell may fold over


@dataclass(frozen=True)
class Located:
    """Cells that contain points, several for a point on a face: `point` (e,), `kind` (e,) number of the block, `cell`
    (e,) within the block, reference coordinates `xi` (e, 3); and the displacement of each point, `moved` (p,) [m]."""

    point: Array
    kind: Array
    cell: Array
    xi: Array
    moved: Array


def locate(points: Array, nodes: Array, cells: Mapping[str, Array], name: str) -> Located:
    """Find `points` (p, 3) in the `cells` {kind: (m, k)} over `nodes` (n, 3), all in m.

    Raises `InputError` naming the first point that lies outside, with its distance to the nearest cell.
    """
    found = [_in_block(points, nodes[block], kind) for kind, block in cells.items()]
    number = np.concatenate([np.full(len(f[0]), i) for i, f in enumerate(found)])
    point, cell, xi, gap, size = (np.concatenate(parts) for parts in zip(*found, strict=True))
    nearest = np.full(len(points), np.inf)
    np.minimum.at(nearest, point, gap)
    outside = np.flatnonzero(np.isinf(nearest))
    if len(outside):
        x = points[outside[0]]
        distance = min(_distance(x, nodes[block], kind) for kind, block in cells.items())
        raise InputError(
            f"stress {name!r}: {len(outside)} of {len(points)} points lie outside the mesh, the first is number "
            f"{outside[0]} at ({', '.join(f'{v:.6g}' for v in x)}) m, {distance:.3g} m from the nearest cell; move it "
            "inside, or check its unit and frame"
        )
    keep = gap <= nearest[point] + INSIDE * size
    return Located(point[keep], number[keep], cell[keep], xi[keep], nearest)


def _in_block(points: Array, x: Array, kind: str) -> tuple[Array, Array, Array, Array, Array]:
    """(point, cell, xi, distance, cell size) of the points in or close to cells with node coordinates x (m, k, 3)."""
    point, cell = _candidates(points, x, kind)
    xi, gap = np.zeros((len(point), 3)), np.zeros(len(point))
    for start in range(0, len(point), _CHUNK):
        part = slice(start, start + _CHUNK)
        xi[part], gap[part] = inverse_map(points[point[part]], x[cell[part]], kind)
    size = np.max(np.ptp(x[cell], axis=1), axis=1)
    near = gap <= SNAP * size
    return point[near], cell[near], xi[near], gap[near], size[near]


def _candidates(points: Array, x: Array, kind: str) -> tuple[Array, Array]:
    """Pairs (point, cell) with the point in the cell's enlarged box."""
    from scipy.spatial import KDTree

    element = cell_kind(kind)
    straight = cell_kind(LINEAR[element.domain]).shape(element.nodes)[0] @ x[:, : element.corner_count]
    low, high = x.min(axis=1), x.max(axis=1)
    margin = BULGE * np.max(np.abs(x - straight), axis=1) + SNAP * np.max(high - low, axis=1)[:, None]
    low, high = low - margin, high + margin
    radius = 0.5 * np.linalg.norm(high - low, axis=1)
    pairs = []
    levels = np.floor(np.log2(radius)).astype(int)
    for level in np.unique(levels):
        members = np.flatnonzero(levels == level)
        tree = KDTree(0.5 * (low + high)[members])
        lists = tree.query_ball_point(points, float(radius[members].max()))
        point = np.repeat(np.arange(len(points)), [len(entry) for entry in lists])
        cell = members[np.concatenate([np.asarray(entry, dtype=int) for entry in lists])]
        inside = np.all((points[point] >= low[cell]) & (points[point] <= high[cell]), axis=1)
        pairs.append(np.stack([point[inside], cell[inside]]))
    point, cell = np.concatenate(pairs, axis=1)
    return point, cell


def inverse_map(points: Array, x: Array, kind: str) -> tuple[Array, Array]:
    """Reference coordinates (e, 3), clipped to the reference cell, of one point in each cell x (e, k, 3), and the
    distance (e,) [m] between the point and their image; 0 for a point inside."""
    element = cell_kind(kind)
    xi = np.tile(element.nodes[: element.corner_count].mean(axis=0), (len(points), 1))
    active = np.arange(len(points))
    for _ in range(STEPS):
        if not len(active):
            break
        N, dN = element.shape(xi[active])
        residual = points[active] - np.einsum("ea,eai->ei", N, x[active])
        J = np.einsum("eai,eaj->eij", x[active], dN)
        step = np.linalg.solve(J + _tiny(J), residual[..., None])[..., 0]
        moved = np.clip(xi[active] + step, -LIMIT, LIMIT)
        done = np.max(np.abs(moved - xi[active]), axis=1) < CONVERGED
        xi[active] = moved
        active = active[~done]
    cut = inside_cell(xi, element.domain)
    image = np.einsum("ea,eai->ei", element.shape(cut)[0], x)
    gap = np.linalg.norm(points - image, axis=1)
    inside = np.max(np.abs(cut - xi), axis=1, initial=0.0) < INSIDE
    exact = gap < INSIDE * np.max(np.ptp(x, axis=1), axis=1)
    return cut, np.where(inside & exact, 0.0, gap)


def inside_cell(xi: Array, domain: str) -> Array:
    """Reference coordinates (e, 3) moved onto the reference cell of `domain` "hex", "wedge" or "tet"."""
    if domain == "hex":
        return np.clip(xi, -1.0, 1.0)
    flat = 3 if domain == "tet" else 2
    cut = xi.copy()
    cut[:, :flat] = np.maximum(cut[:, :flat], 0.0)
    cut[:, :flat] /= np.maximum(cut[:, :flat].sum(axis=1), 1.0)[:, None]
    if domain == "wedge":
        cut[:, 2] = np.clip(cut[:, 2], -1.0, 1.0)
    return cut


def _tiny(J: Array) -> Array:
    """Round-off of each Jacobian on its diagonal: keeps the solve defined where the cut map is singular."""
    return 1e-14 * np.abs(J).max(axis=(1, 2))[:, None, None] * np.eye(3)


def _distance(x: Array, cells: Array, kind: str) -> float:
    """Approximate distance [m] of the point x (3,) to the nearest of the cells (m, k, 3)."""
    count = min(32, len(cells))
    corners = cells[:, : cell_kind(kind).corner_count]
    order = np.argsort(np.min(np.linalg.norm(corners - x, axis=2), axis=1))[:count]
    return float(inverse_map(np.tile(x, (count, 1)), cells[order], kind)[1].min())


SAME_PLACE = 1e-9  # of the body's size: points of rotated sectors this close are one point


@dataclass(frozen=True)
class SectorOperator:
    """Stress at the distinct positions of the points, for a rotationally periodic body.

    `blocks` {o: csr (6 p0, 3 nn)} [Pa/m] act on the displacements of sector o (counted from the point's own), given in
    that sector's axes; the result is in the axes of the point's sector. `place` (p,), `sector` (p,), `axes` (3, 3).
    """

    blocks: dict[int, Sparse]
    place: Array
    sector: Array
    axes: Array
    sectors: int

    def sampled(self, k: int, wave: Array) -> Array:
        """Waves `wave` (6 p0, m) e^{i k s phi} of harmonic k at the points: (6 p, m), complex, user axes."""
        turn = np.exp(2j * np.pi * (k * self.sector % self.sectors) / self.sectors)
        parts = wave.reshape(len(wave) // 6, 6, wave.shape[1])[self.place] * turn[:, None, None]
        frames = sector_frames(self.axes, self.sector, self.sectors)
        found = np.moveaxis(rotated(np.moveaxis(parts, 2, 0), frames), 0, 2)
        return found.reshape(6 * len(found), wave.shape[1])


def sector_blocks(S: Sparse, home: Array, axes: Array, sectors: int) -> dict[int, Sparse]:
    """{o: csr (6 r, 3 nn)} of S, csr (6 r, 3 n) [Pa/m] in user axes, for points in the sectors `home` (r,)."""
    n = S.shape[1] // 3
    nn = n // sectors
    by_node = sp.bsr_matrix(S.tobsr((6, 3)))
    row = np.repeat(np.arange(len(home)), np.diff(by_node.indptr))
    node = by_node.indices.astype(np.int64)
    frames = sector_frames(axes, np.arange(sectors), sectors)
    data = by_node.data @ frames[node // nn]  # (e, 6, 3)
    back = frames[home][row].swapaxes(1, 2)[:, None]
    data = np.moveaxis(rotated(np.moveaxis(data, 2, 1), back), 1, 2)
    offset = (node // nn - home[row] + sectors // 2) % sectors - sectors // 2
    blocks = {}
    for o in np.unique(offset):
        part = offset == o
        rows = np.broadcast_to(6 * row[part][:, None, None] + np.arange(6)[:, None], data[part].shape)
        columns = np.broadcast_to(3 * (node[part] % nn)[:, None, None] + np.arange(3), data[part].shape)
        entries = (data[part].ravel(), (rows.ravel(), columns.ravel()))
        blocks[int(o)] = sp.csr_matrix(entries, shape=(6 * len(home), 3 * nn))
    return blocks


def distinct_places(
    relative: Array, home: Array, marks: Array, axes: Array, size: float, sectors: int
) -> tuple[Array, Array]:
    """One point (p0,) of each distinct position in a sector, and the position (p,) of every point.

    `relative` (p, 3) [m] to a point on the axis, user axes; `size` [m] of the body. Points whose copies in one sector
    coincide share a position if their `marks` (p,) agree: a contact surface may end within the revolution.
    """
    local = np.einsum("pj,pji->pi", relative, sector_frames(axes, home, sectors))
    keys = np.column_stack([np.rint(local / (SAME_PLACE * size)), marks])
    _, first, place = np.unique(keys, axis=0, return_index=True, return_inverse=True)
    return first, place.ravel()
