r"""Ansys databases as text, written by CDWRITE (.cdb), and the input files of Workbench with the same blocks.

| command | here |
|---|---|
| NBLOCK | nodes, in global Cartesian coordinates |
| EBLOCK | elements: cell sets `type_T` and `material_M` of solids, facet sets of surface elements |
| ET, ETBLOCK | the kind of element of each type, by its number: SOLID185 is 185 |
| CMBLOCK | components of elements: cell and facet sets; of nodes: the outer facets all of whose nodes are in it |
| MP, MPDATA | EX, NUXY or PRXY, DENS of each material, at its first temperature |

Solids with repeated nodes, as Ansys writes wedges and tetrahedra, are read as what remains; a quadratic solid without
any mid-side node is linear. mapdl-archive is not used: damaged files end its process (17 of 300), and it reads no
materials.
"""

from __future__ import annotations

import re
from collections import Counter
from dataclasses import dataclass, field
from pathlib import Path

import numpy as np

from warpffrf.model.errors import InputError
from warpffrf.model.material import Material
from warpffrf.model.mesh.files.columns import CHUNK, Lines, widths
from warpffrf.model.mesh.files.raw_mesh import RawMesh, listed_counts, places, require_once, system_of

Array = np.ndarray

# element types by their shape: solids, and what lies on their surface
_SOLIDS = {
    "hex8": (5, 45, 46, 62, 64, 65, 69, 70, 96, 97, 164, 185, 190, 278),
    "hex20": (90, 95, 122, 186, 191, 226, 231, 236, 279),
    "tet4": (285,),
    "tet10": (87, 92, 98, 123, 168, 187, 227, 232, 237),
}
_SURFACES = (
    *(28, 41, 43, 63, 91, 93, 99, 131, 132, 143, 150, 152, 154, 157, 163, 181, 281),
    *(170, 173, 174, 200),  # targets, contacts, meshes without properties
)
_KIND = {number: kind for kind, numbers in _SOLIDS.items() for number in numbers}
_CORNERS = {"hex8": 8, "hex20": 8, "tet4": 4, "tet10": 4}
_LINEAR = {"hex20": "hex8", "tet10": "tet4"}
WIDEST_INTEGER = 20  # columns of an integer: a line of one may be the -1 that ends a block
_REFUSED = {"N", "E", "EN", "NGEN", "EGEN", "FILL", "VMESH", "NUMMRG"}  # they create, or change, nodes and elements
_BLOCKED = "write the database with CDWRITE,DB,FILE,CDB and without UNBLOCKED"
_NUMBER = re.compile(r"[+-]?(?>[0-9]++\.?+[0-9]*+|\.[0-9]++)(?:[ED][+-]?[0-9]++)?+")
_DIGITS = re.compile(r"[0-9]{1,9}")
_LABELS = ("EX", "EY", "EZ", "NUXY", "PRXY", "DENS")


@dataclass
class _Elements:
    """Rows of all blocks of elements: number, type, material, count of nodes; nodes (n, 20 at most), 0 where there is
    none; the line of each."""

    rows: list[Array] = field(default_factory=list)
    nodes: list[Array] = field(default_factory=list)
    lines: list[Array] = field(default_factory=list)


