r"""Nastran bulk data: grid points, solid elements, shells as facets, properties, isotropic materials.

meshio is not used: it reads coordinates in local systems as basic ones, fails at a shell with an orientation, and
has no materials. A card is a line of up to 10 fields, in one of three formats, with continuation lines:

    free         fields between commas
    small field  8 columns each
    large field  the name ends in *: 8 columns, then 16 each, half as many fields per line

A continuation begins with +, *, a blank field or a comma; where the tenth field of a line and the first of the next one
both name it, the names are the same. Reals may drop the E of their exponent: 7.-2 is 0.07. A card = repeats the
previous one, with = for an unchanged field, *d for one that is increased by d, == for all others; a card =n repeats
that n times.

Densities are multiplied by PARAM,WTMASS: a deck may give weights. The nodes of a solid may run in either sense.

Solids with property p form the cell set `property_p`, shells on their surface the facet set of that name. A local
system (CORD2R, CORD2C, CORD2S) is given by three points in its reference system: the origin A, B on its third axis e_3
and C in the half plane of e_1 and e_3; `x = A + x_1 e_1 + x_2 e_2 + x_3 e_3` for the Cartesian coordinates that
(r, theta, z) or (r, theta, phi), angles in degrees, represent.
"""

from __future__ import annotations

import math
import re
from collections import Counter
from collections.abc import Iterator
from dataclasses import dataclass, field
from pathlib import Path

import numpy as np

from warpffrf.model.errors import InputError
from warpffrf.model.files.paths import Budget, exists, reason
from warpffrf.model.material import Material
from warpffrf.model.mesh.files.nastran_structure import ELEMENTS, PROPERTIES, StructureReader
from warpffrf.model.mesh.files.raw_mesh import LENGTH_UNITS, RawMesh, listed_counts, system_of
from warpffrf.model.mesh.structure import Beam, RigidLink, Shell, Structure

SUFFIXES = (".bdf", ".nas", ".fem", ".dat")

# linear kind, quadratic kind, position in the card of each node of the quadratic kind (Nastran puts the vertical edges
# before those of the top)
_SOLIDS = {
    "CTETRA": ("tet4", "tet10", list(range(10))),
    "CPENTA": ("wedge6", "wedge15", [*range(9), 12, 13, 14, 9, 10, 11]),
    "CHEXA": ("hex8", "hex20", [*range(12), 16, 17, 18, 19, 12, 13, 14, 15]),
}
_SHELLS = {
    "CTRIA3": ("tri3", 3),
    "CTRIAR": ("tri3", 3),
    "CQUAD4": ("quad4", 4),
    "CQUADR": ("quad4", 4),
    "CTRIA6": ("tri6", 6),
    "CQUAD8": ("quad8", 8),
}
_CORNERS = {"CTETRA": 4, "CPENTA": 6, "CHEXA": 8}
_LOCAL = {"CORD2R", "CORD2C", "CORD2S"}
_OTHER_SOLIDS = ("CHEX", "CPENT", "CTETR", "CPYR")  # initial letters of solids that are not read
MOST_COPIES = 100_000  # cards created by =n
_INTEGER = re.compile(r"[+-]?[0-9]{1,18}")
_REAL = re.compile(r"[+-]?(?>[0-9]++\.?+[0-9]*+|\.[0-9]++)(?:e[+-]?[0-9]++)?")
_EXPONENT = re.compile(r"(?<=[0-9.])([+-][0-9]+)$")

Array = np.ndarray


@dataclass
class Card:
    """A card's `name`, its fields after the name, and where it begins."""

    name: str
    fields: list[str]
    place: str

    def text(self, i: int) -> str:
        """Field i, counted from 1 after the name; empty where there is none."""
        return self.fields[i - 1] if i <= len(self.fields) else ""

    def fault(self, message: str) -> InputError:
        return InputError(f"mesh file {self.place}: {self.name}: {message}")

    def integer(self, i: int, default: int | None = None) -> int:
        text = self.text(i)
        if not text and default is not None:
            return default
        if not _INTEGER.fullmatch(text):  # Python takes 1_0 for 10
            raise self.fault(f"field {i + 1} must be an integer, got {text!r}; repair the line")
        return int(text)

    def real(self, i: int, default: float | None = None) -> float:
        text = self.text(i)
        if not text and default is not None:
            return default
        # Nastran's own forms: 1.5D6 and 1.5+6
        plain = _EXPONENT.sub(r"e\1", text.lower().replace("d", "e"))
        value = float(plain) if _REAL.fullmatch(plain) else math.inf
        if not math.isfinite(value):
            raise self.fault(f"field {i + 1} must be a number, got {text!r}; repair the line")
        return value


