"""The sparse retained solve against a dense one: random systems on many graphs, and what it does when it fails."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest
import warp as wp
from zero_topics import given, zeros

from warpffrf.online.arrays.declaration import host_structs
from warpffrf.online.compile.retained_pattern import GROUND, RetainedPattern, find_pattern, on_device
from warpffrf.online.device import chosen_device
from warpffrf_kernels.core import control as k
from warpffrf_kernels.core.model import Model
from warpffrf_kernels.core.run import Run
from warpffrf_kernels.core.scalars import BLOCK
from warpffrf_kernels.core.scratch import RetainedSystem
from warpffrf_kernels.linear import retained_solve

DEVIATION = 1e-13  # of the solution, times the condition number: some hundred times round-off


def graphs() -> dict[str, list[tuple[int, int, int]]]:
    """Named joints (body, body, rows)."""
    ladder = [(GROUND, 0, 5), (GROUND, 1, 3)]
    for i in range(0, 8, 2):
        ladder += [(i, i + 2, 3), (i + 1, i + 3, 3), (i, i + 1, 1)]
    return {
        "free": [],
        "one": [(GROUND, 0, 6)],
        "chain": [(i - 1, i, 5 if i % 2 else 3) for i in range(12)],
        "star": [(GROUND, 0, 5), *[(i, 0, 5) for i in range(1, 12)]],
        "four bars": [(GROUND, 0, 5), (0, 1, 3), (1, 2, 4), (2, GROUND, 3)],
        "loop in the air": [(i, (i + 1) % 6, 3) for i in range(6)],
        "ladder": ladder,
        "two parts": [(0, 1, 5), (GROUND, 2, 3), (2, 3, 5)],
    }


def system(
    joints: list[tuple[int, int, int]], seed: int, modes: int = 0, flexible: bool = False
) -> tuple[RetainedPattern, np.ndarray]:
    """Pattern and a random matrix [[S, C^T], [C, -E]] on it, S unsymmetric with a positive definite symmetric part."""
    rng = np.random.default_rng(seed)
    bodies = 1 + max([b for joint in joints for b in joint[:2]], default=0)
    rows = np.array([(a, b) for a, b, count in joints for _ in range(count)]).reshape(-1, 2)
    dense = np.zeros(bodies, int)
    dense[::2] = modes
    ends = (rows != GROUND) & flexible
    pattern = find_pattern(bodies, dense, rows, ends)
    size, offset = pattern.retained_count, pattern.retained_count - len(rows)
    owner = np.concatenate([np.repeat(np.arange(bodies), 6), np.repeat(np.arange(bodies), dense)])
    A = np.zeros((size, size))
    for b in range(bodies):
        at = np.flatnonzero(owner == b)
        x = rng.standard_normal((len(at), len(at)))
        A[np.ix_(at, at)] = x @ x.T + len(at) * np.eye(len(at)) + 0.1 * x
    for r, pair in enumerate(rows):
        for b in pair[pair != GROUND]:
            at = np.flatnonzero(owner == b)
            A[offset + r, at] = A[at, offset + r] = rng.standard_normal(len(at))
    for a, b, _ in joints:  # geometric stiffness
        if GROUND not in (a, b):
            A[6 * a : 6 * a + 6, 6 * b : 6 * b + 6] += 0.05 * rng.standard_normal((6, 6))
    if flexible:
        for b in range(bodies):
            at = offset + np.flatnonzero((rows == b).any(axis=1))
            x = rng.standard_normal((len(at), 8))
            A[np.ix_(at, at)] -= 0.1 * x @ x.T
    return pattern, A


def solve(
    pattern: RetainedPattern, A: np.ndarray, b: np.ndarray, refresh: int = 1
) -> tuple[np.ndarray, np.ndarray, int]:
    """z, fallback words and failure bits of `solve_retained`."""
    size = pattern.retained_count
    m = Model()
    m.retained.count, m.retained.row_offset = (
        size,
        int(np.flatnonzero(np.diag(A) <= 0.0)[0]) if np.any(np.diag(A) <= 0) else size,
    )
    kept, patterns = on_device(pattern, chosen_device(None))
    ctl = host_structs(k.Control, 1)
    ctl["run"], ctl["moved"], ctl["refresh"] = 1, 1, refresh
    run: Any = Run()
    run.models, run.ctl = wp.array([m], dtype=Model), wp.array(ctl, dtype=k.Control)
    lines = BLOCK * pattern.widest
    retained = zeros(RetainedSystem, {"retained": size, "factor_number": pattern.factor_size, "factor_line": lines})
    retained.tangent = wp.array(A[None], dtype=wp.float64)
    inputs = [given(run, Run), given(retained, RetainedSystem), patterns, wp.array(b, dtype=wp.float64)]
    wp.launch_tiled(retained_solve.solve_retained, dim=(1,), block_dim=BLOCK, inputs=inputs)
    del kept
    words: Any = run.ctl.numpy()
    return retained.z.numpy(), retained.fallback.numpy()[0], int(words["failure"][0])


@pytest.mark.parametrize("modes, flexible", [(0, False), (0, True), (3, True)])
@pytest.mark.parametrize("name", graphs())
def test_agrees_with_a_dense_solve(name: str, modes: int, flexible: bool) -> None:
    for seed in range(3):
        pattern, A = system(graphs()[name], seed, modes, flexible)
        b = np.random.default_rng(seed + 100).standard_normal(len(A))
        z, fallback, failure = solve(pattern, A, b)
        exact = np.linalg.solve(A, b)
        assert failure == 0 and not fallback.any()
        assert np.abs(z - exact).max() < DEVIATION * np.linalg.cond(A) * np.abs(exact).max()


def test_pattern_holds_every_entry_once() -> None:
    for joints in graphs().values():
        pattern, A = system(joints, 0, modes=2, flexible=True)
        seen = np.zeros(A.shape, int)
        known = pattern.gather_line >= 0
        np.add.at(seen, (pattern.gather_line[known], pattern.gather_column[known]), 1)
        assert seen.max() == 1 and np.all(seen[A != 0.0] == 1)
        lines = np.repeat(np.arange(len(A)), np.diff(pattern.entry_start))
        assert np.array_equal(np.argwhere(seen), np.stack([lines, pattern.entry_column], axis=1))
        assert np.array_equal(np.sort(pattern.order), np.arange(len(A)))


def operations(pattern: RetainedPattern) -> int:
    """Multiplications of one factorisation, about: s^3/3 + s^2 w + s w^2 a node."""
    s, w = pattern.size.astype(np.int64), pattern.width.astype(np.int64)
    return int((s**3 // 3 + s**2 * w + s * w**2).sum())


def test_work_of_a_tree_grows_with_its_size() -> None:
    """Chain, star and comb of n bodies: the same work a body whatever n."""
    shapes = {
        "chain": lambda n: [(i - 1, i, 5) for i in range(n)],
        "star": lambda n: [(GROUND, 0, 5), *[(0, i, 5) for i in range(1, n)]],
        "comb": lambda n: [(i - 1 if i % 2 == 0 else i - 1, i, 5) for i in range(n)],
    }
    for shape in shapes.values():
        small, large = (operations(system(shape(n), 0)[0]) for n in (20, 80))
        assert large < 4.2 * small


def test_a_small_pivot_falls_back_on_the_dense_inverse_and_is_counted() -> None:
    """S of the first body is singular, the whole matrix is not: its joint holds what its inertia does not."""
    pattern, A = system(graphs()["chain"], 0)
    leaf = 6 * 11
    A[leaf, leaf : leaf + 6] = A[leaf : leaf + 6, leaf] = 0.0
    b = np.ones(len(A))
    z, fallback, failure = solve(pattern, A, b)
    assert failure == 0 and fallback.tolist() == [1, 1]
    assert np.allclose(z, np.linalg.solve(A, b), rtol=1e-9, atol=1e-9)


def test_a_singular_system_is_reported() -> None:
    pattern, A = system(graphs()["four bars"], 0)
    A[-1], A[:, -1] = A[-2], A[:, -2]
    A[-1, -1] = A[-2, -2]
    _, fallback, failure = solve(pattern, A, np.ones(len(A)))
    assert failure == int(k.SINGULAR) and fallback[1] == 1


@pytest.mark.parametrize("ratio", [1e3, 1e6, 1e10])
def test_a_light_body_between_heavy_ones_is_factored(ratio: float) -> None:
    """Rows that a light body holds give small pivots in which nothing cancels: no fallback, and digits are lost by how
    much more easily it gives way, as no pivot is sought outside a block."""
    pattern, A = system([(GROUND, 0, 5), (0, 1, 5)], 0)
    A[:6, :6] /= ratio
    A[:6, 6:12] = A[6:12, :6] = 0.0
    b = np.concatenate([np.zeros(6), np.ones(6), np.zeros(len(A) - 12)])
    z, fallback, failure = solve(pattern, A, b)
    exact = np.linalg.solve(A, b)
    assert failure == 0 and fallback.tolist() == [0, 0]
    assert np.abs(z - exact).max() < DEVIATION * (ratio + np.linalg.cond(A)) * np.abs(exact).max()


@pytest.mark.parametrize("ratio", [1e-8, 1e8])
def test_rows_that_depend_on_each_other_are_found_whatever_the_masses(ratio: float) -> None:
    pattern, A = system([(GROUND, 0, 5), (0, 1, 4), (0, 1, 1)], 0)
    A[:6, :6] *= ratio
    A[:6, 6:12] = A[6:12, :6] = 0.0
    A[-1], A[:, -1] = A[-2], A[:, -2]
    A[-1, -1] = A[-2, -2]
    assert solve(pattern, A, np.ones(len(A)))[2] == int(k.SINGULAR)
