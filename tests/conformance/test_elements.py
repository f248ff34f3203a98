"""Every cell kind of the registry: patch test, zero-energy modes, mass, and the rate on a curved body."""

from __future__ import annotations

import numpy as np
import pytest
import scipy.linalg as sla
import scipy.sparse.linalg as spla
from element_meshes import STEEL, crooked_block, each_formulation, lattice_mesh, ring

from warpffrf.model.material import Material
from warpffrf.model.mesh import Mesh
from warpffrf.model.mesh.elements import CELL_KINDS, cell_kind
from warpffrf.model.mesh.facets import rigid_modes
from warpffrf.offline.fe import STIFFNESS_DEGREE, assemble, assign, rule

ROUND_OFF = 1e-11  # relative: sums of some hundred terms and one small solve
ZERO_ENERGY = 1e-10  # of shear modulus times size of the cell; the smallest elastic eigenvalue is about 1e-3 of it


def matrices(mesh: Mesh, material: Material = STEEL):
    K, M = assemble(mesh.points, mesh.cells, assign(mesh, material))
    return K.toarray(), M.toarray()


@each_formulation
def test_patch_of_crooked_cells_is_exact(kind: str, material: Material) -> None:
    """A linear displacement on the surface continues into the block exactly, whatever the cells inside."""
    mesh = crooked_block(kind).check()
    K, _ = matrices(mesh, material)
    gradient = np.random.default_rng(1).standard_normal((3, 3))
    exact = (mesh.points @ gradient.T + np.array([0.1, -0.2, 0.3])).ravel()
    outside = np.zeros(3 * len(mesh.points), dtype=bool)
    outside[(3 * mesh.outer_facets().node_set[:, None] + np.arange(3)).ravel()] = True
    inside = ~outside
    assert inside.any()
    u = np.linalg.solve(K[np.ix_(inside, inside)], -K[np.ix_(inside, outside)] @ exact[outside])
    assert np.abs(u - exact[inside]).max() < ROUND_OFF * np.abs(exact).max()
    # and the energy is that of the constant strain
    strain = 0.5 * (gradient + gradient.T)
    lam, mu = material.lame
    density = 0.5 * lam * np.trace(strain) ** 2 + mu * np.sum(strain**2)
    assert 0.5 * exact @ K @ exact == pytest.approx(density * mesh.volume(), rel=ROUND_OFF)
    assert mesh.volume() == pytest.approx(0.48, rel=ROUND_OFF)


@each_formulation
def test_one_cell_has_six_zero_energy_modes(kind: str, material: Material) -> None:
    """No hourglass modes: full integration leaves the rigid motions alone, and the shear of a mixed cell is full."""
    cell = cell_kind(kind)
    moved = cell.nodes + np.random.default_rng(2).uniform(-0.05, 0.05, cell.nodes.shape)
    mesh = Mesh(moved, {kind: np.arange(len(moved))[None]})
    K, _ = matrices(mesh, material)
    values = np.linalg.eigvalsh(K)
    shear = material.lame[1] * np.linalg.norm(np.ptp(moved, axis=0))  # what the volume resists is lambda/mu times that
    assert np.sum(np.abs(values) < ZERO_ENERGY * shear) == 6
    assert np.abs(K @ rigid_modes(mesh.points, np.zeros(3))).max() < ROUND_OFF * np.abs(K).max()


@pytest.mark.parametrize("kind", CELL_KINDS)
def test_mass_is_that_of_the_body_and_definite(kind: str) -> None:
    mesh = crooked_block(kind)
    _, M = matrices(mesh)
    rigid = rigid_modes(mesh.points, np.zeros(3))
    J = rigid.T @ M @ rigid
    mass = STEEL.density * 0.48
    assert J[:3, :3] == pytest.approx(mass * np.eye(3), abs=ROUND_OFF * mass)
    assert J[4, 2] == pytest.approx(-mass * 0.5, rel=1e-9)  # first moment: the centre lies at x = 0.5
    assert np.linalg.eigvalsh(M)[0] > 0.0


# Levels (cells around, radially, axially), each with half the edge of the one before.
LEVELS = {1: ((12, 2, 1), (24, 4, 2), (48, 8, 4)), 2: ((8, 1, 1), (16, 2, 1), (32, 4, 2))}
SLACK = 0.3  # orders: the coarse levels are not in the asymptotic range yet


