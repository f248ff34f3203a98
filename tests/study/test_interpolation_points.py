"""DEIM and Q-DEIM beside what is proved of them."""

from __future__ import annotations

import numpy as np
import pytest

from studies.contact.interpolation_points import constant, deim, interpolation, qdeim, qdeim_bound

ROUND_OFF = 1e-11  # of sums of some ten numbers of size one, times constants c of about ten
WAYS = {"deim": deim, "qdeim": qdeim}


@pytest.fixture
def modes() -> np.ndarray:
    """Of 1/sqrt((x - mu)^2 + 0.1^2), the kind of function of the first DEIM paper: (100, 9)."""
    x, mu = np.linspace(-1.0, 1.0, 100), np.linspace(-1.0, 1.0, 51)
    U, _, _ = np.linalg.svd(1.0 / np.hypot(x[:, None] - mu, 0.1), full_matrices=False)
    return U[:, :9]


@pytest.mark.parametrize("way", WAYS)
def test_points_are_different_and_interpolate(way: str, modes: np.ndarray) -> None:
    points = WAYS[way](modes)
    assert len(set(points.tolist())) == modes.shape[1]
    f = np.random.default_rng(1).standard_normal(len(modes))
    np.testing.assert_allclose((interpolation(modes, points) @ f[points])[points], f[points], atol=ROUND_OFF)


@pytest.mark.parametrize("way", WAYS)
def test_what_the_modes_span_is_exact(way: str, modes: np.ndarray) -> None:
    points = WAYS[way](modes)
    f = modes @ np.random.default_rng(2).standard_normal(modes.shape[1])
    np.testing.assert_allclose(interpolation(modes, points) @ f[points], f, atol=ROUND_OFF)


@pytest.mark.parametrize("way", WAYS)
def test_the_error_keeps_its_bound(way: str, modes: np.ndarray) -> None:
    points = WAYS[way](modes)
    c, rng = constant(modes, points), np.random.default_rng(3)
    assert c >= 1.0
    for _ in range(20):
        f = rng.standard_normal(len(modes))
        best = np.linalg.norm(f - modes @ (modes.T @ f))
        assert np.linalg.norm(f - interpolation(modes, points) @ f[points]) <= c * best * (1.0 + ROUND_OFF)


def test_qdeim_keeps_its_bound_on_random_spaces() -> None:
    rng = np.random.default_rng(4)
    for n, m in ((20, 3), (60, 12), (200, 20)):
        for _ in range(10):
            U, _ = np.linalg.qr(rng.standard_normal((n, m)))
            assert constant(U, qdeim(U)) <= qdeim_bound(n, m)


def test_qdeim_depends_on_the_space_alone(modes: np.ndarray) -> None:
    turn, _ = np.linalg.qr(np.random.default_rng(5).standard_normal((9, 9)))
    assert set(qdeim(modes).tolist()) == set(qdeim(modes @ turn).tolist())


def test_deim_takes_the_first_points_by_hand() -> None:
    """u_1 is largest at point 2; what u_2 has beyond its part along u_1 there is largest at point 0."""
    U = np.array([[0.0, 0.8], [0.6, -0.48], [0.8, 0.36]])
    assert deim(U).tolist() == [2, 0]  # what is left of u_2: 0.8, -0.75, 0
    U[1, 1] = -0.7
    assert deim(U).tolist() == [2, 1]  # 0.8, -0.97, 0
