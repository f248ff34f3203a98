r"""What the forces of a lap's cells are on the cells of its faces.

A body knows what forces on all cells of all its laps do, `f` (N,), lap after lap as in `ReducedBody.laps`, three a cell
along the rows of its frame (`LapSurface`). Of a lap in a scene the forces s (3 c,) act on the second face and their
opposite on the first, so that on a body

    f = P s,    P = 1 of a pair of faces of that body,    -1 of a first face,    w_cj F_j T F_c^T of a second one,

with the share w_cj of cell c that cell j of the second face carries (`pairing`), the frames F_c and F_j in the axes of
their bodies, and T from the axes of the first to those of the second. P^T takes displacements of cells of the body to
what the lap sees of them.
"""

from __future__ import annotations

from collections.abc import Mapping

import numpy as np
import scipy.sparse as sp

from warpffrf.model.laps.lap_surface import LapSurface

Array = np.ndarray


def places(laps: Mapping[str, LapSurface]) -> dict[str, slice]:
    """Which of the N forces of a body those of each of its laps are."""
    ends = np.cumsum([0, *(surface.unknowns for surface in laps.values())])
    return {name: slice(int(a), int(b)) for name, a, b in zip(laps, ends[:-1], ends[1:], strict=True)}


def count(laps: Mapping[str, LapSurface]) -> int:
    """N, the number of forces on all laps of a body."""
    return sum(surface.unknowns for surface in laps.values())


def on_own(laps: Mapping[str, LapSurface], name: str, cell: Array) -> sp.csr_matrix:
    """P (N, 3 c) on the body of the first face, or of both, whose lap `name` has the cells with the numbers `cell`
    (c,)."""
    n = 3 * len(cell)
    rows = places(laps)[name].start + (3 * np.asarray(cell)[:, None] + np.arange(3)).ravel()
    sign = 1.0 if laps[name].pair else -1.0
    return sp.csr_matrix((np.full(n, sign), (rows, np.arange(n))), shape=(count(laps), n))


def on_partner(laps: Mapping[str, LapSurface], name: str, weights: sp.csr_matrix, frames: Array) -> sp.csr_matrix:
    """P (N, 3 c) on the body of the second face, its lap `name`; weights (c, cells of that face), frames (c, 3, 3) of
    the lap's cells, in rows, in the axes of this body."""
    shares = sp.coo_matrix(weights)
    blocks = np.einsum("kai,kbi->kab", laps[name].frames[shares.col], frames[shares.row]) * shares.data[:, None, None]
    rows = places(laps)[name].start + 3 * shares.col[:, None, None] + np.arange(3)[:, None] + np.zeros((3, 3), int)
    columns = 3 * shares.row[:, None, None] + np.arange(3)[None, :] + np.zeros((3, 3), int)
    shape = count(laps), 3 * len(frames)
    return sp.csr_matrix((blocks.ravel(), (rows.ravel(), columns.ravel())), shape=shape)
