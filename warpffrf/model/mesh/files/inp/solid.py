"""The nodes and solid cells of one body: numbers of the deck become indices, unused nodes are removed, the instance is
placed.

Nodes are ordered by their number in the deck, cells by kind in the order in which the kinds appear, then as in the
deck. A number of several nodes refers to the last of them, as in Abaqus.

Body. One body of a deck, and the meaning of names and numbers of sets for it.

A body is an instance with its part, a part without an instance, or a deck without parts. Two levels of names apply:

- its *own* scopes (the contents of the instance, then the part), where a number is one of its nodes or elements;
- the *assembly*, where numbers belong to the instance of `INSTANCE=`, and `instance.name` or `instance.number` refers
  to an object of an instance.

Sets may name other sets, defined before or after. Members of other instances are ignored.
"""

from __future__ import annotations

from collections import Counter
from collections.abc import Mapping
from dataclasses import dataclass, field
from functools import cached_property

import numpy as np

from warpffrf.model.errors import InputError
from warpffrf.model.mesh.checks import part_labels
from warpffrf.model.mesh.files.inp.deck import Place
from warpffrf.model.mesh.files.inp.model import (
    FAMILIES,
    Elements,
    Instance,
    Scope,
    SetDefinition,
    SurfaceDefinition,
    Table,
    faces_of,
    fold,
    formulation,
    is_volume,
    number_or_none,
)
from warpffrf.model.mesh.files.raw_mesh import face_numbers, left_over, repeated


@dataclass(frozen=True, eq=False)
class Solid:
    """`points` (n, 3) [file's unit] of the used nodes with their numbers `node_labels` (n,), ascending;
    `cells` {kind: (m, k) indices}; `cell_labels` (N,) in the order of the blocks; `notes` the replacements.
    `became` {element: {face: face}}: S numbers of elements that are read as the remaining cell (`collapsed`).
    """

    points: np.ndarray
    node_labels: np.ndarray
    cells: Mapping[str, np.ndarray]
    cell_labels: np.ndarray
    notes: tuple[str, ...]
    became: Mapping[int, Mapping[int, int]]

    def face_numbers(self, numbers: np.ndarray, face: int) -> np.ndarray:
        """Of cells with these numbers, the S number that `face` of the deck has here; 0 if it has vanished."""
        found = np.full(len(numbers), face)
        for i in np.flatnonzero(np.isin(self.cell_labels[numbers], list(self.became))) if self.became else ():
            found[i] = self.became[int(self.cell_labels[numbers[i]])].get(face, 0)
        return found

    def node_mask(self, labels: np.ndarray) -> np.ndarray:
        """Which nodes (n,) have one of the numbers."""
        return np.isin(self.node_labels, labels)

    def cell_numbers(self, labels: np.ndarray) -> np.ndarray:
        """Sorted cell numbers of the elements with these numbers; those that are no solid cells are ignored."""
        ordered, order = self._by_label
        return np.sort(order[np.searchsorted(ordered, present(labels, ordered))])

    @cached_property
    def _by_label(self) -> tuple[np.ndarray, np.ndarray]:
        order = np.argsort(self.cell_labels)
        return self.cell_labels[order], order


