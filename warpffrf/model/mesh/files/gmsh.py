"""Strict reader of Gmsh's .msh files, versions 2.x and 4.1, as text and binary.

meshio reads the numbers of a file as one long row, loses groups of reversed entities, refuses groups on some of the
entities and fails on partitions. This reader requires the number of values per line that the format defines (Gmsh
reference manual, "MSH file format"), and compares declared counts with the contents.

Elements get the names of the physical groups of their entity (in version 2 those in their line; an element that is
listed once for each of its groups is one element): `surface_<tag>` and `volume_<tag>` where a group has no name. A
partition without groups has those of the entity from which it was cut. A group's number is negative where an entity is
reversed in it. Points, curves and data stored with nodes and elements are omitted and counted in notes.

Gmsh scanner. The numbers of a .msh file: by lines in a text file, as one sequence in a binary file.
"""

from __future__ import annotations

import struct
from collections import Counter
from collections.abc import Callable
from dataclasses import dataclass, field
from pathlib import Path

import numpy as np

from warpffrf.model.errors import InputError
from warpffrf.model.files.paths import MOST_DIGITS, read_named
from warpffrf.model.mesh.files.raw_mesh import RawMesh

Array = np.ndarray

# Gmsh's element types: dimension, nodes, kind here, and for each node of that kind its index in Gmsh's order
_QUADRATIC_HEX = [*range(9), 11, 13, 9, 16, 18, 19, 17, 10, 12, 14, 15]
TYPES: dict[int, tuple[int, int, str, list[int]]] = {
    2: (2, 3, "tri3", [*range(3)]),
    3: (2, 4, "quad4", [*range(4)]),
    4: (3, 4, "tet4", [*range(4)]),
    5: (3, 8, "hex8", [*range(8)]),
    6: (3, 6, "wedge6", [*range(6)]),
    9: (2, 6, "tri6", [*range(6)]),
    10: (2, 9, "quad9", [*range(9)]),
    11: (3, 10, "tet10", [*range(8), 9, 8]),
    12: (3, 27, "hex27", [*_QUADRATIC_HEX, 22, 23, 21, 24, 20, 25, 26]),
    16: (2, 8, "quad8", [*range(8)]),
    17: (3, 20, "hex20", _QUADRATIC_HEX),
    18: (3, 15, "wedge15", [*range(7), 9, 7, 12, 14, 13, 8, 10, 11]),
}
# unsupported element types: dimension, nodes, name
OTHERS = {
    1: (1, 2, "lines"), 8: (1, 3, "lines"), 15: (0, 1, "points"), 26: (1, 4, "lines"), 27: (1, 5, "lines"),
    28: (1, 6, "lines"), 7: (3, 5, "pyramid"), 13: (3, 18, "wedge18"), 14: (3, 14, "pyramid14"),
    19: (3, 13, "pyramid13"), 20: (2, 9, "triangle9"), 21: (2, 10, "triangle10"), 22: (2, 12, "triangle12"),
    23: (2, 15, "triangle15"), 29: (3, 20, "tetra20"), 30: (3, 35, "tetra35"), 31: (3, 56, "tetra56"),
    36: (2, 16, "quad16"), 37: (2, 25, "quad25"), 92: (3, 64, "hexahedron64"), 93: (3, 125, "hexahedron125"),
}  # fmt: skip
SUPPORTED = "hexahedron, hexahedron20, hexahedron27, wedge, wedge15, tetra, tetra10"
SAVE = "save it from Gmsh with Mesh.MshFileVersion = 4.1"
# sections without data of a body's cells and groups, omitted without a note
SKIPPED = {"$Comments", "$Periodic", "$GhostElements", "$Parametrizations", "$InterpolationScheme"}


@dataclass
class _Found:
    """Data of the sections. `elements` {(type, dimension, entity): rows (m, 1 + nodes)}, and for files that list them
    per element the physical group (m,) of each row; `groups` {(dimension, entity): tags}."""

    names: dict[tuple[int, int], str] = field(default_factory=dict)
    numbers: Array | None = None
    points: Array = field(default_factory=lambda: np.zeros((0, 3)))
    groups: dict[tuple[int, int], list[int]] = field(default_factory=dict)
    parents: dict[tuple[int, int], tuple[int, int]] = field(default_factory=dict)
    elements: list[tuple[int, tuple[int, int], Array, Array | None]] = field(default_factory=list)
    unused: Counter[str] = field(default_factory=Counter)


