r"""Facing parts of two triangulated surfaces: the triangles of the first, cut by those of the second.

Triangle b of the second surface is projected onto triangle a of the first along a's normal n: where their normals are
opposed, `n.n_b < -cos 60 deg`, and b is neither behind a, by more than the overlap of meshes of round faces and
press fits, nor far away, the projection of b onto the plane of a cuts a convex polygon out of it (`clipping`). The
polygons of all b fill the part of a that is covered; cut into triangles they are the *pieces*, each with one triangle
on either side.

Clipping. Convex polygons in the plane cut by one another (Sutherland and Hodgman 1974, Commun. ACM 17, 32), many at a
time.

Pairing. Opposite cells of two faces at the initial pose, and the transfer of a cell's forces to the other face.

Triangles of the first face are cut by those of the second, projected along the normals of the first (`facing`). A cell
of the first face that is covered is a cell of the matched face; its force acts on the cells of the second face in
proportion to the shared areas, and its opposite displacement is the mean of theirs with the same weights, so that the
two are conjugate. Cells of the second face have a mean displacement each and no slope, so that weights by shared area
alone would misplace the force where cells do not nest, and two cells on one cell of the second face would have the same
displacement, which locks them. So the weights w are corrected by the smallest change that makes them exact for
displacements that are linear along the face,

    sum w = 1,        sum w x = x of the cell,

over the cells x of the second face that it shares area with and the `NEAR` nearest ones; weights may be negative. At
the outline of the overlap cells of the first face are taken whole: the force acts on all of the cell, and on the cells
of the second face that it covers. The gap of a cell is the mean distance along its normal.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property

import numpy as np
import scipy.sparse as sp
from scipy.spatial import KDTree

from warpffrf.model.errors import InputError

Array = np.ndarray
FACING = -0.5  # cosine between normals of triangles that face each other, at most
# Of the extent of the smaller face: how far the opposite face may lie inside, as with press fits, in addition to what
# the flat facets of round faces cut off. Sheets are thicker, whose other side must not be taken for it.
BEHIND = 1e-3
FAR = 0.5  # of the extent of the smaller face: further apart they do not face each other
ROUND_OFF = 1e-10  # of a triangle's area: remainders of cuts along shared edges
TOGETHER = 1e-9  # of the extent: corners closer than this are one
CENTERS = 1000  # triangles per neighbour search
PAIRS = 200_000  # triangle pairs tested at once: some 100 MB


@dataclass(frozen=True, eq=False)
class Triangles:
    """A surface: corners `x` (t, 3, 3) [m] of its triangles, outwards, and numbers `nodes` (t, 3), equal where corners
    of neighbours coincide."""

    x: Array
    nodes: Array

    @classmethod
    def of(cls, x: Array) -> Triangles:
        """Triangles without numbers of coincident corners."""
        corners = x.reshape(-1, 3)
        size = max(float(np.ptp(corners, axis=0).max()), 1e-300)
        number = np.unique(np.round(corners / (TOGETHER * size)), axis=0, return_inverse=True)[1]
        return cls(x, number.reshape(-1, 3))

    @cached_property
    def _area_vector(self) -> Array:
        return 0.5 * np.cross(self.x[:, 1] - self.x[:, 0], self.x[:, 2] - self.x[:, 0])

    @cached_property
    def area(self) -> Array:
        """Areas (t,) [m2]."""
        return np.linalg.norm(self._area_vector, axis=1)

    @cached_property
    def normal(self) -> Array:
        """Outward unit normals (t, 3)."""
        return self._area_vector / np.where(self.area > 0.0, self.area, 1.0)[:, None]

    @cached_property
    def center(self) -> Array:
        """Centroids (t, 3) [m]."""
        return self.x.mean(axis=1)

    @cached_property
    def reach(self) -> Array:
        """Largest distance (t,) of a corner from the centroid [m]."""
        return np.linalg.norm(self.x - self.center[:, None], axis=2).max(axis=1)

    @cached_property
    def extent(self) -> float:
        """Diagonal of the box around the surface [m]."""
        return float(np.linalg.norm(np.ptp(self.x.reshape(-1, 3), axis=0)))

    @cached_property
    def bulge(self) -> Array:
        """Largest distance (t,) [m] of a triangle from the surface that it represents: its reach times the angle
        between its normal and the mean normals at its corners."""
        total = np.zeros((int(self.nodes.max()) + 1, 3))
        np.add.at(total, self.nodes.ravel(), np.repeat(self.normal, 3, axis=0))
        mean = total[self.nodes]
        mean /= np.maximum(np.linalg.norm(mean, axis=2, keepdims=True), 1e-300)
        aside = np.linalg.norm(np.cross(mean, self.normal[:, None]), axis=2)
        return self.reach * aside.max(axis=1)

    @cached_property
    def plane(self) -> Array:
        """Two axes (t, 2, 3) of each triangle's plane, which make a right-handed frame with its normal."""
        first = self.x[:, 1] - self.x[:, 0]
        first = first / np.linalg.norm(first, axis=1, keepdims=True)
        return np.stack([first, np.cross(self.normal, first)], axis=1)


