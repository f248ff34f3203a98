"""The device's solver of stick and slip against the convex program solved in NumPy."""

from __future__ import annotations

import numpy as np
import pytest
import warp as wp
from zero_topics import given, zeros

from references.half_space.friction_program import residual, solve
from warpffrf.online.arrays.declaration import host_structs
from warpffrf.online.compile.retained_pattern import find_pattern, on_device
from warpffrf.online.device import chosen_device
from warpffrf_kernels.core import control as k
from warpffrf_kernels.core.friction_scratch import FrictionSolve, SlipSpeedSolve
from warpffrf_kernels.core.model import Model
from warpffrf_kernels.core.run import Run
from warpffrf_kernels.core.scalars import BLOCK
from warpffrf_kernels.core.scratch import RetainedSystem
from warpffrf_kernels.friction import stick_slip_solve

SAME = 1e-10  # of the largest bound: both stop at 1e-12 of it, and the compliances' condition is below 100
STIFF = 1e-8  # of the same, where one motion common to all raises the condition to 1e7


def compliance(count: int, generator: np.random.Generator) -> np.ndarray:
    """Two directions of a smooth decay with distance, coupled, positive definite."""
    x = np.arange(count)
    decay = np.exp(-0.3 * np.abs(x[:, None] - x[None]))
    coupled = np.array([[1.0, 0.2], [0.2, 0.8]])
    noise = generator.normal(size=(2 * count, 2 * count))
    return np.kron(decay, coupled) + 1e-3 * noise @ noise.T


def device_solve(D, right, bound, start, softness=None, L=None, M=None) -> tuple[np.ndarray, np.ndarray]:
    """Tractions and control words after one solve on the device, of pairs with a block of D (pairs, 2 cells, 2 cells)
    and lines of L (pairs, 2 cells, 6) each over the coordinates of one body, and its receptance M (6, 6)."""
    D, bound = np.atleast_3d(np.asarray(D, float).T).T, np.atleast_2d(bound)
    P, n, N = *bound.shape, 6
    M = np.eye(N) if M is None else np.asarray(M, float)
    L = np.zeros((P, 2 * n, N)) if L is None else np.asarray(L, float)
    V = L @ M
    whole = D + V @ L.transpose(0, 2, 1)
    blocks = np.stack([whole[:, 2 * i : 2 * i + 2, 2 * i : 2 * i + 2] for i in range(n)], axis=1)
    model = Model()
    model.capacity.cells, model.pairs.count, model.pairs.coupled_capacity = n, P, N
    model.retained.count = model.retained.row_offset = N

    def put(values, kind: type = float) -> wp.array:
        return wp.array(np.asarray(values, kind), dtype=wp.float64 if kind is float else wp.int32)

    def flat(values) -> wp.array:
        return put(np.ravel(values))

    kept = put(np.full(P, N), int), put(np.tile(np.arange(N), (P, 1)), int)
    model.pairs.coupled_count, model.pairs.coupled = kept
    words = host_structs(k.Control, 1)
    words["run"] = 1
    pattern = find_pattern(1, np.zeros(1, int), np.zeros((0, 2), int), np.zeros((0, 2), bool))
    owner, patterns = on_device(pattern, chosen_device(None))
    sizes = {
        "pair": P, "friction_pair": P, "block_pair": P, "speed_pair": P, "cell": n, "speed_cell": n, "coupled": N,
        "friction_retained": N,
        "speed_retained": N, "friction_factor": pattern.factor_size, "friction_line": BLOCK * pattern.widest,
    }  # fmt: skip
    run, slopes, cells = Run(), zeros(SlipSpeedSolve, sizes), zeros(FrictionSolve, sizes)
    run.models, run.ctl = wp.array([model], dtype=Model), wp.array(words, dtype=k.Control)
    slopes.speed_D, slopes.speed_L, slopes.speed_M, slopes.speed_V = flat(D), flat(L), flat(M), flat(V)
    slopes.speed_diagonal, slopes.speed_bordered = flat(blocks[..., [0, 0, 1], [0, 1, 1]]), put(np.linalg.inv(M)[None])
    slopes.speed_right, slopes.speed_tau = flat(right), flat(start)
    cells.cell_block = put(np.tile([0, n, 0], (1, P, 1)), int)
    soft = np.zeros(P * n) if softness is None else softness
    topics = [(run, Run), (slopes, SlipSpeedSolve), (zeros(RetainedSystem, {}), RetainedSystem), (cells, FrictionSolve)]
    inputs = [*(given(*topic) for topic in topics), patterns, flat(bound), flat(soft)]
    wp.launch_tiled(stick_slip_solve.solve_tractions, dim=(1,), block_dim=BLOCK, inputs=inputs)
    del kept, owner
    return slopes.speed_tau.numpy().copy(), run.ctl.numpy()[0].copy()


