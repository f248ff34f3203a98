"""What makes the cyclic path fast keeps it exact: block factors, real harmonics, few solves for many loads."""

from __future__ import annotations

import numpy as np
import pytest
import scipy.sparse as sp
from hypothesis import given, settings
from hypothesis import strategies as st
from traction_reference import cyclic_product, mixed_roller, relative, sector_of, the_surface

from warpffrf.model.mesh import Mesh, roller
from warpffrf.offline.cyclic.block_cholesky import BlockPattern, NotDefiniteError, chain, work
from warpffrf.offline.cyclic.harmonics import AxialInterface, Harmonics, Waves
from warpffrf.offline.cyclic.inertia import CyclicObserver
from warpffrf.offline.cyclic.path import axes_of

ROUND_OFF = 1e-11


def twisted(mesh: Mesh) -> Mesh:
    """A roller whose node planes are bent around the axis: as periodic as before, its own mirror image no more."""
    x, y, z = mesh.points.T
    angle = 0.1 * np.hypot(x, z) / np.hypot(x, z).max()
    c, s = np.cos(angle), np.sin(angle)
    points = np.stack([c * x + s * z, y, -s * x + c * z], axis=1)
    return Mesh(points, mesh.cells, mesh.facet_sets, mesh.cyclic)


@st.composite
def graphs(draw):
    """A symmetric graph of a few nodes with its diagonal, connected or not, and some root nodes."""
    n = draw(st.integers(1, 14))
    pairs = draw(st.lists(st.tuples(st.integers(0, n - 1), st.integers(0, n - 1)), max_size=3 * n))
    roots = draw(st.lists(st.integers(0, n - 1), min_size=1, max_size=3, unique=True))
    graph = np.eye(n)
    for i, j in pairs:
        graph[i, j] = graph[j, i] = 1.0
    return sp.csr_matrix(graph), np.array(roots)


@given(graphs(), st.booleans())
@settings(max_examples=60, deadline=None)
def test_block_factors_solve_any_sparse_matrix(made, complex_):
    graph, roots = made
    rng = np.random.default_rng(graph.nnz)
    n = 3 * graph.shape[0]
    full = np.kron(graph.toarray(), np.ones((3, 3)))
    A = rng.standard_normal((n, n)) + (1j * rng.standard_normal((n, n)) if complex_ else 0.0)
    A = (A + A.conj().T) * full + 4.0 * n * np.eye(n)
    pattern = BlockPattern(graph, [roots, np.zeros(0, np.int64)])
    assert sorted(pattern.order) == list(range(n))
    entries = sp.coo_matrix(A)
    kept, at = pattern.place(entries.row, entries.col)
    values = np.zeros(pattern.length, dtype=A.dtype)
    values[at] = entries.data[kept]
    factor = pattern.factor(values)
    dense = rng.standard_normal((n, 4)) + 1j * rng.standard_normal((n, 4))
    one = np.zeros((n, 1))
    one[3 * roots[0] + 1] = 1.0
    for F in (dense, dense.real, one, np.zeros((n, 2))):
        assert np.allclose(factor.solve(F), np.linalg.solve(A, F), rtol=1e-10, atol=1e-12)


def test_blocks_of_quadratic_layers_alternate():
    """A chain of 2-layer cells from the root: layers on cell boundaries reach two blocks, those inside one."""
    layers = 9
    graph = np.eye(layers)
    for cell in range(0, layers - 1, 2):
        graph[cell : cell + 3, cell : cell + 3] = 1.0
    blocks, reach = chain(sp.csr_matrix(graph), np.array([8]))
    assert [list(b) for b in blocks] == [[0, 1], [2], [3], [4], [5], [6], [7], [8]]  # the far end has no next level
    assert reach == [1, 2, 1, 2, 1, 2, 1, 0]
    assert work(blocks, reach) < work([np.arange(layers)], [0])


