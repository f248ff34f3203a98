"""A body from matrices is reduced like the mesh that the matrices belong to."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

from warpffrf.model import mesh as wfmesh
from warpffrf.model.errors import InputError
from warpffrf.model.material import Material
from warpffrf.model.mesh import Mesh
from warpffrf.model.mesh.files.matrices import from_matrices
from warpffrf.model.reduced.body import ReducedBody
from warpffrf.model.surfaces import Cylinder
from warpffrf.offline import ReductionOptions, reduce
from warpffrf.offline.fe import assemble, assign

STEEL = Material(210e9, 0.3, 7850.0)
SAME = 1e-9  # relative: round-off of a factorisation; the order of sums may differ


def reduced(mesh: Mesh, material: Material | None) -> ReducedBody:
    return reduce(
        mesh,
        material,
        interfaces={"bore": "rigid"},
        contact={"rim": Cylinder()},
        modes=9,
        options=ReductionOptions(periodic=False),
        cache=False,
        progress=False,
    )


@pytest.fixture(scope="module")
def pair() -> tuple[ReducedBody, ReducedBody]:
    """The general path on a mesh, and on its matrices in another order of rows."""
    roller = wfmesh.roller(0.05, 0.015, 0.02, sectors=12, layers=2, axial=2, order=1)
    mesh = Mesh(roller.points, roller.cells, roller.facet_sets)
    K, M = assemble(mesh.points, mesh.cells, assign(mesh, STEEL))
    order = np.random.default_rng(2).permutation(K.shape[0])
    dof_map = np.stack(np.divmod(order, 3), axis=1)
    body = from_matrices(
        M[order][:, order], K[order][:, order], mesh.points, dof_map=dof_map, facets=mesh.facet_sets, name="roller"
    )
    return reduced(mesh, STEEL), reduced(body, None)


def close(a: np.ndarray, b: np.ndarray) -> None:
    assert np.max(np.abs(a - b)) <= SAME * np.max(np.abs(a))


def test_mass_and_frequencies(pair: tuple[ReducedBody, ReducedBody]) -> None:
    mesh, body = pair
    close(mesh.frequencies, body.frequencies)
    assert body.mass == pytest.approx(mesh.mass, rel=SAME)
    close(mesh.inertia, body.inertia)
    assert np.max(np.abs(mesh.center_of_mass - body.center_of_mass)) < SAME


def test_interface_and_contact(pair: tuple[ReducedBody, ReducedBody]) -> None:
    """Through products that do not depend on signs and on the choice within pairs of equal frequencies."""
    mesh, body = pair
    a, b = (p.interfaces["bore"].modes for p in pair)
    close(a.T @ a, b.T @ b)
    a, b = (p.contact_surfaces["rim"].mode_normal for p in pair)
    close(a @ a.T, b @ b.T)
    close(mesh.contact_surfaces["rim"].lags, body.contact_surfaces["rim"].lags)


def test_skin_is_the_facets(pair: tuple[ReducedBody, ReducedBody]) -> None:
    mesh, body = pair
    np.testing.assert_array_equal(mesh.surface.points, body.surface.points)
    assert len(mesh.surface.triangles) == len(body.surface.triangles)


def test_mesh_without_cells_needs_matrices(tmp_path: Path) -> None:
    with pytest.raises(InputError, match="no volume cells"):
        Mesh(np.eye(3), {})
