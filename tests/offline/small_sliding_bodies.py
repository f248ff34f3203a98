"""Meshes with faces that lie on each other, for the tests of small-sliding contacts."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace

import numpy as np

from warpffrf.model.mesh import Mesh, grid
from warpffrf.model.mesh.elements import cell_kind
from warpffrf.model.mesh.facets import FacetSet

Array = np.ndarray
TETS = ((0, 1, 2, 6), (0, 2, 3, 6), (0, 3, 7, 6), (0, 7, 4, 6), (0, 4, 5, 6), (0, 5, 1, 6))  # of a hexahedron


def moved(mesh: Mesh, place: Callable[[Array], Array]) -> Mesh:
    """The mesh with its points (n, 3) where `place` puts them."""
    return replace(mesh, points=place(mesh.points))


def together(**parts: Mesh) -> Mesh:
    """Meshes side by side in one, without a node in common; their facet sets as "part set"."""
    points, cells, sets, start = [], {}, {}, 0
    for part, mesh in parts.items():
        points.append(mesh.points)
        for kind, nodes in mesh.cells.items():
            cells.setdefault(kind, []).append(nodes + start)
        for name, facets in mesh.facet_sets.items():
            sets[f"{part} {name}"] = FacetSet({kind: nodes + start for kind, nodes in facets.blocks.items()})
        start += len(mesh.points)
    return Mesh(np.concatenate(points), {kind: np.concatenate(blocks) for kind, blocks in cells.items()}, sets)


def as_kind(mesh: Mesh, kind: str) -> Mesh:
    """A mesh of hex27 cells as hex8, hex20, tet4 or tet10, with the outer facets of each set in the same places."""
    whole = mesh.cells["hex27"]
    middles: dict[tuple[int, int], int] = {}
    for (a, b), node in _edges(whole, "hex27"):
        middles[a, b] = middles[b, a] = node
    points = mesh.points
    if kind == "hex27":
        cells = whole
    elif kind.startswith("hex"):
        cells = whole[:, : len(cell_kind(kind).nodes)]
    else:
        cells = np.concatenate([whole[:, list(tet)] for tet in TETS])
        if kind == "tet10":
            added, found = [], []
            for tet in cells.tolist():
                row = list(tet)
                for a, b in ((0, 1), (1, 2), (2, 0), (0, 3), (1, 3), (2, 3)):
                    pair = (tet[a], tet[b])
                    if pair not in middles:
                        middles[pair] = middles[pair[::-1]] = len(points) + len(added)
                        added.append(0.5 * (points[pair[0]] + points[pair[1]]))
                    row.append(middles[pair])
                found.append(row)
            cells = np.array(found)
            points = np.concatenate([points, np.array(added).reshape(-1, 3)])
    used, cells = np.unique(cells, return_inverse=True)
    bare = Mesh(points[used], {kind: cells.reshape(-1, len(cell_kind(kind).nodes))})
    outer = bare.outer_facets()
    centers = outer.centers(bare.points)
    sets = {}
    for name, facets in mesh.facet_sets.items():
        on = facets.node_set
        corners = {tuple(x) for x in np.round(mesh.points[on], 9)}
        mask = np.concatenate(
            [
                np.array([all(tuple(np.round(x, 9)) in corners for x in bare.points[f]) for f in nodes])
                for nodes in outer.corners.values()
            ]
        )
        assert mask.any() and len(mask) == len(centers)
        sets[name] = outer.kept(mask)
    return replace(bare, facet_sets=sets)


def _edges(cells: Array, kind: str) -> list[tuple[tuple[int, int], int]]:
    nodes = cell_kind(kind).nodes
    found = []
    for i in range(8):
        for j in range(i):
            if np.abs(nodes[i] - nodes[j]).sum() == 2.0:
                (middle,) = np.flatnonzero(np.abs(nodes - 0.5 * (nodes[i] + nodes[j])).max(axis=1) < 1e-12)
                found += [((int(c[i]), int(c[j])), int(c[middle])) for c in cells]
    return found


def slit_body(order: int = 1, along: int = 6, gap: float = 0.5e-3) -> Mesh:
    """Two leaves, joined at x < 10 mm, that face each other across a slit: facet sets `low` (looks up) and `high`."""
    x = np.concatenate([[0.0], np.linspace(0.01, 0.06, along)])
    y = np.linspace(0.0, 0.02, 3)
    z = np.array([0.0, 2.5e-3, 5e-3, 5e-3 + gap, 7.5e-3 + gap, 1e-2 + gap])
    filled = np.ones((along, 2, 5), dtype=bool)
    filled[x[1:] > 0.0101, :, 2] = False
    mesh = grid(x, y, z, filled=filled, order=order)
    mesh = mesh.select_plane("low", point=(0, 0, 5e-3), normal=(0, 0, 1))
    return mesh.select_plane("high", point=(0, 0, 5e-3 + gap), normal=(0, 0, -1))
