"""Universal files of I-deas (.unv, .uff): nodes, elements and groups, as NX, Salome, Gmsh and Testlab write them.

A file consists of datasets between lines with -1; the first line of each is its number.

| dataset | here |
|---|---|
| 15, 2411 | nodes; those of 15 in the coordinate system that 18 or 2420 defines, those of 2411 in that of the part |
| 2412 | elements: facet sets and cell sets `property_P` by the number of their physical property |
| 2420, 18 | coordinate systems, Cartesian |
| 164 | units, which a note states |
| 2467, 2477, 2452, 2435 | groups: of elements cell and facet sets, of nodes the outer facets over them |

Nodes of a quadratic element go around its bottom, corners and mid-side nodes by turns, then come those of the vertical
edges, then those around its top.
"""

from __future__ import annotations

from collections import Counter
from collections.abc import Callable
from pathlib import Path

import numpy as np

from warpffrf.model.errors import InputError
from warpffrf.model.mesh.files.columns import Lines
from warpffrf.model.mesh.files.raw_mesh import LENGTH_UNITS, RawMesh, listed_counts, places, require_once

Array = np.ndarray

# number of the element: kind here, number of nodes in the file, the place in it of each node of the kind
_SOLIDS = {
    111: ("tet4", 4, [*range(4)]),
    112: ("wedge6", 6, [*range(6)]),
    115: ("hex8", 8, [*range(8)]),
    118: ("tet10", 10, [0, 2, 4, 9, 1, 3, 5, 6, 7, 8]),
    113: ("wedge15", 15, [0, 2, 4, 9, 11, 13, 1, 3, 5, 10, 12, 14, 6, 7, 8]),
    116: ("hex20", 20, [0, 2, 4, 6, 12, 14, 16, 18, 1, 3, 5, 7, 13, 15, 17, 19, 8, 9, 10, 11]),
}
# plane, plate, membrane, axisymmetric and thin shell elements; by their corners
_SHELLS = {
    **{n + 1: ("tri3", 3, [0, 1, 2]) for n in range(40, 100, 10)},
    **{n + 2: ("tri3", 6, [0, 2, 4]) for n in range(40, 100, 10)},
    **{n + 4: ("quad4", 4, [0, 1, 2, 3]) for n in range(40, 100, 10)},
    **{n + 5: ("quad4", 8, [0, 2, 4, 6]) for n in range(40, 100, 10)},
}
_BEAMS = (11, 21, 22, 23, 24)  # with a line more
_GROUPS = (2467, 2477, 2452, 2435)
_NODE, _ELEMENT = 7, 8  # entities of a group
NOT_CARTESIAN = "systems that are not Cartesian"
_SILENT = {151, 164}  # header, units


