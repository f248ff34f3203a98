"""Craig-Bampton matrices: free and clamped frequencies, rigid motions, condensed finite elements, files."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np
import pytest
import scipy.linalg
import scipy.sparse as sp

import warpffrf as wf
from warpffrf.model.errors import InputError
from warpffrf.model.mesh import read_matrix
from warpffrf.model.mesh.facets import rigid_modes
from warpffrf.offline.fe import assign, fe_matrices

STEEL = wf.Material(youngs_modulus=210e9, poisson_ratio=0.3, density=7850)


@pytest.fixture(scope="module")
def beam() -> tuple[Any, Any]:
    mesh = wf.mesh.box((0.2, 0.03, 0.02), (8, 2, 2), order=1)
    interfaces = {"x_min": "rigid", "x_max": "rigid"}
    return mesh, wf.reduce(mesh, STEEL, interfaces=interfaces, modes=30, cache=False, progress=False)


def test_nothing_is_lost(beam: tuple[Any, Any]) -> None:
    """Free frequencies and mass are those of the body; rigid motions of the interfaces need no force."""
    _, body = beam
    found = body.craig_bampton()
    n = len(body.frequencies) + 6
    assert found.stiffness.shape == found.mass.shape == (n, n) and len(found.coordinates) == n
    values = scipy.linalg.eigh(found.stiffness, found.mass, eigvals_only=True)
    assert np.max(np.abs(values[:6])) < 1e-9 * values[6]
    assert np.allclose(np.sqrt(values[6:]) / (2.0 * np.pi), body.frequencies, rtol=1e-7)
    R = np.zeros((n, 6))
    for k, interface in enumerate(body.interfaces.values()):
        R[6 * k : 6 * k + 3] = rigid_modes(interface.point[None], body.center_of_mass)
        R[6 * k + 3 : 6 * k + 6, 3:] = np.eye(3)
    assert np.max(np.abs(found.stiffness @ R)) < 1e-9 * np.max(np.abs(found.stiffness))
    m = R.T @ found.mass @ R
    assert np.allclose(m[:3, :3], body.mass * np.eye(3), rtol=1e-9)
    assert np.allclose(m[3:, 3:], body.inertia, rtol=1e-8, atol=1e-12) and np.max(np.abs(m[:3, 3:])) < 1e-10


def test_stiffness_is_that_of_the_condensed_elements(beam: tuple[Any, Any]) -> None:
    """Static condensation of the finite elements to both rigid ends; clamped frequencies of the elements."""
    mesh, body = beam
    found = body.craig_bampton()
    K, M = (A.toarray() for A in fe_matrices(mesh, assign(mesh, STEEL)))
    ends = [mesh.facets(name).node_set for name in ("x_min", "x_max")]
    free = np.setdiff1d(np.arange(len(mesh.points)), np.concatenate(ends))
    inner = (3 * free[:, None] + np.arange(3)).ravel()
    T = np.zeros((len(K), 12 + len(inner)))
    T[inner, 12 + np.arange(len(inner))] = 1.0
    for k, (nodes, interface) in enumerate(zip(ends, body.interfaces.values(), strict=True)):
        T[(3 * nodes[:, None] + np.arange(3)).ravel(), 6 * k : 6 * k + 6] = rigid_modes(
            mesh.points[nodes], interface.point
        )
    k, m = T.T @ K @ T, T.T @ M @ T
    condensed = k[:12, :12] - k[:12, 12:] @ np.linalg.solve(k[12:, 12:], k[12:, :12])
    scale = np.sqrt(np.outer(np.diag(condensed), np.diag(condensed)))
    assert np.max(np.abs(found.stiffness[:12, :12] - condensed) / scale) < 1e-6
    values = scipy.linalg.eigh(k[12:, 12:], m[12:, 12:], eigvals_only=True)
    assert np.allclose(found.frequencies[:6], np.sqrt(values[:6]) / (2.0 * np.pi), rtol=1e-3)


def test_files_give_the_same_matrices(beam: tuple[Any, Any], tmp_path: Path) -> None:
    """OUTPUT4 by pyYeti and by `read_matrix`, Matrix Market by `read_matrix` and SciPy: to 1e-12."""
    op4 = pytest.importorskip("pyyeti.nastran.op4")
    found = beam[1].craig_bampton()
    path = found.to_op4(tmp_path / "body.op4")
    read = op4.read(str(path))
    K, M = found.to_mtx(tmp_path / "k.mtx", tmp_path / "m.mtx")
    for name, role, own, market in (("KAAX", "stiffness", found.stiffness, K), ("MAAX", "mass", found.mass, M)):
        for other in (read[name.lower()] if name.lower() in read else read[name], read_matrix(path, name).matrix,
                      read_matrix(market, role=role).matrix):  # fmt: skip
            dense = other.toarray() if sp.issparse(other) else np.asarray(other)
            assert np.max(np.abs(dense - own)) <= 1e-12 * np.max(np.abs(own))
    assert "%x_max rz" in K.read_text() and "written by warpffrf" in K.read_text()
    with pytest.raises(InputError, match="exists"):
        found.to_op4(path)
    with pytest.raises(InputError, match="exists"):
        found.to_mtx(K, M)
    assert found.to_mtx(K, M, overwrite=True) == (K, M)


def test_bodies_with_too_few_modes_are_refused() -> None:
    mesh = wf.mesh.box((0.2, 0.03, 0.02), (4, 1, 1), order=1)
    none = wf.reduce(mesh, STEEL, modes=3, cache=False, progress=False)
    with pytest.raises(InputError, match="the body has no interfaces"):
        none.craig_bampton()
