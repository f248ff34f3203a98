"""Two solvers of an increment of contact with friction, written apart, against each other and by hand."""

from __future__ import annotations

import numpy as np
import pytest

from references.small_sliding import contact_program
from small_sliding_reference import OPEN, SLIP, STICK, solve_increment, violations
from warpffrf.model.errors import InputError

AGREE = 1e-9  # of the largest force: both meet the conditions to 1e-11, the flexibilities have conditions below 1e4


def flexibility(c: int, rng: np.random.Generator) -> np.ndarray:
    """As of a bending strip: what a cell does to another falls slowly, and directions are coupled."""
    X = rng.standard_normal((3 * c, 3 * c + 4))
    x = np.linspace(0.0, 1.0, c + 1)[1:]
    return 1e-9 * (np.kron(5.0 * np.minimum.outer(x, x), np.eye(3)) + 0.02 * (X @ X.T / (3 * c) + 1e-2 * np.eye(3 * c)))


@pytest.mark.parametrize("friction", [0.0, 0.2, 0.8])
@pytest.mark.parametrize("c", [1, 3, 12, 40])
def test_the_two_solvers_agree_through_a_history(c: int, friction: float) -> None:
    rng = np.random.default_rng(10 * c)
    G = flexibility(c, rng)
    E = 1e-11 * rng.random(3 * c)
    middle = rng.standard_normal((c, 3)) * [1.0, 0.5, 0.5] - [0.3, 0.0, 0.0]
    slip, slipped, seen = np.zeros((c, 2)), np.zeros((c, 2)), set()
    s = np.zeros((c, 3))
    for _ in range(6):
        b = 1e-5 * (middle + 0.3 * rng.standard_normal((c, 3)))
        step = solve_increment(G, b, friction, slip, E)
        assert step.violation < 1e-11
        shifted = b.copy()
        shifted[:, 1:] -= slipped
        found = contact_program.solve(G + np.diag(E), shifted, friction, s)
        s, slipped = found.force, slipped + found.motion[:, 1:]
        assert violations(G, b, friction, slip, E, s)["worst"] < 1e-10
        scale = max(np.abs(s).max(), 1e-300)
        assert np.abs(step.force.reshape(c, 3) - s).max() < AGREE * scale
        slip = step.slip
        assert np.abs(slip - slipped).max() < AGREE * 1e-5
        shut = step.force[::3] > AGREE * scale  # a cell at the very end of the patch may be called either
        if friction > 0.0:
            assert np.array_equal(found.state[shut], step.state[shut])
        assert found.dissipated >= -1e-15 * scale
        seen |= set(found.state[shut])
    if c >= 12 and friction > 0.0:
        assert {STICK, SLIP} <= seen


def test_the_interior_path_ends_where_newtons_method_does() -> None:
    rng = np.random.default_rng(4)
    for friction in (0.0, 0.3):
        G, b = flexibility(30, rng), 1e-5 * (rng.standard_normal((30, 3)) - [0.3, 0.0, 0.0])
        problem = contact_program._Scaled.of(G, b, np.full(30, friction))
        inner, steps = contact_program._follow(problem)
        exact = contact_program.solve(G, b, friction).force / problem.force
        assert steps < contact_program.PATH_STEPS
        # it holds the cohesion, which Newton's method removes
        assert np.abs(inner - exact).max() < 1e3 * contact_program.COHESION * np.abs(exact).max()


def test_one_cell_by_hand() -> None:
    G = np.diag([2.0, 4.0, 4.0])
    for solver in (lambda b: contact_program.solve(G, b, 0.5).force[0], lambda b: solve_increment(G, b, 0.5).force):
        assert solver(np.array([[1.0, 3.0, 0.0]])) == pytest.approx([0.0, 0.0, 0.0], abs=1e-12)  # apart
        assert solver(np.array([[-2.0, 0.6, -0.8]])) == pytest.approx([1.0, -0.15, 0.2], rel=1e-12)  # sticks
        assert solver(np.array([[-2.0, 3.0, -4.0]])) == pytest.approx([1.0, -0.3, 0.4], rel=1e-12)  # slips against it
    found = contact_program.solve(G, np.array([[-2.0, 3.0, -4.0]]), 0.5)
    assert list(found.state) == [SLIP] and found.dissipated == pytest.approx(0.5 * (5.0 - 2.0), rel=1e-12)
    assert list(contact_program.solve(G, np.array([[1.0, 3.0, 0.0]]), 0.5).state) == [OPEN]


def test_violations_are_seen() -> None:
    G, b = np.eye(6), np.array([-1.0, 0.3, 0.0, 1.0, 0.5, 0.0])
    right = solve_increment(G, b, 0.5).force
    assert violations(G, b, 0.5, None, None, right)["worst"] < 1e-14
    for wrong, name in (
        ([0.5, -0.25, 0, 0, 0, 0], "penetration"),
        ([1.0, -0.3, 0, -0.2, 0, 0], "tension"),
        ([1.0, -0.3, 0, 0.5, 0, 0], "complementarity"),
        ([1.0, -0.8, 0, 0, 0, 0], "cone"),
        ([1.0, -0.1, 0, 0, 0, 0], "slip inside the cone"),
        ([1.0, 0.0, 0.5, 0, 0, 0], "direction"),
        ([1.0, 0.5, 0, 0, 0, 0], "gained work"),
    ):
        assert violations(G, b, 0.5, None, None, np.array(wrong))[name] > 0.05


def test_bad_problems_are_refused() -> None:
    with pytest.raises(InputError, match="friction coefficient must not be negative"):
        contact_program.solve(np.eye(3), np.zeros((1, 3)), -0.1)
    with pytest.raises(InputError, match="flexibility"):
        contact_program.solve(np.eye(4), np.zeros((1, 3)), 0.1)
    with pytest.raises(InputError, match="every cell needs flexibility"):
        contact_program.solve(np.zeros((3, 3)), np.zeros((1, 3)), 0.1)
