"""Sparse solvers: each of those installed against dense algebra, the dissection's invariants, and what is refused."""

from __future__ import annotations

import itertools

import numpy as np
import pytest
import scipy.sparse as sp

import warpffrf.offline.solvers as solvers
import warpffrf.offline.solvers.multifrontal as multifrontal
from warpffrf.model.errors import InputError
from warpffrf.model.mesh.facets import rigid_modes
from warpffrf.offline.elastic import REFINED_ABOVE, StaticResponse, free_model
from warpffrf.offline.solvers import SOLVERS, chosen, factorise, installed
from warpffrf.offline.solvers.ordering import LEAF, find_fronts, nested_dissection

EXACT = 1e-10  # of the largest value: the condition of these systems times round-off, with room
ROUND_OFF = 1e-13
BAR = (14, 7, 6)  # nodes; 1,764 dofs: many parts, and dense algebra is still quick


def lattice(shape=BAR, seed=0):
    """K of springs between neighbours (diagonals too) of a lattice of nodes (n, 3), held softly; and the dofs' places.

    Each spring is k d d^T along its direction d, so K is definite and couples all components.
    """
    rng = np.random.default_rng(seed)
    x = np.stack(np.meshgrid(*map(np.arange, shape), indexing="ij"), axis=-1).reshape(-1, 3).astype(float)
    number = np.arange(len(x)).reshape(shape)
    size = 3 * len(x)
    steps = [(1, 0, 0), (0, 1, 0), (0, 0, 1), (1, 1, 0), (1, -1, 0), (0, 1, 1), (1, 0, 1), (1, 1, 1)]
    rows, columns, values = [], [], []
    for step in steps:
        low = [slice(max(0, -s), n - max(0, s)) for s, n in zip(step, shape, strict=True)]
        high = [slice(max(0, s), n - max(0, -s)) for s, n in zip(step, shape, strict=True)]
        a, b = number[tuple(low)].ravel(), number[tuple(high)].ravel()
        d = np.array(step) / np.linalg.norm(step)
        block = np.outer(d, d) * (1.0 + rng.random(len(a)))[:, None, None]
        for i, j, sign in ((a, a, 1.0), (b, b, 1.0), (a, b, -1.0), (b, a, -1.0)):
            rows.append(np.broadcast_to(3 * i[:, None, None] + np.arange(3)[:, None], block.shape).ravel())
            columns.append(np.broadcast_to(3 * j[:, None, None] + np.arange(3), block.shape).ravel())
            values.append(sign * block.ravel())
    entries = (np.concatenate(values), (np.concatenate(rows), np.concatenate(columns)))
    K = sp.csc_matrix(sp.coo_matrix(entries, shape=(size, size))) + 1e-3 * sp.identity(size)
    return sp.csc_matrix(K), np.repeat(x, 3, axis=0)


def hermitian(K, seed=1):
    """A definite Hermitian matrix with the pattern of K: D^H K D with unit complex factors D that vary by dof."""
    D = sp.diags(np.exp(1j * np.random.default_rng(seed).random(K.shape[0])))
    return sp.csc_matrix(D.conj() @ K @ D)


@pytest.fixture(scope="module")
def bar():
    return lattice()


@pytest.mark.parametrize("name", installed())
@pytest.mark.parametrize("placed", [True, False])
def test_solution_equals_dense_algebra(bar, name, placed):
    K, x = bar
    if name == "multifrontal" and not placed:
        with pytest.raises(InputError, match="needs the coordinates"):
            factorise(K, None, name)
        return
    factor = factorise(K, x if placed else None, name)
    F = np.random.default_rng(2).standard_normal((K.shape[0], 5))
    U = np.linalg.solve(K.toarray(), F)
    assert np.abs(factor.solve(F) - U).max() < EXACT * np.abs(U).max()
    assert np.abs(factor.solve(F + 2j * F) - (1 + 2j) * U).max() < EXACT * np.abs(U).max()
    # few loads, few rows
    G = sp.csc_matrix(([1.0, -2.0, 3.0], ([5, 700, 31], [0, 0, 1])), shape=(K.shape[0], 2))
    rows = np.array([3, 900, 5, 5])
    V = np.linalg.solve(K.toarray(), G.toarray())
    assert np.abs(factor.solve(G, rows) - V[rows]).max() < EXACT * np.abs(V).max()
    assert factor.solve(F[:, :0]).shape == (K.shape[0], 0)
    assert (factor.name, factor.kind, factor.size) == (name, "real", K.shape[0])
    assert factor.fill >= sp.tril(K).nnz and factor.bytes >= 8 * sp.tril(K).nnz