def solid_of(
    body: Body, part: int | str | None, file: str, more: np.ndarray | None = None, read: np.ndarray | None = None
) -> Solid:
    """The nodes and cells of `body`; `part` keeps one element set (a name) or one connected part (a number) of it.
    `more`: numbers of nodes of the structural elements `read` (their numbers), without which there must be cells.

    Raises `InputError` for elements that refer to unknown nodes, share a number or have an unsupported solid type.
    """
    blocks = [block for scope in reversed(body.own) for block in scope.elements]  # the part, then the instance's own
    for block in blocks:
        if block.kind is None and is_volume(block.type):
            raise block.place.fault(f"solid elements of type {block.type} are not supported; use C3D4 to C3D20")
    labels, coordinates, notes = _nodes(body)
    by_kind: dict[str, list[Table]] = {}
    for block in blocks:
        if block.kind is not None and block.table is not None and len(block.labels):
            by_kind.setdefault(block.kind, []).append(block.table)
    extra = np.zeros(0, dtype=np.int64) if more is None else more
    if not by_kind and not len(extra):
        raise InputError(f"mesh file {file}: there are no solid elements; export the 3-D mesh")
    _unique_numbers([table for tables in by_kind.values() for table in tables])
    cells = {kind: np.concatenate([_indices(table, labels) for table in tables]) for kind, tables in by_kind.items()}
    numbers = np.concatenate(
        [np.zeros(0, dtype=np.int64), *(table.labels for tables in by_kind.values() for table in tables)]
    )
    cells, numbers, became, collapsed_notes = _uncollapsed(cells, numbers, file)
    notes += collapsed_notes
    if part is not None:
        cells, numbers = _kept(cells, numbers, _wanted(body, part, file, cells, numbers, len(labels)))

    if part is None and len(extra):
        known = labels[np.minimum(np.searchsorted(labels, extra), len(labels) - 1)] == extra
        if not known.all():
            raise InputError(f"mesh file {file}: a structural element refers to the missing node {extra[~known][0]}")
        extra = np.searchsorted(labels, extra)
    else:
        extra = extra[:0]
    used = np.unique(np.concatenate([extra, *(nodes.ravel() for nodes in cells.values())]))
    new_number = np.full(len(labels), -1, dtype=np.int64)
    new_number[used] = np.arange(len(used))
    if len(used) < len(labels) and part is None:
        notes.append(f"{len(labels) - len(used)} nodes belong to no solid cell and are left out")
    notes += _element_notes(blocks, np.zeros(0, dtype=np.int64) if read is None else read)
    points = _placed(body, coordinates[used], file)
    return Solid(
        points, labels[used], {kind: new_number[n] for kind, n in cells.items()}, numbers, tuple(notes), became
    )


def _uncollapsed(
    cells: Mapping[str, np.ndarray], numbers: np.ndarray, file: str
) -> tuple[dict[str, np.ndarray], np.ndarray, dict[int, Mapping[int, int]], list[str]]:
    """Cells and their numbers in the deck, with the remaining cells of those with a node twice at the end of their
    kind."""
    kept: dict[str, list[np.ndarray]] = {}
    labels: dict[str, list[np.ndarray]] = {}
    moved: dict[str, list[tuple[int, list[int]]]] = {}
    became: dict[int, Mapping[int, int]] = {}
    notes: list[str] = []
    start = 0
    for kind, nodes in cells.items():
        own = numbers[start : start + len(nodes)]
        start += len(nodes)
        bad = repeated(nodes)
        kept.setdefault(kind, []).append(nodes[~bad])
        labels.setdefault(kind, []).append(own[~bad])
        for row in np.flatnonzero(bad):
            left = left_over(kind, nodes[row])
            if left is None:
                raise InputError(
                    f"mesh file {file}: element {own[row]} ({kind}) has repeated nodes and is neither a wedge nor a "
                    "tetrahedron; mesh with these instead"
                )
            moved.setdefault(left[0], []).append((int(own[row]), left[1]))
            became[int(own[row])] = face_numbers(faces_of(kind), nodes[row], faces_of(left[0]), np.array(left[1]))
        if bad.any():
            notes.append(f"{np.sum(bad)} {kind} cells with repeated nodes are read as wedges or tetrahedra")
    for kind, rows in moved.items():
        kept.setdefault(kind, []).append(np.array([nodes for _, nodes in rows], dtype=np.int64))
        labels.setdefault(kind, []).append(np.array([label for label, _ in rows], dtype=np.int64))
    made = {kind: np.concatenate(parts) for kind, parts in kept.items()}
    made = {kind: nodes for kind, nodes in made.items() if len(nodes)}
    found = [np.zeros(0, dtype=np.int64), *(a for kind in made for a in labels[kind])]
    return made, np.concatenate(found), became, notes


