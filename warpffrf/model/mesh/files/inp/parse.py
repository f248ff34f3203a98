"""Keyword blocks -> `Deck`: a registry with one function per keyword.

Keywords that are not in the registry have no effect on the body's shape, sets or elastic material and are counted.
Unsupported keywords that create or move nodes and elements are refused.
"""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path

import numpy as np
from scipy.spatial.transform import Rotation

from warpffrf.model.mesh.elements import cell_kind, facet_kind
from warpffrf.model.mesh.files.inp import model
from warpffrf.model.mesh.files.inp.deck import Block, Place, read_blocks
from warpffrf.model.mesh.files.inp.model import (
    Deck,
    Elements,
    Instance,
    MaterialText,
    Members,
    Orientation,
    Scope,
    Section,
    SurfaceDefinition,
    SurfaceItem,
    fold,
    kind_of,
    shell_kind_of,
)

GENERATORS = {
    "NGEN", "NFILL", "NCOPY", "NMAP", "ELGEN", "ELCOPY", "SYSTEM", "SYMMETRICMODELGENERATION"
}  # fmt: skip
STRUCTURAL = (
    "SHELLSECTION", "BEAMSECTION", "BEAMGENERALSECTION", "MASS", "ROTARYINERTIA", "SPRING", "RIGIDBODY"
)  # fmt: skip
ORTHOTROPIC = ("ENGINEERING CONSTANTS", "ENGINEERINGCONSTANTS", "ORTHO", "ORTHOTROPIC")  # types of *Elastic
PARALLEL = 1e-6  # sine of the angle between the points of an orientation below which they lie on one line
TINY = np.finfo(float).tiny
OTHER_FACES = {"SPOS", "SNEG", "SP", "SN", "EDGE", "E1", "E2", "E3", "E4", "END1", "END2"}


class Parser:
    """Collects the contents of the blocks of a deck in `deck`."""

    def __init__(self, path: Path) -> None:
        self.deck = Deck(path.name, Scope("", Place(path.name, 1)))
        self.open: list[tuple[str, Place]] = []  # PART, ASSEMBLY and INSTANCE that have not ended
        self.part: Scope | None = None
        self.instance: Instance | None = None
        self.material: MaterialText | None = None

    @property
    def scope(self) -> Scope:
        """The current scope of nodes, elements and sets."""
        if self.instance is not None:
            return self.instance.scope
        return self.part if self.part is not None else self.deck.top

    def run(self, blocks: list[Block]) -> Deck:
        """Read all blocks; raises `InputError` for invalid blocks, or where an end is missing."""
        for block in blocks:
            handler = HANDLERS.get(block.keyword)
            if block.keyword in GENERATORS:
                raise block.place.fault(f"*{block.keyword} is not supported; write the mesh out node by node")
            if handler is None:
                self.deck.ignored[block.keyword] += 1
            else:
                handler(self, block)
        if self.open:
            keyword, place = self.open[-1]
            raise place.fault(f"*{keyword} has no *End {keyword.title()}; is the deck truncated?")
        for instance in self.deck.instances.values():
            if fold(instance.part) not in self.deck.parts:
                known = ", ".join(repr(p.name) for p in self.deck.parts.values()) or "none"
                raise instance.place.fault(f"there is no part {instance.part!r}; known: {known}")
        return self.deck


def parse(path: Path) -> Deck:
    """The contents of the deck at `path` and its included files."""
    return Parser(path).run(read_blocks(path))


def _nothing(parser: Parser, block: Block) -> None:
    """A title, or the end of an ignored block."""


def _begin(parser: Parser, block: Block, inside: tuple[str, ...]) -> None:
    if tuple(keyword for keyword, _ in parser.open) not in ((), inside):
        keyword, place = parser.open[-1]
        raise block.place.fault(f"*{block.keyword} inside the *{keyword} of {place}, which has not ended")
    parser.open.append((block.keyword, block.place))


def _end(parser: Parser, block: Block) -> None:
    keyword = block.keyword.removeprefix("END")
    if not parser.open or parser.open[-1][0] != keyword:
        raise block.place.fault(f"*End {keyword.title()} without *{keyword.title()}")
    parser.open.pop()


