"""Result of the readers: the matrix of a file, and the dofs of its rows.

Text table. Tables of numbers in text files, with the number of the line that cannot be read.

Strict reader of Matrix Market files, coordinate or array (Boisvert, Pozo, Remington 1996, NISTIR 5935).

SciPy's reader ends a number at the first unknown character, so that it reads 1.5D6 as 1.5, and a truncated file can
crash the interpreter. Here every line must conform to the format completely: real, integer or pattern;
general, symmetric or skew-symmetric; one entry per line, none twice. Exponents may be Fortran's: 1.5D6, and 1.5+106 for
1.5e106. Declared sizes are compared with the size of the file before memory is allocated.

Abaqus text matrices, written by `*MATRIX GENERATE, STIFFNESS, MASS` and `*MATRIX OUTPUT, STIFFNESS, MASS`.

- FORMAT=MATRIX INPUT, the default: `row node, dof, column node, dof, value`; a symmetric matrix as one triangle
  (Abaqus Keywords Guide, *MATRIX INPUT). Nodes and rows are matched by number, so the order of lines does not matter.
- FORMAT=COORDINATE: `row column value`, counted from 1; the dofs of the rows are not given: nodes in ascending order of
  their numbers, three rows each, for a model of solid elements without constraints.

The files are `<job>_STIF<step>.mtx` and `<job>_MASS<step>.mtx`. Abaqus marks a supported dof by 1e36 on the diagonal,
and gives internal nodes negative numbers.

CalculiX matrices: `<job>.sti`, `<job>.mas` and `<job>.dof` of a `*FREQUENCY, SOLVER=MATRIXSTORAGE` step.

A line of .sti (stiffness) and .mas (mass) is `row column value`, counted from 1, one triangle, 14 digits; line i of
.dof is `node.direction` of row i, directions from 1 (written by `matrixstorage.c` of CalculiX 2.20; files of that
version are among the tests). Dofs eliminated by a boundary condition or an equation have no row.

Nastran matrices in OUTPUT4 (.op4, text or binary) and OUTPUT2 (.op2) files, through pyYeti (extra `matrices`).

The g-set matrices KGG and MGG have six rows per grid point in ascending order of its number; rotations of solid
elements are empty rows. Files of Nastran do not give the dofs of the rows; where the a-set lacks dofs, give `dof_map`.

pyYeti does not validate, so the form of a file is checked before: a text has lines of whole numbers, of numbers of
one width, and heads; a binary file is a chain of Fortran's records, each with its length before and after it.
"""

from __future__ import annotations

import io
import re
import warnings
from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np

from warpffrf.model.errors import InputError
from warpffrf.model.files.paths import MOST_DIGITS, exists, read_named


@dataclass(frozen=True, eq=False)
class FileMatrix:
    """A matrix of a file in the file's own units and order.

    `matrix`: scipy.sparse csr (d, d). `dofs` (d, 2) int64: of each row the node's number *in the FE program* and the
    component (0 to 2 displacements, 3 to 5 rotations); None where the file does not give them. `source`: for messages.
    `notes`: what of the file is not used.
    """

    matrix: Any
    dofs: np.ndarray | None
    source: str
    notes: tuple[str, ...] = ()


def from_triplets(rows: np.ndarray, columns: np.ndarray, values: np.ndarray, size: int) -> Any:
    """csr (size, size) of entries at 0-based `rows` and `columns`."""
    import scipy.sparse as sp

    return sp.coo_matrix((values, (rows, columns)), shape=(size, size)).tocsr()


COMMENT = "*"  # Abaqus: a keyword or, doubled, a comment
_TO_PLAIN = str.maketrans({",": " ", "D": "E", "d": "e"})
SHOWN = 60  # characters of a bad line in a message


def read_table(file: Path, columns: tuple[int, ...], meaning: str) -> np.ndarray:
    """Numbers (m, c) of the lines of `file`, with c the first of `columns` that the first line has.

    Numbers are separated by blanks or commas; lines that begin with `*` and empty lines are skipped; Fortran's D
    exponents are supported. Raises `InputError` naming the first line that has another number of columns, a word, or
    a value that is not finite, and `meaning`, what a line should hold.
    """
    text = read_named(file, "matrix file").decode("latin-1")  # any byte is a character: comments may contain any
    plain = text.translate(_TO_PLAIN)
    try:
        with warnings.catch_warnings():
            warnings.simplefilter("ignore")  # of an empty file, which is refused below
            table = np.loadtxt(io.StringIO(plain), comments=COMMENT, ndmin=2)
    except ValueError:
        table = None
    if table is None or table.shape[1] not in columns or not len(table) or not np.all(np.isfinite(table)):
        raise _fault(file, text, columns, meaning)
    return table


