"""Meshes from files: Gmsh .msh and VTK .vtu, through meshio.

Named sets become facet sets:
- .msh: physical groups of surfaces, under their names (`surface_<tag>` where a group has none);
- .vtu: integer cell arrays. Facets marked 1 in an array that holds only 0 and 1 on facets form the set of that array's
  name; in any other integer array each positive value v marks the set `<array>_<v>`.

Facets are matched with the faces of the cells and take their node order, so that normals point outwards whatever the
file's order was.
"""

from __future__ import annotations

import logging
from pathlib import Path
from typing import Any

import numpy as np

from warpffrf.model.errors import InputError, unknown_name
from warpffrf.model.mesh.checks import part_labels
from warpffrf.model.mesh.data import Mesh
from warpffrf.model.mesh.elements import cell_kind, facet_kind
from warpffrf.model.mesh.facets import FacetSet

logger = logging.getLogger(__name__)

LENGTH_UNITS = {"m": 1.0, "cm": 1e-2, "mm": 1e-3, "um": 1e-6, "in": 0.0254, "ft": 0.3048}  # in m
SUFFIXES = {".msh": "gmsh", ".vtu": "vtu"}
_CELLS = {"hexahedron": "hex8", "hexahedron27": "hex27", "tetra": "tet4", "tetra10": "tet10"}
_FACETS = {"quad": "quad4", "quad9": "quad9", "triangle": "tri3", "triangle6": "tri6"}
_OTHER_VOLUMES = ("wedge", "pyramid", "hexahedron", "tetra", "polyhedron")  # by the beginning of meshio's cell names


def read(path: str | Path, *, length_unit: str, part: int | str | None = None) -> Mesh:
    """Read a mesh of hexahedra or tetrahedra, linear or quadratic, with named facet sets; lengths become metres.

    `length_unit` is the unit of the file's coordinates: one of m, cm, mm, um, in, ft. `part` picks one body of a file
    with several: the number of a connected part (0 is the one of the first cell) or the name of a volume group.
    Raises `InputError` when the file is missing or unreadable, has no (supported) volume cells, an inverted cell or
    more than one connected part.
    """
    path = Path(path)
    if length_unit not in LENGTH_UNITS:
        raise unknown_name("length unit", length_unit, LENGTH_UNITS)
    file = _load(path)
    kind, cells, blocks = _volume_cells(file, path)
    groups = _groups(file, path.suffix.lower())
    cells = _one_part(path, kind, cells, blocks, groups, part, len(file.points))

    used = np.unique(cells)
    new_number = np.full(len(file.points), -1, dtype=np.int64)
    new_number[used] = np.arange(len(used))
    cells = new_number[cells]
    points = np.asarray(file.points, dtype=np.float64)[used]
    if points.shape[1] != 3:
        raise InputError(f"mesh file {path.name}: points have {points.shape[1]} coordinates, a solid needs 3")
    facet_sets = _facet_sets(file, groups, kind, cells, new_number, path)
    mesh = Mesh(points * LENGTH_UNITS[length_unit], {kind: cells}, facet_sets, name=path.stem)
    try:
        mesh.check()
    except InputError as error:
        raise InputError(f"mesh file {path.name}: {error}") from None
    for warning in mesh.report().warnings:
        logger.warning("mesh file %s: %s", path.name, warning)
    return mesh


def _load(path: Path) -> Any:
    if not path.is_file():
        raise InputError(f"mesh file {str(path)!r} does not exist; check the path")
    if path.suffix.lower() not in SUFFIXES:
        raise InputError(f"mesh file {path.name}: unknown format {path.suffix!r}, known: {', '.join(SUFFIXES)}")
    import meshio

    try:
        return meshio.read(path, file_format=SUFFIXES[path.suffix.lower()])
    except (Exception, SystemExit) as error:  # meshio leaves with whatever its parsers raise, SystemExit among them
        reason = (
            f"not a valid {path.suffix} file" if isinstance(error, SystemExit) else f"{type(error).__name__}: {error}"
        )
        raise InputError(f"mesh file {path.name}: cannot be read ({reason}); export it again") from error


def _volume_cells(file: Any, path: Path) -> tuple[str, np.ndarray, dict[int, int]]:
    """Kind, cells (m, k) in file numbering, and for each block of the file they come from its first cell's number."""
    found: dict[str, list[int]] = {}
    for number, block in enumerate(file.cells):
        if block.type in _CELLS:
            found.setdefault(_CELLS[block.type], []).append(number)
        elif block.type.startswith(_OTHER_VOLUMES):
            raise InputError(
                f"mesh file {path.name}: {block.type} cells are not supported; mesh with {', '.join(_CELLS)}"
            )
    if not found:
        kinds = ", ".join(sorted({block.type for block in file.cells})) or "nothing"
        raise InputError(f"mesh file {path.name}: there are no volume cells (found {kinds}); export the 3-D mesh")
    if len(found) > 1:
        raise InputError(f"mesh file {path.name}: mixed volume cells {', '.join(found)}; mesh with one kind")
    ((kind, numbers),) = found.items()
    cells = np.concatenate([file.cells[b].data for b in numbers]).astype(np.int64)
    if cells.min() < 0 or cells.max() >= len(file.points):
        raise InputError(f"mesh file {path.name}: a cell refers to a node that the file does not hold")
    starts = np.cumsum([0] + [len(file.cells[b].data) for b in numbers[:-1]])
    return kind, cells, dict(zip(numbers, starts.tolist(), strict=True))


