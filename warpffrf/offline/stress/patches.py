r"""Displacement gradients from patches of cells (Zienkiewicz and Zhu 1992).

O. C. Zienkiewicz and J. Z. Zhu, Int. J. Numer. Methods Eng. 33, 1331. Around each corner of the cells, a *vertex*, the
gradient is a polynomial, fitted to its samples in the cells around, which are more accurate by an order than the
gradient elsewhere. Anywhere in a cell the gradient is the mean of the polynomials of its vertices, weighted by the
linear shape functions N_v of the corners,

    g(x) = sum_v N_v(xi) m(x).a_v,     sum_q w_q |s_q(m).a_v - g_q|^2 -> min,     m = (1, x, y, z, x^2, xy, ..., z^3),

continuous, and smooth across nodes: the maximum below a contact need not lie at a node.

*Quadratic cells* are sampled at their recovery points, s_q(m) = m(x_q), w_q = 1, and a patch is the cells that share
the vertex. Hexahedra have four layers of points in it, which determine a cubic; stress under a contact decreases so
quickly that a quadratic polynomial is inaccurate if the contact is a few nodes wide. Points of tetrahedra and wedges
do not lie in such layers, and determine a quadratic polynomial.

*hex8* is sampled once, in its middle. The derivative of an interpolated displacement is there the mean of the true one
over the cell, so that s_q(m) is the mean of m over the cell: taken as the value in the middle, it would lose h^2/24 of
the curvature, 4 % of the stress with 2.5 cells per half-width. A patch is the cells that share a vertex with those at
the vertex, four layers again, and those near it have larger weights, w_q = exp(-|y|^2), y as below.

On the boundary a patch has fewer layers of cells: there the polynomials of neighbours along an edge are used whose
patches have at least 1.5 times as many cells, if there are any.

In the fit x is measured from the mean of the samples' positions in the axes and units y of their covariance, so that
the shape of the cells is irrelevant, and the higher terms are made orthogonal to the linear ones: in a direction with
one layer of cells the quadratic term is hardly observable from the samples (for hex8 the linear one is not), and
combinations with singular values below `SEEN` are omitted. If a value would still be a difference of large ones
(weights of the samples with a sum above `STEEP`, at corners of bodies with few tetrahedra), the linear fit is used.

Linear tetrahedra and wedges have no such samples.
"""

from __future__ import annotations

import itertools
from collections.abc import Mapping
from dataclasses import dataclass
from functools import cache, reduce

import numpy as np
import scipy.sparse as sp

from warpffrf.model.mesh.elements import cell_kind
from warpffrf.model.mesh.facets import outer_faces
from warpffrf.offline.fe import Sparse, gradients_at
from warpffrf.offline.stress.recovery_points import recovery_points

Array = np.ndarray
CORNER_KIND = {8: "hex8", 6: "wedge6", 4: "tet4"}  # the cell with as many nodes as a cell has corners
MORE = 1.5  # cells, relative to the vertex's own, of a neighbour whose polynomial is used instead
STEPS = {1: 3, 2: 1}  # to donors, by rings of a patch: 3 lead from a corner of the body over an edge and a face inside
SEEN = {2: 0.05, 3: 0.01}  # singular value, of the largest, that is resolved by the points; by degree
STEEP = 15.0  # sum of the sizes of the weights; of hexahedra it is below 12, at the edge of a patch
_TERMS = [t for degree in (2, 3) for t in itertools.combinations_with_replacement(range(3), degree)]  # factors x, y, z
_QUADRATIC = 6  # of them are of degree two


@dataclass(frozen=True)
class Places:
    """Points of gradients: x (K, 3) [m], and csr (K, n) the weights of the vertices whose polynomials define them,
    rows with the sum one."""

    x: Array
    shares: Sparse

    def __len__(self) -> int:
        return len(self.x)


def node_places(points: Array, cells: Mapping[str, Array], nodes: Array) -> Places:
    """The positions of `nodes` (K,), each on one of the cells."""
    return Places(points[nodes], _shares(cells, nodes, len(points)))


def cell_places(points: Array, kind: str, nodes: Array, xi: Array) -> Places:
    """Positions at the reference coordinates `xi` (K, 3) of cells of a `kind` with `nodes` (K, k)."""
    corners = nodes[:, : cell_kind(kind).corner_count]
    N = cell_kind(CORNER_KIND[corners.shape[1]]).shape(xi)[0]
    rows = np.repeat(np.arange(len(nodes)), corners.shape[1])
    shares = sp.csr_matrix((N.ravel(), (rows, corners.ravel())), shape=(len(nodes), len(points)))
    return Places(np.einsum("pk,pki->pi", cell_kind(kind).shape(xi)[0], points[nodes]), shares)


def has_patches(kind: str) -> bool:
    """Whether gradients of cells of this kind are computed from patches."""
    return kind == "hex8" or cell_kind(kind).degree > 1


