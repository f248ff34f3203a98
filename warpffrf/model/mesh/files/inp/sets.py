"""Named sets of a deck as sets of the mesh: of elements -> cell sets; surfaces, sets of shells, of nodes -> facet sets.

Sets of the part (or of a deck without parts) keep their names. A set of the assembly has its own name too, unless the
part uses it for something else: then it is called `assembly.NAME`. Sets that a preprocessor marks `internal` are
omitted, unless a material requires them. A set of shells (or membranes, plane elements, as meshers write the groups of
a surface) becomes a facet set of the free faces they lie on, a node set one of the free faces all of whose nodes it
contains; of one name, a surface takes precedence, then shells.

Select. The body of a deck that is read: the only one, or the one that `part=` names.

Faces. The faces of a body's cells with their S numbers: surfaces and node sets become facets.

A surface `elset, S3` is face 3 of each element of the set; without a face it is all free faces of those elements. A
*free* (outer) face belongs to one cell only. Facets keep the node order of the cell's face, outward.

Sections. *Solid Section and *Material -> {cell set: Material} in SI units.

A deck has no units: its numbers form the consistent system that follows from the unit of length (`units`).
"""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from dataclasses import dataclass
from functools import cached_property

import numpy as np

from warpffrf.model.errors import InputError
from warpffrf.model.material import Material, Orthotropic, SolidMaterial
from warpffrf.model.mesh.elements import facet_kind
from warpffrf.model.mesh.facets import FacetSet, row_numbers
from warpffrf.model.mesh.files.inp.model import (
    FACE_COUNT,
    Deck,
    Instance,
    MaterialText,
    Orientation,
    Scope,
    Section,
    SetDefinition,
    SurfaceDefinition,
    faces_of,
    fold,
)
from warpffrf.model.mesh.files.inp.solid import ASSEMBLY, OWN, Body, Solid
from warpffrf.model.mesh.files.raw_mesh import system_of

ASSEMBLY_PREFIX = "assembly."
MANY = 8  # items shown in a note


def cell_sets(body: Body, solid: Solid, needed: Iterable[str], notes: list[str]) -> dict[str, np.ndarray]:
    """{name: cell numbers} of the element sets that contain cells; `needed` are own sets that are kept although
    internal."""
    keep = {fold(name) for name in needed}
    found: dict[str, np.ndarray] = {}
    for level, definition in definitions(body, "elset"):
        numbers = solid.cell_numbers(body.members(level, "elset", definition.name, definition.place))
        if not len(numbers) or (definition.internal and (level == ASSEMBLY or fold(definition.name) not in keep)):
            continue
        name = definition.name
        taken = {fold(k): v for k, v in found.items()}.get(fold(name))
        if taken is not None:
            if np.array_equal(taken, numbers):
                continue
            name = _second_name(name, "element set", notes)
        found[name] = numbers
    return found


def facet_sets(body: Body, solid: Solid, notes: list[str]) -> dict[str, FacetSet]:
    """{name: facets} of the surfaces, then of the node sets, that contain free faces."""
    faces = Faces(solid.cells)
    found: dict[str, FacetSet] = {}
    for level in body.levels():
        for surface in body.surfaces(level):
            if surface.internal:
                continue
            facets, inside = _surface(body, level, surface, solid, faces)
            if inside:
                notes.append(f"surface {surface.name!r}: {inside} faces inside the body are left out")
            own = body.scopes(level)
            if surface.nodal and any((fold(surface.name), False) in scope.surfaces for scope in own):
                notes.append(f"surface {surface.name!r} of nodes is not used, a surface of element faces has that name")
                continue
            _add(found, surface.name, facets, "surface", notes)
    for name, facets in shell_sets(body, solid, faces, notes):
        if fold(name) not in {fold(k) for k in found}:
            found[name] = facets
    surfaces = {fold(name): len(facets) for name, facets in found.items()}
    dropped: list[str] = []
    for level, definition in definitions(body, "nset"):
        labels = body.members(level, "nset", definition.name, definition.place)
        if definition.internal or not len(labels):
            continue
        facets = faces.over_nodes(solid.node_mask(labels))
        if not len(facets):
            dropped.append(definition.name)
        elif fold(definition.name) in surfaces:
            if surfaces[fold(definition.name)] != len(facets):
                notes.append(f"node set {definition.name!r} is not used, a surface has that name")
        else:
            _add(found, definition.name, facets, "node set", notes)
    if dropped:
        notes.append(f"node sets without a complete free face are not used: {listed([repr(n) for n in dropped])}")
    return found