@each_formulation
def test_strain_on_a_curved_body_converges_at_the_rate_of_the_element(kind: str, material: Material) -> None:
    """Lame's thick ring in plane strain, u_r = A r + B/r: the strain's error falls with h (linear) or h^2."""
    degree = cell_kind(kind).degree
    A, B = 1e-3, 5e-6

    def exact(x: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """Displacement (n, 3) and its gradient (n, 3, 3) at x (n, 3); the axis is z."""
        flat = x * np.array([1.0, 1.0, 0.0])
        r2 = np.sum(flat**2, axis=1)[:, None, None]
        plane = np.diag([1.0, 1.0, 0.0])
        return (A + B / r2[:, 0]) * flat, (A + B / r2) * plane - 2.0 * B * flat[:, :, None] * flat[:, None, :] / r2**2

    errors = []
    for level in LEVELS[degree]:
        mesh = ring(kind, *level)
        K = assemble(mesh.points, mesh.cells, assign(mesh, material))[0]
        u = exact(mesh.points)[0].ravel()
        fixed = np.zeros(len(u), dtype=bool)
        fixed[(3 * mesh.outer_facets().node_set[:, None] + np.arange(3)).ravel()] = True
        inner = np.flatnonzero(~fixed)
        if len(inner):
            u[inner] = spla.spsolve(K[inner][:, inner].tocsc(), -K[inner][:, np.flatnonzero(fixed)] @ u[fixed])
        nodes = mesh.cells[kind]
        r = rule(kind, STIFFNESS_DEGREE[kind])
        J = np.einsum("eai,qaj->eqij", mesh.points[nodes], r.gradients)
        slopes = np.einsum("qaj,eqji->eqai", r.gradients, np.linalg.inv(J))
        found = np.einsum("eqai,eac->eqci", slopes, u.reshape(-1, 3)[nodes])
        wanted = exact(np.einsum("qa,eai->eqi", r.values, mesh.points[nodes]).reshape(-1, 3))[1].reshape(found.shape)
        difference = found - wanted
        strain = 0.5 * (difference + difference.swapaxes(2, 3))
        errors.append(np.sqrt(np.sum(np.linalg.det(J) * r.weights * np.sum(strain**2, axis=(2, 3)))))
    rates = np.log2(np.array(errors[:-1]) / errors[1:])
    print(kind, errors, rates)
    assert rates[-1] > degree - SLACK


def test_frequencies_converge_with_mixed_kinds() -> None:
    """A body half of hexahedra, half of wedges, has the frequencies between those of either."""
    hexes, wedges = ring("hex8", 16, 2, 1), ring("wedge6", 16, 2, 1)
    # both lattices number their corners alike where the cells are taken in the same order: match by place
    order = np.lexsort(np.round(hexes.points, 9).T), np.lexsort(np.round(wedges.points, 9).T)
    number = np.empty(len(hexes.points), dtype=np.int64)
    number[order[1]] = order[0]
    half = len(hexes.cells["hex8"]) // 2
    mixed = Mesh(
        hexes.points, {"hex8": hexes.cells["hex8"][:half], "wedge6": number[wedges.cells["wedge6"][2 * half :]]}
    ).check()
    lowest = []
    for mesh in (hexes, mixed, wedges):
        K, M = matrices(mesh)
        lowest.append(np.sqrt(sla.eigh(K, M, eigvals_only=True, subset_by_index=[6, 6])[0]))
    assert mixed.volume() == pytest.approx(hexes.volume(), rel=1e-12)
    assert lowest[0] < lowest[1] < lowest[2]


@pytest.mark.parametrize("kind", CELL_KINDS)
def test_a_cut_leaves_two_faces_that_look_at_each_other(kind: str) -> None:
    block = lattice_mesh(kind, (4, 4, 2), lambda x: x)
    slit = block.cut("slit", point=(0.5, 0.5, 0.5), normal=(0, 0, 1), radius=0.6).check()
    assert len(slit.points) > len(block.points)
    assert slit.volume() == pytest.approx(block.volume(), rel=1e-14)
    areas = {name: facets.blocks for name, facets in slit.facet_sets.items()}
    total = {}
    for name, blocks in areas.items():
        corners = [slit.points[nodes[:, : 4 if facet[0] == "q" else 3]] for facet, nodes in blocks.items()]
        total[name] = sum(0.5 * np.cross(x[:, 2] - x[:, 0], x[:, -1] - x[:, 1]).sum(axis=0) for x in corners)
    assert total["slit_low"][2] > 0.5  # twelve of the sixteen squares, a sixteenth each
    np.testing.assert_allclose(total["slit_low"], -np.asarray(total["slit_high"]), atol=1e-15)