def read_gmsh(path: Path) -> RawMesh:
    """The contents of a .msh file. Raises `InputError`, for text with the number of the line, for contents that violate
    the format, for volume cells of an unsupported kind, and where there are no cells."""
    scan, found = Scanner(path, read_named(path, "mesh file")), _Found()
    while (word := _section(scan)) is not None:
        reader = _SECTIONS.get((scan.version[:1], word.decode("latin-1")))
        if word == b"$MeshFormat":
            _format(scan)
        elif word == b"$NOD":
            raise InputError(f"mesh file {path.name}: version 1 of the format is not read; {SAVE}")
        elif word == b"$ParametricNodes":
            raise InputError(f"mesh file {path.name}: nodes with parameters of version 2 are not read; {SAVE}")
        elif not scan.version and word != b"$Comments":
            raise scan.damaged("its first section is not $MeshFormat")
        elif reader is not None:
            reader(scan, found)
        else:
            _skip(scan, word)
            if word.decode("latin-1") not in SKIPPED:
                found.unused[word[:SHOWN].decode("latin-1")] += 1
            continue
        _close(scan, word)
    if found.numbers is None:
        raise scan.damaged("it has no nodes")
    return _raw(path, found)


def _section(scan: Scanner) -> bytes | None:
    """The next `$Name`; None at the end of the file."""
    while scan.at < len(scan.content):
        word = scan.text_line().strip()
        if word:
            if not word.startswith(b"$") or word.startswith(b"$End"):
                raise (
                    scan.damaged(f"line {scan.line} is outside all sections")
                    if not scan.binary
                    else scan.damaged("a section does not end where its counts require")
                )
            return word
    return None


def _close(scan: Scanner, word: bytes) -> None:
    scan.end(f"the end of {word.decode()}")
    wanted = b"$End" + word[1:]
    line = scan.text_line()
    while scan.at < len(scan.content) and not line.strip():
        line = scan.text_line()
    if line.strip() != wanted:
        raise scan.fault(wanted.decode(), line)


def _skip(scan: Scanner, word: bytes) -> None:
    end = b"\n$End" + word[1:]
    at = scan.content.find(end, scan.at - 1)
    if at < 0:
        raise scan.damaged(f"{word[:SHOWN].decode('latin-1')} has no end")
    scan.line += scan.content.count(b"\n", scan.at, at + 1)
    scan.at = at + 1
    if scan.text_line().strip() != end.strip():
        raise scan.damaged(f"{word[:SHOWN].decode('latin-1')} has no end")


def _format(scan: Scanner) -> None:
    line = scan.text_line()
    fields = line.split()
    if len(fields) != 3 or fields[1] not in (b"0", b"1"):
        raise scan.fault("version, 0 or 1 and 8", line)
    version, kind, size = fields
    if version not in (b"2", b"2.0", b"2.1", b"2.2", b"4.1") or size != b"8":
        raise InputError(
            f"mesh file {scan.path.name}: version {version[:9].decode('latin-1')} of the format is not read; {SAVE}"
        )
    scan.version = version
    if kind == b"1":
        one = scan.content[scan.at : scan.at + 4]
        if one not in (b"\1\0\0\0", b"\0\0\0\1"):
            raise scan.damaged("it does not declare its byte order")
        scan.binary, scan.order = True, "<" if one[0] else ">"
        scan.at += 4


def _names(scan: Scanner, found: _Found) -> None:
    """`dimension number "name"`: lines of text in binary files, too."""
    line = scan.text_line()
    try:
        count = int(line) if len(line.strip()) <= MOST_DIGITS else -1
    except ValueError:
        count = -1
    if count < 0:
        raise scan.fault("the number of names", line)
    for line in scan.lines(count, "a name")[0]:
        words = line.strip().split(None, 2)
        if len(words) != 3 or not all(w.isdigit() and len(w) <= MOST_DIGITS for w in words[:2]):
            raise scan.fault("'dimension number \"name\"' of a group", line)
        dim, tag, name = int(words[0]), int(words[1]), words[2].decode("utf-8", errors="replace").strip('"')
        if found.names.setdefault((dim, tag), name) != name:
            raise scan.fault("a name of a group without one", line)


