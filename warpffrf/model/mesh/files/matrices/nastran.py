"""Nastran matrices in OUTPUT4 (.op4, text or binary) and OUTPUT2 (.op2) files, through pyYeti (extra `matrices`).

The g-set matrices KGG and MGG have six rows a grid point in ascending order of its number; rotations of solid elements
are empty rows. Files of Nastran do not say what the rows are; where the a-set lacks dofs give `dof_map`.

pyYeti reads what it finds, so the form of a file is looked at before: a text has lines of whole numbers, of numbers of
one width, and heads; a binary file is a chain of Fortran's records, each with its length before and behind it.
"""

from __future__ import annotations

import re
from collections.abc import Mapping
from pathlib import Path
from typing import Any

from warpffrf.model.errors import InputError
from warpffrf.model.files.regular_file import read_named
from warpffrf.model.mesh.files.matrices.file_matrix import FileMatrix

# data blocks of the global, the analysis and the residual structure's set; DMIG-like short names last
USUAL_NAMES = {"stiffness": ("KGG", "KAA", "KXX", "KJJ", "K"), "mass": ("MGG", "MAA", "MXX", "MJJ", "M")}
_WHOLE = re.compile(rb"(?> *+-?+[0-9]++)++ *+")
_REALS = re.compile(rb"(?> *+[+-]?+[0-9]*+\.[0-9]++(?>[ED][+-]?+[0-9]++|[+-][0-9]++)?+)++ *+")
_HEAD = re.compile(
    rb"[ 0-9-]{32,64}+[A-Za-z][A-Za-z0-9_ ]{7}(?:\s*+(?:1P,)?([0-9]{1,2})[EeDd]([0-9]{1,2})\.[0-9]{1,2})?\s*+"
)
_WIDTH = 16  # characters of a number where a head says none


def read_op4(file: Path, name: str | None, role: str) -> FileMatrix:
    """A matrix of an OUTPUT4 file. Raises `InputError` without pyYeti, for a garbled file, or for no such matrix."""
    op4 = _library("pyyeti.nastran.op4", file)
    content = read_named(file, "matrix file")
    text = content[:1].isspace() or content[:1].isdigit() or content[:1] == b"-"
    fault = _text_fault(content) if text and 0 not in content[:4] else _record_fault(content)
    if fault:
        raise InputError(f"matrix file {file.name}: cannot be read as OUTPUT4 ({fault}); export it again")
    try:
        matrices = op4.read(str(file), sparse=True)
    except Exception as error:  # the reader raises what it stumbles over: ValueError, IndexError, struct.error
        raise InputError(f"matrix file {file.name}: cannot be read as OUTPUT4 ({error}); export it again") from None
    return _chosen(matrices, file, name, role)


def read_op2(file: Path, name: str | None, role: str) -> FileMatrix:
    """A matrix of an OUTPUT2 file; raises as `read_op4` does."""
    op2 = _library("pyyeti.nastran.op2", file)
    fault = _record_fault(read_named(file, "matrix file"))
    if fault:
        raise InputError(f"matrix file {file.name}: cannot be read as OUTPUT2 ({fault}); export it again")
    try:
        matrices = op2.rdmats(str(file))
    except Exception as error:
        raise InputError(f"matrix file {file.name}: cannot be read as OUTPUT2 ({error}); export it again") from None
    return _chosen(matrices, file, name, role)


def _text_fault(content: bytes) -> str:
    """What is wrong with the form of a text; "" for nothing."""
    width = _WIDTH
    for number, line in enumerate(content.split(b"\n"), start=1):
        line = line.rstrip(b"\r")
        head = _HEAD.fullmatch(line)
        if head:
            width = int(head[2]) if head[2] else _WIDTH
            sizes = [abs(int(w)) for w in line[:16].split()]
            if max(sizes, default=0) > len(content):
                return f"line {number} says a matrix of {' by '.join(map(str, sizes))}, more than fits into the file"
        elif not line.strip() or _WHOLE.fullmatch(line):
            continue
        elif not _REALS.fullmatch(line) or len(line.rstrip()) % width:
            return f"line {number} is neither a head nor numbers"
    return ""


def _record_fault(content: bytes) -> str:
    """What is wrong with the chain of records of a binary file; "" for nothing."""
    orders = [o for o in ("little", "big") if 0 < int.from_bytes(content[:4], o) <= len(content) - 8]  # type: ignore
    for order in orders:
        at = 0
        while at + 8 <= len(content):
            size = int.from_bytes(content[at : at + 4], order)  # type: ignore[arg-type]
            if content[at : at + 4] != content[at + 4 + size : at + 8 + size]:
                break
            at += size + 8
        if at == len(content):
            return ""
    return "its records are damaged"


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