def test_indefinite_matrix_is_found():
    pattern = BlockPattern(sp.csr_matrix(np.ones((2, 2))), [np.array([0])])
    A = np.diag([1.0, 1.0, 1.0, 1.0, -1.0, 1.0])
    entries = sp.coo_matrix(A)
    kept, at = pattern.place(entries.row, entries.col)
    values = np.zeros(pattern.length)
    values[at] = entries.data[kept]
    with pytest.raises(NotDefiniteError, match="not positive definite"):
        pattern.factor(values)


@pytest.mark.parametrize("order", [1, 2])
def test_mirrored_sectors_have_real_harmonics(order):
    sector = sector_of(roller(0.05, 0.02, 0.02, crown_radius=0.1, sectors=7, layers=2, axial=2, order=order))
    waves = Waves(sector)
    assert waves.mirrored and len(waves.angles) == order + 1
    for k in range(4):
        Q = waves.basis(k).toarray()
        assert np.allclose(Q.conj().T @ Q, np.eye(len(Q)), atol=1e-14)
        for what, pair in (("K", sector.K), ("M", sector.M)):
            expected = Q.conj().T @ sector.harmonic(pair, k) @ Q
            found = waves.matrix(what, k)
            assert not np.iscomplexobj(found.data)
            assert relative(found.toarray(), expected) < ROUND_OFF


@pytest.mark.parametrize("make", [twisted, lambda _: mixed_roller(9)], ids=["twisted", "diagonals"])
def test_other_sectors_stay_complex(make):
    sector = sector_of(make(roller(0.05, 0.02, 0.02, sectors=9, layers=2, axial=1, order=1)))
    waves = Waves(sector)
    assert not waves.mirrored and waves.real_at(0) and not waves.real_at(2)
    assert relative(waves.matrix("K", 2).toarray(), sector.harmonic(sector.K, 2).toarray()) < ROUND_OFF


@pytest.mark.parametrize("order", [1, 2])
def test_both_kinds_of_arithmetic_agree(order, monkeypatch):
    mesh = roller(0.05, 0.02, 0.02, sectors=10, layers=2, axial=1, order=order)
    wanted = {"interfaces": ["bore"], "modes": 12, "tangential": "cells"}
    real, _ = cyclic_product(mesh, **wanted)
    monkeypatch.setattr(Waves, "_is_mirrored", lambda self: False)
    other, _ = cyclic_product(mesh, **wanted)
    assert (real.facts["harmonics"], other.facts["harmonics"]) == ("real", "complex")
    assert relative(real.omega, other.omega) < 1e-9
    (a, a_t), (b, b_t) = the_surface(real), the_surface(other)
    assert relative(a.lags, b.lags) < ROUND_OFF
    assert relative(a_t.lags_tt, b_t.lags_tt) < ROUND_OFF
    assert relative(a_t.lags_nt, b_t.lags_nt) < ROUND_OFF
    # products that a turn within equal frequencies leaves alone
    p, q = real.interfaces["bore"].modes, other.interfaces["bore"].modes
    assert relative(p.T @ p, q.T @ q) < 1e-9
    for m, n in ((a.mode_normal, b.mode_normal), (a_t.mode_tangent[0], b_t.mode_tangent[0])):
        assert relative(m @ m.T, n @ n.T) < 1e-9 and relative(m @ p, n @ q) < 1e-9


def test_a_harmonic_has_modes_where_lanczos_finds_them():
    from warpffrf.offline.bases.modes import vibration_modes

    harmonics = Harmonics(sector_of(roller(0.05, 0.02, 0.02, sectors=9, layers=2, axial=1, order=1)), [])
    for k in (2, 3, 4):
        lowest = vibration_modes(harmonics.model(k), count=1)[0][0]
        assert harmonics.has_modes(k, lowest * (1.0 + 1e-6)) and not harmonics.has_modes(k, lowest * (1.0 - 1e-6))


