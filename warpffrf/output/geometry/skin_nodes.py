"""Nodes of a skin that belong to a face which is given by triangles, and means of its cells at them.

Nodes of a face are the corners of its triangles that look along these, as the faces of a lap within a body may lie on
each other, node on node. The face across is known by where it lies alone: its nodes look against the triangles, lie
over one of them, and at the gap that cells have there, to about what bent facets stand off their arc: layers of a body
that are thinner than this are not told apart. A node has the mean of the cells that meet in it, weighed by the angles
that their triangles have there, which do not depend on how facets are cut into triangles.
"""

from __future__ import annotations

from functools import cached_property

import numpy as np
import scipy.sparse as sp
from scipy.spatial import KDTree

from warpffrf.output.geometry.thinning import vertex_normals

Array = np.ndarray
SAME = 1e-9  # of the extent of a skin: places of one node
LOOKS = -0.3  # n . n of a node and its face: nodes of faces that lie on each other are told apart, edges belong to both
INSIDE = 1e-2  # of a triangle: how far beside it a node opposite may lie
LEVEL = 1e-3  # of the size of a triangle: how far a node opposite may be from where the gap has it, on a plane
BENT = 0.25  # of the size times the angle to the next triangles: the same of bent faces; their rise is an eighth
SLIVER = 1e-3  # of the largest triangle of a cell
NEIGHBOURS = 9  # triangles around one, itself among them


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
        """Means (n, cells) at the nodes that are corners of triangles (t, 3, 3) of cells (t,)."""
        corners, cell = _broad(corners, cell)
        reach = SAME * float(np.ptp(self.points, axis=0).max())
        corner, node = _pairs(self._tree.query_ball_point(corners.reshape(-1, 3), reach))
        return self._means(node, corner // 3, _angles(corners).ravel()[corner], _normals(corners)[0], cell, cells)

    def across(self, corners: Array, cell: Array, gap: Array) -> sp.csr_matrix:
        """Means (n, c) at the nodes that lie opposite to triangles (t, 3, 3) of cells (t,) with gaps (c,) [m]."""
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
        edges = np.sum(places < INSIDE, axis=1)  # that the node lies on: two at a corner
        angle = np.where(edges == 0, 2.0 * np.pi, np.pi)
        angle = np.where(edges == 2, _angles(corners)[triangle, np.argmax(places, axis=1)], angle)
        return self._means(node, triangle, angle, -normal, cell, len(gap))

    def _means(
        self, node: Array, triangle: Array, angle: Array, normal: Array, cell: Array, cells: int
    ) -> sp.csr_matrix:
        """Of the nodes (k,) that look along the normals (t, 3) of the triangles (k,) that have an angle (k,) there."""
        looks = np.einsum("ki,ki->k", self.normals[node], normal[triangle]) > LOOKS
        shape = len(self.points), cells
        weights = sp.csr_matrix((angle[looks], (node[looks], cell[triangle[looks]])), shape=shape)
        total = np.asarray(weights.sum(axis=1)).ravel()
        return sp.csr_matrix(sp.diags(1.0 / np.where(total > 0.0, total, 1.0)) @ weights)


def _broad(corners: Array, cell: Array) -> tuple[Array, Array]:
    """Triangles, and their cells, without slivers that cutting leaves: they have no direction."""
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
    """Number of a list and what it holds, for all that lists hold."""
    counts = np.array([len(held) for held in lists], dtype=int)
    held = np.concatenate([np.asarray(h, dtype=int) for h in lists]) if counts.sum() else np.zeros(0, dtype=int)
    return np.repeat(np.arange(len(counts)), counts), held


def _barycentric(corners: Array, normal: Array, away: Array) -> Array:
    """Coordinates (k, 3) of places `away` (k, 3) from the first corners of triangles (k, 3, 3), seen along normals."""
    a, b = corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0]
    whole = np.einsum("ki,ki->k", np.cross(a, b), normal)
    whole = np.where(whole > 0.0, whole, np.inf)
    u = np.einsum("ki,ki->k", np.cross(away, b), normal) / whole
    v = np.einsum("ki,ki->k", np.cross(a, away), normal) / whole
    return np.stack([1.0 - u - v, u, v], axis=1)
