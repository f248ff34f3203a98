"""Element matrices against scikit-fem's vector basis, against exact volumes, and rigid motion."""

from __future__ import annotations

import numpy as np
import pytest
from reference_fe import matrices

from warpffrf.model.mesh import Mesh, roller
from warpffrf.model.mesh.elements import CELL_KINDS, FACET_KINDS, cell_kind, facet_kind
from warpffrf.model.mesh.facets import rigid_modes
from warpffrf.offline.fe import assemble, assign, rule
from warpffrf.offline.products import mass_properties


@pytest.mark.parametrize("kind", [*CELL_KINDS, *FACET_KINDS])
def test_shape_functions_are_nodal_and_sum_to_one(kind):
    r = rule(kind, 3)
    assert np.allclose(r.values.sum(axis=1), 1.0)
    assert np.allclose(r.gradients.sum(axis=1), 0.0)
    # linear fields are reproduced: sum_a N_a xi_a = xi, gradient of xi is the identity
    nodes = (facet_kind(kind) if kind in FACET_KINDS else cell_kind(kind)).nodes
    assert np.allclose(np.einsum("qad,ae->qed", r.gradients, nodes), np.eye(nodes.shape[1]))


@pytest.mark.parametrize("kind,degree", [("quad4", 3), ("tri3", 4), ("quad9", 5), ("tri6", 4)])
def test_split_quadrature_keeps_integrals(kind, degree):
    one, many = rule(kind, degree), rule(kind, degree, 3)
    assert np.allclose(one.weights @ one.values, many.weights @ many.values)


def test_matrices_equal_scikit_fem_vector_basis(small_roller, steel):
    K, M = assemble(small_roller.points, small_roller.cells, assign(small_roller, steel))
    for ours, theirs in zip((K, M), matrices(small_roller, steel), strict=True):
        difference = np.abs(ours.toarray() - theirs).max()
        assert difference < 1e-12 * np.abs(theirs).max()  # round-off of sums of a few terms


def tetrahedra(mesh: Mesh) -> Mesh:
    """Every linear hexahedron cut into six tetrahedra around its diagonal."""
    split = np.array([(0, 1, 2, 6), (0, 2, 3, 6), (0, 3, 7, 6), (0, 7, 4, 6), (0, 4, 5, 6), (0, 5, 1, 6)])
    return Mesh(mesh.points, {"tet4": mesh.single[1][:, split].reshape(-1, 4)})


def test_tetrahedra_equal_scikit_fem(small_roller, steel):
    mesh = tetrahedra(small_roller)
    K, M = assemble(mesh.points, mesh.cells, assign(mesh, steel))
    for ours, theirs in zip((K, M), matrices(mesh, steel), strict=True):
        assert np.abs(ours.toarray() - theirs).max() < 1e-12 * np.abs(theirs).max()


@pytest.mark.parametrize("order", [1, 2])
def test_rigid_motion_has_no_energy_and_the_right_mass(order, steel):
    R, r, width = 0.05, 0.015, 0.02
    mesh = roller(R, r, width, sectors=12, layers=2, axial=1, order=order)
    K, M = assemble(mesh.points, mesh.cells, assign(mesh, steel))
    modes = rigid_modes(mesh.points, np.array([0.01, 0.02, -0.03]))
    assert np.abs(K @ modes).max() < 1e-12 * np.abs(K).max()
    mass, center, inertia = mass_properties(modes.T @ (M @ modes), np.array([0.01, 0.02, -0.03]))
    exact = steel.density * np.pi * (R**2 - r**2) * width
    # straight facets lose 1 - sin(a)/a of the area, a = 30 degrees; curved quadratic ones about its square
    shortage = 1.0 - np.sin(np.pi / 6.0) / (np.pi / 6.0)
    assert abs(mass / exact - 1.0) < (1.01 * shortage if order == 1 else shortage**2)
    assert np.allclose(center, 0.0, atol=1e-12)
    polar, transverse = inertia[1, 1], inertia[0, 0]
    assert polar == pytest.approx(0.5 * mass * (R**2 + r**2), rel=2.0 * shortage if order == 1 else shortage**2)
    assert transverse == pytest.approx(0.5 * polar + mass * width**2 / 12.0, rel=1e-9)  # axial symmetry, exact