@dataclass(frozen=True, eq=False)
class Facing:
    """The pieces of two surfaces: triangles `source` (p,) of the first and `across` (p,) of the second, corners as
    weights (p, 3, 3) of the corners of `source`, `area` (p,) [m2] on the first, `gap` (p,) [m] along its normals in the
    middle of each, and the shares `covered` of both surfaces' areas."""

    source: Array
    across: Array
    weights: Array
    area: Array
    gap: Array
    covered: tuple[float, float]


def facing(first: Triangles, second: Triangles) -> Facing:
    """The pieces of two surfaces; none where they do not face each other."""
    none = np.zeros(0, dtype=np.int64)
    parts = [(none, none, np.zeros((0, 3, 3)), np.zeros(0))]
    one, other = _candidates(first, second)
    for start in range(0, len(one), PAIRS):
        i, j = one[start : start + PAIRS], other[start : start + PAIRS]
        axes, origin = first.plane[i], first.x[i, 0]
        flat = np.einsum("pdi,pci->pcd", axes, first.x[i] - origin[:, None])
        shadow = np.einsum("pdi,pci->pcd", axes, second.x[j] - origin[:, None])[:, ::-1]  # seen from the other side
        polygons, count = clipped(flat, np.full(len(i), 3), shadow)
        kept = (count >= 3) & (areas(polygons, count) > ROUND_OFF * first.area[i])
        triangles, number = fans(polygons[kept], count[kept])
        i, j, flat = i[kept][number], j[kept][number], flat[kept][number]
        parts.append((i, j, barycentric(flat, triangles), areas(triangles, np.full(len(i), 3))))
    source, across, weights, area = (np.concatenate(part) for part in zip(*parts, strict=True))
    normal, opposite = first.normal[source], second.normal[across]
    cosine = np.einsum("pi,pi->p", normal, opposite)
    x = np.einsum("pcv,pvi->pi", weights, first.x[source]) / 3.0
    gap = np.einsum("pi,pi->p", opposite, second.center[across] - x) / cosine
    covered = area.sum() / first.area.sum(), np.sum(area / np.abs(cosine)) / second.area.sum()
    return Facing(source, across, weights, area, gap, (float(covered[0]), float(covered[1])))


def why_apart(first: Triangles, second: Triangles, covered: tuple[float, float]) -> str:
    """Message on surfaces that do not face each other: the covered parts, the distance, and the reason."""
    apart = float(KDTree(second.x.reshape(-1, 3)).query(first.x.reshape(-1, 3))[0].min())
    means = []
    for surface in (first, second):
        total = np.sum(surface.normal * surface.area[:, None], axis=0)
        means.append(total / max(float(np.linalg.norm(total)), 1e-300))
    angle = float(np.degrees(np.arccos(np.clip(-means[0] @ means[1], -1.0, 1.0))))
    if angle > 180.0 - 60.0:
        why = "their outward normals look the same way"
    elif angle > 60.0:
        why = f"their outward normals are {angle:.0f} degrees from being opposite"
    else:
        why = "they lie side by side, far apart, or back to back with material between"
    return (
        f"{covered[0]:.2g} and {covered[1]:.2g} of their areas overlap, their nearest corners are {apart:.3g} m apart, "
        f"{why}"
    )