def _nodes(body: Body) -> tuple[np.ndarray, np.ndarray, list[str]]:
    """Sorted node numbers, their coordinates, and a note where one number has several positions."""
    tables = [table for scope in reversed(body.own) for table in scope.nodes]
    labels = np.concatenate([np.zeros(0, dtype=np.int64), *(t.labels for t in tables)])
    coordinates = np.concatenate([np.zeros((0, 3)), *(t.rows for t in tables)])
    unique, last, inverse = np.unique(labels[::-1], return_index=True, return_inverse=True)
    kept = coordinates[::-1][last]
    moved = np.unique(labels[::-1][np.any(kept[inverse.ravel()] != coordinates[::-1], axis=1)])
    notes = []
    if len(moved):
        notes.append(
            f"{len(moved)} node numbers are defined twice with different positions, the last is used: {moved[0]}"
        )
    return unique, kept, notes


def _unique_numbers(tables: list[Table]) -> None:
    numbers = np.concatenate([np.zeros(0, dtype=np.int64), *(table.labels for table in tables)])
    order = np.argsort(numbers, kind="stable")
    twice = np.flatnonzero(np.diff(numbers[order]) == 0)
    if len(twice):
        first, second = (_place_of_row(tables, int(order[twice[0] + i])) for i in (0, 1))
        raise second.fault(f"element {numbers[order[twice[0]]]} is defined already, in {first}")


def _place_of_row(tables: list[Table], row: int) -> Place:
    for table in tables:
        if row < len(table.labels):
            return table.place(row)
        row -= len(table.labels)
    raise IndexError(row)


def _indices(table: Table, labels: np.ndarray) -> np.ndarray:
    """Node indices (m, k) of a table of elements."""
    place = np.searchsorted(labels, table.rows)
    if not len(labels):
        raise table.place(0).fault(f"element {table.labels[0]} refers to node {table.rows[0, 0]}, but there are none")
    unknown = labels[np.minimum(place, len(labels) - 1)] != table.rows
    if unknown.any():
        row, column = (int(i) for i in np.argwhere(unknown)[0])
        raise table.place(row).fault(
            f"element {table.labels[row]} refers to node {table.rows[row, column]}, which does not exist"
        )
    return place


def _wanted(
    body: Body, part: int | str, file: str, cells: Mapping[str, np.ndarray], numbers: np.ndarray, node_count: int
) -> np.ndarray:
    """Which cells (N,) belong to the requested part."""
    if isinstance(part, str):
        if body.definition(OWN, "elset", part) is None:
            known = ", ".join(repr(d.name) for d in body.own[0].sets["elset"].values()) or "none"
            raise InputError(f"mesh file {file}: there is no element set {part!r} for part=; known: {known}")
        mask = np.isin(numbers, body.members(OWN, "elset", part, body.place))
        if not mask.any():
            raise InputError(f"mesh file {file}: element set {part!r} has no solid cells")
        return mask
    found = part_labels(node_count, cells)
    order = found[np.sort(np.unique(found, return_index=True)[1])]  # parts in the order of their first cells
    if not 0 <= part < len(order):
        raise InputError(f"mesh file {file}: part {part!r} does not exist, it has {len(order)} connected part(s)")
    return found == order[part]


def _kept(
    cells: Mapping[str, np.ndarray], numbers: np.ndarray, mask: np.ndarray
) -> tuple[dict[str, np.ndarray], np.ndarray]:
    stops = np.cumsum([len(nodes) for nodes in cells.values()])[:-1]
    parts = {kind: nodes[m] for (kind, nodes), m in zip(cells.items(), np.split(mask, stops), strict=True)}
    return {kind: nodes for kind, nodes in parts.items() if len(nodes)}, numbers[mask]


