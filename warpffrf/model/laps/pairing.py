r"""Which cells of two faces lie on each other at the initial pose, and how forces of a cell act on the other face.

Triangles of the first face are cut by those of the second, seen along the normals of the first (`facing`). A cell of
the first face that is covered is a cell of the lap; its force acts on the cells of the second face in proportion to the
areas that they share, and what it sees of the second face is the mean of their displacements with the same weights, so
that the two are conjugate. At the outline of the overlap cells of the first face are taken whole: the force acts on all
of the cell, and on the cells of the second face that it covers. The gap of a cell is the mean distance along its
normal.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
import scipy.sparse as sp

from warpffrf.model.errors import InputError
from warpffrf.model.laps.facing import Triangles, facing, why_apart

Array = np.ndarray
LEAST = 1e-2  # of a cell's area: less of it covered is none


@dataclass(frozen=True, eq=False)
class Pairing:
    """Cells of the lap, c of them: `cell` (c,) on the first face, `covered` (c,) the covered share of its area, `gap`
    (c,) [m], `weights` (c, cells of the second face) csr, rows that add up to 1; `shares` of both faces' areas that
    face each other, `distance` [m] mean and largest gap."""

    cell: Array
    covered: Array
    gap: Array
    weights: sp.csr_matrix
    shares: tuple[float, float]

    @property
    def distance(self) -> tuple[float, float]:
        return float(self.gap.mean()), float(self.gap.max())


def pair_faces(label: str, first: Array, cell: Array, normals: Array, second: Array, other: Array) -> Pairing:
    """The pairing of two faces in common axes.

    first (t, 3, 3), second (u, 3, 3): corners of their triangles [m], outwards; cell (t,), other (u,): the cells that
    these are of; normals (cells of the first face, 3). Raises `InputError`, naming `label`, where they do not face each
    other.
    """
    a, b = Triangles.of(first), Triangles.of(second)
    pieces = facing(a, b)
    cells, of = int(cell.max()) + 1, cell[pieces.source]
    area = np.bincount(of, weights=pieces.area, minlength=cells)
    covered = area / np.bincount(cell, weights=a.area, minlength=cells)
    lap = np.flatnonzero(covered > LEAST)
    if not len(lap):
        raise InputError(
            f"{label}: the faces do not face each other: {why_apart(a, b, pieces.covered)}; place the bodies so that "
            "the two faces look at each other across a small gap"
        )
    gap = np.bincount(of, weights=pieces.area * pieces.gap, minlength=cells)[lap] / area[lap]
    shape = cells, int(other.max()) + 1
    shared = sp.csr_matrix((pieces.area, (of, other[pieces.across])), shape=shape)[lap]
    weights = sp.csr_matrix(sp.diags(1.0 / area[lap]) @ shared)
    shares = min(pieces.covered[0], 1.0), min(pieces.covered[1], 1.0)
    return Pairing(lap, np.minimum(covered[lap], 1.0), gap, weights, shares)
