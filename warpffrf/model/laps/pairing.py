r"""Which cells of two faces lie on each other at the initial pose, and how forces of a cell act on the other face.

Triangles of the first face are cut by those of the second, seen along the normals of the first (`clipping`). A cell of
the first face that is covered is a cell of the lap; its force acts on the cells of the second face in proportion to the
areas that they share, and what it sees of the second face is the mean of their displacements with the same weights, so
that the two are conjugate. At the outline of the overlap cells of the first face are taken whole: the force acts on all
of the cell, and on the cells of the second face that it covers. The gap of a cell is the mean distance along its
normal.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
import scipy.sparse as sp
from scipy.spatial import KDTree

from warpffrf.model.errors import InputError
from warpffrf.model.laps.clipping import areas, clipped, fans

Array = np.ndarray
FACING = -0.5  # cosine between normals that look at each other, at most
BEHIND = 1e-3  # of the extent of the smaller face: how deep the second may lie behind the first, as with press fits
LEAST = 1e-2  # of a cell's area: less of it covered is none
FAR = 0.5  # of the extent of the smaller face: further apart they do not face each other


@dataclass(frozen=True, eq=False)
class Pairing:
    """Cells of the lap, c of them: `cell` (c,) on the first face, `covered` (c,) the covered share of its area, `gap`
    (c,) [m], `weights` (c, cells of the second face) csr, rows that add up to 1; `shares` of both faces' areas that
    face each other, `distance` [m] mean and largest gap."""

    cell: Array
    covered: Array
    gap: Array
    weights: sp.csr_matrix
    shares: tuple[float, float]

    @property
    def distance(self) -> tuple[float, float]:
        return float(self.gap.mean()), float(self.gap.max())


def pair_faces(label: str, first: Array, cell: Array, normals: Array, second: Array, other: Array) -> Pairing:
    """The pairing of two faces in common axes.

    first (t, 3, 3), second (u, 3, 3): corners of their triangles [m], outwards; cell (t,), other (u,): the cells that
    these are of; normals (cells of the first face, 3). Raises `InputError`, naming `label`, where they do not face each
    other.
    """
    own, center = _areas(first), first.mean(axis=1)
    own_other, across = _areas(second), second.mean(axis=1)
    normal, opposite = _normals(first), _normals(second)
    extent = min(float(np.linalg.norm(np.ptp(x.reshape(-1, 3), axis=0))) for x in (first, second))
    i, j = _near(center, first, across, second, FAR * extent)
    cosine = np.einsum("pi,pi->p", normal[i], opposite[j])
    apart = np.einsum("pi,pi->p", across[j] - center[i], normal[i])
    kept = (cosine < FACING) & (apart > -BEHIND * extent - _reach(first)[i]) & (np.abs(apart) < FAR * extent)
    i, j = i[kept], j[kept]
    axes = _plane_axes(normal)
    flat = np.einsum("pdi,pci->pcd", axes[i], first[i] - center[i][:, None])
    shadow = np.einsum("pdi,pci->pcd", axes[i], second[j] - center[i][:, None])[:, ::-1]
    polygons, count = clipped(flat, np.full(len(i), 3), shadow)
    area = areas(polygons, count)
    there = (count >= 3) & (area > 1e-12 * own[i])
    i, j, area, polygons, count = i[there], j[there], area[there], polygons[there], count[there]
    cells = int(cell.max()) + 1
    covered_area = np.bincount(cell[i], weights=area, minlength=cells)
    whole = np.bincount(cell, weights=own, minlength=cells)
    covered = covered_area / whole
    seen = np.bincount(j, weights=area / np.abs(np.einsum("pi,pi->p", normal[i], opposite[j])), minlength=len(second))
    shares = float(covered_area.sum() / own.sum()), float(min(seen.sum() / own_other.sum(), 1.0))
    lap = np.flatnonzero(covered > LEAST)
    if not len(lap):
        raise InputError(_apart(label, first, second, normal, own, opposite, own_other))
    triangles, number = fans(polygons, count)
    place = triangles.mean(axis=1)
    part = _flat_areas(triangles)
    x = center[i][number] + np.einsum("pd,pdi->pi", place, axes[i][number])
    n = normal[i][number]
    y_gap = np.einsum("pi,pi->p", across[j][number] - x, opposite[j][number]) / np.einsum(
        "pi,pi->p", n, opposite[j][number]
    )
    weight = np.bincount(cell[i][number], weights=part, minlength=cells)
    gap = np.bincount(cell[i][number], weights=part * y_gap, minlength=cells)[lap] / weight[lap]
    at = np.full(cells, -1)
    at[lap] = np.arange(len(lap))
    row = at[cell[i]]
    inside = row >= 0
    shared = sp.csr_matrix(
        (area[inside], (row[inside], other[j][inside])), shape=(len(lap), int(other.max()) + 1)
    )  # fmt: skip
    weights = sp.csr_matrix(sp.diags(1.0 / covered_area[lap]) @ shared)
    return Pairing(lap, np.minimum(covered[lap], 1.0), gap, weights, (min(shares[0], 1.0), shares[1]))


def _areas(triangles: Array) -> Array:
    cross = np.cross(triangles[:, 1] - triangles[:, 0], triangles[:, 2] - triangles[:, 0])
    return 0.5 * np.linalg.norm(cross, axis=1)


def _normals(triangles: Array) -> Array:
    cross = np.cross(triangles[:, 1] - triangles[:, 0], triangles[:, 2] - triangles[:, 0])
    return cross / np.linalg.norm(cross, axis=1, keepdims=True)


def _flat_areas(triangles: Array) -> Array:
    a, b = triangles[:, 1] - triangles[:, 0], triangles[:, 2] - triangles[:, 0]
    return 0.5 * np.abs(a[:, 0] * b[:, 1] - a[:, 1] * b[:, 0])


def _reach(triangles: Array) -> Array:
    """Largest distance of a corner from the middle."""
    return np.linalg.norm(triangles - triangles.mean(axis=1, keepdims=True), axis=2).max(axis=1)


def _plane_axes(normals: Array) -> Array:
    """Two unit vectors (p, 2, 3) across each normal, right-handed with it."""
    help_ = np.eye(3)[np.argmin(np.abs(normals), axis=1)]
    a = np.cross(help_, normals)
    a /= np.linalg.norm(a, axis=1, keepdims=True)
    return np.stack([a, np.cross(normals, a)], axis=1)


def _near(center: Array, first: Array, across: Array, second: Array, far: float) -> tuple[Array, Array]:
    """Pairs of triangles that may lie opposite."""
    tree = KDTree(across)
    reach, widest = _reach(first), float(_reach(second).max())
    nearest = tree.query(center)[0]
    found = tree.query_ball_point(center, np.minimum(nearest, far) * 2.0 + reach + widest)
    i = np.repeat(np.arange(len(found)), [len(f) for f in found])
    return i, np.concatenate([np.asarray(f, dtype=np.int64) for f in found])


def _apart(label: str, first: Array, second: Array, n: Array, own: Array, m: Array, other: Array) -> str:
    """What to say of faces that do not face each other."""
    distance = float(KDTree(second.reshape(-1, 3)).query(first.reshape(-1, 3))[0].min())
    means = [np.sum(v * a[:, None], axis=0) for v, a in ((n, own), (m, other))]
    means = [v / max(float(np.linalg.norm(v)), 1e-300) for v in means]
    angle = float(np.degrees(np.arccos(np.clip(-means[0] @ means[1], -1.0, 1.0))))
    why = "they lie beside each other, or too far apart" if angle <= 60.0 else (
        f"their outward normals are {angle:.0f} degrees from being opposite"
    )  # fmt: skip
    return (
        f"{label}: the faces do not face each other: nothing of them overlaps, their nearest corners are "
        f"{distance:.3g} m apart, {why}; place the bodies so that the two faces look at each other across a small gap"
    )
