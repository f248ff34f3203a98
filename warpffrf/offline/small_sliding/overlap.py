r"""Overlap of two faces of a body: pieces of the first, and the opposite points on the second.

The triangles of the facets are cut by one another (`warpffrf.model.small_sliding.facing`): pieces with one facet on
either side. For a point x of a piece the opposite point y has the same projection on the plane of the piece,

    t.(y(eta) - x(xi)) = 0    for both axes t of the plane,

computed by Newton's method from the point in the flat triangle opposite; `n.(y - x)` is the gap there.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from warpffrf.model.errors import InputError
from warpffrf.model.small_sliding.facing import barycentric, facing, why_apart
from warpffrf.offline.small_sliding.faces import Face

Array = np.ndarray
LEAST_SHARE = 1e-3  # of the smaller face: a smaller overlap is an artefact of the edges
# Of a facet's area: admissible double coverage. In a hollow face, projections of neighbours overlap by the gap times
# the angle between facets, a fraction gap/radius; a face in several layers covers its facets twice and more.
FOLDED = 0.5
STEPS = 20  # of Newton's method, which takes three or four
PRECISE = 1e-13  # of the triangle's length: convergence tolerance


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
    """The opposite parts of two faces: the pieces, the shares of both areas, and for each facet of the first the share
    of its area `of_facet` (facets,)."""

    pieces: Pieces
    covered: tuple[float, float]
    of_facet: Array


def whole(face: Face) -> Pieces:
    """All triangles of a face."""
    none = np.zeros(0, dtype=np.int64)
    return Pieces(face.triangles.facet, face.triangles.xi, none, none)


def overlap(name: str, first: Face, second: Face) -> Overlap:
    """The overlap of two faces. Raises `InputError` naming interface `name` if they do not face each other, and if the
    second overlaps itself."""
    a, b = first.triangles, second.triangles
    found = facing(a, b)
    if max(found.covered) < LEAST_SHARE:
        raise InputError(
            f"contact {name!r}: facet sets {first.name!r} and {second.name!r} do not face each other: "
            f"{why_apart(a, b, found.covered)}; choose two sets whose outward normals look at each other across a gap"
        )
    facet = a.facet[found.source]
    own = np.bincount(a.facet, weights=a.area, minlength=len(first))
    of_facet = np.bincount(facet, weights=found.area, minlength=len(first)) / own
    if np.any(of_facet > 1.0 + FOLDED):
        raise InputError(
            f"contact {name!r}: {int(np.sum(of_facet > 1.0 + FOLDED))} facets of {first.name!r} see facets of "
            f"{second.name!r} behind one another; keep only those of {second.name!r} that touch {first.name!r}"
        )
    corners = np.einsum("pcv,pvd->pcd", found.weights, a.xi[found.source])
    covered = min(found.covered[0], 1.0), min(found.covered[1], 1.0)
    return Overlap(Pieces(facet, corners, found.source, found.across), covered, np.minimum(of_facet, 1.0))


def places_across(second: Face, triangle: Array, x: Array, axes: Array) -> tuple[Array, Array]:
    """Facets (q,) of the second face and points (q, 2) in their reference domains whose projection on the plane `axes`
    (q, 2, 3) is that of `x` (q, 3) [m]; `triangle` (q,) is the initial guess."""
    b = second.triangles
    corners = np.einsum("qdi,qci->qcd", axes, b.x[triangle])
    share = barycentric(corners, np.einsum("qdi,qi->qd", axes, x)[:, None])
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
