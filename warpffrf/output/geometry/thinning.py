"""A coarser copy of a display surface, so that a recording stays small.

Every kept point is a point of the full surface, so the coarse one moves with real nodes and its values need no
averaging. On a surface of equal sectors every k-th sector is kept, which keeps a round body round; otherwise nodes
are clustered on a cubic grid and each cluster keeps its node nearest to the centroid; the cell size is the smallest
(by bisection) that gives the wanted count.
"""

from __future__ import annotations

import numpy as np

MIN_SECTORS = 24  # fewer would no longer look round
BISECTIONS = 24  # halvings of the cell size: far below the spacing of any mesh


def _clusters(points: np.ndarray, cell: float) -> np.ndarray:
    keys = np.floor((points - points.min(axis=0)) / cell + 0.5).astype(np.int64)
    return np.unique(keys, axis=0, return_inverse=True)[1].reshape(-1)


def thinned(
    points: np.ndarray, triangles: np.ndarray, max_points: int, sectors: int = 1
) -> tuple[np.ndarray, np.ndarray]:
    """Indices (k,) of the kept points, at most `max_points`, and triangles (t, 3) among them; everything when it
    is small enough."""
    if len(points) <= max_points:
        return np.arange(len(points)), np.asarray(triangles)
    if sectors > 1 and len(points) % sectors == 0 and sectors // MIN_SECTORS * max_points >= len(points):
        label, kept = _every_kth_sector(len(points), sectors, max_points)
    else:
        label, kept = _clustered(points, max_points)
    coarse = label[triangles]
    different = (coarse[:, 0] != coarse[:, 1]) & (coarse[:, 1] != coarse[:, 2]) & (coarse[:, 2] != coarse[:, 0])
    coarse = coarse[different]
    _, first = np.unique(np.sort(coarse, axis=1), axis=0, return_index=True)
    return kept, coarse[np.sort(first)]


def _every_kth_sector(count: int, sectors: int, max_points: int) -> tuple[np.ndarray, np.ndarray]:
    """Group of each point and the point kept of each group; points are numbered sector by sector."""
    per_sector = count // sectors
    k = -(-sectors // max(max_points // per_sector, 1))
    sector, node = np.divmod(np.arange(count), per_sector)
    return (sector // k) * per_sector + node, np.flatnonzero(sector % k == 0)


def _clustered(points: np.ndarray, max_points: int) -> tuple[np.ndarray, np.ndarray]:
    """Group of each point and the point kept of each group, by clustering on a cubic grid."""
    low, high = 0.0, float(np.ptp(points, axis=0).max())
    for _ in range(BISECTIONS):
        middle = 0.5 * (low + high)
        if _clusters(points, middle).max() + 1 > max_points:
            low = middle
        else:
            high = middle
    label = _clusters(points, high)
    count = np.bincount(label)
    centroid = np.stack([np.bincount(label, points[:, c]) for c in range(3)], axis=1) / count[:, None]
    distance = np.linalg.norm(points - centroid[label], axis=1)
    order = np.lexsort((distance, label))
    return label, order[np.searchsorted(label[order], np.arange(len(count)))]


def vertex_normals(points: np.ndarray, triangles: np.ndarray) -> np.ndarray:
    """Area-weighted unit normals (n, 3) of the vertices."""
    corners = points[triangles]
    area = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
    normals = np.zeros_like(points)
    for c in range(3):
        np.add.at(normals, triangles[:, c], area)
    length = np.linalg.norm(normals, axis=1, keepdims=True)
    return normals / np.where(length > 0.0, length, 1.0)