@dataclass
class _Deck:
    """The cards of a solid body."""

    grids: dict[int, tuple[int, tuple[float, float, float], Card]] = field(default_factory=dict)
    systems: dict[int, Card] = field(default_factory=dict)
    cells: dict[str, list[tuple[int, list[int], Card]]] = field(default_factory=dict)  # by kind: property, nodes
    elements: set[int] = field(default_factory=set)  # their numbers
    solids: dict[int, Card] = field(default_factory=dict)  # PSOLID by property
    materials: dict[int, Card] = field(default_factory=dict)  # MAT1
    mass_factors: list[float] = field(default_factory=list)  # PARAM,WTMASS
    ignored: Counter[str] = field(default_factory=Counter)
    structural: list[Card] = field(default_factory=list)  # bars, masses, springs, rigid elements
    properties: dict[tuple[str, int], Card] = field(default_factory=dict)  # of shells, bars and springs


def read_bulk(path: Path, length_unit: str) -> RawMesh:
    """Contents of a bulk data file. Raises `InputError`, with file and line, for invalid entries."""
    deck = _Deck()
    for card in cards(path):
        _take(deck, card)
    numbers = {node: i for i, node in enumerate(deck.grids)}
    placed = _Systems(deck)
    points = np.array([placed.basic(cp, x, card) for cp, x, card in deck.grids.values()]).reshape(-1, 3)
    blocks, labels, groups = [], [], {}
    for kind, rows in deck.cells.items():
        try:
            nodes = np.array([[numbers[a] for a in row] for _, row, _ in rows], dtype=np.int64)
        except KeyError:
            card, missing = next((c, a) for _, row, c in rows for a in row if a not in numbers)
            raise card.fault(f"grid point {missing} does not exist") from None
        properties = np.array([p for p, _, _ in rows])
        for p in np.unique(properties):
            members = groups.setdefault(f"property_{p}", {})
            members[len(blocks)] = np.flatnonzero(properties == p)
        blocks.append((kind, nodes))
        labels.append(np.array([card.integer(1) for _, _, card in rows]))
    notes: list[str] = []
    structure = _structure(deck, points, numbers, length_unit, notes)
    solids = any(name in deck.cells for pair in _SOLIDS.values() for name in pair[:2])
    if not solids and not structure.of(Shell) and not structure.of(Beam):
        raise InputError(f"mesh file {path.name}: there are no volume cells ({', '.join(_SOLIDS)}); export the solids")
    empty = np.zeros(0, dtype=np.int64)
    full = {name: [members.get(b, empty) for b in range(len(blocks))] for name, members in groups.items()}
    materials = _materials(deck, length_unit, notes)
    if deck.ignored:
        notes.append(f"cards that are not used: {listed_counts(deck.ignored)}")
    links = {link.name: link.nodes for link in structure.of(RigidLink)}
    more = {"stray_facets": True, "either_hand": True, "labels": labels, "node_groups": links, "structure": structure}
    return RawMesh(points, blocks, full, materials, tuple(notes), **more)


def _structure(deck: _Deck, points: Array, numbers: dict[int, int], length_unit: str, notes: list[str]) -> Structure:
    """Shells, beams, masses, springs and rigid elements; `notes` list the cards that are not read."""
    shells = {kind: rows for kind, rows in deck.cells.items() if rows[0][2].name in _SHELLS}
    if not deck.structural and not any(name == "PSHELL" for name, _ in deck.properties):
        return Structure()
    found: list[str] = []
    system = system_of(length_unit, found)
    if system is None:
        count = Counter(card.name for card in deck.structural)
        notes.append(f"structural elements are not read, lengths in {length_unit}: {listed_counts(count) or 'shells'}")
        return Structure()
    stress, density, _ = system
    length, factor = LENGTH_UNITS[length_unit], deck.mass_factors[0] if deck.mass_factors else 1.0
    known: dict[int, Material | None] = {}

    def material(number: int) -> Material | None:
        if number not in known:
            card = deck.materials.get(number)
            known[number] = None if card is None else _material(card, stress, factor * density, notes)
        return known[number]

    units = length, stress * length**2, factor * density * length**3
    reader = StructureReader(deck.structural, deck.properties, shells, numbers, points, material, units)
    structure = reader.structure()
    notes += reader.notes
    if reader.left_out:
        notes.append(f"structural elements that are not read: {listed_counts(reader.left_out)}")
    return structure


