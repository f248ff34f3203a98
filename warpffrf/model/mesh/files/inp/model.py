"""Contents of a deck, before references are resolved: scopes with nodes, elements, sets and surfaces; instances;
materials.

A *scope* is the range of names and numbers: each part, the contents of an instance, and the top (the assembly, or
everything in a deck without parts). The same number or name in two scopes refers to different objects.

Cells. Solid elements of Abaqus and CalculiX: which cell kind each becomes, and the numbering of their faces.

Node orders are those of our cells: Abaqus numbers the corners of the bottom and of the top, then the edges of the
bottom, of the top, and the vertical ones. (The normal of the first triangle of a wedge points into the cell in both.)

A solid element's type is `C3D`, the number of nodes, and letters for its formulation: R reduced integration,
I incompatible modes (C3D10I: improved surface stress), H hybrid, M modified, S improved surface stress, T with
temperatures. Here all of them become the plain, fully integrated element of the same shape; `formulation` states what
was replaced. (Abaqus' own C3D8 averages the volumetric strain over the cell; ours does not.)

Faces S1, S2, ... are given by their corners as in Abaqus (Analysis User's Guide, "Three-dimensional solid element
library") and CalculiX (manual, *DLOAD), which agree.

Numbers. Tables of numbers in a deck: nodes, elements and the members of sets, read in bulk.

A table of 100,000 lines is joined and converted at once; only if that fails are the lines read one by one, to
name the wrong one.
"""

from __future__ import annotations

import re
from collections import Counter
from dataclasses import dataclass, field
from functools import cache

import numpy as np

from warpffrf.model.mesh.elements import cell_kind, facet_kind
from warpffrf.model.mesh.files.inp.deck import Block, Place

FAMILIES = {"nset": "node set", "elset": "element set"}


def fold(name: str) -> str:
    """The form in which names are compared: without regard to upper and lower case."""
    return name.casefold()


@dataclass(frozen=True, eq=False)
class Elements:
    """Elements of one type: `kind` is our cell kind, `shell` our facet kind, both None for any other type; `table` the
    nodes of either, and of `structural_nodes` of the type."""

    type: str
    kind: str | None
    place: Place
    labels: np.ndarray
    table: Table | None
    shell: str | None = None


@dataclass(frozen=True, eq=False)
class Members:
    """One definition of members of a set: numbers, ranges (first, last, step), names of sets, of one instance or not.

    `elset`: the nodes of this element set (an *Nset with ELSET=).
    """

    place: Place
    instance: str | None = None
    labels: np.ndarray = field(default_factory=lambda: np.zeros(0, dtype=np.int64))
    ranges: tuple[tuple[int, int, int], ...] = ()
    names: tuple[tuple[str, Place], ...] = ()
    elset: str | None = None


@dataclass(eq=False)
class SetDefinition:
    """A named set: the union of all its definitions. `internal`: created by a preprocessor, without meaning for the
    user."""

    name: str
    place: Place
    internal: bool = False
    members: list[Members] = field(default_factory=list)


@dataclass(frozen=True)
class SurfaceItem:
    """One line of a surface: an element, node or set, and the face (S1 to S6, or None for all free faces)."""

    target: str
    face: int | None
    place: Place


@dataclass(eq=False)
class SurfaceDefinition:
    """A named surface of element faces (`nodal` False) or of nodes."""

    name: str
    place: Place
    nodal: bool
    internal: bool
    items: list[SurfaceItem]


@dataclass(frozen=True)
class Section:
    """A *Solid Section: the material of an element set, and the name of its *Orientation."""

    elset: str
    material: str
    place: Place
    orientation: str | None = None


@dataclass(frozen=True, eq=False)
class Orientation:
    """An *Orientation: the first two axes (2, 3) in the frame of its part, None with the `fault` that it has."""

    axes: np.ndarray | None
    fault: str = ""