def shell_sets(body: Body, solid: Solid, faces: Faces, notes: list[str]) -> list[tuple[str, FacetSet]]:
    """(name, facets) of the element sets that contain shells on the surface of the cells, and no cells."""
    shells = [
        (block.labels, block.shell, block.table.rows)
        for scope in body.own
        for block in scope.elements
        if block.shell is not None and block.table is not None
    ]
    found: list[tuple[str, FacetSet]] = []
    for level, definition in definitions(body, "elset") if shells else []:
        members = body.members(level, "elset", definition.name, definition.place)
        if definition.internal or len(solid.cell_numbers(members)):
            continue
        on_body = 0  # shells all of whose corners are nodes of cells; others belong to omitted parts
        blocks: dict[str, list[np.ndarray]] = {}
        for labels, shell, rows in shells:
            corners = rows[np.isin(labels, members), : facet_kind(shell).corner_count]
            place = np.minimum(np.searchsorted(solid.node_labels, corners), len(solid.node_labels) - 1)
            known = (solid.node_labels[place] == corners).all(axis=1)
            on_body += int(known.sum())
            if known.any():
                for kind, nodes in faces.under(place[known]).blocks.items():
                    blocks.setdefault(kind, []).append(nodes)
        facets = FacetSet({kind: np.unique(np.concatenate(parts), axis=0) for kind, parts in blocks.items()})
        if len(facets):
            found.append((definition.name, facets))
        if on_body > len(facets):
            notes.append(
                f"element set {definition.name!r}: {on_body - len(facets)} shells inside the body are left out"
            )
    return found


def listed(items: list[str]) -> str:
    """The first items of a list, and how many more there are."""
    shown = ", ".join(items[:MANY])
    return shown if len(items) <= MANY else f"{shown} and {len(items) - MANY} more"


def definitions(body: Body, family: str) -> list[tuple[str, SetDefinition]]:
    """All sets with members of the body, with their level; the first of a name in each level."""
    found = []
    for level in body.levels():
        names = [key for scope in body.scopes(level) for key in scope.sets[family]]
        for key in dict.fromkeys(names):
            definition = body.definition(level, family, key)
            if definition is not None:
                found.append((level, definition))
    return found


def _surface(body: Body, level: str, surface: SurfaceDefinition, solid: Solid, faces: Faces) -> tuple[FacetSet, int]:
    """The free faces of a surface, and how many of its faces lie inside."""
    if surface.nodal:
        labels = [body.surface_target(level, "nset", item.target, item.place) for item in surface.items]
        return faces.over_nodes(solid.node_mask(np.concatenate([np.zeros(0, dtype=np.int64), *labels]))), 0
    wanted = np.zeros_like(faces.exists)
    for item in surface.items:
        labels = body.surface_target(level, "elset", item.target, item.place)
        numbers = solid.cell_numbers(labels)
        if not len(numbers):
            continue
        if item.face is None:
            wanted |= faces.free_of(numbers)
            continue
        number = solid.face_numbers(numbers, item.face)
        has = faces.exists[numbers, number]
        if not has.any():
            raise item.place.fault(f"surface {surface.name!r}: the cells of {item.target!r} have no face S{item.face}")
        wanted[numbers[has], number[has]] = True
    return faces.selected(wanted)