def _placed(body: Body, points: np.ndarray, file: str) -> np.ndarray:
    """Points of the instance in the assembly: first translated, then rotated about the axis."""
    if body.instance is None:
        return points
    at = body.instance
    with np.errstate(over="ignore", invalid="ignore"):
        points = (points + at.translation - at.axis_point) @ at.rotation.T + at.axis_point
    if not np.isfinite(points).all():
        raise at.place.fault("the translation of the instance is too large")
    return points


def _element_notes(blocks: list[Elements], read: np.ndarray) -> list[str]:
    """Cells whose formulation is replaced, and omitted elements, with their numbers; not those that are `read`."""
    replaced: Counter[tuple[str, str, str]] = Counter()
    others: Counter[str] = Counter()
    for block in blocks:
        if block.kind is None:
            others[block.type] += int(np.sum(~np.isin(block.labels, read)))
        else:
            said = formulation(block.type)
            if said is not None:
                replaced[block.type, said, block.kind] += len(block.labels)
    notes = [f"{count} {name} cells {said}, as {kind}" for (name, said, kind), count in replaced.items()]
    if others := +others:
        listed = ", ".join(f"{count} {name}" for name, count in others.items())
        notes.append(f"elements that fill no volume, their stiffness and mass, are left out: {listed}")
    return notes


NESTING = 100  # sets inside sets; deeper nesting is refused
OWN, ASSEMBLY = "own", "assembly"