@pytest.mark.parametrize("seed", range(6))
@pytest.mark.parametrize("load", [0.05, 1.0, 30.0], ids=["mostly stick", "mixed", "mostly slip"])
def test_stick_and_slip_equal_the_convex_program(seed: int, load: float) -> None:
    generator = np.random.default_rng(seed)
    count = 24
    K = compliance(count, generator)
    right = load * generator.normal(size=2 * count)
    bound = generator.uniform(0.2, 1.5, count)
    bound[generator.integers(0, count, 3)] = 0.0  # cells that have lost their pressure
    tau, words = device_solve(K, right, bound, generator.normal(size=2 * count))
    loaded = np.repeat(bound > 0.0, 2)
    exact = solve(K[np.ix_(loaded, loaded)], right[loaded].reshape(-1, 2), bound[bound > 0.0]).ravel()
    assert words["failure"] == 0
    np.testing.assert_allclose(tau[loaded], exact, atol=SAME * bound.max(), rtol=0.0)
    assert np.all(tau[~loaded] == 0.0)
    kept = tau[loaded].reshape(-1, 2)
    found = residual(K[np.ix_(loaded, loaded)], right[loaded].reshape(-1, 2), bound[bound > 0.0], kept)
    assert found < SAME
    slip = (K @ tau + right).reshape(-1, 2)
    assert np.all(np.sum(tau.reshape(-1, 2) * slip, axis=1) < SAME * bound.max())  # friction takes energy only


@pytest.mark.parametrize("seed", range(4))
@pytest.mark.parametrize("common", [30.0, 1e3, 1e5])
def test_tractions_that_all_move_a_free_body(seed: int, common: float) -> None:
    """Newton goes to and fro there, all cells sliding one way, then the other; the interior-point method does not."""
    generator = np.random.default_rng(seed)
    count = 24
    along = np.tile([1.0, 0.0], count)
    K = compliance(count, generator) + common * np.outer(along, along)
    right, bound = 2.0 * generator.normal(size=2 * count), generator.uniform(0.2, 1.5, count)
    tau, words = device_solve(K, right, bound, -np.repeat(bound, 2) * along)
    assert words["failure"] == 0 and words["solves"] < 80
    exact = solve(K, right.reshape(-1, 2), bound).ravel()
    np.testing.assert_allclose(tau, exact, atol=STIFF * bound.max(), rtol=0.0)
    stick = np.hypot(*tau.reshape(-1, 2).T) < (1.0 - STIFF) * bound
    assert 0 < stick.sum() < count


@pytest.mark.parametrize("seed", range(4))
@pytest.mark.parametrize("common", [0.3, 30.0, 1e4])
def test_pairs_that_move_the_same_bodies(seed: int, common: float) -> None:
    """Three pairs, each with a block of its own, coupled by the motion of a body alone: the whole matrix is the
    sum."""
    generator = np.random.default_rng(seed)
    pairs, count, columns = 3, 8, 6
    D = np.array([compliance(count, generator) for _ in range(pairs)])
    L = generator.normal(size=(pairs, 2 * count, columns))
    root = generator.normal(size=(columns, columns))
    M = common * (root @ root.T + 0.1 * np.eye(columns))
    all_L = L.reshape(-1, columns)
    K = all_L @ M @ all_L.T
    for p in range(pairs):
        K[2 * count * p : 2 * count * (p + 1), 2 * count * p : 2 * count * (p + 1)] += D[p]
    right, bound = 2.0 * generator.normal(size=2 * pairs * count), generator.uniform(0.2, 1.5, (pairs, count))
    tau, words = device_solve(D, right, bound, generator.normal(size=2 * pairs * count), L=L, M=M)
    assert words["failure"] == 0
    exact = solve(K, right.reshape(-1, 2), bound.ravel()).ravel()
    np.testing.assert_allclose(tau, exact, atol=STIFF * bound.max(), rtol=0.0)


def test_a_warm_start_needs_no_factorisation_of_a_solved_problem() -> None:
    generator = np.random.default_rng(1)
    K, right, bound = compliance(20, generator), generator.normal(size=40), generator.uniform(0.5, 1.0, 20)
    tau, first = device_solve(K, right, bound, np.zeros(40))
    again, second = device_solve(K, right, bound, tau)
    assert first["solves"] > 0 and second["solves"] == 0
    np.testing.assert_array_equal(again, tau)


def test_softness_is_one_more_compliance_of_each_cell() -> None:
    """The regularised law: K + diag(softness) with the same bounds."""
    generator = np.random.default_rng(2)
    K, right, bound = compliance(16, generator), 2.0 * generator.normal(size=32), generator.uniform(0.5, 1.0, 16)
    softness = generator.uniform(0.1, 2.0, 16)
    tau, words = device_solve(K, right, bound, np.zeros(32), softness)
    exact = solve(K + np.diag(np.repeat(softness, 2)), right.reshape(-1, 2), bound).ravel()
    assert words["failure"] == 0
    np.testing.assert_allclose(tau, exact, atol=SAME, rtol=0.0)


def test_an_indefinite_compliance_is_a_failure_of_the_step() -> None:
    K = -np.eye(8)
    _, words = device_solve(K, 0.1 * np.ones(8), np.ones(4), np.zeros(8))
    assert words["failure"] & int(k.INDEFINITE)