class UniversalFile:
    """Datasets of a file, taken one after the other."""

    def __init__(self, path: Path, kind: str = "mesh file") -> None:
        self.lines = Lines(path, kind)
        self.numbers: list[Array] = []
        self.points: list[Array] = []
        self.systems: list[Array] = []  # of the points
        self.displaced: list[Array] = []  # systems of the displacements at the points
        self.head: list[Array] = []  # of elements: number, kind, physical property, count of nodes
        self.rows: list[Array] = []  # line of each element
        self.nodes: list[list[Array]] = []
        self.axes: dict[int, Array] = {}  # system: three axes and the origin (4, 3)
        self.groups: list[tuple[str, Array]] = []  # name, entities: code and number
        self.length: float | None = None  # units of length per metre
        self.ignored: Counter[str] = Counter()
        take = {15: self._single, 2411: self._double, 2412: self._elements, 2420: self._systems_, 18: self._old_systems}
        take |= {164: self._units} | dict.fromkeys(_GROUPS, self._groups) | self.others()
        for number, first, last in self._datasets():
            if number in take:
                take[number](first, last)
            elif number not in _SILENT:
                self.ignored[str(number)] += 1

    def others(self) -> dict[int, Callable[[int, int], None]]:
        """What takes datasets of other numbers, from their first line to the line after the last one."""
        return {}

    def _datasets(self) -> list[tuple[int, int, int]]:
        """Number, first line and the line after the last one of each dataset."""
        ends = self._marks()
        if not len(ends) or len(ends) % 2:
            raise InputError(
                f"{self.lines.label}: {len(ends)} lines with -1, datasets begin and end with one; export it again"
            )
        found = []
        for begin, end in ends.reshape(-1, 2).tolist():
            words = self.lines.text(begin + 1).split()
            word = words[0].rstrip("b") if words else ""
            if not (word.isdecimal() and len(word) < 7):
                raise self.lines.fault(begin + 1, f"{self.lines.short(begin + 1)} is no number of a dataset")
            found.append((int(word), begin + 2, end))
        between = [a[2] + 1 for a, b in zip(found[:-1], found[1:], strict=True) if b[1] - 2 > a[2] + 1]
        stray = [i for i in between if self.lines.text(i).strip()]
        if stray:
            raise self.lines.fault(stray[0], f"{self.lines.short(stray[0])} is in no dataset; export the file again")
        return found

    def _marks(self) -> Array:
        """Lines with -1 in columns 5 and 6 and nothing else."""
        starts = self.lines.starts
        likely = np.flatnonzero(self.lines.stops - starts >= 6)
        likely = likely[self.lines.bytes[starts[likely] + 5] == ord("1")]
        likely = likely[self.lines.bytes[starts[likely] + 4] == ord("-")]
        return np.array([i for i in likely.tolist() if self.lines.text(i) == "    -1"], dtype=np.int64)

    def _single(self, first: int, last: int) -> None:
        whole, real = self.lines.table(np.arange(first, last), [10] * 4, [13] * 3)
        self._points(whole, real, whole[:, 1], whole[:, 2])

    def _double(self, first: int, last: int) -> None:
        if (last - first) % 2:
            raise self.lines.fault(last - 1, "dataset 2411: a node has two lines; export the file again")
        whole, _ = self.lines.table(np.arange(first, last, 2), [10] * 4)
        _, real = self.lines.table(np.arange(first + 1, last, 2), [], [25] * 3)
        self._points(whole, real, np.zeros(len(whole), dtype=np.int64), whole[:, 2])

    def _points(self, whole: Array, real: Array, systems: Array, displaced: Array) -> None:
        if len(whole) and whole[:, 0].min() < 1:
            raise InputError(
                f"{self.lines.label}: node {whole[:, 0].min()}: nodes are numbered from 1; export it again"
            )
        self.numbers.append(whole[:, 0])
        self.points.append(real)
        self.systems.append(systems)
        self.displaced.append(displaced)

    def _elements(self, first: int, last: int) -> None:
        whole, _ = self.lines.table(np.arange(first, last), [10] * 8)
        kinds, counts = whole[:, 1].tolist(), whole[:, 5].tolist()
        begins, k = [], 0
        while k < len(whole):
            begins.append(k)
            if not 1 <= counts[k] <= 100 or whole[k, 6:].any():
                raise self.lines.fault(
                    first + k, f"dataset 2412: {self.lines.short(first + k)} is no head of an element; export it again"
                )
            k += 1 + (kinds[k] in _BEAMS) - (-counts[k] // 8)
        if k > len(whole):
            raise self.lines.fault(last - 1, "dataset 2412: the nodes of the last element are missing; export it again")
        begin = np.array(begins, dtype=np.int64)
        head = whole[begin][:, [0, 1, 2, 5]]
        for kind, (_, count, _) in {**_SOLIDS, **_SHELLS}.items():
            chosen = np.flatnonzero(head[:, 1] == kind)
            if not len(chosen):
                continue
            wrong = head[chosen, 3] != count
            lines = -(-count // 8)
            nodes = (
                np.concatenate([whole[begin[chosen] + 1 + n] for n in range(lines)], axis=1)
                if not wrong.any()
                else whole
            )
            if wrong.any() or not nodes[:, :count].all() or nodes[:, count:].any():
                bad = wrong if wrong.any() else ~nodes[:, :count].all(axis=1) | nodes[:, count:].any(axis=1)
                i = int(begin[chosen[np.argmax(bad)]])
                raise self.lines.fault(
                    first + i,
                    f"dataset 2412: element {whole[i, 0]} of kind {kind} needs {count} nodes; export it again",
                )
            self.head.append(head[chosen])
            self.rows.append(first + begin[chosen])
            self.nodes.append([np.array(kind), nodes[:, :count]])
        others = ~np.isin(head[:, 1], [*_SOLIDS, *_SHELLS])
        for kind, times in zip(*np.unique(head[others, 1], return_counts=True), strict=True):
            self.ignored[f"elements of kind {kind}"] += int(times)

    def _systems_(self, first: int, last: int) -> None:
        """The number and name of a part; then for each system its head, name and four lines of three numbers."""
        at = np.arange(first + 2, last, 6)
        if (last - first - 2) % 6:
            raise self.lines.fault(last - 1, "dataset 2420: a system has six lines; export the file again")
        whole, _ = self.lines.table(at, [10] * 3)
        for row, (number, kind, _) in zip(at.tolist(), whole.tolist(), strict=True):
            if kind:
                self.ignored[NOT_CARTESIAN] += 1
                continue
            self.axes[number] = self.lines.table(np.arange(row + 2, row + 6), [], [25] * 3)[1]

    def _old_systems(self, first: int, last: int) -> None:
        """Head, name, origin and a point on the first axis, and one in the half plane of the first and third axes."""
        if (last - first) % 4:
            raise self.lines.fault(last - 1, "dataset 18: a system has four lines; export the file again")
        for row in range(first, last, 4):
            (number, kind, *_), _ = (a[0] for a in self.lines.table(np.array([row]), [10] * 5))
            if kind:
                self.ignored[NOT_CARTESIAN] += 1
                continue
            origin, x = self.lines.table(np.array([row + 2]), [], [13] * 6)[1][0].reshape(2, 3)
            z = self.lines.table(np.array([row + 3]), [], [13] * 3)[1][0]
            e_2 = np.cross(z - origin, x - origin)
            lengths = np.linalg.norm(x - origin), np.linalg.norm(e_2)
            if not min(lengths) > 0.0:
                raise self.lines.fault(row, f"dataset 18: the points of system {number} lie on one line")
            e_1, e_2 = (x - origin) / lengths[0], e_2 / lengths[1]
            self.axes[int(number)] = np.stack([e_1, e_2, np.cross(e_1, e_2), origin])

    def _units(self, first: int, last: int) -> None:
        if last - first < 2:
            raise self.lines.fault(first, "dataset 164: the factors of the units are missing; export the file again")
        width = 25 if last - first > 2 else 13
        self.length = float(self.lines.table(np.array([first + 1]), [], [width] * 3)[1][0, 0])

    def _groups(self, first: int, last: int) -> None:
        """Head, whose last number counts the entities; name; two entities of four numbers in a line."""
        row = first
        while row < last:
            head, _ = self.lines.table(np.array([row]), [10] * 8)
            count = int(head[0, 7])
            stop = row + 2 + (count + 1) // 2
            name = self.lines.text(row + 1).strip()
            if count < 0 or stop > last or not name:
                raise self.lines.fault(row, "groups: a name or entities are missing; export the file again")
            whole, _ = self.lines.table(np.arange(row + 2, stop), [10] * 8)
            self.groups.append((name, whole.reshape(-1, 4)[:count, :2]))
            if not self.groups[-1][1].all() or whole.reshape(-1, 4)[count:].any():
                raise self.lines.fault(row, f"group {name[:40]!r} does not have the {count} entities of its head")
            row = stop


def read_unv(path: Path) -> RawMesh:
    """Contents of a universal file. Raises `InputError`, with the line, for damaged datasets and unknown nodes."""
    file = UniversalFile(path)
    label = file.lines.label
    if not file.numbers or not file.head:
        missing = "nodes (dataset 2411 or 15)" if not file.numbers else "elements (dataset 2412)"
        raise InputError(f"{label}: there are no {missing}; export the mesh, not results alone")
    notes: list[str] = []
    numbers = np.concatenate(file.numbers)
    head, lines = np.concatenate(file.head), np.concatenate(file.rows)
    require_once(numbers, f"{label}: node")
    require_once(head[:, 0], f"{label}: element")
    points = placed(file, np.concatenate(file.points), np.concatenate(file.systems))
    blocks, labels, properties = [], [], []
    used = np.zeros(len(numbers), dtype=bool)
    start = 0
    for kind, nodes in file.nodes:
        name, _, order = {**_SOLIDS, **_SHELLS}[int(kind)]
        place = places(numbers, nodes)
        if np.any(place < 0):
            k, column = np.argwhere(place < 0)[0]
            raise file.lines.fault(
                int(lines[start + k]),
                f"node {nodes[k, column]} of element {head[start + k, 0]} is in no dataset of nodes",
            )
        used[place] = True
        blocks.append((name, place[:, order]))
        labels.append(head[start : start + len(nodes), 0])
        properties.append(head[start : start + len(nodes), 2])
        start += len(nodes)
    groups = {
        f"property_{p}": [np.flatnonzero(of == p) for of in properties] for p in np.unique(head[:, 2]).tolist() if p
    }
    node_groups: dict[str, Array] = {}
    for name, entities in file.groups:
        _add_group(name, entities, labels, numbers, groups, node_groups, notes)
    check_units(file, notes)
    if not used.all():  # of a dataset of elements that is missing, too
        notes.append(f"{np.sum(~used)} of {len(used)} nodes belong to no element that is read")
    if file.ignored:
        notes.append(f"datasets and elements that are not used: {listed_counts(file.ignored)}")
    more = {"stray_facets": True, "either_hand": True, "labels": labels, "node_groups": node_groups}
    return RawMesh(points, blocks, groups, {}, tuple(notes), **more)


def placed(file: UniversalFile, points: Array, systems: Array) -> Array:
    """Nodes in the system of the part."""
    for number in np.unique(systems[systems > 0]).tolist():
        if number not in file.axes:
            raise InputError(
                f"{file.lines.label}: nodes are given in the coordinate system {number}, which no dataset 18 or 2420 "
                "defines as Cartesian; export the nodes in the global system"
            )
        axes = file.axes[number]
        points[systems == number] = points[systems == number] @ axes[:3] + axes[3]
    return points


def _add_group(
    name: str,
    entities: Array,
    labels: list[Array],
    numbers: Array,
    groups: dict[str, list[Array]],
    node_groups: dict[str, Array],
    notes: list[str],
) -> None:
    elements, nodes = (np.unique(entities[entities[:, 0] == code, 1]) for code in (_ELEMENT, _NODE))
    others = int(np.sum(~np.isin(entities[:, 0], (_ELEMENT, _NODE))))
    if others:
        notes.append(f"group {name!r}: {others} entities that are neither nodes nor elements are not used")
    if len(elements):
        groups[name] = [np.flatnonzero(np.isin(of, elements)) for of in labels]
        missing = len(elements) - sum(map(len, groups[name]))
        if missing:
            notes.append(f"group {name!r}: {missing} of {len(elements)} elements are not read")
    if len(nodes):
        node_groups[name] = np.flatnonzero(np.isin(numbers, nodes))
        if len(node_groups[name]) < len(nodes):
            notes.append(f"group {name!r}: {len(nodes) - len(node_groups[name])} of {len(nodes)} nodes do not exist")


def check_units(file: UniversalFile, notes: list[str]) -> None:
    """A note on the units that the file states: many programs state metres whatever they write."""
    if file.length is None:
        return
    named = [unit for unit, metres in LENGTH_UNITS.items() if abs(file.length * metres - 1.0) < 1e-3]
    notes.append(f"the file states lengths in {named[0] if named else f'1/{file.length:g} m'} (dataset 164)")
