r"""Loads of turning on a rotationally periodic body, as waves of the harmonics 0, 1 and 2.

In sector axes with the axis e = (0, 0, 1) and d = (1, i, 0)/root 2 an angular velocity is `w = a e + b d + b* d*`. The
constant e has the same components in every sector, d turns as `e^{i s phi}` (`harmonics`). So the six products of w are

    a^2      -e x (e x X)                                        harmonic 0,
    |b|^2    -(d x (d* x X) + d* x (d x X))                      harmonic 0,
    a b      -(d x (e x X) + e x (d x X)),   and conjugate       harmonic 1,
    b^2      -d x (d x X),                   and conjugate       harmonic 2.

In cylindrical axes, r and z of the point about the centre of mass, the last two are `-e^{i theta} (z (e_r + i e_theta)
+ r e_z)/root 2` and `-e^{2 i theta} r (e_r + i e_theta)/2`: real in the coordinates of `waves`. With few sectors
harmonics coincide: of three, the conjugate of the wave 2 is one of harmonic 1; of four, the wave 2 is its own
conjugate's, and its real and imaginary part are two loads.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np

from warpffrf.model.reduced.inertia import PRODUCTS
from warpffrf.offline.cyclic.harmonics import DIRECTIONS, Harmonics
from warpffrf.offline.elastic import Array
from warpffrf.offline.inertia.centrifugal import TurningResponse

HARMONICS = 3  # 0, 1 and 2
# Imaginary part, of the largest entry, that is round-off: nodes lie on the mirror planes to 1e-10 (`waves.MIRRORED`).
REAL = 1e-9


@dataclass(frozen=True, eq=False)
class TurningWaves:
    """Loads of turning of one harmonic: `loads` (n_k, c) in its coordinates, and how much of each the
    products of the angular velocity in sector axes make, `weights` (c, 6) in the order of `PRODUCTS`: the load on
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
    # a wave that is real itself has real parts only
    return TurningWaves(k, F, np.real(W) if 2 * k == N else W)


def _real(F: Array, W: Array) -> tuple[Array, Array]:
    """The same loads as real columns: the imaginary parts, where there are any, become columns of their own."""
    apart = np.abs(np.imag(F)).max(axis=0, initial=0.0) > REAL * np.abs(F).max(axis=0, initial=0.0)
    F = np.concatenate([np.real(F), np.imag(F)[:, apart]], axis=1)
    return F, np.concatenate([W, 1j * W[apart]]) if apart.any() else W


def left_out_products(
    found: Mapping[int, tuple[TurningWaves, TurningResponse]], harmonics: Harmonics, limit: float
) -> Array:
    """S (6, 6) [kg m2 s4] of `inertia.centrifugal` for the whole body, sector axes: what modes up to `limit` [rad/s]
    lack, from the loads and responses of each harmonic."""
    N = harmonics.count
    S = np.zeros((6, 6))
    for k, (waves, response) in found.items():
        # the square of a wave has the mean 1/2 over the sectors, that of one which is real itself, 1
        share = N / harmonics.multiplicity(k)
        S += share * np.real(waves.weights.conj().T @ response.beyond(limit) @ waves.weights)
    return S
