"""Named sets of a deck as sets of the mesh: of elements -> cell sets; surfaces, sets of shells, of nodes -> facet sets.

Sets of the part (or of a deck without parts) keep their names. A set of the assembly has its own name too, unless the
part uses it for something else: then it is called `assembly.NAME`. Sets that a preprocessor marks `internal` are left
out, unless a material needs them. A set of shells (or membranes, plane elements: so meshers write the groups of a
surface) becomes a facet set of the free faces they lie on, a node set one of the free faces all of whose nodes it
holds; of one name, a surface goes first, then shells.
"""

from __future__ import annotations

from collections.abc import Iterable

import numpy as np

from warpffrf.model.mesh.elements import facet_kind
from warpffrf.model.mesh.facets import FacetSet
from warpffrf.model.mesh.files.inp.body import ASSEMBLY, Body
from warpffrf.model.mesh.files.inp.faces import Faces
from warpffrf.model.mesh.files.inp.model import SetDefinition, SurfaceDefinition, fold
from warpffrf.model.mesh.files.inp.solid import Solid

ASSEMBLY_PREFIX = "assembly."
MANY = 8  # items shown in a note


def cell_sets(body: Body, solid: Solid, needed: Iterable[str], notes: list[str]) -> dict[str, np.ndarray]:
    """{name: cell numbers} of the element sets that hold cells; `needed` are own sets that are kept though internal."""
    keep = {fold(name) for name in needed}
    found: dict[str, np.ndarray] = {}
    for level, definition in _definitions(body, "elset"):
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
    """{name: facets} of the surfaces, then of the node sets, that hold free faces."""
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
                notes.append(f"surface {surface.name!r} of nodes is not taken over, one of element faces has that name")
                continue
            _add(found, surface.name, facets, "surface", notes)
    for name, facets in shell_sets(body, solid, faces, notes):
        if fold(name) not in {fold(k) for k in found}:
            found[name] = facets
    surfaces = {fold(name): len(facets) for name, facets in found.items()}
    dropped: list[str] = []
    for level, definition in _definitions(body, "nset"):
        labels = body.members(level, "nset", definition.name, definition.place)
        if definition.internal or not len(labels):
            continue
        facets = faces.over_nodes(solid.node_mask(labels))
        if not len(facets):
            dropped.append(definition.name)
        elif fold(definition.name) in surfaces:
            if surfaces[fold(definition.name)] != len(facets):
                notes.append(f"node set {definition.name!r} is not taken over, a surface has that name")
        else:
            _add(found, definition.name, facets, "node set", notes)
    if dropped:
        notes.append(f"node sets that hold no whole free face are not taken over: {listed([repr(n) for n in dropped])}")
    return found


def shell_sets(body: Body, solid: Solid, faces: Faces, notes: list[str]) -> list[tuple[str, FacetSet]]:
    """(name, facets) of the element sets that hold shells on the surface of the cells, and no cells."""
    shells = [
        (block.labels, block.shell, block.table.rows)
        for scope in body.own
        for block in scope.elements
        if block.shell is not None and block.table is not None
    ]
    found: list[tuple[str, FacetSet]] = []
    for level, definition in _definitions(body, "elset") if shells else []:
        members = body.members(level, "elset", definition.name, definition.place)
        if definition.internal or len(solid.cell_numbers(members)):
            continue
        on_body = 0  # shells all of whose corners are nodes of cells; others belong to parts that are left out
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


def _definitions(body: Body, family: str) -> list[tuple[str, SetDefinition]]:
    """All sets that reach the body, with their level; the first of a name in each level."""
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
    """The name of a set of the assembly where the part has another one of that name."""
    notes.append(f"the {what} {name!r} of the assembly is called {ASSEMBLY_PREFIX + name!r}, the part has another")
    return ASSEMBLY_PREFIX + name
