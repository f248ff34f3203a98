r"""Stress operators of a rotationally periodic body: from the whole mesh to blocks between sectors.

Each sector's displacement u_s is given in its own axes A_s (columns), u = A_s u_s at its nodes, and the stress of a
point in sector s in the axes of that sector, sigma_s = A_s^T sigma A_s. An operator S on all nodes becomes

    sigma_s = sum_o S_o u_(s+o),      S_o = R(A_s^T) S A_(s+o),

R(A) the turn of the six components; a point and its copies in other sectors have the same S_o. Nodal averaging of
linear cells reaches one cell beyond the point's own, patches of quadratic ones two: o runs over as many sectors as they
touch.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
import scipy.sparse as sp

from warpffrf.model.reduced.stress_field import rotated, sector_frames
from warpffrf.offline.fe.assembly import Sparse

Array = np.ndarray
SAME_PLACE = 1e-9  # of the body's size: points of turned sectors this close are one place


@dataclass(frozen=True)
class SectorOperator:
    """Stress at the distinct places of the points, for a rotationally periodic body.

    `blocks` {o: csr (6 p0, 3 nn)} [Pa/m] act on the displacements of sector o (counted from the point's own), given in
    that sector's axes; the result is in the axes of the point's sector. `place` (p,), `sector` (p,), `axes` (3, 3).
    """

    blocks: dict[int, Sparse]
    place: Array
    sector: Array
    axes: Array
    sectors: int

    def sampled(self, k: int, wave: Array) -> Array:
        """Waves `wave` (6 p0, m) e^{i k s phi} of harmonic k at the points: (6 p, m), complex, user axes."""
        turn = np.exp(2j * np.pi * (k * self.sector % self.sectors) / self.sectors)
        parts = wave.reshape(len(wave) // 6, 6, wave.shape[1])[self.place] * turn[:, None, None]
        frames = sector_frames(self.axes, self.sector, self.sectors)
        found = np.moveaxis(rotated(np.moveaxis(parts, 2, 0), frames), 0, 2)
        return found.reshape(6 * len(found), wave.shape[1])


def sector_blocks(S: Sparse, home: Array, axes: Array, sectors: int) -> dict[int, Sparse]:
    """{o: csr (6 r, 3 nn)} of S, csr (6 r, 3 n) [Pa/m] in user axes, for points in the sectors `home` (r,)."""
    n = S.shape[1] // 3
    nn = n // sectors
    by_node = sp.bsr_matrix(S.tobsr((6, 3)))
    row = np.repeat(np.arange(len(home)), np.diff(by_node.indptr))
    node = by_node.indices.astype(np.int64)
    frames = sector_frames(axes, np.arange(sectors), sectors)
    data = by_node.data @ frames[node // nn]  # (e, 6, 3)
    back = frames[home][row].swapaxes(1, 2)[:, None]
    data = np.moveaxis(rotated(np.moveaxis(data, 2, 1), back), 1, 2)
    offset = (node // nn - home[row] + sectors // 2) % sectors - sectors // 2
    blocks = {}
    for o in np.unique(offset):
        part = offset == o
        rows = np.broadcast_to(6 * row[part][:, None, None] + np.arange(6)[:, None], data[part].shape)
        columns = np.broadcast_to(3 * (node[part] % nn)[:, None, None] + np.arange(3), data[part].shape)
        entries = (data[part].ravel(), (rows.ravel(), columns.ravel()))
        blocks[int(o)] = sp.csr_matrix(entries, shape=(6 * len(home), 3 * nn))
    return blocks


def distinct_places(
    relative: Array, home: Array, marks: Array, axes: Array, size: float, sectors: int
) -> tuple[Array, Array]:
    """One point (p0,) of each distinct place in a sector, and the place (p,) of every point.

    `relative` (p, 3) [m] to a point on the axis, user axes; `size` [m] of the body. Points whose copies in one sector
    coincide share a place when their `marks` (p,) agree: a contact surface may end within the turn.
    """
    local = np.einsum("pj,pji->pi", relative, sector_frames(axes, home, sectors))
    keys = np.column_stack([np.rint(local / (SAME_PLACE * size)), marks])
    _, first, place = np.unique(keys, axis=0, return_index=True, return_inverse=True)
    return first, place.ravel()
