r"""Which cells of two faces lie on each other at the initial pose, and how forces of a cell act on the other face.

Triangles of the first face are cut by those of the second, seen along the normals of the first (`facing`). A cell of
the first face that is covered is a cell of the lap; its force acts on the cells of the second face in proportion to the
areas that they share, and what it sees of the second face is the mean of their displacements with the same weights, so
that the two are conjugate. Cells of the second face have a mean displacement each and no slope, so that shared areas
alone would put the force beside the cell where cells do not nest, and two cells on one of the second face would see the
same, which locks them. So weights w are changed by as little as makes them exact for displacements that are linear
along the face,

    sum w = 1,        sum w x = x of the cell,

with the cells x of the second face that it shares area with and the `NEAR` nearest ones; weights below 0 may be among
them. At the outline of the overlap cells of the first face are taken whole: the force acts on all
of the cell, and on the cells of the second face that it covers. The gap of a cell is the mean distance along its
normal.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
import scipy.sparse as sp
from scipy.spatial import KDTree

from warpffrf.model.errors import InputError
from warpffrf.model.laps.facing import Triangles, facing, why_apart

Array = np.ndarray
LEAST = 1e-2  # of a cell's area: less of it covered is none
NEAR = 5  # a cell and its neighbours on a grid
AT_PLACE = 1e-6  # of a cell's edge: how far its force may act beside it
SHORT = 1e-6  # of how far the cells at hand lie apart: directions in which they do not differ


@dataclass(frozen=True, eq=False)
class Pairing:
    """Cells of the lap, c of them: `cell` (c,) on the first face, `covered` (c,) the covered share of its area, `gap`
    (c,) [m], `weights` (c, cells of the second face) csr, rows that add up to 1; `shares` of both faces' areas that
    face each other."""

    cell: Array
    covered: Array
    gap: Array
    weights: sp.csr_matrix
    shares: tuple[float, float]


def pair_faces(label: str, first: Array, cell: Array, normals: Array, second: Array, other: Array) -> Pairing:
    """The pairing of two faces in common axes.

    first (t, 3, 3), second (u, 3, 3): corners of their triangles [m], outwards; cell (t,), other (u,): the cells that
    these are of; normals (cells of the first face, 3). Raises `InputError`, naming `label`, where they do not face each
    other.
    """
    a, b = Triangles.of(first), Triangles.of(second)
    pieces = facing(a, b)
    cells, of = int(cell.max()) + 1, cell[pieces.source]
    area = np.bincount(of, weights=pieces.area, minlength=cells)
    covered = area / np.bincount(cell, weights=a.area, minlength=cells)
    lap = np.flatnonzero(covered > LEAST)
    if not len(lap):
        raise InputError(
            f"{label}: the faces do not face each other: {why_apart(a, b, pieces.covered)}; place the bodies so that "
            "the two faces look at each other across a small gap"
        )
    gap = np.bincount(of, weights=pieces.area * pieces.gap, minlength=cells)[lap] / area[lap]
    shape = cells, int(other.max()) + 1
    shared = sp.csr_matrix((pieces.area, (of, other[pieces.across])), shape=shape)[lap]
    weights = sp.csr_matrix(sp.diags(1.0 / area[lap]) @ shared)
    weights = _at_their_places(weights, _centers(a, cell)[lap], np.sqrt(area[lap]), normals[lap], _centers(b, other))
    shares = min(pieces.covered[0], 1.0), min(pieces.covered[1], 1.0)
    return Pairing(lap, np.minimum(covered[lap], 1.0), gap, weights, shares)


def _centers(triangles: Triangles, cell: Array) -> Array:
    """Centroids (cells, 3) [m]."""
    area = np.bincount(cell, weights=triangles.area)
    middle = triangles.x.mean(axis=1) * triangles.area[:, None]
    return np.stack([np.bincount(cell, weights=middle[:, d]) for d in range(3)], axis=1) / area[:, None]


def _at_their_places(weights: sp.csr_matrix, x: Array, edge: Array, normals: Array, others: Array) -> sp.csr_matrix:
    """The weights (c, cells of the second face) changed as the module docstring says; x (c, 3), edge (c,), normals
    (c, 3) of the cells, others (cells of the second face, 3): places."""
    tree, near = KDTree(others), min(NEAR, len(others))
    aside = weights @ others - x
    aside -= np.einsum("ci,ci->c", aside, normals)[:, None] * normals
    rows = weights.tolil()
    for c in np.flatnonzero(np.linalg.norm(aside, axis=1) > AT_PLACE * edge):
        used = np.union1d(rows.rows[c], np.atleast_1d(tree.query(x[c], k=near)[1]))
        away = others[used] - x[c]
        away -= np.outer(away @ normals[c], normals[c])
        w = np.zeros(len(used))
        w[np.searchsorted(used, rows.rows[c])] = rows.data[c]
        w -= np.linalg.pinv((away - away.mean(axis=0)).T, rcond=SHORT) @ (w @ away)  # by no change of the sum
        rows.rows[c], rows.data[c] = used.tolist(), w.tolist()
    return sp.csr_matrix(rows)
