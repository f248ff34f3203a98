"""Conversion of the contents of a mesh file to a `Mesh`: one part, its nodes, facet sets on its faces, cell sets.

Facets are matched with the faces of the cells by their corners and take the faces' node order, so that normals point
outwards whatever the file's order was. A wedge whose triangles run the other way (VTK's documentation and meshio
disagree with VTK and everyone else about its first triangle) is reversed, other cells only where the format does not
define their orientation. Cells with repeated nodes become the cells that remain.

Units of files without units: lengths, and the corresponding consistent system of stress and density.

With newton and second, the unit of length defines the others:

    m:  N, kg, s   stress Pa = N/m2,    density kg/m3
    mm: N, t, s    stress MPa = N/mm2,  density t/mm3 = 1e12 kg/m3

For other units of length there is no usual system, and the materials of a file are not used.

Collapsed. Cells with repeated nodes: a hexahedron or wedge whose edges are collapsed is the remaining wedge or
tetrahedron.

Programs without wedges write them in this form: `1, 2, 3, 3, 4, 5, 6, 6` as eight nodes. The faces of the cell, without
repeated corners, are those of the remaining cell: two triangles and three quadrilaterals form a wedge, four triangles a
tetrahedron. Mid nodes follow their edges.
"""

from __future__ import annotations

import logging
from collections import Counter
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field, replace
from typing import Any

import numpy as np
from scipy.sparse import coo_matrix
from scipy.sparse.csgraph import connected_components

from warpffrf.model.errors import InputError, unknown_name
from warpffrf.model.material import Material
from warpffrf.model.mesh.checks import (
    check_connected,
    check_distinct,
    check_orientation,
    check_structure,
    corner_notes,
    part_labels,
)
from warpffrf.model.mesh.data import Mesh
from warpffrf.model.mesh.elements import CELL_KINDS, cell_kind, facet_kind
from warpffrf.model.mesh.facets import FacetSet, outer_faces, row_numbers
from warpffrf.model.mesh.structure import Structure

logger = logging.getLogger(__name__)

Array = np.ndarray

SPARSE = 64  # numbers per node up to which a table of all numbers is smaller than the file
MOST_LISTED = 20  # kinds in a note; control decks have a handful of unused ones


@dataclass(frozen=True, eq=False)
class RawMesh:
    """Contents of a file. `points` (n, 3) in the file's unit; `blocks`: kinds of cells or facets with their nodes (m,
    k) as numbers of points; `groups`: {name: member numbers in each block}; `materials` in SI units.

    `stray_facets`: facets that are no faces of a cell are omitted with a note (shells of a larger model) instead of
    refused. `either_hand`: the format does not define the orientation of cells. `labels`: the numbers that the
    file gives the members of each block, None where it gives none. `node_groups`: {name: numbers of points}, which
    become the outer facets all of whose nodes they contain. `structure`: shells, beams and others in SI units, with
    numbers of points.
    """

    points: Array
    blocks: Sequence[tuple[str, Array]]
    groups: Mapping[str, Sequence[Array]]
    materials: Mapping[str, Material] = field(default_factory=dict)
    notes: tuple[str, ...] = ()
    stray_facets: bool = False
    either_hand: bool = False
    labels: Sequence[Array] | None = None
    node_groups: Mapping[str, Array] = field(default_factory=dict)
    structure: Structure = field(default_factory=Structure)


