r"""Compliance between two contact surfaces of one body: what loads on one do to the other through the local modes.

A load on one surface deforms the whole body. The part of it that the global modes have is in their coordinates; what
is left is the residual response, the same that makes a surface's own compliance. Seen at another surface t under a load
on s, in the coefficients and forces of `ContactSurface` and `Tangential`,

    u_n^t += D_ts f_n^s + D_nt f_t^s,      u_t^t += D_tn f_n^s + D_tt f_t^s,

    D_ts = M_t^-1 C_ts M_s^-1,      C_ts = (B psi)_t^T G_res (B psi)_s,      G_res = G - Phi_g omega^-2 Phi_g^T,

normals outward on each surface, tangential directions those of each surface. G_res is symmetric, so the other
direction is the transpose, and own and foreign compliances are together the Gram matrix of G_res,

    [D_tt^own  D_ts; D_ts^T  D_ss^own]   symmetric positive semidefinite,      |D_ts,ij|^2 <= D_tt,ii D_ss,jj.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

Array = np.ndarray
# Directions of the functions of target and source, by array: 1 normal, 2 tangential.
FUNCTIONS = {"lags": (1, 1), "lags_tt": (2, 2), "lags_nt": (1, 2), "lags_tn": (2, 1)}


@dataclass(frozen=True, eq=False)
class CrossCompliance:
    """Displacement of contact surface `target` under loads on contact surface `source` of the same body, by the local
    modes, in the layout of `ContactSurface.lags`:

        D[(j,k),(j',k')] = lags[(j//c_t - j'//c_s) mod sectors][(j%c_t) rows_t + k, (j'%c_s) rows_s + k'],

    c_t, c_s columns of a sector of both grids, `columns = sectors c`. Two full turns of a periodic body whose columns
    repeat alike keep their sectors; everywhere else `sectors` is 1 and c all columns. Tangential functions of a sector
    are numbered by direction, column, row.
    """

    target: str
    source: str
    lags: Array  # (sectors, c_t rows_t, c_s rows_s) m/N: normal per normal force
    lags_tt: Array | None = None  # (sectors, 2 c_t rows_t, 2 c_s rows_s) m/N: tangential per tangential force
    lags_nt: Array | None = None  # (sectors, c_t rows_t, 2 c_s rows_s) m/N: normal at target per tangential on source
    lags_tn: Array | None = None  # (sectors, 2 c_t rows_t, c_s rows_s) m/N: tangential at target per normal on source

    def transposed(self) -> CrossCompliance:
        """The same with target and source swapped: D_st = D_ts^T."""
        of_directions = {directions: key for key, directions in FUNCTIONS.items()}
        swapped = {}
        for key, lags in self.arrays().items():
            a, b = FUNCTIONS[key]
            swapped[of_directions[b, a]] = _swapped(lags)
        return CrossCompliance(self.source, self.target, **swapped)

    def arrays(self) -> dict[str, Array]:
        """The arrays that there are, by name."""
        return {key: lags for key in FUNCTIONS if (lags := getattr(self, key)) is not None}

    def whole(self, key: str = "lags") -> Array:
        """The operator of the array `key`, all functions of the target by all of the source, [m/N], each numbered by
        direction, column, row."""
        lags = self.arrays()[key]
        sector = np.arange(len(lags))
        blocks = lags[(sector[:, None] - sector) % len(lags)]  # (target's sector, source's sector, rows, columns)
        (a, b), (L, _, m, n) = FUNCTIONS[key], blocks.shape
        return blocks.reshape(L, L, a, m // a, b, n // b).transpose(2, 0, 3, 4, 1, 5).reshape(L * m, L * n)


def _swapped(lags: Array) -> Array:
    """Blocks of the transpose: [l] = lags[-l]^T."""
    return np.ascontiguousarray(np.roll(lags[::-1], 1, axis=0).swapaxes(1, 2))
