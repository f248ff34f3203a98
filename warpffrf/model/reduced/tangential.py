r"""Tangential compliance of a contact surface: what friction needs beside the normal compliance.

Tangential tractions have two directions, 0: `e_theta`, around the axis, and 1: `t_z = (R' e_r + e_a)/sqrt(1 + R'^2)`,
along the meridian; with the outward normal `e_theta x t_z = n`. On their own grid (hats or cells, on the nodes of the
normal one) the coefficients of the tangential displacement, and what they add to the normal one, are

    u_t = mode_tangent q_g + D_tt f_t + D_nt^T f_n,      u_n = mode_normal q_g + D f_n + D_nt f_t,

f_t forces [N] `int psi_i tau dA` of both directions, `D_tt = M_t^-1 C_tt M_t^-1`, `D_nt = M_n^-1 C_nt M_t^-1`. Of a
cell the coefficient is the mean displacement and the force the traction times the area.
"""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np

from warpffrf.model.reduced.contact_grid import ContactGrid
from warpffrf.model.reduced.recovery import Recovery


@dataclass(frozen=True, eq=False)
class Tangential:
    """Tangential part of a contact surface, block-circulant like its normal compliance.

    With `c` columns and `r` rows of a sector and the flat index `d*c*r + j*r + k` of direction d within a sector:
    `lags_tt (L, 2 c r, 2 c r)`, `lags_nt (L, c r, 2 c r)` [m/N], rows of the latter normal coefficients;
    block (s, s') of the operators is `lags[(s - s') mod L]`. Columns and rows are those of the normal grid.
    """

    grid: ContactGrid
    lags_tt: np.ndarray
    lags_nt: np.ndarray
    mode_tangent: np.ndarray  # (2, columns rows, m) m per unit modal coordinate
    recovery: Recovery  # its transfer has 2 c r columns a sector

    def compliance(self, columns: np.ndarray) -> np.ndarray:
        """D_tt (2 w r, 2 w r) [m/N] of the given grid `columns` (w,), ordered by direction, column, row."""
        c, r = self.grid.columns_per_sector, self.grid.rows
        lags = self.lags_tt.reshape(len(self.lags_tt), 2, c, r, 2, c, r)
        sector, part = columns // c, columns % c
        lag = (sector[:, None] - sector[None, :]) % len(lags)
        blocks = lags[lag, :, part[:, None], :, :, part[None, :], :]  # (w, w, 2, r, 2, r)
        return blocks.transpose(2, 0, 3, 4, 1, 5).reshape(2 * len(columns) * r, -1)

    def coupling(self, normal_columns: np.ndarray, columns: np.ndarray) -> np.ndarray:
        """D_nt (v r, 2 w r) [m/N]: normal coefficients at `normal_columns` (v,) per force on `columns` (w,)."""
        c, r = self.grid.columns_per_sector, self.grid.rows
        lags = self.lags_nt.reshape(len(self.lags_nt), c, r, 2, c, r)
        lag = (normal_columns[:, None] // c - columns[None, :] // c) % len(lags)
        blocks = lags[lag, (normal_columns % c)[:, None], :, :, (columns % c)[None, :], :]  # (v, w, r, 2, r)
        return blocks.transpose(0, 2, 3, 1, 4).reshape(len(normal_columns) * r, -1)

    def recover(self, forces: np.ndarray) -> np.ndarray:
        """Displacement (n, 3) [m], user axes, of the display points under forces (2, columns, rows) [N]."""
        c, r, recovery = self.grid.columns_per_sector, self.grid.rows, self.recovery
        whole = np.zeros((2, c * recovery.sectors, r))
        place = recovery.offset + recovery.stride * np.arange(self.grid.columns)
        whole[:, place % whole.shape[1]] = forces
        by_sector = whole.reshape(2, recovery.sectors, c, r).transpose(1, 0, 2, 3).reshape(-1, r)
        return replace(recovery, offset=0, stride=1).apply(by_sector, 2 * c)
