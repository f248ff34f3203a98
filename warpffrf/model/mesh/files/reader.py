"""Meshes from files: Gmsh .msh, VTK .vtu and .vtk, Nastran bulk data, Abaqus and CalculiX .inp, Ansys .cdb,
universal files .unv, MED.

One module per format reads it (`gmsh`, `vtu`, `vtk`, `nastran`, `inp`, `cdb`, `unv`, `med`); `raw_mesh` converts one
part to a mesh. Named surfaces become facet sets, named groups of cells become cell sets. Contents (cells by kind,
pieces, entities, groups, arrays) that a mesh cannot represent are refused or listed in `Mesh.notes`.
"""

from __future__ import annotations

import logging
from pathlib import Path

from warpffrf.model.errors import InputError, unknown_name
from warpffrf.model.files.paths import exists
from warpffrf.model.mesh.data import Mesh
from warpffrf.model.mesh.files.cdb import read_cdb
from warpffrf.model.mesh.files.gmsh import read_gmsh
from warpffrf.model.mesh.files.med import read_med
from warpffrf.model.mesh.files.nastran import SUFFIXES as NASTRAN
from warpffrf.model.mesh.files.nastran import read_bulk
from warpffrf.model.mesh.files.raw_mesh import LENGTH_UNITS, built
from warpffrf.model.mesh.files.unv import read_unv
from warpffrf.model.mesh.files.vtk import read_vtk
from warpffrf.model.mesh.files.vtu import read_vtu
from warpffrf.model.messages.named_arguments import named_arguments

logger = logging.getLogger(__name__)

READERS = {".msh": read_gmsh, ".vtu": read_vtu, ".vtk": read_vtk, ".unv": read_unv, ".uff": read_unv, ".med": read_med}
IN_UNITS = {".cdb": read_cdb, **dict.fromkeys(NASTRAN, read_bulk)}  # whose materials have the units of the lengths
SUFFIXES = (*READERS, *IN_UNITS, ".inp")


@named_arguments
def read(path: str | Path, *, length_unit: str, part: int | str | None = None) -> Mesh:
    """Read a mesh of hexahedra, wedges and tetrahedra, linear or quadratic, with its sets, from the file `path`;
    lengths become metres. Of Nastran, Abaqus and CalculiX decks also shells, beams, masses, springs and rigid links.

    `length_unit` is the unit of the file's coordinates: one of m, cm, mm, um, in, ft. `part` picks one body of a file
    with several: the number of a connected part (0 is the one of the first cell) or the name of a volume group, in an
    .inp deck of an instance. Omissions and replacements are listed in `Mesh.notes`. Raises `InputError` when the
    file is missing or unreadable, has no (supported) volume cells, an inverted cell or more than one connected part.

    >>> plate = wf.mesh.read("plate.vtu", length_unit="mm")  # doctest: +ELLIPSIS
    Traceback (most recent call last):
    ...
    warpffrf.model.errors.InputError: mesh file 'plate.vtu' does not exist...
    """
    if not isinstance(path, str | Path):
        raise InputError(f"mesh.read: a path is needed, got {path!r}")
    path = Path(path)
    if not isinstance(length_unit, str) or length_unit not in LENGTH_UNITS:
        raise unknown_name("length unit", length_unit, LENGTH_UNITS)
    if part is not None and (isinstance(part, bool) or not isinstance(part, int | str)):
        raise InputError(f"part must be a name or the number of a connected part, got {part!r}")
    if not exists(path):
        raise InputError(f"mesh file {str(path)!r} does not exist; check the path")
    suffix = path.suffix.lower()
    if suffix not in SUFFIXES:
        raise InputError(f"mesh file {path.name}: unknown format {path.suffix!r}, known: {', '.join(SUFFIXES)}")
    if suffix == ".inp":
        from warpffrf.model.mesh.files.inp import read_inp

        mesh = read_inp(path, length_unit=length_unit, part=part)
    else:
        raw = READERS[suffix](path) if suffix in READERS else IN_UNITS[suffix](path, length_unit)
        mesh = built(raw, scale=LENGTH_UNITS[length_unit], part=part, name=path.stem, label=f"mesh file {path.name}")
    for warning in mesh.report().warnings:
        logger.warning("mesh file %s: %s", path.name, warning)
    return mesh