@dataclass(eq=False)
class Body:
    """The scopes that define a body, and the sorted numbers of all its nodes and elements.

    `missing` counts members of sets that refer to a node or an element that the body does not have.
    """

    name: str
    own: tuple[Scope, ...]
    place: Place
    assembly: Scope | None = None
    instance: Instance | None = None
    instances: Mapping[str, Instance] = field(default_factory=dict)
    missing: Counter[str] = field(default_factory=Counter)

    def __post_init__(self) -> None:
        nodes = [table.labels for scope in self.own for table in scope.nodes]
        elements = [block.labels for scope in self.own for block in scope.elements]
        self.labels = {"nset": _sorted(nodes), "elset": _sorted(elements)}
        self._memo: dict[tuple[str, str, str], np.ndarray] = {}

    def scopes(self, level: str) -> tuple[Scope, ...]:
        """The scopes of a level, in the order of search."""
        if level == OWN:
            return self.own
        return () if self.assembly is None else (self.assembly,)

    def levels(self) -> tuple[str, ...]:
        """The levels of names that apply to the body."""
        return (OWN,) if self.assembly is None else (OWN, ASSEMBLY)

    def definition(self, level: str, family: str, name: str) -> SetDefinition | None:
        """The set of that name at a level, None where there is none."""
        return next((s.sets[family][fold(name)] for s in self.scopes(level) if fold(name) in s.sets[family]), None)

    def members(self, level: str, family: str, name: str, place: Place, chain: tuple[str, ...] = ()) -> np.ndarray:
        """Sorted numbers of this body's nodes ("nset") or elements ("elset") in a set; `place`: of the reference.

        Raises `InputError` for an unknown set and for sets that contain themselves.
        """
        key = (level, family, fold(name))
        if key in self._memo:
            return self._memo[key]
        definition = self.definition(level, family, name)
        if definition is None:
            dotted = self._dotted(name) if level == ASSEMBLY else None
            if dotted is not None:
                return self._of_instance(*dotted, family, place, chain)
            known = sorted({d.name for scope in self.scopes(level) for d in scope.sets[family].values()})
            shown = ", ".join(repr(k) for k in known) or "none"
            raise place.fault(f"there is no {FAMILIES[family]} {name!r}; known: {shown}")
        link = f"{level}|{family}|{fold(name)}"
        if link in chain:
            raise definition.place.fault(f"{FAMILIES[family]} {name!r} contains itself")
        if len(chain) >= NESTING:
            raise definition.place.fault(f"sets are nested more than {NESTING} deep")
        parts = [self._one(level, family, definition, number, (*chain, link)) for number in definition.members]
        self._memo[key] = _sorted(parts)
        return self._memo[key]

    def surface_target(self, level: str, family: str, target: str, place: Place) -> np.ndarray:
        """Numbers of this body's nodes or elements that a line of a surface names: a number or a set."""
        number = number_or_none(target)
        if number is None:
            return self.members(level, family, target, place)
        if level == ASSEMBLY:
            return _none()
        found = self._known(family, np.array([number]))
        if not len(found):
            raise place.fault(f"there is no {'element' if family == 'elset' else 'node'} {number}")
        return found

    def surfaces(self, level: str) -> list[SurfaceDefinition]:
        """The surfaces of a level, those of element faces first."""
        found = [surface for scope in self.scopes(level) for surface in scope.surfaces.values()]
        return sorted(found, key=lambda surface: surface.nodal)

    def _one(self, level: str, family: str, owner: SetDefinition, m, chain: tuple[str, ...]) -> np.ndarray:
        """Members that one definition adds to the set of `owner`."""
        inner = level
        if level == ASSEMBLY and m.instance is not None:
            if fold(m.instance) not in self.instances:
                known = ", ".join(repr(i.name) for i in self.instances.values()) or "none"
                raise m.place.fault(f"there is no instance {m.instance!r}; known: {known}")
            if self.instance is None or fold(m.instance) != fold(self.instance.name):
                return _none()
            inner = OWN
        found = [self.members(inner, family, name, place, chain) for name, place in m.names]
        if m.elset is not None:
            found.append(self._nodes_of(self.members(inner, "elset", m.elset, m.place, chain)))
        if inner == OWN:  # at the level of the assembly a bare number is a reference point's
            listed = self._known(family, m.labels)
            ranges = [self._in_range(family, *r) for r in m.ranges]
            wanted = len(np.unique(m.labels)) + sum((r[1] - r[0]) // r[2] + 1 for r in m.ranges)
            self.missing[owner.name] += wanted - len(listed) - sum(len(r) for r in ranges)
            found += [listed, *ranges]
        return _sorted(found)

    def _dotted(self, name: str) -> tuple[Instance, str] | None:
        """Instance and rest of `instance.rest`."""
        for i, character in enumerate(name):
            if character == "." and fold(name[:i]) in self.instances:
                return self.instances[fold(name[:i])], name[i + 1 :]
        return None

    def _of_instance(self, instance: Instance, rest: str, family: str, place: Place, chain: tuple) -> np.ndarray:
        if self.instance is None or instance is not self.instance:
            return _none()
        number = number_or_none(rest)
        if number is not None:
            return self._known(family, np.array([number]))
        return self.members(OWN, family, rest, place, chain)

    def _known(self, family: str, numbers: np.ndarray) -> np.ndarray:
        return present(numbers, self.labels[family])

    def _in_range(self, family: str, first: int, last: int, step: int) -> np.ndarray:
        labels = self.labels[family]
        inside = labels[np.searchsorted(labels, first) : np.searchsorted(labels, last, side="right")]
        return inside[(inside - first) % step == 0]

    def _nodes_of(self, elements: np.ndarray) -> np.ndarray:
        tables = [block.table for scope in self.own for block in scope.elements if block.table is not None]
        return _sorted([t.rows[np.isin(t.labels, elements)].ravel() for t in tables])


def present(numbers: np.ndarray, among: np.ndarray) -> np.ndarray:
    """Sorted, unique `numbers` that are in the sorted array `among`; quick for few numbers among many."""
    numbers = np.unique(numbers)
    if not len(among):
        return numbers[:0]
    return numbers[among[np.minimum(np.searchsorted(among, numbers), len(among) - 1)] == numbers]


def _none() -> np.ndarray:
    return np.zeros(0, dtype=np.int64)


def _sorted(parts: list[np.ndarray]) -> np.ndarray:
    return np.unique(np.concatenate([_none(), *parts]))
