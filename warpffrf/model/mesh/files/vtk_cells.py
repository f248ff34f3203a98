"""Common parts of .vtu and .vtk files: types of cells, and sets given by integer arrays on cells.

An integer array of one component on the cells marks sets, separately on facets and on cells. One that holds only 0 and
1 there marks the set of that array's name. In any other one each value v defines the set `<array>_<v>`; 0 denotes no
set on facets, and is a value like others on cells, because every cell has a material. The same holds if an array is the
only one that divides the cells into 0 and 1: its zeros are the set `<array>_0`.
"""

from __future__ import annotations

from collections import Counter
from collections.abc import Callable, Mapping, Sequence
from pathlib import Path

import numpy as np

from warpffrf.model.errors import InputError
from warpffrf.model.files.paths import MOST_DIGITS, read_named
from warpffrf.model.mesh.files.raw_mesh import RawMesh

Array = np.ndarray

MOST_GROUPS = 256  # values of one array that are read as groups: more are numbers of cells or results
# of VTK's cell types: dimension, nodes, kind here, and for each node of that kind its place in VTK's order
TYPES: dict[int, tuple[int, int, str, list[int]]] = {
    5: (2, 3, "tri3", [*range(3)]),
    8: (2, 4, "quad4", [0, 1, 3, 2]),  # a pixel
    9: (2, 4, "quad4", [*range(4)]),
    10: (3, 4, "tet4", [*range(4)]),
    11: (3, 8, "hex8", [0, 1, 3, 2, 4, 5, 7, 6]),  # a voxel
    12: (3, 8, "hex8", [*range(8)]),
    13: (3, 6, "wedge6", [0, 2, 1, 3, 5, 4]),
    22: (2, 6, "tri6", [*range(6)]),
    23: (2, 8, "quad8", [*range(8)]),
    24: (3, 10, "tet10", [*range(10)]),
    25: (3, 20, "hex20", [*range(20)]),
    26: (3, 15, "wedge15", [*range(15)]),
    28: (2, 9, "quad9", [*range(9)]),
    29: (3, 27, "hex27", [*range(27)]),
}
# unsupported cells: dimension, nodes (None: any number), name
OTHERS: dict[int, tuple[int, int | None, str]] = {
    0: (0, 0, "empty cells"), 1: (0, 1, "points"), 2: (0, None, "points"), 3: (1, 2, "lines"), 4: (1, None, "lines"),
    6: (2, None, "triangle_strip"), 7: (2, None, "polygon"), 14: (3, 5, "pyramid"), 15: (3, 10, "penta_prism"),
    16: (3, 12, "hexa_prism"), 21: (1, 3, "lines"), 27: (3, 13, "pyramid13"), 30: (2, 6, "quadratic_linear_quad"),
    31: (3, 12, "wedge12"), 32: (3, 18, "wedge18"), 33: (3, 24, "hexahedron24"), 34: (2, 7, "triangle7"),
    35: (1, 4, "lines"), 36: (2, None, "quadratic_polygon"), 37: (3, 19, "pyramid19"),
    41: (3, None, "convex_point_set"), 42: (3, None, "polyhedron"),
    68: (1, None, "lines"), 69: (2, None, "lagrange_triangle"),
    70: (2, None, "lagrange_quadrilateral"), 71: (3, None, "lagrange_tetrahedron"),
    72: (3, None, "lagrange_hexahedron"), 73: (3, None, "lagrange_wedge"), 74: (3, None, "lagrange_pyramid"),
    75: (1, None, "lines"), 76: (2, None, "bezier_triangle"), 77: (2, None, "bezier_quadrilateral"),
    78: (3, None, "bezier_tetrahedron"), 79: (3, None, "bezier_hexahedron"), 80: (3, None, "bezier_wedge"),
    81: (3, None, "bezier_pyramid"),
}  # fmt: skip
SUPPORTED = "hexahedron, hexahedron20, hexahedron27, wedge, wedge15, tetra, tetra10"
GHOSTS = "vtkGhostType"  # an array that marks cells that are duplicated in other pieces or hidden


class Fault(Exception):
    """The reason why a file cannot be read."""


def guarded(path: Path, read: Callable[[str, bytes], RawMesh], cure: str) -> RawMesh:
    """Result of `read`, called with the name of the file for messages and its content. Raises `InputError` for a
    `Fault`, with the cure, for unsupported cells, and without volume cells."""
    label = f"mesh file {path.name}"
    try:
        return read(label, read_named(path, "mesh file"))
    except Fault as fault:
        raise InputError(f"{label}: cannot be read ({fault}); {cure}") from None


def whole(text: str, what: str) -> int:
    """A number that is not negative. Raises `Fault`."""
    word = text.strip()
    if not (word.isascii() and word.isdigit() and len(word) <= MOST_DIGITS):
        raise Fault(f"{what} is {word[:20]!r}, no whole number")
    return int(word)


def numbers(words: Sequence[str] | Sequence[bytes], real: bool, what: str) -> Array:
    """Words as reals or whole numbers. Raises `Fault`."""
    try:
        if any(("_" if isinstance(w, str) else b"_") in w for w in words):  # pyright: ignore[reportOperatorIssue]
            raise ValueError
        return np.array([float(w) for w in words]) if real else np.array([int(w) for w in words], dtype=np.int64)
    except (ValueError, OverflowError):
        raise Fault(f"{what} contains an entry that is not a number") from None


