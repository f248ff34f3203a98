"""Matrix Market files, coordinate or array (Boisvert, Pozo, Remington 1996, NISTIR 5935), through SciPy.

SciPy's reader ends a number at the first character that it does not know: it reads Fortran's 1.5D6 and 1.5+106 as 1.5,
and 1.5.2 too. So Fortran's exponents are written as 1.5e6 and 1.5e+106 for it, and a file with anything else among its
numbers is refused.
"""

from __future__ import annotations

import io
import re
from pathlib import Path

from warpffrf.model.errors import InputError
from warpffrf.model.mesh.matrices.file_matrix import FileMatrix

BANNER = b"%%matrixmarket"  # in small letters, as it is compared
_FORTRAN = re.compile(rb"(?<=[0-9.])[dD](?=[+-]?[0-9])")
_FORTRAN_WIDE = re.compile(rb"(\.[0-9]*)(?=[+-][0-9]{3}(?:\s|\Z))")  # of three digits Fortran leaves out the letter
_NUMBERS = re.compile(rb"(?>\s+|[+-]?(?>[0-9]+\.?[0-9]*|\.[0-9]+)(?>[eE][+-]?[0-9]+)?(?=\s|\Z))*+")
_COMMENTS = re.compile(rb"(?:\s*%[^\n]*\n)*")


def read(file: Path, name: str | None, role: str) -> FileMatrix:
    """The matrix of a Matrix Market file; it does not say what its rows are. Raises `InputError` for a garbled file."""
    import scipy.sparse as sp
    from scipy.io import mmread

    text = _plain(file)
    try:
        matrix = mmread(io.BytesIO(text))
    except Exception as error:  # the reader raises what its parser meets: ValueError, OverflowError, IndexError
        raise InputError(
            f"matrix file {file.name}: cannot be read as Matrix Market ({error}); export it again"
        ) from None
    return FileMatrix(sp.csr_matrix(matrix), None, file.name)


def _plain(file: Path) -> bytes:
    """The file with exponents as SciPy reads them; raises `InputError` for what is no number."""
    text = file.read_bytes()
    head = re.match(_COMMENTS, text)
    start = head.end() if head else 0
    numbers = _FORTRAN_WIDE.sub(rb"\1e", _FORTRAN.sub(b"e", text[start:]))
    read = _NUMBERS.match(numbers)
    end = read.end() if read else 0
    if end < len(numbers):
        line = text[:start].count(b"\n") + numbers[:end].count(b"\n") + 1
        word = numbers[end : end + 60].split()[0].decode(errors="replace")
        raise InputError(f"matrix file {file.name}: line {line} holds {word!r}, which is not a number; export it again")
    return text[:start] + numbers
