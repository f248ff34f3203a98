r"""Cells of small-sliding contact on matching meshes: loads B of unit forces; B^T gives the relative displacement.

Cell c has a frame (n, t1, t2), n the outward normal of the first face. Column 3 c + k of B (dofs, 3 c) is a unit force
along axis k on the second face and the opposite on the first, so that y = B^T u is the displacement of the second
relative to the first: of *facets* both are distributed evenly over a pair of facets and y is the difference of means;
of *nodes* they act on a pair of nodes and y is the difference of their displacements.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
import scipy.sparse as sp
from scipy.spatial import KDTree

from references.finite_elements.meshes import facet_shares
from references.small_sliding.full_model import FullModel
from warpffrf.model.errors import InputError

Array = np.ndarray
SAME_PLACE = 1e-6  # of the size of a facet: tangential distance of partners; along the normal there is a gap
Face = tuple[int, str]  # body and facet set


@dataclass(frozen=True, eq=False)
class Cells:
    """loads B (dofs, 3 c) csc; points (c, 3) [m] on the first face; frames (c, 3, 3), rows n, t1, t2; area (c,) [m2];
    gap (c,) [m] along n, >= 0 apart."""

    loads: Any
    points: Array
    frames: Array
    area: Array
    gap: Array

    @property
    def count(self) -> int:
        """Number of cells."""
        return len(self.area)


def facet_cells(model: FullModel, first: Face, second: Face) -> Cells:
    """A cell for every facet of the first face. Raises `InputError` if a facet has no partner."""
    nodes, shares, centers, vectors = _facets(model, first)
    others, other_shares, other_centers, _ = _facets(model, second)
    area = np.array([s.sum() for s in shares])
    normal = vectors / np.linalg.norm(vectors, axis=1)[:, None]
    partner, gap = _partners(centers, normal, other_centers, np.sqrt(area), "facet", first, second)
    frames = _frames(normal)
    sides = [
        (nodes, [s / s.sum() for s in shares], -1.0),
        ([others[j] for j in partner], [other_shares[j] / other_shares[j].sum() for j in partner], 1.0),
    ]
    return Cells(_loads(model, frames, sides), centers, frames, area, gap)


def node_cells(model: FullModel, first: Face, second: Face) -> Cells:
    """A cell for every node of the first face that is not fixed with its partner or shared by both faces.

    Raises `InputError` if a node has no partner or no area, as corners of quad8 facets.
    """
    nodes, shares, _, vectors = _facets(model, first)
    others = np.unique(np.concatenate(_facets(model, second)[0]))
    area, normal = np.zeros(len(model.points)), np.zeros((len(model.points), 3))
    for facet, share, vector in zip(nodes, shares, vectors, strict=True):
        np.add.at(area, facet, share)
        np.add.at(normal, facet, vector)
    own = np.unique(np.concatenate(nodes))
    if np.any(area[own] <= 0.0):
        raise InputError("node cells: a node of the face has no area; use facet cells, or hex27 in place of hex20")
    n = normal[own] / np.linalg.norm(normal[own], axis=1)[:, None]
    partner, gap = _partners(model.points[own], n, model.points[others], np.sqrt(area[own]), "node", first, second)
    other = others[partner]
    loose = np.isin(3 * own, model.free) | np.isin(3 * other, model.free)
    kept = (own != other) & loose
    own, other, n, gap = own[kept], other[kept], n[kept], gap[kept]
    frames = _frames(n)
    one = [np.ones(1)] * len(own)
    sides = [(list(own[:, None]), one, -1.0), (list(other[:, None]), one, 1.0)]
    return Cells(_loads(model, frames, sides), model.points[own], frames, area[own], gap)


def gathered(cells: Cells, group: Array) -> Cells:
    """Larger cells: those of equal number `group` (c,), 0, 1, ... as one, its force spread evenly over their area."""
    group = np.asarray(group)
    count = int(group.max()) + 1
    area = np.bincount(group, cells.area, count)
    share = cells.area / area[group]
    mean = sp.csr_matrix((share, (np.arange(len(group)), group)), shape=(len(group), count))
    normal = mean.T @ cells.frames[:, 0]
    frames = _frames(normal / np.linalg.norm(normal, axis=1)[:, None])
    turn = np.einsum("cix,cjx->cij", cells.frames, frames[group])  # from the axes of the large cell to the small one's
    rows = (3 * np.arange(len(group))[:, None, None] + np.arange(3)[:, None]) + np.zeros((1, 1, 3), dtype=int)
    columns = (3 * group[:, None, None] + np.arange(3)) + np.zeros((1, 3, 1), dtype=int)
    spread = sp.csr_matrix(
        ((share[:, None, None] * turn).ravel(), (rows.ravel(), columns.ravel())), shape=(3 * len(group), 3 * count)
    )
    return Cells(sp.csc_matrix(cells.loads @ spread), mean.T @ cells.points, frames, area, mean.T @ cells.gap)


def together(cells: Sequence[Cells]) -> Cells:
    """Cells of several joint interfaces one after the other."""
    return Cells(
        sp.csc_matrix(sp.hstack([c.loads for c in cells])),
        *(np.concatenate([getattr(c, name) for c in cells]) for name in ("points", "frames", "area", "gap")),
    )


def _facets(model: FullModel, face: Face) -> tuple[list[Array], list[Array], Array, Array]:
    """Of each facet: nodes, int N dA (k,) [m2], centroid (3,) [m], int n dA (3,) [m2]."""
    part, name = face
    nodes, shares, centers, vectors = [], [], [], []
    mesh = model.parts[part].mesh
    for kind, numbers in mesh.facets(name).blocks.items():
        share, vector = facet_shares(kind, mesh.points[numbers])
        nodes += list(numbers + model.offsets[part])
        shares += list(share)
        centers.append(np.einsum("mk,mkx->mx", share, mesh.points[numbers]) / share.sum(axis=1)[:, None])
        vectors.append(vector)
    return nodes, shares, np.concatenate(centers), np.concatenate(vectors)


def _partners(
    x: Array, normal: Array, others: Array, size: Array, what: str, first: Face, second: Face
) -> tuple[Array, Array]:
    """Number of the partner of each point x (c, 3), and the gap (c,) [m] along the normal."""
    partner = np.asarray(KDTree(others).query(x)[1])
    apart = others[partner] - x
    gap = np.einsum("cx,cx->c", apart, normal)
    aside = np.linalg.norm(apart - gap[:, None] * normal, axis=1)
    worst = int(np.argmax(aside / size))
    if aside[worst] > SAME_PLACE * size[worst]:
        raise InputError(
            f"cells between {first[1]!r} and {second[1]!r}: the {what} at {x[worst]} m has no partner, the nearest is "
            f"{aside[worst]:.3g} m aside; this reference needs meshes that match"
        )
    return partner, gap


def _frames(normal: Array) -> Array:
    """Right-handed frames (c, 3, 3) of the normals (c, 3): t1 along x, or along y if the normal is near x."""
    along = np.where(np.abs(normal[:, :1]) < 0.9, [[1.0, 0.0, 0.0]], [[0.0, 1.0, 0.0]])
    t1 = along - np.einsum("cx,cx->c", along, normal)[:, None] * normal
    t1 /= np.linalg.norm(t1, axis=1)[:, None]
    return np.stack([normal, t1, np.cross(normal, t1)], axis=1)


def _loads(model: FullModel, frames: Array, sides: list[tuple[list[Array], list[Array], float]]) -> Any:
    """B (dofs, 3 c) csc of the sides: nodes and shares of each cell, sign."""
    rows, columns, values = [], [], []
    for nodes, shares, sign in sides:
        for c, (node, share) in enumerate(zip(nodes, shares, strict=True)):
            rows.append(np.repeat((3 * node[:, None] + np.arange(3)).ravel(), 3))
            columns.append(np.tile(3 * c + np.arange(3), 3 * len(node)))
            values.append((sign * share[:, None, None] * frames[c].T[None]).ravel())
    shape = (model.size, 3 * len(frames))
    entries = (np.concatenate(values), (np.concatenate(rows), np.concatenate(columns)))
    return sp.csc_matrix(sp.coo_matrix(entries, shape=shape))
