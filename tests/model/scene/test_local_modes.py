"""Dynamic local modes from Gram matrices: orthogonality, static exactness at any cut, harmonics against dense algebra.

The bodies are random symmetric matrices, without meshes: what must hold for every body must hold for these.
"""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
import scipy.linalg as sla

from warpffrf.model.errors import InputError
from warpffrf.model.reduced.contact_grid import SurfaceGrid
from warpffrf.model.reduced.contact_surface import ContactSurface, Recovery
from warpffrf.model.reduced.local_mass import LocalMass
from warpffrf.model.reduced.local_modes import dynamic_modes

ROUND_OFF = 1e-10  # of modal mass, and of the largest entry: products of a few hundred terms, condition 1e4


def surface(D, N, W, sectors=1, rows=2, mode_normal=None):
    """A contact surface of `D`, `N` lags (sectors, c rows, c rows) and overlap W^T; a transfer that is the identity."""
    c = D.shape[1] // rows
    columns = c * sectors
    grid = SurfaceGrid(np.eye(3)[0], 0.0, 2.0 * np.pi / columns, columns, True, np.linspace(0.0, 1.0, rows), c)
    grid_nodes = columns * rows
    transfer = np.zeros((1, 3 * grid_nodes, grid_nodes))
    transfer[0, 3 * np.arange(grid_nodes), np.arange(grid_nodes)] = 1.0
    normal = np.zeros((grid_nodes, W.shape[1])) if mode_normal is None else mode_normal
    recovery = Recovery(transfer, 1, np.eye(3))
    return ContactSurface("rim", None, grid, D, normal, recovery, local_mass=LocalMass(N, W))


def dense(s, lags):
    """A block-circulant operator as one matrix."""
    return replace(s, lags=lags).compliance(np.arange(s.grid.columns))


def spring_mass(size=60, grid_nodes=24, vibrations=4, attached=3, seed=0):
    """K, M, loads B, and global modes: vibration modes and responses to `attached` loads, made orthonormal."""
    rng = np.random.default_rng(seed)
    K, M = (A @ A.T / size + 0.3 * np.eye(size) for A in rng.standard_normal((2, size, size)))
    K *= 1e4
    B = rng.standard_normal((size, grid_nodes))
    F = rng.standard_normal((size, attached))
    V = sla.eigh(K, M)[1][:, :vibrations]
    Q = np.concatenate([V, np.linalg.solve(K, F)], axis=1)
    omega2, Y = sla.eigh(Q.T @ K @ Q, Q.T @ M @ Q)
    return K, M, B, F, np.sqrt(omega2), Q @ Y


def reduced(seed=0):
    """The body of `spring_mass`, its residual responses U, and its surface."""
    K, M, B, F, omega, Phi = spring_mass(seed=seed)
    U = np.linalg.solve(K, B) - Phi @ ((Phi.T @ B) / omega[:, None] ** 2)
    D, N, W = B.T @ U, U.T @ M @ U, U.T @ M @ Phi
    D = 0.5 * (D + D.T)
    return K, M, B, F, omega, Phi, U, surface(D[None], N[None], W, mode_normal=B.T @ Phi)


def test_modes_are_orthonormal_in_mass_and_stiffness_and_to_the_global_ones():
    K, M, _, _, _, Phi, U, s = reduced()
    modes = dynamic_modes(s)
    phi = U @ modes.shape
    assert np.abs(phi.T @ M @ phi - np.eye(len(modes.omega))).max() < ROUND_OFF
    stiffness = (phi.T @ K @ phi) / np.outer(modes.omega, modes.omega)
    assert np.abs(stiffness - np.eye(len(modes.omega))).max() < ROUND_OFF
    assert np.abs(Phi.T @ M @ phi).max() < ROUND_OFF
    assert np.abs(Phi.T @ K @ phi).max() < ROUND_OFF * modes.omega[-1] ** 2
    assert np.all(np.diff(modes.omega) >= 0.0)