def raw_mesh(
    label: str,
    points: Array,
    connectivity: Array,
    offsets: Array,
    types: Array,
    arrays: Mapping[str, Array],
    unused: Sequence[str] = (),
) -> RawMesh:
    """The cells, `offsets` (c,) being where each ends in `connectivity`, with sets of the integer `arrays` (c, width);
    `unused`: other contents of the file, as text. Raises `InputError` for volume cells that are not supported."""
    sizes = np.diff(offsets, prepend=0)
    if len(types) != len(offsets) or np.any(sizes < 0) or (len(offsets) and offsets[-1] != len(connectivity)):
        raise InputError(f"{label}: cannot be read (its cells do not fit their nodes); export it again")
    if len(connectivity) and (connectivity.min() < 0 or connectivity.max() >= len(points)):
        raise InputError(f"{label}: a cell refers to a node that the file does not contain")
    ghosts = arrays.get(GHOSTS)
    if ghosts is not None and np.any(ghosts):
        raise InputError(
            f"{label}: {np.count_nonzero(ghosts)} cells are copies or hidden ({GHOSTS}); export it without"
        )
    places: list[Array] = []
    blocks: list[tuple[str, Array]] = []
    others: Counter[tuple[int, str]] = Counter()
    # a run of cells of one type is a block, as the cells of a kind are numbered in the order of the file
    starts = np.flatnonzero(np.diff(types, prepend=-1)) if len(types) else np.zeros(0, dtype=np.int64)
    by_kind: dict[str, list[tuple[Array, Array]]] = {}
    for first, stop in zip(starts, [*starts[1:], len(types)], strict=True):
        here = np.arange(first, stop)
        vtk = int(types[first])
        if vtk not in TYPES and vtk not in OTHERS:
            raise InputError(f"{label}: cell {first} is of VTK's type {vtk}, which is not supported; export it again")
        dim, count, name = (TYPES.get(vtk) or OTHERS[vtk])[:3]
        wrong = here[sizes[here] != count] if count is not None else here[:0]
        if len(wrong):
            raise InputError(
                f"{label}: cell {wrong[0]} of type {name} has {sizes[wrong[0]]} nodes, not {count}; export it again"
            )
        if vtk in OTHERS:
            others[dim, name] += len(here)
            continue
        nodes = connectivity[(offsets[here] - sizes[here])[:, None] + np.array(TYPES[vtk][3])]
        by_kind.setdefault(name, []).append((nodes, here))
    solid = [(name, count) for (dim, name), count in others.items() if dim == 3]
    if solid:
        hint = "; in Gmsh set Mesh.SecondOrderIncomplete = 1" if solid[0][0] == "wedge18" else ""
        listed = " and ".join(f"{count} {name}" for name, count in solid)
        raise InputError(f"{label}: {listed} cells are not supported; mesh with {SUPPORTED}{hint}")
    for name, parts in by_kind.items():
        blocks.append((name, np.concatenate([nodes for nodes, _ in parts])))
        places.append(np.concatenate([here for _, here in parts]))
    dims = [_dimension(name) for name, _ in blocks]
    if 3 not in dims:
        kinds = ", ".join(sorted({*by_kind, *(name for _, name in others)})) or "nothing"
        raise InputError(f"{label}: there are no volume cells (found {kinds}); export the 3-D mesh")
    notes: list[str] = []
    flat = [f"{count} {name}" for (dim, name), count in sorted(others.items()) if dim == 2]
    if flat:
        notes.append(f"facets of kinds that no cell has are left out: {', '.join(flat)}")
    thin = [f"{count} {name}" for (dim, name), count in sorted(others.items()) if dim < 2]
    if thin:
        notes.append(f"cells without volume are left out: {', '.join(thin)}")
    groups = _groups(dims, places, arrays, notes)
    if unused:
        notes.append(f"arrays that are not used: {', '.join(unused)}")
    return RawMesh(points, blocks, groups, notes=tuple(notes))


def _dimension(kind: str) -> int:
    return 3 if kind.startswith(("hex", "wedge", "tet")) else 2


def _groups(
    dims: list[int], places: list[Array], arrays: Mapping[str, Array], notes: list[str]
) -> dict[str, list[Array]]:
    groups: dict[str, list[Array]] = {}
    marking = {name: a for name, a in arrays.items() if name != GHOSTS}
    empty = np.zeros(0, dtype=np.int64)

    def values_of(array: Array, dim: int) -> Array:
        return np.unique(np.concatenate([empty, *(array[p] for d, p in zip(dims, places, strict=True) if d == dim)]))

    halves = [name for name, array in marking.items() if values_of(array, 3).tolist() == [0, 1]]
    for name, array in marking.items():
        for dim in (2, 3):
            values = values_of(array, dim)
            if len(values) > MOST_GROUPS:
                notes.append(f"array {name!r} has {len(values)} values on {'facets' if dim == 2 else 'cells'}: no sets")
                continue
            single = set(values.tolist()) <= {0, 1}
            lowest = 1 if dim == 2 or (single and halves != [name]) else None
            for value in values if lowest is None else values[values >= lowest]:
                label = name if single and value else f"{name}_{value}"
                parts = groups.setdefault(label, [empty for _ in places])
                for b, (d, place) in enumerate(zip(dims, places, strict=True)):
                    if d == dim:
                        parts[b] = np.flatnonzero(array[place] == value)
    return groups
