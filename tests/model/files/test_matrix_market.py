"""Matrix Market files: what SciPy writes is read the same, and anything that is not of the format is refused."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest
import scipy.sparse as sp
from hypothesis import given, settings
from hypothesis import strategies as st
from scipy.io import mmread, mmwrite

from warpffrf.model.errors import InputError
from warpffrf.model.mesh.files.matrices.formats import read

REAL = "%%MatrixMarket matrix coordinate real general\n"


def of(path: Path, text: str | bytes) -> np.ndarray:
    path.write_bytes(text.encode() if isinstance(text, str) else text)
    return read(path, None, "stiffness").matrix.toarray()


def square(symmetry: str) -> np.ndarray:
    A = np.random.default_rng(2).standard_normal((7, 7)) * 1e9
    A[2, 5] = A[5, 2] = 0.0
    return {"general": A, "symmetric": A + A.T, "skew-symmetric": A - A.T}[symmetry]


@pytest.mark.parametrize("symmetry", ["general", "symmetric", "skew-symmetric"])
@pytest.mark.parametrize("field", ["real", "integer"])
@pytest.mark.parametrize("layout", ["coordinate", "array"])
def test_what_scipy_writes_is_read_bit_for_bit(tmp_path: Path, symmetry: str, field: str, layout: str) -> None:
    A = square(symmetry) if field == "real" else np.rint(square(symmetry))
    if field == "integer":
        A = A.astype(np.int64)
    path = tmp_path / "a.mtx"
    mmwrite(path, sp.coo_matrix(A) if layout == "coordinate" else A, field=field, precision=17, symmetry=symmetry)
    assert symmetry.encode() in path.read_bytes()[:80] and field.encode() in path.read_bytes()[:80]
    np.testing.assert_array_equal(read(path, None, "mass").matrix.toarray(), A)
    np.testing.assert_array_equal(sp.coo_matrix(mmread(path)).toarray(), A)


def test_a_pattern_is_ones(tmp_path: Path) -> None:
    text = "%%MatrixMarket matrix coordinate pattern symmetric\n3 3 2\n1 1\n3 2\n"
    np.testing.assert_array_equal(of(tmp_path / "a.mtx", text), [[1, 0, 0], [0, 0, 1], [0, 1, 0]])


def test_blanks_comments_and_ends_of_line_of_all_systems(tmp_path: Path) -> None:
    text = "%%MatrixMarket  MATRIX Coordinate Real General\r\n%\r\n\r\n  % x\n 2\t2  2 \r\n\n  1 1\t+1.\r\n\r\n2 2 .5 "
    np.testing.assert_array_equal(of(tmp_path / "a.mtx", text), np.diag([1.0, 0.5]))


@pytest.mark.parametrize(
    ("text", "message"),
    [
        ("%%MatrixMarket matrix coordinate real\n1 1 1\n1 1 1\n", "line 1: is not '%%MatrixMarket matrix LAYOUT"),
        ("%%MatrixMarket matrix coordinate complex general\n1 1 1\n1 1 1 0\n", "line 1: 'complex' is not supported"),
        ("%%MatrixMarket matrix coordinate real hermitian\n1 1 1\n1 1 1\n", "'hermitian' is not supported"),
        ("%%MatrixMarket matrix array pattern general\n1 1\n", "has no entries"),
        (REAL + "1 1\n1 1 1\n", "line 2: '1 1' are not the numbers of rows, columns and entries"),
        (REAL + "1 -1 1\n1 1 1\n", "line 2"),
        (REAL, "line 2: '' are not"),
        (REAL + "9999999999 9999999999 1\n1 1 1\n", "declares 9999999999 rows, .* in 76 bytes"),
        (REAL + "3 3 99999999999999999999999999999\n1 1 1\n", "declares"),
        (REAL + "2 2 2\n1 1 1\n2 2 1 7\n", "line 4: '2 2 1 7' is not row, column and value"),
        (REAL + "2 2 2\n1 1 1\n2 2\n", "line 4"),
        (REAL + "2 2 2\n1 1 1\n% no\n2 2 1\n", "line 4: '% no' is not"),
        (REAL + "2 2 2\n1 1 1\n3 2 1\n", "line 4: row 3, column 2 is outside 2 by 2"),
        (REAL + "2 2 2\n0 1 1\n2 2 1\n", "line 3: row 0"),
        (REAL + "2 2 2\n1.0 1 1\n2 2 1\n", "line 3"),
        (REAL + "2 2 2\n1 1 1\n\n2 2 1e999\n", "line 5: holds a number that is too large"),
        (REAL + "2 2 3\n1 2 1\n\n2 2 1\n1 2 1\n", "line 6: row 1, column 2 repeats line 3"),
        (REAL.replace("general", "symmetric") + "2 2 2\n1 2 1\n2 1 1\n", "line 4: row 2, column 1 repeats line 3"),
        (REAL.replace("general", "symmetric") + "2 3 1\n1 2 1\n", "cannot have 2 rows and 3 columns"),
        (REAL.replace("general", "skew-symmetric") + "2 2 1\n1 1 1\n", "line 3: .* no entry on its diagonal"),
        (REAL.replace("real", "integer") + "1 1 1\n1 1 1.0\n", "line 3"),
        (REAL + "2 2 1\n1 1 1\n2 2 1\n", "has 2 entries, line 2 declares 1"),
        (REAL + "2 2 1\n", "has 0 entries, line 2 declares 1"),
        (REAL + "2 2 1", "has 0 entries, line 2 declares 1"),
        ("%%MatrixMarket matrix array real general\n1 1\n\n", "has 0 entries, line 2 declares 1"),
        ("%%MatrixMarket matrix array real general\n2 2\n1\n2\n3\n", "has 3 entries, line 2 declares 4"),
        ("%%MatrixMarket matrix array real general\n2 1\n1 2\n", "line 3: '1 2' is not a value"),
    ],
)
def test_what_is_not_of_the_format_is_refused(tmp_path: Path, text: str, message: str) -> None:
    with pytest.raises(InputError, match=message) as refusal:
        of(tmp_path / "a.mtx", text)
    assert "a.mtx" in str(refusal.value) and str(refusal.value).endswith("export it again")


@pytest.mark.parametrize("odd", [b"\0", b"\xff", b"\x0c", "\u0663".encode(), b"_"])
def test_odd_bytes(tmp_path: Path, odd: bytes) -> None:
    with pytest.raises(InputError, match="line 3"):
        of(tmp_path / "a.mtx", REAL.encode() + b"1 1 1\n1 1 1" + odd + b"0\n")


@settings(max_examples=200, deadline=None)
@given(st.data())
def test_a_file_cut_off_or_changed_is_read_or_refused(tmp_path_factory: pytest.TempPathFactory, data) -> None:
    whole = (REAL + "% x\n3 3 4\n1 1 1.5D6\n2 2 1e3\n3 3 -.5+102\n3 1 7\n").encode()
    at = data.draw(st.integers(0, len(whole)))
    changed = whole[:at] + data.draw(st.binary(max_size=3)) + whole[at + data.draw(st.integers(0, 9)) :]
    path = tmp_path_factory.getbasetemp() / "cut.mtx"
    try:
        assert np.isfinite(of(path, changed)).all()
    except InputError as error:
        assert "cut.mtx" in str(error)
