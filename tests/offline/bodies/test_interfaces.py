"""Rigid, averaging and free interfaces: invariants, an independent least-squares fit, closed forms, bad input."""

from __future__ import annotations

import numpy as np
import pytest
from interface_bodies import box, free_body, two_bearing_roller
from offline_bodies import STEEL

from warpffrf.model.errors import InputError
from warpffrf.model.mesh import FacetSet, Mesh
from warpffrf.model.mesh.elements import facet_kind
from warpffrf.model.mesh.facets import rigid_modes
from warpffrf.offline.fe import rule
from warpffrf.offline.interfaces import (
    INTERFACE_KINDS,
    MOST_FREE_NODES,
    AverageInterface,
    InterfaceSystem,
    body_interfaces,
    require_spread,
)

BAR = (0.02, 0.03, 0.1)


@pytest.fixture(scope="module")
def roller_mesh() -> Mesh:
    return two_bearing_roller()


def test_registry_names_its_classes():
    assert all(cls.kind == kind for kind, cls in INTERFACE_KINDS.items())


@pytest.mark.parametrize("left", INTERFACE_KINDS)
@pytest.mark.parametrize("right", INTERFACE_KINDS)
def test_rigid_motion_is_found_exactly(roller_mesh, left, right):
    """Rigid motions are in the constrained model, strain nothing, and move every interface as they say."""
    model, system = free_body(roller_mesh, {"left": left, "right": right})
    center = np.array([0.01, -0.02, 0.03])
    R = system.rigid(center)
    assert np.allclose(system.T @ R, rigid_modes(roller_mesh.points, center), atol=1e-15)
    assert np.abs(model.K @ R).max() < 1e-13 * np.abs(model.K).max()
    for interface, motion in zip(system.interfaces, system.motions(R), strict=True):
        exact = np.concatenate([rigid_modes(interface.point[None], center), np.eye(3, 6, 3)])
        assert np.allclose(motion.T, exact, atol=1e-12)
    assert system.coordinates.shape == (system.size, 3)
    assert np.isnan(system.coordinates).sum() == 18 * [left, right].count("rigid")


@pytest.mark.parametrize("left", INTERFACE_KINDS)
def test_loads_are_conjugate_to_the_coordinates(roller_mesh, left):
    """Work of the six forces and moments = F^T u: of the unit loads themselves, or of their combination by S."""
    _, system = free_body(roller_mesh, {"left": left, "right": "rigid"})
    u = np.random.default_rng(0).standard_normal((system.size, 4))
    motion = system.motions(u)[0].T
    first = system.interfaces[0]
    F = system.loads[:, :-6]
    if left == "free":
        assert isinstance(first, AverageInterface)
        F = F @ first.S.T
    assert np.allclose(F.T @ u, motion, rtol=1e-12)
    # a unit force or moment has itself as resultant about the point, and no other
    assert np.allclose(system.rigid(first.point).T @ F, np.eye(6), atol=1e-12)


@pytest.mark.parametrize("order", [1, 2])
def test_average_is_the_least_squares_fit_over_the_area(order):
    """Against samples of the interpolated displacement at many points of every facet, weighted by their area."""
    mesh = two_bearing_roller(order)
    found = body_interfaces(mesh, {"left": "average"})[0]
    assert isinstance(found, AverageInterface)
    u = np.random.default_rng(1).standard_normal((len(found.nodes), 3))
    field = np.zeros((len(mesh.points), 3))
    field[found.nodes] = u
    rows, values, weights = [], [], []
    for kind, nodes in mesh.facets("left").blocks.items():
        r = rule(kind, 11)
        x = mesh.points[nodes]
        tangents = np.einsum("mki,qkd->mqdi", x, r.gradients)
        area = np.linalg.norm(np.cross(tangents[:, :, 0], tangents[:, :, 1]), axis=2) * r.weights
        rows.append(np.einsum("qk,mki->mqi", r.values, x).reshape(-1, 3))
        values.append(np.einsum("qk,mki->mqi", r.values, field[nodes]).reshape(-1, 3))
        weights.append(area.ravel())
    w = np.repeat(np.sqrt(np.concatenate(weights)), 3)
    X = rigid_modes(np.concatenate(rows), found.point)
    exact = np.linalg.lstsq(w[:, None] * X, w * np.concatenate(values).ravel(), rcond=None)[0]
    # curved facets: the area of theirs is not polynomial, two rules differ by what they miss of it
    assert np.allclose(found.S @ u.ravel(), exact, atol=(1e-10 if order == 1 else 1e-5) * np.abs(exact).max())


def test_force_on_an_average_interface_is_a_uniform_traction():
    mesh = box((3, 2, 2), BAR)
    found = body_interfaces(mesh, {"high": "average"})[0]
    assert isinstance(found, AverageInterface)
    nodes = mesh.facets("high").blocks["quad4"]
    share = np.bincount(nodes.ravel(), minlength=len(mesh.points))[found.nodes] / (4.0 * len(nodes))
    expected = np.zeros((len(found.nodes), 3))
    expected[:, 2] = share
    assert np.allclose(found.S[2].reshape(-1, 3), expected, atol=1e-12)
    assert np.allclose(found.point, [0.01, 0.015, 0.1])


