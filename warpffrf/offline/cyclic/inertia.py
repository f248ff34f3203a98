r"""Inertia invariants of a rotationally periodic body, from one sector's share of each mode.

A wave of harmonic k moves sector s by `u e^{i k s phi}` in the sector's own axes. In axes at rest its components along
`e_+ , e_-`: `u^+- = u_x +- i u_y`, and `u^z`, are scalar waves of the harmonics k + 1, k - 1 and k. The mass matrix of
finite elements is the same scalar one for every component and every axes, with factors m_A (within a sector) and m_B
(to the next), so that the scalar wave of harmonic l sees `m_l = m_A + e^{i l phi} m_B + e^{-i l phi} m_B^T`, and

    int a b dm = N a^T m_l b   where harmonics h of a and l of b have h + l = 0 modulo N, else zero.

So J1 comes from the harmonics 0, 1 and 2 alone, and J2 and G couple harmonics that differ, or sum to N, by at most 2:
all else is never computed. The position X is itself a wave of harmonic 0. A real mode `Re z` or `Im z` is made of the
waves z of harmonic k and conj(z) of -k.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
import scipy.sparse as sp

from warpffrf.model.reduced.inertia import InertiaTerms
from warpffrf.offline.cyclic.real_modes import HarmonicModes
from warpffrf.offline.cyclic.sector import Sector, phase
from warpffrf.offline.fe.assembly import Sparse
from warpffrf.offline.inertia.invariants import from_moments

Array = np.ndarray
SHIFTS = (1, -1, 0)  # of the harmonic, in axes at rest: of the components +, -, z
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

    Real modes are ordered as in `RealModes`: ascending in frequency, the two of a pair beside each other.
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