def built(raw: RawMesh, *, scale: float, part: int | str | None, name: str, label: str) -> Mesh:
    """The checked mesh of one part of `raw`, coordinates times `scale`; `label` names the file in errors."""
    for kind, nodes in raw.blocks:
        if nodes.size and (nodes.min() < 0 or nodes.max() >= len(raw.points)):
            what = "cell" if kind in CELL_KINDS else "facet"
            raise InputError(f"{label}: a {what} refers to a node that the file does not contain")
    notes: list[str] = []
    raw = _uncollapsed(raw, notes, label)
    volumes = [b for b, (kind, _) in enumerate(raw.blocks) if kind in CELL_KINDS]
    kept = _one_part(raw, volumes, part, label)
    structure = raw.structure
    if structure.parts and volumes:
        structure = attached(structure, [raw.blocks[b][1] for b in volumes], len(raw.points), notes)
    if part is not None and structure.parts:
        notes.append(f"part {part!r} is read without structural elements: {counted(structure)}")
        structure = Structure()
    if not any(mask.any() for mask in kept.values()) and not structure.parts:
        raise InputError(f"{label}: there are no volume cells; export the 3-D mesh")

    by_kind: dict[str, list[Array]] = {}
    named: dict[str, list[Array]] = {}
    for b in volumes:
        kind, nodes = raw.blocks[b]
        if kept[b].any():
            by_kind.setdefault(kind, []).append(_upright(kind, raw, nodes[kept[b]], notes))
            named.setdefault(kind, []).append(np.zeros(0) if raw.labels is None else raw.labels[b][kept[b]])
    cells = {kind: np.concatenate(parts) for kind, parts in by_kind.items()}
    labels = None
    if raw.labels is not None:
        labels = np.concatenate([np.zeros(0, dtype=np.int64), *(a for parts in named.values() for a in parts)])
    number = _cell_numbers(raw, volumes, kept, list(cells))
    marked = np.zeros(len(raw.points), dtype=bool)
    for nodes in cells.values():
        marked[nodes] = True
    marked[structure.nodes()] = True
    used = np.flatnonzero(marked)
    new_number = np.where(marked, np.cumsum(marked) - 1, -1)
    cells = {kind: new_number[nodes] for kind, nodes in cells.items()}

    cell_sets = {}
    for group, parts in raw.groups.items():
        members = np.concatenate([np.zeros(0, dtype=np.int64), *(number[b][parts[b]] for b in volumes)])
        if np.any(members >= 0):
            cell_sets[group] = members[members >= 0]
    structure = structure.renumbered(new_number)
    shells = structure.facet_sets()
    facet_sets, left_out = _facet_sets(raw, cells, new_number, label) if cells else ({}, [])
    left_out = [note for note in left_out if not any(note.startswith(f"set {name!r}: ") for name in shells)]
    if cells:
        facet_sets |= _node_sets(raw, cells, new_number, facet_sets, left_out)
    # shells on faces of solids keep the outward normals of those
    facet_sets |= {n: s for n, s in shells.items() if n not in facet_sets or len(facet_sets[n]) != len(s)}
    points, what = raw.points[used] * scale, "number" if labels is None else "element"
    try:
        # what mesh.check() does, with the file's numbers; nodes without cells are left out already
        check_orientation(points, cells, labels, what)
        if cells:
            check_distinct(cells, labels, what)
        if structure.parts:
            check_structure(len(points), cells, structure)
        else:
            check_connected(len(points), cells)
        return Mesh(
            points,
            cells,
            facet_sets,
            name=name,
            cell_sets=cell_sets,
            materials={group: material for group, material in raw.materials.items() if group in cell_sets},
            notes=(*raw.notes, *notes, *left_out, *corner_notes(points, cells, labels, what)),
            structure=structure,
            node_sets=rotating_sets(structure, facet_sets, new_number, raw.node_groups),
        )
    except InputError as error:
        raise InputError(f"{label}: {error}") from None


def counted(structure: Structure) -> str:
    """The numbers of structural elements, as text."""
    return ", ".join(f"{count} {name}" for name, count in structure.counts().items())


def attached(structure: Structure, solids: Sequence[Array], node_count: int, notes: list[str]) -> Structure:
    """The elements that are connected with `solids` (nodes of cells); a note counts the others."""
    first, other = [], []
    for block in [*solids, *structure.connections()]:
        first.append(np.repeat(block[:, 0], block.shape[1] - 1))
        other.append(block[:, 1:].ravel())
    ends = np.concatenate(first), np.concatenate(other)
    graph = coo_matrix((np.ones(len(ends[0]), dtype=np.int8), ends), shape=(node_count, node_count))
    label = connected_components(graph, directed=False)[1]
    on_solid = np.isin(label, np.unique(label[np.concatenate([block[:, 0] for block in solids])]))
    kept, apart = structure.split(on_solid)
    if apart.parts:
        notes.append(f"structural elements that are not connected with the solids are left out: {counted(apart)}")
    return kept