def _fault(file: Path, text: str, columns: tuple[int, ...], meaning: str) -> InputError:
    width = None
    for number, line in enumerate(text.splitlines(), start=1):
        words = line.translate(_TO_PLAIN).split(COMMENT)[0].split()
        if not words:
            continue
        width = len(words) if width is None and len(words) in columns else width
        if len(words) != width or not all(_is_number(word) for word in words):
            return InputError(
                f"matrix file {file.name}, line {number}: {line.strip()[:SHOWN]!r} is not {meaning}; export it again"
            )
    return InputError(f"matrix file {file.name}: holds no entries; a line is {meaning}; export it again")


def _is_number(word: str) -> bool:
    try:
        return bool(np.isfinite(float(word)))
    except ValueError:
        return False


def whole_numbers(values: np.ndarray, file: Path, what: str) -> np.ndarray:
    """`values` as int64; raises `InputError` where they are not whole."""
    with np.errstate(invalid="ignore"):  # of numbers beyond 63 bits, which are refused
        numbers = values.astype(np.int64)
    if np.any(numbers != values):
        bad = values[numbers != values][0]
        raise InputError(f"matrix file {file.name}: {what} must be whole numbers, got {bad:g}; export it again")
    return numbers


BANNER = b"%%matrixmarket"  # in small letters, as it is compared
LAYOUTS = ("coordinate", "array")
FIELDS = ("real", "integer", "pattern")
SYMMETRIES = ("general", "symmetric", "skew-symmetric")
_INTEGER = rb"[+-]?+[0-9]++"
_EXPONENT = rb"[eEdD][+-]?+[0-9]++"
_WIDE_EXPONENT = rb"[+-][0-9]{3}(?![0-9])"  # of three digits Fortran omits the letter
_POINT = rb"(?>[0-9]++\.[0-9]*+|\.[0-9]++)(?>" + _EXPONENT + rb"|" + _WIDE_EXPONENT + rb")?+"
_REAL = rb"[+-]?+(?>" + _POINT + rb"|[0-9]++(?>" + _EXPONENT + rb")?+)"
_WIDE = re.compile(rb"(\.[0-9]*)([+-][0-9]{3})(?=\s)")
_PLAIN_MARKET = bytes.maketrans(b"dD", b"ee")
_COMMENTS = re.compile(rb"(?>[ \t]*+%[^\n]*+\n|[ \t\r]*+\n)*+")
_SIZES = re.compile(rb"[ \t]*+([0-9]++(?:[ \t]++[0-9]++)*+)[ \t\r]*+(?:\n|\Z)")


@dataclass(frozen=True)
class _Head:
    """Contents of the first lines, and the byte and the line where the entries begin."""

    layout: str
    field: str
    symmetry: str
    rows: int
    columns: int
    entries: int
    start: int
    line: int


def read(file: Path, name: str | None, role: str) -> FileMatrix:
    """The matrix of a Matrix Market file; the dofs of its rows are not given. Raises `InputError` with the number of
    the line for anything that is not of the format."""
    text = read_named(file, "matrix file")
    head = _head(file, text)
    numbers = _numbers(file, text, head)
    rows, columns, values = (_coordinates if head.layout == "coordinate" else _array)(file, text, head, numbers)
    if not np.all(np.isfinite(values)):
        bad = int(np.argmin(np.isfinite(values)))
        raise _market_fault(file, _line_of(text, head, bad), "holds a number that is too large")
    return FileMatrix(_matrix(head, rows, columns, values), None, file.name)


def _market_fault(file: Path, line: int, what: str) -> InputError:
    return InputError(f"matrix file {file.name}, line {line}: {what}; export it again")


