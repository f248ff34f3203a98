"""Construction of a mesh from a deck."""

from __future__ import annotations

from collections import Counter
from pathlib import Path

import numpy as np

from warpffrf.model.errors import InputError, unknown_name
from warpffrf.model.mesh.checks import check_connected, check_distinct, check_orientation, check_structure, corner_notes
from warpffrf.model.mesh.data import Mesh
from warpffrf.model.mesh.facets import FacetSet
from warpffrf.model.mesh.files.inp.parse import parse
from warpffrf.model.mesh.files.inp.sets import (
    cell_sets,
    choose,
    definitions,
    facet_sets,
    listed,
    materials_of,
    sections_of,
)
from warpffrf.model.mesh.files.inp.solid import Body, Solid, solid_of
from warpffrf.model.mesh.files.inp.structure import DeckStructure, structure_of
from warpffrf.model.mesh.files.raw_mesh import LENGTH_UNITS, attached, rotating_sets
from warpffrf.model.mesh.structure import RigidLink, Structure


def read_inp(path: str | Path, *, length_unit: str, part: int | str | None = None) -> Mesh:
    """Read the mesh, sets, surfaces and materials of one body from an Abaqus or CalculiX deck.

    `length_unit` is the unit of the deck's coordinates (m, cm, mm, um, in, ft); points become metres, in the frame of
    the assembly. `part` selects the body: the name of an instance or of a part that is placed once; in a deck without
    parts the name of an element set; or the number of a connected part (0 is that of the first cell). It is required
    if there are several. C3D4, 6, 8, 10, 15 and 20 are read with any formulation, which `Mesh.notes` reports
    together with all omissions.

    Raises `InputError`, with file and line, for a deck that is invalid, refers to something that does not
    exist, or has several bodies; and for inverted cells or disconnected parts.
    """
    path = Path(path)
    if length_unit not in LENGTH_UNITS:
        raise unknown_name("length unit", length_unit, LENGTH_UNITS)
    if part is not None and (isinstance(part, bool) or not isinstance(part, int | str)):
        raise InputError(f"part must be a name or the number of a connected part, got {part!r}")
    deck = parse(path)
    body = choose(deck, part if isinstance(part, str) else None)
    of_deck = not deck.parts and not deck.instances
    wanted = part if of_deck or isinstance(part, int) else None
    notes: list[str] = []
    labels = body.labels["nset"]
    extra = structure_of(deck, body, length_unit, notes) if wanted is None else DeckStructure(Structure(), labels)
    solid, structure = _with_structure(body, extra, wanted, path.name, notes)
    notes = [*solid.notes, *notes]
    if body.instance is not None:
        notes.append(f"read: instance {body.instance.name!r} of part {body.instance.part!r}, as placed in the assembly")
    sections = sections_of(deck, body, solid)
    materials = materials_of(sections, length_unit, notes)
    mesh_cell_sets = cell_sets(body, solid, [name for name, *_ in sections], notes)
    mesh_facet_sets = facet_sets(body, solid, notes)
    node_sets = _structural_sets(body, extra, solid, structure, mesh_facet_sets, notes)
    absent = [f"{name!r} ({count})" for name, count in body.missing.items() if count > 0]
    if absent:
        notes.append(f"members of sets that the body does not have are left out: {listed(absent)}")
    if deck.ignored:
        notes.append(f"keywords that are not used: {_counts(deck.ignored)}")
    notes += corner_notes(solid.points, solid.cells, solid.cell_labels, "element")
    mesh = Mesh(
        solid.points * LENGTH_UNITS[length_unit],
        solid.cells,
        mesh_facet_sets,
        name=f"{path.stem}:{body.name}" if body.name else path.stem,
        cell_sets=mesh_cell_sets,
        materials=materials,
        notes=tuple(notes),
        structure=structure,
        node_sets=node_sets,
    )
    try:
        # what mesh.check() does, with the deck's numbers; nodes without cells are left out already
        check_orientation(mesh.points, mesh.cells, solid.cell_labels, "element")
        if mesh.cells:
            check_distinct(mesh.cells, solid.cell_labels, "element")
        if structure.parts:
            check_structure(len(mesh.points), mesh.cells, structure)
        else:
            check_connected(len(mesh.points), mesh.cells)
        return mesh
    except InputError as error:
        raise InputError(f"mesh file {path.name}: {error}") from None


def _with_structure(
    body: Body, extra: DeckStructure, part: int | str | None, file: str, notes: list[str]
) -> tuple[Solid, Structure]:
    """Solid cells, and the structural elements connected with them, nodes of both as positions in the solid's."""
    if not extra.structure.parts:
        return solid_of(body, part, file), Structure()
    has_cells = any(block.kind is not None and len(block.labels) for scope in body.own for block in scope.elements)
    structure = extra.structure
    if has_cells:
        alone = solid_of(body, None, file)
        at = np.searchsorted(extra.node_labels, alone.node_labels)
        cells = [at[nodes] for nodes in alone.cells.values()]
        structure = attached(structure, cells, len(extra.node_labels), notes)
        if not structure.parts:
            return alone, structure
    solid = solid_of(body, None, file, extra.node_labels[structure.nodes()], extra.elements)
    return solid, structure.renumbered(_numbers(extra, solid))


def _numbers(extra: DeckStructure, solid: Solid) -> np.ndarray:
    """The node of the mesh for each node of the body, -1 for those left out."""
    place = np.minimum(np.searchsorted(solid.node_labels, extra.node_labels), len(solid.node_labels) - 1)
    return np.where(solid.node_labels[place] == extra.node_labels, place, -1)


def _structural_sets(
    body: Body, extra: DeckStructure, solid: Solid, structure: Structure, taken: dict[str, FacetSet], notes: list[str]
) -> dict[str, np.ndarray]:
    """Adds the element sets of shells to `taken`; returns {name: nodes} of node sets with rotating nodes."""
    if not structure.parts:
        return {}
    number = _numbers(extra, solid)
    for level, definition in definitions(body, "elset"):
        members = body.members(level, "elset", definition.name, definition.place)
        facets = extra.facets(members)
        blocks = {kind: number[nodes] for kind, nodes in facets.blocks.items()}
        facets = FacetSet({kind: nodes[(nodes >= 0).all(axis=1)] for kind, nodes in blocks.items()})
        known = taken.get(definition.name)
        # shells on faces of solids keep the outward normals of those
        if len(facets) and not definition.internal and (known is None or len(known) != len(facets)):
            taken[definition.name] = facets
        if len(facets):  # shells that are no faces of solids are not left out
            notes[:] = [note for note in notes if not note.startswith(f"element set {definition.name!r}: ")]
    groups = {link.name: np.asarray(link.nodes) for link in structure.of(RigidLink)}
    found = rotating_sets(structure, taken, np.arange(len(solid.node_labels)), groups)
    for level, definition in definitions(body, "nset"):
        members = body.members(level, "nset", definition.name, definition.place)
        nodes = np.flatnonzero(solid.node_mask(members))
        if not definition.internal:
            found |= rotating_sets(structure, taken, np.arange(len(solid.node_labels)), {definition.name: nodes})
    used = [note for note in notes if note.startswith("node sets without a complete free face")]
    if used and found:
        notes.remove(used[0])
    return found


def _counts(ignored: Counter[str]) -> str:
    return ", ".join(f"*{keyword} ({count})" for keyword, count in sorted(ignored.items()))
