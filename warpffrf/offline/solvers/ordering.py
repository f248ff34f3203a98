r"""Fill-reducing ordering by geometric nested dissection (George 1973, SIAM J. Numer. Anal. 10, 345).

A set of nodes is cut in two at the median along one of its principal axes; the nodes of one half that touch the other
are the separator and are eliminated after both halves, which are thereby decoupled. Among the three axes and the two
sides of a cut, the smallest separator is used: on quadratic cells one side of a cut is often two layers of nodes, the
other one. The dofs of a node stay together, so that the work is that of the node graph, a ninth of the matrix.

Fronts. The frontal matrices of a dissected sparse matrix: the dofs of each part of the elimination.

Eliminating the dofs of part p (the *pivots*) updates the later dofs that they, or the parts below p, are coupled to
(the *border*). With

    border(p) = ({later neighbours of the pivots in K} u border of each child) \ pivots of p,

the elimination of p reads and writes only the dense matrix on pivots and border: Duff and Reid 1983, ACM
Trans. Math. Softw. 9, 302; Liu 1992, SIAM Review 34, 82.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property
from typing import Any

import numpy as np
import scipy.sparse as sp

Array = np.ndarray
# Nodes that are not cut any further. Measured on hex8 of 100,000 dofs with dense elimination of the leaves: 12, 20, 36
# and 64 give the same fill within 10 % and the same time within 15 %; many small leaves cost calls, large ones work.
LEAF = 24


@dataclass(frozen=True)
class Dissection:
    """Elimination `order` (n,) of the dofs in `parts`, children before parents: part p is `order[starts[p]:ends[p]]`,
    `parent` (parts,) the part whose cut created it, -1 for the last."""

    order: Array
    ends: Array
    parent: Array

    @property
    def starts(self) -> Array:
        """First position (parts,) of each part in the order."""
        return np.concatenate([[0], self.ends[:-1]])


def nested_dissection(matrix: Any, coordinates: Array, leaf: int = LEAF) -> Dissection:
    """Dissect a symmetric sparse `matrix` (n, n) with dofs at `coordinates` (n, 3) [m].

    Dofs with NaN coordinates (rigid interfaces, which involve many nodes) are eliminated with the last part. Sets of at
    most `leaf` nodes are not cut.
    """
    placed = np.all(np.isfinite(coordinates), axis=1)
    dofs = np.flatnonzero(placed)
    last = np.flatnonzero(~placed)
    if not len(dofs):
        return Dissection(last, np.array([len(last)]), np.array([-1]))
    nodes, node_of = np.unique(coordinates[dofs], axis=0, return_inverse=True)
    tree = _Tree(_node_graph(sp.csr_matrix(matrix), dofs, node_of.ravel(), len(nodes)), nodes, leaf)
    tree.dissect()
    by_node = np.argsort(node_of.ravel(), kind="stable")
    count = np.bincount(node_of.ravel(), minlength=len(nodes))
    first = np.cumsum(count) - count
    lengths = [int(count[part].sum()) for part in tree.parts]
    sequence = np.concatenate(tree.parts)
    order = dofs[by_node[_ranges(first[sequence], count[sequence])]]
    lengths[-1] += len(last)
    return Dissection(np.concatenate([order, last]), np.cumsum(lengths), np.array(tree.parent))


def _node_graph(matrix: Any, dofs: Array, node_of: Array, nodes: int) -> Any:
    """Graph (nodes, nodes) of the placed dofs' matrix, csr; its values have no meaning."""
    of_dof = np.full(matrix.shape[0], -1, dtype=np.int64)
    of_dof[dofs] = node_of
    pattern = sp.csr_matrix((np.ones(matrix.nnz, dtype=np.float32), matrix.indices, matrix.indptr), matrix.shape)
    gather = sp.csr_matrix((np.ones(len(dofs), dtype=np.float32), (node_of, dofs)), shape=(nodes, matrix.shape[0]))
    return sp.csr_matrix(gather @ pattern @ gather.T)


def _ranges(starts: Array, lengths: Array) -> Array:
    """The numbers starts[i] ... starts[i] + lengths[i] - 1, one range after the other."""
    shift = np.repeat(starts - (np.cumsum(lengths) - lengths), lengths)
    return shift + np.arange(len(shift))


class _Tree:
    """The parts found so far, children before parents."""

    def __init__(self, graph: Any, x: Array, leaf: int) -> None:
        self.indptr, self.indices = graph.indptr, graph.indices
        self.x, self.leaf = x, leaf
        self.side = np.zeros(len(x), dtype=np.int8)  # of the current cut: 1 lower, 2 upper half, 0 elsewhere
        self.parts: list[Array] = []
        self.parent: list[int] = []

    def dissect(self) -> None:
        """Depth first without recursion: a set is revisited, as its separator, after its halves are done."""
        stack: list[tuple[Array, int | None]] = [(np.arange(len(self.x)), None)]
        orphans: list[int] = []
        while stack:
            nodes, halves = stack.pop()  # halves: how many a separator joins, None for a set not visited yet
            cut = self._cut(nodes) if halves is None and len(nodes) > self.leaf else None
            if cut is not None:
                separator, low, high = cut
                stack.append((separator, (len(low) > 0) + (len(high) > 0)))
                stack.extend((half, None) for half in (high, low) if len(half))
                continue
            number = len(self.parts)
            self.parts.append(nodes)
            self.parent.append(-1)
            for _ in range(halves or 0):
                self.parent[orphans.pop()] = number
            orphans.append(number)

    def _cut(self, nodes: Array) -> tuple[Array, Array, Array] | None:
        """Separator, lower and upper half of a set; None if all nodes coincide."""
        x = self.x[nodes] - self.x[nodes].mean(axis=0)
        axes = np.linalg.eigh(x.T @ x)[1].T[::-1]  # longest first
        lengths = self.indptr[nodes + 1] - self.indptr[nodes]
        neighbours = self.indices[_ranges(self.indptr[nodes], lengths)]
        starts = np.cumsum(lengths) - lengths
        best, least = None, np.inf
        for axis in axes:
            s = x @ axis
            upper = s > np.median(s)
            if not upper.any():
                upper = s >= np.median(s)
            if not upper.any() or upper.all():
                continue
            self.side[nodes] = np.where(upper, 2, 1)
            beside = self.side[neighbours]
            low = ~upper & np.logical_or.reduceat(beside == 2, starts)
            high = upper & np.logical_or.reduceat(beside == 1, starts)
            separator = low if np.count_nonzero(low) <= np.count_nonzero(high) else high
            halves = np.count_nonzero(upper & ~separator), np.count_nonzero(~upper & ~separator)
            cost = np.count_nonzero(separator) / max(min(halves), 1)  # small, and with halves of similar size
            if cost < least:
                best, least = (nodes[separator], nodes[~upper & ~separator], nodes[upper & ~separator]), cost
        self.side[nodes] = 0
        return best


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
        """Numbers stored of the factors: for each front a square on the pivots, a block below it."""
        pivots, border = self.sizes
        return int((pivots * (pivots + border)).sum())

    @cached_property
    def work(self) -> Array:
        """Multiplications of each front (fronts,), as floats."""
        pivots, border = (s.astype(float) for s in self.sizes)
        return pivots**3 / 3.0 + pivots**2 * border + pivots * border**2

    @cached_property
    def peak(self) -> int:
        """Maximum of numbers stored while the fronts are eliminated in turn: factors, updates, one front."""
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
        """Mask (fronts,) of the fronts with one of the `positions` among their pivots."""
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
