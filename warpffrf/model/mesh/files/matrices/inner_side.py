r"""On which side of a facet the body lies, from K alone.

Two nodes of one cell are coupled: their block of K is not zero. The corners of a face of a cell are therefore coupled
with one another, and the nodes that are coupled with all of them are those of the cells at the face (in meshes of
tetrahedra a few more). With n the unit normal of a facet, c the mean of its corners and d_j = n . (x_j - c) for those
nodes that are not on the facet,

    s = sum d_j / sum |d_j|

is -1 where all of them lie behind the facet, as on the surface with an outward normal, +1 with an inward one, and near
0 for a face between two cells. The median over a set counts, so that a single odd cell does not.

A condensed K couples every node with every other and says nothing: rows longer than `LONGEST_ROW` are not looked at.
"""

from __future__ import annotations

from typing import Any

import numpy as np

from warpffrf.model.errors import InputError
from warpffrf.model.mesh.facets import FacetSet

LONGEST_ROW = 1000  # nodes coupled with one node, in the mean: hex27 have 125, quadratic tetrahedra some 50 to 200
INSIDE = 0.35  # |s| of a face between two cells of unequal depth: up to 1 : 2


def require_on_surface(K: Any, facets: FacetSet, points: np.ndarray, label: str) -> None:
    """Raise `InputError` for facets of no cell, inside the body, or with inward normals; K (3n, 3n) csr."""
    sides = []
    for kind, corners in facets.corners.items():
        nodes = facets.blocks[kind]
        coupled = _coupled(K, corners, len(points))
        if coupled is None:
            return
        torn = np.flatnonzero(~_holds(coupled, corners).all(axis=1))
        if len(torn):
            raise InputError(
                f"{label}: {len(torn)} {kind} facet(s) are no face of a cell, K does not couple their corners; the "
                f"first is number {torn[0]} with corners {corners[torn[0]].tolist()}; give positions in `nodes` "
                "counted from 0, corners first"
            )
        sides.append(_side(coupled, corners, nodes, points))
    s = float(np.median(np.concatenate(sides)))
    if abs(s) < INSIDE:
        raise InputError(f"{label}: the body lies on both sides of them; choose facets on the surface")
    if s > 0.0:
        raise InputError(f"{label}: the normals point into the body; reverse the order of the nodes of each facet")


def _coupled(K: Any, corners: np.ndarray, count: int) -> Any:
    """Nodes coupled with all corners of each facet, csr (m, count) of ones; None where K is dense."""
    from scipy.sparse import csr_matrix

    used, place = np.unique(corners, return_inverse=True)
    dofs = (3 * used[:, None] + np.arange(3)).ravel()
    rows = csr_matrix(K.tocsr()[dofs])
    if rows.nnz > 9 * LONGEST_ROW * len(used):
        return None
    kept = rows.data != 0.0
    node = np.repeat(np.arange(len(dofs)), np.diff(rows.indptr))[kept] // 3
    graph = csr_matrix((np.ones(len(node), dtype=np.int32), (node, rows.indices[kept] // 3)), shape=(len(used), count))
    graph.data[:] = 1  # duplicates were summed
    m, c = corners.shape
    of_facet = csr_matrix((np.ones(m * c, dtype=np.int32), (np.repeat(np.arange(m), c), place.ravel())), (m, len(used)))
    common = csr_matrix(of_facet @ graph)
    common.data = (common.data == c).astype(np.int32)
    common.eliminate_zeros()
    return common


def _holds(common: Any, nodes: np.ndarray) -> np.ndarray:
    """Whether each of the nodes (m, k) is among the common ones of its facet."""
    row = np.repeat(np.arange(len(nodes)), nodes.shape[1])
    found: Any = common[row, nodes.ravel()]
    return np.asarray(found).reshape(nodes.shape) > 0


def _side(common: Any, corners: np.ndarray, nodes: np.ndarray, points: np.ndarray) -> np.ndarray:
    """s (m,) of each facet; -1 where nothing is known."""
    x = points[corners]
    normal = np.cross(x, np.roll(x, -1, axis=1)).sum(axis=1)
    normal /= np.linalg.norm(normal, axis=1)[:, None]
    row = np.repeat(np.arange(len(corners)), np.diff(common.indptr))
    d = np.einsum("ei,ei->e", points[common.indices] - x.mean(axis=1)[row], normal[row])
    d[(nodes[row] == common.indices[:, None]).any(axis=1)] = 0.0
    total = np.bincount(row, np.abs(d), len(corners))
    return np.where(total > 0.0, np.bincount(row, d, len(corners)) / np.where(total > 0.0, total, 1.0), -1.0)