def _take(deck: _Deck, card: Card) -> None:
    name = card.name
    if name == "GRID":
        number = card.integer(1)
        x = (card.real(3, 0.0), card.real(4, 0.0), card.real(5, 0.0))
        grid = card.integer(2, 0), x, card
        known = deck.grids.setdefault(number, grid)
        if known[:2] != grid[:2]:
            raise card.fault(
                f"grid point {number} is defined twice, at different positions; give one of them another number"
            )
    elif name in _SOLIDS:
        linear, quadratic, order = _SOLIDS[name]
        corners = _CORNERS[name]
        given = [t for t in card.fields[2 + corners : 2 + len(order)] if t not in ("", "0")]
        if given and len(given) < len(order) - corners:
            raise card.fault(f"{len(order) - corners - len(given)} of its mid-side nodes are missing; give all or none")
        kind, wanted = (quadratic, [3 + i for i in order]) if given else (linear, list(range(3, 3 + corners)))
        _add(deck, kind, card, wanted)
    elif name in _SHELLS:
        kind, count = _SHELLS[name]
        if kind in ("tri6", "quad8") and any(not card.text(3 + i) for i in range(count)):
            kind, count = ("tri3", 3) if kind == "tri6" else ("quad4", 4)  # facets are matched by their corners
        _add(deck, kind, card, list(range(3, 3 + count)))
    elif name in ("CPYRAM", "CPYRA"):
        raise card.fault("pyramids are not supported; mesh with tetrahedra, wedges and hexahedra")
    elif name.startswith(_OTHER_SOLIDS):
        raise card.fault(f"solids of this name are not read; {', '.join(_SOLIDS)} are")
    elif name == "PARAM" and card.text(1).upper() == "WTMASS":
        deck.mass_factors.append(card.real(2))
    elif name in _LOCAL:
        deck.systems[card.integer(1)] = card
    elif name in ELEMENTS:
        deck.structural.append(card)
    elif name in PROPERTIES:
        deck.properties[name, card.integer(1)] = card
    elif name == "PSOLID":
        deck.solids[card.integer(1)] = card
    elif name == "MAT1":
        deck.materials[card.integer(1)] = card
    elif name == "GRDSET" and card.integer(2, 0) != 0:
        raise card.fault("a default coordinate system for all grid points is not supported; write it to each GRID")
    else:
        deck.ignored[name] += 1


def _add(deck: _Deck, kind: str, card: Card, fields: list[int]) -> None:
    number = card.integer(1)
    if number in deck.elements:
        raise card.fault(f"element {number} is defined twice; give one of them another number")
    deck.elements.add(number)
    nodes = [card.integer(i) for i in fields]
    deck.cells.setdefault(kind, []).append((card.integer(2, number), nodes, card))


