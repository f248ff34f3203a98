"""Construction of a mesh from a deck."""

from __future__ import annotations

from collections import Counter
from pathlib import Path

from warpffrf.model.errors import InputError, unknown_name
from warpffrf.model.mesh.checks import check_connected, check_distinct, check_orientation, corner_notes
from warpffrf.model.mesh.data import Mesh
from warpffrf.model.mesh.files.inp.parse import parse
from warpffrf.model.mesh.files.inp.sets import cell_sets, choose, facet_sets, listed, materials_of, sections_of
from warpffrf.model.mesh.files.inp.solid import solid_of
from warpffrf.model.mesh.files.raw_mesh import LENGTH_UNITS


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
    solid = solid_of(body, part if of_deck or isinstance(part, int) else None, path.name)

    notes = list(solid.notes)
    if body.instance is not None:
        notes.append(f"read: instance {body.instance.name!r} of part {body.instance.part!r}, as placed in the assembly")
    sections = sections_of(deck, body, solid)
    materials = materials_of(sections, length_unit, notes)
    mesh_cell_sets = cell_sets(body, solid, [name for name, _ in sections], notes)
    mesh_facet_sets = facet_sets(body, solid, notes)
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
    )
    try:
        # what mesh.check() does, with the deck's numbers; nodes without cells are left out already
        check_orientation(mesh.points, mesh.cells, solid.cell_labels, "element")
        check_distinct(mesh.cells, solid.cell_labels, "element")
        check_connected(len(mesh.points), mesh.cells)
        return mesh
    except InputError as error:
        raise InputError(f"mesh file {path.name}: {error}") from None


def _counts(ignored: Counter[str]) -> str:
    return ", ".join(f"*{keyword} ({count})" for keyword, count in sorted(ignored.items()))
