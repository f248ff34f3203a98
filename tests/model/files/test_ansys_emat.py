"""Element matrices of Ansys: a file of ansys-mapdl-reader's own tests (MIT, two beams of 40 hexahedra with 20 nodes,
Copyright Synopsys, Inc. and ANSYS, Inc.), whose nodes are those of the library's example HexBeam.cdb, twice."""

from __future__ import annotations

import lzma
from pathlib import Path
from typing import Any

import numpy as np
import pytest
import scipy.linalg

import warpffrf as wf
from warpffrf.model.errors import InputError
from warpffrf.model.mesh import read_matrix
from warpffrf.model.mesh.facets import rigid_modes

DATA = Path(__file__).parents[2] / "data" / "two_hex_beams.emat.xz"
SIZE = (1.0, 1.0, 5.0)  # of a beam, in the file's own units
DENSITY = 5e-4  # in them
COUNT = 321  # nodes of a beam
ROUND_OFF = 1e-12


@pytest.fixture(scope="module")
def emat(tmp_path_factory: pytest.TempPathFactory) -> Path:
    pytest.importorskip("ansys.mapdl.reader")
    path = tmp_path_factory.mktemp("ansys") / "file.emat"
    path.write_bytes(lzma.decompress(DATA.read_bytes()))
    return path


@pytest.fixture(scope="module")
def beam(emat: Path) -> tuple[Any, Any, np.ndarray, np.ndarray]:
    """K and M of the first beam (dense), places and numbers of its nodes, in the order of the rows."""
    reader = pytest.importorskip("ansys.mapdl.reader")
    archive = reader.Archive(str(Path(reader.__file__).parent / "examples" / "HexBeam.cdb"))
    places = dict(zip(archive.nnum.tolist(), archive.nodes[:, :3], strict=True))
    K, M = (read_matrix(emat, role=role) for role in ("stiffness", "mass"))
    assert K.dofs is not None and M.dofs is not None and np.array_equal(K.dofs, M.dofs)
    assert len(K.dofs) == 2 * COUNT * 3
    own = np.flatnonzero(K.dofs[:, 0] <= COUNT)
    numbers = K.dofs[own[::3], 0]
    k, m = (A.matrix[own][:, own].toarray() for A in (K, M))
    return k, m, np.array([places[n] for n in numbers.tolist()]), numbers


def test_rigid_motions_are_free_of_force_and_have_the_mass_of_the_beam(beam: Any) -> None:
    K, M, points, _ = beam
    R = rigid_modes(points, points.mean(axis=0))
    assert all(np.abs(A - A.T).max() < ROUND_OFF * np.abs(A).max() for A in (K, M))
    assert np.abs(K @ R).max() < ROUND_OFF * np.abs(K).max() * np.abs(points).max()
    mass = DENSITY * np.prod(SIZE)
    a, b, c = SIZE
    inertia = mass / 12.0 * np.array([b**2 + c**2, a**2 + c**2, a**2 + b**2])
    assert np.allclose(R.T @ M @ R, np.diag([*3 * [mass], *inertia]), rtol=1e-9, atol=1e-9 * inertia.max())


def test_a_body_of_the_matrices_has_their_free_frequencies(beam: Any) -> None:
    """M of elements with reduced integration is singular: the eigenvalues are those of M against K + M, scaled."""
    K, M, points, _ = beam
    scale = np.abs(K).max() / np.abs(M).max()
    values = scale * (1.0 / scipy.linalg.eigh(M, K / scale + M, eigvals_only=True)[:-11:-1] - 1.0)
    assert np.abs(values[:6]).max() < 1e-6 * values[6]  # six rigid motions
    body = wf.reduce(wf.mesh.from_matrices(M, K, points), modes=4, cache=False, progress=False)
    assert np.allclose(body.frequencies[:4], np.sqrt(values[6:10]) / (2.0 * np.pi), rtol=1e-6)


def test_names_and_damaged_files_are_refused(emat: Path, tmp_path: Path) -> None:
    with pytest.raises(InputError, match="no names of matrices"):
        read_matrix(emat, "KAA")
    content = emat.read_bytes()
    for number, damaged in enumerate((content[:9000], b"\0" * 4000, content[:20000] + b"\xff" * 400 + content[20400:])):
        path = tmp_path / f"{number}.emat"
        path.write_bytes(damaged)
        with pytest.raises(InputError, match=f"matrix file {path.name}: "):
            read_matrix(path)