class _Systems:
    """Positions in local coordinate systems, in basic ones."""

    def __init__(self, deck: _Deck) -> None:
        self._cards = deck.systems
        self._frames: dict[int, tuple[Array, Array]] = {}

    def basic(self, system: int, x: tuple[float, float, float] | Array, card: Card, depth: int = 0) -> Array:
        """Basic coordinates (3,) of the coordinates `x` in `system`."""
        if system == 0:
            return np.asarray(x, dtype=float)
        if system not in self._cards or depth > len(self._cards):
            raise card.fault(f"coordinate system {system} is not given by CORD2R, CORD2C or CORD2S, or by itself")
        definition = self._cards[system]
        if system not in self._frames:
            reference = definition.integer(2, 0)
            A, B, C = (
                self.basic(reference, np.array([definition.real(i + j, 0.0) for j in range(3)]), definition, depth + 1)
                for i in (3, 6, 9)
            )
            e_2 = np.cross(B - A, C - A)
            lengths = np.linalg.norm(B - A), np.linalg.norm(e_2)
            if not min(lengths) > 0.0:
                raise definition.fault("its three points lie on one line")
            e_3, e_2 = (B - A) / lengths[0], e_2 / lengths[1]
            self._frames[system] = A, np.stack([np.cross(e_2, e_3), e_2, e_3])
        origin, frame = self._frames[system]
        a, b, c = x
        if definition.name == "CORD2C":
            a, b = a * np.cos(np.radians(b)), a * np.sin(np.radians(b))
        elif definition.name == "CORD2S":  # r, theta from the third axis, phi
            theta, phi = np.radians(b), np.radians(c)
            a, b, c = a * np.sin(theta) * np.cos(phi), a * np.sin(theta) * np.sin(phi), a * np.cos(theta)
        return origin + np.array([a, b, c]) @ frame


def _materials(deck: _Deck, length_unit: str, notes: list[str]) -> dict[str, Material]:
    """{property_p: Material} [SI] of PSOLID and MAT1; `notes` list omitted data."""
    if not deck.solids or not deck.materials:
        return {}
    system = system_of(length_unit, notes)
    if system is None:
        return {}
    stress, density, units = system
    if deck.mass_factors:
        if len(set(deck.mass_factors)) > 1 or not deck.mass_factors[0] > 0.0:
            raise InputError(f"PARAM,WTMASS is given as {deck.mass_factors}; give one positive factor")
        density *= deck.mass_factors[0]
        notes.append(f"densities are multiplied by PARAM,WTMASS {deck.mass_factors[0]:g}")
    found: dict[str, Material] = {}
    for p, solid in deck.solids.items():
        number = solid.integer(2)
        card = deck.materials.get(number)
        if card is None:
            notes.append(f"PSOLID {p}: material {number} is not a MAT1 and is not used")
            continue
        material = _material(card, stress, density, notes)
        if material is not None:
            found[f"property_{p}"] = material
    if found:
        notes.append(f"materials are read in {units}, the system of units with lengths in {length_unit}")
    return found


def _material(card: Card, stress: float, density: float, notes: list[str]) -> Material | None:
    """The material [SI] of a MAT1; None, with a note, where it is not admissible."""
    number = card.integer(1)
    E, G, nu, rho = (card.real(i, 0.0) for i in (2, 3, 4, 5))
    if not card.text(4) and E > 0.0 and G > 0.0:
        nu = E / (2.0 * G) - 1.0
    elif not E > 0.0:
        E = 2.0 * G * (1.0 + nu)
    try:
        return Material(stress * E, nu, density * rho, name=f"MAT1 {number}")
    except InputError as error:
        notes.append(f"MAT1 {number} is not used: {error}")
    return None


def cards(path: Path) -> Iterator[Card]:
    """The cards of the bulk data section, with copies expanded."""
    last: Card | None = None
    recipe: list[str] | None = None
    copies = 0
    for card in _written_cards(path):
        if not card.name.startswith("="):
            last, recipe = card, None
            yield card
            continue
        if last is None:
            raise card.fault("there is no card before it to repeat; repair the line")
        count = 1
        if card.name != "=":
            word = card.name[1:].strip("()")
            if recipe is None or not word.isdigit() or len(word) > 8 or any(card.fields):
                raise card.fault(
                    "=n must follow a card with =, of which it gives the number of copies; repair the line"
                )
            count = int(word)
        else:
            recipe = card.fields
        copies += count
        if copies > MOST_COPIES:
            raise card.fault(f"more than {MOST_COPIES} copies of cards; write the deck out")
        for _ in range(count):
            last = _copy(last, recipe or [], card)
            yield last


def _copy(last: Card, recipe: list[str], card: Card) -> Card:
    """The card after `last` by `recipe`, the fields of a card = at `card`."""
    fields: list[str] = []
    given = list(recipe)
    while given and not given[-1]:
        given.pop()
    for i, text in enumerate(given, start=1):
        if text == "==":
            if i < len(given):
                raise card.fault("== is its last field; repair the line")
            fields += last.fields[i - 1 :]
        elif text == "=":
            fields.append(last.text(i))
        elif text.startswith("*"):
            fields.append(_grown(last, i, text[1:].strip("()"), card))
        else:
            fields.append(text)
    if len(given) < len(last.fields) and "==" not in given and any(last.fields[len(given) :]):
        raise card.fault(
            f"it gives {len(given)} of the {len(last.fields)} fields of {last.name}; write == for the rest"
        )
    return Card(last.name, fields, card.place)