def _entities(scan: Scanner, found: _Found) -> None:
    what = "an entity with its box and groups"
    counts = scan.head("nnnn", "the four numbers of $Entities")
    for dim, count in enumerate(counts):
        for _ in range(count):
            (tag,) = scan.take("i", what)
            scan.take("d" * (3 if dim == 0 else 6), what)
            _entity(scan, found, dim, tag, what)


def _entity(scan: Scanner, found: _Found, dim: int, tag: int, what: str) -> None:
    """The groups of an entity and its bounding entities."""
    found.groups[dim, tag] = [abs(g) for g in _several(scan, what)]
    if dim:
        _several(scan, what)
    scan.end(what)


def _several(scan: Scanner, what: str) -> list[int]:
    (count,) = scan.take("n", what)
    if not 0 <= count <= len(scan.content) - scan.at:
        raise scan.fault(what, str(count).encode())
    return scan.take("i" * count, what)


def _partitions(scan: Scanner, found: _Found) -> None:
    what = "an entity of a partition with its box and groups"
    scan.head("n", "the number of partitions")
    (ghosts,) = scan.head("n", "the number of ghost entities")
    for _ in range(ghosts):
        scan.head("ii", "a ghost entity")
    counts = scan.head("nnnn", "the four numbers of entities of partitions")
    for dim, count in enumerate(counts):
        for _ in range(count):
            tag, parent_dim, parent = scan.take("iii", what)
            found.parents[dim, tag] = (parent_dim, parent)
            _several(scan, what)
            scan.take("d" * (3 if dim == 0 else 6), what)
            _entity(scan, found, dim, tag, what)


def _take_nodes(scan: Scanner, found: _Found, numbers: Array, points: Array, total: int) -> None:
    if found.numbers is not None:
        raise scan.damaged("it has two sections of nodes")
    if len(numbers) != total:
        raise InputError(f"mesh file {scan.path.name}: has {len(numbers)} nodes and declares {total}; export it again")
    if len(numbers) and (numbers.min() < 1 or len(np.unique(numbers)) < len(numbers)):
        raise InputError(f"mesh file {scan.path.name}: node numbers are not positive and distinct; export it again")
    found.numbers, found.points = numbers, points


def _nodes_4(scan: Scanner, found: _Found) -> None:
    blocks, total = scan.head("nnnn", "the numbers of $Nodes")[:2]
    numbers, points = [np.zeros((0, 1), dtype=np.int64)], [np.zeros((0, 3))]
    for _ in range(blocks):
        dim, _, parametric, count = scan.head("iiin", "'dimension entity parametric count' of nodes")
        if not 0 <= dim <= 3 or parametric not in (0, 1):
            raise scan.damaged("a block of nodes has no dimension from 0 to 3")
        n, _ = scan.table(count, 1, 0, "the number of a node", "n")
        _, x = scan.table(count, 0, 3 + (dim if parametric else 0), "the coordinates of a node")
        numbers.append(n)
        points.append(x[:, :3])
    _take_nodes(scan, found, np.concatenate(numbers)[:, 0], np.concatenate(points), total)


def _elements_4(scan: Scanner, found: _Found) -> None:
    blocks, total = scan.head("nnnn", "the numbers of $Elements")[:2]
    have = 0
    for _ in range(blocks):
        dim, entity, kind, count = scan.head("iiin", "'dimension entity type count' of elements")
        _, nodes = _known(scan, kind)
        what = "'number nodes' of an element, with all of its nodes"
        rows, _ = scan.table(count, 1 + nodes, 0, what, "n")
        found.elements.append((kind, (dim, entity), rows, None))
        have += count
    if have != total:
        raise InputError(f"mesh file {scan.path.name}: has {have} elements and declares {total}; export it again")


def _known(scan: Scanner, kind: int) -> tuple[int, int]:
    """Dimension and number of nodes of a type."""
    if kind not in TYPES and kind not in OTHERS:
        raise InputError(
            f"mesh file {scan.path.name}: elements of Gmsh's type {kind} are not supported; mesh with {SUPPORTED}"
        )
    return (TYPES.get(kind) or OTHERS[kind])[:2]


def _nodes_2(scan: Scanner, found: _Found) -> None:
    (total,) = _count(scan, "the number of nodes")
    n, x = scan.table(total, 1, 3, "'number x y z' of a node")
    _take_nodes(scan, found, n[:, 0], x, total)