def _head(file: Path, text: bytes) -> _Head:
    """The banner and the sizes, checked against the size of the file."""
    banner, _, _ = text.partition(b"\n")
    words = banner[:200].decode("ascii", errors="replace").lower().split()
    if len(words) != 5 or words[1] != "matrix":
        raise _market_fault(file, 1, "is not '%%MatrixMarket matrix LAYOUT FIELD SYMMETRY'")
    for word, known in zip(words[2:], (LAYOUTS, FIELDS, SYMMETRIES), strict=True):
        if word not in known:
            raise _market_fault(file, 1, f"{word!r} is not supported; known: {', '.join(known)}")
    layout, field, symmetry = words[2:]
    if layout == "array" and field == "pattern":
        raise _market_fault(file, 1, "an array of a pattern has no entries")
    at = len(banner) + 1
    comments = _COMMENTS.match(text, at)
    at = comments.end() if comments else at
    line = text.count(b"\n", 0, at) + 1
    found = _SIZES.match(text, at)
    sizes = [int(word) for word in found[1].split()] if found and len(found[1]) <= SHOWN else []
    if found is None or len(sizes) != (3 if layout == "coordinate" else 2):
        wanted = "rows, columns and entries" if layout == "coordinate" else "rows and columns"
        raise _market_fault(file, line, f"{_shown(text, at)} are not the numbers of {wanted}")
    rows, columns = sizes[:2]
    if symmetry != "general" and rows != columns:
        raise _market_fault(file, line, f"a {symmetry} matrix cannot have {rows} rows and {columns} columns")
    entries = sizes[2] if layout == "coordinate" else _array_entries(symmetry, rows, columns)
    if max(rows, columns, entries) > len(text):  # an entry takes two bytes or more, a row that matters an entry
        raise _market_fault(
            file, line, f"declares {rows} rows, {columns} columns and {entries} entries in {len(text)} bytes"
        )
    return _Head(layout, field, symmetry, rows, columns, entries, found.end(), line + 1)


def _array_entries(symmetry: str, rows: int, columns: int) -> int:
    return {"general": rows * columns, "symmetric": rows * (rows + 1) // 2, "skew-symmetric": rows * (rows - 1) // 2}[
        symmetry
    ]


