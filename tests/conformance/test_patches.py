"""Gradients from patches of quadratic cells: polynomials, rates, weights that stay small."""

from __future__ import annotations

import numpy as np
import pytest
from element_meshes import lattice_mesh

from warpffrf.model.mesh import Mesh, box, roller
from warpffrf.offline.stress import patches
from warpffrf.offline.stress.patches import STEEP, patch_gradients

ROUND_OFF = 1e-11
KINDS = ["hex20", "hex27", "wedge15", "tet10"]


def block(kind: str, parts: int) -> Mesh:
    """A unit cube of straight-sided cells."""
    return lattice_mesh(kind, (parts, parts, parts), lambda s: s)


def error(mesh: Mesh, degree: int) -> float:
    """Of the gradient of x^d + ... at all nodes, of the largest."""
    x = mesh.points - mesh.points.mean(axis=0)
    direction = np.array([1.0, 0.7, -0.4])
    found = patch_gradients(mesh.points, mesh.cells, np.arange(len(x)))
    exact = degree * (x @ direction)[:, None] ** (degree - 1) * direction
    return float(np.abs(np.stack([g @ (x @ direction) ** degree for g in found], axis=1) - exact).max() / degree)


@pytest.mark.parametrize("kind", KINDS)
def test_quadratic_fields_are_exact(kind: str) -> None:
    assert error(block(kind, 3), 2) < ROUND_OFF


def test_hexahedra_reproduce_cubic_fields() -> None:
    """Superconvergence: their gradient is not in the cells, and exact at the recovery points."""
    assert error(block("hex27", 3), 3) < ROUND_OFF


@pytest.mark.parametrize(("kind", "rate"), [("hex20", 2.4), ("hex27", 3.6), ("wedge15", 1.7), ("tet10", 1.2)])
def test_rates(kind: str, rate: float) -> None:
    """On the boundary too; of tetrahedra, with few cells at its edges, least."""
    coarse, fine = (error(block(kind, parts), 5) for parts in (4, 8))
    assert np.log2(coarse / fine) > rate


def largest_weights(mesh: Mesh, monkeypatch: pytest.MonkeyPatch) -> float:
    """Largest sum of the sizes of the weights that values are made with."""
    sizes, weights = [], patches._Fit.weights

    def seen(self, which, x):
        found = weights(self, which, x)
        sizes.append(np.abs(found).sum(axis=1))
        return found

    monkeypatch.setattr(patches._Fit, "weights", seen)
    patch_gradients(mesh.points, mesh.cells, np.arange(len(mesh.points)))
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
    few, every = (patch_gradients(mesh.points, mesh.cells, n) for n in (nodes, np.arange(len(mesh.points))))
    for a, b in zip(few, every, strict=True):
        assert abs(a - b[nodes]).max() < ROUND_OFF * abs(b).max()
