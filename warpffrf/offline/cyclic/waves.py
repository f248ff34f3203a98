r"""Matrices of all harmonics of a sector as sums of few constant ones, real where the sector is its own mirror image.

In harmonic k the matrix of a sector is `K_k = A + e^{ik phi} B + e^{-ik phi} B^T`, complex and Hermitian. On a mesh of
node planes that is mirrored at each of them it is real in other coordinates. Describe the displacement of node a, at
angle theta_a, in its own cylindrical axes, without the phase of the wave, the circumferential part turned by i:

    u_a = e^{i k theta_a} (v_r e_r + i v_theta e_theta + v_z e_z)      u = Q_k v,  Q_k unitary.

The mirror theta -> -theta turns the wave k into the wave -k and changes the sign of u_theta; complex conjugation turns
it back. Both together leave every v as it is where each node is mirrored to itself (theta_a = 0 or phi/2, modulo phi),
so `Q_k^H K_k Q_k` is its own conjugate: real and symmetric, a quarter of the work and half of the memory. With
`delta = theta_b - theta_a` (the angle between the nodes themselves, of whatever sectors) an entry K_ab between them
contributes, K_ab in cylindrical axes,

    Re(s e^{i k delta}) K_ab = cos(k delta) K_ab   (s = 1: both or none circumferential),
                               sin(k delta) K_ab   (s = -i: row circumferential),  - sin(k delta) K_ab  (s = i: column),

with as many different |delta| as the distances of coupled node planes. Whether a sector is such a one is found by
looking at the imaginary part in one harmonic (`MIRRORED`); where it is not, Q_k = 1 and the three complex terms stay.
So they do in the harmonics 0 and N/2, where they are real anyway and a real mode must stay a real displacement.
"""

from __future__ import annotations

import numpy as np
import scipy.sparse as sp

from warpffrf.offline.cyclic.sector import Sector, phase
from warpffrf.offline.fe.assembly import Sparse

Array = np.ndarray
# Imaginary part, relative to the largest entry, below which a sector is its own mirror image: round-off of cells a
# thousandth of the radius wide is 1e-12. What is left out is then below the agreement with the general path, 1e-9.
MIRRORED = 1e-10
SAME_ANGLE = 1e-9  # rad; angles between node planes closer than this are one: planes are 1e-4 rad apart at least
MOST_TERMS = 16  # more different angles between coupled nodes than this cost more than complex arithmetic


