"""Every cell kind: a linear displacement has the constant stress of Hooke's law at nodes, in cells and between two
materials."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from element_meshes import STEEL, crooked_block, each_formulation, ring

from warpffrf.model.errors import InputError
from warpffrf.model.material import Material
from warpffrf.model.mesh import Mesh
from warpffrf.model.mesh.elements import CELL_KINDS, cell_kind, facet_kind
from warpffrf.model.reduced.stress_field import StressPoints, from_tensor
from warpffrf.offline.fe import assign
from warpffrf.offline.stress.plan import StressPlan
from warpffrf.offline.stress.point_location import locate

BRASS = Material(100e9, 0.35, 8500.0)
ROUND_OFF = 1e-11  # relative: sums of some hundred terms
GRADIENT = np.random.default_rng(1).standard_normal((3, 3))
INNER = np.random.default_rng(2).uniform(0.02, 0.98, (30, 3)) * np.array([1.0, 0.8, 0.6])


def hooke(material: Material) -> np.ndarray:
    """The constant stress (6,) of the displacement GRADIENT x."""
    lam, mu = material.lame
    e = 0.5 * (GRADIENT + GRADIENT.T)
    return from_tensor(lam * np.trace(e) * np.eye(3) + 2.0 * mu * e)


def stresses(mesh: Mesh, material, wanted) -> np.ndarray:
    plan = StressPlan(mesh, assign(mesh, material), "here", wanted)
    return (plan.operator() @ (mesh.points @ GRADIENT.T).ravel()).reshape(-1, 6)


def edge_point(mesh: Mesh, nodes: np.ndarray) -> np.ndarray:
    """A point (1, 3) that is no node, on a straight edge whose two corners are among `nodes`."""
    ((kind, cells),) = mesh.cells.items()
    for facet, faces in cell_kind(kind).faces.items():
        for corners in cells[:, faces[:, : facet_kind(facet).corner_count]].reshape(-1, facet_kind(facet).corner_count):
            if np.isin(corners[:2], nodes).all():
                return 0.7 * mesh.points[corners[:1]] + 0.3 * mesh.points[corners[1:2]]
    raise ValueError("no edge")


@each_formulation
@pytest.mark.parametrize("wanted", ["all", "skin", "points"])
def test_patch(kind: str, material: Material, wanted: str) -> None:
    mesh = crooked_block(kind)
    found = stresses(mesh, material, INNER if wanted == "points" else wanted)
    assert np.abs(found - hooke(material)).max() < ROUND_OFF * sum(material.lame)


@pytest.mark.parametrize("kind", ["wedge6", "tet4"])
def test_nodes_of_cells_without_patches_have_the_mean_of_their_cells(kind: str) -> None:
    """Of tet4 the gradient is constant, of wedge6 that in the middle of the triangle, linear along the axis."""
    mesh = crooked_block(kind)
    (cells,) = mesh.cells.values()
    u = np.random.default_rng(6).standard_normal(mesh.points.shape)
    found = (StressPlan(mesh, assign(mesh, STEEL), "here", "all").operator() @ u.ravel()).reshape(-1, 6)
    lam, mu = STEEL.lame
    total, count = np.zeros((len(mesh.points), 3, 3)), np.zeros(len(mesh.points))
    for nodes in cells:
        for a, xi in zip(nodes, cell_kind(kind).nodes, strict=True):
            points = [np.full((1, 3), 0.25)] if kind == "tet4" else gauss_ends()
            gradients = []
            for point in points:
                dN = cell_kind(kind).shape(point)[1][0]
                gradients.append(u[nodes].T @ dN @ np.linalg.inv(mesh.points[nodes].T @ dN))
            low, high = gradients[0], gradients[-1]
            g = low if kind == "tet4" else 0.5 * (low + high) + 0.5 * np.sqrt(3.0) * xi[2] * (high - low)
            e = 0.5 * (g + g.T)
            total[a] += lam * np.trace(e) * np.eye(3) + 2.0 * mu * e
            count[a] += 1
    by_hand = from_tensor(total / count[:, None, None])
    assert np.abs(found - by_hand).max() < ROUND_OFF * np.abs(by_hand).max()


def gauss_ends() -> list[np.ndarray]:
    return [np.array([[1.0 / 3.0, 1.0 / 3.0, z]]) for z in (-1.0 / np.sqrt(3.0), 1.0 / np.sqrt(3.0))]


@pytest.mark.parametrize("kind", CELL_KINDS)
def test_located_points_map_back(kind: str) -> None:
    mesh = crooked_block(kind)
    found = locate(INNER, mesh.points, mesh.cells, "here")
    N, _ = cell_kind(kind).shape(found.xi)
    image = np.einsum("ea,eai->ei", N, mesh.points[mesh.cells[kind][found.cell]])
    assert np.abs(image - INNER[found.point]).max() < 1e-12
    assert np.array_equal(np.unique(found.point), np.arange(len(INNER)))
    assert not found.moved.any()


@pytest.mark.parametrize("kind", [k for k in CELL_KINDS if cell_kind(k).degree == 2])
def test_points_in_the_bulge_of_curved_cells_are_found(kind: str) -> None:
    """Eight cells around: their outer edges reach 7.6 mm beyond the straight line between the corners."""
    mesh = ring(kind, 8, 1, 1)
    angle = np.random.default_rng(4).uniform(0.0, 2.0 * np.pi, 60)
    r = np.tile([0.0605, 0.08, 0.0995], 20)
    points = np.stack([r * np.sin(angle), r * np.cos(angle), np.linspace(0.0, 0.04, 60)], axis=1)
    found = locate(points, mesh.points, mesh.cells, "here")
    assert np.array_equal(np.unique(found.point), np.arange(60))
    assert not found.moved.any()


@pytest.mark.parametrize("kind", CELL_KINDS)
def test_two_materials_are_not_averaged(kind: str) -> None:
    """Cells of each half keep their own stress; on the interface it is the mean, or that of the named side."""
    mesh = crooked_block(kind)
    ((_, cells),) = mesh.cells.items()
    left = np.flatnonzero(mesh.points[cells].mean(axis=1)[:, 0] < 0.5)
    right = np.setdiff1d(np.arange(len(cells)), left)
    mesh = replace(mesh, cell_sets={"left": left, "right": right})
    both = {"left": STEEL, "right": BRASS}
    shared = np.intersect1d(cells[left], cells[right])
    found = stresses(mesh, both, "all")
    in_left = np.setdiff1d(cells[left], shared)
    in_right = np.setdiff1d(cells[right], shared)
    E = STEEL.youngs_modulus
    assert np.abs(found[in_left] - hooke(STEEL)).max() < ROUND_OFF * E
    assert np.abs(found[in_right] - hooke(BRASS)).max() < ROUND_OFF * E
    mean = 0.5 * (hooke(STEEL) + hooke(BRASS))
    assert np.abs(found[shared] - mean).max() < ROUND_OFF * E
    on_edge = edge_point(mesh, shared)
    assert np.abs(stresses(mesh, both, on_edge) - mean).max() < ROUND_OFF * E
    for side, material in both.items():
        found = stresses(mesh, both, StressPoints("skin", side))
        assert np.abs(found - hooke(material)).max() < ROUND_OFF * E


def test_points_outside_are_refused_with_their_distance() -> None:
    mesh = crooked_block("hex20")
    with pytest.raises(InputError, match=r"stress 'here': 1 of 2 points lie outside .* number 1 .* 0\.50\d* m from"):
        stresses(mesh, STEEL, np.array([[0.5, 0.4, 0.3], [1.5, 0.4, 0.3]]))
    with pytest.raises(InputError, match="facet set 'rim' does not exist; known: 'skin', 'all'"):
        stresses(mesh, STEEL, "rim")
    with pytest.raises(InputError, match="cell set 'hub' does not exist"):
        stresses(mesh, STEEL, StressPoints(INNER, "hub"))
    with pytest.raises(InputError, match="there are no points"):
        stresses(mesh, STEEL, np.zeros((0, 3)))
