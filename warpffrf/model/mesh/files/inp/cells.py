"""Solid elements of Abaqus and CalculiX: which cell kind each becomes, and the numbering of their faces.

Node orders are those of our cells: Abaqus numbers the corners of the bottom and of the top, then the edges of the
bottom, of the top, and the vertical ones. (The first triangle of a wedge looks into the cell in both.)

A solid element's type is `C3D`, the number of nodes, and letters for its formulation: R reduced integration,
I incompatible modes (C3D10I: improved surface stress), H hybrid, M modified, S improved surface stress, T with
temperatures. Here all of them become the plain, fully integrated element of the same shape; `formulation` says what
was replaced. (Abaqus' own C3D8 averages the volumetric strain over the cell; ours does not.)

Faces S1, S2, ... are given by their corners as in Abaqus (Analysis User's Guide, "Three-dimensional solid element
library") and CalculiX (manual, *DLOAD), which agree.
"""

from __future__ import annotations

import re
from functools import cache

import numpy as np

from warpffrf.model.mesh.elements import cell_kind, facet_kind

KINDS = {4: "tet4", 6: "wedge6", 8: "hex8", 10: "tet10", 15: "wedge15", 20: "hex20"}  # by the number of nodes
_TYPE = re.compile(r"C3D(4|6|8|10|15|20)([RIHMST]*)")
_VOLUMES = re.compile(r"C3D|(SC|CSS|CCL|DC3D|DCC3D|AC3D|EC3D|FC3D|Q3D)\d")
# shells, membranes, plane elements and rigid faces in space, with their number of nodes (STRI65 has six)
_SHELL = re.compile(r"(?:DS|SFM3D|M3D|CPS|CPE|CPEG|R3D|STRI|S)([3468])[RITHMP0-9]*")
_SHELL_KINDS = {3: "tri3", 4: "quad4", 6: "tri6", 8: "quad8"}
_FORMULATIONS = {
    "R": "are integrated fully",
    "I": "have no incompatible modes here",
    "H": "are hybrid where the material asks for it",
    "M": "are not modified here",
    "S": "have the usual stress points here",
    "T": "have no temperatures here",
}
# corners of the faces S1, S2, ..., counted from 1 as the manuals do
_FACES = {
    "hex": ((1, 2, 3, 4), (5, 8, 7, 6), (1, 5, 6, 2), (2, 6, 7, 3), (3, 7, 8, 4), (4, 8, 5, 1)),
    "wedge": ((1, 2, 3), (4, 6, 5), (1, 4, 5, 2), (2, 5, 6, 3), (3, 6, 4, 1)),
    "tet": ((1, 2, 3), (1, 4, 2), (2, 4, 3), (3, 4, 1)),
}
FACE_COUNT = 6  # the largest number of faces of any kind


def kind_of(element_type: str) -> str | None:
    """The cell kind that an element type becomes, None where it is no solid element of ours."""
    match = _TYPE.fullmatch(element_type.upper())
    return KINDS[int(match[1])] if match else None


def shell_kind_of(element_type: str) -> str | None:
    """The facet kind of an element without volume that covers a face, None for any other."""
    match = _SHELL.fullmatch(element_type.upper())
    return _SHELL_KINDS[int(match[1])] if match else None


def is_volume(element_type: str) -> bool:
    """Whether an element type fills a volume, one of ours or not: it cannot be left out without changing the body."""
    return _VOLUMES.match(element_type.upper()) is not None


def formulation(element_type: str) -> str | None:
    """What is said about cells whose formulation is replaced, for example 'are integrated fully'; None for plain."""
    match = _TYPE.fullmatch(element_type.upper())
    letters = match[2] if match else ""
    return " and ".join(_FORMULATIONS[letter] for letter in letters) or None


@cache
def faces_of(kind: str) -> tuple[tuple[str, np.ndarray], ...]:
    """For S1, S2, ... of a cell kind: the facet kind and the local node numbers (kf,), counted from 0, outward."""
    cell = cell_kind(kind)
    by_corners = {
        frozenset(local[: facet_kind(facet).corner_count].tolist()): (facet, local)
        for facet, table in cell.faces.items()
        for local in table
    }
    return tuple(by_corners[frozenset(c - 1 for c in corners)] for corners in _FACES[cell.domain])
