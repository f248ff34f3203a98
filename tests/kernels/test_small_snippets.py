"""axpy, dot, the Cholesky solve and the inverse of the native snippets against NumPy, on arrays of their own."""

# Warp kernels confuse it
# pyright: reportInvalidTypeForm=false, reportAssignmentType=false, reportGeneralTypeIssues=false
from __future__ import annotations

from typing import Any

import numpy as np
import pytest
import warp as wp
from warpffrf_kernels.core import control as k
from warpffrf_kernels.core.model import Model
from warpffrf_kernels.core.scalars import MODULE_OPTIONS, axpy, dot, real
from warpffrf_kernels.linear import outer
from warpffrf_kernels.normal.contact_solve import factor_and_solve

from warpffrf.online.arrays.declaration import host_structs

wp.set_module_options(MODULE_OPTIONS)
DEVICE = "cpu"
ROUND_OFF = 1e-13  # relative, of well-conditioned problems of these sizes


@wp.kernel
def add(n: int, a: real, x: wp.array(dtype=real), start: int, at: int, y: wp.array(dtype=real)):
    axpy(n, a, x, start, y, at)


@wp.kernel
def multiply(n: int, x: wp.array(dtype=real), at_x: int, y: wp.array(dtype=real), at_y: int, out: wp.array(dtype=real)):
    out[0] = dot(n, x, at_x, y, at_y)


@wp.kernel
def solve(
    models: wp.array(dtype=Model),
    count: int,
    G: wp.array3d(dtype=real),
    right: wp.array2d(dtype=real),
    order: wp.array2d(dtype=int),
    work: wp.array3d(dtype=real),
    solution: wp.array2d(dtype=real),
    bad: wp.array(dtype=int),
):
    w, _lane = wp.tid()
    bad[w] = factor_and_solve(models[0], w, count, G, right, order, work, solution)


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


@pytest.mark.parametrize("n", [0, 1, 2, 3, 4, 5, 8, 11, 17])
def test_cholesky_solve(n: int) -> None:
    """Any remainder of the rank-4 updates, on a permuted selection of rows, in the second of two worlds."""
    capacity = 20
    A = pseudo_random(capacity, capacity)
    G = A @ A.T + capacity * np.eye(capacity)
    right = pseudo_random(2, capacity)
    order = np.random.default_rng(n).permutation(capacity)
    solution, bad = device(np.zeros((2, capacity))), device(np.zeros(2, int), int)
    wp.launch_tiled(
        solve, dim=(2,),
        inputs=[models(capacity__slots=capacity), n, device(np.stack([np.eye(capacity), G])), device(right),
                device(np.stack([order, order]), int)],
        outputs=[device(np.zeros((2, capacity, capacity + 1))), solution, bad], block_dim=64, device=DEVICE,
    )  # fmt: skip
    chosen = order[:n]
    expected = np.linalg.solve(G[np.ix_(chosen, chosen)], right[1, chosen])
    assert np.allclose(solution.numpy()[1, :n], expected, rtol=1e-11, atol=ROUND_OFF)
    assert np.allclose(solution.numpy()[0, :n], right[0, chosen])  # the identity in the first world
    assert not bad.numpy().any()


@pytest.mark.parametrize("broken", [-1.0, 0.0, np.nan])
def test_cholesky_names_what_is_not_definite(broken: float) -> None:
    G = np.eye(6)
    G[4, 4] = broken
    bad = device(np.zeros(1, int), int)
    wp.launch_tiled(
        solve, dim=(1,),
        inputs=[models(capacity__slots=6), 6, device(G[None]), device(np.ones((1, 6))),
                device(np.arange(6)[None], int)],
        outputs=[device(np.zeros((1, 6, 7))), device(np.zeros((1, 6))), bad], block_dim=64, device=DEVICE,
    )  # fmt: skip
    assert bad.numpy()[0] == 1


def inverted(matrix: np.ndarray, bodies: int, rhs: np.ndarray) -> tuple[np.ndarray, np.ndarray, int]:
    """H, H rhs and the failure bits of `factor_outer`."""
    n = len(matrix)
    words = host_structs(k.Control, 1)
    words["run"] = words["moved"] = words["refresh"] = 1
    ctl: Any = wp.array(words, dtype=k.Control, device=DEVICE)
    transposed, z = device(np.zeros(n * n)), device(np.zeros(n))
    wp.launch_tiled(
        outer.factor_outer, dim=(1,),
        inputs=[models(outer__count=n, bodies__count=bodies, outer__row_offset=6 * bodies), device(matrix[None]),
                device(rhs)],
        outputs=[ctl, device(np.zeros((1, n))), device(np.zeros((1, n)), int), device(np.zeros((1, n, n))), transposed,
                 z],
        block_dim=64, device=DEVICE,
    )  # fmt: skip
    return transposed.numpy().reshape(n, n).T, z.numpy(), int(ctl.numpy()["failure"][0])


@pytest.mark.parametrize("rows", [0, 1, 5])
def test_inverse_of_a_saddle_point_matrix(rows: int) -> None:
    """Masses and inertias far apart, constraints with zeros on the diagonal: rows must be swapped and scaled."""
    rigid = 12
    S = np.diag(np.concatenate([np.full(3, 5e8), np.full(3, 2e4), np.full(3, 3e2), np.full(3, 1e-1)]))
    S[3:6, 3:6] += 50.0 * pseudo_random(3, 3)  # gyroscopic: not symmetric
    C = pseudo_random(rows, rigid)
    K = np.block([[S, C.T], [C, -1e-9 * np.eye(rows) * np.arange(rows)]])
    rhs = pseudo_random(rigid + rows)
    H, z, failure = inverted(K, 2, rhs)
    assert failure == 0
    d = np.sqrt(np.abs(np.diag(H)))
    size = np.where(d > 0.0, d, 1.0)
    exact = np.linalg.inv(K * size[:, None] * size[None, :]) * size[:, None] * size[None, :]
    assert np.allclose(H / size[:, None] / size[None, :], exact / size[:, None] / size[None, :], atol=1e-10)
    assert np.allclose(z / size, H @ rhs / size, rtol=1e-10, atol=ROUND_OFF * np.abs(H @ rhs / size).max())


def test_dependent_constraints_are_singular() -> None:
    C = pseudo_random(2, 6)
    C[1] = 2.0 * C[0]
    K = np.block([[np.eye(6), C.T], [C, np.zeros((2, 2))]])
    assert inverted(K, 1, np.ones(8))[2] == int(k.SINGULAR)