def _count(scan: Scanner, what: str) -> list[int]:
    """The number of nodes or elements of version 2: text in binary files, too."""
    binary, scan.binary = scan.binary, False
    found = scan.head("n", what)
    scan.binary = binary
    return found


def _elements_2(scan: Scanner, found: _Found) -> None:
    (total,) = _count(scan, "the number of elements")
    rows: dict[tuple[int, int, int], list[Array | list[int]]] = {}
    if scan.binary:
        have = 0
        while have < total:
            kind, count, tags = scan.take("iii", "a head of elements")
            nodes = _known(scan, kind)[1]
            if count < 1 or not 0 <= tags <= 1000:
                raise scan.damaged("a head of elements has wrong counts")
            table, _ = scan.table(count, 1 + tags + nodes, 0, "an element")
            for row in table:
                _sort_in(rows, kind, row[1 : 1 + tags].tolist(), [int(row[0]), *row[1 + tags :].tolist()])
            have += count
        if have != total:
            raise scan.damaged(f"it has {have} elements and declares {total}")
    else:
        what = "'number type tags nodes' of an element, with all of its nodes"
        lines, begin = scan.lines(total, what)
        for number, line in enumerate(lines, start=begin):
            words = line.split()
            values = [int(w) for w in words] if are_numbers(words, len(words)) else []
            if len(values) < 3 or not 0 <= values[2] <= len(values) - 3:
                raise scan.fault(what, line, number)
            kind, tags = values[1], values[2]
            if len(values) != 3 + tags + _known(scan, kind)[1]:
                raise scan.fault(what, line, number)
            _sort_in(rows, kind, values[3 : 3 + tags], [values[0], *values[3 + tags :]])
    for (kind, entity, group), table in rows.items():
        dim, nodes = _known(scan, kind)
        found.elements.append((kind, (dim, entity), np.array(table, dtype=np.int64).reshape(-1, 1 + nodes),
                               np.full(len(table), group)))  # fmt: skip


def _sort_in(rows: dict, kind: int, tags: list[int], row: list[int]) -> None:
    entity = tags[1] if len(tags) > 1 else 0
    rows.setdefault((kind, abs(entity), abs(tags[0]) if tags else 0), []).append(row)


_SECTIONS: dict[tuple[bytes, str], Callable[[Scanner, _Found], None]] = {
    (b"2", "$PhysicalNames"): _names,
    (b"2", "$Nodes"): _nodes_2,
    (b"2", "$Elements"): _elements_2,
    (b"4", "$PhysicalNames"): _names,
    (b"4", "$Entities"): _entities,
    (b"4", "$PartitionedEntities"): _partitions,
    (b"4", "$Nodes"): _nodes_4,
    (b"4", "$Elements"): _elements_4,
}


def _raw(path: Path, found: _Found) -> RawMesh:
    """The cells and facets with their groups, and notes about the rest."""
    tags = found.numbers if found.numbers is not None else np.zeros(0, dtype=np.int64)
    order = np.argsort(tags)
    ordered = tags[order]
    others: Counter[str] = Counter()
    blocks: list[tuple[str, Array]] = []
    labels: list[Array] = []
    members: dict[str, dict[int, list[Array]]] = {}
    for kind in sorted({kind for kind, *_ in found.elements}, key=[kind for kind, *_ in found.elements].index):
        tables = [(entity, rows, group) for k, entity, rows, group in found.elements if k == kind and len(rows)]
        if kind in OTHERS:
            dim, _, name = OTHERS[kind]
            others[name] += sum(len(rows) for _, rows, _ in tables)
            if dim == 3 and others[name]:
                hint = "; in Gmsh set Mesh.SecondOrderIncomplete = 1" if name == "wedge18" else ""
                raise InputError(
                    f"mesh file {path.name}: {others[name]} {name} cells are not supported; mesh with {SUPPORTED}{hint}"
                )
            continue
        if not tables:
            continue
        dim, _, name, places = TYPES[kind]
        rows = np.concatenate([rows for _, rows, _ in tables])
        first, block = _once(rows, tables)
        start, number = 0, len(blocks)
        for entity, table, group in tables:
            here = block[start : start + len(table)]
            start += len(table)
            for tag in _groups(found, dim, entity, group):
                label = found.names.get((dim, tag), f"{'surface' if dim == 2 else 'volume'}_{tag}")
                chosen = here if group is None else here[group == tag]
                members.setdefault(label, {}).setdefault(number, []).append(chosen)
        corners = rows[first, 1:][:, places]
        nodes = np.searchsorted(ordered, corners)
        if not len(ordered) or np.any(ordered[np.minimum(nodes, len(ordered) - 1)] != corners):
            what = "cell" if dim == 3 else "facet"
            raise InputError(f"mesh file {path.name}: a {what} refers to a node that the file does not contain")
        blocks.append((name, order[nodes]))
        labels.append(rows[first, 0])
    if not any(TYPES_BY_KIND[name] == 3 for name, _ in blocks):
        kinds = ", ".join(sorted([*{name for name, _ in blocks}, *others])) or "nothing"
        raise InputError(
            f"mesh file {path.name}: there are no volume cells (found {kinds}); export the 3-D mesh "
            "(Gmsh saves only what is in a physical group, or all with Mesh.SaveAll = 1)"
        )
    groups = {
        name: [np.unique(np.concatenate([np.zeros(0, dtype=np.int64), *parts.get(b, [])])) for b in range(len(blocks))]
        for name, parts in members.items()
    }
    return RawMesh(found.points, blocks, groups, notes=_notes(found, others, groups), labels=labels)


