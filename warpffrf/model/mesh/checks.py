"""Geometric checks of a mesh: orientation of the cells, duplicate cells, unused nodes, connectivity.

A cell is *inverted* where det(dx/dxi) <= 0 at one of the points at which its stiffness is integrated. At its nodes the
determinant may be smaller and even negative in cells that are integrated as they should be (a corner of the patch test
of MacNeal and Harder 1985, Finite Elem. Anal. Des. 1, 3; curved tetrahedra): `corner_notes` names them.
"""

from __future__ import annotations

from collections.abc import Mapping

import numpy as np

from warpffrf.model.errors import InputError
from warpffrf.model.mesh.elements import cell_kind
from warpffrf.model.mesh.structure import Structure

FLAT_CELL = 1e-9  # det J below this fraction of (cell size)^3 counts as inverted: round-off of a flat cell, not a shape
# the rule of Keast (1986) with 11 points, of degree 4, for quadratic tetrahedra: centre, near corners, near edges
_A, _B = 0.5 * (1.0 + np.sqrt(5.0 / 14.0)) / 2.0, 0.5 * (1.0 - np.sqrt(5.0 / 14.0)) / 2.0
_KEAST = np.array([(0.25, 0.25, 0.25), *(11.0 / 14.0 * np.eye(3) + 1.0 / 14.0 * (1.0 - np.eye(3))), 3 * (1.0 / 14.0,),
                   (_B, _A, _A), (_A, _B, _A), (_A, _A, _B), (_A, _B, _B), (_B, _A, _B), (_B, _B, _A)])  # fmt: skip
_CHUNK = 20_000  # cells processed together: bounds the memory of the check to some tens of MB


def jacobian_range(
    points: np.ndarray, kind: str, cells: np.ndarray, places: np.ndarray
) -> tuple[np.ndarray, np.ndarray]:
    """Smallest determinant at the reference `places` (q, 3) of each cell (m,) [m3], and the cube of each cell's size
    (m,) [m3]."""
    cell = cell_kind(kind)
    smallest, cube = np.empty(len(cells)), np.empty(len(cells))
    for start in range(0, len(cells), _CHUNK):
        part = slice(start, start + _CHUNK)
        x = points[cells[part]]
        smallest[part] = cell.jacobians(x, places).min(axis=1)
        cube[part] = np.max(np.ptp(x, axis=1), axis=1) ** 3
    return smallest, cube


def check_orientation(
    points: np.ndarray, cells: Mapping[str, np.ndarray], labels: np.ndarray | None = None, what: str = "number"
) -> None:
    """Raise `InputError` naming the first inverted (or flat) cell of a kind and how many there are, or the first with a
    node twice.

    `labels` (N,), through the blocks, are the cells' numbers in their file, which calls them `what`; None: 0, 1, 2, ...
    """
    start = 0
    for kind, nodes in cells.items():
        ordered = np.sort(nodes, axis=1)
        twice = np.flatnonzero(np.any(ordered[:, 1:] == ordered[:, :-1], axis=1))
        if len(twice):
            first = start + int(twice[0])
            raise InputError(
                f"mesh: {len(twice)} {kind} cell(s) have repeated nodes, the first is {what} "
                f"{first if labels is None else labels[first]}; give each corner a node, or write the cell as a wedge "
                "or tetrahedron"
            )
        smallest, cube = jacobian_range(points, kind, nodes, inside_points(kind))
        bad = np.flatnonzero(~(smallest > FLAT_CELL * cube))
        if len(bad):
            first = int(bad[0])
            center = ", ".join(f"{x:.6g}" for x in points[nodes[first]].mean(axis=0))
            raise InputError(
                f"mesh: {len(bad)} inverted {kind} cell(s), the first is {what} "
                f"{start + first if labels is None else labels[start + first]} at ({center}) m with det J = "
                f"{smallest[first]:.3g} m3; repair the mesh or the node order of its cells"
            )
        start += len(nodes)


def inside_points(kind: str) -> np.ndarray:
    """Points (q, 3) at which det J of a cell has to be positive: those of the rule of its stiffness."""
    return _KEAST if kind == "tet10" else cell_kind(kind).quadrature_points


def corner_notes(
    points: np.ndarray, cells: Mapping[str, np.ndarray], labels: np.ndarray | None = None, what: str = "number"
) -> list[str]:
    """A note for each kind of cells some of which have det J <= 0 at a node; arguments as in `check_orientation`."""
    notes, start = [], 0
    for kind, nodes in cells.items():
        smallest, cube = jacobian_range(points, kind, nodes, cell_kind(kind).nodes)
        bad = np.flatnonzero(~(smallest > FLAT_CELL * cube))
        if len(bad):
            first = start + int(bad[0])
            notes.append(
                f"{len(bad)} {kind} cell(s) have det J <= 0 at a node, the first is {what} "
                f"{first if labels is None else labels[first]}: where they are integrated it is positive, but their "
                "quality is poor and stresses near them are doubtful"
            )
        start += len(nodes)
    return notes


