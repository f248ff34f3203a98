"""MED files (.med) of Salome and Code_Aster: nodes, elements and their groups, an HDF5 file.

    ENS_MAA/<mesh>/<time>/NOE      coordinates COO, one component after the other; family of each node FAM
    ENS_MAA/<mesh>/<time>/MAI/H20  nodes NOD of each kind of element, one place after the other; family FAM
    FAS/<mesh>/NOEUD, ELEME        families: the groups (GRO/NOM) that their members belong to

Groups of elements become cell and facet sets, groups of nodes the outer facets all of whose nodes they contain. Cells
of MED have the other orientation than those of VTK; of programs that write the latter they are corrected with a note.
meshio is not used: HDF5 may read a damaged file for ever, so that sizes and links are checked before.
"""

from __future__ import annotations

from collections import Counter
from pathlib import Path
from typing import Any

import numpy as np

from warpffrf.model.errors import InputError
from warpffrf.model.files.hdf5_parts import member, names, probe, read
from warpffrf.model.files.paths import read_named
from warpffrf.model.mesh.elements import CELL_KINDS
from warpffrf.model.mesh.files.raw_mesh import RawMesh, listed_counts, mirror

Array = np.ndarray

_KINDS = {
    "TE4": ("tet4", 4), "T10": ("tet10", 10), "PE6": ("wedge6", 6), "P15": ("wedge15", 15), "HE8": ("hex8", 8),
    "H20": ("hex20", 20), "H27": ("hex27", 27), "TR3": ("tri3", 3), "TR6": ("tri6", 6), "QU4": ("quad4", 4),
    "QU8": ("quad8", 8), "QU9": ("quad9", 9),
}  # fmt: skip
_REFUSED = {"PY5": "pyramids", "P13": "pyramids", "P18": "wedges of 18 nodes"}
_NAME_BYTES = 80
_HEAD = b"\x89HDF\r\n\x1a\n"


def read_med(path: Path) -> RawMesh:
    """Contents of a MED file with one mesh. Raises `InputError` for a damaged one, and for unsupported volume cells."""
    import h5py

    label = f"mesh file {path.name}"
    cure = "export it again"
    if not read_named(path, "mesh file").startswith(_HEAD):
        raise InputError(f"{label}: it is no MED file (HDF5); {cure}")
    probe(path, f"{label}: it", cure)
    try:
        with h5py.File(path, "r") as file:
            return _raw(file)
    except InputError as error:
        text = str(error)
    except (OSError, KeyError, ValueError, TypeError, RuntimeError, IndexError) as error:
        text = " ".join(str(error).split())
    raise InputError(f"{label}: {text}; {cure}")