@dataclass(eq=False)
class Scope:
    """The nodes, elements, sets, surfaces and sections of a part, of an instance, or of the top of the deck.

    A surface of nodes may have the name of one of element faces: the keys of `surfaces` distinguish them.
    """

    name: str
    place: Place
    nodes: list[Table] = field(default_factory=list)
    elements: list[Elements] = field(default_factory=list)
    sets: dict[str, dict[str, SetDefinition]] = field(default_factory=lambda: {family: {} for family in FAMILIES})
    surfaces: dict[tuple[str, bool], SurfaceDefinition] = field(default_factory=dict)
    sections: list[Section] = field(default_factory=list)
    orientations: dict[str, Orientation] = field(default_factory=dict)
    structural: list[Block] = field(default_factory=list)  # sections and properties of shells, beams, masses, ...

    def add_members(self, family: str, name: str, members: Members, internal: bool = False) -> None:
        """Add to the set of that name, which begins here if it is new."""
        known = self.sets[family]
        definition = known.setdefault(fold(name), SetDefinition(name, members.place, internal))
        definition.members.append(members)

    @property
    def has_cells(self) -> bool:
        """Whether the scope holds elements that fill a volume, usable ones or not."""
        return any(block.kind is not None or is_volume(block.type) for block in self.elements)

    @property
    def has_structure(self) -> bool:
        """Whether the scope holds shells or beams with a section."""
        return any(block.keyword.endswith("SECTION") for block in self.structural)


@dataclass(eq=False)
class Instance:
    """A part placed in the assembly: x = rotation @ (X + translation - axis_point) + axis_point [file's unit]."""

    name: str
    part: str
    place: Place
    scope: Scope
    translation: np.ndarray
    axis_point: np.ndarray
    rotation: np.ndarray


@dataclass(eq=False)
class MaterialText:
    """A *Material as the deck gives it, in its own units; `faults` state why it cannot be used."""

    name: str
    place: Place
    elastic: tuple[float, float] | None = None
    orthotropic: list[list[float]] | None = None  # E_1, E_2, E_3; nu_12, nu_13, nu_23; G_12, G_13, G_23
    density: float | None = None
    faults: list[str] = field(default_factory=list)
    notes: list[str] = field(default_factory=list)


@dataclass(eq=False)
class Deck:
    """Contents of a deck. Parts and instances by folded name; `ignored` counts keywords without effect here."""

    file: str
    top: Scope
    parts: dict[str, Scope] = field(default_factory=dict)
    instances: dict[str, Instance] = field(default_factory=dict)
    materials: dict[str, MaterialText] = field(default_factory=dict)
    ignored: Counter[str] = field(default_factory=Counter)


KINDS = {4: "tet4", 6: "wedge6", 8: "hex8", 10: "tet10", 15: "wedge15", 20: "hex20"}  # by the number of nodes
_TYPE = re.compile(r"C3D(4|6|8|10|15|20)([RIHMST]*)")
_VOLUMES = re.compile(r"C3D|(SC|CSS|CCL|DC3D|DCC3D|AC3D|EC3D|FC3D|Q3D)\d")
# shells, membranes, plane elements and rigid faces in space, with their number of nodes (STRI65 has six)
_SHELL = re.compile(r"(?:DS|SFM3D|M3D|CPS|CPE|CPEG|R3D|STRI|S)([3468])[RITHMP0-9]*")
_STRUCTURAL = {"B31": 2, "B31R": 2, "B33": 2, "B32": 3, "B32R": 3, "MASS": 1, "ROTARYI": 1, "SPRINGA": 2, "SPRING2": 2}
_SHELL_KINDS = {3: "tri3", 4: "quad4", 6: "tri6", 8: "quad8"}
_FORMULATIONS = {
    "R": "are integrated fully",
    "I": "have no incompatible modes here",
    "H": "are hybrid where the material requires it",
    "M": "are not modified here",
    "S": "have the usual stress points here",
    "T": "have no temperatures here",
}
# corners of the faces S1, S2, ..., counted from 1 as in the manuals
_FACES = {
    "hex": ((1, 2, 3, 4), (5, 8, 7, 6), (1, 5, 6, 2), (2, 6, 7, 3), (3, 7, 8, 4), (4, 8, 5, 1)),
    "wedge": ((1, 2, 3), (4, 6, 5), (1, 4, 5, 2), (2, 5, 6, 3), (3, 6, 4, 1)),
    "tet": ((1, 2, 3), (1, 4, 2), (2, 4, 3), (3, 4, 1)),
}
FACE_COUNT = 6  # the largest number of faces of any kind


