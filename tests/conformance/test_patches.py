"""Gradients from patches of quadratic cells: polynomials, rates, weights that stay small."""

from __future__ import annotations

from itertools import product

import numpy as np
import pytest
import scipy.sparse as sp
from element_meshes import lattice_mesh

from warpffrf.model.mesh import Mesh, box, roller
from warpffrf.model.mesh.elements import cell_kind
from warpffrf.offline.stress import patches
from warpffrf.offline.stress.patches import STEEP, Places, cell_places, node_places, patch_gradients

ROUND_OFF = 1e-11
FIT = 1e-8  # relative: least squares of 20 monomials by another algorithm
KINDS = ["hex8", "hex20", "hex27", "wedge15", "tet10"]


def block(kind: str, parts: int) -> Mesh:
    """A unit cube of straight-sided cells."""
    return lattice_mesh(kind, (parts, parts, parts), lambda s: s)


def error(mesh: Mesh, degree: int) -> float:
    """Of the gradient of x^d + ... at all nodes, of the largest."""
    x = mesh.points - mesh.points.mean(axis=0)
    direction = np.array([1.0, 0.7, -0.4])
    found = patch_gradients(mesh.points, mesh.cells, node_places(mesh.points, mesh.cells, np.arange(len(x))))
    exact = degree * (x @ direction)[:, None] ** (degree - 1) * direction
    return float(np.abs(np.stack([g @ (x @ direction) ** degree for g in found], axis=1) - exact).max() / degree)


@pytest.mark.parametrize("kind", KINDS)
def test_quadratic_fields_are_exact(kind: str) -> None:
    assert error(block(kind, 3), 2) < ROUND_OFF


def test_hexahedra_reproduce_cubic_fields() -> None:
    """Superconvergence: their gradient is not in the cells, and exact at the recovery points."""
    assert error(block("hex27", 3), 3) < ROUND_OFF


@pytest.mark.parametrize(
    ("kind", "rate"), [("hex8", 1.7), ("hex20", 2.4), ("hex27", 3.6), ("wedge15", 1.7), ("tet10", 1.2)]
)
def test_rates(kind: str, rate: float) -> None:
    """On the boundary too; of tetrahedra, with few cells at its edges, least."""
    coarse, fine = (error(block(kind, parts), 5) for parts in (4, 8))
    assert np.log2(coarse / fine) > rate


def warped(s: np.ndarray) -> np.ndarray:
    return s + 0.03 * np.sin(2.0 * s[:, [1, 2, 0]])


@pytest.mark.parametrize("kind", ["hex8", "hex27"])
def test_vertex_inside_by_hand(kind: str) -> None:
    """Weighted least squares by monomials: hex8 by cell means, the nearer the heavier; hex27 by its 2x2x2 points."""
    mesh = lattice_mesh(kind, (4, 4, 4), warped)
    x, cells = mesh.points, mesh.cells[kind]
    vertex = np.argmin(np.linalg.norm(x - warped(np.full((1, 3), 0.5)), axis=1))
    gauss = np.array(list(product((-1.0, 1.0), repeat=3))) / np.sqrt(3.0)
    around = cells if kind == "hex8" else cells[np.any(cells[:, :8] == vertex, axis=1)]
    N, dN = cell_kind(kind).shape(gauss)
    places = np.einsum("qa,eai->eqi", N, x[around])  # (cells, 8, 3)
    if kind == "hex8":
        dN = cell_kind(kind).shape(np.zeros((1, 3)))[1]
    else:
        places = places.reshape(-1, 1, 3)
    spread = (places - places.mean(axis=(0, 1))).reshape(-1, 3)
    monomials = [a for a in product(range(4), repeat=3) if sum(a) <= 3]
    A = np.stack([np.prod((places - x[vertex]) ** a, axis=-1).mean(axis=1) for a in monomials], axis=1)
    far = (places.mean(axis=1) - places.mean(axis=(0, 1))) @ np.linalg.inv(np.cov(spread.T, bias=True))
    weight = np.exp(-np.sum(far * (places.mean(axis=1) - places.mean(axis=(0, 1))), axis=1))
    if kind == "hex27":
        weight[:] = 1.0
    u = np.random.default_rng(3).standard_normal(len(x))
    J = np.einsum("eai,qaj->eqij", x[around], dN)
    samples = np.einsum("ea,qaj,eqji->eqi", u[around], dN, np.linalg.inv(J)).reshape(-1, 3)
    root = np.sqrt(weight)[:, None]
    (fitted, *_) = np.linalg.lstsq(root * A, root * samples, rcond=None)
    found = patch_gradients(x, mesh.cells, node_places(x, mesh.cells, np.array([vertex])))
    assert np.array([g @ u for g in found])[:, 0] == pytest.approx(fitted[0], rel=FIT)


