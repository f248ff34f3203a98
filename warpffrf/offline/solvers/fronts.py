r"""The frontal matrices of a dissected sparse matrix: which dofs each part of the elimination touches.

Eliminating the dofs of part p (the *pivots*) updates the later dofs that they, or the parts below p, are coupled to
(the *border*). With

    border(p) = ({later neighbours of the pivots in K} u border of each child) \ pivots of p,

everything that the elimination of p reads and writes is the dense matrix on pivots and border: Duff and Reid 1983, ACM
Trans. Math. Softw. 9, 302; Liu 1992, SIAM Review 34, 82.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property
from typing import Any

import numpy as np
import scipy.sparse as sp

from warpffrf.offline.solvers.ordering import Array, Dissection


@dataclass(frozen=True, eq=False)
class Fronts:
    """The fronts of `matrix`, K (n, n) permuted to the elimination order, csc. Positions count in that order.

    `borders[p]` (b,) ascending positions; front p has the pivots `starts[p] ... ends[p] - 1`.
    """

    matrix: Any
    order: Array
    starts: Array
    ends: Array
    parent: Array
    borders: list[Array]

    @cached_property
    def children(self) -> list[list[int]]:
        """Fronts whose updates go into each front."""
        found: list[list[int]] = [[] for _ in self.parent]
        for p, parent in enumerate(self.parent):
            if parent >= 0:
                found[parent].append(p)
        return found

    @cached_property
    def position(self) -> Array:
        """Position (n,) of each dof in the elimination order."""
        position = np.empty(len(self.order), dtype=np.int64)
        position[self.order] = np.arange(len(self.order))
        return position

    @cached_property
    def sizes(self) -> tuple[Array, Array]:
        """Pivots (fronts,) and border dofs (fronts,) of each front."""
        return self.ends - self.starts, np.array([len(b) for b in self.borders], dtype=np.int64)

    @property
    def entries(self) -> int:
        """Numbers kept of the factors: of each front a square on the pivots, a block below it."""
        pivots, border = self.sizes
        return int((pivots * (pivots + border)).sum())

    @cached_property
    def work(self) -> Array:
        """Multiplications of each front (fronts,), as floats."""
        pivots, border = (s.astype(float) for s in self.sizes)
        return pivots**3 / 3.0 + pivots**2 * border + pivots * border**2

    @cached_property
    def peak(self) -> int:
        """Numbers alive at most while the fronts are eliminated one after the other: factors, updates, one front."""
        pivots, border = self.sizes
        kept = waiting = most = 0
        for p in range(len(self.parent)):
            most = max(most, kept + waiting + int((pivots[p] + border[p]) ** 2 + border[p] ** 2))
            kept += int(pivots[p] * (pivots[p] + border[p]))
            waiting += int(border[p] ** 2) - sum(int(border[c] ** 2) for c in self.children[p])
        return most

    def above(self, touched: Array) -> Array:
        """Mask (fronts,) of the fronts in `touched` (fronts,) and of all above them, up to the roots."""
        mask = touched.copy()
        for p in np.flatnonzero(self.parent >= 0):  # children come before parents
            if mask[p]:
                mask[self.parent[p]] = True
        return mask

    def of_positions(self, positions: Array) -> Array:
        """Mask (fronts,) of the fronts that hold one of the `positions` among their pivots."""
        mask = np.zeros(len(self.ends), dtype=bool)
        mask[np.searchsorted(self.ends, positions, side="right")] = True
        return mask


def find_fronts(K: Any, dissection: Dissection) -> Fronts:
    """Fronts of a symmetric sparse matrix K (n, n)."""
    order, starts, ends = dissection.order, dissection.starts, dissection.ends
    matrix = sp.csc_matrix(sp.csc_matrix(K)[order][:, order])
    matrix.sort_indices()
    mark = np.zeros(len(order), dtype=bool)
    below: list[list[int]] = [[] for _ in ends]
    borders: list[Array] = []
    for p, (start, end) in enumerate(zip(starts, ends, strict=True)):
        neighbours = matrix.indices[matrix.indptr[start] : matrix.indptr[end]]
        mark[neighbours] = True
        for child in below[p]:
            mark[borders[child]] = True
        border = end + np.flatnonzero(mark[end:])
        mark[neighbours] = mark[border] = False
        mark[start:end] = False
        borders.append(border)
        if dissection.parent[p] >= 0:
            below[dissection.parent[p]].append(p)
    return Fronts(matrix, order, starts, ends, dissection.parent, borders)