def patch_groups(cells: Mapping[str, Array]) -> list[dict[str, Array]]:
    """The cells of one material with common patches, first those whose gradients are used where groups meet."""
    quadratic = {kind: block for kind, block in cells.items() if cell_kind(kind).degree > 1}
    linear = {kind: block for kind, block in cells.items() if has_patches(kind) and kind not in quadratic}
    return [group for group in (quadratic, linear) if group]


def patch_gradients(points: Array, cells: Mapping[str, Array], wanted: Places) -> list[Sparse]:
    """Derivatives along x, y, z of a nodal field at the points `wanted`: three csr (K, n) [1/m].

    points (n, 3) [m]; cells {kind: (m, k)}, one of the `patch_groups` of a material.
    """
    n, linear = len(points), "hex8" in cells
    rings = 2 if linear else 1
    near = _around(cells, wanted.shares.indices, n, rings)
    touching = _incidence(near, n).T.tocsr()  # vertices by cells of their patches
    for _ in range(rings - 1):
        touching = sp.csr_matrix((touching @ touching.T @ touching) > 0, dtype=float)
    pairs = (wanted.shares @ _donors(near, np.asarray(touching.sum(axis=1)).ravel(), STEPS[rings])).tocoo()
    vertices, column = np.unique(pairs.col, return_inverse=True)
    touching = touching[vertices]
    places, slopes, of_cell = _samples(points, near)
    rows, columns, values = [], [], []
    patches = [
        np.concatenate([of_cell[c] for c in touching.indices[begin:end]])
        for begin, end in itertools.pairwise(touching.indptr)
    ]
    counts = np.array([len(found) for found in patches])
    layered = np.concatenate([np.full(len(block), cell_kind(kind).corner_count == 8) for kind, block in near.items()])
    degree = np.where(touching @ (~layered).astype(float) > 0.0, 2, 3)
    for size, power in np.unique(np.stack([counts, degree]), axis=1).T:
        group = np.flatnonzero((counts == size) & (degree == power))
        seen = np.stack([patches[v] for v in group])  # (g, q)
        fit = _Fit(places[seen], int(power), fading=linear)
        at = np.flatnonzero((counts == size)[column] & (degree == power)[column])
        which = np.searchsorted(group, column[at])
        weights = fit.weights(which, wanted.x[pairs.row[at]]) * pairs.data[at, None]
        rows.append(np.repeat(pairs.row[at], size))
        columns.append(seen[which].ravel())
        values.append(weights.ravel())
    shape = (len(wanted), len(places))
    mean = sp.csr_matrix((np.concatenate(values), (np.concatenate(rows), np.concatenate(columns))), shape=shape)
    return [sp.csr_matrix(mean @ slope) for slope in slopes]


class _Fit:
    """Least squares by polynomials of a `degree` in patches with samples that are means over the points x (g, q, s, 3);
    `fading`: those far from the middle have smaller weights."""

    def __init__(self, x: Array, degree: int, fading: bool) -> None:
        self.terms = _TERMS if degree == 3 else _TERMS[:_QUADRATIC]
        self.middle = x.mean(axis=(1, 2), keepdims=True)
        spread = np.einsum("gqsi,gqsj->gij", x - self.middle, x - self.middle) / (x.shape[1] * x.shape[2])
        length, axes = np.linalg.eigh(spread)
        self.axes = axes / np.sqrt(length)[:, None, :]
        slopes, curved = (t.mean(axis=2) for t in self._terms(x))
        weight = np.exp(-0.5 * np.sum(slopes**2, axis=-1, keepdims=True)) if fading else np.ones((*x.shape[:2], 1))
        whole = np.sum(weight**2, axis=1, keepdims=True)
        self.shift = np.sum(weight**2 * slopes, axis=1, keepdims=True) / whole  # (g, 1, 3): linear terms have mean zero
        inclined = _seen_inverse(weight * (slopes - self.shift), SEEN[2])
        line = np.concatenate([(weight / whole).swapaxes(1, 2), inclined], axis=1)  # (g, 4, q)
        linear = weight * _with_one(slopes - self.shift)
        self.known = line @ (weight * curved)  # (g, 4, t)
        through = _seen_inverse(np.concatenate([linear, weight * curved - linear @ self.known], axis=2), SEEN[degree])
        self.line, self.through = line * weight.swapaxes(1, 2), through * weight.swapaxes(1, 2)

    def weights(self, which: Array, x: Array) -> Array:
        """Values of the samples of the patches `which` (p,) to that of the polynomial at x (p, 3): (p, q)."""
        slopes, curved = (t[:, 0] for t in self._terms(x[:, None, None], which))
        linear = _with_one(slopes - self.shift[which])
        m = np.concatenate([linear, curved - linear @ self.known[which]], axis=2)
        found = (m @ self.through[which])[:, 0]
        steep = np.abs(found).sum(axis=1) > STEEP
        found[steep] = (linear[steep] @ self.line[which[steep]])[:, 0]
        return found

    def _terms(self, x: Array, which: Array | slice = slice(None)) -> tuple[Array, Array]:
        """y (..., 3) of the patches `which`, and the products (..., t) of degree two and three."""
        y = (x - self.middle[which]) @ self.axes[which][:, None]
        return y, np.stack([reduce(np.multiply, (y[..., i] for i in t)) for t in self.terms], axis=-1)