def barycentric(corners: Array, points: Array) -> Array:
    """Barycentric coordinates (p, k, 3) of `points` (p, k, 2) in triangles (p, 3, 2)."""
    first, second = corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0]
    det = first[:, 0] * second[:, 1] - first[:, 1] * second[:, 0]
    v = points - corners[:, :1]
    s = (v[:, :, 0] * second[:, None, 1] - v[:, :, 1] * second[:, None, 0]) / det[:, None]
    t = (v[:, :, 1] * first[:, None, 0] - v[:, :, 0] * first[:, None, 1]) / det[:, None]
    return np.stack([1.0 - s - t, s, t], axis=2)


def _candidates(first: Triangles, second: Triangles) -> tuple[Array, Array]:
    """Triangles of the first surface and of the second that may face each other."""
    tree = KDTree(second.center)
    widest = float(second.reach.max())
    smaller = min(first.extent, second.extent)
    near = np.minimum(tree.query(first.center)[0], FAR * smaller)
    # the opposite point is no further than the gap along n, which is at most twice the distance between the faces
    radius = first.reach + widest + (near + widest) / abs(FACING)
    one, other = [np.zeros(0, np.int64)], [np.zeros(0, np.int64)]
    for start in range(0, len(first.center), CENTERS):
        part = slice(start, start + CENTERS)
        found = tree.query_ball_point(first.center[part], radius[part])
        i = np.repeat(np.arange(start, start + len(found)), [len(f) for f in found])
        j = np.concatenate([np.asarray(f, dtype=np.int64) for f in found])
        cosine = np.einsum("pi,pi->p", first.normal[i], second.normal[j])
        between = second.center[j] - first.center[i]
        gap = np.einsum("pi,pi->p", second.normal[j], between) / np.minimum(cosine, FACING)
        aside = between - np.einsum("pi,pi->p", first.normal[i], between)[:, None] * first.normal[i]
        seen = (cosine < FACING) & (gap > -BEHIND * smaller - first.bulge[i] - second.bulge[j]) & (gap < FAR * smaller)
        seen &= np.linalg.norm(aside, axis=1) < first.reach[i] + second.reach[j]
        one.append(i[seen])
        other.append(j[seen])
    return np.concatenate(one), np.concatenate(other)


def clipped(polygons: Array, count: Array, windows: Array) -> tuple[Array, Array]:
    """The parts of convex polygons that lie inside convex windows, one window per polygon.

    `polygons` (p, k, 2), of which the first `count` (p,) corners count, and `windows` (p, l, 2), all corners, run
    counter-clockwise. Returns polygons (p, k', 2) and their count, 0 where none remains.
    """
    for edge in range(windows.shape[1]):
        a, b = windows[:, edge], windows[:, (edge + 1) % windows.shape[1]]
        polygons, count = _half(polygons, count, a, b)
    return polygons, count


def areas(polygons: Array, count: Array) -> Array:
    """Areas (p,) of polygons, counter-clockwise positive."""
    k = polygons.shape[1]
    there = np.arange(k) < count[:, None]
    x = np.where(there[:, :, None], polygons - polygons[:, :1], 0.0)
    following = np.take_along_axis(x, _next(k, count)[:, :, None], axis=1)
    twice = x[:, :, 0] * following[:, :, 1] - x[:, :, 1] * following[:, :, 0]
    return 0.5 * np.sum(np.where(there, twice, 0.0), axis=1)


def fans(polygons: Array, count: Array) -> tuple[Array, Array]:
    """Triangles (t, 3, d) that fill convex polygons (p, k, d), and the polygon (t,) of each."""
    k = polygons.shape[1]
    number, i = np.nonzero((np.arange(1, k - 1) + 1)[None, :] < count[:, None])
    i += 1
    return np.stack([polygons[number, 0], polygons[number, i], polygons[number, i + 1]], axis=1), number