TYPES_BY_KIND = {kind: dim for dim, _, kind, _ in TYPES.values()}


def _once(rows: Array, tables: list[tuple[tuple[int, int], Array, Array | None]]) -> tuple[Array, Array]:
    """Distinct rows, and the index of each row among them: version 2 lists an element once for each group."""
    if all(group is None for _, _, group in tables):
        return np.arange(len(rows)), np.arange(len(rows))
    marks = np.concatenate(
        [np.full((len(rows), 1), 0) if group is None else group[:, None] for _, rows, group in tables]
    )
    _, alike = np.unique(rows[:, 1:], axis=0, return_inverse=True)
    # twice in one group: two cells at the same position, which is refused later
    _, times = np.unique(np.column_stack([alike.ravel(), marks]), axis=0, return_counts=True)
    if times.max() > 1:
        return np.arange(len(rows)), np.arange(len(rows))
    _, first, which = np.unique(alike.ravel(), return_index=True, return_inverse=True)
    places = np.sort(first)
    return places, np.searchsorted(places, first[which.ravel()])


def _groups(found: _Found, dim: int, entity: tuple[int, int], group: Array | None) -> list[int]:
    """The tags of the groups that elements of an entity are in."""
    if group is not None:
        return [int(tag) for tag in np.unique(group) if tag > 0]
    seen = 0
    while entity in found.groups and seen < 5:
        parent = found.parents.get(entity)
        if found.groups[entity] or parent is None or parent[0] != dim:
            return found.groups[entity]
        entity, seen = parent, seen + 1
    return []


def _notes(found: _Found, others: Counter[str], groups: dict[str, list[Array]]) -> tuple[str, ...]:
    notes = []
    facets = {name: count for name, count in others.items() if name not in ("points", "lines") and count}
    if facets:
        listed = ", ".join(f"{count} {name}" for name, count in sorted(facets.items()))
        notes.append(f"facets of kinds that no cell has are left out: {listed}")
    empty = [name for (dim, _), name in found.names.items() if name not in groups]
    if empty:
        notes.append(f"groups without cells or facets are left out: {', '.join(dict.fromkeys(empty))}")
    if found.unused:
        notes.append(f"sections that are not used: {', '.join(f'{n} ({c})' for n, c in found.unused.items())}")
    return tuple(notes)


SHOWN = 60  # characters of a bad line in a message