def _part(parser: Parser, block: Block) -> None:
    _begin(parser, block, ())
    name = block.required("NAME")
    known = parser.deck.parts.get(fold(name))
    if known is not None:
        raise block.place.fault(f"part {name!r} is defined already, in {known.place}")
    parser.part = parser.deck.parts[fold(name)] = Scope(name, block.place)


def _end_part(parser: Parser, block: Block) -> None:
    _end(parser, block)
    parser.part = None


def _assembly(parser: Parser, block: Block) -> None:
    _begin(parser, block, ())


def _instance(parser: Parser, block: Block) -> None:
    _begin(parser, block, ("ASSEMBLY",))
    name = block.required("NAME")
    known = parser.deck.instances.get(fold(name))
    if known is not None:
        raise block.place.fault(f"instance {name!r} is defined already, in {known.place}")
    placed = _placement(block)
    parser.instance = Instance(name, block.required("PART"), block.place, Scope(name, block.place), *placed)
    parser.deck.instances[fold(name)] = parser.instance


def _end_instance(parser: Parser, block: Block) -> None:
    _end(parser, block)
    parser.instance = None


def _placement(block: Block) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Translation (3,), a point of the axis (3,) and the rotation matrix: line 1 translates, then line 2 rotates about
    a-b."""
    rows = list(block.fields())
    translation, point, rotation = np.zeros(3), np.zeros(3), np.eye(3)
    if len(rows) > 2:
        raise rows[2][1].fault("an instance has one line of translation and one of rotation")
    if rows:
        values = model.reals(rows[0][0], rows[0][1], "the translation of an instance", 1)
        translation = np.array([*values[:3], 0.0, 0.0])[:3]
    if len(rows) == 2:
        values = model.reals(rows[1][0], rows[1][1], "the rotation of an instance (two points and degrees)", 7)
        point, angle = np.array(values[:3]), np.radians(values[6])
        with np.errstate(over="ignore", invalid="ignore"):
            axis = np.array(values[3:6]) - point
            length = float(np.linalg.norm(axis))
        if not np.isfinite(length) or length == 0.0:
            raise rows[1][1].fault("the two points of the rotation axis coincide")
        rotation = Rotation.from_rotvec(angle * axis / length).as_matrix()
    return translation, point, rotation


def _node(parser: Parser, block: Block) -> None:
    system = (block.value("SYSTEM") or "R").upper()
    if system not in ("R", "RC"):
        raise block.place.fault(f"*Node with SYSTEM={system} is not supported; write the nodes in x, y, z")
    table = model.node_table(block)
    parser.scope.nodes.append(table)
    name = block.value("NSET")
    if name is not None:
        parser.scope.add_members("nset", name, Members(block.place, labels=table.labels))


def _element(parser: Parser, block: Block) -> None:
    element_type = block.required("TYPE").upper()
    kind, shell = kind_of(element_type), shell_kind_of(element_type)
    table = None
    if kind is not None:
        table = model.element_table(block, len(cell_kind(kind).nodes))
    elif shell is not None:
        table = model.element_table(block, len(facet_kind(shell).nodes))
    elif (width := model.structural_nodes(element_type)) is not None:
        table = model.element_table(block, width)
    labels = model.element_numbers(block) if table is None else table.labels
    parser.scope.elements.append(Elements(element_type, kind, block.place, labels, table, shell))
    name = block.value("ELSET")
    if name is not None:
        parser.scope.add_members("elset", name, Members(block.place, labels=labels))


def _set(parser: Parser, block: Block) -> None:
    family = block.keyword.lower()
    name = block.required(block.keyword)
    labels, names = np.zeros(0, dtype=np.int64), []
    ranges: list[tuple[int, int, int]] = []
    if block.has("GENERATE"):
        ranges = model.set_ranges(block)
    else:
        labels, names = model.set_members(block)
    elset = block.value("ELSET") if family == "nset" else None
    members = Members(block.place, block.value("INSTANCE"), labels, tuple(ranges), tuple(names), elset)
    parser.scope.add_members(family, name, members, block.has("INTERNAL"))


def _surface(parser: Parser, block: Block) -> None:
    name = block.required("NAME")
    kind = (block.value("TYPE") or "ELEMENT").upper()
    if kind not in ("ELEMENT", "NODE") or block.has("COMBINE") or block.has("CROP"):
        parser.deck.ignored["SURFACE of another kind than elements or nodes"] += 1
        return
    known = parser.scope.surfaces.get((fold(name), kind == "NODE"))
    if known is not None:
        raise block.place.fault(f"surface {name!r} is defined already, in {known.place}")
    items = []
    for fields, place in block.fields():
        if not fields or not fields[0]:
            raise place.fault(f"surface {name!r}: a line begins with an element, a node or a set")
        face = fields[1].upper() if len(fields) > 1 and kind == "ELEMENT" else ""
        if face in OTHER_FACES:
            parser.deck.ignored[f"SURFACE lines with face {face} of shells, beams or plane elements"] += 1
            continue
        if face and (len(face) != 2 or face[0] != "S" or face[1] not in "123456"):
            raise place.fault(f"surface {name!r}: {face!r} is no face of a solid element; S1 to S6 are")
        items.append(SurfaceItem(fields[0], int(face[1]) if face else None, place))
    definition = SurfaceDefinition(name, block.place, kind == "NODE", block.has("INTERNAL"), items)
    parser.scope.surfaces[fold(name), kind == "NODE"] = definition


def _solid_section(parser: Parser, block: Block) -> None:
    material = block.value("MATERIAL")
    if material is None:
        parser.deck.ignored["SOLIDSECTION without MATERIAL="] += 1
        return
    section = Section(block.required("ELSET"), material, block.place, block.value("ORIENTATION"))
    parser.scope.sections.append(section)


def _orientation(parser: Parser, block: Block) -> None:
    """Point a on axis 1 and b in the plane of axes 1 and 2, from the origin or from a third point; then, on a second
    line, an axis about which the system turns, and the angle [degrees]."""
    parser.scope.orientations[fold(block.required("NAME"))] = _axes(block)


def _axes(block: Block) -> Orientation:
    system = (block.value("SYSTEM") or "RECTANGULAR").upper()
    definition = (block.value("DEFINITION") or "COORDINATES").upper()
    rows = [model.reals(fields, place, "*Orientation", 0) for fields, place in block.fields()]
    if system != "RECTANGULAR" or definition != "COORDINATES":
        return Orientation(None, f"it is of system {system}, defined by {definition}; only rectangular ones are read")
    if not rows or len(rows[0]) not in (6, 9) or len(rows) > 2:
        return Orientation(None, "it needs a line of two or three points, and at most one more")
    a, b, c = np.reshape([*rows[0], 0.0, 0.0, 0.0][:9], (3, 3))
    with np.errstate(over="ignore", invalid="ignore"):
        first, normal = a - c, np.cross(a - c, b - c)
        sizes = np.linalg.norm(first), np.linalg.norm(normal)
    if not (0.0 < sizes[0] < np.inf and PARALLEL * sizes[0] * np.linalg.norm(b - c) < sizes[1] < np.inf):
        return Orientation(None, "its points lie on one line")
    e_1, e_3 = first / sizes[0], normal / sizes[1]
    R = np.array([e_1, np.cross(e_3, e_1), e_3])
    if len(rows) == 2:
        about, angle = [*rows[1], 0.0][:2] if rows[1] else (1.0, 0.0)
        if about not in (1.0, 2.0, 3.0):
            return Orientation(None, f"it turns about the axis {about:g}, which is none of 1, 2, 3")
        vector = np.zeros(3)
        vector[int(about) - 1] = np.radians(angle)
        R = Rotation.from_rotvec(vector).as_matrix().T @ R
    return Orientation(R[:2])


def _structural(parser: Parser, block: Block) -> None:
    parser.scope.structural.append(block)


def _material(parser: Parser, block: Block) -> None:
    name = block.required("NAME")
    known = parser.deck.materials.get(fold(name))
    if known is not None:
        raise block.place.fault(f"material {name!r} is defined already, in {known.place}")
    parser.material = parser.deck.materials[fold(name)] = MaterialText(name, block.place)


def _property(parser: Parser, block: Block, what: str, count: int) -> tuple[MaterialText, list[float]]:
    """The current material, and the first row of a property table; further rows are noted."""
    if parser.material is None:
        raise block.place.fault(f"*{block.keyword.title()} without a *Material before it")
    rows = list(block.fields())
    if not rows:
        raise block.place.fault(f"*{block.keyword.title()} has no data line")
    material = parser.material
    values = model.reals(rows[0][0], rows[0][1], what, count)
    if len(rows) > 1:
        at = f", at temperature {values[count]:g}" if len(values) > count else ""
        material.notes.append(f"of the {len(rows)} rows of *{block.keyword.title()} the first is used{at}")
    return material, values


def _elastic(parser: Parser, block: Block) -> None:
    kind = (block.value("TYPE") or "ISOTROPIC").upper()
    if kind in ORTHOTROPIC:
        _nine_constants(parser, block, kind)
        return
    if kind not in ("ISOTROPIC", "ISO"):
        if parser.material is not None:
            parser.material.faults.append(f"*Elastic of type {kind} is neither isotropic nor orthotropic")
        return
    material, values = _property(parser, block, "*Elastic (Young's modulus, Poisson ratio)", 2)
    material.elastic = (values[0], values[1])


def _nine_constants(parser: Parser, block: Block, kind: str) -> None:
    """Nine constants on two lines: engineering constants, or D_1111, D_1122, D_2222, D_1133, D_2233, D_3333, D_1212,
    D_1313, D_2323 of the stiffness."""
    material, values = _property(parser, block, f"*Elastic, TYPE={kind}", 8)
    rows = list(block.fields())
    more = model.reals(*rows[1], f"*Elastic, TYPE={kind}", 1) if len(rows) > 1 else []
    if len(values) != 8 or not more:
        raise block.place.fault(f"*Elastic, TYPE={kind} needs eight constants on a line and the ninth on the next")
    material.notes[:] = [note for note in material.notes if "rows of *Elastic" not in note]
    if len(rows) > 2:
        material.notes.append(f"of {len(rows) // 2} temperatures of *Elastic the first is used")
    values = [*values, more[0]]
    if kind.startswith("ENGINEERING"):
        material.orthotropic = [values[:3], values[3:6], values[6:]]
        return
    D = np.array([values[k] for k in (0, 1, 3, 1, 2, 4, 3, 4, 5)]).reshape(3, 3)
    with np.errstate(all="ignore"):
        positive = np.all(np.isfinite(D)) and np.linalg.eigvalsh(D / max(np.abs(D).max(), TINY))[0] > 0.0
    if not positive:
        material.faults.append("its stiffness of the normal strains is not positive definite")
        return
    S = np.linalg.inv(D)
    E = 1.0 / np.diag(S)
    nu = [-S[0, 1] * E[0], -S[0, 2] * E[0], -S[1, 2] * E[1]]
    material.orthotropic = [E.tolist(), nu, values[6:]]


def _density(parser: Parser, block: Block) -> None:
    material, values = _property(parser, block, "*Density", 1)
    material.density = values[0]


HANDLERS: dict[str, Callable[[Parser, Block], None]] = {
    "HEADING": _nothing,
    "PART": _part,
    "ENDPART": _end_part,
    "ASSEMBLY": _assembly,
    "ENDASSEMBLY": _end,
    "INSTANCE": _instance,
    "ENDINSTANCE": _end_instance,
    "NODE": _node,
    "ELEMENT": _element,
    "NSET": _set,
    "ELSET": _set,
    "SURFACE": _surface,
    "SOLIDSECTION": _solid_section,
    "ORIENTATION": _orientation,
    **dict.fromkeys(STRUCTURAL, _structural),
    "MATERIAL": _material,
    "ELASTIC": _elastic,
    "DENSITY": _density,
}
