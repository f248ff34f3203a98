"""The reduced static response to any load in the span of the nodes equals a full finite-element solution.

The full model is assembled by scikit-fem's vector basis and solved as a dense saddle point, with the bore made rigid
by a dense constraint: nothing is shared with the reduction but the loads of the nodes.
"""

from __future__ import annotations

import numpy as np
import pytest
from offline_bodies import reduced
from reference_fe import free_response, matrices

from warpffrf.model.mesh.facets import rigid_modes
from warpffrf.offline.contact.contact_grid import facet_chart, nodal_plan
from warpffrf.offline.contact.node_loads import node_loads

EXACT = 1e-8  # what the product promises
SINGLE = 2e-6  # the display transfer is stored in single precision


@pytest.fixture(scope="module")
def full(small_roller, steel):
    """Responses (3 n, nodes) of the full model to all nodes of the rim, loads B, and the rigid bore's nodes."""
    K, M = matrices(small_roller, steel)
    points = small_roller.points
    bore = small_roller.facets("bore").node_set
    free = np.setdiff1d(np.arange(len(points)), bore)
    T = np.zeros((3 * len(points), 3 * len(free) + 6))
    T[(3 * free[:, None] + np.arange(3)).ravel(), np.arange(3 * len(free))] = 1.0
    T[(3 * bore[:, None] + np.arange(3)).ravel(), 3 * len(free) :] = rigid_modes(points[bore], np.zeros(3))
    R = np.zeros((T.shape[1], 6))
    R[: 3 * len(free)] = rigid_modes(points[free], np.zeros(3))
    R[3 * len(free) :] = np.eye(6)
    shape = reduced(small_roller).contact_surfaces["rim"].shape
    kind, nodes = small_roller.facets("rim").single
    chart = facet_chart(points, kind, nodes, shape)
    plan = nodal_plan(chart, "rim")
    assert plan is not None
    loads = node_loads(kind, nodes, chart, shape, plan)
    rows = len(plan.z)
    B = np.zeros((len(points), 3, plan.columns * rows))
    for d in range(3):
        np.add.at(B[:, d], (loads.node, loads.column % plan.columns * rows + loads.row), loads.value[:, d])
    B = B.reshape(3 * len(points), -1)
    u = T @ free_response(T.T @ K @ T, T.T @ M @ T, R, T.T @ B)
    return u, B, bore


@pytest.mark.parametrize("general", [False, True])
@pytest.mark.parametrize("modes", [0, 5, 50, 200])
def test_static_response_is_exact(small_roller, full, modes, general):
    u, B, bore = full
    body = reduced(small_roller, modes=modes, general=general)
    s = body.contact_surfaces["rim"]
    grid_nodes = s.grid.columns * s.grid.rows
    gram = np.kron(s.grid.gram_theta(), s.gram_z)
    pressures = np.random.default_rng(modes).standard_normal((grid_nodes, 3))
    pressures[:, 0] = np.eye(grid_nodes)[4]  # a single hat
    forces = gram @ pressures
    stiffness = (2.0 * np.pi * body.frequencies) ** 2
    assert len(body.frequencies) >= modes
    q = (s.mode_normal.T @ forces) / stiffness[:, None]
    normal = s.mode_normal @ q + s.compliance(np.arange(s.grid.columns)) @ forces
    expected = np.linalg.solve(gram, B.T @ (u @ pressures))
    assert np.abs(normal - expected).max() < EXACT * np.abs(expected).max()

    # the same on the skin, all three components (single precision)
    place = {tuple(np.round(x, 9)): i for i, x in enumerate(small_roller.points)}
    nodes = np.array([place[tuple(np.round(x, 9))] for x in body.surface.points])
    for j in range(3):
        skin = np.einsum("m,mnd->nd", q[:, j], body.surface.modes) + s.recover(forces[:, j].reshape(-1, s.grid.rows))
        exact = (u @ pressures[:, j]).reshape(-1, 3)[nodes]
        assert np.abs(skin - exact).max() < SINGLE * np.abs(exact).max()

    # the interface: its motion is that of the attachment modes alone, local modes do not move it
    moved = q.T @ body.interfaces["bore"].modes
    exact = np.linalg.lstsq(
        rigid_modes(small_roller.points[bore], np.zeros(3)),
        (u @ pressures).reshape(-1, 3, 3)[bore].reshape(-1, 3),
        rcond=None,
    )[0]
    assert np.abs(moved - exact.T).max() < 1e-10 * np.abs(u @ pressures).max() / 0.015  # rotations: times 1/bore radius


def test_frequencies_equal_the_full_model(small_roller, steel):
    import scipy.linalg as sla

    K, M = matrices(small_roller, steel)
    omega = np.sqrt(np.abs(sla.eigh(K, M, eigvals_only=True, subset_by_index=[0, 25])))
    body = reduced(small_roller, interfaces={}, modes=20)
    full = omega[6 : 6 + len(body.frequencies)] / (2.0 * np.pi)
    assert np.abs(body.frequencies / full - 1.0).max() < 1e-9
