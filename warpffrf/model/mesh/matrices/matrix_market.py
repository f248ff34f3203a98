"""Matrix Market files, coordinate or array (Boisvert, Pozo, Remington 1996, NISTIR 5935), through SciPy."""

from __future__ import annotations

from pathlib import Path

from warpffrf.model.errors import InputError
from warpffrf.model.mesh.matrices.files import FileMatrix

BANNER = b"%%matrixmarket"  # in small letters, as it is compared


def read(file: Path, name: str | None, role: str) -> FileMatrix:
    """The matrix of a Matrix Market file; it does not say what its rows are. Raises `InputError` for a garbled file."""
    import scipy.sparse as sp
    from scipy.io import mmread

    try:
        matrix = mmread(file)
    except Exception as error:  # the reader raises what its parser meets: ValueError, OverflowError, IndexError
        raise InputError(
            f"matrix file {file.name}: cannot be read as Matrix Market ({error}); export it again"
        ) from None
    return FileMatrix(sp.csr_matrix(matrix), None, file.name)
