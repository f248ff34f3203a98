"""A mesh as a pyvista grid: the cells, and in addition the facets of all sets, with one array per set.

A cell array with the name of a set is 1 on the members of the set and 0 elsewhere, for cells and facets. Written as a
.vtu file and read again with `mesh.read` the arrays become the same sets.
"""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np

from warpffrf.model.errors import InputError
from warpffrf.model.mesh.structure import Beam, Shell

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
}
_VERTEX, _LINE = 1, 3


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

    blocks: list[tuple[int, np.ndarray]] = [(VTK_TYPES[kind], nodes) for kind, nodes in mesh.cells.items()]
    count = mesh.cell_count
    places: dict[str, list[np.ndarray]] = {name: [members] for name, members in mesh.cell_sets.items()}
    for beam in mesh.structure.of(Beam):
        blocks.append((_LINE, beam.nodes))
        count += len(beam.nodes)
    by_kind: dict[str, list[tuple[str | None, np.ndarray]]] = {}
    for shell in mesh.structure.of(Shell):
        by_kind.setdefault(shell.kind, []).append((None, shell.nodes))
    for name, facets in mesh.facet_sets.items():
        for kind, nodes in facets.blocks.items():
            by_kind.setdefault(kind, []).append((name, nodes))
    for kind, members in by_kind.items():
        rows = np.concatenate([nodes for _, nodes in members])
        _, first, place = np.unique(np.sort(rows, axis=1), axis=0, return_index=True, return_inverse=True)
        stops = np.cumsum([len(nodes) for _, nodes in members])[:-1]
        for (name, _), part in zip(members, np.split(place.ravel(), stops), strict=True):
            if name is not None:
                places.setdefault(name, []).append(count + part)
        blocks.append((VTK_TYPES[kind], rows[first]))
        count += len(first)
    if not blocks:
        blocks = [(_VERTEX, np.arange(len(mesh.points))[:, None])]
        count = len(mesh.points)
    connectivity = np.concatenate([np.insert(nodes, 0, nodes.shape[1], axis=1).ravel() for _, nodes in blocks])
    types = np.concatenate([np.full(len(nodes), number, dtype=np.uint8) for number, nodes in blocks])
    grid = pyvista.UnstructuredGrid(connectivity, types, np.array(mesh.points))
    for name, parts in places.items():
        marks = np.zeros(count, dtype=np.int32)
        marks[np.concatenate(parts)] = 1
        grid.cell_data[name] = marks
    grid.set_active_scalars(None)  # sets are equivalent: pictures in one colour, equal arrays in files
    return grid
