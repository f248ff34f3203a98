r"""Displacement gradients at nodes of quadratic cells from patches of cells (Zienkiewicz and Zhu 1992).

O. C. Zienkiewicz and J. Z. Zhu, Int. J. Numer. Methods Eng. 33, 1331. Around each corner of the cells, a *vertex*, the
gradient is a polynomial, fitted to its values at the recovery points of all cells that share the vertex, where it is
more accurate by an order than elsewhere:

    g_v(x) = m(x).a_v,      sum_q |m(x_q).a_v - g(x_q)|^2 -> min,      m = (1, x, y, z, x^2, xy, ..., z^3).

Hexahedra have four layers of points in a patch, which tell a cubic; stress under a contact falls so quickly that a
quadratic polynomial does not follow it where the contact is a few nodes wide. Points of tetrahedra and wedges lie in no
such layers, and carry a quadratic polynomial. The value at a vertex is that of its polynomial; at a node between
vertices, on an edge, a face or inside a cell, it is the mean of the polynomials of the vertices around. On the boundary
a patch has one layer of cells: there the polynomials of neighbours along an edge are taken that have cells on both
sides (half as many cells again as its own, or more), as far as there are any.

In the fit x is taken from the mean of the points in the axes and units of their covariance, so that the shape of the
cells does not matter, and the higher terms without what the linear ones say of them: a direction with one layer of
cells has a quadratic term that the points hardly see, and combinations that they see less than `SEEN` are left out.
Where a value would still be a difference of large ones (weights of the points with a sum above `STEEP`, at corners of
bodies with few tetrahedra), the linear fit is taken.
"""

from __future__ import annotations

import itertools
from collections.abc import Mapping
from functools import cache

import numpy as np
import scipy.sparse as sp

from warpffrf.model.mesh.elements import cell_kind
from warpffrf.model.mesh.facets import outer_faces
from warpffrf.offline.fe.assembly import Sparse
from warpffrf.offline.fe.reference import gradients_at
from warpffrf.offline.stress.recovery_points import recovery_points

Array = np.ndarray
CORNER_KIND = {8: "hex8", 6: "wedge6", 4: "tet4"}  # the cell with as many nodes as a cell has corners
MORE = 1.5  # cells, against the vertex's own, of a neighbour whose polynomial is taken instead
RINGS = 4  # of cells around those wanted, in which vertices are counted: two of donors, one of their cells, one spare
SEEN = {2: 0.05, 3: 0.01}  # singular value, of the largest, that the points tell; by degree
STEEP = 15.0  # sum of the sizes of the weights; of hexahedra it is below 12, at the edge of a patch
_TERMS = [t for degree in (2, 3) for t in itertools.combinations_with_replacement(range(3), degree)]  # factors x, y, z
_QUADRATIC = 6  # of them are of degree two


def patch_gradients(points: Array, cells: Mapping[str, Array], wanted: Array) -> list[Sparse]:
    """Derivatives along x, y, z of a nodal field at the nodes `wanted` (K,): three csr (K, n) [1/m].

    points (n, 3) [m]; cells {kind: (m, k)}, quadratic and of one material, every wanted node on one of them.
    """
    near = _around(cells, wanted, len(points))
    pairs = (_shares(near, wanted, len(points)) @ _donors(near, len(points))).tocoo()
    vertices, column = np.unique(pairs.col, return_inverse=True)
    places, slopes = _recovered(points, near)
    touching = _incidence(near, len(points)).T.tocsr()[vertices]  # vertices by cells
    sizes = [len(block) for block in near.values()]
    per_cell = np.repeat([len(recovery_points(kind)[0]) for kind in near], sizes)
    numbers = np.split(np.arange(len(places)), np.cumsum(per_cell)[:-1])  # of the points of each cell
    rows, columns, values = [], [], []
    samples = [
        np.concatenate([numbers[c] for c in touching.indices[begin:end]])
        for begin, end in itertools.pairwise(touching.indptr)
    ]
    counts = np.array([len(found) for found in samples])
    degree = np.where(touching @ np.repeat([cell_kind(k).corner_count != 8 for k in near], sizes) > 0.0, 2, 3)
    for size, power in np.unique(np.stack([counts, degree]), axis=1).T:
        group = np.flatnonzero((counts == size) & (degree == power))
        seen = np.stack([samples[v] for v in group])  # (g, q)
        fit = _Fit(places[seen], int(power))
        at = np.flatnonzero((counts == size)[column] & (degree == power)[column])
        which = np.searchsorted(group, column[at])
        weights = fit.weights(which, points[wanted[pairs.row[at]]]) * pairs.data[at, None]
        rows.append(np.repeat(pairs.row[at], size))
        columns.append(seen[which].ravel())
        values.append(weights.ravel())
    shape = (len(wanted), len(places))
    mean = sp.csr_matrix((np.concatenate(values), (np.concatenate(rows), np.concatenate(columns))), shape=shape)
    return [sp.csr_matrix(mean @ slope) for slope in slopes]


