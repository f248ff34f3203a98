"""Nodes of a skin that belong to a face given by triangles, and means of its cells at these nodes.

Nodes of a face are the corners of its triangles with normals in the same direction, because the faces of a contact
within a body may coincide node by node. The opposite face is identified by its position alone: the normals of its nodes
oppose those of the triangles, and the nodes lie over a triangle at the gap of its cell, to about the deviation of bent
facets from their arc: layers of a body thinner than this are not distinguished. A node has the mean of the adjacent
cells, weighted by the angles of their triangles at the node, which do not depend on the triangulation of facets.

Thinning. A coarser copy of a display surface, to keep a recording small.

Every kept point is a point of the full surface, so the coarse one moves with its nodes and needs no averaging. On a
surface of equal sectors every k-th sector is kept, which keeps a round body round; otherwise nodes are clustered on a
cubic grid and each cluster keeps its node nearest to the centroid; the cell size is the smallest (by bisection) that
gives the required count.

Shown. Selection of the saved rows to show, and magnification of the elastic displacement.
"""

from __future__ import annotations

from functools import cached_property

import numpy as np
import scipy.sparse as sp
from scipy.spatial import KDTree

Array = np.ndarray
SAME = 1e-9  # of the extent of a skin: closer positions are equal
LOOKS = -0.3  # n . n of a node and its face: distinguishes nodes of coincident faces; edges belong to both
INSIDE = 1e-2  # of a triangle: how far outside of it an opposite node may lie
LEVEL = 1e-3  # of the size of a triangle: tolerance of an opposite node's distance from the gap, for planes
BENT = 0.25  # of the size times the angle to adjacent triangles: the same for bent faces, whose rise is an eighth
SLIVER = 1e-3  # of the largest triangle of a cell
NEIGHBOURS = 9  # triangles around one, including itself


