"""A mesh of 27-node hexahedra cut into ten-node tetrahedra on the same nodes, six a cell, alike in every cell; and the
four-node tetrahedra between their corners."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from warpffrf.model.mesh import FacetSet, Mesh
from warpffrf.model.mesh.elements import cell_kind
from warpffrf.model.mesh.facets import outer_faces

# corners of the hexahedron in VTK order: six ways from corner 0 to corner 6 along its edges
SIX = ((0, 1, 2, 6), (0, 2, 3, 6), (0, 3, 7, 6), (0, 7, 4, 6), (0, 4, 5, 6), (0, 5, 1, 6))


def cut_into_tets(mesh: Mesh) -> Mesh:
    """The same body and facet sets in tet10; mid nodes are those of the edges, faces and middles of the hexahedra."""
    hexahedron = cell_kind("hex27").nodes
    shares = cell_kind("tet4").shape(cell_kind("tet10").nodes)[0]  # (10, 4) of the corners in the place of each node
    place = {tuple(np.round(x, 9)): k for k, x in enumerate(hexahedron)}
    nodes = [[place[tuple(np.round(x, 9))] for x in shares @ hexahedron[list(cut)]] for cut in SIX]
    cells = {"tet10": mesh.cells["hex27"][:, np.array(nodes)].reshape(-1, 10)}
    outer = outer_faces(cells)
    sets = {}
    for name, facets in mesh.facet_sets.items():
        on = np.isin(np.arange(len(mesh.points)), facets.node_set)
        sets[name] = FacetSet({kind: block[np.all(on[block], axis=1)] for kind, block in outer.blocks.items()})
    return replace(mesh, cells=cells, facet_sets=sets)


def linear_tets(mesh: Mesh) -> Mesh:
    """The tet4 between the corners of the tet10 of `mesh`, with its facet sets."""
    corners = mesh.cells["tet10"][:, :4]
    kept, cells = np.unique(corners, return_inverse=True)
    number = np.full(len(mesh.points), -1)
    number[kept] = np.arange(len(kept))
    sets = {name: FacetSet({"tri3": number[facets.blocks["tri6"][:, :3]]}) for name, facets in mesh.facet_sets.items()}
    return replace(mesh, points=mesh.points[kept], cells={"tet4": cells.reshape(-1, 4)}, facet_sets=sets)
