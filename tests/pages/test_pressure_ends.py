"""The study of where a patch ends: its four ways to meet the law compared with closed forms, and compared with the
program."""

from __future__ import annotations

import numpy as np
import pytest

from studies.contact.evaluations import PAIR, layer_of, node_means, run_at_nodes, run_quadrature, scene_of, tread
from studies.contact.patch_ends import OnPatch, nodes_over
from studies.contact.pressing import WAYS, Pressing, active_set, in_cells
from studies.speed.step_time import RADIUS, WIDTH

APPROACH = 400e-6  # about three columns a half-width


@pytest.fixture(scope="module")
def small() -> Pressing:
    return Pressing(tread(30, sectors=480, layers=8, axial=2), 29)


def test_an_active_set_meets_its_conditions() -> None:
    rng = np.random.default_rng(3)
    root = rng.standard_normal((12, 12))
    A, b = root @ root.T + 3.0 * np.eye(12), rng.standard_normal(12)
    x = active_set(A, b)
    slack = A @ x + b
    assert 0 < np.count_nonzero(x) < 12
    assert x.min() >= 0.0 and slack.min() > -1e-12 and np.abs(x * slack).max() < 1e-12


def test_cells_hold_their_length_of_nodes() -> None:
    steps = np.array([1.0, 2.0, 0.5])
    B = in_cells(steps)
    edges = np.concatenate([[0.0], np.cumsum(steps) - 0.5 * steps, [steps.sum()]])
    np.testing.assert_allclose(B.sum(axis=0), np.diff(edges), rtol=1e-14)  # nodes sum to one
    grid_nodes = np.concatenate([[0.5], [1.5, 1.25], [0.25]])
    np.testing.assert_allclose(B.sum(axis=1), grid_nodes, rtol=1e-14)  # and cells cover the line
    fine = (np.arange(7000) + 0.5) / 2000.0
    values = np.interp(fine, np.concatenate([[0.0], np.cumsum(steps)]), [0.0, 1.0, 0.0, 0.0])
    inside = (fine > edges[2]) & (fine < edges[3])
    assert values[inside].sum() / 2000.0 == pytest.approx(B[1, 2], rel=1e-3)


@pytest.mark.parametrize("way", WAYS)
def test_a_layer_on_bodies_that_hardly_yield(way: str, small: Pressing) -> None:
    """p = k (delta - x^2/R) over the half-width sqrt(delta R): a force of 4/3 k delta b times the width."""
    k = 1e-7 * layer_of(small.body).stiffness
    b = np.sqrt(APPROACH * RADIUS)
    columns = b / (RADIUS * small.grid.pitch)
    force = getattr(small, f"by_{way}")(k, 0.3 * small.grid.pitch, APPROACH).sum()
    assert force == pytest.approx(4.0 / 3.0 * k * APPROACH * b * WIDTH, rel=1.0 / columns**2)


def test_each_way_meets_its_law(small: Pressing) -> None:
    k, center = layer_of(small.body).stiffness, 0.2 * small.grid.pitch
    found = {way: getattr(small, f"by_{way}")(k, center, APPROACH) for way in WAYS}
    peak = found["points"].max()
    nodes = np.repeat(small.gap(small.angle, center, APPROACH), small.grid.rows) + small.D @ found["nodes"]
    assert np.abs(found["nodes"] - k * small.area * np.maximum(-nodes, 0.0)).max() < 1e-9 * peak
    points = small.gap(small.at, center, APPROACH) + small.psi @ (small.D @ found["points"])
    law = small.psi.T @ (small.dA * k * np.maximum(-points, 0.0))
    assert np.abs(found["points"] - law).max() < 1e-9 * peak
    s = np.linalg.solve(small.M, found["hats"])
    weak = small.psi.T @ (small.dA * (small.gap(small.at, center, APPROACH) + small.psi @ (small.D @ found["hats"])))
    yields = weak + small.M @ s / k
    assert s.min() > -1e-9 * s.max()
    assert np.abs(yields[s > 1e-6 * s.max()]).max() < 1e-9 * np.abs(weak).max()
    for way in WAYS:
        again = small.forces(way, k, center, 2e4)
        assert again.sum() == pytest.approx(2e4, rel=1e-9)


@pytest.mark.slow
@pytest.mark.parametrize("way", ["hats", "nodes"])
def test_the_ways_are_those_of_the_program(way: str, small: Pressing) -> None:
    """At the force and the place that a run has; its axles bend the bores a little otherwise."""
    scene = scene_of(small.body, "full", APPROACH, 0.02, 5.0, 1e-4)
    result = run_at_nodes(scene, 1) if way == "nodes" else run_quadrature(scene, 1)
    contact = result.history.contacts[PAIR]
    load = float(np.linalg.norm(contact.force[0]))
    center = (float(contact.center_column[0]) - small.middle) * small.grid.pitch
    forces = small.forces(way, layer_of(small.body).stiffness, center, load)
    p = node_means(small.body, result, way == "nodes")[0][small.columns].ravel()
    assert np.count_nonzero(p) > 10
    assert small.norm(p - forces / small.area) < 0.01 * small.norm(p)


def test_nodes_over_intervals_are_their_integrals() -> None:
    lines, edges = np.array([0.0, 1.0, 3.0, 3.5]), np.array([-0.5, 0.2, 0.9, 1.7, 3.3, 4.0])
    A = nodes_over(lines, edges)
    n = 4000  # midpoints of each interval: the rule errs at the kinks only, by (interval/n)^2
    for i, (a, b) in enumerate(zip(edges[:-1], edges[1:], strict=True)):
        x = a + (b - a) * (np.arange(n) + 0.5) / n
        for j in range(len(lines)):
            grid_node = np.interp(x, lines, np.eye(len(lines))[j], left=0.0, right=0.0)
            assert A[j, i] == pytest.approx(grid_node.mean() * (b - a), abs=1e-3)
    covered = np.clip(edges[1:], 0.0, 3.5) - np.clip(edges[:-1], 0.0, 3.5)
    np.testing.assert_allclose(A.sum(axis=0), covered, atol=1e-14)  # nodes sum to one


@pytest.mark.slow
def test_cells_that_travel_carry_the_force_and_come_to_the_law() -> None:
    """Bodies that hardly yield: p = k (delta - x^2/R), whose force is 4/3 k delta b times the width."""
    pressing = Pressing(tread(30, sectors=480, layers=8, axial=2, contact_fixed=True), 29)
    k = 1e-7 * layer_of(pressing.body).stiffness
    b = np.sqrt(APPROACH * RADIUS)
    off = []
    for strips in (11, 41):
        force = OnPatch(pressing, strips).at(k, 0.3 * pressing.grid.pitch, APPROACH).sum()
        off.append(abs(force / (4.0 / 3.0 * k * APPROACH * b * WIDTH) - 1.0))
    assert off[0] < 0.6 / 11**2 and off[1] < 0.6 / 41**2  # the rule of docs/studies/patch_cells.md