def _half(polygons: Array, count: Array, a: Array, b: Array) -> tuple[Array, Array]:
    """The part to the left of the line from a to b (p, 2)."""
    p, k = polygons.shape[:2]
    there = np.arange(k) < count[:, None]
    along = b - a
    x = polygons - a[:, None]
    side = along[:, None, 0] * x[:, :, 1] - along[:, None, 1] * x[:, :, 0]  # positive to the left
    following = _next(k, count)
    next_side = np.take_along_axis(side, following, axis=1)
    next_corner = np.take_along_axis(polygons, following[:, :, None], axis=1)
    inside = there & (side >= 0.0)
    crosses = there & ((side >= 0.0) != (next_side >= 0.0))
    share = np.where(crosses, side / np.where(crosses, side - next_side, 1.0), 0.0)
    crossing = polygons + share[:, :, None] * (next_corner - polygons)
    # each corner, then the crossing after it, where they are kept
    kept = np.stack([inside, crosses], axis=2).reshape(p, 2 * k)
    corners = np.stack([polygons, crossing], axis=2).reshape(p, 2 * k, 2)
    found = kept.sum(axis=1)
    # one more than before, but where an edge on the line goes to and fro across it by round-off
    order = np.argsort(~kept, axis=1, kind="stable")[:, : max(k + 1, int(found.max(initial=0)))]
    return np.take_along_axis(corners, order[:, :, None], axis=1), found


def _next(k: int, count: Array) -> Array:
    """Index (p, k) of the corner after each, that after the last being the first."""
    following = np.arange(1, k + 1)[None, :]
    return np.where(following < count[:, None], following, 0)


LEAST = 1e-2  # of a cell's area: a smaller covered share counts as none
NEAR = 5  # a cell and its neighbours on a grid
AT_PLACE = 1e-6  # of a cell's edge: admissible offset of its force
SHORT = 1e-6  # of the distances of the cells considered: directions in which they do not differ


@dataclass(frozen=True, eq=False)
class Pairing:
    """Cells of the matched face, c of them: `cell` (c,) on the first face, `covered` (c,) the covered share of its
    area, `gap` (c,) [m], `weights` (c, cells of the second face) csr, rows that add up to 1; `shares` of both faces'
    areas that face each other."""

    cell: Array
    covered: Array
    gap: Array
    weights: sp.csr_matrix
    shares: tuple[float, float]


def pair_faces(label: str, first: Array, cell: Array, normals: Array, second: Array, other: Array) -> Pairing:
    """The pairing of two faces in common axes.

    first (t, 3, 3), second (u, 3, 3): corners of their triangles [m], outwards; cell (t,), other (u,): their
    cells; normals (cells of the first face, 3). Raises `InputError`, naming `label`, where they do not face each
    other.
    """
    a, b = Triangles.of(first), Triangles.of(second)
    pieces = facing(a, b)
    cells, of = int(cell.max()) + 1, cell[pieces.source]
    area = np.bincount(of, weights=pieces.area, minlength=cells)
    covered = area / np.bincount(cell, weights=a.area, minlength=cells)
    face = np.flatnonzero(covered > LEAST)
    if not len(face):
        raise InputError(
            f"{label}: the faces do not face each other: {why_apart(a, b, pieces.covered)}; place the bodies so that "
            "the two faces look at each other across a small gap"
        )
    gap = np.bincount(of, weights=pieces.area * pieces.gap, minlength=cells)[face] / area[face]
    shape = cells, int(other.max()) + 1
    shared = sp.csr_matrix((pieces.area, (of, other[pieces.across])), shape=shape)[face]
    weights = sp.csr_matrix(sp.diags(1.0 / area[face]) @ shared)
    weights = _at_their_places(weights, _centers(a, cell)[face], np.sqrt(area[face]), normals[face], _centers(b, other))
    shares = min(pieces.covered[0], 1.0), min(pieces.covered[1], 1.0)
    return Pairing(face, np.minimum(covered[face], 1.0), gap, weights, shares)


def _centers(triangles: Triangles, cell: Array) -> Array:
    """Centroids (cells, 3) [m]."""
    area = np.bincount(cell, weights=triangles.area)
    middle = triangles.x.mean(axis=1) * triangles.area[:, None]
    return np.stack([np.bincount(cell, weights=middle[:, d]) for d in range(3)], axis=1) / area[:, None]


def _at_their_places(weights: sp.csr_matrix, x: Array, edge: Array, normals: Array, others: Array) -> sp.csr_matrix:
    """The weights (c, cells of the second face) corrected as in the module docstring; x (c, 3), edge (c,), normals
    (c, 3) of the cells, others (cells of the second face, 3): positions."""
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