def rotating_sets(
    structure: Structure, taken: Mapping[str, Any], number: Array, groups: Mapping[str, Array]
) -> dict[str, Array]:
    """{name: nodes} of the node `groups` that hold a node with rotation and have no facets; `number` of each node."""
    found = {}
    for name, members in groups.items():
        nodes = number[members]
        nodes = nodes[nodes >= 0]
        if name not in taken and np.isin(nodes, structure.rotating).any():
            found[name] = nodes
    return found


def _uncollapsed(raw: RawMesh, notes: list[str], label: str) -> RawMesh:
    """`raw` with cells that have a node twice replaced by the remaining cells, in separate blocks."""
    blocks, groups = [*raw.blocks], {name: [*parts] for name, parts in raw.groups.items()}
    labels = None if raw.labels is None else [*raw.labels]
    for b, (kind, nodes) in enumerate(raw.blocks):
        bad = repeated(nodes) if kind in CELL_KINDS else np.zeros(0, dtype=bool)
        if not bad.any():
            continue
        rows = np.flatnonzero(bad)
        # cells with the same pattern of repetition, each node as the first place of its number, leave the same
        pattern = np.argmax(nodes[rows][:, :, None] == nodes[rows][:, None, :], axis=2)
        patterns, of_row = np.unique(pattern, axis=0, return_inverse=True)
        left: dict[str, list[tuple[Array, Array]]] = {}
        for number, one in enumerate(patterns):
            alike = rows[of_row.ravel() == number]
            found = left_over(kind, one)
            if found is None:
                name = f"number {alike[0]} of its kind" if raw.labels is None else f"element {raw.labels[b][alike[0]]}"
                pyramid = len(set(one[: cell_kind(kind).corner_count].tolist())) == 5
                raise InputError(
                    f"{label}: {kind} {name} has repeated nodes and is {'a pyramid, ' if pyramid else ''}neither a "
                    "wedge nor a tetrahedron; mesh with these instead"
                )
            left.setdefault(found[0], []).append((alike, nodes[alike][:, found[1]]))
        for new_kind, parts_left in left.items():
            old, new = (np.concatenate(parts) for parts in zip(*parts_left, strict=True))
            blocks.append((new_kind, new))
            for parts in groups.values():
                parts.append(np.flatnonzero(np.isin(old, parts[b])))
            if labels is not None and raw.labels is not None:
                labels.append(raw.labels[b][old])
            notes.append(f"{len(old)} {kind} cells with repeated nodes are read as {new_kind}")
        number = np.cumsum(~bad) - 1
        blocks[b] = (kind, nodes[~bad])
        for parts in groups.values():
            parts[b] = number[parts[b][~bad[parts[b]]]]
        if labels is not None:
            labels[b] = labels[b][~bad]
    return replace(raw, blocks=blocks, groups=groups, labels=labels)


def _one_part(raw: RawMesh, volumes: list[int], part: int | str | None, label: str) -> dict[int, Array]:
    """For each volume block which of its cells belong to the requested part; all of them for None."""
    masks = {b: np.full(len(raw.blocks[b][1]), part is None) for b in volumes}
    if part is None or not volumes:
        return masks
    if isinstance(part, str):
        named = {name for name, parts in raw.groups.items() if any(len(parts[b]) for b in volumes)}
        if part not in named:
            raise unknown_name(f"{label}: volume group", part, sorted(named))
        for b in volumes:
            masks[b][raw.groups[part][b]] = True
        return masks
    # blocks have unique names: several may be of one kind
    labels = part_labels(len(raw.points), {str(b): raw.blocks[b][1] for b in volumes})
    order = labels[np.sort(np.unique(labels, return_index=True)[1])]  # parts in the order of their first cells
    if isinstance(part, bool) or not isinstance(part, int) or not 0 <= part < len(order):
        raise InputError(f"{label}: part {part!r} does not exist, it has {len(order)} connected part(s)")
    stops = np.cumsum([len(raw.blocks[b][1]) for b in volumes])[:-1]
    return dict(zip(volumes, np.split(labels == order[part], stops), strict=True))


