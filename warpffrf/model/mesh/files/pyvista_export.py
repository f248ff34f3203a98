"""A mesh as a pyvista grid: the cells, and in addition the facets of all sets, with one array per set.

A cell array with the name of a set is 1 on the members of the set and 0 elsewhere, for cells and facets. Written as a
.vtu file and read again with `mesh.read` the arrays become the same sets.
"""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np

from warpffrf.model.errors import InputError
from warpffrf.model.mesh.files.marked_blocks import LINE, marked_blocks

if TYPE_CHECKING:
    from warpffrf.model.mesh.data import Mesh

# numbers of vtkCellType.h
VTK_TYPES = {
    "hex8": 12,
    "hex20": 25,
    "hex27": 29,
    "wedge6": 13,
    "wedge15": 26,
    "tet4": 10,
    "tet10": 24,
    "quad4": 9,
    "quad8": 23,
    "quad9": 28,
    "tri3": 5,
    "tri6": 22,
    LINE: 3,
}
_VERTEX = 1


def to_pyvista(mesh: Mesh) -> Any:
    """`pyvista.UnstructuredGrid` of `mesh`: volume cells first, then beams as lines, then every shell
    and every facet that is in a set, once.

    Points in m. Raises `InputError` where pyvista is not installed. A mesh without cells and facets becomes a cloud of
    vertices.
    """
    try:
        import pyvista
    except ImportError as error:
        raise InputError("to_pyvista needs pyvista; install it with: pip install warpffrf[vtk]") from error

    parts, marks = marked_blocks(mesh)
    blocks = [(VTK_TYPES[kind], nodes) for kind, nodes in parts]
    if not blocks:
        blocks = [(_VERTEX, np.arange(len(mesh.points))[:, None])]
    connectivity = np.concatenate([np.insert(nodes, 0, nodes.shape[1], axis=1).ravel() for _, nodes in blocks])
    types = np.concatenate([np.full(len(nodes), number, dtype=np.uint8) for number, nodes in blocks])
    grid = pyvista.UnstructuredGrid(connectivity, types, np.array(mesh.points))
    for name, members in marks.items():
        grid.cell_data[name] = members
    grid.set_active_scalars(None)  # sets are equivalent: pictures in one colour, equal arrays in files
    return grid