def test_points_between_vertices_by_hand() -> None:
    """The polynomials of the corners, by the linear shape functions: along an edge a blend of its two ends."""
    mesh = block("hex27", 4)
    x, u = mesh.points, np.random.default_rng(4).standard_normal(len(mesh.points))
    cell = mesh.cells["hex27"][:1]
    at = np.array([[0.3, -0.2, 0.6]])
    found = patch_gradients(x, mesh.cells, cell_places(x, "hex27", cell, at))
    N = cell_kind("hex8").shape(at)[0][0]
    place = cell_kind("hex27").shape(at)[0] @ x[cell[0]]
    total = np.zeros(3)
    for share, vertex in zip(N, cell[0, :8], strict=True):
        own = Places(place, sp.csr_matrix(([1.0], ([0], [vertex])), shape=(1, len(x))))
        total += share * np.array([g @ u for g in patch_gradients(x, mesh.cells, own)])[:, 0]
    assert np.array([g @ u for g in found])[:, 0] == pytest.approx(total, rel=FIT)


def largest_weights(mesh: Mesh, monkeypatch: pytest.MonkeyPatch) -> float:
    """Largest sum of the sizes of the weights that values are made with."""
    sizes, weights = [], patches._Fit.weights

    def seen(self, which, x):
        found = weights(self, which, x)
        sizes.append(np.abs(found).sum(axis=1))
        return found

    monkeypatch.setattr(patches._Fit, "weights", seen)
    patch_gradients(mesh.points, mesh.cells, node_places(mesh.points, mesh.cells, np.arange(len(mesh.points))))
    return float(np.concatenate(sizes).max())


@pytest.mark.parametrize("parts", [1, 2, 4])
@pytest.mark.parametrize("kind", KINDS)
def test_values_are_no_differences_of_large_ones(kind: str, parts: int, monkeypatch: pytest.MonkeyPatch) -> None:
    """Hexahedra need no help for that; where cubes are cut, corners with few cells take the linear fit."""
    assert largest_weights(block(kind, parts), monkeypatch) <= (12.0 if kind.startswith("hex") else STEEP)


def test_nor_in_a_thin_ring(monkeypatch: pytest.MonkeyPatch) -> None:
    """Nearly plane, with one layer of cells."""
    thin = roller(0.05, 0.049, 0.02, sectors=48, layers=1, axial=1, order=2)
    assert largest_weights(thin, monkeypatch) < 12.0


def test_a_few_nodes_as_among_all() -> None:
    """Only cells near the wanted nodes are looked at."""
    mesh = box((1.0, 1.0, 1.0), (9, 3, 3), order=2)
    nodes = np.flatnonzero(np.linalg.norm(mesh.points - mesh.points[0], axis=1) < 0.4)
    few, every = (
        patch_gradients(mesh.points, mesh.cells, node_places(mesh.points, mesh.cells, n))
        for n in (nodes, np.arange(len(mesh.points)))
    )
    for a, b in zip(few, every, strict=True):
        assert abs(a - b[nodes]).max() < ROUND_OFF * abs(b).max()