def test_held_directions_are_those_of_the_attachment_modes():
    *_, s = reduced()
    modes = dynamic_modes(s)
    assert (modes.held, modes.dropped) == (3, 0)
    assert len(modes.omega) == s.local_modes - 3


def test_local_modes_do_not_move_what_the_attachment_modes_stand_for():
    _, _, _, F, _, _, U, s = reduced()
    modes = dynamic_modes(s)
    moved = F.T @ (U @ modes.shape)
    assert np.abs(moved).max() < ROUND_OFF * np.abs(modes.shape).max() * np.abs(F.T @ (U + 1.0)).max()


@pytest.mark.parametrize("count", [0, 1, 7, 15, None])
def test_static_response_is_exact_at_any_cut(count):
    K, _, B, _, omega, _, _, s = reduced()
    modes = dynamic_modes(s, count=count)
    f = np.random.default_rng(1).standard_normal(s.local_modes)
    u = s.mode_normal @ (s.mode_normal.T @ f / omega**2) + modes.trace @ (modes.trace.T @ f / modes.omega**2)
    u += modes.residual_lags[0] @ f
    exact = B.T @ np.linalg.solve(K, B @ f)
    assert np.abs(u - exact).max() < ROUND_OFF * np.abs(exact).max()
    lowest = np.linalg.eigvalsh(modes.residual_lags[0])[0]
    assert lowest > -ROUND_OFF * np.abs(s.lags).max()  # what is cut is never softer than nothing


def test_frequencies_are_ritz_values_from_above():
    """Global and local modes together: above the body's own, and at most as many places up as there are held ones."""
    K, M, _, _, omega, Phi, U, s = reduced()
    modes = dynamic_modes(s)
    own = np.sqrt(sla.eigh(K, M, eigvals_only=True))
    together = np.sort(np.concatenate([omega, modes.omega]))
    assert np.all(together >= own[: len(together)] * (1.0 - 1e-12))
    Q = np.linalg.qr(np.concatenate([Phi, U], axis=1))[0]
    union = np.sqrt(sla.eigh(Q.T @ K @ Q, Q.T @ M @ Q, eigvals_only=True))
    assert np.all(together >= union[: len(together)] * (1.0 - 1e-9))
    assert np.all(together <= union[modes.held :] * (1.0 + 1e-9))


def test_loads_do_work_on_the_trace():
    """The modal force of node forces f is phi^T B f."""
    _, _, B, _, _, _, U, s = reduced()
    modes = dynamic_modes(s)
    assert modes.trace == pytest.approx(B.T @ (U @ modes.shape), abs=ROUND_OFF * np.abs(modes.trace).max())


def test_equivalent_forces_have_the_displacement_of_modes_and_rest():
    _, _, _, _, _, _, U, s = reduced()
    modes = dynamic_modes(s, count=6)
    rng = np.random.default_rng(2)
    f, q = rng.standard_normal(s.local_modes), rng.standard_normal(len(modes.omega))
    rest = U - (U @ modes.shape) @ (modes.trace / modes.omega**2).T
    exact = U @ modes.shape @ q + rest @ f
    found = U @ modes.equivalent_forces(f.reshape(-1, s.grid.rows), q).ravel()
    assert found == pytest.approx(exact, abs=ROUND_OFF * np.abs(exact).max())
    at_rest = modes.equivalent_forces(f.reshape(-1, s.grid.rows), modes.trace.T @ f / modes.omega**2)
    assert at_rest.ravel() == pytest.approx(f, abs=ROUND_OFF)