def _add(found: dict[str, FacetSet], name: str, facets: FacetSet, what: str, notes: list[str]) -> None:
    if not len(facets):
        return
    taken = {fold(k): v for k, v in found.items()}.get(fold(name))
    if taken is not None:
        if taken.blocks.keys() == facets.blocks.keys() and all(
            np.array_equal(taken.blocks[kind], nodes) for kind, nodes in facets.blocks.items()
        ):
            return
        name = _second_name(name, what, notes)
    found[name] = facets


def _second_name(name: str, what: str, notes: list[str]) -> str:
    """The name of a set of the assembly if the part has another one of that name."""
    notes.append(f"the {what} {name!r} of the assembly is called {ASSEMBLY_PREFIX + name!r}, the part has another one")
    return ASSEMBLY_PREFIX + name


def choose(deck: Deck, part: str | None) -> Body:
    """The body that `part` names: an instance, else the one instance of a part, else a part without instances.

    Without `part` the deck must have one body. Raises `InputError` that lists the names.
    """
    if not deck.instances and not deck.parts:
        if not deck.top.has_cells and not deck.top.has_structure:
            raise _no_cells(deck)
        return Body("", (deck.top,), deck.top.place)
    if any(block.kind is not None for block in deck.top.elements):
        place = next(block.place for block in deck.top.elements if block.kind is not None)
        raise place.fault("solid elements outside the parts are not supported; put them into a *Part with an *Instance")
    bodies = _bodies(deck)
    names = ", ".join(repr(body.name) for body in bodies.values())
    if part is None:
        if not bodies:
            raise _no_cells(deck)
        if len(bodies) > 1:
            raise InputError(
                f"mesh file {deck.file}: there are {len(bodies)} bodies, select one with part=, one of {names}"
            )
        return next(iter(bodies.values()))
    if fold(part) in bodies:
        return bodies[fold(part)]
    of_part = [i for i in deck.instances.values() if fold(i.part) == fold(part)]
    if len(of_part) == 1 and fold(of_part[0].name) in bodies:
        return bodies[fold(of_part[0].name)]
    if len(of_part) > 1:
        placed = ", ".join(repr(i.name) for i in of_part)
        raise InputError(
            f"mesh file {deck.file}: part {part!r} is placed more than once, select one with part=, one of {placed}"
        )
    empty = deck.instances.get(fold(part))
    if empty is not None:
        scopes = (empty.scope, deck.parts[fold(empty.part)])
        raise empty.place.fault(
            f"instance {part!r} has no solid elements (element types: {_types(scopes)}); select one with part=, one "
            f"of {names or 'none'}"
        )
    raise InputError(f"mesh file {deck.file}: there is no body {part!r}; known: {names or 'none'}")


def _bodies(deck: Deck) -> dict[str, Body]:
    """Instances with volume elements by folded name; parts without instances if there are no instances at all."""
    bodies: dict[str, Body] = {}
    for key, instance in deck.instances.items():
        scopes = (instance.scope, deck.parts[fold(instance.part)])
        if any(scope.has_cells or scope.has_structure for scope in scopes):
            bodies[key] = _placed(deck, instance)
    if not deck.instances:
        bodies = {key: Body(p.name, (p,), p.place) for key, p in deck.parts.items() if p.has_cells or p.has_structure}
    return bodies


def _placed(deck: Deck, instance: Instance) -> Body:
    scopes = (instance.scope, deck.parts[fold(instance.part)])
    return Body(instance.name, scopes, instance.place, deck.top, instance, deck.instances)


def _no_cells(deck: Deck) -> InputError:
    found = _types((deck.top, *deck.parts.values()))
    return InputError(f"mesh file {deck.file}: there are no solid elements (element types: {found}); export a 3-D mesh")


def _types(scopes: Iterable[Scope]) -> str:
    return ", ".join(sorted({block.type for scope in scopes for block in scope.elements})) or "none"


