"""Structural elements of a deck: shells and beams with a section, masses, springs between nodes, rigid bodies.

| element | section | not read |
|---|---|---|
| S3, S4, S6, S8, STRI3, STRI65 (R, I and 5 too) | *Shell Section, OFFSET= as in Abaqus | COMPOSITE, NODAL THICKNESS |
| B31, B32, B33 (R too); B32 as two beams | *Beam Section RECT, CIRC, PIPE; *Beam General Section | other sections |
| MASS, ROTARYI | *Mass, *Rotary Inertia | |
| SPRINGA, SPRING2 | *Spring, linear | NONLINEAR, SPRING1 |
| | *Rigid Body with REF NODE= and NSET= (or TIE NSET=) | ELSET=, PIN NSET= |

Shells without a section only name faces of solids, as before (`sets.shell_sets`). OFFSET is the distance of the nodes
from the middle surface over the thickness, so the middle surface lies at -OFFSET t. The first axis n_1 of a beam's
section is its y axis here, I_11 = I_y and I_22 = I_z.
"""

from __future__ import annotations

from collections import Counter
from collections.abc import Callable
from dataclasses import dataclass, field
from typing import Any

import numpy as np

from warpffrf.model.errors import InputError
from warpffrf.model.material import Material, SolidMaterial
from warpffrf.model.mesh.facets import FacetSet
from warpffrf.model.mesh.files.inp import model
from warpffrf.model.mesh.files.inp.deck import Block, Place
from warpffrf.model.mesh.files.inp.model import Deck, MaterialText, Section, Table
from warpffrf.model.mesh.files.inp.sets import material_in_si, material_text
from warpffrf.model.mesh.files.inp.solid import OWN, Body
from warpffrf.model.mesh.files.raw_mesh import LENGTH_UNITS, system_of
from warpffrf.model.mesh.structure import Beam, BeamSection, PointMass, RigidLink, Shell, Spring, Structure

Array = np.ndarray
SPRINGS = ("SPRINGA", "SPRING2")


@dataclass(eq=False)
class DeckStructure:
    """`structure` in SI units, its nodes as positions in `node_labels`, the sorted numbers of all nodes of the body;
    `elements` (e,): sorted numbers of all elements that it contains; `shells`: numbers and facets of shells by kind."""

    structure: Structure
    node_labels: Array
    elements: Array = field(default_factory=lambda: np.zeros(0, dtype=np.int64))
    shells: list[tuple[Array, str, Array]] = field(default_factory=list)

    def facets(self, members: Array) -> FacetSet:
        """The shells with one of the numbers `members`, as facets."""
        blocks: dict[str, list[Array]] = {}
        for labels, kind, nodes in self.shells:
            blocks.setdefault(kind, []).append(nodes[np.isin(labels, members)])
        found = {kind: np.concatenate(parts) for kind, parts in blocks.items()}
        return FacetSet({kind: nodes for kind, nodes in found.items() if len(nodes)})


def structure_of(deck: Deck, body: Body, length_unit: str, notes: list[str]) -> DeckStructure:
    """The structural elements of `body` that have a section. Raises `InputError` for one that cannot be read."""
    blocks = [block for scope in body.own for block in scope.structural]
    labels = body.labels["nset"]
    if not blocks or not len(labels):
        return DeckStructure(Structure(), labels)
    system = system_of(length_unit, [])
    if system is None:
        notes.append(
            f"structural elements are not read: with lengths in {length_unit} the unit of their stiffness is unknown; "
            "it is known in m and mm"
        )
        return DeckStructure(Structure(), labels)
    return _Reader(deck, body, LENGTH_UNITS[length_unit], system[:2], notes).read(blocks)