def kind_of(element_type: str) -> str | None:
    """The cell kind of an element type, None if it is not a supported solid element."""
    match = _TYPE.fullmatch(element_type.upper())
    return KINDS[int(match[1])] if match else None


def shell_kind_of(element_type: str) -> str | None:
    """The facet kind of an element without volume that covers a face, None for any other."""
    match = _SHELL.fullmatch(element_type.upper())
    return _SHELL_KINDS[int(match[1])] if match else None


def is_volume(element_type: str) -> bool:
    """Whether an element type fills a volume, supported or not: omitting it would change the body."""
    return _VOLUMES.match(element_type.upper()) is not None


def formulation(element_type: str) -> str | None:
    """Text about cells whose formulation is replaced, for example 'are integrated fully'; None for plain cells."""
    match = _TYPE.fullmatch(element_type.upper())
    letters = match[2] if match else ""
    return " and ".join(_FORMULATIONS[letter] for letter in letters) or None


def structural_nodes(element_type: str) -> int | None:
    """Number of nodes of beams, masses and springs between nodes; None for any other type."""
    return _STRUCTURAL.get(element_type.upper())


@cache
def faces_of(kind: str) -> tuple[tuple[str, np.ndarray], ...]:
    """For S1, S2, ... of a cell kind: the facet kind and the local node numbers (kf,), counted from 0, outward."""
    cell = cell_kind(kind)
    by_corners = {
        frozenset(local[: facet_kind(facet).corner_count].tolist()): (facet, local)
        for facet, table in cell.faces.items()
        for local in table
    }
    return tuple(by_corners[frozenset(c - 1 for c in corners)] for corners in _FACES[cell.domain])


LARGEST_NUMBER = 2**53  # of a node or element: exact as a float, far above any numbering


@dataclass(frozen=True, eq=False)
class Table:
    """Numbered rows of a block: `labels` (m,), `rows` (m, k), and the index of each row's data line."""

    block: Block
    labels: np.ndarray
    rows: np.ndarray
    lines: np.ndarray

    def place(self, row: int) -> Place:
        """Where a row begins."""
        return self.block.place_of(int(self.lines[row]))


def node_table(block: Block) -> Table:
    """Node numbers and coordinates (m, 3): `number, x, y, z`; omitted coordinates are 0."""
    texts, lines = [], []
    for text, index in block.data():
        texts.append(text.rstrip(", \t"))
        lines.append(index)
    values = None
    if all(text.count(",") == 3 for text in texts):
        values = _floats(",".join(texts)) if texts else np.zeros(0)
    if values is None:
        values = np.array([_node(text, block.place_of(i)) for text, i in zip(texts, lines, strict=True)])
    values = values.reshape(-1, 4)
    good = np.isfinite(values).all(axis=1) & (values[:, 0] == np.floor(values[:, 0]))
    good &= (values[:, 0] >= 1) & (values[:, 0] <= LARGEST_NUMBER)
    if not good.all():
        row = int(np.flatnonzero(~good)[0])
        raise block.place_of(lines[row]).fault(f"a node is 'number, x, y, z' with finite values, got {texts[row]!r}")
    return Table(block, values[:, 0].astype(np.int64), values[:, 1:], np.array(lines, dtype=np.int64))


def _node(text: str, place: Place) -> list[float]:
    fields = [field.strip() for field in text.split(",")]
    values = _floats(",".join(field or "0" for field in fields[:4])) if fields[0] else None
    if values is None:
        raise place.fault(f"a node is 'number, x, y, z', got {text!r}")
    return [*values.tolist(), *[0.0] * (4 - len(values))]