class _Fit:
    """Least squares by polynomials of a `degree` in patches with points x (g, q, 3)."""

    def __init__(self, x: Array, degree: int) -> None:
        self.terms = _TERMS if degree == 3 else _TERMS[:_QUADRATIC]
        self.middle = x.mean(axis=1, keepdims=True)
        spread = np.einsum("gqi,gqj->gij", x - self.middle, x - self.middle) / x.shape[1]
        length, axes = np.linalg.eigh(spread)
        self.axes = axes / np.sqrt(length)[:, None, :]
        linear, curved = self._terms(x - self.middle)
        self.line = np.linalg.solve(linear.swapaxes(1, 2) @ linear, linear.swapaxes(1, 2))  # (g, 4, q)
        self.known = self.line @ curved  # (g, 4, t)
        A = np.concatenate([linear, curved - linear @ self.known], axis=2)
        square, modes = np.linalg.eigh(A.swapaxes(1, 2) @ A)
        seen = square > SEEN[degree] ** 2 * square[:, -1:]
        inverse = np.where(seen, 1.0 / np.where(seen, square, 1.0), 0.0)
        self.through = (modes * inverse[:, None, :]) @ modes.swapaxes(1, 2) @ A.swapaxes(1, 2)  # (g, 4 + t, q)

    def weights(self, which: Array, x: Array) -> Array:
        """Values at the points of the patches `which` (p,) to that of the polynomial at x (p, 3): (p, q)."""
        linear, curved = self._terms(x[:, None] - self.middle[which], which)
        m = np.concatenate([linear, curved - linear @ self.known[which]], axis=2)
        found = (m @ self.through[which])[:, 0]
        steep = np.abs(found).sum(axis=1) > STEEP
        found[steep] = (linear[steep] @ self.line[which[steep]])[:, 0]
        return found

    def _terms(self, x: Array, which: Array | slice = slice(None)) -> tuple[Array, Array]:
        y = x @ self.axes[which]
        curved = np.stack([np.prod(y[..., list(t)], axis=-1) for t in self.terms], axis=-1)
        return np.concatenate([np.ones((*y.shape[:2], 1)), y], axis=2), curved


@cache
def _parents(kind: str) -> Array:
    """(k, corners): share of each corner in the place of each node of `kind`."""
    cell = cell_kind(kind)
    shares = cell_kind(CORNER_KIND[cell.corner_count]).shape(cell.nodes)[0]
    return np.where(np.abs(shares) > 1e-9, shares, 0.0)


def _corners(cells: Mapping[str, Array]) -> list[Array]:
    return [block[:, : cell_kind(kind).corner_count] for kind, block in cells.items()]


def _incidence(cells: Mapping[str, Array], n: int) -> Sparse:
    """csr (cells, n): 1 at the corners of each cell, blocks one after the other."""
    columns = np.concatenate([block.ravel() for block in _corners(cells)])
    width = np.concatenate([np.full(len(block), block.shape[1]) for block in _corners(cells)])
    return sp.csr_matrix((np.ones(len(columns)), columns, np.concatenate([[0], np.cumsum(width)])), (len(width), n))


