"""The reference of the friction law: optimality, uniqueness, influence coefficients against quadrature."""

from __future__ import annotations

import numpy as np
import pytest
from scipy.integrate import quad

from references.half_space.friction_program import project, residual, solve, sweep
from references.half_space.influence import coupling_2d, coupling_3d, influence_2d, influence_3d, normal_3d
from warpffrf.model.errors import InputError
from warpffrf.model.material import Material

STEEL = Material(210e9, 0.3, 7800.0)
SOFT = Material(3e9, 0.1, 1000.0)
SQUARE = np.stack(np.meshgrid(np.arange(4.0), np.arange(4.0), indexing="ij"), axis=-1).reshape(-1, 2)


@pytest.fixture(params=["plane", "space"])
def program(request: pytest.FixtureRequest) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Compliance, free slip and bounds of cells of which some stick and some slip."""
    rng = np.random.default_rng(3)
    if request.param == "plane":
        G, n, d = influence_2d(24, 0.1, 1.0, 10.0), 24, 1
    else:
        G, n, d = influence_3d(SQUARE, (1.0, 1.0), Material(1.0, 0.3, 1.0)), 16, 2
    drive = G @ rng.normal(size=n * d)
    bound = np.abs(rng.normal(size=n))
    bound[2] = 0.0
    return G, drive.reshape(n, d), bound


def test_solution_obeys_coulomb(program: tuple[np.ndarray, np.ndarray, np.ndarray]) -> None:
    G, s0, bound = program
    tau = solve(G, s0, bound)
    s = (G @ tau.ravel()).reshape(tau.shape) + s0
    size, speed = np.linalg.norm(tau, axis=1), np.linalg.norm(s, axis=1)
    scale = np.abs(s0).max()
    sticks = size < bound * (1.0 - 1e-9)
    assert 0 < sticks.sum() < len(bound) - 1
    assert np.all(size <= bound * (1.0 + 1e-12)) and tau[2].tolist() == [0.0] * tau.shape[1]
    assert speed[sticks].max() < 1e-11 * scale
    slips = ~sticks & (bound > 0.0)
    against = np.einsum("id,id->i", tau[slips], s[slips])
    assert np.allclose(against, -bound[slips] * speed[slips], rtol=1e-9, atol=1e-11 * scale)
    assert residual(G, s0, bound, tau) < 1e-12


def test_every_start_and_plain_sweeps_find_the_same(program: tuple[np.ndarray, np.ndarray, np.ndarray]) -> None:
    G, s0, bound = program
    tau = solve(G, s0, bound)
    other = solve(G, s0, bound, start=10.0 * np.random.default_rng(0).normal(size=tau.shape))
    swept = sweep(G, s0, bound, np.zeros_like(tau), 2000)
    assert np.allclose(other, tau, atol=1e-12 * bound.max())
    assert np.allclose(swept, tau, atol=1e-9 * bound.max())


def test_solution_is_the_least_of_the_program(program: tuple[np.ndarray, np.ndarray, np.ndarray]) -> None:
    G, s0, bound = program
    tau = solve(G, s0, bound)
    rng = np.random.default_rng(1)

    def value(t: np.ndarray) -> float:
        return float(0.5 * t.ravel() @ G @ t.ravel() + s0.ravel() @ t.ravel())

    for size in (1e-3, 1e-1, 1.0):
        for _ in range(20):
            assert value(project(tau + size * rng.normal(size=tau.shape), bound)) >= value(tau) - 1e-13


def test_bad_input_is_refused() -> None:
    G = influence_2d(3, 1.0, 1.0, 10.0)
    with pytest.raises(InputError, match="negative"):
        solve(G, np.zeros(3), np.array([1.0, -1.0, 1.0]))
    with pytest.raises(InputError, match="shape"):
        solve(G, np.zeros(3), np.ones(4))
    assert solve(G, np.ones(3), np.zeros(3)).tolist() == [0.0, 0.0, 0.0]


def test_strips_follow_the_half_plane() -> None:
    """Against adaptive quadrature of the kernel."""
    width, modulus, depth = 0.3, 2.0, 7.0
    G = influence_2d(5, width, modulus, depth)
    for k in range(5):
        x = k * width
        edges = (-0.5 * width, 0.5 * width)
        value = quad(lambda t: np.log(abs(x - t) / depth), *edges, points=[0.0] if k == 0 else None)[0]  # noqa: B023
        assert G[0, k] == pytest.approx(-2.0 / (np.pi * modulus) * value, rel=1e-9)
    assert np.linalg.eigvalsh(G).min() > 0.0


def _over_cell(kernel, center: tuple[float, float], size: tuple[float, float]) -> float:
    """Gauss quadrature of kernel(X, Y) over a cell away from the origin."""
    g, w = np.polynomial.legendre.leggauss(24)
    X = center[0] + 0.5 * size[0] * g[:, None]
    Y = center[1] + 0.5 * size[1] * g[None]
    return float(0.25 * size[0] * size[1] * np.einsum("i,j,ij->", w, w, kernel(X, Y)))


def test_cells_follow_the_half_space() -> None:
    """Far cells against Gauss quadrature of Cerruti's and Boussinesq's kernels; the cell itself in polar ones."""
    centers, size = SQUARE * [0.2, 0.3], (0.2, 0.3)
    G = influence_3d(centers, size, STEEL, SOFT).reshape(16, 2, 16, 2)
    N, K = normal_3d(centers, size, 5.0), coupling_3d(centers, size, STEEL, SOFT).reshape(16, 16, 2)
    for i, j in ((0, 5), (15, 2), (3, 12)):
        d = tuple(centers[i] - centers[j])
        parts = np.zeros((2, 2))
        for m in (STEEL, SOFT):
            nu, scale = m.poisson_ratio, 2.0 * np.pi * m.lame[1]
            for a in range(2):
                for b in range(2):
                    same = float(a == b) * (1.0 - nu)

                    def kernel(X, Y, same=same, a=a, b=b, nu=nu):
                        r = np.hypot(X, Y)
                        return same / r + nu * (X, Y)[a] * (X, Y)[b] / r**3

                    parts[a, b] += _over_cell(kernel, d, size) / scale
        assert np.allclose(G[i, :, j], parts, rtol=1e-7, atol=1e-7 * parts.max())
        assert N[i, j] == pytest.approx(
            _over_cell(lambda X, Y: 1.0 / np.hypot(X, Y), d, size) / (np.pi * 5.0), rel=1e-7
        )
        for a in range(2):
            value = _over_cell(lambda X, Y, a=a: (X, Y)[a] / (X**2 + Y**2), d, size)
            k = [(1.0 - 2.0 * m.poisson_ratio) / (4.0 * np.pi * m.lame[1]) for m in (STEEL, SOFT)]
            assert K[i, j, a] == pytest.approx((k[0] - k[1]) * value, rel=1e-7)
    x, y = 0.5 * size[0], 0.5 * size[1]

    def radial(t: float) -> float:
        """int dr over the ray at the angle t from the centre to the rim of the cell."""
        return min(x / max(np.cos(t), 1e-300), y / max(np.sin(t), 1e-300))

    own = 4.0 * quad(radial, 0.0, np.pi / 2.0, points=[np.arctan2(y, x)])[0]
    assert N[0, 0] == pytest.approx(own / (np.pi * 5.0), rel=1e-8)
    flat = G.reshape(32, 32)
    assert np.allclose(flat, flat.T, rtol=0.0, atol=1e-14 * flat.max()) and np.linalg.eigvalsh(flat).min() > 0.0


def test_coupling_vanishes_for_like_bodies_and_turns_its_sign_with_their_order() -> None:
    assert not coupling_2d(4, 0.1, STEEL, STEEL).any() and not coupling_3d(SQUARE, (1.0, 1.0), SOFT, SOFT).any()
    K = coupling_2d(4, 0.1, STEEL, SOFT)
    assert np.array_equal(K, -coupling_2d(4, 0.1, SOFT, STEEL)) and np.array_equal(K, -K.T)
    alone = coupling_2d(2, 0.1, STEEL)[1, 0]  # traction to the left pushes the surface on its right inwards
    assert alone == pytest.approx(0.1 * 0.4 * 1.3 / (2.0 * 210e9), rel=1e-12)
