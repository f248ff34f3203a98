"""Sampling points of a contact surface: positive weights, exact areas, optimal, and as accurate as asked for."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from offline_bodies import reduced
from scipy.optimize import nnls

from warpffrf.model.errors import InputError
from warpffrf.model.mesh import roller
from warpffrf.model.reduced.body import ReducedBody
from warpffrf.model.reduced.contact_surface import Sampling, gauss_points
from warpffrf.model.surfaces import CrownedCylinder
from warpffrf.offline.contact.cubature import (
    PAIR,
    Places,
    Problem,
    all_points,
    candidate_places,
    choose_sampling,
    families,
    nonnegative_least_squares,
    pivots,
    strip_areas,
)

ROUND_OFF = 1e-12  # of an area: sums of some ten weights
KKT = 1e-9  # gradient over the norms of column and right-hand side


@pytest.fixture(scope="module")
def rim():
    mesh = roller(0.05, 0.015, 0.02, sectors=90, layers=3, axial=4, order=1)
    return reduced(mesh).contact_surfaces["rim"]


@pytest.fixture(scope="module")
def crowned():
    mesh = roller(0.05, 0.015, 0.02, crown_radius=0.4, sectors=90, layers=3, axial=5, order=1)
    return reduced(mesh, contact={"rim": CrownedCylinder()}).contact_surfaces["rim"]


def row_weights(points, rows: int) -> np.ndarray:
    """Sum of the weights by row (rows,) [m^2]: a node of the row has twice half of it, so this is its area."""
    out = np.zeros(rows)
    np.add.at(out, points.row, points.weight * (1.0 - points.zeta))
    np.add.at(out, points.row + 1, points.weight * points.zeta)
    return out


@pytest.mark.parametrize("seeded", [False, True])
def test_least_squares_agree_with_scipy_and_are_optimal(seeded):
    rng = np.random.default_rng(3)
    for _ in range(5):
        A, b = rng.normal(size=(40, 25)), rng.normal(size=40)
        seed = [int(i) for i in pivots(A, 8)] if seeded else []
        c = nonnegative_least_squares(A, b, seed=seed)
        assert np.all(c >= 0.0)
        gradient = A.T @ (A @ c - b) / (np.linalg.norm(A, axis=0) * np.linalg.norm(b))
        assert np.abs(gradient[c > 0.0]).max() < KKT
        assert gradient[c == 0.0].min() > -KKT
        assert np.linalg.norm(A @ c - b) == pytest.approx(nnls(A, b)[1], rel=1e-10)


def test_an_early_stop_ends_at_the_first_set_that_is_good_enough():
    rng = np.random.default_rng(5)
    A = np.abs(rng.normal(size=(60, 30)))
    b = A @ np.abs(rng.normal(size=30))

    def residual(c):
        return float(np.linalg.norm(A @ c - b) / np.linalg.norm(b))

    counts = []
    for limit in (0.2, 0.1, 0.05, 0.01):
        c = nonnegative_least_squares(A, b, enough=lambda c, limit=limit: residual(c) <= limit)
        assert residual(c) <= limit and np.all(c >= 0.0)
        counts.append(np.count_nonzero(c))
    assert counts == sorted(counts) and counts[0] < counts[-1]


def test_pivots_are_the_columns_that_span_the_matrix():
    rng = np.random.default_rng(7)
    basis = rng.normal(size=(20, 4))
    A = np.column_stack([basis @ rng.normal(size=(4, 6)), basis * 10.0])
    assert len(pivots(A, 9)) == 4
    assert np.linalg.matrix_rank(A[:, pivots(A, 4)]) == 4


@pytest.mark.parametrize("surface", ["rim", "crowned"])
def test_weights_are_positive_and_areas_exact(surface, request):
    surface = request.getfixturevalue(surface)
    points = choose_sampling(surface, 0.05)
    rows, shape = surface.grid.rows, surface.shape
    assert np.all(points.weight > 0.0)
    z = np.linspace(surface.grid.z[0], surface.grid.z[-1], 20001)
    profile = shape.radius_at(z) * np.sqrt(1.0 + shape.slope_at(z) ** 2)
    area = surface.grid.pitch * np.trapezoid(profile, z)
    assert points.area == pytest.approx(area, rel=1e-8)  # the trapezoidal rule, an independent sum
    exact = surface.grid.pitch * np.asarray(surface.gram_z).sum(axis=1)
    assert points.area == pytest.approx(exact.sum(), rel=ROUND_OFF)
    np.testing.assert_allclose(row_weights(points, rows), exact, rtol=0.0, atol=ROUND_OFF * points.area)


def test_a_constant_pressure_has_its_resultant_and_its_moment(rim):
    """Hats sum to one, and a linear function of z is a sum of nodes: both are integrated exactly on a cylinder."""
    points = choose_sampling(rim, 0.1)
    z, rows = rim.grid.z, rim.grid.rows
    measure = rim.grid.pitch * rim.shape.radius
    share = row_weights(points, rows)
    assert share.sum() == pytest.approx(measure * (z[-1] - z[0]), rel=ROUND_OFF)
    assert share @ z == pytest.approx(0.5 * measure * (z[-1] ** 2 - z[0] ** 2), abs=ROUND_OFF * points.area * z[-1])


def test_more_points_for_a_smaller_error(rim):
    found = [choose_sampling(rim, error) for error in (0.2, 0.05, 0.01)]
    assert all(p.training_error <= p.wanted_error for p in found)
    assert all(p.mean_error <= p.training_error for p in found)
    errors, counts = [p.training_error for p in found], [p.count for p in found]
    assert errors == sorted(errors, reverse=True) and errors[-1] < errors[0]
    assert counts == sorted(counts) and counts[0] < counts[-1]
    assert 3 * counts[-1] <= len(gauss_points(rim.grid.rows, 3, 2)[0])  # a third of quadrature "full"


def test_the_training_error_is_that_of_the_points(rim):
    """The families again, at the chosen points alone."""
    points = choose_sampling(rim, 0.03)
    places = Places.of(rim, points.fraction, points.row, points.zeta)
    errors = [np.linalg.norm(f.values @ points.weight - f.target) for f in families(rim, places)]
    assert len(errors) == points.families
    assert max(errors) == pytest.approx(points.training_error, rel=1e-8)


def test_points_serve_patches_that_were_not_trained(rim):
    """Later patches of the sequence, whose sizes, places and skews are others."""
    points = choose_sampling(rim, 0.02, patches=24)
    places = Places.of(rim, points.fraction, points.row, points.zeta)
    other = [f for f in families(rim, places, 72) if f.name.startswith(("gap", "response"))][48:]
    assert len(other) == 96
    errors = [np.linalg.norm(f.values @ points.weight - f.target) for f in other]
    assert max(errors) < 2.0 * points.wanted_error  # not the promise of the training set, but near it


def test_chosen_weights_are_optimal_on_their_points(rim):
    """Of all weights with exact areas on these points none does better: the gradient is a sum of area rows."""
    problem = Problem.of(rim, candidate_places(rim, PAIR, PAIR), 24)
    share = problem.solve(0.02)
    assert share is not None
    at = np.flatnonzero(share)
    V = np.concatenate([v[:, at] for v in problem.values])
    t = np.concatenate([f.target for f in problem.trained])
    gradient = V.T @ (V @ share[at] - t)
    left = gradient - problem.E[:, at].T @ np.linalg.lstsq(problem.E[:, at].T, gradient, rcond=None)[0]
    assert np.abs(left).max() < 1e-8 * np.linalg.norm(V.T @ t)


def test_a_random_smooth_gap_is_integrated_as_well_as_by_all_points(rim):
    """Weak gaps of a plane wave many columns long: few points compared with 3 x 2 of every cell, both against a fine
    rule."""
    grid, k, q = rim.grid, 2.0 * np.pi / 9.0, 2.0 * np.pi / 0.03
    points = choose_sampling(rim, 0.01)

    def weak(x, row, zeta, weight):
        p = Places.of(rim, x, row, zeta)
        along = p.along(grid.rows)
        wave = [np.cos(k * (p.x + shift - 0.3) + q * p.z) for shift in (0, -1)]
        return along @ (weight * ((1.0 - p.x) * wave[0] + p.x * wave[1]))

    exact, fine = all_points(rim, 12, 12)
    true = weak(exact.x, exact.row, exact.zeta, fine)
    every, full = all_points(rim)
    size = np.abs(true).max()
    few = np.abs(weak(points.fraction, points.row, points.zeta, points.weight) - true).max() / size
    many = np.abs(weak(every.x, every.row, every.zeta, full) - true).max() / size
    assert many < 2e-3
    assert few < 1e-2


def test_a_body_keeps_its_points_in_its_file(tmp_path):
    mesh = roller(0.05, 0.015, 0.02, sectors=60, layers=2, axial=3, order=1)
    body = reduced(mesh, sampling_error=0.05)
    points = body.contact_surfaces["rim"].sampling
    assert points is not None
    again = ReducedBody.load(body.save(tmp_path / "body.h5")).contact_surfaces["rim"].sampling
    assert isinstance(again, Sampling)
    for name, array in points.arrays().items():
        np.testing.assert_array_equal(again.arrays()[name], array)
    assert (
        again.facts()
        == points.facts()
        == {key: body.report["contact"]["rim"]["sampling"][key] for key in points.facts()}
    )
    assert f"{points.count} points" in body.info()
    without = replace(body, contact_surfaces={"rim": replace(body.contact_surfaces["rim"], sampling=None)})
    assert without.content_hash() != body.content_hash()
    assert without.content_hash() == reduced(mesh).content_hash()


def test_what_cannot_be_is_refused(rim):
    with pytest.raises(InputError, match="fraction below 1"):
        reduced(roller(0.05, 0.015, 0.02, sectors=18, layers=2, axial=2, order=1), sampling_error=2.0)
    with pytest.raises(InputError, match="chosen for tractions on nodes"):
        reduced(roller(0.05, 0.015, 0.02, sectors=18, layers=2, axial=2, order=1), sampling_error=0.1, traction="cells")
    good = choose_sampling(rim, 0.2)
    with pytest.raises(InputError, match="positive"):
        replace(good, weight=-good.weight)
    with pytest.raises(InputError, match="fraction"):
        replace(good, fraction=good.fraction + 1.0)
    assert strip_areas(rim).sum() == pytest.approx(good.area, rel=ROUND_OFF)
