"""Gmsh and VTK files through meshio.

Named groups:
- Gmsh: physical groups, under their names (`surface_<tag>`, `volume_<tag>` where a group has none);
- VTK: integer cell arrays, on facets and on cells apart. An array that holds only 0 and 1 there marks the group of that
  array's name. In any other one each value v makes the group `<array>_<v>`; 0 stands for no group on facets, and is a
  value like others on cells, because every cell is of some material.
"""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np

from warpffrf.model.errors import InputError
from warpffrf.model.mesh.gmsh_lines import check_lines
from warpffrf.model.mesh.raw_mesh import RawMesh

FORMATS = {".msh": "gmsh", ".vtu": "vtu", ".vtk": "vtk"}
MOST_GROUPS = 256  # values of one array that are taken for groups: with more they are numbers of cells or results
_KINDS = {
    "hexahedron": "hex8",
    "hexahedron20": "hex20",
    "hexahedron27": "hex27",
    "wedge": "wedge6",
    "wedge15": "wedge15",
    "tetra": "tet4",
    "tetra10": "tet10",
    "quad": "quad4",
    "quad8": "quad8",
    "quad9": "quad9",
    "triangle": "tri3",
    "triangle6": "tri6",
}
_COMPLETE = {"wedge18"}  # quadratic with nodes in the middle of faces; Gmsh makes them unless told

Array = np.ndarray
Groups = dict[str, list[Array]]


def read_meshio(path: Path) -> RawMesh:
    """What a .msh, .vtu or .vtk file holds. Raises `InputError` for a file that cannot be read, has no volume cells, or
    has some of a kind that is not supported."""
    file = _load(path)
    points = np.asarray(file.points, dtype=np.float64)
    if points.ndim != 2 or points.shape[1] != 3:
        raise InputError(f"mesh file {path.name}: points have {points.shape[-1]} coordinates, a solid needs 3")
    supported = [name for name, kind in _KINDS.items() if kind.startswith(("hex", "wedge", "tet"))]
    kept: list[int] = []
    others: set[str] = set()
    for number, block in enumerate(file.cells):
        if block.type in _KINDS:
            kept.append(number)
        elif block.dim == 3:
            hint = "; in Gmsh set Mesh.SecondOrderIncomplete = 1" if block.type in _COMPLETE else ""
            raise InputError(
                f"mesh file {path.name}: {block.type} cells are not supported; mesh with {', '.join(supported)}{hint}"
            )
        elif block.dim == 2:
            others.add(block.type)
    if not any(file.cells[b].dim == 3 for b in kept):
        kinds = ", ".join(sorted({block.type for block in file.cells})) or "nothing"
        hint = " (Gmsh saves only what is in a physical group)" if path.suffix.lower() == ".msh" else ""
        raise InputError(f"mesh file {path.name}: there are no volume cells (found {kinds}); export the 3-D mesh{hint}")
    notes: list[str] = []
    if others:
        notes.append(f"facets of kinds that no cell has are left out: {', '.join(sorted(others))}")
    groups = _physical_groups(file) if path.suffix.lower() == ".msh" else _marked_groups(file, notes)
    blocks = [(_KINDS[file.cells[b].type], np.asarray(file.cells[b].data, dtype=np.int64)) for b in kept]
    return RawMesh(points, blocks, {name: [parts[b] for b in kept] for name, parts in groups.items()}, {}, tuple(notes))


def meshio_package() -> Any:
    """The package. Raises InputError where it cannot be imported, as its versions before 5.3.5 beside NumPy 2."""
    try:
        import meshio
        from meshio._mesh import topological_dimension
    except (ImportError, AttributeError) as error:
        raise InputError(
            f"files of meshes need the package meshio, which cannot be imported ({type(error).__name__}: {error}); "
            'pip install "meshio>=5.3.5"'
        ) from error
    # meshio 5.3 knows wedge15 but for its dimension, without which no block of it can be made
    topological_dimension.setdefault("wedge15", 3)
    return meshio


def _load(path: Path) -> Any:
    meshio = meshio_package()
    suffix = path.suffix.lower()
    if suffix == ".vtk":
        _refuse_misread(path)
    elif suffix == ".msh":
        check_lines(path)
    try:
        # the format's own reader: meshio.read prints the reason and leaves the program
        return getattr(meshio, FORMATS[suffix]).read(str(path))
    except Exception as error:  # meshio's parsers raise whatever they stumble over
        cure = "save it as .vtu" if suffix == ".vtk" else "export it again"
        reason = f"{type(error).__name__}: {error}".rstrip(": ")
        raise InputError(f"mesh file {path.name}: cannot be read ({reason}); {cure}") from error


def _refuse_misread(path: Path) -> None:
    """Raise `InputError` for a binary .vtk file with data: meshio 5.3 takes its 32-bit integers for 64-bit ones."""
    content = path.read_bytes()
    if content.split(b"\n", 3)[2:3] == [b"BINARY"] and any(w in content for w in (b"CELL_DATA", b"POINT_DATA")):
        raise InputError(
            f"mesh file {path.name}: data of binary .vtk files cannot be read; save it as .vtu, or as ASCII"
        )


def _physical_groups(file: Any) -> Groups:
    groups = _file_sets(file)
    named = {(int(tag), int(dim)): name for name, (tag, dim) in file.field_data.items()}
    for block, values in enumerate(file.cell_data.get("gmsh:physical", [])):
        dim = file.cells[block].dim
        for tag in np.unique(values[values > 0]):
            label = {2: "surface", 3: "volume"}.get(dim, "group")
            name = named.get((int(tag), dim), f"{label}_{int(tag)}")
            if name not in file.cell_sets:
                _mark(groups, name, block, np.flatnonzero(values == tag), len(file.cells))
    return groups


def _marked_groups(file: Any, notes: list[str]) -> Groups:
    groups = _file_sets(file)
    for name, arrays in file.cell_data.items():
        if not all(np.issubdtype(a.dtype, np.integer) and a.ndim == 1 for a in arrays):
            continue
        for dim in (2, 3):
            here = [b for b, block in enumerate(file.cells) if block.dim == dim]
            values = np.unique(np.concatenate([np.zeros(0, dtype=np.int64), *(arrays[b] for b in here)]))
            if len(values) > MOST_GROUPS:
                notes.append(f"array {name!r} has {len(values)} values on {'facets' if dim == 2 else 'cells'}: no sets")
                continue
            single = set(values.tolist()) <= {0, 1}
            lowest = 1 if single or dim == 2 else 0
            for b in here:
                for value in values[values >= lowest]:
                    label = name if single else f"{name}_{value}"
                    _mark(groups, label, b, np.flatnonzero(arrays[b] == value), len(file.cells))
    return groups


def _file_sets(file: Any) -> Groups:
    empty = np.zeros(0, dtype=np.int64)
    return {
        name: [empty if p is None else np.asarray(p, dtype=np.int64) for p in parts]
        for name, parts in file.cell_sets.items()
        if not name.startswith("gmsh:")
    }


def _mark(groups: Groups, name: str, block: int, members: Array, block_count: int) -> None:
    parts = groups.setdefault(name, [np.zeros(0, dtype=np.int64) for _ in range(block_count)])
    parts[block] = np.union1d(parts[block], members)
