r"""A facet set as a surface: points on it, and the triangles into which it is split.

A facet of any kind is split at its own nodes into triangles (at its corners, if these define it), straight in its
reference domain and nearly so in space. These triangles are cut: a corner of a cut is mapped to the reference domain
by the affine map of its triangle, so that whole triangles remain whole there, and their integrals are those of
the isoparametric facet,

    int f dA = sum_q w_q f(xi_q) |x_,1 x x_,2|(xi_q),      x(xi) = sum_a N_a(xi) x_a.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property
from typing import Any

import numpy as np
import scipy.sparse as sp

from warpffrf.model.mesh import Mesh
from warpffrf.model.mesh.elements import facet_kind
from warpffrf.model.small_sliding.facing import Triangles

Array = np.ndarray
LINEAR = {"quad": "quad4", "tri": "tri3"}  # the facet on the corners of one of that domain
STRAIGHT = 1e-9  # of a facet's length: allowed deviation of nodes from straight edges, digits of a mesh file


@dataclass(frozen=True, eq=False)
class Face:
    """The facet set `name` of a mesh with `points` (n, 3) [m]; facets are numbered through its blocks."""

    name: str
    points: Array
    blocks: list[tuple[str, Array]]  # kind, nodes (m, k)

    @classmethod
    def of(cls, mesh: Mesh, name: str) -> Face:
        """The facet set of that name; raises `InputError` if there is none."""
        return cls(name, mesh.points, list(mesh.facets(name).blocks.items()))

    def __len__(self) -> int:
        return sum(len(nodes) for _, nodes in self.blocks)

    @property
    def starts(self) -> Array:
        """Number of the first facet of each block, and that after the last."""
        return np.concatenate([[0], np.cumsum([len(nodes) for _, nodes in self.blocks])]).astype(np.int64)

    @cached_property
    def node_set(self) -> Array:
        """Sorted numbers of the nodes."""
        return np.unique(np.concatenate([nodes.ravel() for _, nodes in self.blocks]))

    @property
    def quadratic(self) -> bool:
        """Whether any facet has nodes between its corners."""
        return any(facet_kind(kind).degree == 2 for kind, _ in self.blocks)

    @cached_property
    def edge(self) -> Array:
        """Mean length (facets,) of each facet's edges, corner to corner [m]."""
        return np.concatenate([lengths.mean(axis=1) for lengths in self._edges])

    @cached_property
    def shortest(self) -> Array:
        """Length (facets,) of each facet's shortest edge, corner to corner [m]."""
        return np.concatenate([lengths.min(axis=1) for lengths in self._edges])

    @property
    def _edges(self) -> list[Array]:
        """Lengths (m, corners) [m] of the edges of each block."""
        found = []
        for kind, nodes in self.blocks:
            x = self.points[nodes[:, : facet_kind(kind).corner_count]]
            found.append(np.linalg.norm(np.roll(x, -1, axis=1) - x, axis=2))
        return found

    @cached_property
    def centers(self) -> Array:
        """Means (facets, 3) of each facet's corners [m]."""
        return np.concatenate([self.points[n[:, : facet_kind(k).corner_count]].mean(axis=1) for k, n in self.blocks])

    @cached_property
    def corners(self) -> Array:
        """Corners (facets, 4, 3) of each facet [m], the last of a triangle twice."""
        found = []
        for kind, nodes in self.blocks:
            count = facet_kind(kind).corner_count
            found.append(self.points[nodes[:, [0, 1, 2, count - 1]]])
        return np.concatenate(found)

    @cached_property
    def boundary(self) -> tuple[Array, Array]:
        """Edges between corners: numbers (e, 2) of their nodes, sorted, and the facet (e,) of each, all facets' own."""
        edges, facet = [], []
        for start, (kind, nodes) in zip(self.starts[:-1], self.blocks, strict=True):
            corners = nodes[:, : facet_kind(kind).corner_count]
            edges.append(np.sort(np.stack([corners, np.roll(corners, -1, axis=1)], axis=2).reshape(-1, 2), axis=1))
            facet.append(np.repeat(start + np.arange(len(nodes)), corners.shape[1]))
        return np.concatenate(edges), np.concatenate(facet)

    @cached_property
    def triangles(self) -> FaceTriangles:
        """All facets split at their own nodes, those with straight edges at their corners."""
        facet, xi, numbers = [], [], []
        for start, (kind, nodes) in zip(self.starts[:-1], self.blocks, strict=True):
            element = facet_kind(kind)
            straight = self._straight(kind, nodes)
            corners = facet_kind(LINEAR[element.domain]).triangles
            for split, here in ((corners, np.flatnonzero(straight)), (element.triangles, np.flatnonzero(~straight))):
                facet.append(np.repeat(start + here, len(split)))
                xi.append(np.tile(element.nodes[split], (len(here), 1, 1)))
                numbers.append(nodes[here][:, split].reshape(-1, 3))
        nodes = np.concatenate(numbers)
        return FaceTriangles(self.points[nodes], nodes, np.concatenate(facet), np.concatenate(xi))

    def _straight(self, kind: str, nodes: Array) -> Array:
        """Which facets (m,) have all their nodes at the positions of the linear facet on their corners."""
        element = facet_kind(kind)
        values = facet_kind(LINEAR[element.domain]).shape(element.nodes)[0]
        x = self.points[nodes]
        corners = x[:, : element.corner_count]
        off = np.linalg.norm(x - np.einsum("ac,mci->mai", values, corners), axis=2).max(axis=1)
        return off <= STRAIGHT * np.linalg.norm(np.ptp(corners, axis=1), axis=1)

    def at(self, facet: Array, xi: Array) -> tuple[Any, Array]:
        """At points `xi` (q, 2) of the facets `facet` (q,): shape functions (q, n) csr over all nodes of the mesh, and
        the tangents dx/dxi (q, 2, 3) [m]."""
        starts = self.starts
        rows, columns, values = [], [], []
        tangents = np.zeros((len(facet), 2, 3))
        for start, stop, (kind, nodes) in zip(starts[:-1], starts[1:], self.blocks, strict=True):
            here = np.flatnonzero((facet >= start) & (facet < stop))
            if not len(here):
                continue
            N, slopes = facet_kind(kind).shape(xi[here])
            of = nodes[facet[here] - start]
            tangents[here] = np.einsum("qkd,qki->qdi", slopes, self.points[of])
            rows.append(np.repeat(here, N.shape[1]))
            columns.append(of.ravel())
            values.append(N.ravel())
        data = (np.concatenate(values), (np.concatenate(rows), np.concatenate(columns)))
        return sp.csr_matrix(data, shape=(len(facet), len(self.points))), tangents


@dataclass(frozen=True, eq=False)
class FaceTriangles(Triangles):
    """Triangles of a face with their `facet` (t,) and their corners `xi` (t, 3, 2) in its reference
    domain."""

    facet: Array
    xi: Array
