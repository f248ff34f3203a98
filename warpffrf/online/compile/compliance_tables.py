"""Operators of contact surfaces in the layouts that the kernels read.

An operator between two surfaces is block-circulant like D of `ContactSurface`: (sectors, lines of a block of the
target, lines of a block of the source), or dense, which is the case of one sector.
"""

from __future__ import annotations

import numpy as np

from warpffrf.model.reduced.contact_surface import ContactSurface

Array = np.ndarray


def modal_moments(surface: ContactSurface) -> Array:
    """M Phi (nodes, modes): weak normal displacement of the global modes at the nodes of the grid."""
    grid = surface.grid
    phi = surface.mode_normal.reshape(grid.columns, grid.rows, -1)
    return np.einsum("kl,jlm->jkm", surface.gram_z, grid.along_theta(phi))


def columns_of_turn(surface: ContactSurface) -> int:
    """Columns of the full circumference in the compliance of a surface, 0 where it covers an arc."""
    sectors = len(surface.lags)
    whole = sectors > 1 or surface.grid.periodic
    return sectors * surface.lags.shape[1] // surface.grid.rows if whole else 0


def node_gram(surface: ContactSurface, sectors: int | None = None) -> Array:
    """M_psi of the nodes [m^2], block-circulant like D, or in `sectors` sectors, 1: dense."""
    grid = surface.grid
    sectors = len(surface.lags) if sectors is None else sectors
    if sectors == 1:
        return np.kron(grid.gram_theta(), surface.gram_z)[None]
    side = surface.lags.shape[1]
    c = side // grid.rows
    theta = np.zeros((sectors, c, c))
    j = np.arange(c)
    theta[0, j, j] = 2.0 / 3.0 * grid.pitch
    for shift in (1, -1):  # node j overlaps node j + shift, which may be in the next sector
        other = j + shift
        theta[(-(other // c)) % sectors, j, other % c] += grid.pitch / 6.0
    return np.einsum("nab,kl->nakbl", theta, surface.gram_z).reshape(sectors, side, side)


def product(*operators: Array) -> Array:
    """Product of block-circulant operators, harmonic by harmonic on a full circumference; of dense ones by
    multiplication.
    """
    sectors = len(operators[0])
    turned = [np.fft.rfft(A, axis=0) for A in operators] if sectors > 1 else operators
    total = turned[0]
    for A in turned[1:]:
        total = total @ A
    return np.fft.irfft(total, n=sectors, axis=0) if sectors > 1 else total


def transposed(operator: Array) -> Array:
    """The transpose, (-k) mod sectors at lag k."""
    return np.roll(operator[::-1], 1, axis=0).transpose(0, 2, 1)


def by_column(operator: Array, target: tuple[int, int], source: tuple[int, int]) -> Array:
    """`operator` (sectors, target lines, source lines) as (sectors, column, line, column, line): `target` and `source`
    are directions (1 for normal, 2 for tangential lines, which precede the columns) and rows.
    """
    shape = []
    for (directions, rows), lines in zip((target, source), operator.shape[1:], strict=True):
        shape += [directions, lines // (directions * rows), rows]
    parted = operator.reshape(-1, *shape).transpose(0, 2, 1, 3, 5, 4, 6)
    (dt, rt), (ds, rs) = target, source
    return parted.reshape(len(operator), shape[1], dt * rt, shape[4], ds * rs)


def response_table(blocks: Array, reach: int, turns: bool) -> Array:
    """Table (column of the block, source line, target column + reach, target line) of `by_column`.

    The response to a line along the columns of a window is one contiguous run, for any block: kernels add such runs.
    Columns are counted from the source's block; with `turns` they continue beyond a dense block, else they are zero,
    where the grid has no nodes.
    """
    sectors, c = blocks.shape[:2]
    column = np.arange(-reach, c + reach)
    table = blocks[(column // c) % sectors, column % c].transpose(2, 3, 0, 1).copy()
    if sectors == 1 and not turns:
        table[:, :, (column < 0) | (column >= c)] = 0.0
    return table
