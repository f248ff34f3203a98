"""Matrix files: every format written here and read back, CalculiX's own files, and garbled ones.

The files in tests/data/calculix were written by CalculiX 2.20 from the decks next to them (`ccx hex8`, `ccx hex20`):
one distorted cell each, steel, mm and tonnes.
"""

from __future__ import annotations

import re
from pathlib import Path
from typing import Any

import numpy as np
import pytest
import scipy.sparse as sp
from hypothesis import given, settings
from hypothesis import strategies as st
from scipy.io import mmwrite

from warpffrf.model.errors import InputError
from warpffrf.model.material import Material
from warpffrf.model.mesh import Mesh
from warpffrf.model.mesh.files.matrices import from_matrices, read_matrix
from warpffrf.model.mesh.files.matrices.files import completed
from warpffrf.offline.fe import assemble, assign

CALCULIX = Path(__file__).resolve().parents[2] / "data" / "calculix"
STEEL = Material(210e9, 0.3, 7850.0)


def symmetric(size: int = 12, seed: int = 3) -> sp.csr_matrix:
    """A symmetric positive matrix with some zeros."""
    rng = np.random.default_rng(seed)
    A = rng.standard_normal((size, size)) * (rng.random((size, size)) < 0.6)
    return sp.csr_matrix(A @ A.T + 30.0 * np.eye(size))


def write_abaqus(path: Path, A: sp.csr_matrix, numbers: np.ndarray, *, triangle: bool, seed: int = 0) -> Path:
    """MATRIX INPUT lines in a random order; each pair in a random order too, as an own numbering would give."""
    entries = sp.coo_matrix(sp.triu(A) if triangle else A)
    rng = np.random.default_rng(seed)
    lines = ["** matrix", "*MATRIX ASSEMBLE"]
    for k in rng.permutation(entries.nnz):
        pair = [int(entries.row[k]), int(entries.col[k])]
        if triangle and rng.random() < 0.5:
            pair.reverse()
        (a, i), (b, j) = (divmod(r, 3) for r in pair)
        lines.append(f"{numbers[a]},{i + 1}, {numbers[b]},{j + 1}, {entries.data[k]:.17e}")
    path.write_text("\n".join(lines) + "\n")
    return path


def write_triplets(path: Path, A: sp.csr_matrix, *, triangle: bool, lower: bool = False) -> Path:
    part = sp.coo_matrix((sp.tril(A) if lower else sp.triu(A)) if triangle else A)
    rows = zip(part.row + 1, part.col + 1, part.data, strict=True)
    path.write_text("".join(f"{i} {j} {x:.17e}\n" for i, j, x in rows))
    return path


def same(A: Any, B: Any) -> None:
    assert abs(A - B).max() <= 1e-15 * abs(A).max()


@pytest.mark.parametrize("triangle", [False, True])
def test_matrix_market(tmp_path: Path, triangle: bool) -> None:
    A = symmetric()
    mmwrite(tmp_path / "a.mtx", A, symmetry="symmetric" if triangle else "general", precision=17)
    same(read_matrix(tmp_path / "a.mtx").matrix, A)
    mmwrite(tmp_path / "full.mtx", A.toarray(), precision=17)
    same(read_matrix(tmp_path / "full.mtx").matrix, A)


@pytest.mark.parametrize("triangle", [False, True])
def test_abaqus_matrix_input(tmp_path: Path, triangle: bool) -> None:
    A = symmetric()
    numbers = np.array([4, 7, 105, 2000])
    found = read_matrix(write_abaqus(tmp_path / "job_STIF1.mtx", A, numbers, triangle=triangle))
    same(found.matrix, A)
    assert found.dofs is not None
    np.testing.assert_array_equal(found.dofs, [(n, i) for n in numbers for i in range(3)])


@pytest.mark.parametrize(("triangle", "lower"), [(False, False), (True, False), (True, True)])
def test_abaqus_coordinate(tmp_path: Path, triangle: bool, lower: bool) -> None:
    A = symmetric()
    found = read_matrix(write_triplets(tmp_path / "job_STIF1.mtx", A, triangle=triangle, lower=lower))
    same(found.matrix, A)
    assert found.dofs is None


def test_exponents_of_fortran(tmp_path: Path) -> None:
    (tmp_path / "a.mtx").write_text("1 1 1.5D+02\n2 2 2.5d-01\n")
    np.testing.assert_allclose(read_matrix(tmp_path / "a.mtx").matrix.toarray(), np.diag([150.0, 0.25]), rtol=1e-15)


