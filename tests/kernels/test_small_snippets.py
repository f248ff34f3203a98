"""axpy, dot, the elimination of a pair and the inverse of the native snippets against NumPy, on arrays of their own."""

# Warp kernels confuse it
# pyright: reportInvalidTypeForm=false, reportAssignmentType=false, reportGeneralTypeIssues=false
from __future__ import annotations

import numpy as np
import pytest
import warp as wp

from warpffrf.online.compile.retained_pattern import find_pattern, on_device
from warpffrf_kernels.core.model import Model
from warpffrf_kernels.core.scalars import MODULE_OPTIONS, axpy, dot, real
from warpffrf_kernels.linear import banded_elimination, block_elimination, general_elimination
from warpffrf_kernels.linear.retained_solve import PIVOT_TOLERANCE, invert
from warpffrf_kernels.linear.sparse_factor import Pattern
from warpffrf_kernels.normal.pair_elimination import block_at, gather_block, gather_lines, lines_at

wp.set_module_options(MODULE_OPTIONS)
DEVICE = "cpu"
ROUND_OFF = 1e-13  # relative, of well-conditioned problems of these sizes
SCALE = 0.8  # of lines, as where cells have grown since the rows of G were made


@wp.kernel
def add(n: int, a: real, x: wp.array(dtype=real), start: int, at: int, y: wp.array(dtype=real)):
    axpy(n, a, x, start, y, at)


@wp.kernel
def multiply(n: int, x: wp.array(dtype=real), at_x: int, y: wp.array(dtype=real), at_y: int, out: wp.array(dtype=real)):
    out[0] = dot(n, x, at_x, y, at_y)


@wp.kernel
def eliminate(
    models: wp.array(dtype=Model),
    start: int,
    count: int,
    G: wp.array3d(dtype=real),
    L: wp.array3d(dtype=real),
    order: wp.array2d(dtype=int),
    z: wp.array(dtype=real),
    factor: wp.array(dtype=real),
    W: wp.array(dtype=real),
    square: wp.array(dtype=real),
    solution: wp.array(dtype=real),
    right: wp.array(dtype=real),
    bad: wp.array(dtype=int),
):
    w, _lane = wp.tid()
    model = models[0]
    cap = model.capacity.slots
    width = model.pairs.coupled_capacity
    coupled = model.pairs.coupled_count[0]
    block = block_at(model, w, start)
    line = lines_at(model, w, start)
    at = w * cap + start
    gather_block(model, w, start, count, G, order, factor)
    bad[w] = block_elimination.factor(factor, block, cap, count)
    gather_lines(model, w, 0, start, count, real(SCALE), L, order, W)
    block_elimination.forward_lines(factor, block, cap, count, W, line, width, coupled)
    block_elimination.square_of(count, W, line, width, coupled, square, w * width * width)
    block_elimination.forward(factor, block, cap, count, solution, at)
    block_elimination.push_columns(model, w, 0, count, W, line, solution, at, right)
    block_elimination.follow_columns(model, w, 0, count, real(-1.0), W, line, z, solution, at)
    block_elimination.backward(factor, block, cap, count, solution, at)


@wp.kernel
def inverse(
    models: wp.array(dtype=Model),
    patterns: wp.array(dtype=Pattern),
    matrix: wp.array3d(dtype=real),
    hold: wp.array3d(dtype=real),
    held: int,
    scaling: wp.array2d(dtype=real),
    pivots: wp.array2d(dtype=int),
    work: wp.array3d(dtype=real),
    transposed: wp.array(dtype=real),
    bad: wp.array(dtype=int),
):
    w, _lane = wp.tid()
    bad[w] = invert(
        models[0], patterns[0], w, PIVOT_TOLERANCE, matrix, hold, held, scaling, pivots, work, transposed
    )  # fmt: skip


def device(values: np.ndarray, dtype: type = wp.float64) -> wp.array:
    return wp.array(np.ascontiguousarray(values), dtype=dtype, device=DEVICE)


def models(**values: int) -> wp.array:
    """A model of which only the named sizes are set, topic__field=size."""
    model = Model()
    for name, value in values.items():
        topic, field = name.split("__")
        setattr(getattr(model, topic), field, value)
    return wp.array([model], dtype=Model, device=DEVICE)


def pseudo_random(*shape: int) -> np.ndarray:
    return np.random.default_rng(sum(shape)).standard_normal(shape)


