"""Gradients from patches of quadratic cells: polynomials, rates, weights that stay small."""

from __future__ import annotations

import numpy as np
import pytest

from warpffrf.model.mesh import Mesh, box, roller
from warpffrf.offline.stress import patches
from warpffrf.offline.stress.patches import STEEP, patch_gradients

ROUND_OFF = 1e-11
KINDS = ["hex20", "hex27", "wedge15", "tet10"]


def block(kind: str, parts: int) -> Mesh:
    """A unit cube of straight-sided cells; wedges and tetrahedra by cutting hexahedra."""
    return box((1.0, 1.0, 1.0), (parts, parts, parts), order=2) if kind == "hex27" else _cut(kind, parts)


def _cut(kind: str, parts: int) -> Mesh:
    from warpffrf.model.mesh.elements import cell_kind

    whole = box((1.0, 1.0, 1.0), (parts, parts, parts), order=2)
    (cells,) = whole.cells.values()
    places = np.rint(cell_kind("hex27").nodes * 1.0).astype(int)
    number = {tuple(p): i for i, p in enumerate(places)}
    shapes = {
        "hex20": [tuple(map(tuple, cell_kind("hex8").nodes.astype(int)))],
        "wedge15": [
            ((-1, -1, -1), (1, -1, -1), (1, 1, -1), (-1, -1, 1), (1, -1, 1), (1, 1, 1)),
            ((-1, -1, -1), (1, 1, -1), (-1, 1, -1), (-1, -1, 1), (1, 1, 1), (-1, 1, 1)),
        ],
        "tet10": [
            tuple(np.cumsum([(-1, -1, -1), *(2 * np.eye(3, dtype=int)[list(order)])], axis=0).tolist())
            for order in ((0, 1, 2), (1, 2, 0), (2, 0, 1))
        ]
        + [
            tuple(np.cumsum([(-1, -1, -1), *(2 * np.eye(3, dtype=int)[list(order)])], axis=0)[[0, 2, 1, 3]].tolist())
            for order in ((1, 0, 2), (0, 2, 1), (2, 1, 0))
        ],
    }[kind]
    own = cell_kind(kind)
    linear = cell_kind({20: "hex8", 15: "wedge6", 10: "tet4"}[len(own.nodes)]).shape(own.nodes)[0]
    blocks = [cells[:, [number[tuple(np.rint(p).astype(int))] for p in linear @ np.array(c)]] for c in shapes]
    merged = np.concatenate(blocks)
    used, where = np.unique(merged, return_inverse=True)
    return Mesh(whole.points[used], {kind: where.reshape(merged.shape)})


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


@pytest.mark.parametrize(
    "mesh",
    [block("tet10", 1), block("wedge15", 2), roller(0.05, 0.049, 0.02, sectors=48, layers=1, axial=1, order=2)],
    ids=["tetrahedra", "wedges", "thin ring"],
)
def test_values_are_no_differences_of_large_ones(mesh: Mesh, monkeypatch: pytest.MonkeyPatch) -> None:
    sizes = []
    weights = patches._Fit.weights

    def seen(self, which, x):
        found = weights(self, which, x)
        sizes.append(np.abs(found).sum(axis=1))
        return found

    monkeypatch.setattr(patches._Fit, "weights", seen)
    patch_gradients(mesh.points, mesh.cells, np.arange(len(mesh.points)))
    assert np.concatenate(sizes).max() < 2.0 * STEEP


def test_a_few_nodes_as_among_all() -> None:
    """Only cells near the wanted nodes are looked at."""
    mesh = box((1.0, 1.0, 1.0), (9, 3, 3), order=2)
    nodes = np.flatnonzero(np.linalg.norm(mesh.points - mesh.points[0], axis=1) < 0.4)
    few, every = (patch_gradients(mesh.points, mesh.cells, n) for n in (nodes, np.arange(len(mesh.points))))
    for a, b in zip(few, every, strict=True):
        assert abs(a - b[nodes]).max() < ROUND_OFF * abs(b).max()