def test_calculix_written_here(tmp_path: Path) -> None:
    A = symmetric()
    order = np.random.default_rng(5).permutation(12)
    write_triplets(tmp_path / "job.sti", A[order][:, order], triangle=True)
    (tmp_path / "job.dof").write_text("".join(f"{10 + r // 3}.{1 + r % 3}\n" for r in order))
    found = read_matrix(tmp_path / "job.sti")
    assert found.dofs is not None
    np.testing.assert_array_equal(found.dofs, np.stack([10 + order // 3, order % 3], axis=1))
    same(found.matrix, A[order][:, order])


def deck_nodes(kind: str) -> tuple[np.ndarray, np.ndarray]:
    """Numbers (n,) and coordinates (n, 3) [mm] of the nodes of a deck."""
    rows = []
    for line in (CALCULIX / f"{kind}.inp").read_text().splitlines()[1:]:
        if line.startswith("*"):
            break
        rows.append([float(x) for x in line.split(",")])
    table = np.array(rows)
    return table[:, 0].astype(int), table[:, 1:]


@pytest.mark.parametrize("kind", ["hex8", "hex20"])
def test_calculix_gives_the_matrices_of_the_assembly(kind: str) -> None:
    numbers, nodes = deck_nodes(kind)
    files = CALCULIX / f"{kind}.mas", CALCULIX / f"{kind}.sti"
    body = from_matrices(*files, nodes, node_numbers=numbers, length_unit="mm")
    assert body.matrices is not None
    mesh = Mesh(body.points, {kind: np.arange(len(nodes))[None]})
    for ours, theirs in zip(
        assemble(mesh.points, mesh.cells, assign(mesh, STEEL)),
        (body.matrices.stiffness, body.matrices.mass),
        strict=True,
    ):
        assert abs(ours - theirs).max() < 1e-12 * abs(ours).max()  # files of 14 digits, nodes of 4


def test_nastran_op4(tmp_path: Path) -> None:
    op4 = pytest.importorskip("pyyeti.nastran.op4")
    A, B = symmetric(seed=1), symmetric(seed=2)
    for binary, sparse in ((True, "bigmat"), (True, "dense"), (False, "bigmat"), (False, "nonbigmat")):
        path = tmp_path / "model.op4"
        op4.write(str(path), {"KGG": A, "MGG": B}, binary=binary, sparse=sparse, digits=17)
        same(read_matrix(path, role="stiffness").matrix, A)
        same(read_matrix(path, role="mass").matrix, B)
        same(read_matrix(path, "mgg").matrix, B)
    with pytest.raises(InputError, match="KGG, MGG, looked for PHIX.*read_matrix"):
        read_matrix(tmp_path / "model.op4", "phix")
    (tmp_path / "bad.op4").write_bytes(b"\x00\x01garbled" * 5)
    with pytest.raises(InputError, match=r"bad\.op4: cannot be read as OUTPUT4"):
        read_matrix(tmp_path / "bad.op4")


def test_missing_extra_is_named(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setitem(__import__("sys").modules, "pyyeti.nastran.op4", None)
    (tmp_path / "model.op4").write_bytes(b"")
    with pytest.raises(InputError, match=r"pyYeti.*warpffrf\[matrices\]"):
        read_matrix(tmp_path / "model.op4")


@pytest.mark.parametrize(
    ("name", "text", "message"),
    [
        ("a.mtx", "1,1,1,1,2.0\n1,1,2,x,3.0\n", r"a\.mtx, line 2: '1,1,2,x,3.0' is not 'node, dof"),
        ("a.mtx", "** note\n1 1 2.0\n\n2 1\n", r"line 4: '2 1' is not"),
        ("a.mtx", "1 1 nan\n", "line 1"),
        ("a.mtx", "", "holds no entries"),
        ("a.mtx", "1 1 1 1\n", "line 1"),
        ("a.mtx", "0 1 1.0\n", "count from 1"),
        ("a.mtx", "1 1 1.0\n999999999999 1 1.0\n", "2 entries cannot fill 999999999999 rows"),
        ("a.mtx", "1.5 1 1.0\n", "whole numbers, got 1.5"),
        ("a.mtx", "-3,1,-3,1,2.0\n", "node -3 is an internal node"),
        ("a.mtx", "3,8,3,8,2.0\n", "dof 8 of node 3 is no displacement"),
        (
            "a.mtx",
            "%%MatrixMarket matrix coordinate real general\n3 3 2\n1 1 1.0\n",
            "has 1 entries, line 2 declares 2",
        ),
        ("a.mtx", "%%MatrixMarket matrix coordinate real general\n2 3 1\n1 1 1.0\n", r"\(2, 3\), not square"),
        (
            "a.mtx",
            "%%MatrixMarket matrix coordinate real general\n% note\n2 2 1\n1 1 1.5X6\n",
            "line 4: '1 1 1.5X6' is not row, column and value",
        ),
        ("a.sti", "1 1 1.0\n", r"a\.dof does not exist"),
        ("a.txt", "1 1 1.0\n", "unknown format '.txt'"),
    ],
)
def test_garbled_files(tmp_path: Path, name: str, text: str, message: str) -> None:
    (tmp_path / name).write_text(text)
    with pytest.raises(InputError, match=message):
        read_matrix(tmp_path / name)


def test_garbled_dof_file_and_missing_file(tmp_path: Path) -> None:
    (tmp_path / "a.mas").write_text("1 1 1.0\n3 3 1.0\n")
    for text, message in (
        ("1.1\n1\n", r"line 2: '1' is not node\.direction"),
        ("1.1\n1.2\n", "rows 1 to 3 do not fit"),
    ):
        (tmp_path / "a.dof").write_text(text)
        with pytest.raises(InputError, match=message):
            read_matrix(tmp_path / "a.mas")
    with pytest.raises(InputError, match="does not exist; check the path"):
        read_matrix(tmp_path / "none.mtx")
    with pytest.raises(InputError, match="role must be one of"):
        read_matrix(tmp_path / "a.mas", role="damping")


@settings(max_examples=60, deadline=None)
@given(st.text(alphabet="0123456789 ,.-+eEdD*%\nxnaif", max_size=120))
def test_any_text_is_read_or_refused(tmp_path_factory: pytest.TempPathFactory, text: str) -> None:
    path = tmp_path_factory.mktemp("fuzz") / "a.mtx"
    path.write_text(text)
    try:
        found = read_matrix(path)
    except InputError as error:
        assert "a.mtx" in str(error)
    else:
        assert found.matrix.shape[0] == found.matrix.shape[1]


def test_a_whole_matrix_is_not_completed_twice() -> None:
    A = symmetric()
    same(completed(A), A)
    same(completed(sp.tril(A)), A)
    same(completed(sp.diags_array(A.diagonal())), sp.diags_array(A.diagonal()).tocsr())
    unsymmetric = sp.csr_matrix(np.array([[2.0, 1.0, 3.0], [1.0, 2.0, 0.0], [0.0, 0.0, 2.0]]))
    same(completed(unsymmetric), unsymmetric)  # a partner is there: not one triangle, the check of symmetry sees it


@pytest.mark.parametrize("exponent", ["e", "E", "d", "D"])
@pytest.mark.parametrize("sign", ["", "+", "-"])
def test_exponents_of_every_program(tmp_path: Path, exponent: str, sign: str) -> None:
    """Fortran writes 1.5D6; read as 1.5 it would be a wrong matrix that looks right."""
    head = "%%MatrixMarket matrix coordinate real general\n% made by Dora\n2 2 2\n"
    text = f"{head}1 1 1.5{exponent}{sign}6\n2 2 -2.{exponent}01\n"
    (tmp_path / "a.mtx").write_text(text)
    np.testing.assert_array_equal(
        read_matrix(tmp_path / "a.mtx").matrix.toarray(), np.diag([float(f"1.5e{sign}6"), -20.0])
    )


def test_an_exponent_without_letter(tmp_path: Path) -> None:
    """With three digits Fortran's E format has no room for the letter."""
    text = "%%MatrixMarket matrix coordinate real general\n2 2 2\n1 1 1.5-106\n2 2 -.25+100"
    (tmp_path / "a.mtx").write_text(text)
    np.testing.assert_array_equal(read_matrix(tmp_path / "a.mtx").matrix.toarray(), np.diag([1.5e-106, -0.25e100]))


@pytest.mark.parametrize("word", ["1.5.2", "1..5", "1e", "1.5e6e2", "1-106", "--1", ".", "nan", "1,5", "1.5D"])
def test_what_is_no_number(tmp_path: Path, word: str) -> None:
    """SciPy reads most of these up to the first character that it does not know."""
    text = f"%%MatrixMarket matrix coordinate real general\n% made by Dora\n2 2 2\n1 1 1.0\n2 2 {word}\n"
    (tmp_path / "a.mtx").write_text(text)
    with pytest.raises(InputError, match=rf"a\.mtx, line 5: '2 2 {re.escape(word)}' is not row, column and value"):
        read_matrix(tmp_path / "a.mtx")
