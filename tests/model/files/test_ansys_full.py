"""The .full file that ansys-mapdl-reader brings as its example: matrices, dofs, and the frequencies that it states."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest
import scipy.sparse.linalg as spla

from warpffrf.model.errors import InputError
from warpffrf.model.mesh import read_matrix

STATED = [1283.200, 1283.200, 5781.975, 6919.399]  # Hz, in the documentation of ansys-mapdl-reader


def example(name: str) -> Path:
    reader = pytest.importorskip("ansys.mapdl.reader")
    return Path(reader.__file__).parent / "examples" / name


def test_matrices_give_the_frequencies_of_ansys() -> None:
    """A clamped beam: frequencies of K and M without the empty rows of the clamped end."""
    K, M = (read_matrix(example("file.full"), role=role) for role in ("stiffness", "mass"))
    assert K.dofs is not None and M.dofs is not None and np.array_equal(K.dofs, M.dofs)
    assert sorted(np.unique(K.dofs[:, 1])) == [0, 1, 2]
    free = np.flatnonzero(K.matrix.diagonal())
    assert len(K.dofs) - len(free) == 3 * 21  # the nodes of one end
    k, m = (A.matrix[free][:, free].tocsc() for A in (K, M))
    values = np.sort(spla.eigsh(k, 4, m, sigma=0.0, return_eigenvectors=False))
    assert np.allclose(np.sqrt(values) / (2.0 * np.pi), STATED, rtol=1e-6)


def test_a_damaged_file_is_refused_with_its_name(tmp_path: Path) -> None:
    content = example("file.full").read_bytes()
    for number, damaged in enumerate((content[:5000], b"\0" * 4000, content[:400] + b"\xff" * 4000 + content[4400:])):
        path = tmp_path / f"{number}.full"
        path.write_bytes(damaged)
        with pytest.raises(InputError, match=f"matrix file {path.name}: .*WRFULL"):
            read_matrix(path)


def test_names_are_refused(tmp_path: Path) -> None:
    (tmp_path / "a.full").write_bytes(b"x")
    with pytest.raises(InputError, match="no names of matrices"):
        read_matrix(tmp_path / "a.full", "KAA")
