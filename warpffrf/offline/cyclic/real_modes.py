r"""The global modes of all harmonics of a periodic body as real modes.

A complex mode `u` of harmonic 0 < k < N/2 with `u^H M_k u = 1` stands for the two real modes
`sqrt(2/N) Re, Im (u e^{i k s phi})`; one of k = 0 or N/2 for `u e^{i k s phi}/sqrt(N)`.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from warpffrf.model.reduced.recovery import sector_to_user
from warpffrf.offline.cyclic.harmonics import DIRECTIONS
from warpffrf.offline.elastic import Array


@dataclass
class HarmonicModes:
    """Global modes of one harmonic: omega (p,), sector displacement (3 nn, p), interface amplitudes (2 i, p), on each
    contact surface the coefficients of the displacement in each field (count, p), and the observers' values
    (rows, p)."""

    k: int
    omega: Array
    shape: Array
    interface: Array
    fields: list[list[Array]]
    observed: list[Array]


class RealModes:
    """The complex modes of all harmonics as real modes, ascending in frequency, the two of a pair beside each other."""

    def __init__(self, N: int, found: list[HarmonicModes]) -> None:
        self.N, self.found = N, found
        omega, self._kinds = [], []
        for h in found:
            pair = 0 < h.k and 2 * h.k != N
            for w in h.omega:
                omega += [w] * (2 if pair else 1)
            self._kinds.append(pair)
        self._order = np.argsort(np.array(omega), kind="stable")
        self.omega = np.array(omega)[self._order]

    def combine(self, waves: list[Array]) -> Array:
        """Real fields (rows, m) from the complex waves (rows, p) of each harmonic."""
        columns = []
        for wave, pair in zip(waves, self._kinds, strict=True):
            if pair:
                scale = np.sqrt(2.0 / self.N)
                columns.append(np.stack([np.real(wave), np.imag(wave)], axis=2).reshape(len(wave), -1) * scale)
            else:
                columns.append(np.real(wave) / np.sqrt(self.N))
        if not columns:
            return np.zeros((0, 0))
        return np.concatenate(columns, axis=1)[:, self._order]

    def interface_motion(self, j: int, axes: Array) -> Array:
        """Translation and rotation (m, 6) of interface j, user axes."""
        waves = []
        for h in self.found:
            motion = np.zeros((6, len(h.omega)), dtype=complex)
            if h.k in DIRECTIONS:
                d = axes @ DIRECTIONS[h.k]
                motion[:3] = d[:, None] * h.interface[2 * j]
                motion[3:] = d[:, None] * h.interface[2 * j + 1]
            waves.append(motion)
        return self.combine(waves).T if waves else np.zeros((0, 6))

    def skin(self, dofs: Array, axes: Array) -> Array:
        """Displacement of the display points (m, n, 3) float32, user axes."""
        N, points = self.N, len(dofs) // 3
        fields = np.zeros((len(self.omega), N * points, 3), dtype=np.float32)
        place = np.argsort(self._order)
        row = 0
        for h, pair in zip(self.found, self._kinds, strict=True):
            wave = np.exp(2j * np.pi * h.k * np.arange(N) / N)[:, None, None]
            for p in range(len(h.omega)):
                u = wave * h.shape[dofs, p].reshape(1, points, 3)
                parts = (u.real, u.imag) if pair else (u.real,)
                scale = np.sqrt(len(parts) / N)
                for part in parts:
                    fields[place[row]] = scale * sector_to_user(part, axes)
                    row += 1
        return fields

    def facts(self) -> dict:
        """Harmonics that carry global modes, for the report."""
        return {"harmonics_with_modes": [int(h.k) for h in self.found]}
