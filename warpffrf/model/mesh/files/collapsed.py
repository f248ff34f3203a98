"""Cells with repeated nodes: a hexahedron or wedge whose edges are collapsed is the wedge or tetrahedron that is left.

Programs without wedges write them so: `1, 2, 3, 3, 4, 5, 6, 6` as eight nodes. The faces of the cell, without repeated
corners, are those of what is left: two triangles and three quadrilaterals a wedge, four triangles a tetrahedron. Middle
nodes go with their edges.
"""

from __future__ import annotations

from collections.abc import Mapping

import numpy as np

from warpffrf.model.mesh.elements import cell_kind, facet_kind

Array = np.ndarray
_QUADRATIC = {"wedge6": "wedge15", "tet4": "tet10"}


def repeated(nodes: Array) -> Array:
    """Which cells (m,) of nodes (m, k) have a node twice."""
    ordered = np.sort(nodes, axis=1)
    return np.any(ordered[:, 1:] == ordered[:, :-1], axis=1)


def left_over(kind: str, nodes: Array) -> tuple[str, list[int]] | None:
    """The kind and nodes of what is left of one cell (k,) with repeated corners; None where that is no cell of ours."""
    cell = cell_kind(kind)
    if kind == "hex27":
        return None
    faces = []
    for name, table in cell.faces.items():
        for local in table[:, : facet_kind(name).corner_count]:
            loop = [int(nodes[a]) for a in local]
            loop = [a for i, a in enumerate(loop) if a != loop[i - 1]]
            if len(set(loop)) != len(loop):
                return None  # folded onto itself
            if len(loop) > 2:
                faces.append(loop)
    triangles = [face for face in faces if len(face) == 3]
    corners = {a for face in faces for a in face}
    if len(triangles) == 4 and len(faces) == 4 and len(corners) == 4:
        a, b, c = triangles[0]
        order = [a, c, b, *(corners - {a, b, c})]
        found = "tet4"
    elif len(triangles) == 2 and len(faces) == 5 and len(corners) == 6:
        bottom = triangles[0][::-1]  # its normal points into the wedge
        beside = {frozenset(pair) for face in faces for pair in zip(face, face[1:] + face[:1], strict=True)}
        top = [[b for b in triangles[1] if frozenset((a, b)) in beside] for a in bottom]
        if [len(t) for t in top] != [1, 1, 1]:
            return None
        order, found = [*bottom, *(t[0] for t in top)], "wedge6"
    else:
        return None
    if len(nodes) == cell.corner_count:
        return found, order
    middle: dict[frozenset[int], int] = {}
    at = {tuple(x): int(a) for x, a in zip(cell.nodes.tolist(), nodes, strict=True)}
    for i in range(cell.corner_count):
        for j in range(i):
            edge = at.get(tuple(0.5 * (cell.nodes[i] + cell.nodes[j])))
            if edge is not None and nodes[i] != nodes[j]:
                if middle.setdefault(frozenset((int(nodes[i]), int(nodes[j]))), edge) != edge:
                    return None  # one edge with two middles
    full = cell_kind(_QUADRATIC[found])
    pairs = [np.flatnonzero(np.isin(np.arange(full.corner_count), _ends(full, x))) for x in full.nodes[len(order) :]]
    try:
        return full.name, order + [middle[frozenset(order[i] for i in pair)] for pair in pairs]
    except KeyError:
        return None


def _ends(cell, x: Array) -> list[int]:
    """The two corners whose mean is the place `x` of a middle node."""
    n = cell.corner_count
    return next([i, j] for i in range(n) for j in range(i) if np.array_equal(0.5 * (cell.nodes[i] + cell.nodes[j]), x))


def face_numbers(
    faces: tuple[tuple[str, Array], ...], nodes: Array, new_faces: tuple[tuple[str, Array], ...], new_nodes: Array
) -> Mapping[int, int]:
    """Which face of what is left (from 1) each face (from 1) of the collapsed cell has become; none where it is gone.
    `faces` as `inp.cells.faces_of` gives them."""

    def corners(face: tuple[str, Array], at: Array) -> frozenset[int]:
        return frozenset(int(at[a]) for a in face[1][: facet_kind(face[0]).corner_count])

    left = {corners(face, new_nodes): number for number, face in enumerate(new_faces, start=1)}
    became = {number: left.get(corners(face, nodes)) for number, face in enumerate(faces, start=1)}
    return {number: new for number, new in became.items() if new is not None}
