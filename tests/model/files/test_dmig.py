"""Matrices of DMIG cards: written by pyYeti and here, in small, large and free fields; faults."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pandas as pd
import pytest
import scipy.sparse as sp

from warpffrf.model.errors import InputError
from warpffrf.model.material import Material
from warpffrf.model.mesh import box, from_matrices, read_matrix
from warpffrf.offline.fe import assign, fe_matrices

WRITTEN = 1e-9  # relative: ten digits in a field of 16 columns


def beam():
    mesh = box((2, 1, 1), (2, 1, 1), order=1)
    return mesh, *fe_matrices(mesh, assign(mesh, Material(210e9, 0.3, 7850.0)))


@pytest.mark.parametrize("symmetric", [True, False])
def test_matrices_written_by_pyyeti(tmp_path: Path, symmetric: bool) -> None:
    """A .pch with both matrices and numbers of grid points that are not in order; names and dofs are found."""
    nastran = pytest.importorskip("pyyeti.nastran")
    mesh, K, M = beam()
    numbers = 100 - 7 * np.arange(len(mesh.points))
    index = pd.MultiIndex.from_product([numbers, [1, 2, 3]])
    tables = {}
    K, M = 0.5 * (K + K.T), 0.5 * (M + M.T)
    for name, A in (("KAAX", K), ("MAAX", M)):
        dense = A.toarray() + (0.0 if symmetric else 1e-12 * abs(A).max() * np.triu(np.ones(A.shape), 1))
        tables[name] = pd.DataFrame(dense, index=index, columns=index)
    nastran.wtdmig(str(tmp_path / "e.pch"), tables)
    assert ("       6" in (tmp_path / "e.pch").read_text().splitlines()[0]) == symmetric
    body = from_matrices(tmp_path / "e.pch", tmp_path / "e.pch", mesh.points, node_numbers=numbers)
    assert body.matrices is not None and "e.pch: not used for MAAX: matrix KAAX" in body.notes
    for found, own in ((body.matrices.stiffness, K), (body.matrices.mass, M)):
        assert abs(found - own).max() < WRITTEN * abs(own).max()


def test_small_and_free_fields(tmp_path: Path) -> None:
    """Several rows in a card, reals without E, blank values, a continuation that names itself, other cards between."""
    text = """$ a comment
DMIG    STIF    0       6       1       0
GRID    1               0.      0.      0.
DMIG    STIF    1       1               1       1       3.+5
DMIG    STIF    2       1               1       1       -3.+5           +A
+A      2       1       3.5+5
DMIG,LOAD,0,9,1,0,,,1
DMIG,LOAD,1,,,1,1,1.0
DMIG,STIF,2,2,,2,2,1.5E3,,
"""
    (tmp_path / "s.bdf").write_text(text)
    found = read_matrix(tmp_path / "s.bdf")
    assert found.dofs is not None and found.dofs.tolist() == [[1, 0], [2, 0], [2, 1]]
    assert np.array_equal(found.matrix.toarray(), [[3e5, -3e5, 0], [-3e5, 3.5e5, 0], [0, 0, 1.5e3]])
    assert found.notes == ("s.bdf: not used for STIF: matrix LOAD, cards GRID (1)",)
    with pytest.raises(InputError, match="LOAD is of form 9, no square matrix"):
        read_matrix(tmp_path / "s.bdf", "LOAD")


HEAD = "DMIG,KGG,0,6,2,0\n"


@pytest.mark.parametrize(
    ("text", "message"),
    [
        ("DMIG,KGG,1,1,,1,1,2.0\n", "line 1: DMIG: KGG has no head"),
        (HEAD + HEAD, "line 2: DMIG: KGG has two heads"),
        (HEAD, "KGG has no columns"),
        ("DMIG,KGG,0,6,3,0\nDMIG,KGG,1,1,,1,1,2.0\n", "complex"),
        (HEAD + "DMIG,KGG,1,1,,1,1,two\n", "line 2: DMIG: field 8 must be a number, got 'two'"),
        (HEAD + "DMIG,KGG,1,1,,1,1,2.0\nDMIG,KGG,9,0,,9,0,1.0\n", "point 9, component 0, which is no displacement"),
        (HEAD + "DMIG,KGG,1,1,,2,1,2.0\nDMIG,KGG,2,1,,1,1,2.0\n", "the entry of 1-1 and 2-1 is given 2 times"),
        ("GRID,1,,0.,0.,0.\n", "no stiffness matrix among nothing"),
    ],
)
def test_a_wrong_file_is_refused(tmp_path: Path, text: str, message: str) -> None:
    (tmp_path / "wrong.pch").write_text(text)
    with pytest.raises(InputError) as error:
        read_matrix(tmp_path / "wrong.pch")
    assert message in str(error.value) and str(error.value).startswith("matrix file wrong.pch")


def test_one_matrix_of_any_name_is_taken(tmp_path: Path) -> None:
    (tmp_path / "a.pch").write_text(HEAD.replace("KGG", "ANY") + "DMIG,ANY,4,2,,4,2,2.0\n")
    assert sp.csr_matrix(read_matrix(tmp_path / "a.pch", role="mass").matrix).toarray().tolist() == [[2.0]]
