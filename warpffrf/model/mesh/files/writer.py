"""A mesh as a file for other programs, by meshio: VTK `.vtu`, and `.inp` of Abaqus and CalculiX. Lengths in m.

A .vtu has the facets of sets as cells too, and an array of 0 and 1 for each set. An .inp has the volume cells, an ELSET
for each cell set and an NSET of the nodes of each facet set. Both are read again by `mesh.read` with the same sets.
"""

from __future__ import annotations

import tempfile
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from warpffrf.model.errors import InputError
from warpffrf.model.files.paths import checked_output_path
from warpffrf.model.mesh.files.marked_blocks import LINE, marked_blocks

if TYPE_CHECKING:
    from warpffrf.model.mesh.data import Mesh

NAMES = {  # of kinds in meshio
    "hex8": "hexahedron", "hex20": "hexahedron20", "hex27": "hexahedron27", "wedge6": "wedge", "wedge15": "wedge15",
    "tet4": "tetra", "tet10": "tetra10", "quad4": "quad", "quad8": "quad8", "quad9": "quad9", "tri3": "triangle",
    "tri6": "triangle6", LINE: "line",
}  # fmt: skip
SUFFIXES = (".vtu", ".inp")
NO_DECK = ("hex27",)  # kinds that a deck does not have


def write(mesh: Mesh, path: str | Path, *, overwrite: bool = False) -> Path:
    """Write `mesh` to the file `path`, see the module. Raises `InputError` for another suffix, for what such a file
    cannot hold, and for a file that exists unless `overwrite` is set."""
    import meshio

    target = checked_output_path(path, "mesh.write", overwrite=overwrite)
    suffix = target.suffix.lower()
    if suffix not in SUFFIXES:
        raise InputError(f"mesh.write: unknown format {target.suffix!r}, known: {', '.join(SUFFIXES)}")
    if not mesh.cells:
        raise InputError(f"mesh.write: mesh {mesh.name!r} has no volume cells")
    points: Any = np.array(mesh.points)
    if suffix == ".vtu":
        blocks, marks = marked_blocks(mesh)
        stops = np.cumsum([len(nodes) for _, nodes in blocks])[:-1]
        data: dict[str, Any] = {name: np.split(members, stops) for name, members in marks.items()}
        found = meshio.Mesh(points, [(NAMES[kind], nodes) for kind, nodes in blocks], cell_data=data)
        return _written(target, found, "<!-- written by warpffrf -->")
    if wrong := [kind for kind in mesh.cells if kind in NO_DECK] or [type(p).__name__ for p in mesh.structure.parts]:
        raise InputError(f"mesh.write: an .inp written here has no {wrong[0]}; write a .vtu")
    starts = np.cumsum([0, *(len(nodes) for nodes in mesh.cells.values())])
    sets: dict[str, Any] = {
        name: [members[(members >= a) & (members < b)] - a for a, b in zip(starts, starts[1:], strict=False)]
        for name, members in mesh.cell_sets.items()
    }
    facets: dict[str, Any] = {name: each.node_set for name, each in mesh.facet_sets.items()}
    cells: list[Any] = [(NAMES[kind], nodes) for kind, nodes in mesh.cells.items()]
    return _written(target, meshio.Mesh(points, cells, point_sets=facets, cell_sets=sets), "** written by warpffrf")


def _written(target: Path, found: Any, sign: str) -> Path:
    """Write a mesh of meshio with a line that says who wrote the file, by which `overwrite` knows it."""
    with tempfile.TemporaryDirectory(dir=target.parent) as folder:
        file = Path(folder) / target.name
        found.write(file)
        first, rest = file.read_bytes().split(b"\n", 1)
        file.write_bytes(b"\n".join([first, sign.encode(), rest]))
        file.replace(target)
    return target