def check_distinct(cells: Mapping[str, np.ndarray], labels: np.ndarray | None = None, what: str = "number") -> None:
    """Raise `InputError` where two cells have the same corners: stiffness and mass would count twice.

    `labels` and `what` as in `check_orientation`.
    """
    rows, numbers = [], []
    widest = max(cell_kind(kind).corner_count for kind in cells)
    start = 0
    for kind, nodes in cells.items():
        corners = np.sort(nodes[:, : cell_kind(kind).corner_count], axis=1)
        rows.append(np.pad(corners, ((0, 0), (0, widest - corners.shape[1])), constant_values=-1))
        numbers.append(np.arange(start, start + len(nodes)))
        start += len(nodes)
    corners, number = np.concatenate(rows), np.concatenate(numbers)
    order = np.lexsort(corners.T)
    same = np.flatnonzero(np.all(corners[order[1:]] == corners[order[:-1]], axis=1))
    if len(same):
        first, second = sorted(number[order[same[0] : same[0] + 2]])
        if labels is not None:
            first, second = labels[first], labels[second]
        raise InputError(
            f"mesh: {len(same)} cell(s) have the corners of another one, the first are {what} {first} and {second}; "
            "remove one of each two"
        )


def check_used(node_count: int, cells: Mapping[str, np.ndarray]) -> None:
    """Raise `InputError` when a node belongs to no cell: it would have neither stiffness nor mass."""
    used = np.zeros(node_count, dtype=bool)
    for nodes in cells.values():
        used[nodes.ravel()] = True
    if not used.all():
        first = int(np.flatnonzero(~used)[0])
        raise InputError(
            f"mesh: {int(np.sum(~used))} node(s) belong to no cell, the first is number {first}; remove them"
        )


def part_labels(node_count: int, cells: Mapping[str, np.ndarray]) -> np.ndarray:
    """Number of the connected part of each cell (all cells of all blocks), counted from 0."""
    from scipy.sparse import coo_matrix
    from scipy.sparse.csgraph import connected_components

    first = np.concatenate([np.repeat(c[:, 0], c.shape[1] - 1) for c in cells.values()])
    other = np.concatenate([c[:, 1:].ravel() for c in cells.values()])
    graph = coo_matrix((np.ones(len(first), dtype=np.int8), (first, other)), shape=(node_count, node_count))
    parts = connected_components(graph, directed=False)[1]
    return np.unique(np.concatenate([parts[c[:, 0]] for c in cells.values()]), return_inverse=True)[1]


def check_connected(node_count: int, cells: Mapping[str, np.ndarray]) -> None:
    """Raise `InputError` when the cells form more than one part: a body must be connected."""
    labels = part_labels(node_count, cells)
    count = int(labels.max()) + 1
    if count > 1:
        sizes = ", ".join(str(n) for n in np.bincount(labels))
        raise InputError(
            f"mesh: {count} disconnected parts with {sizes} cells; a body is one part: merge the coincident nodes, "
            "or read one part (mesh.read(..., part=0))"
        )


def check_structure(node_count: int, cells: Mapping[str, np.ndarray], structure: Structure) -> None:
    """Raise `InputError` for a node of no element, and for parts that no element connects."""
    from scipy.sparse import coo_matrix
    from scipy.sparse.csgraph import connected_components

    blocks = [*cells.values(), *structure.connections()]
    used = np.zeros(node_count, dtype=bool)
    used[np.concatenate([np.zeros(0, dtype=np.int64), *(b.ravel() for b in blocks)])] = True
    if not used.all():
        first = int(np.flatnonzero(~used)[0])
        raise InputError(
            f"mesh: {int(np.sum(~used))} node(s) belong to no solid, shell, beam, spring or rigid link, the first is "
            f"number {first}; remove them"
        )
    ends = [(np.repeat(b[:, 0], b.shape[1] - 1), b[:, 1:].ravel()) for b in blocks]
    first, other = (np.concatenate(part) for part in zip(*ends, strict=True))
    graph = coo_matrix((np.ones(len(first), dtype=np.int8), (first, other)), shape=(node_count, node_count))
    count, label = connected_components(graph, directed=False)
    if count > 1:
        sizes = ", ".join(str(n) for n in np.bincount(label))
        raise InputError(
            f"mesh: {count} disconnected parts with {sizes} nodes; a body is one part: merge the coincident nodes, or "
            "connect the parts by rigid links"
        )