def _numbers(file: Path, text: bytes, head: _Head) -> np.ndarray:
    """The numbers of the lines (entries, numbers per line), all of them read exactly."""
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
        raise _market_fault(file, line, f"{_shown(body, end)} is not {what}")
    if head.field == "real":
        body = _WIDE.sub(rb"\1e\2", body.translate(_PLAIN_MARKET))
    # NumPy returns one number for an empty text
    numbers = np.fromstring(body.decode("ascii"), sep=" ") if body.strip() else np.zeros(0)
    numbers = numbers.reshape(-1, len(words))
    if len(numbers) != head.entries:
        raise InputError(
            f"matrix file {file.name}: has {len(numbers)} entries, line {head.line - 1} declares {head.entries}; "
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
        raise _market_fault(file, _line_of(text, head, bad), where)
    i, j = numbers[:, :2].astype(np.int64).T - 1
    if head.symmetry == "skew-symmetric" and np.any(i == j):
        bad = int(np.argmax(i == j))
        raise _market_fault(file, _line_of(text, head, bad), "a skew-symmetric matrix has no entry on its diagonal")
    _refuse_twice(file, text, head, i, j)
    return i, j, np.ones(len(i)) if head.field == "pattern" else numbers[:, 2].copy()


def _refuse_twice(file: Path, text: bytes, head: _Head, i: np.ndarray, j: np.ndarray) -> None:
    """Raise where two lines have the same entry, or, if one triangle is complete, an entry and its partner."""
    a, b = (i, j) if head.symmetry == "general" else (np.maximum(i, j), np.minimum(i, j))
    place = a * head.columns + b
    order = np.argsort(place, kind="stable")
    again = np.flatnonzero(np.diff(place[order]) == 0)
    if len(again):
        first, second = order[again[0]], order[again[0] + 1]
        lines = _line_of(text, head, int(first)), _line_of(text, head, int(second))
        raise _market_fault(file, lines[1], f"row {i[second] + 1}, column {j[second] + 1} repeats line {lines[0]}")


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


COMPONENTS = 6  # dofs 1 to 6 are displacements and rotations


def read_abaqus(file: Path, name: str | None, role: str) -> FileMatrix:
    """The matrix of an Abaqus .mtx file. Raises `InputError` for a garbled file, internal nodes, and dofs above 6."""
    table = read_table(file, (5, 3), "'node, dof, node, dof, value' or 'row column value'")
    numbers = whole_numbers(table[:, :-1], file, "node, dof, row and column")
    values = table[:, -1]
    if numbers.shape[1] == 2:
        if numbers.min() < 1:
            raise InputError(f"matrix file {file.name}: rows and columns count from 1, got {numbers.min()}")
        size = int(numbers.max())
        if size > len(table):  # each row has an entry on the diagonal at least
            raise InputError(f"matrix file {file.name}: {len(table)} entries cannot fill {size} rows; export it again")
        return FileMatrix(from_triplets(numbers[:, 0] - 1, numbers[:, 1] - 1, values, size), None, file.name)
    places = numbers.reshape(-1, 2)
    if places[:, 0].min() < 1:
        raise InputError(
            f"matrix file {file.name}: node {places[:, 0].min()} is an internal node of Abaqus; export a model of "
            "plain solid elements, without hybrid elements, shells or connectors"
        )
    odd = places[(places[:, 1] < 1) | (places[:, 1] > COMPONENTS)]
    if len(odd):
        raise InputError(
            f"matrix file {file.name}: dof {odd[0, 1]} of node {odd[0, 0]} is no displacement or rotation; export a "
            "structural model"
        )
    dofs, place = np.unique(places, axis=0, return_inverse=True)
    row, column = place.reshape(-1, 2).T
    return FileMatrix(from_triplets(row, column, values, len(dofs)), dofs - [0, 1], file.name)


def read_calculix(file: Path, name: str | None, role: str) -> FileMatrix:
    """The matrix of a .sti or .mas file, with the dofs of the .dof file next to it. Raises `InputError` for a garbled
    or missing one, and for rows that the .dof file does not list."""
    table = read_table(file, (3,), "'row column value'")
    numbers = whole_numbers(table[:, :2], file, "row and column")
    dofs = _dofs(file.with_suffix(".dof"))
    if numbers.min() < 1 or numbers.max() > len(dofs):
        raise InputError(
            f"matrix file {file.name}: rows {numbers.min()} to {numbers.max()} do not fit the {len(dofs)} lines of "
            f"{file.stem}.dof; keep the files of one run together (cyclic symmetry doubles the rows: export the whole)"
        )
    return FileMatrix(from_triplets(numbers[:, 0] - 1, numbers[:, 1] - 1, table[:, 2], len(dofs)), dofs, file.name)


def _dofs(file: Path) -> np.ndarray:
    if not exists(file):
        raise InputError(f"matrix file {file.name} does not exist; keep .sti, .mas and .dof of a CalculiX run together")
    dofs = []
    # as text: read as numbers, directions 1 and 10 of a node would be one
    text = read_named(file, "matrix file").decode("ascii", errors="replace")
    for number, line in enumerate(text.splitlines(), start=1):
        node, dot, direction = line.strip().partition(".")
        known = all(word.isdigit() and len(word) <= MOST_DIGITS for word in (node, direction))
        if not (dot and known and int(direction) >= 1):
            raise InputError(
                f"matrix file {file.name}, line {number}: {line.strip()[:SHOWN]!r} is not node.direction; export again"
            )
        dofs.append((int(node), int(direction) - 1))
    if not dofs:
        raise InputError(f"matrix file {file.name}: holds no entries; export it again")
    return np.array(dofs, dtype=np.int64)


# data blocks of the global, the analysis and the residual structure's set; DMIG-like short names last
USUAL_NAMES = {"stiffness": ("KGG", "KAA", "KXX", "KJJ", "K"), "mass": ("MGG", "MAA", "MXX", "MJJ", "M")}
_WHOLE = re.compile(rb"(?> *+-?+[0-9]++)++ *+")
_REALS = re.compile(rb"(?> *+[+-]?+[0-9]*+\.[0-9]++(?>[ED][+-]?+[0-9]++|[+-][0-9]++)?+)++ *+")
_HEAD = re.compile(
    rb"[ 0-9-]{32,64}+[A-Za-z][A-Za-z0-9_ ]{7}(?:\s*+(?:1P,)?([0-9]{1,2})[EeDd]([0-9]{1,2})\.[0-9]{1,2})?\s*+"
)
_WIDTH = 16  # characters of a number where a head has none


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
    except Exception as error:  # the reader raises various errors: ValueError, IndexError, struct.error
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
    """Error in the form of a text; "" if there is none."""
    width = _WIDTH
    for number, line in enumerate(content.split(b"\n"), start=1):
        line = line.rstrip(b"\r")
        head = _HEAD.fullmatch(line)
        if head:
            width = int(head[2]) if head[2] else _WIDTH
            sizes = [abs(int(w)) for w in line[:16].split()]
            if max(sizes, default=0) > len(content):
                return (
                    f"line {number} declares a matrix of {' by '.join(map(str, sizes))}, more than fits into the file"
                )
        elif not line.strip() or _WHOLE.fullmatch(line):
            continue
        elif not _REALS.fullmatch(line) or len(line.rstrip()) % width:
            return f"line {number} is neither a head nor numbers"
    return ""


def _record_fault(content: bytes) -> str:
    """Error in the chain of records of a binary file; "" if there is none."""
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