def test_parts_that_nothing_connects():
    """Two lattices apart, in one matrix."""
    K, x = lattice((6, 5, 4))
    whole, places = sp.csc_matrix(sp.block_diag([K, K])), np.concatenate([x, x + [20.0, 0.0, 0.0]])
    F = np.random.default_rng(3).standard_normal((len(places), 2))
    found = factorise(whole, places, "multifrontal").solve(F)
    assert np.abs(whole @ found - F).max() < EXACT * np.abs(F).max()


@pytest.mark.parametrize("name", installed())
def test_hermitian_systems(bar, name):
    K, x = bar
    H = hermitian(K)
    if name == "pardiso":
        with pytest.raises(InputError, match="real matrices only"):
            factorise(H, x, name)
        return
    factor = factorise(H, x, name)
    F = np.random.default_rng(3).standard_normal((K.shape[0], 3))
    U = np.linalg.solve(H.toarray(), F)
    assert factor.kind == "complex"
    assert np.abs(factor.solve(F) - U).max() < EXACT * np.abs(U).max()


@pytest.mark.parametrize("name", installed())
def test_what_is_not_definite_is_refused(bar, name):
    K, x = bar
    K = K.tolil(copy=True)
    K[100, 100] = -K[100, 100]
    with pytest.raises(InputError, match="not positive definite.*can move without deforming"):
        factorise(sp.csc_matrix(K), x, name)
    free = lattice()[0] - 1e-3 * sp.identity(x.shape[0])  # nothing holds it: singular up to round-off
    shifted = sp.csc_matrix(free - 1e-6 * sp.identity(x.shape[0]))
    with pytest.raises(InputError, match="not positive definite"):
        factorise(shifted, x, name)


def test_a_missing_solver_names_its_extra(bar, monkeypatch):
    monkeypatch.setattr(solvers, "installed", lambda: ["multifrontal", "superlu"])
    with pytest.raises(InputError, match=r"'cholmod' is not installed; pip install 'warpffrf\[cholmod\]'.*superlu"):
        factorise(bar[0], bar[1], "cholmod")
    with pytest.raises(InputError, match="'mumps' is not available, use one of multifrontal, superlu"):
        factorise(bar[0], bar[1], "mumps")


def test_choice_of_the_solver():
    assert chosen(100_000, True) == "multifrontal"
    assert chosen(100, True) == chosen(100_000, False) == "superlu"
    assert chosen(100_000, True, "superlu") == "superlu"
    assert set(installed()) <= set(SOLVERS)


def test_bad_shapes_are_refused(bar):
    K, x = bar
    with pytest.raises(InputError, match="must be square"):
        factorise(K[:5], x)
    with pytest.raises(InputError, match="coordinates must have shape"):
        factorise(K, x[:5])
    with pytest.raises(InputError, match="loads must have shape"):
        factorise(K, x).solve(np.zeros((3, 1)))
    with pytest.raises(InputError, match="memory_limit"):
        factorise(K, x, "multifrontal", memory_limit=1000)


def test_dissection_separates(bar):
    """No entry couples two parts of which neither is above the other, and each dof comes once."""
    K, x = bar
    places = x.copy()
    places[-6:] = np.nan
    d = nested_dissection(K, places)
    assert np.array_equal(np.sort(d.order), np.arange(len(x)))
    assert np.array_equal(np.sort(d.order[-6:]), np.arange(len(x) - 6, len(x)))  # without a place: last
    part = np.repeat(np.arange(len(d.ends)), d.ends - d.starts)
    assert part.size == len(x) and len(d.ends) > 10 and np.all(d.parent[:-1] > np.arange(len(d.parent) - 1))
    above = [{p} for p in range(len(d.ends))]
    for p in reversed(range(len(d.ends))):
        if d.parent[p] >= 0:
            above[p] |= above[d.parent[p]]
    entries = sp.coo_matrix(K[d.order][:, d.order])
    for i, j in set(zip(part[entries.row].tolist(), part[entries.col].tolist(), strict=True)):
        assert j in above[i] or i in above[j]
    has_children = np.isin(np.arange(len(d.ends)), d.parent)
    assert np.all((d.ends - d.starts)[~has_children] <= 3 * LEAF)