def _raw(file: Any) -> RawMesh:
    meshes = names(file, "ENS_MAA")
    if len(meshes) != 1:
        raise InputError(f"it holds {len(meshes)} meshes ({', '.join(meshes)[:200]}), not one")
    notes: list[str] = []
    at = f"ENS_MAA/{meshes[0]}"
    dimension = int(member(file, at).attrs["ESP"])
    steps = [""] if "NOE" in names(file, at) else [f"/{name}" for name in names(file, at)]
    if not steps or dimension != 3:
        raise InputError(f"its mesh has {dimension} dimensions and {len(steps)} time steps; a solid body has 3 and 1")
    if len(steps) > 1:
        notes.append(f"the first of {len(steps)} time steps of the mesh is read")
    at += steps[0]
    coordinates = read(file, f"{at}/NOE/COO").astype(float).ravel()
    if len(coordinates) % 3 or not np.isfinite(coordinates).all():
        raise InputError("NOE/COO: three finite coordinates per node are needed")
    points = coordinates.reshape(3, -1).T.copy()

    families = {**_families(file, f"FAS/{meshes[0]}/ELEME"), **_families(file, f"FAS/{meshes[0]}/NOEUD")}
    blocks, of_blocks, labels = [], [], []
    left: Counter[str] = Counter()
    start = 0
    for name in names(file, f"{at}/MAI"):
        cells = f"{at}/MAI/{name}"
        nodes = _whole(read(file, f"{cells}/NOD").ravel(), f"{name}/NOD")
        if name in _REFUSED:
            raise InputError(f"{_REFUSED[name]} are not supported; mesh with tetrahedra, wedges and hexahedra")
        if name not in _KINDS:
            left[name] += len(read(file, f"{cells}/FAM")) if "FAM" in names(file, cells) else 1
            continue
        kind, width = _KINDS[name]
        if len(nodes) % width or (len(nodes) and not 1 <= nodes.min() <= nodes.max() <= len(points)):
            raise InputError(f"{name}/NOD: its numbers are not those of {width} nodes per element")
        order = mirror(kind) if kind in CELL_KINDS else [*range(width)]
        blocks.append((kind, nodes.reshape(width, -1).T[:, order] - 1))
        count = len(nodes) // width
        of_blocks.append(_of_family(file, cells, count))
        labels.append(
            _whole(read(file, f"{cells}/NUM"), f"{name}/NUM")
            if "NUM" in names(file, cells)
            else start + 1 + np.arange(count)
        )
        if len(labels[-1]) != count:
            raise InputError(f"{name}/NUM: it has {len(labels[-1])} numbers, not {count}")
        start += count
    groups: dict[str, list[Array]] = {}
    node_groups: dict[str, Array] = {}
    of_nodes = _of_family(file, f"{at}/NOE", len(points))
    for group in dict.fromkeys(name for found in families.values() for name in found):
        numbers = [number for number, found in families.items() if group in found]
        members = [np.flatnonzero(np.isin(of, numbers)) for of in of_blocks]
        nodes = np.flatnonzero(np.isin(of_nodes, [n for n in numbers if n > 0]))
        if any(map(len, members)):
            groups[group] = members
        if len(nodes):
            node_groups[group] = nodes
        if not any(map(len, members)) and not len(nodes):
            notes.append(f"group {group!r} is empty, or of elements that are not used")
    if left:
        notes.append(f"elements that are not used: {listed_counts(left)}")
    if fields := names(file, "CHA"):
        notes.append(f"results that are not used: {', '.join(fields)[:200]}")
    more = {"stray_facets": True, "either_hand": True, "labels": labels, "node_groups": node_groups}
    return RawMesh(points, blocks, groups, {}, tuple(notes), **more)


def _whole(numbers: Array, what: str) -> Array:
    if numbers.dtype.kind not in "iu" or numbers.ndim != 1:
        raise InputError(f"{what}: whole numbers are needed")
    return numbers.astype(np.int64)


def _of_family(file: Any, at: str, count: int) -> Array:
    """The family of each node or element; 0, no group, where the file gives none."""
    if "FAM" not in names(file, at):
        return np.zeros(count, dtype=np.int64)
    found = _whole(read(file, f"{at}/FAM"), f"{at}/FAM")
    if len(found) != count:
        raise InputError(f"{at}/FAM: it has {len(found)} numbers, not {count}")
    return found


def _families(file: Any, at: str) -> dict[int, list[str]]:
    """{number: names of the groups} of the families."""
    found = {}
    for name in names(file, at):
        if "GRO" not in names(file, f"{at}/{name}"):
            continue
        letters = read(file, f"{at}/{name}/GRO/NOM")
        text = np.ascontiguousarray(letters).tobytes()
        if len(text) % _NAME_BYTES:
            raise InputError(f"{at}/{name}: names of groups have {_NAME_BYTES} characters")
        parts = [text[k : k + _NAME_BYTES] for k in range(0, len(text), _NAME_BYTES)]
        number = int(member(file, f"{at}/{name}").attrs["NUM"])
        found[number] = [part.split(b"\0")[0].decode("utf-8", "replace").strip() for part in parts]
    return found
