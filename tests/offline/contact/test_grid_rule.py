"""The rule for the spacing of a contact grid against states that the study did not look at, and what the study measures
with: compliances in closed form, Hertz's displacements, the contact on a grid."""

from __future__ import annotations

import numpy as np
import pytest
from scipy.integrate import quad
from scipy.optimize import nnls

from references.half_space.compliances import EllipsePatch, LinePatch, facing, plane_table, space_table, toeplitz
from studies.contact.contact_grid import DEPTH
from studies.contact.grid_errors import contact_pressures, grid_errors
from studies.contact.grid_on_roller import approach_for, press, pressed_roller
from warpffrf.model.errors import InputError
from warpffrf.model.reduced.contact_grid import KINDS
from warpffrf.offline.contact.contact_grid import (
    COARSEST,
    PATCHES,
    QUANTITIES,
    RULES,
    choose_spacing,
    contact_spacing,
    grid_error,
)

CASES = [(t, p) for t in KINDS for p in PATCHES]


def _states(patch, traction: str, low: float, high: float, count: int, seed: int) -> np.ndarray:
    """(n, 5) absolute errors at random b/s, positions and, with nodes, positions of the opposite grid."""
    random = np.random.default_rng(seed)
    dimension, found = len(patch.axes), []
    for _ in range(count):
        spacing = tuple(np.array(patch.axes) / random.uniform(low, high))
        position = tuple(random.uniform(-0.5, 0.5, dimension))
        paired = traction == "nodes" and random.random() < 0.5
        opposite = tuple(random.uniform(-0.5, 0.5, dimension)) if paired else None
        errors = np.abs(grid_errors(patch, traction, spacing, position, opposite))
        limit = [grid_error(spacing[0], 1.0, quantity=q, patch=_patch(patch), traction=traction) for q in QUANTITIES]
        found.append(errors / np.array(limit))
    return np.array(found)


def _patch(patch) -> str:
    return "line" if len(patch.axes) == 1 else "ellipse"


@pytest.mark.slow
@pytest.mark.parametrize(("traction", "patch"), CASES)
def test_no_state_exceeds_the_rule(traction: str, patch: str) -> None:
    """Sizes and positions drawn at random, and not far below it: the rule is the envelope, not a wild guess."""
    patches = [LinePatch(DEPTH)] if patch == "line" else [EllipsePatch(2.0), EllipsePatch(10.0)]
    for one in patches:
        for low, high in ((1.0, 2.0), (2.0, 4.0)):
            share = _states(one, traction, low, high, 40, seed=int(10 * low)).max(axis=0)
            assert np.all(share < 1.0), dict(zip(QUANTITIES, share, strict=True))
            assert np.all(share > 0.2), dict(zip(QUANTITIES, share, strict=True))


def test_errors_fall_at_the_rates_of_the_rule() -> None:
    """Line contact, worst of random states from b/s = 3 to 12: the slope is that of the rule within a quarter."""
    patch = LinePatch(DEPTH)
    for traction in KINDS:
        coarse, fine = (_states(patch, traction, n, 1.5 * n, 60, seed=3).max(axis=0) for n in (4.0, 12.0))
        slopes = np.log(coarse / fine) / np.log(3.0)  # beyond the rule's, whose limit is divided out
        assert np.all(np.abs(slopes) < 0.5), slopes


def test_centred_loads_promise_too_much() -> None:
    """Peak pressure of a line at four spacings in a half-width, on a node and between: the reason for the sweep."""
    patch = LinePatch(DEPTH)
    centred = abs(grid_errors(patch, "nodes", (0.25,), (0.0,)).peak_pressure)
    worst = max(abs(grid_errors(patch, "nodes", (0.25,), (x,)).peak_pressure) for x in np.linspace(0.0, 0.5, 5))
    assert worst > 2.0 * centred


def test_nodes_and_cells_are_made_of_finer_ones() -> None:
    """A coarse function is a sum of finer ones, in the plane and with unequal spacings in space."""
    tent = np.concatenate([np.arange(1, 10), np.arange(10, 0, -1)]) / 10.0
    fine = toeplitz(plane_table("nodes", 0.1, 19, DEPTH))
    assert tent @ fine @ tent == pytest.approx(plane_table("nodes", 1.0, 1, DEPTH)[0], rel=1e-10)
    weights = np.outer([0.5, 1.0, 0.5], tent).ravel()
    fine = toeplitz(space_table("nodes", (0.5, 0.1), (3, 19)))
    assert weights @ fine @ weights == pytest.approx(space_table("nodes", (1.0, 1.0), (1, 1))[0, 0], rel=1e-10)
    fine = toeplitz(space_table("cells", (1.0, 0.1), (1, 10)))
    assert fine.sum() == pytest.approx(space_table("cells", (1.0, 1.0), (1, 1))[0, 0], rel=1e-10)


