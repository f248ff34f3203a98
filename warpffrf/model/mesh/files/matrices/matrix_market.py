"""Matrix Market files, coordinate or array (Boisvert, Pozo, Remington 1996, NISTIR 5935), read here and strictly.

SciPy's reader ends a number at the first character that it does not know, so that 1.5D6 is 1.5 to it, and a file that
is cut off can crash the interpreter. Here every line has to be one of the format, in full: real, integer or pattern;
general, symmetric or skew-symmetric; one entry a line, none twice. Exponents may be Fortran's: 1.5D6, and 1.5+106 for
1.5e106. What a file declares is held against its own size before memory is taken for it.
"""

from __future__ import annotations

import re
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np

from warpffrf.model.errors import InputError
from warpffrf.model.files.regular_file import read_named
from warpffrf.model.mesh.files.matrices.file_matrix import FileMatrix

BANNER = b"%%matrixmarket"  # in small letters, as it is compared
LAYOUTS = ("coordinate", "array")
FIELDS = ("real", "integer", "pattern")
SYMMETRIES = ("general", "symmetric", "skew-symmetric")
SHOWN = 60  # characters of a bad line in a message
_INTEGER = rb"[+-]?+[0-9]++"
_EXPONENT = rb"[eEdD][+-]?+[0-9]++"
_WIDE_EXPONENT = rb"[+-][0-9]{3}(?![0-9])"  # of three digits Fortran leaves out the letter
_POINT = rb"(?>[0-9]++\.[0-9]*+|\.[0-9]++)(?>" + _EXPONENT + rb"|" + _WIDE_EXPONENT + rb")?+"
_REAL = rb"[+-]?+(?>" + _POINT + rb"|[0-9]++(?>" + _EXPONENT + rb")?+)"
_WIDE = re.compile(rb"(\.[0-9]*)([+-][0-9]{3})(?=\s)")
_TO_PLAIN = bytes.maketrans(b"dD", b"ee")
_COMMENTS = re.compile(rb"(?>[ \t]*+%[^\n]*+\n|[ \t\r]*+\n)*+")
_SIZES = re.compile(rb"[ \t]*+([0-9]++(?:[ \t]++[0-9]++)*+)[ \t\r]*+(?:\n|\Z)")


@dataclass(frozen=True)
class _Head:
    """What the first lines say, and where the entries begin: the byte and the line."""

    layout: str
    field: str
    symmetry: str
    rows: int
    columns: int
    entries: int
    start: int
    line: int


def read(file: Path, name: str | None, role: str) -> FileMatrix:
    """The matrix of a Matrix Market file; it does not say what its rows are. Raises `InputError` for anything that is
    not of the format, with the number of the line."""
    text = read_named(file, "matrix file")
    head = _head(file, text)
    numbers = _numbers(file, text, head)
    rows, columns, values = (_coordinates if head.layout == "coordinate" else _array)(file, text, head, numbers)
    if not np.all(np.isfinite(values)):
        bad = int(np.argmin(np.isfinite(values)))
        raise _fault(file, _line_of(text, head, bad), "holds a number that is too large")
    return FileMatrix(_matrix(head, rows, columns, values), None, file.name)


def _fault(file: Path, line: int, what: str) -> InputError:
    return InputError(f"matrix file {file.name}, line {line}: {what}; export it again")


def _head(file: Path, text: bytes) -> _Head:
    """The banner and the sizes, held against the size of the file."""
    banner, _, _ = text.partition(b"\n")
    words = banner[:200].decode("ascii", errors="replace").lower().split()
    if len(words) != 5 or words[1] != "matrix":
        raise _fault(file, 1, "is not '%%MatrixMarket matrix LAYOUT FIELD SYMMETRY'")
    for word, known in zip(words[2:], (LAYOUTS, FIELDS, SYMMETRIES), strict=True):
        if word not in known:
            raise _fault(file, 1, f"{word!r} is not read here, one of {', '.join(known)} is")
    layout, field, symmetry = words[2:]
    if layout == "array" and field == "pattern":
        raise _fault(file, 1, "an array of a pattern holds nothing")
    at = len(banner) + 1
    comments = _COMMENTS.match(text, at)
    at = comments.end() if comments else at
    line = text.count(b"\n", 0, at) + 1
    found = _SIZES.match(text, at)
    sizes = [int(word) for word in found[1].split()] if found and len(found[1]) <= SHOWN else []
    if found is None or len(sizes) != (3 if layout == "coordinate" else 2):
        wanted = "rows, columns and entries" if layout == "coordinate" else "rows and columns"
        raise _fault(file, line, f"{_shown(text, at)} are not the numbers of {wanted}")
    rows, columns = sizes[:2]
    if symmetry != "general" and rows != columns:
        raise _fault(file, line, f"a {symmetry} matrix cannot have {rows} rows and {columns} columns")
    entries = sizes[2] if layout == "coordinate" else _array_entries(symmetry, rows, columns)
    if max(rows, columns, entries) > len(text):  # an entry takes two bytes or more, a row that matters an entry
        raise _fault(file, line, f"declares {rows} rows, {columns} columns and {entries} entries in {len(text)} bytes")
    return _Head(layout, field, symmetry, rows, columns, entries, found.end(), line + 1)