def _groups(file: Any, suffix: str) -> dict[str, list[np.ndarray]]:
    """Named groups: for each block of the file the numbers of its cells in the group."""
    groups: dict[str, list[np.ndarray]] = {}
    for name, parts in file.cell_sets.items():
        if not name.startswith("gmsh:"):
            empty = np.zeros(0, dtype=np.int64)
            groups[name] = [empty if p is None else np.asarray(p, dtype=np.int64) for p in parts]
    if suffix == ".msh":
        named = {(int(tag), int(dim)): name for name, (tag, dim) in file.field_data.items()}
        tags = file.cell_data.get("gmsh:physical", [])
        for block, values in enumerate(tags):
            dim = file.cells[block].dim
            for tag in np.unique(values[values > 0]):
                label = {2: "surface", 3: "volume"}.get(dim, "group")
                name = named.get((int(tag), dim), f"{label}_{int(tag)}")
                if name not in file.cell_sets:
                    _mark(groups, name, block, np.flatnonzero(values == tag), len(file.cells))
        return groups
    for name, arrays in file.cell_data.items():
        if not all(np.issubdtype(a.dtype, np.integer) and a.ndim == 1 for a in arrays):
            continue
        on_facets = [a for a, block in zip(arrays, file.cells, strict=True) if block.dim == 2]
        values = np.unique(np.concatenate(on_facets)) if on_facets else np.zeros(0, dtype=np.int64)
        single = set(values.tolist()) <= {0, 1}
        for block, array in enumerate(arrays):
            for value in np.unique(array[array > 0]):
                _mark(groups, name if single else f"{name}_{value}", block, np.flatnonzero(array == value), len(arrays))
    return groups


def _mark(groups: dict[str, list[np.ndarray]], name: str, block: int, members: np.ndarray, block_count: int) -> None:
    parts = groups.setdefault(name, [np.zeros(0, dtype=np.int64) for _ in range(block_count)])
    parts[block] = np.union1d(parts[block], members)


def _one_part(
    path: Path,
    kind: str,
    cells: np.ndarray,
    blocks: dict[int, int],
    groups: dict,
    part: int | str | None,
    node_count: int,
) -> np.ndarray:
    """The cells of the wanted part; all of them for None."""
    if part is None:
        return cells
    if isinstance(part, str):
        volumes = {name: g for name, g in groups.items() if any(len(g[b]) for b in blocks)}
        if part not in volumes:
            raise unknown_name(f"mesh file {path.name}: volume group", part, volumes)
        members = [volumes[part][number] + offset for number, offset in blocks.items()]
        return cells[np.concatenate(members)]
    labels = part_labels(node_count, {kind: cells})
    order = labels[np.sort(np.unique(labels, return_index=True)[1])]  # parts in the order of their first cells
    if not isinstance(part, int) or not 0 <= part < len(order):
        raise InputError(f"mesh file {path.name}: part {part!r} does not exist, it has {len(order)} connected part(s)")
    return cells[labels == order[part]]


def _facet_sets(
    file: Any, groups: dict, kind: str, cells: np.ndarray, new_number: np.ndarray, path: Path
) -> dict[str, FacetSet]:
    """Facet sets in the numbering of the kept nodes, each facet in the node order of the cell face it lies on."""
    ((facet_name, local),) = cell_kind(kind).faces.items()
    corner_count = facet_kind(facet_name).corner_count
    faces = cells[:, local].reshape(-1, local.shape[1])
    keys = np.sort(faces[:, :corner_count], axis=1)
    unique, first, count = np.unique(keys, axis=0, return_index=True, return_counts=True)
    place = {tuple(key): i for i, key in enumerate(unique.tolist())}
    sets: dict[str, FacetSet] = {}
    for name, parts in groups.items():
        rows: list[int] = []
        inside = 0
        for block, members in enumerate(parts):
            if not len(members) or _FACETS.get(file.cells[block].type) is None:
                continue
            nodes = new_number[file.cells[block].data[members][:, :corner_count]]
            for key in np.sort(nodes[np.all(nodes >= 0, axis=1)], axis=1).tolist():
                match = place.get(tuple(key))
                if match is None:
                    raise InputError(f"mesh file {path.name}: set {name!r} has a facet that is no face of a cell")
                if count[match] > 1:
                    inside += 1
                else:
                    rows.append(int(first[match]))
        if inside:
            logger.warning("mesh file %s: set %r: %d facets inside the volume are left out", path.name, name, inside)
        if rows:
            sets[name] = FacetSet({facet_name: faces[np.unique(rows)]})
    return sets
