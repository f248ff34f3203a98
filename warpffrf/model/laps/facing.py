r"""Where two surfaces of triangles face each other: the triangles of the first, cut by those of the second.

Triangle b of the second surface is seen from triangle a of the first along a's normal n: where their normals look
against each other, `n.n_b < -cos 60 deg`, and b is neither behind a, by more than what meshes of round faces and press
fits overlap, nor far away, the shadow of b on the plane of a cuts a convex polygon out of it (`clipping`). The polygons
of all b fill the part of a that is covered; cut into triangles they are the *pieces*, each with one triangle on either
side.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property

import numpy as np
from scipy.spatial import KDTree

from warpffrf.model.laps.clipping import areas, clipped, fans

Array = np.ndarray
FACING = -0.5  # cosine between normals of triangles that face each other, at most
# Of the extent of the smaller face: how far the face across may lie inside, as with press fits, beside what the flat
# facets of round faces cut off. Sheets are thicker, whose other side must not be taken for it.
BEHIND = 1e-3
FAR = 0.5  # of the extent of the smaller face: further apart they do not face each other
ROUND_OFF = 1e-10  # of a triangle's area: what cuts along shared edges leave
TOGETHER = 1e-9  # of the extent: corners closer than this are one
CENTERS = 1000  # triangles whose neighbours are looked for together
PAIRS = 200_000  # triangles tried against triangles together: some 100 MB


@dataclass(frozen=True, eq=False)
class Triangles:
    """A surface: corners `x` (t, 3, 3) [m] of its triangles, outwards, and numbers `nodes` (t, 3), alike where corners
    of neighbours are one."""

    x: Array
    nodes: Array

    @classmethod
    def of(cls, x: Array) -> Triangles:
        """Triangles that do not say which of their corners are one."""
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
        """How far (t,) [m] the surface that a triangle stands for may lie beside it: its reach times the angle between
        its normal and the mean normals at its corners."""
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
    """What is to be said of surfaces that do not face each other: how much does, how far apart they are, and why."""
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
        why = "they lie beside each other, far apart, or back to back with material between"
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
    # the place across is no further than the gap along n, which is at most twice the distance between the faces
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