def test_bar_pulled_at_average_interfaces():
    """Uniform stress is in the space of any mesh: the ends part by F L/(E A), Poisson contraction and all."""
    model, system = free_body(box((3, 2, 5), BAR), {"low": "average", "high": "average"})
    pull = system.loads[:, [8]] - system.loads[:, [2]]
    low, high = system.motions(model.flexibility(pull))
    assert high[0, 2] - low[0, 2] == pytest.approx(BAR[2] / (STEEL.youngs_modulus * BAR[0] * BAR[1]), rel=1e-10)
    # one that keeps its ends from contracting is stiffer
    model, system = free_body(box((3, 2, 5), BAR), {"low": "rigid", "high": "rigid"})
    pull = system.loads[:, [8]] - system.loads[:, [2]]
    stiff_low, stiff_high = system.motions(model.flexibility(pull))
    assert 0.9 < (stiff_high[0, 2] - stiff_low[0, 2]) / (high[0, 2] - low[0, 2]) < 1.0 - 1e-3


def test_products_carry_the_nodes_of_free_interfaces(roller_mesh):
    _, system = free_body(roller_mesh, {"left": "free", "right": "average", "ends": "average"})  # ends overlap right
    Phi = np.random.default_rng(2).standard_normal((system.size, 5))
    product = system.products(Phi)
    assert [i.kind for i in product.values()] == ["free", "average", "average"]
    nodes = roller_mesh.facets("left").node_set
    free = product["left"]
    assert free.nodes is not None and free.node_modes is not None
    assert np.array_equal(free.nodes, roller_mesh.points[nodes])
    assert np.array_equal(free.node_modes, Phi.T.reshape(5, -1, 3)[:, nodes])
    assert product["right"].nodes is None and product["right"].node_modes is None
    assert all(i.modes.shape == (5, 6) for i in product.values())


def test_coordinates_from_nodal_displacements(roller_mesh):
    _, system = free_body(roller_mesh, {"left": "rigid", "right": "average"})
    u = np.random.default_rng(3).standard_normal((system.size, 3))
    assert np.allclose(system.from_nodes(system.T @ u), u, atol=1e-10)


def test_no_interfaces(roller_mesh):
    system = InterfaceSystem(roller_mesh.points, [])
    assert system.loads.shape == (3 * len(roller_mesh.points), 0) and system.pinned is None
    assert system.products(np.zeros((system.size, 2))) == {}


# --- bad input ---


@pytest.mark.parametrize(
    "kinds, message",
    [
        ({"left": "welded"}, "interface 'left': kind 'welded' does not exist; known: 'rigid', 'average', 'free'"),
        ({"hub": "rigid"}, "'hub' does not exist"),
        ({"left": "rigid", "bore": "rigid"}, "'left' and 'bore' share 24 nodes.*separate the sets"),
        ({"left": "average", "bore": "rigid"}, "'left' and 'bore' share 24 nodes"),
        ({"left": "rigid", "ends": "free"}, "share 12 nodes"),
    ],
)
def test_bad_interfaces_are_named(roller_mesh, kinds, message):
    with pytest.raises(InputError, match=message):
        body_interfaces(roller_mesh, kinds)


@pytest.mark.parametrize("kind", INTERFACE_KINDS)
def test_too_few_or_collinear_nodes(kind):
    mesh = box((1, 1, 2), BAR)
    edge = Mesh(mesh.points, mesh.cells, {"edge": FacetSet({"quad4": np.array([[0, 1, 1, 0]])})})
    with pytest.raises(InputError, match="interface 'edge': at least three nodes.*has 2; choose"):
        body_interfaces(edge, {"edge": kind})
    line = np.outer(np.arange(5.0), [1.0, 2.0, 3.0])
    with pytest.raises(InputError, match="5 on a line"):
        require_spread(line, "edge")
    require_spread(line + 1e-3 * np.eye(5, 3), "edge")


def test_free_interface_is_capped():
    side = int(np.sqrt(MOST_FREE_NODES)) + 1
    mesh = box((side, side, 1), BAR)
    with pytest.raises(InputError, match=f"'high'.*{(side + 1) ** 2} nodes.*at most {MOST_FREE_NODES}.*'average'"):
        body_interfaces(mesh, {"high": "free"})


def test_every_facet_kind_has_a_definite_mass():
    """What the averaging fit rests on: no facet kind gives a node a zero or negative weight in the fit."""
    for kind in ("quad4", "quad8", "quad9", "tri3", "tri6"):
        r = rule(kind, 7)
        W = np.einsum("qa,qb,q->ab", r.values, r.values, r.weights)
        assert np.linalg.eigvalsh(W)[0] > 1e-3 * np.linalg.eigvalsh(W)[-1]
        assert len(W) == len(facet_kind(kind).nodes)
