"""Nastran matrices in OUTPUT4 (.op4, text or binary) and OUTPUT2 (.op2) files, through pyYeti (extra `matrices`).

The g-set matrices KGG and MGG have six rows a grid point in ascending order of its number; rotations of solid elements
are empty rows. Files of Nastran do not say what the rows are; where the a-set lacks dofs give `dof_map`.
"""

from __future__ import annotations

from collections.abc import Mapping
from pathlib import Path
from typing import Any

from warpffrf.model.errors import InputError
from warpffrf.model.mesh.matrices.file_matrix import FileMatrix

# data blocks of the global, the analysis and the residual structure's set; DMIG-like short names last
USUAL_NAMES = {"stiffness": ("KGG", "KAA", "KXX", "KJJ", "K"), "mass": ("MGG", "MAA", "MXX", "MJJ", "M")}


def read_op4(file: Path, name: str | None, role: str) -> FileMatrix:
    """A matrix of an OUTPUT4 file. Raises `InputError` without pyYeti, for a garbled file, or for no such matrix."""
    op4 = _library("pyyeti.nastran.op4", file)
    try:
        matrices = op4.read(str(file), sparse=True)
    except Exception as error:  # the reader raises what it stumbles over: ValueError, IndexError, struct.error
        raise InputError(f"matrix file {file.name}: cannot be read as OUTPUT4 ({error}); export it again") from None
    return _chosen(matrices, file, name, role)


def read_op2(file: Path, name: str | None, role: str) -> FileMatrix:
    """A matrix of an OUTPUT2 file; raises as `read_op4` does."""
    op2 = _library("pyyeti.nastran.op2", file)
    try:
        matrices = op2.rdmats(str(file))
    except Exception as error:
        raise InputError(f"matrix file {file.name}: cannot be read as OUTPUT2 ({error}); export it again") from None
    return _chosen(matrices, file, name, role)


def _library(module: str, file: Path) -> Any:
    import importlib

    try:
        return importlib.import_module(module)
    except ImportError:
        raise InputError(
            f"matrix file {file.name}: reading it needs pyYeti; install the extra, pip install 'warpffrf[matrices]', "
            "or export Matrix Market"
        ) from None


def _chosen(matrices: Mapping[str, Any], file: Path, name: str | None, role: str) -> FileMatrix:
    import scipy.sparse as sp

    found = {key.strip().upper(): matrix for key, matrix in (matrices or {}).items()}
    wanted = (name.strip().upper(),) if name is not None else USUAL_NAMES[role]
    for key in wanted:
        if key in found:
            return FileMatrix(sp.csr_matrix(found[key]), None, f"{file.name} ({key})")
    if name is None and len(found) == 1:
        ((key, matrix),) = found.items()
        return FileMatrix(sp.csr_matrix(matrix), None, f"{file.name} ({key})")
    raise InputError(
        f"matrix file {file.name}: no {role} matrix among {', '.join(found) or 'nothing'}, looked for "
        f"{', '.join(wanted)}; name it: mesh.read_matrix(path, name)"
    )