def _with_one(slopes: Array) -> Array:
    return np.concatenate([np.ones((*slopes.shape[:-1], 1)), slopes], axis=-1)


def _seen_inverse(A: Array, seen: float) -> Array:
    """Least-squares inverses (g, t, q) of A (g, q, t), without singular values below `seen` of the largest."""
    square, modes = np.linalg.eigh(A.swapaxes(1, 2) @ A)
    told = square > seen**2 * square[:, -1:]
    inverse = np.where(told, 1.0 / np.where(told, square, 1.0), 0.0)
    return (modes * inverse[:, None, :]) @ modes.swapaxes(1, 2) @ A.swapaxes(1, 2)


@cache
def _parents(kind: str) -> Array:
    """(k, corners): weight of each corner in the position of each node of `kind`."""
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


def _around(cells: Mapping[str, Array], vertices: Array, n: int, rings: int) -> dict[str, Array]:
    """The cells that determine the polynomials of `vertices` and of their donors, with patches of this many `rings`."""
    marked = np.zeros(n, dtype=bool)
    marked[vertices] = True
    taken: dict[str, Array] = {}
    for _ in range(STEPS[rings] + 2 * rings):  # the cells of a donor's patch, and all cells of those of its neighbours
        taken = {kind: np.any(marked[block], axis=1) for kind, block in cells.items()}
        for kind, block in cells.items():
            marked[block[taken[kind]]] = True
    return {kind: block[taken[kind]] for kind, block in cells.items() if taken[kind].any()}


def _shares(cells: Mapping[str, Array], wanted: Array, n: int) -> Sparse:
    """csr (K, n): the vertices around each requested node, rows with the sum one."""
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


def _donors(cells: Mapping[str, Array], count: Array, steps: int) -> Sparse:
    """csr (n, n): vertices whose polynomials replace that of each vertex, up to `steps` edges away, rows with the sum
    one; `count` (n,) cells of the patches."""
    n = len(count)
    edges = [_edges(kind, block) for kind, block in cells.items()]
    a, b = np.unique(np.sort(np.concatenate(edges), axis=1), axis=0).T
    a, b = np.concatenate([a, b]), np.concatenate([b, a])
    boundary = np.zeros(n, dtype=bool)
    boundary[outer_faces(dict(cells)).node_set] = True
    gives = boundary[a] & (count[b] >= MORE * count[a])
    taken = sp.csr_matrix((np.ones(gives.sum()), (a[gives], b[gives])), shape=(n, n))
    number = np.asarray(taken.sum(axis=1)).ravel()
    step = sp.diags(1.0 / np.maximum(number, 1.0)) @ taken + sp.diags((number == 0.0).astype(float))
    donors = sp.identity(n, format="csr")
    for _ in range(steps):
        donors = donors @ step
    return sp.csr_matrix(donors)


def _edges(kind: str, block: Array) -> Array:
    """(e, 2): vertices at the ends of the edges of cells, which two of its faces share."""
    corners = cell_kind(kind).corner_count
    on = np.array([np.isin(np.arange(corners), face) for faces in cell_kind(kind).faces.values() for face in faces])
    shared = on.T.astype(int) @ on
    return block[:, np.argwhere(np.triu(shared == 2, 1))].reshape(-1, 2)


def _samples(points: Array, cells: Mapping[str, Array]) -> tuple[Array, list[Sparse], list[Array]]:
    """Points (Q, s, 3) over which the samples are means, the derivatives they are, three csr (Q, n), and the numbers of
    those of each cell."""
    places, data, columns, widths, counts = [], [], [], [], []
    for kind, block in cells.items():
        N, dN = recovery_points(kind)
        at = np.einsum("qa,eai->eqi", N, points[block])[:, :, None]
        if kind == "hex8":
            dN = cell_kind(kind).shape(np.zeros((1, 3)))[1]
            at = at.swapaxes(1, 2)  # one sample, over all points
        slopes, _ = gradients_at(points[block], dN)
        places.append(at.reshape(-1, *at.shape[2:]))
        data.append(slopes.reshape(-1, 3))
        columns.append(np.repeat(block, len(dN), axis=0).ravel())
        widths.append(np.full(len(block) * len(dN), block.shape[1]))
        counts.append(np.full(len(block), len(dN)))
    indptr = np.concatenate([[0], np.cumsum(np.concatenate(widths))])
    column, value = np.concatenate(columns), np.concatenate(data)
    shape = (len(indptr) - 1, len(points))
    slopes = [sp.csr_matrix((value[:, i], column, indptr), shape=shape) for i in range(3)]
    numbers = np.split(np.arange(shape[0]), np.cumsum(np.concatenate(counts))[:-1])
    return np.concatenate(places), slopes, numbers