class SkinNodes:
    """The nodes of a skin, `points` (n, 3) [m, user frame] and `triangles` (t, 3)."""

    def __init__(self, points: Array, triangles: Array) -> None:
        self.points, self._triangles = points, triangles

    @cached_property
    def normals(self) -> Array:
        """(n, 3), outwards."""
        return vertex_normals(self.points, self._triangles)

    @cached_property
    def _tree(self) -> KDTree:
        return KDTree(self.points)

    def on(self, corners: Array, cell: Array, cells: int) -> sp.csr_matrix:
        """Means (n, cells) at the nodes that are corners of the triangles (t, 3, 3) of cells (t,)."""
        corners, cell = _broad(corners, cell)
        reach = SAME * float(np.ptp(self.points, axis=0).max())
        corner, node = _pairs(self._tree.query_ball_point(corners.reshape(-1, 3), reach))
        return self._means(node, corner // 3, _angles(corners).ravel()[corner], _normals(corners)[0], cell, cells)

    def across(self, corners: Array, cell: Array, gap: Array) -> sp.csr_matrix:
        """Means (n, c) at the nodes opposite to the triangles (t, 3, 3) of cells (t,) with gaps (c,) [m]."""
        corners, cell = _broad(corners, cell)
        normal, area = _normals(corners)
        size, off, middle = np.sqrt(area), gap[cell], corners.mean(axis=1)
        beside = KDTree(middle).query(middle, k=min(NEIGHBOURS, len(middle)))[1].reshape(len(middle), -1)
        turned = np.linalg.norm(normal[beside] - normal[:, None], axis=2).max(axis=1)
        slack = size * (LEVEL + BENT * turned) + np.abs(off[beside] - off[:, None]).max(axis=1)
        reach = np.linalg.norm(corners - middle[:, None], axis=2).max(axis=1) * (1.0 + INSIDE) + slack
        triangle, node = _pairs(self._tree.query_ball_point(middle + off[:, None] * normal, reach))
        away = self.points[node] - corners[triangle, 0]
        level = np.abs(np.einsum("ki,ki->k", away, normal[triangle]) - off[triangle]) < slack[triangle]
        places = _barycentric(corners[triangle], normal[triangle], away)
        hit = level & np.all(places > -INSIDE, axis=1)
        node, triangle, places = node[hit], triangle[hit], places[hit]
        edges = np.sum(places < INSIDE, axis=1)  # number of edges through the node: two at a corner
        angle = np.where(edges == 0, 2.0 * np.pi, np.pi)
        angle = np.where(edges == 2, _angles(corners)[triangle, np.argmax(places, axis=1)], angle)
        return self._means(node, triangle, angle, -normal, cell, len(gap))

    def _means(
        self, node: Array, triangle: Array, angle: Array, normal: Array, cell: Array, cells: int
    ) -> sp.csr_matrix:
        """Means at the nodes (k,) whose normals agree with the normals (t, 3) of the triangles (k,), with an angle (k,)
        there."""
        looks = np.einsum("ki,ki->k", self.normals[node], normal[triangle]) > LOOKS
        shape = len(self.points), cells
        weights = sp.csr_matrix((angle[looks], (node[looks], cell[triangle[looks]])), shape=shape)
        total = np.asarray(weights.sum(axis=1)).ravel()
        return sp.csr_matrix(sp.diags(1.0 / np.where(total > 0.0, total, 1.0)) @ weights)


def _broad(corners: Array, cell: Array) -> tuple[Array, Array]:
    """Triangles, and their cells, without slivers from cutting, which have no well-defined direction."""
    area = _normals(corners)[1]
    largest = np.zeros(int(cell.max()) + 1)
    np.maximum.at(largest, cell, area)
    kept = area > SLIVER * largest[cell]
    return corners[kept], cell[kept]


def _normals(corners: Array) -> tuple[Array, Array]:
    """Unit normals (t, 3) and areas (t,) [m2]."""
    vector = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
    length = np.linalg.norm(vector, axis=1)
    return vector / np.where(length > 0.0, length, 1.0)[:, None], 0.5 * length


def _angles(corners: Array) -> Array:
    """(t, 3) rad, at the corners."""
    ahead, back = np.roll(corners, -1, axis=1) - corners, np.roll(corners, 1, axis=1) - corners
    return np.arctan2(np.linalg.norm(np.cross(ahead, back), axis=2), np.einsum("tci,tci->tc", ahead, back))


def _pairs(lists: Array) -> tuple[Array, Array]:
    """Index of a list and its item, for all items of all lists."""
    counts = np.array([len(held) for held in lists], dtype=int)
    held = np.concatenate([np.asarray(h, dtype=int) for h in lists]) if counts.sum() else np.zeros(0, dtype=int)
    return np.repeat(np.arange(len(counts)), counts), held


def _barycentric(corners: Array, normal: Array, away: Array) -> Array:
    """Barycentric coordinates (k, 3) of points `away` (k, 3) from the first corners of triangles (k, 3, 3), along
    normals."""
    a, b = corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0]
    whole = np.einsum("ki,ki->k", np.cross(a, b), normal)
    whole = np.where(whole > 0.0, whole, np.inf)
    u = np.einsum("ki,ki->k", np.cross(away, b), normal) / whole
    v = np.einsum("ki,ki->k", np.cross(a, away), normal) / whole
    return np.stack([1.0 - u - v, u, v], axis=1)


MIN_SECTORS = 24  # fewer would not look round
BISECTIONS = 24  # halvings of the cell size: far below the spacing of any mesh


def _clusters(points: np.ndarray, cell: float) -> np.ndarray:
    keys = np.floor((points - points.min(axis=0)) / cell + 0.5).astype(np.int64)
    return np.unique(keys, axis=0, return_inverse=True)[1].reshape(-1)


