"""Which material each cell of a mesh is made of."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np

from warpffrf.model.errors import InputError, unknown_name
from warpffrf.model.material import Material
from warpffrf.model.mesh import FacetSet, Mesh
from warpffrf.model.mesh.elements import cell_kind


@dataclass(frozen=True)
class Assignment:
    """`materials`, and for each block of cells the number of its cells' material (m,)."""

    materials: tuple[Material, ...]
    of_cell: dict[str, np.ndarray]


def assign(mesh: Mesh, material: Material | Mapping[str, Material] | None) -> Assignment:
    """Spread one material, or {cell set: material}, over the cells of `mesh`.

    Raises `InputError` for an unknown cell set, a cell without material or with two, and where a mesh of cells gets
    none. A mesh that carries its own matrices needs no material; one that is given serves results only.
    """
    if material is None:
        if mesh.matrices is None:
            raise InputError("reduce: a material is needed, made by Material, or {cell set: Material}")
        return Assignment((), {})
    if isinstance(material, Material):
        return Assignment((material,), {kind: np.zeros(len(c), dtype=np.int64) for kind, c in mesh.cells.items()})
    if not isinstance(material, Mapping) or not material:
        raise InputError(f"reduce: a material is needed, made by Material, or {{cell set: Material}}, got {material!r}")
    number = np.full(mesh.cell_count, -1, dtype=np.int64)
    for i, (name, one) in enumerate(material.items()):
        if not isinstance(one, Material):
            raise InputError(f"material of cell set {name!r}: a Material is needed, got {one!r}")
        if name not in mesh.cell_sets:
            raise unknown_name(f"mesh {mesh.name or '(unnamed)'}: cell set", name, mesh.cell_sets)
        cells = mesh.cell_sets[name]
        taken = cells[number[cells] >= 0]
        if len(taken):
            other = list(material)[int(number[taken[0]])]
            raise InputError(
                f"materials of cell sets {other!r} and {name!r}: {len(taken)} cells are in both, the first is number "
                f"{taken[0]}; give each cell one material"
            )
        number[cells] = i
    bare = np.flatnonzero(number < 0)
    if len(bare):
        raise InputError(
            f"material: {len(bare)} of {mesh.cell_count} cells are in none of the sets {', '.join(material)}, the "
            f"first is number {bare[0]}; give every cell a material"
        )
    return Assignment(tuple(material.values()), dict(mesh.by_block(number)))


def facet_material(mesh: Mesh, facets: FacetSet, assignment: Assignment) -> Material | None:
    """The material under most of the facets; None for a mesh without materials."""
    if len(assignment.materials) < 2:
        return assignment.materials[0] if assignment.materials else None
    return assignment.materials[int(np.argmax(_cells_behind(mesh, facets, assignment)))]


def other_material(mesh: Mesh, facets: FacetSet, assignment: Assignment) -> float:
    """Share (0 to 1) of the cells behind the facets that are not of `facet_material`."""
    if len(assignment.materials) < 2:
        return 0.0
    behind = _cells_behind(mesh, facets, assignment)
    return float(1.0 - behind.max() / max(behind.sum(), 1.0))


def _cells_behind(mesh: Mesh, facets: FacetSet, assignment: Assignment) -> np.ndarray:
    """Number of cells with a face on the facets, by material: a face has three corners or more, an edge two."""
    on_set = np.zeros(len(mesh.points), dtype=bool)
    on_set[facets.node_set] = True
    found = np.zeros(len(assignment.materials))
    for kind, cells in mesh.cells.items():
        behind = on_set[cells[:, : cell_kind(kind).corner_count]].sum(axis=1) >= 3
        found += np.bincount(assignment.of_cell[kind][behind], minlength=len(found))
    return found