def _grown(last: Card, i: int, step: str, card: Card) -> str:
    """Field i of `last` and `step` more."""
    if _INTEGER.fullmatch(last.text(i)) and _INTEGER.fullmatch(step):
        return str(int(last.text(i)) + int(step))
    by = Card(card.name, [step], card.place)
    return repr(last.real(i) + by.real(1))


def _written_cards(path: Path) -> Iterator[Card]:
    """The cards as written, with their continuations joined."""
    card: Card | None = None
    width = 8
    name = ""  # of the continuation that the line before announces
    for line, place in _bulk_lines(path, Budget()):
        free = "," in line
        fields = [f.strip() for f in line.split(",")] if free else []
        head = fields[0] if free else line[:8].strip()
        large = head.endswith("*") or head.startswith("*")
        goes_on = head == "" or head[0] in "+*"
        copied = head.startswith("=") or (goes_on and card is not None and card.name.startswith("="))
        if not free:
            step = 16 if large else 8
            fields = [head, *(line[8 + i * step : 8 + (i + 1) * step].strip() for i in range(64 // step))]
            behind = line[72:80].strip()
        else:
            behind = fields[9] if len(fields) == 10 and not large else ""
            # a short line may end with the name at once
            if not copied and len(fields) > 1 and fields[-1].startswith(("+", "*")) and not _is_number(fields[-1]):
                behind = fields.pop()
        limit = 4 if large else 8
        # the data are followed by the name of the continuation; a longer free line continues without one
        data = fields[1:] if len(fields) > limit + 2 else fields[1 : 1 + limit]
        if goes_on:
            if card is None:
                raise InputError(f"mesh file {place}: a continuation without a card before it; repair the line")
            if name.strip("+* ") and head.strip("+* ") and name.strip("+* ") != head.strip("+* "):
                raise InputError(
                    f"mesh file {place}: continuation {head!r} is found where {name!r} of the previous card is "
                    "expected; write the lines of a card in sequence"
                )
            card.fields += [""] * (-len(card.fields) % width) + data
            width, name = limit, behind
            continue
        if card is not None:
            yield card
        card, width, name = Card(head.rstrip("*").upper(), data, place), limit, behind
    if card is not None:
        yield card


def _is_number(text: str) -> bool:
    return re.fullmatch(r"[+-]?[0-9.]++([ed]?[+-]?[0-9]++)?", text.lower()) is not None


def _bulk_lines(path: Path, budget: Budget, parents: tuple[Path, ...] = ()) -> Iterator[tuple[str, str]]:
    """Lines of the bulk data section (before it those of PARAM) without comments, includes inserted, each with its
    place as text."""
    try:
        lines = budget.read(path, len(parents)).decode("latin-1").splitlines()  # comments may hold anything
    except (OSError, ValueError) as error:
        raise InputError(f"mesh file {path.name}: cannot be read ({reason(error)}); check the path") from None
    begin = next((i for i, line in enumerate(lines) if line.upper().split()[:2] == ["BEGIN", "BULK"]), -1)
    for number, raw in enumerate(lines, start=1):
        line = raw.split("$", 1)[0].expandtabs(8).rstrip()
        if not line or (number <= begin + 1 and not line.upper().startswith("PARAM")):
            continue
        place = f"{path.name}, line {number}"
        word = line.split(None, 1)[0].upper()
        if word == "ENDDATA":
            return
        if word != "INCLUDE":
            yield line, place
            continue
        name = line.split(None, 1)[1].strip("'\" ") if len(line.split(None, 1)) > 1 else ""
        other = path.parent / name
        if not name or not exists(other) or other.resolve() in [p.resolve() for p in (*parents, path)]:
            raise InputError(
                f"mesh file {place}: INCLUDE {name[:200]!r} does not exist or includes itself; correct the path"
            )
        yield from _bulk_lines(other, budget, (*parents, path))
