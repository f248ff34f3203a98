r"""Facets grouped into cells, of a size that may grow with the distance from an outline.

A set of facets that is longer than the target length of any of them, or whose normals differ by more than `TURN`, is
split in two across the direction in which it exceeds the target most, into halves of equal area, and so on.
Directions are along and across an edge of its middle facet, so that cells follow the rows of a structured mesh. At the
distance d of a facet from the outline, the target in either direction is

    length = min(size, length of the facet + growth d),

and a set that is one facet wide cannot be split there: long facets give cells of their own width.

The outline is that of the overlap: the edges that belong to one covered facet only and the partially covered facets.
Alternatively it is that of other facet sets, as of heads of bolts, whose edges press through the sheet: d is then the
distance from the line through the facet along its normal.

A facet covered by less than `LEAST` does not form a cell: it is merged with the neighbouring cell.
"""

from __future__ import annotations

import numpy as np
from scipy.spatial import KDTree

from warpffrf.model.mesh.facets import row_numbers
from warpffrf.offline.small_sliding.faces import Face

Array = np.ndarray
TURN = np.cos(np.radians(15.0))  # between a facet's normal and the mean of its cell: tractions keep one direction
LEAST = 0.2  # share of a facet below which it is merged with its neighbour: pressures on slivers would be noise
SLACK = 1.01  # of the size: round-off allowance for structured meshes
SAME = 1e-6  # of an extent: points this close are one
PLACES = 1_000_000  # pairs of facets and points of an outline processed together
PARTLY = 1.0 - 1e-6  # share of a facet below which the outline of the second face crosses it


def grown(face: Face, of_facet: Array, growth: float | None, fine: Array | None = None) -> Array:
    """growth d (facets,) [m], infinite without growth; `of_facet` (facets,) is the covered share of each, `fine` (k, 3)
    [m] are points of outlines that replace that of the overlap."""
    if growth is None:
        return np.full(len(face), np.inf)
    if fine is not None:
        away = _aside(face, fine)
    else:
        partly = face.centers[(of_facet > 0.0) & (of_facet < PARTLY)]
        places = np.concatenate([outline(face, of_facet > 0.0), partly])
        # a closed face has no outline
        away = KDTree(places).query(face.centers)[0] if len(places) else np.full(len(face), np.inf)
    return growth * np.maximum(away - 0.5 * face.shortest, 0.0)


def outline(face: Face, there: Array | None = None) -> Array:
    """Ends and middles (k, 3) [m] of the edges that belong to one facet only, of all or of those `there` (facets,)."""
    edges, facet = face.boundary
    if there is not None:
        edges = edges[there[facet]]
    number = row_numbers(edges)
    ends = face.points[edges[np.bincount(number)[number] == 1]]
    return np.concatenate([ends[:, 0], ends[:, 1], ends.mean(axis=1)])


def _aside(face: Face, places: Array) -> Array:
    """Least distance (facets,) [m] of `places` (k, 3) from the line through each facet along its normal."""
    normals = _normals(face)
    least = np.full(len(face), np.inf)
    chunk = max(1, PLACES // max(len(places), 1))
    for start in range(0, len(face), chunk):
        part = slice(start, start + chunk)
        apart = places - face.centers[part, None]
        along = np.einsum("mki,mi->mk", apart, normals[part])
        squares = np.einsum("mki,mki->mk", apart, apart) - along**2
        least[part] = np.sqrt(np.maximum(squares, 0.0).min(axis=1, initial=np.inf))
    return least


def _normals(face: Face) -> Array:
    """Unit normals (facets, 3) of the triangles of each facet together."""
    normals = np.zeros((len(face), 3))
    np.add.at(normals, face.triangles.facet, face.triangles.normal * face.triangles.area[:, None])
    return normals / np.linalg.norm(normals, axis=1, keepdims=True)


def gathered(face: Face, covered: Array, area: Array, size: float | None, more: Array) -> Array:
    """Number of the cell (facets,) of each facet, -1 for those not `covered` (facets,) bool; `area` (facets,) [m2]
    their covered areas, `more` (facets,) [m] as given by `grown`."""
    most = np.inf if size is None else size
    normals = _normals(face)
    cells = np.full(len(face), -1)
    waiting = [np.flatnonzero(covered)]
    found = 0
    while waiting:
        here = waiting.pop()
        mean = normals[here].sum(axis=0)
        mean /= max(float(np.linalg.norm(mean)), 1e-300)
        center = face.centers[here].mean(axis=0)
        middle = here[np.argmin(np.linalg.norm(face.centers[here] - center, axis=1))]
        edge = face.corners[middle, 1] - face.corners[middle, 0]
        edge /= np.linalg.norm(edge)
        directions = np.stack([edge, np.cross(normals[middle], edge)])
        corners = face.corners[here] @ directions.T
        extent = np.ptp(corners.reshape(-1, 2), axis=0)
        wanted = np.minimum(most, np.ptp(corners, axis=1) + more[here, None]).min(axis=0)
        places = (face.centers[here] - center) @ directions.T
        several = np.ptp(places, axis=0) > SAME * extent
        too_long = np.where(several, extent / np.where(np.isfinite(wanted), wanted, 1.0), 0.0)
        longest = int(too_long[1] > SLACK * too_long[0])
        along = places[:, longest]
        small = np.all(extent[several] <= SLACK * wanted[several]) and np.all(normals[here] @ mean > TURN)
        if len(here) == 1 or small:
            cells[here] = found
            found += 1
            continue
        low = _lower_half(along, area[here])
        waiting += [here[~low], here[low]]
    return cells


def slivers_joined(face: Face, cells: Array, of_facet: Array) -> Array:
    """The numbers `cells` (facets,), -1 for facets without one, after merging every single-facet cell covered by less
    than `LEAST` into that of the neighbouring facet covered most; without a neighbour it stays."""
    alone = np.bincount(cells[cells >= 0])[cells] == 1
    small = (cells >= 0) & alone & (of_facet < LEAST)
    if not small.any():
        return cells
    edges, facet = face.boundary
    number = row_numbers(edges)
    order = np.argsort(number, kind="stable")
    same = np.flatnonzero(np.diff(number[order]) == 0)
    one, other = facet[order[same]], facet[order[same + 1]]
    one, other = np.concatenate([one, other]), np.concatenate([other, one])
    usable = small[one] & (cells[other] >= 0) & ~small[other]
    one, other = one[usable], other[usable]
    rising = np.argsort(of_facet[other], kind="stable")  # the last one counts
    joined = cells.copy()
    joined[one[rising]] = cells[other[rising]]
    kept, numbers = np.unique(joined, return_inverse=True)
    return numbers - int(kept[0] < 0)


def _lower_half(along: Array, area: Array) -> Array:
    """The positions `along` (m,) a line below the best cut of their `area` (m,); ties stay together."""
    order = np.argsort(along, kind="stable")
    steps = np.diff(along[order])
    cuts = np.flatnonzero(steps > SAME * max(float(np.ptp(along)), 1e-300))
    if not len(cuts):  # all at one position: any half is acceptable
        low = np.zeros(len(along), dtype=bool)
        low[: len(along) // 2] = True
        return low
    sums = np.cumsum(area[order])
    cut = cuts[np.argmin(np.abs(sums[cuts] - 0.5 * sums[-1]))]
    low = np.zeros(len(along), dtype=bool)
    low[order[: cut + 1]] = True
    return low