class _Reader:
    def __init__(self, deck: Deck, body: Body, length: float, system: tuple[float, float], notes: list[str]) -> None:
        self.deck, self.body, self.notes = deck, body, notes
        self.length, (self.stress, self.density) = length, system
        self.labels = body.labels["nset"]
        self.turn = np.eye(3) if body.instance is None else body.instance.rotation
        self.found = DeckStructure(Structure(), self.labels)
        self.parts: list[Any] = []
        self.taken: list[Array] = []
        self.left_out: Counter[str] = Counter()
        self.materials: dict[str, SolidMaterial | None] = {}

    def read(self, blocks: list[Block]) -> DeckStructure:
        handlers: dict[str, Callable[[Block], None]] = {
            "SHELLSECTION": self._shell,
            "BEAMSECTION": self._beam,
            "BEAMGENERALSECTION": self._general_beam,
            "MASS": self._masses,
            "SPRING": self._springs,
            "RIGIDBODY": self._rigid,
        }
        for block in blocks:
            if block.keyword in handlers:
                handlers[block.keyword](block)
        if self.left_out:
            listed = ", ".join(f"{count} {name}" for name, count in self.left_out.items())
            self.notes.append(f"structural elements that are not read: {listed}")
        self.found.structure = Structure(tuple(self.parts))
        self.found.elements = np.unique(np.concatenate([np.zeros(0, dtype=np.int64), *self.taken]))
        return self.found

    # --- tables ---

    def _rows(self, block: Block, wanted: Callable[[Any], bool]) -> list[tuple[Any, Array, Array]]:
        """(elements, numbers, nodes as positions) of the elements of the block's ELSET of which `wanted` is true."""
        elset = block.required("ELSET")
        members = self.body.members(OWN, "elset", elset, block.place)
        found = []
        for scope in self.body.own:
            for elements in scope.elements:
                if elements.table is None or not wanted(elements):
                    continue
                mine = np.isin(elements.labels, members)
                if mine.any():
                    found.append((elements, elements.labels[mine], self._positions(elements.table, mine)))
                    self.taken.append(elements.labels[mine])
        return found

    def _positions(self, table: Table, mine: Array) -> Array:
        rows = table.rows[mine]
        place = np.minimum(np.searchsorted(self.labels, rows), len(self.labels) - 1)
        unknown = np.argwhere(self.labels[place] != rows)
        if len(unknown):
            row = int(np.flatnonzero(mine)[unknown[0, 0]])
            raise table.place(row).fault(f"element {table.labels[row]} refers to a node that does not exist")
        return place

    def _material(self, block: Block) -> Material:
        name = block.required("MATERIAL")
        if name not in self.materials:
            text: MaterialText = material_text(self.deck, Section(block.value("ELSET") or "", name, block.place))
            self.materials[name] = material_in_si(text, self.stress, self.density, self.notes)
        material = self.materials[name]
        if not isinstance(material, Material):
            raise block.place.fault(
                f"*{block.keyword.title()} needs a material with isotropic *Elastic and *Density, {name!r} has not"
            )
        return material

    def _lines(self, block: Block, least: int, what: str) -> list[tuple[list[float], Place]]:
        rows = [(model.reals(fields, place, what, 0), place) for fields, place in block.fields()]
        if not rows or len(rows[0][0]) < least:
            raise block.place.fault(f"{what} needs a data line of {least} number(s)")
        return rows

    def _made(self, place: Place, make: Callable[[], Any]) -> None:
        try:
            self.parts.append(make())
        except InputError as error:
            raise place.fault(str(error)) from None

    # --- sections ---

    def _shell(self, block: Block) -> None:
        for parameter in ("COMPOSITE", "NODALTHICKNESS", "SHELLTHICKNESS"):
            if block.has(parameter):
                raise block.place.fault(f"*Shell Section with {parameter} is not read; give one thickness")
        rows = self._rows(block, lambda elements: elements.shell is not None)
        if not rows:
            return
        thickness = self._lines(block, 1, "*Shell Section")[0][0][0] * self.length
        word = (block.value("OFFSET") or "0").upper()
        side = {"SPOS": 0.5, "SNEG": -0.5, "MIDDLE": 0.0}.get(word)
        offset = side if side is not None else model.reals([word], block.place, "OFFSET", 1)[0]
        material, name = self._material(block), block.required("ELSET")
        for elements, labels, nodes in rows:
            self.found.shells.append((labels, elements.shell, nodes))
            self._made(
                block.place, lambda n=nodes: Shell(n, thickness, material, offset=-offset * thickness, name=name)
            )

    def _beam(self, block: Block) -> None:
        kind = (block.value("SECTION") or "").upper()
        lines = self._lines(block, 1, "*Beam Section")
        sizes = [size * self.length for size in lines[0][0]]
        made: dict[str, tuple[int, Callable[[], BeamSection]]] = {
            "RECT": (2, lambda: BeamSection.rectangle(sizes[0], sizes[1])),
            "CIRC": (1, lambda: BeamSection.circle(sizes[0])),
            "PIPE": (2, lambda: BeamSection.circle(sizes[0], sizes[0] - sizes[1])),
        }
        if kind not in made:
            raise block.place.fault(f"*Beam Section of SECTION={kind} is not read; RECT, CIRC and PIPE are")
        least, section = made[kind]
        if len(sizes) < least:
            raise block.place.fault(f"*Beam Section of SECTION={kind} needs {least} sizes")
        self._beams(block, section, self._material(block), lines[1:2])

    def _general_beam(self, block: Block) -> None:
        kind = (block.value("SECTION") or "GENERAL").upper()
        if kind != "GENERAL":
            raise block.place.fault(f"*Beam General Section of SECTION={kind} is not read; SECTION=GENERAL is")
        lines = self._lines(block, 5, "*Beam General Section")
        if len(lines) < 3 or len(lines[2][0]) < 2:
            raise block.place.fault("*Beam General Section needs three data lines: section, direction, E and G")
        A, I_11, I_12, I_22, J = lines[0][0][:5]
        E, G = (self.stress * value for value in lines[2][0][:2])
        if I_12 != 0.0:
            raise block.place.fault("I_12 is not zero; turn n_1 to the principal axes of the section")
        density = model.reals([block.required("DENSITY")], block.place, "DENSITY", 1)[0] * self.density
        L = self.length
        try:
            material = Material(E, E / (2.0 * G) - 1.0, density)
        except (InputError, ZeroDivisionError) as error:
            raise block.place.fault(str(error)) from None
        self._beams(block, lambda: BeamSection(A * L**2, I_11 * L**4, I_22 * L**4, J * L**4), material, lines[1:2])

    def _beams(self, block: Block, section: Callable[[], BeamSection], material: Material, line: list[Any]) -> None:
        given = line[0][0] if line and line[0][0] else [0.0, 0.0, -1.0]
        direction = self.turn @ np.array([*given, 0.0, 0.0, 0.0])[:3]
        name = block.required("ELSET")
        for _, _, nodes in self._rows(block, lambda e: e.type.startswith("B3")):
            if nodes.shape[1] == 3:
                nodes = np.concatenate([nodes[:, :2], nodes[:, 1:]])
            self._made(block.place, lambda n=nodes: Beam(n, section(), material, direction, name=name))

    def _masses(self, block: Block) -> None:
        unit = self.density * self.length**3
        mass = self._lines(block, 1, "*Mass")[0][0][0] * unit
        for _, _, nodes in self._rows(block, lambda e: e.type == "MASS"):
            for node in nodes[:, 0]:
                inertia = self._inertia(int(node)) * unit * self.length**2
                self._made(block.place, lambda n=node, J=inertia: PointMass(int(n), mass, inertia=J))

    def _inertia(self, node: int) -> Array:
        """Rotary inertia (3, 3) at a node, in the deck's units and the assembly's axes."""
        total = np.zeros((3, 3))
        for block in (b for scope in self.body.own for b in scope.structural if b.keyword == "ROTARYINERTIA"):
            if not any(np.any(nodes == node) for _, _, nodes in self._rows(block, lambda e: e.type == "ROTARYI")):
                continue
            values = np.zeros(6)
            given = self._lines(block, 3, "*Rotary Inertia")[0][0][:6]
            values[: len(given)] = given
            xx, yy, zz, xy, xz, yz = values
            total += np.array([[xx, xy, xz], [xy, yy, yz], [xz, yz, zz]])
        return self.turn @ total @ self.turn.T

    def _springs(self, block: Block) -> None:
        if block.has("NONLINEAR"):
            raise block.place.fault("*Spring with NONLINEAR is not read; use a spring of the scene")
        rows = self._rows(block, lambda elements: elements.type in SPRINGS)
        if not rows:
            return
        lines = list(block.fields())
        if len(lines) < (1 if rows[0][0].type == "SPRINGA" else 2) or not lines[-1][0]:
            raise block.place.fault("*Spring needs the line of its components (blank for SPRINGA) and its stiffness")
        stiffness = model.reals(lines[-1][0], lines[-1][1], "*Spring", 1)[0]
        force = self.stress * self.length**2
        for elements, _, nodes in rows:
            for pair in nodes:
                k, axes = np.zeros(6), self.turn
                if elements.type == "SPRINGA":
                    component = 0
                    axes = _along(self._place(pair[1]) - self._place(pair[0]), lines[-1][1])
                else:
                    both = [int(v) - 1 for v in model.reals(lines[0][0], lines[0][1], "*Spring", 2)[:2]]
                    component = both[0]
                    if both[0] != both[1] or component not in range(6):
                        raise lines[0][1].fault("*Spring: both components must be alike, 1 to 6")
                k[component] = stiffness * (force / self.length if component < 3 else force * self.length)
                ends = (int(pair[0]), int(pair[1]))
                self._made(lines[-1][1], lambda e=ends, k=k, axes=axes: Spring(e, k, axes=axes))

    def _place(self, position: int) -> Array:
        for scope in self.body.own:
            for table in scope.nodes:
                row = np.flatnonzero(table.labels == self.labels[position])
                if len(row):
                    return self.turn @ table.rows[row[-1]]
        raise ValueError("a node without a table")

    def _rigid(self, block: Block) -> None:
        reference, nset = block.value("REFNODE"), block.value("NSET") or block.value("TIENSET")
        if reference is None or nset is None:
            self.left_out["*Rigid Body without REF NODE and NSET"] += 1
            return
        number = model.number_or_none(reference)
        first = np.array([number]) if number is not None else self.body.members(OWN, "nset", reference, block.place)
        nodes = np.concatenate([first, np.setdiff1d(self.body.members(OWN, "nset", nset, block.place), first)])
        if not np.isin(nodes, self.labels).all():
            raise block.place.fault("a node of *Rigid Body does not exist")
        place = np.searchsorted(self.labels, nodes)
        self._made(block.place, lambda: RigidLink(place, name=f"rigid_{first[0]}"))


def _along(direction: Array, place: Place) -> Array:
    """Axes (3, 3) in columns, the first along `direction`."""
    length = np.linalg.norm(direction)
    if not length > 0.0:
        raise place.fault("a SPRINGA needs two nodes apart; use SPRING2")
    first = direction / length
    other = np.cross(first, np.eye(3)[np.argmin(np.abs(first))])
    other /= np.linalg.norm(other)
    return np.stack([first, other, np.cross(first, other)], axis=1)
