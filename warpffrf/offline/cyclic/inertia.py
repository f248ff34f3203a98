r"""Inertia invariants of a rotationally periodic body, from one sector's share of each mode.

A wave of harmonic k moves sector s by `u e^{i k s phi}` in the sector's own axes. In fixed axes its components along
`e_+ , e_-`: `u^+- = u_x +- i u_y`, and `u^z`, are scalar waves of the harmonics k + 1, k - 1 and k. The mass matrix of
finite elements is the same scalar one for every component and in any axes, with factors m_A (within a sector) and m_B
(to the next), so that the scalar wave of harmonic l has the mass `m_l = m_A + e^{i l phi} m_B + e^{-i l phi} m_B^T`,

    int a b dm = N a^T m_l b   where harmonics h of a and l of b have h + l = 0 modulo N, else zero.

So J1 depends on the harmonics 0, 1 and 2 alone, and J2 and G couple harmonics that differ, or sum to N, by at most 2:
nothing else is computed. The position X is itself a wave of harmonic 0. A real mode `Re z` or `Im z` is composed of the
waves z of harmonic k and conj(z) of -k.

Centrifugal. Loads of rotation of a rotationally periodic body, as waves of the harmonics 0, 1 and 2.

In sector axes with the axis e = (0, 0, 1) and d = (1, i, 0)/root 2 an angular velocity is `w = a e + b d + b* d*`. The
constant e has the same components in every sector, d varies as `e^{i s phi}` (`harmonics`). The six products of w are

    a^2      -e x (e x X)                                        harmonic 0,
    |b|^2    -(d x (d* x X) + d* x (d x X))                      harmonic 0,
    a b      -(d x (e x X) + e x (d x X)),   and conjugate       harmonic 1,
    b^2      -d x (d x X),                   and conjugate       harmonic 2.

In cylindrical axes, r and z of the point about the centre of mass, the last two are `-e^{i theta} (z (e_r + i e_theta)
+ r e_z)/root 2` and `-e^{2 i theta} r (e_r + i e_theta)/2`: real in the coordinates of `waves`. With few sectors
harmonics coincide: of three, the conjugate of the wave 2 is one of harmonic 1; of four, the wave 2 is its own
conjugate's, and its real and imaginary part are two loads.

Observers. Quantities observed in every harmonic of a periodic body: linear operators on its displacement.

An observer has `rows` values per sector, those of sector s from the displacements u_{s+o} of sectors near it, each in
its own axes: `y_s = sum_o blocks[o] u_{s+o}`. Under a wave `u_s = u e^{i k s phi}` the values are a wave too, of
amplitude `y = sum_o e^{i k o phi} blocks[o] u`. The display skin is one (o = 0 alone), stresses at points are others.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass

import numpy as np
import scipy.sparse as sp

from warpffrf.model.reduced.inertia import PRODUCTS, InertiaTerms
from warpffrf.offline.cyclic.harmonics import DIRECTIONS, HarmonicModes, Harmonics
from warpffrf.offline.cyclic.sector import Sector, phase
from warpffrf.offline.fe import Sparse
from warpffrf.offline.inertia.invariants import TurningResponse, from_moments

Array = np.ndarray
SHIFTS = (1, -1, 0)  # of the harmonic, in fixed axes: of the components +, -, z
# x, y, z from the components +, -, z
CARTESIAN = np.array([[0.5, 0.5, 0.0], [-0.5j, 0.5j, 0.0], [0.0, 0.0, 1.0]])


@dataclass(frozen=True)
class _Waves:
    """Waves of one signed harmonic: components +, -, z (3, nn, p), and their numbers (p,) among all waves."""

    k: int
    parts: Array
    numbers: Array

    @classmethod
    def of(cls, k: int, shape: Array, first: int) -> _Waves:
        """Of the displacement (3 nn, p) in sector axes, numbered from `first`."""
        x, y, z = shape[0::3], shape[1::3], shape[2::3]
        return cls(k, np.stack([x + 1j * y, x - 1j * y, z]), first + np.arange(shape.shape[1]))


def cyclic_inertia_terms(sector: Sector, harmonics: Sequence[HarmonicModes], kept: int, center: Array) -> InertiaTerms:
    """Invariants, user axes, of the first `kept` real modes; `center` (3,) [m] of mass, user frame.

    Real modes are ordered as in `RealModes`: ascending in frequency, the two of a pair adjacent.
    """
    N = sector.count
    every = np.sort(np.concatenate([np.zeros(0), *(np.repeat(h.omega, _copies(h.k, N)) for h in harmonics)]))
    limit = every[kept - 1] if kept else -1.0
    inside = [(h.k, h.omega[h.omega <= limit], h.shape[:, h.omega <= limit]) for h in harmonics]
    total = 2 * sum(len(w) for _, w, _ in inside)
    waves: list[_Waves] = []
    omega: list[float] = []
    combined: list[Array] = []  # each real mode as a combination of all waves
    first = 0
    for k, w, shape in inside:
        p, copies = len(w), _copies(k, N)
        waves += [_Waves.of(k, shape, first), _Waves.of(-k, shape.conj(), first + p)]
        for i in range(p):
            pair = np.zeros((2, total), dtype=complex)
            pair[:, first + i], pair[:, first + p + i] = (0.5, -0.5j), (0.5, 0.5j)
            combined += list(np.sqrt(copies / N) * pair[:copies])
            omega += [w[i]] * copies
        first += 2 * p
    C = np.array(combined).reshape(len(omega), total)[np.argsort(np.array(omega), kind="stable")[:kept]]

    height = float((center - sector.origin) @ sector.axes[:, 2])
    position = _Waves.of(0, (sector.coordinates - np.array([0.0, 0.0, height])).reshape(-1, 1), 0)
    P, S = _moments(sector, position, waves, total)
    turn = sector.axes @ CARTESIAN
    return from_moments(
        np.real(np.einsum("ac,bd,cdj,nj->nab", turn, turn, P, C, optimize=True)),
        np.real(np.einsum("ac,bd,mi,cdij,nj->mnab", turn, turn, C, S, C, optimize=True)),
    )


def _moments(sector: Sector, position: _Waves, waves: Sequence[_Waves], total: int) -> tuple[Array, Array]:
    """int X^c u_j^d dm (3, 3, total) and int u_i^c u_j^d dm (3, 3, total, total) of the components +, -, z of all
    waves, the sum over the sectors of the whole body."""
    N = sector.count
    A, B = (sp.csr_matrix(part[2::3][:, 2::3]) for part in sector.M)  # the axial part is the same in all axes
    at: dict[int, list[_Waves]] = {}
    for w in waves:
        at.setdefault(w.k % N, []).append(w)
    P = np.zeros((3, 3, total), dtype=complex)
    S = np.zeros((3, 3, total, total), dtype=complex)
    for w in waves:
        for d, shift in enumerate(SHIFTS):
            loaded = N * (_scalar(A, B, w.k + shift, N) @ w.parts[d])
            for c, other_shift in enumerate(SHIFTS):
                wanted = -(w.k + shift + other_shift) % N
                if wanted == 0:
                    P[c, d, w.numbers] = position.parts[c][:, 0] @ loaded
                for other in at.get(wanted, ()):
                    S[c, d, other.numbers[:, None], w.numbers] = other.parts[c].T @ loaded
    return P, S


def _scalar(A: Sparse, B: Sparse, k: int, count: int) -> Sparse:
    """Mass matrix (nn, nn) of the scalar wave k."""
    e = phase(k, count)
    return A + e * B + np.conj(e) * B.T


def _copies(k: int, count: int) -> int:
    """Real modes of one complex mode of harmonic k."""
    return 1 if k == 0 or 2 * k == count else 2


HARMONICS = 3  # 0, 1 and 2
# Imaginary part, of the largest entry, that is round-off: nodes lie on the mirror planes to 1e-10 (`waves.MIRRORED`).
REAL = 1e-9


@dataclass(frozen=True, eq=False)
class TurningWaves:
    """Loads of rotation of one harmonic: `loads` (n_k, c) in its coordinates, and their dependence on the products of
    the angular velocity in sector axes, `weights` (c, 6) in the order of `PRODUCTS`: the load on
    sector s is the real part of `loads @ weights @ products e^{i k s phi}`."""

    k: int
    loads: Array
    weights: Array


def acceleration_waves(h: int, X: Array) -> tuple[Array, Array]:
    """Waves (3 n, c) of harmonic h at points X (n, 3) [m] about the centre of mass, and their `weights` (c, 6)."""
    e, d = DIRECTIONS[0], DIRECTIONS[1]
    pairs = {0: [(e, e), (d, d.conj())], 1: [(d, e)], 2: [(d, d)]}[h]
    waves, weights = [], []
    for p, q in pairs:
        wave = -np.cross(p, np.cross(q, X))
        if p is not q:
            wave = wave - np.cross(q, np.cross(p, X))
        waves.append((np.real(wave) if h == 0 else wave).reshape(-1))
        # the amplitudes of w along p and q: w.p* and w.q*
        both = np.outer(np.conj(p), np.conj(q))
        weight = np.array([both[a, b] if a == b else both[a, b] + both[b, a] for a, b in PRODUCTS])
        weights.append(np.real(weight) if h == 0 else 2.0 * weight)
    return np.stack(waves, axis=1), np.stack(weights)


def turning_waves(harmonics: Harmonics, k: int, height: float) -> TurningWaves:
    """Loads of harmonic k; `height` [m] of the centre of mass on the axis. None (c = 0) beyond the harmonic 2."""
    N = harmonics.count
    X = harmonics.sector.coordinates - np.array([0.0, 0.0, height])
    waves, weights = [], []
    for h in range(HARMONICS):
        wave, weight = acceleration_waves(h, X)
        if h == k:
            waves.append(wave)
            weights.append(weight)
        elif N - h == k:
            waves.append(wave.conj())
            weights.append(weight.conj())
    if not waves:
        return TurningWaves(k, np.zeros((harmonics.size(k), 0)), np.zeros((0, 6)))
    M, Q = harmonics.waves.matrix("M", k), harmonics.waves.basis(k)
    F = harmonics.constraint(k).conj().T @ (M @ (Q.conj().T @ np.concatenate(waves, axis=1)))
    W = np.concatenate(weights)
    if harmonics.waves.real_at(k):
        F, W = _real(F, W)
    # a real wave has real parts only
    return TurningWaves(k, F, np.real(W) if 2 * k == N else W)


def _real(F: Array, W: Array) -> tuple[Array, Array]:
    """The same loads as real columns: the imaginary parts, if any, become columns of their own."""
    apart = np.abs(np.imag(F)).max(axis=0, initial=0.0) > REAL * np.abs(F).max(axis=0, initial=0.0)
    F = np.concatenate([np.real(F), np.imag(F)[:, apart]], axis=1)
    return F, np.concatenate([W, 1j * W[apart]]) if apart.any() else W


def left_out_products(
    found: Mapping[int, tuple[TurningWaves, TurningResponse]], harmonics: Harmonics, limit: float
) -> Array:
    """S (6, 6) [kg m2 s4] of `inertia.centrifugal` for the whole body, sector axes: the part outside the modes up to
    `limit` [rad/s], from the loads and responses of each harmonic."""
    N = harmonics.count
    S = np.zeros((6, 6))
    for k, (waves, response) in found.items():
        # the square of a wave has the mean 1/2 over the sectors, that of a real one 1
        share = N / harmonics.multiplicity(k)
        S += share * np.real(waves.weights.conj().T @ response.beyond(limit) @ waves.weights)
    return S


@dataclass(frozen=True)
class CyclicObserver:
    """`blocks` {sector offset o: csr (rows, 3 nn)}."""

    name: str
    blocks: Mapping[int, Sparse]

    @property
    def rows(self) -> int:
        """Values per sector."""
        return next(iter(self.blocks.values())).shape[0]

    def harmonic(self, k: int, count: int) -> Sparse:
        """Operator (rows, 3 nn) on the wave of sector 0 in harmonic k of `count` sectors."""
        return sp.csr_matrix(sum(phase(k * o, count) * block for o, block in self.blocks.items()))


def selected_dofs(name: str, dofs: Array, size: int) -> CyclicObserver:
    """The displacements at `dofs` (r,) of `size` dofs of a sector."""
    entries = (np.ones(len(dofs)), (np.arange(len(dofs)), dofs))
    return CyclicObserver(name, {0: sp.csr_matrix(entries, shape=(len(dofs), size))})


@dataclass(frozen=True)
class ObservedModes:
    """An observer's values of the global modes: waves [(k, (rows, p))] of the harmonics that have modes, `rows` values.

    `combine` converts complex waves (n, p) of these harmonics into real fields (n, m) of the body's modes.
    """

    waves: list[tuple[int, Array]]
    rows: int
    combine: Callable[[list[Array]], Array]

    def real(self, sampled: Callable[[int, Array], Array]) -> Array:
        """Real values (n, m); `sampled(k, wave (rows, p)) -> (n, p)` gives `wave e^{i k s phi}` at the points."""
        if not self.waves:
            return np.real(sampled(0, np.zeros((self.rows, 0))))
        return self.combine([sampled(k, wave) for k, wave in self.waves])