@pytest.mark.parametrize("n", [0, 1, 2, 7, 32])
def test_axpy_and_dot(n: int) -> None:
    """Entries outside the run stay as they are."""
    x, y = pseudo_random(40), pseudo_random(41)
    y_device = device(y)
    wp.launch_tiled(add, dim=(1,), inputs=[n, 0.7, device(x), 3, 5], outputs=[y_device], block_dim=64, device=DEVICE)
    expected = y.copy()
    expected[5 : 5 + n] += 0.7 * x[3 : 3 + n]
    assert np.allclose(y_device.numpy(), expected, rtol=ROUND_OFF, atol=0.0)
    out = device(np.zeros(1))
    wp.launch(multiply, dim=1, inputs=[n, device(x), 3, device(y), 5], outputs=[out], device=DEVICE)
    assert out.numpy()[0] == pytest.approx(x[3 : 3 + n] @ y[5 : 5 + n], rel=ROUND_OFF, abs=ROUND_OFF)


def pair(capacity: int, coupled: int) -> tuple[Model, wp.array]:
    """A model with one pair and the retained columns 1, 3, 5, ... behind its gaps, which has to be kept, and an array
    of it."""
    model = Model()
    model.capacity.slots, model.retained.count = capacity, 2 * coupled
    model.pairs.count, model.pairs.coupled_capacity = 1, coupled
    model.pairs.coupled_count = device(np.array([coupled]), int)
    model.pairs.coupled = device(np.arange(1, 2 * coupled, 2)[None], int)
    return model, wp.array([model], dtype=Model, device=DEVICE)


@pytest.mark.parametrize("start, n", [(0, 0), (0, 1), (3, 2), (0, 3), (2, 4), (1, 5), (0, 8), (4, 11), (3, 17)])
def test_a_pair_is_eliminated(start: int, n: int) -> None:
    """Any remainder of the rank-4 updates, on a permuted selection of rows, in the second of two worlds."""
    capacity, coupled = 20, 6
    A = pseudo_random(capacity, capacity)
    G = A @ A.T + capacity * np.eye(capacity)
    L, z, b = pseudo_random(capacity, coupled), pseudo_random(2 * coupled), pseudo_random(capacity)
    order = np.random.default_rng(n).permutation(capacity)
    square, right = device(np.zeros(2 * coupled**2)), device(np.zeros(4 * coupled))
    solution, bad = device(np.tile(b, 2)), device(np.zeros(2, int), int)
    kept, given = pair(capacity, coupled)
    wp.launch_tiled(
        eliminate, dim=(2,),
        inputs=[given, start, n, device(np.stack([np.eye(capacity), G])), device(np.stack([L, L])),
                device(np.stack([order, order]), int), device(np.tile(z, 2))],
        outputs=[device(np.zeros(2 * capacity**2)), device(np.zeros(2 * capacity * coupled)), square, solution,
                 right, bad],
        block_dim=64, device=DEVICE,
    )  # fmt: skip
    del kept
    chosen, mine = order[start : start + n], slice(start, start + n)
    block, gradient = G[np.ix_(chosen, chosen)], SCALE * L[chosen]
    assert np.allclose(
        square.numpy().reshape(2, coupled, coupled)[1], gradient.T @ np.linalg.solve(block, gradient), atol=ROUND_OFF
    )
    assert np.allclose(
        right.numpy()[2 * coupled + 1 :: 2], gradient.T @ np.linalg.solve(block, b[mine]), atol=ROUND_OFF
    )
    assert not right.numpy()[2 * coupled :: 2].any()
    expected = np.linalg.solve(block, b[mine] - gradient @ z[1::2])
    assert np.allclose(solution.numpy()[capacity:][mine], expected, rtol=1e-11, atol=ROUND_OFF)
    assert np.allclose(
        solution.numpy()[:capacity][mine], b[mine] - gradient @ z[1::2]
    )  # the identity in the first world
    rest = np.setdiff1d(np.arange(capacity), np.arange(start, start + n))
    assert np.array_equal(solution.numpy()[capacity:][rest], b[rest])
    assert not bad.numpy().any()