def _around(cells: Mapping[str, Array], wanted: Array, n: int) -> dict[str, Array]:
    """The cells within `RINGS` rings of those that hold a wanted node."""
    marked = np.zeros(n, dtype=bool)
    marked[wanted] = True
    taken: dict[str, Array] = {}
    for _ in range(RINGS + 1):
        taken = {kind: np.any(marked[block], axis=1) for kind, block in cells.items()}
        for kind, block in cells.items():
            marked[block[taken[kind]]] = True
    return {kind: block[taken[kind]] for kind, block in cells.items() if taken[kind].any()}


def _shares(cells: Mapping[str, Array], wanted: Array, n: int) -> Sparse:
    """csr (K, n): the vertices around each wanted node, rows with the sum one."""
    rows, columns, values = [], [], []
    missing = np.ones(len(wanted), dtype=bool)
    place = np.full(n, -1)
    place[wanted] = np.arange(len(wanted))
    for kind, block in cells.items():
        parents, corners = _parents(kind), block[:, : cell_kind(kind).corner_count]
        cell, a = np.nonzero(place[block] >= 0)
        slot, once = np.unique(place[block[cell, a]], return_index=True)
        new = missing[slot]
        slot, once = slot[new], once[new]
        missing[slot] = False
        rows.append(np.repeat(slot, corners.shape[1]))
        columns.append(corners[cell[once]].ravel())
        values.append(parents[a[once]].ravel())
    entries = (np.concatenate(values), (np.concatenate(rows), np.concatenate(columns)))
    found = sp.csr_matrix(entries, shape=(len(wanted), n))
    found.eliminate_zeros()
    return found


def _donors(cells: Mapping[str, Array], n: int) -> Sparse:
    """csr (n, n): whose polynomials stand for that of each vertex, rows with the sum one."""
    count = np.asarray(_incidence(cells, n).sum(axis=0)).ravel()
    edges = [_edges(kind, block) for kind, block in cells.items()]
    a, b = np.unique(np.sort(np.concatenate(edges), axis=1), axis=0).T
    a, b = np.concatenate([a, b]), np.concatenate([b, a])
    boundary = np.zeros(n, dtype=bool)
    boundary[outer_faces(dict(cells)).node_set] = True
    gives = boundary[a] & (count[b] >= MORE * count[a])
    taken = sp.csr_matrix((np.ones(gives.sum()), (a[gives], b[gives])), shape=(n, n))
    number = np.asarray(taken.sum(axis=1)).ravel()
    step = sp.diags(1.0 / np.maximum(number, 1.0)) @ taken + sp.diags((number == 0.0).astype(float))
    return sp.csr_matrix(step @ step @ step)  # from a corner of the body over an edge and a face to its inside


def _edges(kind: str, block: Array) -> Array:
    """(e, 2): vertices at the ends of the edges of cells."""
    parents = _parents(kind)
    ends = np.array([np.flatnonzero(row) for row in parents if np.count_nonzero(row) == 2])
    return block[:, ends].reshape(-1, 2)


def _recovered(points: Array, cells: Mapping[str, Array]) -> tuple[Array, list[Sparse]]:
    """Places (Q, 3) of the recovery points of all cells, and the derivatives there, three csr (Q, n)."""
    places, data, columns, widths = [], [], [], []
    for kind, block in cells.items():
        N, dN = recovery_points(kind)
        x = points[block]
        slopes, _ = gradients_at(x, dN)
        places.append(np.einsum("qa,eai->eqi", N, x).reshape(-1, 3))
        data.append(slopes.reshape(-1, 3))
        columns.append(np.repeat(block, len(N), axis=0).ravel())
        widths.append(np.full(len(block) * len(N), block.shape[1]))
    indptr = np.concatenate([[0], np.cumsum(np.concatenate(widths))])
    column, value = np.concatenate(columns), np.concatenate(data)
    shape = (len(indptr) - 1, len(points))
    return np.concatenate(places), [sp.csr_matrix((value[:, i], column, indptr), shape=shape) for i in range(3)]
