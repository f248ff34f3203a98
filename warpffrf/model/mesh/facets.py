"""Facets of a mesh: named sets of them, and the outer faces of its cells.

Rigid motions of a set of nodes.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np

from warpffrf.model.errors import InputError
from warpffrf.model.mesh.elements import cell_kind, facet_kind


@dataclass(frozen=True, eq=False)
class FacetSet:
    """Facets by kind, `blocks` {quad4, quad8, quad9, tri3 or tri6: nodes (m, k) int64}, VTK order, outward normal."""

    blocks: Mapping[str, np.ndarray]

    def __post_init__(self) -> None:
        blocks = {}
        for kind, nodes in self.blocks.items():
            blocks[kind] = node_numbers(nodes, f"{kind} facets", len(facet_kind(kind).nodes))
        object.__setattr__(self, "blocks", {kind: nodes for kind, nodes in blocks.items() if len(nodes)})

    def __len__(self) -> int:
        return sum(len(nodes) for nodes in self.blocks.values())

    @property
    def node_set(self) -> np.ndarray:
        """Sorted numbers (n,) of all nodes on the set."""
        if not self.blocks:
            return np.zeros(0, dtype=np.int64)
        return np.unique(np.concatenate([nodes.ravel() for nodes in self.blocks.values()]))

    @property
    def corners(self) -> dict[str, np.ndarray]:
        """Corner nodes (m, 3 or 4) of each block."""
        return {kind: nodes[:, : facet_kind(kind).corner_count] for kind, nodes in self.blocks.items()}

    @property
    def single(self) -> tuple[str, np.ndarray]:
        """Kind and nodes (m, k) of a set of one kind; raises `InputError` for a set of several."""
        if len(self.blocks) != 1:
            raise InputError(f"facets of one kind are needed, got {', '.join(self.blocks) or 'none'}")
        return next(iter(self.blocks.items()))

    def centers(self, points: np.ndarray) -> np.ndarray:
        """Means of the facets' corners (m, 3) [m], blocks one after the other; points (n, 3) [m]: of the mesh."""
        return np.concatenate([np.zeros((0, 3)), *(points[c].mean(axis=1) for c in self.corners.values())])

    def node_normals(self, points: np.ndarray) -> np.ndarray:
        """Outward unit normals (n, 3) at the nodes of `node_set`, the mean of those of their facets' corners,
        in the axes of `points` (n, 3) [m], those of the mesh."""
        numbers = self.node_set
        total = np.zeros((len(numbers), 3))
        for kind, nodes in self.blocks.items():
            corners = points[nodes[:, : facet_kind(kind).corner_count]]
            # twice the area vector: of a triangle, and of a quadrilateral by its diagonals
            normal = np.cross(corners[:, 2] - corners[:, 0], corners[:, -1] - corners[:, 1])
            place = np.searchsorted(numbers, nodes)
            np.add.at(total, place.ravel(), np.repeat(normal, nodes.shape[1], axis=0))
        length = np.linalg.norm(total, axis=1, keepdims=True)
        return total / np.where(length > 0.0, length, 1.0)  # opposite facets cancel

    def kept(self, mask: np.ndarray) -> FacetSet:
        """The facets for which `mask` (m,) is true, counted through the blocks."""
        stops = np.cumsum([len(nodes) for nodes in self.blocks.values()])[:-1]
        parts = np.split(np.asarray(mask), stops)
        return FacetSet({kind: nodes[m] for (kind, nodes), m in zip(self.blocks.items(), parts, strict=True)})

    def renumbered(self, new_number: np.ndarray) -> FacetSet:
        """The set over other node numbers: node a becomes `new_number[a]`."""
        return FacetSet({kind: new_number[nodes] for kind, nodes in self.blocks.items()})


def outer_faces(cells: Mapping[str, np.ndarray], inner: Mapping[str, int] | None = None) -> FacetSet:
    """Faces of `cells` {kind: (m, k)} that belong to one cell only, outward.

    With `inner`, only the faces of the first `inner[kind]` cells are returned; the others are their neighbours only.
    """
    found: list[tuple[str, np.ndarray, np.ndarray]] = []  # facet kind, faces, and which of them are considered
    keys = []
    for kind, nodes in cells.items():
        for facet, local in cell_kind(kind).faces.items():
            faces = nodes[:, local].reshape(-1, local.shape[1])
            corners = np.sort(faces[:, : facet_kind(facet).corner_count], axis=1)
            keys.append(np.pad(corners, ((0, 0), (0, 4 - corners.shape[1])), constant_values=-1))
            looked_at = np.ones(len(faces), dtype=bool)
            if inner is not None:
                looked_at[inner[kind] * len(local) :] = False
            found.append((facet, faces, looked_at))
    number = row_numbers(np.concatenate(keys))
    single = np.split(np.bincount(number)[number] == 1, np.cumsum([len(k) for k in keys])[:-1])
    blocks: dict[str, list[np.ndarray]] = {}
    for (facet, faces, looked_at), alone in zip(found, single, strict=True):
        blocks.setdefault(facet, []).append(faces[alone & looked_at])
    return FacetSet({facet: np.concatenate(parts) for facet, parts in blocks.items()})


def row_numbers(rows: np.ndarray) -> np.ndarray:
    """Number (m,) of each row of integers (m, k), counted from 0 in sorted order; equal rows have equal numbers.

    The inverse of `np.unique(rows, axis=0)`, some ten times faster.
    """
    order = np.lexsort(rows.T[::-1])
    new = np.any(np.diff(rows[order], axis=0) != 0, axis=1)
    number = np.empty(len(rows), dtype=np.int64)
    number[order] = np.concatenate([np.zeros(min(len(rows), 1), dtype=np.int64), np.cumsum(new)])
    return number


def triangles(facets: FacetSet) -> np.ndarray:
    """Triangles (t, 3) of the facets, outward, split at the facets' own nodes."""
    parts = [nodes[:, facet_kind(kind).triangles].reshape(-1, 3) for kind, nodes in facets.blocks.items()]
    return np.concatenate([np.zeros((0, 3), dtype=np.int64), *parts])


def node_numbers(nodes: object, name: str, width: int) -> np.ndarray:
    """`nodes` as read-only int64 (m, width); raises `InputError` otherwise."""
    array = np.array(nodes)
    if array.ndim != 2 or array.shape[1] != width or not np.issubdtype(array.dtype, np.integer):
        raise InputError(
            f"{name}: node numbers must be integers of shape (m, {width}), got {array.shape} of {array.dtype}"
        )
    array = array.astype(np.int64)
    array.setflags(write=False)
    return array


def rigid_modes(points: np.ndarray, center: np.ndarray) -> np.ndarray:
    """Rigid motions (3 n, 6) of nodes `points` (n, 3): three translations, three rotations about `center` (3,)."""
    n = len(points)
    x, y, z = (points - center).T
    R = np.zeros((n, 3, 6))
    R[:, range(3), range(3)] = 1.0
    R[:, 1, 3], R[:, 2, 3] = -z, y
    R[:, 0, 4], R[:, 2, 4] = z, -x
    R[:, 0, 5], R[:, 1, 5] = -y, x
    return R.reshape(3 * n, 6)