@dataclass(frozen=True, eq=False)
class FaceBlock:
    """Faces of one facet kind: `nodes` (f, kf), the `cell` (f,) and S number (f,) of each, and whether it is free."""

    nodes: np.ndarray
    cell: np.ndarray
    number: np.ndarray
    free: np.ndarray

    @cached_property
    def free_nodes(self) -> np.ndarray:
        """Nodes of the free faces."""
        return self.nodes[self.free]


class Faces:
    """All faces of the cells {kind: (m, k)}, cells numbered through the kinds."""

    def __init__(self, cells: Mapping[str, np.ndarray]) -> None:
        self.cell_count = sum(len(nodes) for nodes in cells.values())
        self.exists = np.zeros((self.cell_count, FACE_COUNT + 1), dtype=bool)  # column 0 is no face
        pieces: dict[str, list[tuple[np.ndarray, np.ndarray, np.ndarray]]] = {}
        start = 0
        for kind, nodes in cells.items():
            numbers = np.arange(start, start + len(nodes))
            for s, (facet, local) in enumerate(faces_of(kind), start=1):
                self.exists[numbers, s] = True
                pieces.setdefault(facet, []).append((nodes[:, local], numbers, np.full(len(nodes), s)))
            start += len(nodes)
        self.blocks: dict[str, FaceBlock] = {}
        for facet, parts in pieces.items():
            nodes, cell, number = (np.concatenate(arrays) for arrays in zip(*parts, strict=True))
            free = _single(nodes[:, : facet_kind(facet).corner_count])
            self.blocks[facet] = FaceBlock(nodes, cell, number, free)

    def selected(self, wanted: np.ndarray) -> tuple[FacetSet, int]:
        """The free faces marked in `wanted` (cells, FACE_COUNT + 1), and the number of marked inner faces."""
        found, inside = {}, 0
        for facet, block in self.blocks.items():
            marked = wanted[block.cell, block.number]
            found[facet] = block.nodes[marked & block.free]
            inside += int(np.sum(marked & ~block.free))
        return FacetSet(found), inside

    def free_of(self, cells: np.ndarray) -> np.ndarray:
        """The mask (cells, FACE_COUNT + 1) of the free faces of some cells."""
        chosen = np.zeros(self.cell_count, dtype=bool)
        chosen[cells] = True
        mask = np.zeros_like(self.exists)
        for block in self.blocks.values():
            rows = block.free & chosen[block.cell]
            mask[block.cell[rows], block.number[rows]] = True
        return mask

    def under(self, corners: np.ndarray) -> FacetSet:
        """The free faces that have the same corners (m, 3 or 4) as one of the rows, in any order."""
        found = {}
        keys = np.sort(corners, axis=1)
        for facet, block in self.blocks.items():
            own = np.sort(block.free_nodes[:, : facet_kind(facet).corner_count], axis=1)
            if own.shape[1] != keys.shape[1]:
                continue
            same = row_numbers(np.concatenate([keys, own]))
            found[facet] = block.free_nodes[np.isin(same[len(keys) :], same[: len(keys)])]
        return FacetSet(found)

    def over_nodes(self, node_mask: np.ndarray) -> FacetSet:
        """The free faces all of whose nodes are marked in `node_mask` (n,)."""
        return FacetSet({f: b.free_nodes[node_mask[b.free_nodes].all(axis=1)] for f, b in self.blocks.items()})


def _single(corners: np.ndarray) -> np.ndarray:
    """Which rows of node numbers (f, c) occur once, in any order of the numbers."""
    keys = np.sort(corners, axis=1)
    order = np.lexsort(keys.T[::-1])
    same = np.all(keys[order[1:]] == keys[order[:-1]], axis=1)
    single = np.ones(len(keys), dtype=bool)
    single[order[1:][same]] = False
    single[order[:-1][same]] = False
    return single