def test_loaded_nodes_are_eliminated_last():
    """Radial levels from the rim inwards: the widest block is one layer of a sector's nodes."""
    mesh = roller(0.05, 0.02, 0.02, sectors=9, layers=5, axial=2, order=2)
    sector = sector_of(mesh)
    rim, bore = (mesh.facets(name).node_set for name in ("rim", "bore"))
    harmonics = Harmonics(sector, [AxialInterface(bore[bore < sector.nodes], 0.0)], rim[rim < sector.nodes])
    assert harmonics.pattern.widest == 3 * 2 * 5  # two planes of five axial nodes
    last = harmonics.free[harmonics.pattern.order[-3 * 2 * 5 :]] // 3
    assert np.isin(last, rim).all()


def test_an_observer_sees_modes_and_local_responses():
    """Differences of displacement between a node and its copy in the next sector, against those of the skin."""
    mesh = roller(0.05, 0.02, 0.02, sectors=8, layers=2, axial=1, order=1)
    nn, N = len(mesh.points) // 8, 8
    node = int(np.flatnonzero(np.isin(np.arange(nn), mesh.facets("rim").node_set))[0])
    pick = sp.csr_matrix((np.ones(3), (np.arange(3), 3 * node + np.arange(3))), shape=(3, 3 * nn))
    observer = CyclicObserver("difference", {0: -pick, 1: pick})
    product, _ = cyclic_product(mesh, interfaces=["bore"], modes=8, tangential="nodes", observers=[observer])
    s, s_t = the_surface(product)
    skin = int(np.argmin(np.linalg.norm(product.skin_points - mesh.points[node], axis=1)))
    per_sector = len(product.skin_points) // N
    turns = axes_of(mesh) @ np.array([[c, -d, 0, d, c, 0, 0, 0, 1] for c, d in _turns(N)]).reshape(N, 3, 3)

    def difference(u):
        """(N, 3) of displacements (n, 3) of the skin, each in its own sector's axes."""
        local = np.einsum("sji,sj->si", turns, u[skin + per_sector * np.arange(N)])
        return np.roll(local, -1, axis=0) - local

    rng = np.random.default_rng(0)
    for recovery, columns, full in (
        (s.recovery, s.grid.columns_per_sector, "observed"),
        (s_t.recovery, 2 * s.grid.columns_per_sector, "observed_tangential"),
    ):
        forces = rng.standard_normal((N * columns, s.grid.rows))
        seen = getattr(s, full)["difference"]
        amplitudes = np.fft.rfft(forces.reshape(N, -1), axis=0)
        values = np.fft.irfft(np.einsum("hpi,hi->hp", seen.transfer, amplitudes), n=N, axis=0)
        expected = difference(recovery.apply(forces, columns))
        assert relative(values, expected) < 1e-5  # both in single precision, and a difference of larger numbers
    observed = product.observed_modes["difference"]
    wave = np.exp(2j * np.pi * np.arange(N) / N)
    modes = observed.real(lambda k, w: (wave[:, None, None] ** k * w).reshape(3 * N, -1))
    for m in range(len(product.omega)):
        u = product.skin_modes[m].astype(float)
        assert np.abs(modes[:, m].reshape(N, 3) - difference(u)).max() < 2e-6 * np.abs(u).max()


def _turns(N: int):
    angle = 2.0 * np.pi * np.arange(N) / N
    return zip(np.cos(angle), np.sin(angle), strict=True)


def test_wanted_number_of_modes_beyond_the_first_harmonics():
    """More modes than the first harmonics hold: all harmonics are taken, down to the last mode that the mesh has."""
    mesh = roller(0.05, 0.02, 0.02, sectors=20, layers=1, axial=1, order=1)
    few, _ = cyclic_product(mesh, interfaces=[], modes=30)
    every, _ = cyclic_product(mesh, interfaces=[], modes=3 * len(mesh.points))
    assert len(every.omega) == 3 * len(mesh.points) - 6
    assert relative(few.omega, every.omega[: len(few.omega)]) < 1e-9
    assert set(few.facts["harmonics_with_modes"]) < set(range(11))
