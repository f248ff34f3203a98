"""The device's solver of stick and slip against the convex program solved in NumPy."""

from __future__ import annotations

from collections.abc import Generator

import numpy as np
import pytest
import warp as wp
from zero_topics import given, zeros

from references.half_space.friction_program import residual, solve
from references.half_space.influence import mean_3d
from warpffrf.model.material import Material
from warpffrf.online.arrays.declaration import host_structs
from warpffrf.online.compile.retained_pattern import find_pattern, on_device
from warpffrf.online.device import chosen_device
from warpffrf_kernels.core import control as k
from warpffrf_kernels.core.contact_scratch import PatchScratch, RollingScratch
from warpffrf_kernels.core.friction_scratch import FrictionCells, FrictionSolve, SlipSpeedSolve, StripSolve
from warpffrf_kernels.core.model import Elements, Model
from warpffrf_kernels.core.run import Run
from warpffrf_kernels.core.scalars import BLOCK
from warpffrf_kernels.core.scratch import RetainedSystem
from warpffrf_kernels.rolling import traction_solve

SAME = 1e-10  # of the largest bound: the solution stops at 1e-11 of it, and the compliances' condition is below 100
SOLUTIONS = 4  # each reduces its first defect to 1e-3
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
    whole = D + L @ M @ L.transpose(0, 2, 1)
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
        "pair": P, "friction_pair": P, "block_pair": P, "block_cell": n, "speed_pair": P, "cell": n, "speed_cell": n,
        "coupled": N, "friction_retained": N,
        "speed_retained": N, "friction_factor": pattern.factor_size, "friction_line": BLOCK * pattern.widest,
    }  # fmt: skip
    run, slopes, cells = Run(), zeros(SlipSpeedSolve, sizes), zeros(FrictionSolve, sizes)
    elements = Elements()
    elements.slip_speeds.pieces = put(np.zeros(P), int)
    model.elements = wp.array([elements], dtype=Elements)
    run.models, run.ctl = wp.array([model], dtype=Model), wp.array(words, dtype=k.Control)
    slopes.speed_D, slopes.speed_L, slopes.speed_M = flat(D), flat(L), flat(M)
    slopes.speed_diagonal, slopes.speed_bordered = flat(blocks[..., [0, 0, 1], [0, 1, 1]]), put(np.linalg.inv(M)[None])
    slopes.speed_right, slopes.speed_tau = flat(right), flat(start)
    cells.cell_block = put(np.tile([0, n, 0], (1, P, 1)), int)
    soft = np.zeros(P * n) if softness is None else softness
    unused = [(zeros(topic, {}), topic) for topic in (FrictionCells, PatchScratch, RollingScratch)]
    topics = [
        (run, Run), (zeros(RetainedSystem, {}), RetainedSystem), *unused, (cells, FrictionSolve),
        (slopes, SlipSpeedSolve), (zeros(StripSolve, {}), StripSolve),
    ]  # fmt: skip
    inputs = [*(given(*topic) for topic in topics), patterns, flat(bound), flat(soft)]
    for _ in range(SOLUTIONS):
        wp.launch_tiled(traction_solve.solve_tractions, dim=(1,), block_dim=BLOCK, inputs=inputs)
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


RUNS, LENGTH = 120, 14  # of random rolling patches, and steps of each
STEEL = Material(210e9, 0.3, 7850.0)
PARTNERS = {
    "like": STEEL,
    "aluminium": Material(70e9, 0.33, 2700.0),
    "rubber": Material(1e7, 0.49, 1000.0),
    "rigid": None,
}
UNSETTLED = 1e-8  # of the largest bound, of the natural residual by the whole matrix


def rolling_steps(generator: np.random.Generator) -> Generator[tuple[np.ndarray, np.ndarray, np.ndarray], np.ndarray]:
    """K (2 n, 2 n), weak slips without tractions (2 n) and bounds (n) of the steps of a patch whose load, creepage,
    lateral creepage and spin vary; half of them on a body that is free to follow. The tractions found are sent."""
    columns, rows = ((8, 7), (13, 10))[generator.integers(2)]
    line = bool(generator.integers(2))
    size = (2.6 / columns, 20.0 / rows if line else 2.6 / rows)  # of the half-width
    x, z = (np.arange(columns) - 0.5 * (columns - 1)) * size[0], (np.arange(rows) - 0.5 * (rows - 1)) * size[1]
    centers = np.stack(np.meshgrid(x, z, indexing="ij"), axis=-1).reshape(-1, 2)
    partner = PARTNERS[list(PARTNERS)[generator.integers(4)]]
    K = mean_3d(centers, size, STEEL, partner)
    K = 0.5 * (K + K.T) / np.diag(K).mean()
    history = K.copy()
    if generator.integers(2):
        along = np.tile([1.0, 0.0], len(centers))
        K = K + 10.0 ** generator.uniform(0.0, 4.0) * np.outer(along, along)
    mu, way = generator.choice([0.05, 0.3, 1.0]), generator.choice([0.02, 0.1, 0.5, 1.0])  # way: columns a step
    harsh = generator.choice([0.1, 0.5])
    tau = np.zeros(2 * len(centers))
    for step in range(LENGTH):
        if step == LENGTH // 2:
            tau = np.zeros_like(tau)  # a cold start in between
        load, creep, side, spin = 1.0 + harsh * generator.normal(size=4)
        depth = load - centers[:, 0] ** 2 - (0.0 if line else 1.0) * centers[:, 1] ** 2
        bound = mu * np.sqrt(np.maximum(depth, 0.0))
        if not bound.any():
            continue
        e = (history @ tau).reshape(columns, rows, 2)
        before = (1.0 - way) * e + way * np.concatenate([e[1:], np.zeros_like(e[:1])])
        rigid = mu * way * size[0] * np.stack([creep - spin * centers[:, 1], 0.3 * side + spin * centers[:, 0]], axis=1)
        tau = yield K, rigid.ravel() - before.ravel(), bound


@pytest.mark.slow
def test_random_steps_of_rolling_patches_all_settle() -> None:
    generator = np.random.default_rng(5)
    worst, most, count = 0.0, 0, 0
    for _ in range(RUNS):
        steps, tau = rolling_steps(generator), None
        try:
            K, right, bound = next(steps)
            while True:
                start = np.zeros(len(right)) if tau is None else tau
                tau, words = device_solve(K, right, bound, start)
                assert words["failure"] == 0
                worst = max(worst, residual(K, right.reshape(-1, 2), bound, tau.reshape(-1, 2)))
                most, count = max(most, int(words["solves"])), count + 1
                K, right, bound = steps.send(tau)
        except StopIteration:
            pass
    print(f"{count} steps, residual {worst:.1e}, {most} systems at most")
    assert worst < UNSETTLED