@pytest.mark.parametrize("broken", [-1.0, 0.0, np.nan])
def test_cholesky_names_what_is_not_definite(broken: float) -> None:
    G = np.eye(6)
    G[4, 4] = broken
    bad = device(np.zeros(1, int), int)
    kept, given = pair(6, 2)
    wp.launch_tiled(
        eliminate, dim=(1,),
        inputs=[given, 0, 6, device(G[None]), device(np.ones((1, 6, 2))), device(np.arange(6)[None], int),
                device(np.zeros(4))],
        outputs=[device(np.zeros(36)), device(np.zeros(12)), device(np.zeros(4)),
                 device(np.ones(6)), device(np.zeros(4)), bad],
        block_dim=64, device=DEVICE,
    )  # fmt: skip
    del kept
    assert bad.numpy()[0] == 1


def inverted(matrix: np.ndarray, bodies: int, hold: np.ndarray) -> tuple[np.ndarray, int]:
    """H of `matrix` with the motions `hold` (count, 6 bodies) held, and whether it is singular."""
    n, rows = len(matrix), len(matrix) - 6 * bodies
    ends = np.array([[r % bodies, (r + 1) % bodies] for r in range(rows)]).reshape(-1, 2)
    kept, patterns = on_device(find_pattern(bodies, np.zeros(bodies, int), ends, np.ones_like(ends, bool)), DEVICE)
    motions = np.zeros((1, 6 * bodies, 6 * bodies))
    motions[0, : len(hold)] = hold
    transposed, bad = device(np.zeros(n * n)), device(np.zeros(1, int), int)
    wp.launch_tiled(
        inverse, dim=(1,),
        inputs=[models(retained__count=n, bodies__count=bodies, retained__row_offset=6 * bodies), patterns,
                device(matrix[None]), device(motions), len(hold)],
        outputs=[device(np.zeros((1, n))), device(np.zeros((1, n)), int), device(np.zeros((1, n, n))), transposed, bad],
        block_dim=64, device=DEVICE,
    )  # fmt: skip
    del kept
    return transposed.numpy().reshape(n, n).T, int(bad.numpy()[0])


@pytest.mark.parametrize("rows", [0, 1, 5])
@pytest.mark.parametrize("held", [0, 2])
def test_inverse_of_a_saddle_point_matrix(rows: int, held: int) -> None:
    """Masses and inertias far apart, constraints with zeros on the diagonal: rows must be swapped and scaled."""
    rigid = 12
    S = np.diag(np.concatenate([np.full(3, 5e8), np.full(3, 2e4), np.full(3, 3e2), np.full(3, 1e-1)]))
    S[3:6, 3:6] += 50.0 * pseudo_random(3, 3)  # gyroscopic: not symmetric
    C, hold = pseudo_random(rows, rigid), pseudo_random(held, rigid)
    K = np.block([[S, C.T], [C, -1e-9 * np.eye(rows) * np.arange(rows)]])
    H, bad = inverted(K, 2, hold)
    K[:rigid, :rigid] += hold.T @ hold
    assert bad == 0
    d = np.sqrt(np.abs(np.diag(H)))
    size = np.where(d > 0.0, d, 1.0)
    exact = np.linalg.inv(K * size[:, None] * size[None, :]) * size[:, None] * size[None, :]
    assert np.allclose(H / size[:, None] / size[None, :], exact / size[:, None] / size[None, :], atol=1e-10)


def test_dependent_constraints_are_singular() -> None:
    C = pseudo_random(2, 6)
    C[1] = 2.0 * C[0]
    K = np.block([[np.eye(6), C.T], [C, np.zeros((2, 2))]])
    assert inverted(K, 1, np.zeros((0, 6)))[1] == 1


# --- matrices that are not symmetric


@wp.kernel
def eliminate_any(
    at: int, stride: int, n: int, more: int, a: wp.array(dtype=real), pivots: wp.array(dtype=int),
    again: wp.array(dtype=real), bad: wp.array(dtype=int),
):  # fmt: skip
    _w, _lane = wp.tid()
    bad[0] = general_elimination.eliminate(a, at, stride, n, more, pivots, 0)
    general_elimination.solve_again(a, at, stride, n, pivots, 0, again, 0)


@pytest.mark.parametrize("n", [1, 7, 8, 29])
def test_a_general_matrix_is_solved_as_by_numpy(n: int) -> None:
    """With pivots that have to be sought."""
    random = np.random.default_rng(n)
    A, b, c = random.normal(size=(n, n)), random.normal(size=(n, 3)), random.normal(size=n)
    at, stride = 4, n + 5
    whole = np.full(at + n * stride, np.nan)
    lines = whole[at:].reshape(n, stride)
    lines[:, :n], lines[:, n : n + 3] = A, b
    arrays = [wp.array(v, dtype=t, device=DEVICE) for v, t in ((whole, real), (np.zeros(n, int), int), (c, real))]
    bad = wp.zeros(1, dtype=int, device=DEVICE)
    wp.launch_tiled(eliminate_any, dim=(1,), inputs=[at, stride, n, 3, *arrays, bad], block_dim=64, device=DEVICE)
    assert bad.numpy()[0] == 0
    solved(A, b, arrays[0].numpy()[at:].reshape(n, stride)[:, n : n + 3])
    solved(A, c, arrays[2].numpy())


