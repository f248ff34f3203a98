"""Operators of contact surfaces in the layouts that the kernels read."""

from __future__ import annotations

import numpy as np

from warpffrf.model.contact_surface import ContactSurface


def modal_moments(surface: ContactSurface) -> np.ndarray:
    """M Phi (nodes, modes): weak normal displacement of the global modes on the hats of the grid."""
    grid = surface.grid
    phi = surface.mode_normal.reshape(grid.columns, grid.rows, -1)
    return np.einsum("kl,jlm->jkm", surface.gram_z, grid.along_theta(phi))


def hat_gram(surface: ContactSurface) -> np.ndarray:
    """M_psi of the hats [m^2], block-circulant like D."""
    grid = surface.grid
    sectors, side = surface.lags.shape[:2]
    c = side // grid.rows
    if sectors == 1:
        return np.kron(grid.gram_theta(), surface.gram_z)[None]
    theta = np.zeros((sectors, c, c))
    j = np.arange(c)
    theta[0, j, j] = 2.0 / 3.0 * grid.pitch
    for shift in (1, -1):  # hat j overlaps hat j + shift, which may stand in the next sector
        other = j + shift
        theta[(-(other // c)) % sectors, j, other % c] += grid.pitch / 6.0
    return np.einsum("nab,kl->nakbl", theta, surface.gram_z).reshape(sectors, side, side)


def weak_compliance(surface: ContactSurface, compliance: float = 0.0) -> np.ndarray:
    """C = M D M + M `compliance`, block-circulant like D: weak displacement of hat i under a unit pressure hat j
    [m^3/Pa], with a layer between the surfaces that yields by `compliance` [m/Pa] (`warpffrf.model.laws`).

    On a turn the two products are taken harmonic by harmonic; a dense operator is multiplied out.
    """
    M, lags = hat_gram(surface), surface.lags
    if len(lags) == 1:
        return M @ lags @ M + compliance * M
    M_hat, D_hat = np.fft.rfft(M, axis=0), np.fft.rfft(lags, axis=0)
    return np.fft.irfft(M_hat @ D_hat @ M_hat, n=len(lags), axis=0) + compliance * M


def response_table(surface: ContactSurface, lags: np.ndarray, reach: int) -> np.ndarray:
    """Block-circulant `lags` as a table (column of the block, source row, target column + reach, target row).

    The response to a hat along the columns of a window is one contiguous run, whatever the block: kernels add such
    runs. Columns are counted from the source's block; a dense operator on an arc is padded with zeros, where the grid
    has no nodes.
    """
    grid = surface.grid
    sectors, side = lags.shape[:2]
    c = side // grid.rows
    column = np.arange(-reach, c + reach)
    blocks = lags.reshape(sectors, c, grid.rows, c, grid.rows)
    table = blocks[(column // c) % sectors, column % c].transpose(2, 3, 0, 1).copy()
    if sectors == 1 and not grid.periodic:
        table[:, :, (column < 0) | (column >= c)] = 0.0
    return table