def test_square_on_itself_and_far_away() -> None:
    """int int 1/r over a unit square twice is 4 ln(1 + sqrt 2) - 4 (sqrt 2 - 1)/3; far away a square is a point."""
    table = space_table("cells", (1.0, 1.0), (31, 31))
    root = np.sqrt(2.0)
    assert np.pi * table[0, 0] == pytest.approx(4.0 * np.log1p(root) - 4.0 / 3.0 * (root - 1.0), rel=1e-9)
    assert np.pi * table[30, 30] == pytest.approx(1.0 / np.hypot(30.0, 30.0), rel=1e-3)


def test_hertz_displacements() -> None:
    """Circle: Johnson (3.42), inside and out. Line: the integral of the pressure. Long ellipse: the line at its middle,
    up to a constant."""
    r = np.array([0.0, 0.4, 1.0, 1.3, 4.0])
    outside = np.maximum(r, 1.0)
    exact = np.where(
        r <= 1.0,
        np.pi / 4.0 * (2.0 - r**2),
        0.5 * ((2.0 - r**2) * np.arcsin(1.0 / outside) + outside * np.sqrt(1.0 - outside**-2)),
    )
    assert EllipsePatch(1.0).displacement(r, 0.0 * r) == pytest.approx(exact, rel=1e-12)

    line = LinePatch(DEPTH)
    for x in (0.3, 1.5):
        cuts = [x] if x < 1.0 else None
        direct = quad(lambda t, x=x: np.sqrt(1 - t**2) * np.log(abs(x - t) / DEPTH), -1.0, 1.0, points=cuts)[0]
        assert line.displacement(np.array(x)) == pytest.approx(-2.0 / np.pi * direct, rel=1e-7)
    x = np.array([0.0, 0.5, 1.0, 1.2])
    long = EllipsePatch(300.0).displacement(x, 0.0 * x)
    assert long - long[0] == pytest.approx(line.displacement(x) - line.displacement(x)[0], rel=1e-3)


@pytest.mark.parametrize("patch", [LinePatch(DEPTH), EllipsePatch(1.0), EllipsePatch(3.0)])
def test_hertz_energy_and_force_on_fine_cells(patch) -> None:
    """Energy of the closed form against Hertz's pressure on fine cells, whose own defect is a few 1e-4."""
    count = 300 if len(patch.axes) == 1 else 40
    spacing = tuple(2.0 * a / count for a in patch.axes)
    middles = [(np.arange(count) + 0.5) * s - a for s, a in zip(spacing, patch.axes, strict=True)]
    p = patch.pressure(*np.meshgrid(*middles, indexing="ij"))
    G = toeplitz(patch.table("cells", spacing, p.shape))
    assert p.sum() * np.prod(spacing) == pytest.approx(patch.force, rel=1e-3)
    assert p.ravel() @ G @ p.ravel() == pytest.approx(patch.energy, rel=1e-3)