def solved(A: np.ndarray, b: np.ndarray, x: np.ndarray) -> None:
    expected = np.linalg.solve(A, b)
    np.testing.assert_allclose(x, expected, rtol=0, atol=ROUND_OFF * np.linalg.cond(A) * np.abs(expected).max())


@wp.kernel
def eliminate_within(
    at: int, stride: int, n: int, half: int, more: int, a: wp.array(dtype=real), pivots: wp.array(dtype=int),
    again: wp.array(dtype=real), bad: wp.array(dtype=int),
):  # fmt: skip
    _w, _lane = wp.tid()
    bad[0] = banded_elimination.eliminate_band(a, at, stride, n, half, more, pivots, 0)
    banded_elimination.solve_band_again(a, at, stride, n, half, pivots, 0, again, 0)


@pytest.mark.parametrize("n", [1, 6, 31])
@pytest.mark.parametrize("half", [0, 1, 4, 9])
@pytest.mark.parametrize("sparse", [False, True])
def test_a_banded_matrix_is_solved_as_by_numpy(n: int, half: int, sparse: bool) -> None:
    """Pivots from below the diagonal, multipliers that are zero, and bands wider than the matrix."""
    random = np.random.default_rng(10 * n + half)
    A = np.triu(np.tril(random.normal(size=(n, n)), half), -half)
    A *= (random.uniform(size=A.shape) < 0.6) | np.eye(n, dtype=bool) if sparse else 1.0
    b, c = random.normal(size=(n, 5)), random.normal(size=n)
    at, stride = 3, 3 * half + 1 + 5 + 2
    whole = np.full(at + n * stride, np.nan)
    lines = whole[at:].reshape(n, stride)
    lines[:, : 3 * half + 1], lines[:, 3 * half + 1 : 3 * half + 6] = 0.0, b
    for i in range(n):
        columns = np.arange(max(0, i - half), min(n, i + half + 1))
        lines[i, columns - i + half] = A[i, columns]
    arrays = [wp.array(v, dtype=t, device=DEVICE) for v, t in ((whole, real), (np.zeros(n, int), int), (c, real))]
    bad = wp.zeros(1, dtype=int, device=DEVICE)
    wp.launch_tiled(
        eliminate_within, dim=(1,), inputs=[at, stride, n, half, 5, *arrays, bad], block_dim=64, device=DEVICE
    )
    assert bad.numpy()[0] == 0
    found = arrays[0].numpy()[at:].reshape(n, stride)
    solved(A, b, found[:, 3 * half + 1 : 3 * half + 6])
    solved(A, c, arrays[2].numpy())
    assert np.all(np.isnan(found[:, 3 * half + 6 :]))  # what stands behind is not touched


def test_a_singular_band_is_reported() -> None:
    a = wp.array(np.array([[0.0, 1.0, 2.0, 0.0, 1.0], [2.0, 4.0, 0.0, 0.0, 1.0]]).ravel(), dtype=real, device=DEVICE)
    rest = [wp.zeros(2, dtype=t, device=DEVICE) for t in (int, real)]
    bad = wp.zeros(1, dtype=int, device=DEVICE)
    wp.launch_tiled(eliminate_within, dim=(1,), inputs=[0, 5, 2, 1, 1, a, *rest, bad], block_dim=64, device=DEVICE)
    assert bad.numpy()[0] == 1


def test_a_singular_matrix_is_reported() -> None:
    a = wp.array(np.array([[1.0, 2.0, 1.0], [2.0, 4.0, 1.0]]).ravel(), dtype=real, device=DEVICE)
    rest = [wp.zeros(2, dtype=t, device=DEVICE) for t in (int, real)]
    bad = wp.zeros(1, dtype=int, device=DEVICE)
    wp.launch_tiled(eliminate_any, dim=(1,), inputs=[0, 3, 2, 1, a, *rest, bad], block_dim=64, device=DEVICE)
    assert bad.numpy()[0] == 1