def thinned(
    points: np.ndarray, triangles: np.ndarray, max_points: int, sectors: int = 1
) -> tuple[np.ndarray, np.ndarray]:
    """Indices (k,) of the kept points, at most `max_points`, and triangles (t, 3) among them; everything if it is small
    enough."""
    if len(points) <= max_points:
        return np.arange(len(points)), np.asarray(triangles)
    if sectors > 1 and len(points) % sectors == 0 and sectors // MIN_SECTORS * max_points >= len(points):
        label, kept = _every_kth_sector(len(points), sectors, max_points)
    else:
        label, kept = _clustered(points, max_points)
    coarse = label[triangles]
    different = (coarse[:, 0] != coarse[:, 1]) & (coarse[:, 1] != coarse[:, 2]) & (coarse[:, 2] != coarse[:, 0])
    coarse = coarse[different]
    _, first = np.unique(np.sort(coarse, axis=1), axis=0, return_index=True)
    return kept, coarse[np.sort(first)]


def _every_kth_sector(count: int, sectors: int, max_points: int) -> tuple[np.ndarray, np.ndarray]:
    """Group of each point and the point kept of each group; points are numbered sector by sector."""
    per_sector = count // sectors
    k = -(-sectors // max(max_points // per_sector, 1))
    sector, node = np.divmod(np.arange(count), per_sector)
    return (sector // k) * per_sector + node, np.flatnonzero(sector % k == 0)


def _clustered(points: np.ndarray, max_points: int) -> tuple[np.ndarray, np.ndarray]:
    """Group of each point and the point kept of each group, by clustering on a cubic grid."""
    low, high = 0.0, float(np.ptp(points, axis=0).max())
    for _ in range(BISECTIONS):
        middle = 0.5 * (low + high)
        if _clusters(points, middle).max() + 1 > max_points:
            low = middle
        else:
            high = middle
    label = _clusters(points, high)
    count = np.bincount(label)
    centroid = np.stack([np.bincount(label, points[:, c]) for c in range(3)], axis=1) / count[:, None]
    distance = np.linalg.norm(points - centroid[label], axis=1)
    order = np.lexsort((distance, label))
    return label, order[np.searchsorted(label[order], np.arange(len(count)))]


def vertex_normals(points: np.ndarray, triangles: np.ndarray) -> np.ndarray:
    """Area-weighted unit normals (n, 3) of the vertices."""
    corners = points[triangles]
    area = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
    normals = np.zeros_like(points)
    for c in range(3):
        np.add.at(normals, triangles[:, c], area)
    length = np.linalg.norm(normals, axis=1, keepdims=True)
    return normals / np.where(length > 0.0, length, 1.0)


SHOWN_DISPLACEMENT = 0.015  # automatic magnification: largest displacement drawn, over the smallest body size


def frame_rows(steps: int, max_frames: int) -> tuple[np.ndarray, int]:
    """Rows to show, including the first and the last, at most `max_frames`, and the stride between them."""
    if steps == 0:
        return np.zeros(0, dtype=int), 1
    if steps == 1 or max_frames == 1:
        return np.array([steps - 1]), max(steps, 1)
    stride = -(-(steps - 1) // (max_frames - 1))
    return rows_every(steps, stride), stride


def rows_every(steps: int, stride: int) -> np.ndarray:
    """Every `stride`th row from the first, and the last."""
    rows = np.arange(0, steps, stride)
    return rows if rows[-1] == steps - 1 else np.append(rows, steps - 1)


def automatic_factor(largest: float, size: float) -> float:
    """Magnification of elastic displacements up to `largest` [m] if the smallest body has the extent `size` [m]."""
    return round_factor(SHOWN_DISPLACEMENT * size / largest) if largest > 0.0 else 1.0


def round_factor(factor: float) -> float:
    """The largest of 1, 2, 5 times a power of ten not above `factor`; at least 1."""
    if not np.isfinite(factor) or factor <= 1.0:
        return 1.0
    decade = 10.0 ** np.floor(np.log10(factor))
    return float(max(m * decade for m in (1.0, 2.0, 5.0) if m * decade <= factor * (1.0 + 1e-12)))