def test_dissection_halves_the_fill_of_a_band():
    """Nested dissection of a cube fills less than the band of a lexicographic order, ever more so: the ratio of fills
    falls with the size (n^(4/3) log against n^(5/3))."""
    ratios = []
    for m in (8, 14):
        K, x = lattice((m, m, m))
        fronts = find_fronts(K, nested_dissection(K, x))
        ratios.append(fronts.entries / (3 * m**3 * 3 * (m**2 + m + 1)))
    assert ratios[1] < 0.85 * ratios[0] and ratios[1] < 0.6


def test_quadratic_cells_get_thin_separators():
    """On cells of two node layers one side of a cut between two planes of corners is one layer, the other two."""
    m = 9  # 4 cells of 3 nodes along each axis
    x = np.stack(np.meshgrid(*[np.arange(float(m))] * 3, indexing="ij"), axis=-1).reshape(-1, 3)
    number = np.arange(m**3).reshape(m, m, m)
    pairs = []
    for a, b, d in itertools.product(range(0, m - 1, 2), repeat=3):
        nodes = number[a : a + 3, b : b + 3, d : d + 3].ravel()
        pairs.append(np.stack(np.meshgrid(nodes, nodes), axis=-1).reshape(-1, 2))
    i, j = np.concatenate(pairs).T
    K = sp.csr_matrix((np.ones(len(i)), (i, j)), shape=(m**3, m**3))
    d = nested_dissection(K, x)
    assert d.ends[-1] - d.starts[-1] == m * m


def test_threads_change_no_bit(bar, monkeypatch):
    K, x = bar
    F = np.random.default_rng(4).standard_normal((K.shape[0], 7))
    found = []
    for workers in (1, 2, 5):
        monkeypatch.setattr(multifrontal, "worker_count", lambda workers=workers: workers)
        found.append(factorise(K, x, "multifrontal").solve(F))
    assert np.array_equal(found[0], found[1]) and np.array_equal(found[0], found[2])


@pytest.mark.parametrize("pinned", [None, np.array([0, 1, 2, 301, 302, 600])])
@pytest.mark.parametrize("refined", [False, True])
def test_rows_of_the_flexible_response(pinned, refined):
    """`StaticResponse` equals the projected flexibility (1 - Phi omega^-2 Phi^T of a mode, too), held rows included."""
    K, x = lattice()
    n = len(x)
    R = rigid_modes(x[::3], x.mean(axis=0))
    M = sp.diags(np.repeat(1.0 + np.random.default_rng(5).random(n // 3), 3)).tocsr()
    free = sp.csr_matrix(K - 1e-3 * sp.identity(n))
    assert np.abs(free @ R).max() < ROUND_OFF * abs(free).max() * np.abs(R).max()
    model = free_model(free, M, R, pinned, x, solver="multifrontal")
    assert model.backward_error < REFINED_ABOVE
    if refined:
        model.backward_error = 1.0
    rng = np.random.default_rng(6)
    dense = rng.standard_normal((n, 9)) * (rng.random((n, 9)) < 0.003)
    F = sp.csc_matrix(dense)
    G = model.flexibility(np.eye(n)[:, :4])
    q = model.flexibility(model.M @ G[:, :1])
    Phi = q / np.sqrt(q[:, 0] @ (model.M @ q[:, 0]))
    omega = np.sqrt(np.array([Phi[:, 0] @ (model.K @ Phi[:, 0])]))
    rows = np.array([0, 1, 7, 302, 600, n - 1])
    exact = model.flexibility(dense) - Phi @ ((Phi.T @ dense) / omega[:, None] ** 2)
    assert np.abs(StaticResponse(model, rows, omega, Phi)(F) - exact[rows]).max() < EXACT * np.abs(exact).max()
