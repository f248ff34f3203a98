"""Displacements of points of a body from the forces on the hats of one of its contact surfaces."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np


@dataclass(frozen=True, eq=False)
class Recovery:
    """Displacement of the display points under hat forces: block-circulant, applied by FFT over the sectors.

    `transfer` (N//2 + 1, 3 p, c rows) complex64: displacement of one sector's `p` display points, in that sector's own
    axes, per harmonic amplitude of the hat forces. `axes` (3, 3): columns are the axes of sector 0 in user axes, the
    third is the axis of rotation. A body without periodicity has one sector and a real transfer (1, 3 n, hats).
    Grid column j is column `offset + j*stride` of the `c*N` columns that the harmonics count.
    """

    transfer: np.ndarray
    sectors: int
    axes: np.ndarray
    offset: int = 0
    stride: int = 1

    def apply(self, forces: np.ndarray, columns_per_sector: int) -> np.ndarray:
        """Displacement (n, 3) [m], user axes, of hat forces (columns, rows) [N]."""
        N = self.sectors
        columns, rows = forces.shape
        whole = np.zeros((columns_per_sector * N, rows)) if N > 1 else np.zeros((columns, rows))
        whole[(self.offset + self.stride * np.arange(columns)) % len(whole)] = forces
        blocks = whole.reshape(N, -1)
        if N == 1:
            return (self.transfer[0] @ blocks[0].astype(self.transfer.dtype)).reshape(-1, 3).astype(np.float64)
        amplitudes = np.fft.rfft(blocks, axis=0)
        response = np.einsum("hpi,hi->hp", self.transfer, amplitudes)
        u = np.fft.irfft(response, n=N, axis=0).reshape(N, -1, 3)
        return sector_to_user(u, self.axes)


def sector_to_user(u: np.ndarray, axes: np.ndarray) -> np.ndarray:
    """Vectors (N, p, 3) given in the axes of their own sectors -> (N p, 3) in user axes.

    Sector s is sector 0 turned by `2 pi s/N` about the third of `axes` (3, 3, columns = axes of sector 0).
    """
    N = len(u)
    angle = 2.0 * np.pi * np.arange(N)[:, None] / N
    c, s = np.cos(angle), np.sin(angle)
    turned = np.stack([c * u[..., 0] - s * u[..., 1], s * u[..., 0] + c * u[..., 1], u[..., 2]], axis=-1)
    return turned.reshape(-1, 3) @ axes.T