def _array_entries(symmetry: str, rows: int, columns: int) -> int:
    return {
        "general": rows * columns,
        "symmetric": rows * (rows + 1) // 2,
        "skew-symmetric": rows * (rows - 1) // 2,
    }[symmetry]


def _numbers(file: Path, text: bytes, head: _Head) -> np.ndarray:
    """The numbers of the lines (entries, numbers a line), all of them read as they are written."""
    index, value = rb"[0-9]++", {"real": _REAL, "integer": _INTEGER, "pattern": b""}[head.field]
    words = [index, index] if head.layout == "coordinate" else []
    words += [value] if value else []
    entry = rb"(?>[ \t]*+" + rb"[ \t]++".join(words) + rb")?+[ \t\r]*+\n"
    body = text[head.start :]
    body += b"" if body.endswith(b"\n") else b"\n"
    read = re.compile(rb"(?>" + entry + rb")*+").match(body)
    end = read.end() if read else 0
    if end < len(body):
        line = head.line + body.count(b"\n", 0, end)
        what = {3: "row, column and value", 2: "row and column", 1: "a value"}[len(words)]
        raise _fault(file, line, f"{_shown(body, end)} is not {what}")
    if head.field == "real":
        body = _WIDE.sub(rb"\1e\2", body.translate(_TO_PLAIN))
    # of nothing NumPy makes one number
    numbers = np.fromstring(body.decode("ascii"), sep=" ") if body.strip() else np.zeros(0)
    numbers = numbers.reshape(-1, len(words))
    if len(numbers) != head.entries:
        raise InputError(
            f"matrix file {file.name}: has {len(numbers)} entries, line {head.line - 1} says {head.entries}; "
            "export it again"
        )
    return numbers


def _coordinates(file: Path, text: bytes, head: _Head, numbers: np.ndarray) -> tuple[np.ndarray, ...]:
    """0-based rows and columns, and the values, of the lines of a coordinate file."""
    inside = (numbers[:, :2] >= 1) & (numbers[:, :2] <= (head.rows, head.columns))
    if not inside.all():
        bad = int(np.argmin(inside.all(axis=1)))
        i, j = numbers[bad, :2]
        where = f"row {i:.0f}, column {j:.0f} is outside {head.rows} by {head.columns}"
        raise _fault(file, _line_of(text, head, bad), where)
    i, j = numbers[:, :2].astype(np.int64).T - 1
    if head.symmetry == "skew-symmetric" and np.any(i == j):
        bad = int(np.argmax(i == j))
        raise _fault(file, _line_of(text, head, bad), "a skew-symmetric matrix has no entry on its diagonal")
    _refuse_twice(file, text, head, i, j)
    return i, j, np.ones(len(i)) if head.field == "pattern" else numbers[:, 2].copy()


def _refuse_twice(file: Path, text: bytes, head: _Head, i: np.ndarray, j: np.ndarray) -> None:
    """Raise where two lines are of one entry, or, where one triangle says all, of an entry and its partner."""
    a, b = (i, j) if head.symmetry == "general" else (np.maximum(i, j), np.minimum(i, j))
    place = a * head.columns + b
    order = np.argsort(place, kind="stable")
    again = np.flatnonzero(np.diff(place[order]) == 0)
    if len(again):
        first, second = order[again[0]], order[again[0] + 1]
        lines = _line_of(text, head, int(first)), _line_of(text, head, int(second))
        raise _fault(file, lines[1], f"row {i[second] + 1}, column {j[second] + 1} is that of line {lines[0]} again")


def _array(file: Path, text: bytes, head: _Head, numbers: np.ndarray) -> tuple[np.ndarray, ...]:
    """0-based rows and columns, and the values, of an array file: column by column, of one triangle the lower."""
    if head.symmetry == "general":
        j, i = np.divmod(np.arange(head.entries), max(head.rows, 1))
    else:
        j, i = np.triu_indices(head.rows, 1 if head.symmetry == "skew-symmetric" else 0)
    return i, j, numbers[:, 0].copy()


def _matrix(head: _Head, i: np.ndarray, j: np.ndarray, values: np.ndarray) -> Any:
    import scipy.sparse as sp

    if head.symmetry != "general":
        beside = i != j
        sign = -1.0 if head.symmetry == "skew-symmetric" else 1.0
        i, j = np.concatenate([i, j[beside]]), np.concatenate([j, i[beside]])
        values = np.concatenate([values, sign * values[beside]])
    return sp.coo_matrix((values, (i, j)), shape=(head.rows, head.columns)).tocsr()


def _shown(text: bytes, at: int) -> str:
    return repr(text[at : at + SHOWN].split(b"\n")[0].decode("ascii", errors="replace").strip())


def _line_of(text: bytes, head: _Head, entry: int) -> int:
    """The number of the line of an entry; empty lines do not count as entries."""
    found = -1
    for number, line in enumerate(text[head.start :].split(b"\n"), start=head.line):
        found += bool(line.strip())
        if found == entry:
            return number
    return head.line