class Scanner:
    """The content of a file, as text or binary, from `at` on."""

    def __init__(self, path: Path, content: bytes) -> None:
        self.path, self.content = path, content
        self.at, self.line = 0, 0
        self.binary, self.order, self.version = False, "<", b""
        self._words: list[bytes] = []

    def fault(self, what: str, line: bytes | None = None, number: int | None = None) -> InputError:
        if self.binary:
            return self.damaged(what)
        if self.at >= len(self.content) and line is None:
            return InputError(f"mesh file {self.path.name}: cannot be read (it ends too early); export it again")
        shown = (line or b"")[:SHOWN].decode("ascii", errors="replace").strip()
        at = number or self.line
        return InputError(f"mesh file {self.path.name}, line {at}: {shown!r} is not {what}; export it again")

    def damaged(self, what: str) -> InputError:
        return InputError(f"mesh file {self.path.name}: cannot be read ({what}); export it again")

    def text_line(self) -> bytes:
        """The next line without its end."""
        end = self.content.find(b"\n", self.at)
        end = len(self.content) if end < 0 else end
        found = self.content[self.at : end]
        self.at, self.line = end + 1, self.line + 1
        return found

    def take(self, form: str, what: str) -> list:
        """Numbers: i an int, n a size, d a double; of a text the next words, from the next line where a line ends."""
        if self.binary:
            layout = self.order + form.replace("n", "Q")
            size = struct.calcsize(layout)
            if self.at + size > len(self.content):
                raise self.damaged("it ends too early")
            values = list(struct.unpack_from(layout, self.content, self.at))
            self.at += size
            return values
        if form and not self._words:
            line = self.text_line()
            self._words = line.split()[::-1]
            if not self._words:
                raise self.fault(what, line)
        values = []
        for letter in form:
            if not self._words:
                raise self.fault(what, b"")
            values.append(self._number(self._words.pop(), letter == "d", what))
        return values

    def end(self, what: str) -> None:
        """The line has no more words."""
        if self._words:
            raise self.fault(what, b" ".join(self._words[::-1]))

    def head(self, form: str, what: str) -> list:
        """The numbers of a line of their own."""
        values = self.take(form, what)
        self.end(what)
        return values

    def _number(self, word: bytes, real: bool, what: str) -> float | int:
        try:
            if b"_" in word or (not real and len(word) > MOST_DIGITS):
                raise ValueError
            value = float(word) if real else int(word)
        except ValueError:
            raise self.fault(what, word) from None
        if not np.isfinite(value):
            raise self.fault(what, word)
        return value

    def table(self, count: int, ints: int, reals: int, what: str, size: str = "i") -> tuple[Array, Array]:
        """`count` lines of `ints` whole numbers and `reals` finite ones: (count, ints) and (count, reals)."""
        if self.binary:
            layout = np.dtype([("n", self.order + {"i": "i4", "n": "u8"}[size], ints), ("x", self.order + "f8", reals)])
            if not 0 <= count <= (len(self.content) - self.at) // layout.itemsize:
                raise self.damaged("it ends too early")
            rows = np.frombuffer(self.content, layout, count, self.at)
            self.at += count * layout.itemsize
            if not np.isfinite(rows["x"]).all() or (ints and np.any(rows["n"] > np.uint64(10**MOST_DIGITS))):
                raise self.damaged(f"{what} contains no numbers")
            return rows["n"].astype(np.int64).reshape(count, ints), rows["x"].astype(float).reshape(count, reals)
        lines, begin = self.lines(count, what)
        words = [line.split() for line in lines]
        for number, row in enumerate(words):
            if len(row) != ints + reals:
                raise self.fault(what, lines[number], begin + number)
        try:
            if any(b"_" in line for line in lines):
                raise ValueError
            n = np.array([int(w) for row in words for w in row[:ints]], dtype=np.int64)
            x = np.array([float(w) for row in words for w in row[ints:]], dtype=float)
        except (ValueError, OverflowError):
            n, x = np.zeros(0, dtype=np.int64), np.full(1, np.nan)
        if not np.isfinite(x).all() or (len(n) and np.abs(n).max() >= 10**MOST_DIGITS):
            bad = next(i for i, row in enumerate(words) if not are_numbers(row, ints))
            raise self.fault(what, lines[bad], begin + bad)
        return n.reshape(count, ints), x.reshape(count, reals)

    def lines(self, count: int, what: str) -> tuple[list[bytes], int]:
        """The next `count` lines, and the number of the first."""
        if not 0 <= count <= len(self.content) - self.at:
            raise self.damaged(f"it declares {count} lines, more than it has")
        begin = self.line + 1
        found = [self.text_line() for _ in range(count) if self.at < len(self.content)]
        if len(found) < count:
            raise self.damaged("it ends too early")
        return found, begin


def are_numbers(words: list[bytes], ints: int) -> bool:
    """Whether the first `ints` words are whole numbers and the others finite ones."""
    try:
        whole = all(len(w) <= MOST_DIGITS and b"_" not in w and int(w) is not None for w in words[:ints])
        return whole and all(b"_" not in w and np.isfinite(float(w)) for w in words[ints:])
    except ValueError:
        return False
