"""Reference cells and facets: one file per cell kind, and the registries.

A new kind is one new file with a `CELL` and a line below. Node orders are those of VTK's file formats and of meshio,
with one exception: of a wedge the first triangle's normal points *into* the cell, as in meshio, Abaqus and Gmsh.
"""

from __future__ import annotations

from warpffrf.model.errors import unknown_name
from warpffrf.model.mesh.elements import hex8, hex20, hex27, tet4, tet10, wedge6, wedge15
from warpffrf.model.mesh.elements.facets import FACETS
from warpffrf.model.mesh.elements.kinds import CellKind, FacetKind, determinants

_CELLS: dict[str, CellKind] = {m.CELL.name: m.CELL for m in (hex8, hex20, hex27, wedge6, wedge15, tet4, tet10)}
CELL_KINDS = tuple(_CELLS)
FACET_KINDS = tuple(FACETS)

__all__ = ["CELL_KINDS", "FACET_KINDS", "CellKind", "FacetKind", "cell_kind", "determinants", "facet_kind"]


def cell_kind(name: str) -> CellKind:
    """The reference cell called `name`, one of `CELL_KINDS`; raises `InputError` for any other."""
    if name not in _CELLS:
        raise unknown_name("cell kind", name, CELL_KINDS)
    return _CELLS[name]


def facet_kind(name: str) -> FacetKind:
    """The reference facet called `name`, one of `FACET_KINDS`; raises `InputError` for any other."""
    if name not in FACETS:
        raise unknown_name("facet kind", name, FACET_KINDS)
    return FACETS[name]