class _Database:
    """The contents of a file, command by command."""

    def __init__(self, path: Path) -> None:
        self.lines = Lines(path, "mesh file")
        self.numbers: list[Array] = []  # of nodes
        self.points: list[Array] = []
        self.elements = _Elements()
        self.types: dict[int, int] = {}
        self.components: dict[str, tuple[str, Array]] = {}
        self.properties: dict[int, dict[str, float]] = {}
        self.varying: set[int] = set()  # materials that depend on temperature
        self.ignored: Counter[str] = Counter()
        self.type = 1  # of elements in blocks that give none
        self.skipping = False  # lines of numbers of a command that is not used
        i = 0
        while i < len(self.lines):
            i = self._command(i)

    def _command(self, i: int) -> int:
        """Take line `i`; the line after it and its block."""
        text = self.lines.text(i).split("!", 1)[0].strip()
        words = [word.strip() for word in text.split(",")]
        name = words[0].upper()
        block = {"NBLOCK": self._nodes, "EBLOCK": self._block, "CMBLOCK": self._component, "ETBLOCK": self._type_block}
        if self.skipping and text and text[0] in "(-.0123456789":
            return i + 1
        self.skipping = name == "*PREAD" or (name.endswith("BLOCK") and name not in block)
        if not text or text[0] in "/*" or "=" in words[0] or name.startswith("C***"):
            return i + 1  # titles, output, parameters
        if not name[:1].isalpha():
            raise self.lines.fault(i, f"{self.lines.short(i)} is no command; write the file again")
        if name in block:
            return block[name](i, words)
        for part in text.split("$"):
            self._take(i, [word.strip() for word in part.split(",")])
        return i + 1

    def _take(self, i: int, words: list[str]) -> None:
        """Take a command of one line."""
        name = words[0].upper()
        if name == "ET":
            self.types[self._whole(i, words, 1)] = self._element_type(i, words)
        elif name == "TYPE":
            self.type = self._whole(i, words, 1)
        elif name in ("MP", "MPDATA"):
            self._property(i, name, words)
        elif name in _REFUSED and not (len(words) > 1 and words[1].upper() in ("R5.3", "R5.1", "R5.5", "UNBL")):
            raise self.lines.fault(i, f"{name} is not read, only nodes and elements in blocks; {_BLOCKED}")
        elif name not in _REFUSED and name != "MPTEMP":
            self.ignored[name[:20]] += 1

    def _whole(self, i: int, words: list[str], at: int) -> int:
        text = words[at] if at < len(words) else ""
        if not _DIGITS.fullmatch(text):
            raise self.lines.fault(i, f"{words[0].upper()}: field {at + 1} must be a whole number, got {text[:40]!r}")
        return int(text)

    def _element_type(self, i: int, words: list[str]) -> int:
        """The number of an element type, given as such or as its name."""
        found = re.fullmatch(r"[A-Za-z]*([0-9]{1,3})", words[2]) if len(words) > 2 else None
        if found is None:
            raise self.lines.fault(i, f"{self.lines.short(i)} names no element type, such as 185 or SOLID185")
        return int(found[1])

    def _form(self, i: int, what: str) -> tuple[list[int], list[int]]:
        """Column widths by the format in line `i`."""
        found = widths(self.lines.text(i)) if i < len(self.lines) else None
        if found is None or not found[0]:
            raise self.lines.fault(i, f"{what}: a format such as (3i9,6e21.13e3) must follow; {_BLOCKED}")
        return found

    def _rows(self, i: int, what: str, count: int | None = None) -> Array:
        """Numbers of the lines of a block from line `i` on, up to -1 or a command, at most `count`."""
        end, limit = i, len(self.lines) if count is None else min(i + count, len(self.lines))
        while end < limit:
            window = min(end + CHUNK, limit)
            first = self.lines.bytes[self.lines.starts[end:window]]  # a line end of an empty line
            length = self.lines.stops[end:window] - self.lines.starts[end:window]
            inside = (first == ord(" ")) | ((first >= ord("0")) & (first <= ord("9")))
            for k in np.flatnonzero(inside & (length <= WIDEST_INTEGER)).tolist():
                inside[k] = self.lines.text(end + k).strip() != "-1"
            if not inside.all():
                end += int(np.argmin(inside))
                break
            end = window
        if end == len(self.lines) and (count is None or end < i + count):
            raise self.lines.fault(end, f"the end of {what} is missing, a line -1; write the file again")
        return np.arange(i, end)

    def _after(self, end: int) -> int:
        return end + 1 if end < len(self.lines) and self.lines.text(end).strip() == "-1" else end

    def _declared(self, i: int, words: list[str], found: int, at: int, what: str) -> None:
        if at < len(words) and words[at] and self._whole(i, words, at) not in (0, found):
            raise self.lines.fault(
                i, f"{words[0].upper()} declares {words[at]} {what}, {found} follow; write the file again"
            )

    def _nodes(self, i: int, words: list[str]) -> int:
        integers, reals = self._form(i + 1, "NBLOCK")
        if len(reals) < 3:
            raise self.lines.fault(i + 1, "NBLOCK: three coordinates are needed; write the file again")
        rows = self._rows(i + 2, "NBLOCK")
        whole, real = self.lines.table(rows, integers, reals, needed=0)  # CDWRITE omits zeros
        self._declared(i, words, len(rows), 4, "nodes")
        if len(rows) and whole[:, 0].min() < 1:
            raise self.lines.fault(int(rows[np.argmin(whole[:, 0])]), "nodes are numbered from 1; write the file again")
        self.numbers.append(whole[:, 0])
        self.points.append(real[:, :3])
        return self._after(i + 2 + len(rows))

    def _block(self, i: int, words: list[str]) -> int:
        integers, _ = self._form(i + 1, "EBLOCK")
        solid = len(words) > 2 and words[2].upper() == "SOLID"
        if len(integers) < (19 if solid else 6):
            raise self.lines.fault(i + 1, f"EBLOCK has {len(integers)} columns, too few; write the file again")
        rows = self._rows(i + 2, "EBLOCK")
        whole, _ = self.lines.table(rows, integers)
        taken = self._solid_rows(rows, whole) if solid else self._other_rows(rows, whole)
        self._declared(i, words, len(taken[0]), 4, "elements")
        for kept, part in zip((self.elements.rows, self.elements.nodes, self.elements.lines), taken, strict=True):
            kept.append(part)
        return self._after(i + 2 + len(rows))

    def _solid_rows(self, rows: Array, whole: Array) -> tuple[Array, Array, Array]:
        """Material, type, ..., count of nodes (9th), -, number (11th), 8 nodes; the other nodes in a second line."""
        begin = _begins(whole[:, 8])
        head = whole if len(begin) == len(whole) else whole[begin]
        count = head[:, 8]
        cut = (count < 1) | (count > 20) | ((count > 8) & (begin == len(rows) - 1))
        if cut.any():
            k = int(np.argmax(cut))
            raise self.lines.fault(
                int(rows[begin[k]]),
                f"EBLOCK: an element of {count[k]} nodes, or without its second line; write it again",
            )
        nodes, long = head[:, 11:19], count > 8
        if long.any():
            nodes = np.pad(nodes, ((0, 0), (0, 12)))
            nodes[long, 8:] = whole[begin[long] + 1, :12]
        fewer = [n for n in np.unique(count).tolist() if n < nodes.shape[1]]
        if any(nodes[count == n, n:].any() for n in fewer) or whole[begin[long] + 1, 12:].any():
            raise self.lines.fault(int(rows[0]), "EBLOCK: elements have more nodes than they declare; write it again")
        return np.stack([head[:, k] for k in (10, 1, 0, 8)], axis=1), nodes, rows[begin]

    def _other_rows(self, rows: Array, whole: Array) -> tuple[Array, Array, Array]:
        """Number, section, constants, material, system, nodes, of the type that TYPE names."""
        nodes = whole[:, 5:25]
        type_, count = np.full(len(rows), self.type), np.sum(nodes > 0, axis=1)
        return np.stack([whole[:, 0], type_, whole[:, 3], count], axis=1), nodes, rows

    def _type_block(self, i: int, words: list[str]) -> int:
        integers, _ = self._form(i + 1, "ETBLOCK")
        rows = self._rows(i + 2, "ETBLOCK")
        for row in rows.tolist():
            found = self.lines.text(row)[: sum(integers[:2])].split()
            if len(found) != 2 or not all(_DIGITS.fullmatch(word) for word in found):
                raise self.lines.fault(row, f"ETBLOCK: {self.lines.short(row)} is no number and element type")
            self.types[int(found[0])] = int(found[1])
        return self._after(i + 2 + len(rows))

    def _component(self, i: int, words: list[str]) -> int:
        kind = words[2].upper()[:4] if len(words) > 2 else ""
        if len(words) < 4 or not words[1] or kind not in ("NODE", "ELEM"):
            raise self.lines.fault(i, "CMBLOCK needs a name, NODE or ELEM, and a number of items; write the file again")
        count = self._whole(i, words, 3)
        integers, _ = self._form(i + 1, "CMBLOCK")
        rows = self._rows(i + 2, f"CMBLOCK {words[1]}", -(-count // len(integers)))
        whole, _ = self.lines.table(rows, integers)
        items = whole.ravel()[:count]
        if len(items) < count or not np.all(items) or whole.ravel()[count:].any() or (count and items[0] < 0):
            raise self.lines.fault(
                i, f"CMBLOCK {words[1]}: its lines do not hold {count} numbers; write the file again"
            )
        high = np.flatnonzero(items < 0)  # the end of a range whose beginning is before it
        low, top = items[high - 1], -items[high]
        if np.any(low < 0) or np.any(top <= low) or np.sum(top - low) > len(self.lines):
            raise self.lines.fault(i, f"CMBLOCK {words[1]}: a range ends before it begins; write the file again")
        ranges = [np.arange(a + 1, b + 1) for a, b in zip(low.tolist(), top.tolist(), strict=True)]
        name = words[1] if words[1] not in self.components else f"{words[1]} ({kind.lower()})"
        self.components[name] = kind, np.unique(np.concatenate([items[items > 0], *ranges]))
        return self._after(i + 2 + len(rows))

    def _property(self, i: int, command: str, words: list[str]) -> None:
        """MP,Lab,MAT,C0,C1,...; MPDATA,R5.0,count,Lab,MAT,first,C1,C2,...; MPDATA,Lab,MAT,first,C1,..."""
        at = 3 if command == "MPDATA" and len(words) > 1 and words[1].upper().startswith("R5") else 1
        label = words[at].upper() if at < len(words) else ""
        if label not in _LABELS:
            self.ignored[f"{command} {label}"] += 1
            return
        number = self._whole(i, words, at + 1)
        if command == "MPDATA" and at == 3 and self._whole(i, words, at + 2) > 1:
            self.varying.add(number)  # values at further temperatures
            return
        values = []
        for text in ",".join(words[at + 3 if command == "MPDATA" else at + 2 :]).rstrip(",").split(","):
            if text and not _NUMBER.fullmatch(text.upper()):
                raise self.lines.fault(i, f"{command}: {text[:40]!r} is no number; repair the line")
            values.append(float(text.upper().replace("D", "E")) if text else 0.0)
        if any(v not in ((0.0, values[0])[command == "MPDATA" :]) for v in values[1:]):
            self.varying.add(number)
        self.properties.setdefault(number, {})[label] = values[0]


def read_cdb(path: Path, length_unit: str) -> RawMesh:
    """Contents of a file of CDWRITE. Raises `InputError`, with the line, for damaged blocks and unknown references."""
    data = _Database(path)
    label = data.lines.label
    if not data.numbers or not data.elements.rows:
        missing = "NBLOCK" if not data.numbers else "EBLOCK"
        raise InputError(f"{label}: there is no {missing}; {_BLOCKED}")
    numbers, points = np.concatenate(data.numbers), np.concatenate(data.points)
    rows, lines = (np.concatenate(parts) for parts in (data.elements.rows, data.elements.lines))
    widest = max(part.shape[1] for part in data.elements.nodes)
    nodes = np.concatenate([np.pad(part, ((0, 0), (0, widest - part.shape[1]))) for part in data.elements.nodes])
    for what, found in (("node", numbers), ("element", rows[:, 0])):
        require_once(found, f"{label}: {what}")
    nodes = _positions(data, numbers, nodes, rows, lines)
    kinds = _kinds(data, rows, lines)
    notes: list[str] = []
    blocks, members = _blocks(data, kinds, rows, nodes, lines, notes)
    groups = _groups(data, rows, members, notes)
    node_groups = {name: _found(numbers, items) for name, (kind, items) in data.components.items() if kind == "NODE"}
    materials = _materials(data, length_unit, notes)
    if "FINISH" not in data.ignored:
        notes.append("the file does not end with FINISH, as CDWRITE ends it: is it whole?")
    del data.ignored["FINISH"]
    if data.ignored:
        notes.append(f"commands that are not used: {listed_counts(data.ignored)}")
    labels = [rows[m, 0] for m in members]
    more = {"stray_facets": True, "labels": labels, "node_groups": node_groups}
    return RawMesh(points, blocks, groups, materials, tuple(notes), **more)


def _begins(counts: Array) -> Array:
    """Rows of a block at which elements begin: those of more than eight nodes take two."""
    if np.all(counts <= 8):
        return np.arange(len(counts))
    begins, k = [], 0
    listed = counts.tolist()
    while k < len(listed):
        begins.append(k)
        k += 1 if listed[k] <= 8 else 2
    return np.array(begins, dtype=np.int64)


def _found(numbers: Array, items: Array) -> Array:
    return np.flatnonzero(np.isin(numbers, items))


def _positions(data: _Database, numbers: Array, nodes: Array, rows: Array, lines: Array) -> Array:
    """Nodes as positions, -1 where there is none."""
    place = places(numbers, nodes)
    missing = (nodes != 0) & (place < 0)
    if missing.any():
        k, column = np.argwhere(missing)[0]
        raise data.lines.fault(
            int(lines[k]), f"node {nodes[k, column]} of element {rows[k, 0]} is not in NBLOCK; write all nodes"
        )
    return place


def _kinds(data: _Database, rows: Array, lines: Array) -> Array:
    """Element type of each element, such as 185."""
    used = np.unique(rows[:, 1])
    for number in used.tolist():
        if number not in data.types:
            k = int(np.argmax(rows[:, 1] == number))
            raise data.lines.fault(
                int(lines[k]),
                f"element {rows[k, 0]} is of type {number}, which no ET defines; write the whole database",
            )
    kinds = np.array([data.types[number] for number in used.tolist()])
    return kinds[np.searchsorted(used, rows[:, 1])]


def _blocks(
    data: _Database, kinds: Array, rows: Array, nodes: Array, lines: Array, notes: list[str]
) -> tuple[list[tuple[str, Array]], list[Array]]:
    """Blocks of cells and facets, and the elements of each."""
    blocks: list[tuple[str, Array]] = []
    members: list[Array] = []

    def add(kind: str, chosen: Array, table: Array) -> None:
        if len(chosen):
            blocks.append((kind, table))
            members.append(chosen)

    left: Counter[str] = Counter()
    for number in np.unique(kinds).tolist():
        chosen = np.flatnonzero(kinds == number)
        if number in _KIND:
            kind = _KIND[number]
            corners, full = _CORNERS[kind], int(re.sub(r"\D", "", kind))
            table = nodes[chosen][:, :full]
            bare = np.all(table[:, corners:] < 0, axis=1) & (full > corners)
            whole = np.all(table >= 0, axis=1)
            bad = ~(whole | (bare & np.all(table[:, :corners] >= 0, axis=1))) | np.any(
                nodes[chosen][:, full:] >= 0, axis=1
            )
            if bad.any():
                k = int(chosen[np.argmax(bad)])
                raise data.lines.fault(
                    int(lines[k]),
                    f"element {rows[k, 0]} of type {number} has {np.sum(nodes[k] >= 0)} of its {full} nodes; give all "
                    "of its mid-side nodes or none (EMID)",
                )
            notes.append(f"{len(chosen)} elements of type {number} are integrated fully")
            add(kind, chosen[~bare], table[~bare])
            if bare.any():
                notes.append(f"{np.sum(bare)} elements of type {number} have no mid-side nodes and are {_LINEAR[kind]}")
                add(_LINEAR[kind], chosen[bare], table[bare][:, :corners])
        elif number in _SURFACES and np.all(nodes[chosen][:, :3] >= 0):
            first = nodes[chosen][:, :4]
            three = (first[:, 3] < 0) | (first[:, 3] == first[:, 2])
            add("tri3", chosen[three], first[three][:, :3])
            add("quad4", chosen[~three], first[~three])
        else:
            left[f"type {number}"] += len(chosen)
    if left:
        notes.append(f"elements that are not used: {listed_counts(left)}")
    return blocks, members


def _groups(data: _Database, rows: Array, members: list[Array], notes: list[str]) -> dict[str, list[Array]]:
    """Members in each block of components, types and materials; `notes` state which are not read."""
    found: dict[str, list[Array]] = {}
    for name, (kind, items) in data.components.items():
        if kind == "ELEM":
            found[name] = [np.flatnonzero(np.isin(rows[m, 0], items)) for m in members]
            missing = len(items) - sum(map(len, found[name]))
            if missing:
                notes.append(f"component {name!r}: {missing} of {len(items)} elements are not read")
    for what, column in (("type", 1), ("material", 2)):
        for number in np.unique(rows[:, column]).tolist():
            found.setdefault(f"{what}_{number}", [np.flatnonzero(rows[m, column] == number) for m in members])
    return found


def _materials(data: _Database, length_unit: str, notes: list[str]) -> dict[str, Material]:
    """{material_M: Material} [SI]; `notes` list omitted data."""
    system = system_of(length_unit, notes) if data.properties else None
    if system is None:
        return {}
    stress, density, units = system
    found: dict[str, Material] = {}
    for number, given in sorted(data.properties.items()):
        name = f"material {number}"
        E = given.get("EX", 0.0)
        nu = given.get("PRXY", given.get("NUXY", 0.0))
        if any(given.get(label, E) != E for label in ("EY", "EZ")):
            notes.append(f"{name} is not used: it is orthotropic; define the material in the call")
            continue
        if number in data.varying:
            notes.append(f"{name}: values at the first temperature, or the constant terms, are used")
        try:
            found[f"material_{number}"] = Material(stress * E, nu, density * given.get("DENS", 0.0), name=name)
        except InputError as error:
            notes.append(f"{name} is not used: {error}")
    if found:
        notes.append(f"materials are read in {units}, the system of units with lengths in {length_unit}")
    return found
