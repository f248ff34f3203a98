"""Tables of numbers in text files, with the number of the line that cannot be read."""

from __future__ import annotations

import io
import warnings
from pathlib import Path

import numpy as np

from warpffrf.model.errors import InputError
from warpffrf.model.files.regular_file import read_named

COMMENT = "*"  # Abaqus: a keyword or, doubled, a comment
_TO_PLAIN = str.maketrans({",": " ", "D": "E", "d": "e"})
SHOWN = 60  # characters of a bad line in a message


def read_table(file: Path, columns: tuple[int, ...], meaning: str) -> np.ndarray:
    """Numbers (m, c) of the lines of `file`, with c the first of `columns` that the first line has.

    Numbers are separated by blanks or commas; lines that begin with `*` and empty lines are left out; Fortran's D
    exponents are understood. Raises `InputError` naming the first line that has another number of columns, a word, or
    a value that is not finite, and `meaning`, what a line should hold.
    """
    text = read_named(file, "matrix file").decode("latin-1")  # any byte is a character: comments may hold anything
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
