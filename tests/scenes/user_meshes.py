"""Meshes as supplied by users, made from those of the package: other elements on the same nodes, and a file."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import numpy as np

from warpffrf.model.mesh import FacetSet, Mesh, read
from warpffrf.model.mesh.elements import cell_kind
from warpffrf.model.mesh.facets import outer_faces

Array = np.ndarray
GMSH_ROLLER = Path(__file__).parents[2] / "demos" / "data" / "roller_4mm.msh"
# corners of the hexahedron in VTK order: six ways from corner 0 to corner 6 along its edges
SIX = ((0, 1, 2, 6), (0, 2, 3, 6), (0, 3, 7, 6), (0, 7, 4, 6), (0, 4, 5, 6), (0, 5, 1, 6))


def gmsh_roller() -> Mesh:
    """The roller (R 50, bore 15, width 20 mm) of quadratic tetrahedra of 4 mm supplied with the demos."""
    return read(GMSH_ROLLER, length_unit="mm")


def cut_into_tets(mesh: Mesh) -> Mesh:
    """The body of hex27 and its facet sets in tet10, six per cell, equal in every cell; mid nodes are of the edges,
    faces and middles of the hexahedra."""
    hexahedron = cell_kind("hex27").nodes
    shares = cell_kind("tet4").shape(cell_kind("tet10").nodes)[0]  # (10, 4) weights of the corners at each node
    place = {tuple(np.round(x, 9)): k for k, x in enumerate(hexahedron)}
    nodes = [[place[tuple(np.round(x, 9))] for x in shares @ hexahedron[list(cut)]] for cut in SIX]
    return _of_cells(mesh, {"tet10": mesh.cells["hex27"][:, np.array(nodes)].reshape(-1, 10)})


def serendipity(mesh: Mesh) -> Mesh:
    """The body of hex27 in hex20: without the nodes in the middles of faces and cells."""
    return _of_cells(mesh, {"hex20": mesh.cells["hex27"][:, :20]})


def straight(mesh: Mesh) -> Mesh:
    """The body of tet10 in tet4: its corners."""
    return _of_cells(mesh, {"tet4": mesh.cells["tet10"][:, :4]})


def _of_cells(mesh: Mesh, cells: dict[str, Array]) -> Mesh:
    """`mesh` with other cells on its nodes, without unused ones, and facet sets at the same positions."""
    used = np.unique(np.concatenate([c.ravel() for c in cells.values()]))
    number = np.full(len(mesh.points), -1)
    number[used] = np.arange(len(used))
    cells = {kind: number[nodes] for kind, nodes in cells.items()}
    outer = outer_faces(cells)
    sets = {}
    for name, facets in mesh.facet_sets.items():
        on = np.isin(used, facets.node_set)
        sets[name] = FacetSet({kind: block[np.all(on[block], axis=1)] for kind, block in outer.blocks.items()})
    return replace(mesh, points=mesh.points[used], cells=cells, facet_sets=sets)
