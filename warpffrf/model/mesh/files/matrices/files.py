"""Matrices in the files of FE programs: one reader per format, chosen by the name and the first line of the file.

| file | reader | dofs of its rows |
|---|---|---|
| `.mtx` beginning with `%%MatrixMarket` | `matrix_market` | not given |
| `.mtx` of Abaqus, `*MATRIX OUTPUT` | `abaqus` | node and dof in every line (MATRIX INPUT), or not given (COORDINATE) |
| `.sti`, `.mas` of CalculiX | `calculix` | in the `.dof` file next to them |
| `.op4`, `.op2` of Nastran | `nastran` | not given |
| `.full`, `.emat` of Ansys | `ansys` | node and dof |
| `.pch`, `.bdf`, `.nas`, `.dat`, `.fem` with DMIG cards of Nastran, OptiStruct | `dmig` | grid point and component |
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np

from warpffrf.model.errors import InputError
from warpffrf.model.files.paths import exists, read_named
from warpffrf.model.mesh.files.matrices import formats
from warpffrf.model.mesh.files.matrices.ansys import read_emat, read_full
from warpffrf.model.mesh.files.matrices.dmig import read_dmig
from warpffrf.model.mesh.files.matrices.formats import FileMatrix
from warpffrf.model.mesh.files.nastran import SUFFIXES as BULK
from warpffrf.model.messages.named_arguments import named_arguments

ROLES = ("stiffness", "mass")


@named_arguments
def read_matrix(path: str | Path, name: str | None = None, *, role: str = "stiffness") -> FileMatrix:
    """The matrix in the file `path`; see the module's table of formats.

    `name`: which matrix, for files of several (Nastran); without it the usual names of the `role`, "stiffness" or
    "mass", are searched. One triangle of a symmetric matrix is completed. Raises `InputError` for a file that is
    missing, garbled (with the number of the line), of an unknown format, or without such a matrix.
    """
    if role not in ROLES:
        raise InputError(f"read_matrix: role must be one of {', '.join(ROLES)}, got {role!r}")
    file = Path(path)
    if not exists(file):
        raise InputError(f"matrix file {str(path)!r} does not exist; check the path")
    suffix = file.suffix.lower()
    readers = _readers()
    if suffix not in readers:
        raise InputError(
            f"matrix file {file.name}: unknown format {suffix!r}; known: {', '.join(readers)}, or give a NumPy array "
            "or SciPy sparse matrix"
        )
    found = readers[suffix](file, name, role)
    if not np.isfinite(found.matrix.data).all():
        raise InputError(f"matrix file {found.source}: the matrix holds NaN or infinite numbers; export it again")
    if found.matrix.shape[0] != found.matrix.shape[1]:
        raise InputError(
            f"matrix file {found.source}: the matrix is {found.matrix.shape}, not square; name another one"
        )
    return replace(found, matrix=completed(found.matrix))


def _readers() -> dict[str, Callable[[Path, str | None, str], FileMatrix]]:
    return {
        ".mtx": _mtx,
        ".mm": _mtx,
        ".sti": formats.read_calculix,
        ".mas": formats.read_calculix,
        ".op4": formats.read_op4,
        ".op2": formats.read_op2,
        ".full": read_full,
        ".emat": read_emat,
        **dict.fromkeys((".pch", *BULK), read_dmig),
    }


def _mtx(file: Path, name: str | None, role: str) -> FileMatrix:
    """Matrix Market and Abaqus share a suffix; the banner distinguishes them."""
    banner = read_named(file, "matrix file")[: len(formats.BANNER)]
    read = formats.read if banner.lower() == formats.BANNER else formats.read_abaqus
    return read(file, name, role)


def completed(matrix: Any) -> Any:
    """A csr matrix with both triangles: where no entry off the diagonal has a partner, each gets one.

    FE programs write one triangle of a symmetric matrix, upper or lower in *their* order of rows, which in the order
    of node numbers is a mixture. A matrix some of whose entries have partners is left unchanged.
    """
    import scipy.sparse as sp

    A = sp.csr_matrix(matrix)
    A.sum_duplicates()
    A.eliminate_zeros()
    diagonal = sp.diags_array(A.diagonal(), format="csr")
    beside = A - diagonal
    beside.eliminate_zeros()
    pattern = beside.copy()
    pattern.data = np.ones_like(pattern.data)
    if pattern.multiply(pattern.T).nnz:
        return A
    return sp.csr_matrix(beside + beside.T + diagonal)