def element_table(block: Block, nodes: int) -> Table:
    """Element numbers and their node numbers (m, nodes); the numbers of one element may take several lines.

    Raises `InputError` naming the line where an element has too many or too few numbers, or an invalid one.
    """
    wanted = nodes + 1
    texts: list[str] = []
    starts: list[int] = []  # index in `texts` of the first line of each element
    indices: list[int] = []
    have = 0
    for text, index in block.data():
        text = text.rstrip(", \t")
        if have == 0:
            starts.append(len(texts))
        texts.append(text)
        indices.append(index)
        have += text.count(",") + 1
        if have > wanted:
            place = block.place_of(indices[starts[-1]])
            kind = block.value("TYPE")
            raise place.fault(f"an element of type {kind} has a number and {nodes} nodes, got {have} values")
        if have == wanted:
            have = 0
    if have:
        place = block.place_of(indices[starts[-1]])
        raise place.fault(f"the element has {have - 1} of {nodes} nodes; is the deck truncated here?")
    values = _integers(",".join(texts)) if texts else np.zeros(0, dtype=np.int64)
    if values is None:
        row = next(i for i, text in enumerate(texts) if _integers(text) is None)
        raise block.place_of(indices[row]).fault(f"element and node numbers are whole and positive, got {texts[row]!r}")
    values = values.reshape(-1, wanted)
    lines = np.array(indices, dtype=np.int64)[starts] if starts else np.zeros(0, dtype=np.int64)
    return Table(block, values[:, 0], values[:, 1:], lines)


def element_numbers(block: Block) -> np.ndarray:
    """The numbers of elements whose nodes are not required; lines without one are skipped."""
    labels, begins = [], True
    for text, _ in block.data():
        if begins:
            value = _integers(text.split(",", 1)[0])
            if value is not None:
                labels.append(int(value[0]))
        begins = not text.endswith(",")
    return np.array(labels, dtype=np.int64)


def set_members(block: Block) -> tuple[np.ndarray, list[tuple[str, Place]]]:
    """The members listed by a set: numbers, and names of other sets with their places."""
    texts = [text.rstrip(", \t") for text, _ in block.data()]
    numbers = _integers(",".join(texts)) if texts else np.zeros(0, dtype=np.int64)
    if numbers is not None:
        return numbers, []
    found: list[np.ndarray] = []
    names: list[tuple[str, Place]] = []
    for fields, place in block.fields():
        for word in fields:
            number = _integers(word)
            if number is not None:
                found.append(number)
            elif word and not _looks_like_number(word):
                names.append((word, place))
            else:
                raise place.fault(f"a member of a set is a whole positive number or a name, got {word!r}")
    return np.concatenate([np.zeros(0, dtype=np.int64), *found]), names


def set_ranges(block: Block) -> list[tuple[int, int, int]]:
    """The ranges (first, last, step) of a set with GENERATE."""
    ranges = []
    for fields, place in block.fields():
        values = _integers(",".join(fields))
        if values is None or len(values) not in (2, 3) or values[1] < values[0]:
            raise place.fault(f"a generated range is 'first, last, step', got {', '.join(fields)!r}")
        ranges.append((int(values[0]), int(values[1]), int(values[2]) if len(values) == 3 else 1))
    return ranges


def number_or_none(text: str) -> int | None:
    """A node or element number, or None where `text` is a name."""
    value = _integers(text)
    return None if value is None else int(value[0])


def reals(fields: list[str], place: Place, what: str, least: int) -> list[float]:
    """Finite numbers, blanks as 0; raises `InputError` naming `what` for anything else or fewer than `least`."""
    values = _floats(",".join(field or "0" for field in fields))
    if values is None or len(values) < least or not np.all(np.isfinite(values)):
        raise place.fault(f"{what} needs {least} finite number(s), got {', '.join(fields)!r}")
    return values.tolist()


def _looks_like_number(text: str) -> bool:
    return text[:1] in "+-.0123456789<"  # "<" is a *Parameter to be replaced


def _floats(text: str) -> np.ndarray | None:
    """Numbers between commas, Fortran's `1.5D-3` among them, or None."""
    if "_" in text:  # Python would take 1_000 for a number
        return None
    try:
        return np.array(list(map(float, text.split(","))))
    except ValueError:
        pass
    try:
        return np.array(list(map(float, text.upper().replace("D", "E").split(","))))
    except ValueError:
        return None


def _integers(text: str) -> np.ndarray | None:
    """Whole numbers from 1 to LARGEST_NUMBER between commas, or None."""
    if "_" in text:
        return None
    try:
        values = np.array(list(map(int, text.split(","))), dtype=np.int64)
    except (ValueError, OverflowError):
        return None
    return values if values.min() >= 1 and values.max() <= LARGEST_NUMBER else None