def _upright(kind: str, raw: RawMesh, nodes: Array, notes: list[str]) -> Array:
    """The cells, with inverted wedges reversed, and all inverted cells where the format does not define their
    orientation."""
    cell = cell_kind(kind)
    if not (raw.either_hand or cell.domain == "wedge"):
        return nodes
    middle = cell.nodes[: cell.corner_count].mean(axis=0, keepdims=True)
    over = cell.jacobians(raw.points[nodes], middle)[:, 0] < 0.0
    if raw.either_hand and over.any():
        notes.append(f"{np.sum(over)} {kind} cells with nodes in reversed order are corrected")
    return np.where(over[:, None], nodes[:, mirror(kind)], nodes)


def mirror(kind: str) -> list[int]:
    """The order of the nodes of a cell of the other orientation."""
    # every reference cell is its own mirror image in the plane between its first two axes
    x = cell_kind(kind).nodes
    return [int(np.argmin(np.abs(x - image).sum(axis=1))) for image in x[:, [1, 0, 2]]]


def _cell_numbers(raw: RawMesh, volumes: list[int], kept: dict[int, Array], kinds: list[str]) -> dict[int, Array]:
    """Number in the mesh of each cell of each volume block, -1 for omitted ones."""
    counts = {kind: sum(int(kept[b].sum()) for b in volumes if raw.blocks[b][0] == kind) for kind in kinds}
    start = dict(zip(kinds, np.cumsum([0, *counts.values()])[:-1].tolist(), strict=True))
    number = {}
    for b in volumes:
        number[b] = np.full(len(kept[b]), -1, dtype=np.int64)
        if kept[b].any():
            kind, found = raw.blocks[b][0], int(kept[b].sum())
            number[b][kept[b]] = start[kind] + np.arange(found)
            start[kind] += found
    return number


def _facet_sets(
    raw: RawMesh, cells: dict[str, Array], new_number: Array, label: str
) -> tuple[dict[str, FacetSet], list[str]]:
    """Facet sets on the outer faces of `cells`, and notes about omitted facets."""
    surfaces = [b for b, (kind, nodes) in enumerate(raw.blocks) if kind not in CELL_KINDS and len(nodes)]
    if not surfaces:
        return {}, []
    faces: list[tuple[str, Array]] = []
    for kind, nodes in cells.items():
        for facet, local in cell_kind(kind).faces.items():
            faces.append((facet, nodes[:, local].reshape(-1, local.shape[1])))
    queries = []
    for b in surfaces:
        nodes = raw.blocks[b][1]
        queries.append((raw.blocks[b][0], new_number[nodes]))
    keys = [_key(*item) for item in [*faces, *queries]]
    same = row_numbers(np.concatenate(keys))
    split = np.split(same, np.cumsum([len(k) for k in keys])[:-1])
    of_faces, of_queries = np.concatenate(split[: len(faces)]), split[len(faces) :]
    times = np.bincount(of_faces, minlength=int(same.max()) + 1)
    first = np.full(len(times), -1, dtype=np.int64)
    first[of_faces] = np.arange(len(of_faces))
    starts = np.cumsum([0, *(len(f) for _, f in faces)])

    sets: dict[str, FacetSet] = {}
    notes: list[str] = []
    for name, parts in raw.groups.items():
        chosen = []
        stray = 0
        for b, (_, nodes), ids in zip(surfaces, queries, of_queries, strict=True):
            members = np.asarray(parts[b], dtype=np.int64)
            ids = ids[members[np.all(nodes[members] >= 0, axis=1)]]
            stray += int(np.sum(times[ids] == 0))
            chosen.append(ids[times[ids] > 0])
        if stray and not raw.stray_facets:
            raise InputError(f"{label}: set {name!r} has a facet that is no face of a cell ({stray} of them)")
        if stray:
            notes.append(f"set {name!r}: {stray} facets that are no faces of a cell are left out")
        ids = np.unique(np.concatenate(chosen))
        inside = int(np.sum(times[ids] > 1))
        if inside:
            notes.append(f"set {name!r}: {inside} facets inside the volume are left out")
            logger.warning("%s: %s", label, notes[-1])
        rows = np.sort(first[ids[times[ids] == 1]])
        blocks: dict[str, list[Array]] = {}
        for (facet, nodes), start in zip(faces, starts[:-1], strict=True):
            here = rows[(rows >= start) & (rows < start + len(nodes))] - start
            if len(here):
                blocks.setdefault(facet, []).append(nodes[here])
        if blocks:
            sets[name] = FacetSet({facet: np.concatenate(parts) for facet, parts in blocks.items()})
    return sets, notes


