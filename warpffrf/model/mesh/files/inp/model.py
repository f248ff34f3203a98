"""What a deck says, before anything is resolved: scopes with nodes, elements, sets and surfaces; instances; materials.

A *scope* is where names and numbers hold: each part, what stands inside an instance, and the top (the assembly, or
everything in a deck without parts). The same number or name in two scopes means two things.
"""

from __future__ import annotations

from collections import Counter
from dataclasses import dataclass, field

import numpy as np

from warpffrf.model.mesh.files.inp.cells import is_volume
from warpffrf.model.mesh.files.inp.deck import Place
from warpffrf.model.mesh.files.inp.numbers import Table

FAMILIES = {"nset": "node set", "elset": "element set"}


def fold(name: str) -> str:
    """The form in which names are compared: without regard to upper and lower case."""
    return name.casefold()


@dataclass(frozen=True, eq=False)
class Elements:
    """Elements of one type: `kind` is our cell kind, `shell` our facet kind, both None for any other type; `table` the
    nodes of either."""

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
    """A named set: the union of all its definitions. `internal`: made by a preprocessor, of no meaning to the user."""

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
    """A *Solid Section: which material an element set is made of."""

    elset: str
    material: str
    place: Place


@dataclass(eq=False)
class Scope:
    """The nodes, elements, sets, surfaces and sections of a part, of an instance, or of the top of the deck.

    A surface of nodes may have the name of one of element faces: the keys of `surfaces` say which it is.
    """

    name: str
    place: Place
    nodes: list[Table] = field(default_factory=list)
    elements: list[Elements] = field(default_factory=list)
    sets: dict[str, dict[str, SetDefinition]] = field(default_factory=lambda: {family: {} for family in FAMILIES})
    surfaces: dict[tuple[str, bool], SurfaceDefinition] = field(default_factory=dict)
    sections: list[Section] = field(default_factory=list)

    def add_members(self, family: str, name: str, members: Members, internal: bool = False) -> None:
        """Add to the set of that name, which begins here if it is new."""
        known = self.sets[family]
        definition = known.setdefault(fold(name), SetDefinition(name, members.place, internal))
        definition.members.append(members)

    @property
    def has_cells(self) -> bool:
        """Whether the scope holds elements that fill a volume, usable ones or not."""
        return any(block.kind is not None or is_volume(block.type) for block in self.elements)


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
    """A *Material as the deck gives it, in its own units; `faults` say why it cannot be taken over."""

    name: str
    place: Place
    elastic: tuple[float, float] | None = None
    density: float | None = None
    faults: list[str] = field(default_factory=list)
    notes: list[str] = field(default_factory=list)


@dataclass(eq=False)
class Deck:
    """Everything a deck says. Parts and instances by folded name; `ignored` counts keywords that say nothing here."""

    file: str
    top: Scope
    parts: dict[str, Scope] = field(default_factory=dict)
    instances: dict[str, Instance] = field(default_factory=dict)
    materials: dict[str, MaterialText] = field(default_factory=dict)
    ignored: Counter[str] = field(default_factory=Counter)