def sections_of(deck: Deck, body: Body, solid: Solid) -> list[tuple[str, MaterialText, Orientation | None]]:
    """Element sets (their names) that contain cells, with their materials and orientations in the mesh's frame.

    Raises `InputError` for an unknown set or material and for a set with two sections.
    """
    found: dict[str, tuple[str, MaterialText, Orientation | None]] = {}
    for scope in body.own:
        for section in scope.sections:
            material = material_text(deck, section)
            members = body.members(OWN, "elset", section.elset, section.place)
            definition = body.definition(OWN, "elset", section.elset)
            if definition is None or not len(solid.cell_numbers(members)):
                continue
            key = fold(section.elset)
            of = None
            if section.orientation is not None:
                of = scope.orientations.get(fold(section.orientation))
                if of is None:
                    of = Orientation(None, f"there is no *Orientation {section.orientation!r} in its part")
                elif of.axes is not None and body.instance is not None:
                    of = Orientation(of.axes @ body.instance.rotation.T)
            if key in found and found[key][1] is not material:
                raise section.place.fault(f"element set {section.elset!r} has a section of another material already")
            found[key] = (definition.name, material, of)
    return list(found.values())


def material_text(deck: Deck, section: Section) -> MaterialText:
    """The material of a section. Raises `InputError` for an unknown one."""
    material = deck.materials.get(fold(section.material))
    if material is None:
        known = ", ".join(repr(m.name) for m in deck.materials.values()) or "none"
        raise section.place.fault(f"there is no material {section.material!r}; known: {known}")
    return material


def materials_of(
    sections: list[tuple[str, MaterialText, Orientation | None]], length_unit: str, notes: list[str]
) -> dict[str, SolidMaterial]:
    """{cell set: Material} [SI] of the sections; `notes` list omitted data."""
    if not sections:
        return {}
    system = system_of(length_unit, notes)
    if system is None:
        return {}
    stress, density, units = system
    made: dict[str, SolidMaterial] = {}
    for elset, text, orientation in sections:
        for note in dict.fromkeys(text.notes):
            notes.append(f"material {text.name!r}: {note}")
        material = material_in_si(text, stress, density, notes, orientation)
        if material is not None:
            made[elset] = material
    if made:
        notes.append(f"materials are read in {units}, the system of units with lengths in {length_unit}")
    return made


def material_in_si(
    text: MaterialText, stress: float, density: float, notes: list[str], orientation: Orientation | None = None
) -> SolidMaterial | None:
    """The material [SI]; None, with a note, where it is not usable. `stress`, `density`: the units of the deck;
    `orientation`: of the section, which an orthotropic one needs."""
    faults = list(text.faults)
    if text.orthotropic is not None and text.density is not None and not faults:
        if orientation is not None and orientation.fault:
            faults.append(f"*Orientation: {orientation.fault}")
        else:
            return _orthotropic(text, stress, density * text.density, orientation, notes)
    if text.elastic is None and text.orthotropic is None and not faults:
        faults.append("it has no *Elastic")
    if text.density is None:
        faults.append("it has no *Density")
    if text.elastic is not None and text.density is not None and not faults:
        try:
            with np.errstate(over="ignore"):
                return Material(stress * text.elastic[0], text.elastic[1], density * text.density, name=text.name)
        except InputError as error:
            faults.append(str(error))
    notes.append(f"material {text.name!r} ({text.place}) is not used: {'; '.join(faults)}")
    return None


def _orthotropic(
    text: MaterialText, stress: float, density: float, orientation: Orientation | None, notes: list[str]
) -> Orthotropic | None:
    """The orthotropic material [SI] of nine constants; None, with a note, where they are not possible."""
    E, nu, G = text.orthotropic or ([], [], [])
    axes = np.eye(3)[:2]
    if orientation is not None and orientation.axes is not None:
        axes = orientation.axes
    else:
        notes.append(f"material {text.name!r}: its section has no ORIENTATION, its axes are those of the coordinates")
    try:
        with np.errstate(over="ignore"):
            moduli, shear = (stress * np.array(values) for values in (E, G))
            return Material.orthotropic(moduli, nu, shear, density, axes=(axes[0], axes[1]), name=text.name)
    except InputError as error:
        notes.append(f"material {text.name!r} ({text.place}) is not used: {error}")
    return None