def _node_sets(
    raw: RawMesh, cells: dict[str, Array], new_number: Array, taken: Mapping[str, FacetSet], notes: list[str]
) -> dict[str, FacetSet]:
    """The outer facets over each group of nodes; `notes` list groups that have none, and names that are taken."""
    outer = outer_faces(cells) if raw.node_groups else FacetSet({})
    sets: dict[str, FacetSet] = {}
    empty: list[str] = []
    for name, members in raw.node_groups.items():
        inside = np.zeros(int(new_number.max()) + 1, dtype=bool)
        inside[new_number[members][new_number[members] >= 0]] = True
        facets = FacetSet({kind: nodes[inside[nodes].all(axis=1)] for kind, nodes in outer.blocks.items()})
        if not len(facets):
            empty.append(f"{name!r} ({len(members)} nodes)")
        elif name not in taken:
            sets[name] = facets
        elif len(facets) != len(taken[name]):
            notes.append(f"node set {name!r} is not used, a set of facets has that name")
    if empty:
        notes.append(f"node sets without a complete outer facet are not used: {', '.join(empty)}")
    return sets


def places(numbers: Array, wanted: Array) -> Array:
    """Positions in `numbers`, of nodes of a file, of the numbers `wanted`; -1 for those that are not among them."""
    if numbers.max() < SPARSE * len(numbers):
        table = np.full(int(numbers.max()) + 1, -1)
        table[numbers] = np.arange(len(numbers))
        return np.where((wanted >= 0) & (wanted < len(table)), table[np.clip(wanted, 0, len(table) - 1)], -1)
    order = np.argsort(numbers, kind="stable")
    place = order[np.minimum(np.searchsorted(numbers, wanted, sorter=order), len(numbers) - 1)]
    return np.where(numbers[place] == wanted, place, -1)


def require_once(numbers: Array, label: str) -> None:
    """Raise `InputError` where a number of a node or element occurs twice."""
    ordered = np.sort(numbers)
    again = ordered[1:] == ordered[:-1]
    if again.any():
        raise InputError(f"{label} {ordered[1:][again][0]} is given twice; write the file again")


def listed_counts(found: Counter[str]) -> str:
    """Names with their counts, the most frequent first."""
    listed = [f"{name} ({count})" for name, count in found.most_common(MOST_LISTED)]
    more = len(found) - len(listed)
    return ", ".join(listed) + (f" and {more} other kinds" if more else "")


def _key(kind: str, nodes: Array) -> Array:
    """Sorted corners (m, 4) of facets, filled up with -1."""
    corners = np.sort(nodes[:, : facet_kind(kind).corner_count], axis=1)
    return np.pad(corners, ((0, 0), (0, 4 - corners.shape[1])), constant_values=-1)


LENGTH_UNITS = {"m": 1.0, "cm": 1e-2, "mm": 1e-3, "um": 1e-6, "in": 0.0254, "ft": 0.3048}  # in m
SYSTEMS = {"m": (1.0, 1.0, "Pa and kg/m3"), "mm": (1e6, 1e12, "MPa and t/mm3")}  # stress in Pa, density in kg/m3