class Waves:
    """K and M of every harmonic in the coordinates v, `K_k = sum_t coefficient_t(k) terms[t]`, and Q_k.

    `mirrored`: whether the sector is its own mirror image, `angles` (d,) [rad]: the |delta| that occur.
    """

    def __init__(self, sector: Sector) -> None:
        self.sector = sector
        x, y, _ = sector.coordinates.T
        self.theta = np.arctan2(y, x)
        self.theta[np.hypot(x, y) == 0.0] = 0.0
        self._turn = _cylindrical(self.theta)
        pairs = {"K": sector.K, "M": sector.M}
        self._sector_terms = {name: [A, B, sp.csr_matrix(B.T)] for name, (A, B) in pairs.items()}
        self._mirror_terms: dict[str, list[Sparse]] = {}
        self.mirrored, self.angles = self._is_mirrored(), np.zeros(0)
        if self.mirrored:
            self.angles = _distinct(np.abs(np.concatenate([self._entries(pair)[3] for pair in pairs.values()])))
            self.mirrored = len(self.angles) <= MOST_TERMS
        if self.mirrored:
            self._mirror_terms = {name: self._real_terms(pair) for name, pair in pairs.items()}

    @property
    def count(self) -> int:
        """Number of sectors N."""
        return self.sector.count

    def mirrored_at(self, k: int) -> bool:
        """Whether harmonic k is described in mirrored coordinates; elsewhere Q_k = 1."""
        return self.mirrored and 0 < 2 * k < self.count

    def real_at(self, k: int) -> bool:
        """Whether the matrices of harmonic k are real."""
        return self.mirrored or k == 0 or 2 * k == self.count

    def terms(self, what: str, k: int) -> list[Sparse]:
        """The constant matrices (3 nn, 3 nn) of "K" or "M" that make harmonic k."""
        return (self._mirror_terms if self.mirrored_at(k) else self._sector_terms)[what]

    def coefficients(self, k: int) -> Array:
        """What the terms are multiplied by in harmonic k."""
        if self.mirrored_at(k):
            return np.concatenate([np.cos(k * self.angles), np.sin(k * self.angles)])
        e = phase(k, self.count)
        return np.array([1.0, e, np.conj(e)])

    def matrix(self, what: str, k: int) -> Sparse:
        """Q_k^H K_k Q_k or Q_k^H M_k Q_k (3 nn, 3 nn)."""
        total = sum(c * term for c, term in zip(self.coefficients(k), self.terms(what, k), strict=True))
        return sp.csr_matrix(total)

    def basis(self, k: int) -> Sparse:
        """Q_k (3 nn, 3 nn): sector displacement u = Q_k v."""
        if not self.mirrored_at(k):
            return sp.identity(3 * self.sector.nodes, format="csr")
        return self._mirror_basis(k)

    def _mirror_basis(self, k: int) -> Sparse:
        wave = np.exp(1j * k * self.theta)[:, None] * np.array([1.0, 1.0j, 1.0])
        return sp.csr_matrix(self._turn @ sp.diags(wave.ravel()))

    def _is_mirrored(self) -> bool:
        k = max(2, self.count // 3)  # large enough for planes a pitch apart to be a third of a turn out of phase
        Q = self._mirror_basis(k)
        for pair in (self.sector.K, self.sector.M):
            v = Q.conj().T @ self.sector.harmonic(pair, k) @ Q
            if np.abs(v.imag).max() > MIRRORED * np.abs(v.real).max():
                return False
        return True

    def _entries(self, pair: tuple[Sparse, Sparse]) -> tuple[Array, Array, Array, Array]:
        """Row, column, value in cylindrical axes, and delta [rad], of all entries of A, B and B^T."""
        A, B = pair
        rows, columns, values, deltas = [], [], [], []
        for offset, block in ((0, A), (1, B), (-1, sp.csr_matrix(B.T))):
            local = sp.coo_matrix(self._turn.T @ block @ self._turn)
            rows.append(local.row)
            columns.append(local.col)
            values.append(local.data)
            angle = self.theta[local.col // 3] - self.theta[local.row // 3]
            deltas.append(angle + offset * self.sector.phi)
        return np.concatenate(rows), np.concatenate(columns), np.concatenate(values), np.concatenate(deltas)

    def _real_terms(self, pair: tuple[Sparse, Sparse]) -> list[Sparse]:
        """The terms of cos(k |delta|) for each of `angles`, then those of sin(k |delta|)."""
        n = 3 * self.sector.nodes
        row, column, value, delta = self._entries(pair)
        middle = 0.5 * (self.angles[1:] + self.angles[:-1])
        which = np.searchsorted(middle, np.abs(delta))
        row_turned, column_turned = row % 3 == 1, column % 3 == 1
        alike = row_turned == column_turned
        signed = value * np.where(row_turned, 1.0, -1.0) * np.sign(delta)
        terms = []
        for part, entries in ((alike, value), (~alike, signed)):
            for i in range(len(self.angles)):
                here = part & (which == i)
                terms.append(sp.csr_matrix((entries[here], (row[here], column[here])), shape=(n, n)))
        return terms


def _distinct(values: Array) -> Array:
    ordered = np.sort(values)
    starts = np.concatenate([[True], np.diff(ordered) > SAME_ANGLE])
    return ordered[starts]


def _cylindrical(theta: Array) -> Sparse:
    """Block-diagonal (3 n, 3 n): columns are e_r, e_theta, e_z at each node in the sector's axes."""
    n = len(theta)
    c, s = np.cos(theta), np.sin(theta)
    blocks = np.zeros((n, 3, 3))
    blocks[:, 0, 0], blocks[:, 0, 1] = c, -s
    blocks[:, 1, 0], blocks[:, 1, 1] = s, c
    blocks[:, 2, 2] = 1.0
    return sp.csr_matrix(sp.bsr_matrix((blocks, np.arange(n), np.arange(n + 1)), shape=(3 * n, 3 * n)))
