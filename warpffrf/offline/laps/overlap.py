r"""Where two faces of a body face each other: the triangles of the first, cut by those of the second.

Triangle b of the second face is seen from triangle a of the first along a's normal n: where their normals look against
each other, `n.n_b < -cos 60 deg`, and b is neither behind a, by more than what meshes of round faces and press fits
overlap, nor further away than the first face is long, the shadow of b on the plane of a cuts a convex polygon out of it
(`clipping`). The polygons of all b fill the part of a that is covered; cut along their own corners they are the pieces,
each with one facet on either side. At a place x of a piece the place across, y, is the one with the same shadow,

    t.(y(eta) - x(xi)) = 0    for both axes t of the plane of a,

found by Newton's method from the place in the flat triangle b; `n.(y - x)` is the gap there.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from scipy.spatial import KDTree

from warpffrf.model.errors import InputError
from warpffrf.model.laps.clipping import areas, clipped, fans
from warpffrf.offline.laps.faces import Face

Array = np.ndarray
FACING = -0.5  # cosine between normals of triangles that face each other, at most
# Of the extent of the smaller face: how far the face across may lie inside, as with press fits, beside what the flat
# facets of round faces cut off. Sheets are thicker, whose other side must not be taken for it.
BEHIND = 1e-3
ROUND_OFF = 1e-10  # of a triangle's area: what cuts along shared edges leave
LEAST_SHARE = 1e-3  # of the smaller face: an overlap below it is an accident of the edges
# Of a facet's area: what may be covered twice. In a hollow face, shadows of neighbours overlap by the gap times the
# angle between facets, a gap's part of the radius; a face in several layers covers its facets twice and more.
FOLDED = 0.5
PAIRS = 200_000  # triangles tried against triangles together: some 100 MB
STEPS = 20  # of Newton's method, which takes three or four
PRECISE = 1e-13  # of the triangle's length: where it ends


@dataclass(frozen=True, eq=False)
class Pieces:
    """Triangles of a face, `facet` (p,), corners `xi` (p, 3, 2) in its reference domain. Of an overlap also `across`
    (p,), the triangle of the second face, and `source` (p,) that of the first; else both are empty."""

    facet: Array
    xi: Array
    source: Array
    across: Array


@dataclass(frozen=True, eq=False)
class Overlap:
    """What of two faces is opposite each other: the pieces, the shares of both areas, and of each facet of the first
    the share of its area `of_facet` (facets,)."""

    pieces: Pieces
    covered: tuple[float, float]
    of_facet: Array


def whole(face: Face) -> Pieces:
    """All triangles of a face."""
    none = np.zeros(0, dtype=np.int64)
    return Pieces(face.triangles.facet, face.triangles.xi, none, none)


def overlap(name: str, first: Face, second: Face) -> Overlap:
    """The overlap of two faces. Raises `InputError` naming lap `name` where they do not face each other, and where the
    second lies behind itself."""
    a, b = first.triangles, second.triangles
    one, other = _candidates(first, second)
    parts = []
    for start in range(0, len(one), PAIRS):
        i, j = one[start : start + PAIRS], other[start : start + PAIRS]
        axes, origin = a.plane[i], a.x[i, 0]
        flat = np.einsum("pdi,pci->pcd", axes, a.x[i] - origin[:, None])
        shadow = np.einsum("pdi,pci->pcd", axes, b.x[j] - origin[:, None])[:, ::-1]  # seen from the other side
        polygons, count = clipped(flat, np.full(len(i), 3), shadow)
        kept = (count >= 3) & (areas(polygons, count) > ROUND_OFF * a.area[i])
        triangles, number = fans(polygons[kept], count[kept])
        i, j, flat = i[kept][number], j[kept][number], flat[kept][number]
        parts.append((i, j, _barycentric(flat, triangles), areas(triangles, np.full(len(i), 3))))
    source, across, weights, area = (np.concatenate(part) for part in zip(*parts, strict=True)) if parts else _nothing()
    facet = a.facet[source]
    own = np.bincount(a.facet, weights=a.area, minlength=len(first))
    of_facet = np.bincount(facet, weights=area, minlength=len(first)) / own
    seen = area / np.abs(np.einsum("pi,pi->p", a.normal[source], b.normal[across]))  # on the second face
    covered = (float(area.sum() / own.sum()), float(seen.sum() / b.area.sum()))
    if max(covered) < LEAST_SHARE:
        raise InputError(_apart(name, first, second, covered))
    if np.any(of_facet > 1.0 + FOLDED):
        raise InputError(
            f"lap {name!r}: {int(np.sum(of_facet > 1.0 + FOLDED))} facets of {first.name!r} see facets of "
            f"{second.name!r} behind one another; keep only those of {second.name!r} that touch {first.name!r}"
        )
    pieces = Pieces(facet, np.einsum("pcv,pvd->pcd", weights, a.xi[source]), source, across)
    return Overlap(pieces, (min(covered[0], 1.0), min(covered[1], 1.0)), np.minimum(of_facet, 1.0))


def places_across(second: Face, triangle: Array, x: Array, axes: Array) -> tuple[Array, Array]:
    """Facets (q,) of the second face and places (q, 2) in their reference domains whose shadow along the plane `axes`
    (q, 2, 3) is that of `x` (q, 3) [m]; `triangle` (q,) is where to begin."""
    b = second.triangles
    corners = np.einsum("qdi,qci->qcd", axes, b.x[triangle])
    share = _barycentric(corners, np.einsum("qdi,qi->qd", axes, x)[:, None])
    eta = np.einsum("qcv,qvd->qd", share, b.xi[triangle])
    facet, least = b.facet[triangle], PRECISE * b.reach[triangle]
    best, smallest = eta, np.full(len(x), np.inf)
    for _ in range(STEPS):
        N, tangents = second.at(facet, eta)
        off = np.einsum("qdi,qi->qd", axes, x - N @ second.points)
        error = np.linalg.norm(off, axis=1)
        best = np.where((error < smallest)[:, None], eta, best)
        smallest = np.minimum(error, smallest)
        if np.all(smallest <= least):
            break
        J = np.einsum("qdi,qei->qde", axes, tangents)
        usable = np.abs(np.linalg.det(J)) > 0.0
        J[~usable] = np.eye(2)
        eta = eta + np.where(usable[:, None], np.linalg.solve(J, off[:, :, None])[:, :, 0], 0.0)
    return facet, best


def _candidates(first: Face, second: Face) -> tuple[Array, Array]:
    """Triangles of the first face and of the second that may face each other."""
    a, b = first.triangles, second.triangles
    tree = KDTree(b.center)
    widest = float(b.reach.max())
    near = tree.query(a.center)[0]
    # the place across is no further than the gap along n, which is at most twice the distance between the faces
    radius = a.reach + widest + (near + widest) / abs(FACING)
    inside = BEHIND * min(first.extent, second.extent)
    one, other = [np.zeros(0, np.int64)], [np.zeros(0, np.int64)]
    for start in range(0, len(a.center), 1000):
        found = tree.query_ball_point(a.center[start : start + 1000], radius[start : start + 1000])
        i = np.repeat(np.arange(start, start + len(found)), [len(f) for f in found])
        j = np.concatenate([np.asarray(f, dtype=np.int64) for f in found])
        cosine = np.einsum("pi,pi->p", a.normal[i], b.normal[j])
        between = b.center[j] - a.center[i]
        gap = np.einsum("pi,pi->p", b.normal[j], between) / np.minimum(cosine, FACING)
        aside = between - np.einsum("pi,pi->p", a.normal[i], between)[:, None] * a.normal[i]
        seen = (cosine < FACING) & (gap > -inside - a.bulge[i] - b.bulge[j]) & (gap < first.extent)
        seen &= np.linalg.norm(aside, axis=1) < a.reach[i] + b.reach[j]
        one.append(i[seen])
        other.append(j[seen])
    return np.concatenate(one), np.concatenate(other)


def _barycentric(corners: Array, points: Array) -> Array:
    """Barycentric coordinates (p, k, 3) of `points` (p, k, 2) in triangles (p, 3, 2)."""
    first, second = corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0]
    det = first[:, 0] * second[:, 1] - first[:, 1] * second[:, 0]
    v = points - corners[:, :1]
    s = (v[:, :, 0] * second[:, None, 1] - v[:, :, 1] * second[:, None, 0]) / det[:, None]
    t = (v[:, :, 1] * first[:, None, 0] - v[:, :, 0] * first[:, None, 1]) / det[:, None]
    return np.stack([1.0 - s - t, s, t], axis=2)


def _nothing() -> tuple[Array, Array, Array, Array]:
    none = np.zeros(0, dtype=np.int64)
    return none, none, np.zeros((0, 3, 3)), np.zeros(0)


def _apart(name: str, first: Face, second: Face, covered: tuple[float, float]) -> str:
    """What to say of faces that do not face each other."""
    nodes = [face.points[face.node_set] for face in (first, second)]
    apart = float(KDTree(nodes[1]).query(nodes[0])[0].min())
    means = []
    for face in (first, second):
        total = np.sum(face.triangles.normal * face.triangles.area[:, None], axis=0)
        means.append(total / max(float(np.linalg.norm(total)), 1e-300))
    angle = float(np.degrees(np.arccos(np.clip(-means[0] @ means[1], -1.0, 1.0))))
    if angle > 180.0 - 60.0:
        why = "their outward normals look the same way"
    elif angle > 60.0:
        why = f"their outward normals are {angle:.0f} degrees from being opposite"
    else:
        why = "they lie beside each other, or back to back with material between"
    return (
        f"lap {name!r}: facet sets {first.name!r} and {second.name!r} do not face each other: {covered[0]:.2g} and "
        f"{covered[1]:.2g} of their areas overlap, their nearest nodes are {apart:.3g} m apart, {why}; choose two sets "
        "whose outward normals look at each other across a gap"
    )