def circulant(sectors, size, m, seed=3):
    """D, N lags (sectors, size, size), positive definite, and an overlap of rank 2 in harmonic 1."""
    rng = np.random.default_rng(seed)
    harmonics = sectors // 2 + 1
    found = []
    for scale in (1.0, 0.02):
        A = rng.standard_normal((harmonics, size, 2 * size)) + 1j * rng.standard_normal((harmonics, size, 2 * size))
        A[0] = A[0].real
        if sectors % 2 == 0:
            A[-1] = A[-1].real
        found.append(scale * np.fft.irfft(A @ A.conj().transpose(0, 2, 1), n=sectors, axis=0))
    wave = np.exp(2j * np.pi * np.arange(sectors) / sectors)
    w = np.multiply.outer(wave, rng.standard_normal(size) + 1j * rng.standard_normal(size)).reshape(-1)
    W = np.zeros((sectors * size, m))
    W[:, 0], W[:, 1] = w.real, w.imag
    return found[0], found[1], 0.05 * W


@pytest.mark.parametrize("sectors", [6, 7])
@pytest.mark.parametrize("count", [0, 5, 11, None])
def test_harmonics_equal_dense_algebra(sectors, count):
    """A block-circulant surface has the same modes and the same rest as the one matrix that it stands for."""
    D, N, W = circulant(sectors, 4, 3)
    s = surface(D, N, W, sectors)
    one = surface(dense(s, D)[None], dense(s, N)[None], W)
    modes = dynamic_modes(s, count=count)
    whole = dynamic_modes(one, count=count)
    assert modes.held == whole.held == 2
    assert modes.omega == pytest.approx(whole.omega, rel=1e-9)
    assert modes.stiffer == pytest.approx(whole.stiffer, rel=1e-9)
    rest = dense(s, modes.residual_lags)
    assert rest == pytest.approx(whole.residual_lags[0], abs=ROUND_OFF * np.abs(rest).max())
    assert rest + (modes.trace / modes.omega**2) @ modes.trace.T == pytest.approx(
        dense(s, D), abs=ROUND_OFF * np.abs(D).max()
    )
    mass = modes.shape.T @ dense(s, N) @ modes.shape
    assert np.abs(mass - np.eye(len(modes.omega))).max(initial=0.0) < ROUND_OFF
    assert modes.trace == pytest.approx(dense(s, D) @ modes.shape, abs=ROUND_OFF * np.abs(modes.trace).max(initial=1))


def test_pairs_are_never_cut_apart():
    D, N, W = circulant(7, 4, 3)
    s = surface(D, N, W, 7)
    every = dynamic_modes(s).omega
    pair = next(i for i in range(len(every) - 1) if every[i + 1] <= every[i] * (1.0 + 1e-9))
    assert len(dynamic_modes(s, count=pair + 1).omega) == pair + 2


def test_limits():
    *_, s = reduced()
    every = dynamic_modes(s)
    limit = float(every.omega[5:7].mean() / (2.0 * np.pi))
    found = dynamic_modes(s, max_frequency=limit)
    assert found.omega == pytest.approx(every.omega[:6])
    assert found.stiffer == pytest.approx(every.omega[6])
    assert len(dynamic_modes(s, max_frequency=limit, count=2).omega) == 2
    assert every.stiffer == np.inf


def test_directions_too_stiff_or_without_compliance_stay_in_the_rest():
    D = np.diag([1.0, 1.0, 0.5, 0.0])
    N = np.diag([1.0, 0.1, 1e-12, 0.0])
    modes = dynamic_modes(surface(D[None], N[None], np.zeros((4, 0))))
    assert modes.omega == pytest.approx([1.0, np.sqrt(10.0)])
    assert modes.dropped == 2
    assert modes.residual_lags[0] == pytest.approx(np.diag([0.0, 0.0, 0.5, 0.0]), abs=1e-14)


def test_bad_input():
    *_, s = reduced()
    with pytest.raises(InputError, match="contact 'rim'.*local_dynamics=True"):
        dynamic_modes(replace(s, local_mass=None))
    with pytest.raises(InputError, match="count"):
        dynamic_modes(s, count=-1)
    with pytest.raises(InputError, match="max_frequency"):
        dynamic_modes(s, max_frequency=0.0)