def test_opposite_grid_sees_the_projection() -> None:
    """`facing` against the matrices written out: a' = l M^-1 G M^-1 l^T on grids long enough for the ends not to
    matter."""
    n, s, shift = 81, 0.3, 0.35
    G = toeplitz(plane_table("nodes", s, n, DEPTH))
    M = s * toeplitz(np.pad([2.0 / 3.0, 1.0 / 6.0], (0, n - 2)))
    away = np.subtract.outer(np.arange(n), np.arange(n)) + shift
    x, w = np.polynomial.legendre.leggauss(3)
    cuts = np.array([-1.0, shift - 1.0, 0.0, shift, 1.0])
    at = (cuts[:-1, None] + np.diff(cuts)[:, None] * 0.5 * (x + 1.0)).ravel()
    weight = (np.diff(cuts)[:, None] * 0.5 * w).ravel()

    def grid_node(t: np.ndarray) -> np.ndarray:
        return np.maximum(1.0 - np.abs(t), 0.0)

    cross = s * np.einsum("q,q,ijq->ij", weight, grid_node(at), grid_node(at - away[..., None]))
    seen = cross @ np.linalg.inv(M)
    whole = seen @ G @ seen.T
    kernel, reach = facing(shift), len(facing(shift)) // 2
    table = plane_table("nodes", s, 10 + reach, DEPTH)
    both = np.concatenate([table[:0:-1], table])
    mine = np.convolve(both, kernel, "same")[len(table) - 1 :][:5]
    assert mine == pytest.approx(whole[n // 2, n // 2 : n // 2 + 5], rel=1e-4)


def test_contact_on_a_grid_is_the_non_negative_minimum() -> None:
    """Active set against the non-negative least squares of the same quadratic form."""
    patch, s = EllipsePatch(2.0), 0.4
    x = [s * (np.arange(-n, n + 1) + 0.3) for n in (4, 7)]
    X, Y = np.meshgrid(*x, indexing="ij")
    G = toeplitz(patch.table("nodes", (s, s), X.shape))
    gap = s**2 * (patch.curvature[0] * X**2 + patch.curvature[1] * Y**2 - patch.approach).ravel()
    U = np.linalg.cholesky(G).T
    exact, _ = nnls(U, np.linalg.solve(U.T, -gap))
    assert contact_pressures(G, gap) == pytest.approx(exact, abs=1e-8)


def test_projection_against_a_fine_grid() -> None:
    """Compliance error against Hertz's pressure on nodes eight times finer, of which the coarse ones are made."""
    patch, fine, coarse = LinePatch(DEPTH), 1.0 / 64.0, 16
    k = np.arange(-6 * coarse, 6 * coarse + 1)
    G = toeplitz(plane_table("nodes", fine, len(k), DEPTH))
    p = patch.pressure(fine * k)
    middles = np.arange(-4, 5) * coarse  # those that reach the patch
    P = np.maximum(1.0 - np.abs(k[:, None] - middles) / coarse, 0.0)
    c = P.T @ G @ p
    expected = 1.0 - c @ np.linalg.solve(P.T @ G @ P, c) / (p @ G @ p)
    found = grid_errors(patch, "nodes", (coarse * fine,), (0.0,)).compliance
    assert found == pytest.approx(expected, rel=0.1)  # of 1e-4; the fine nodes miss a hundredth of it


@pytest.mark.slow
def test_rule_on_a_reduced_roller() -> None:
    """A mesh four times finer than the grid: the force at b/s = 2 is within the rule of the nodal grid's at b/s = 8,
    whatever the position, and not by accident. A deep roller: b is R/14."""
    nodes, per_half_width, ratio = 720, 8, 4
    size = 2.0 * np.pi * 0.05 / nodes
    b = per_half_width * size
    finest, body = (pressed_roller(nodes, s, cache=False) for s in (None, ratio * size))
    approach = approach_for(finest, b)
    exact = press(finest, 0.0, b, approach)
    assert exact.half_width == pytest.approx(b, rel=1e-3)
    forces = np.array([press(body, x * ratio * size, b, approach).force for x in (0.0, 0.25, 0.5)])
    worst, limit = np.abs(forces / exact.force - 1.0).max(), grid_error(ratio * size, b)
    assert limit is not None and 0.2 * limit < worst < limit


@pytest.mark.parametrize(("traction", "patch"), CASES)
@pytest.mark.parametrize("quantity", QUANTITIES)
def test_spacing_and_error_belong_together(traction: str, patch: str, quantity: str) -> None:
    names = {"quantity": quantity, "patch": patch, "traction": traction}
    for error in (1e-4, 1e-3, 5e-3):
        spacing = contact_spacing(2e-4, error=error, **names)
        assert 0.0 < spacing <= 2e-4 * COARSEST
        assert grid_error(spacing, 2e-4, **names) == pytest.approx(error, rel=1e-9)
    assert contact_spacing(4e-4, error=1e-3, **names) == pytest.approx(2.0 * contact_spacing(2e-4, error=1e-3, **names))


def test_no_grid_is_coarser_than_the_patch() -> None:
    assert contact_spacing(1e-3, error=0.9) == pytest.approx(COARSEST * 1e-3)
    assert grid_error(1e-3, 1e-3) == pytest.approx(RULES["nodes", "line"]["force"][0])
    assert grid_error(1.1e-3, 1e-3) is None


@pytest.mark.parametrize(
    ("arguments", "named"),
    [
        ({"half_width": 0.0}, "half_width"),
        ({"half_width": float("nan")}, "half_width"),
        ({"half_width": 1e-3, "error": 1.0}, "0.01"),
        ({"half_width": 1e-3, "error": -0.1}, "error"),
        ({"half_width": 1e-3, "quantity": "stress"}, "peak_pressure"),
        ({"half_width": 1e-3, "patch": "point"}, "ellipse"),
        ({"half_width": 1e-3, "traction": "spots"}, "cells"),
    ],
)
def test_bad_input_is_named(arguments: dict, named: str) -> None:
    with pytest.raises(InputError, match=named):
        contact_spacing(**arguments)


def test_choice_says_what_the_mesh_leaves() -> None:
    free = choose_spacing(1e-3, 1e-4)
    assert free.spacing == contact_spacing(1e-3) and not free.limited_by_mesh and free.warning("rim") is None
    assert free.error == pytest.approx(0.01)
    held = choose_spacing(1e-3, 8e-4)
    assert held.spacing == 8e-4 and held.limited_by_mesh and held.error == grid_error(8e-4, 1e-3)
    assert "'rim'" in (held.warning("rim") or "") and "refine" in (held.warning("rim") or "")
    lost = choose_spacing(1e-3, 3e-3)
    assert lost.error is None and "larger than the half-width" in (lost.warning("rim") or "")
    assert lost.facts()["limited_by_mesh"] is True