def system_of(length_unit: str, notes: list[str]) -> tuple[float, float, str] | None:
    """Units of stress [Pa] and density [kg/m3] and their names; None without a usual system, which `notes` state."""
    if length_unit in SYSTEMS:
        return SYSTEMS[length_unit]
    notes.append(
        f"materials are not used: with lengths in {length_unit} the units of stress and density are unknown (they are "
        f"known with {' and '.join(SYSTEMS)}); define the materials in the call"
    )
    return None


_QUADRATIC = {"wedge6": "wedge15", "tet4": "tet10"}


def repeated(nodes: Array) -> Array:
    """Which cells (m,) of nodes (m, k) have a node twice."""
    ordered = np.sort(nodes, axis=1)
    return np.any(ordered[:, 1:] == ordered[:, :-1], axis=1)


def left_over(kind: str, nodes: Array) -> tuple[str, list[int]] | None:
    """The kind and nodes of the remaining cell of one cell (k,) with repeated corners; None if it is not supported."""
    cell = cell_kind(kind)
    if kind == "hex27":
        return None
    faces = []
    for name, table in cell.faces.items():
        for local in table[:, : facet_kind(name).corner_count]:
            loop = [int(nodes[a]) for a in local]
            loop = [a for i, a in enumerate(loop) if a != loop[i - 1]]
            if len(set(loop)) != len(loop):
                return None  # folded onto itself
            if len(loop) > 2:
                faces.append(loop)
    triangles = [face for face in faces if len(face) == 3]
    corners = {a for face in faces for a in face}
    if len(triangles) == 4 and len(faces) == 4 and len(corners) == 4:
        a, b, c = triangles[0]
        order = [a, c, b, *(corners - {a, b, c})]
        found = "tet4"
    elif len(triangles) == 2 and len(faces) == 5 and len(corners) == 6:
        bottom = triangles[0][::-1]  # its normal points into the wedge
        beside = {frozenset(pair) for face in faces for pair in zip(face, face[1:] + face[:1], strict=True)}
        top = [[b for b in triangles[1] if frozenset((a, b)) in beside] for a in bottom]
        if [len(t) for t in top] != [1, 1, 1]:
            return None
        order, found = [*bottom, *(t[0] for t in top)], "wedge6"
    else:
        return None
    if len(nodes) == cell.corner_count:
        return found, order
    middle: dict[frozenset[int], int] = {}
    at = {tuple(x): int(a) for x, a in zip(cell.nodes.tolist(), nodes, strict=True)}
    for i in range(cell.corner_count):
        for j in range(i):
            edge = at.get(tuple(0.5 * (cell.nodes[i] + cell.nodes[j])))
            if edge is not None and nodes[i] != nodes[j]:
                if middle.setdefault(frozenset((int(nodes[i]), int(nodes[j]))), edge) != edge:
                    return None  # one edge with two middles
    full = cell_kind(_QUADRATIC[found])
    pairs = [np.flatnonzero(np.isin(np.arange(full.corner_count), _ends(full, x))) for x in full.nodes[len(order) :]]
    try:
        return full.name, order + [middle[frozenset(order[i] for i in pair)] for pair in pairs]
    except KeyError:
        return None


def _ends(cell, x: Array) -> list[int]:
    """The two corners whose mean is the position `x` of a mid node."""
    n = cell.corner_count
    return next([i, j] for i in range(n) for j in range(i) if np.array_equal(0.5 * (cell.nodes[i] + cell.nodes[j]), x))


def face_numbers(
    faces: tuple[tuple[str, Array], ...], nodes: Array, new_faces: tuple[tuple[str, Array], ...], new_nodes: Array
) -> Mapping[int, int]:
    """Face (from 1) of the remaining cell for each face (from 1) of the collapsed cell; none where it has vanished.
    `faces` as `inp.cells.faces_of` gives them."""

    def corners(face: tuple[str, Array], at: Array) -> frozenset[int]:
        return frozenset(int(at[a]) for a in face[1][: facet_kind(face[0]).corner_count])

    left = {corners(face, new_nodes): number for number, face in enumerate(new_faces, start=1)}
    became = {number: left.get(corners(face, nodes)) for number, face in enumerate(faces, start=1)}
    return {number: new for number, new in became.items() if new is not None}
