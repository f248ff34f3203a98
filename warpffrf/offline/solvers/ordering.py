"""Fill-reducing ordering by geometric nested dissection (George 1973, SIAM J. Numer. Anal. 10, 345).

A set of nodes is cut in two at the median along one of its principal axes; the nodes of one half that touch the other
are the separator and are eliminated after both halves, which so never meet. Of the three axes, and of the two sides
of a cut, the smallest separator counts: on quadratic cells one side of a cut is often two layers of nodes, the other
one. The dofs of a node stay together, so that the work is that of the node graph, a ninth of the matrix.
"""

from __future__ import annotations

from dataclasses import dataclass
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
    `parent` (parts,) the part that cut it off, -1 for the last."""

    order: Array
    ends: Array
    parent: Array

    @property
    def starts(self) -> Array:
        """First position (parts,) of each part in the order."""
        return np.concatenate([[0], self.ends[:-1]])


def nested_dissection(matrix: Any, coordinates: Array, leaf: int = LEAF) -> Dissection:
    """Dissect a symmetric sparse `matrix` (n, n) whose dofs are placed at `coordinates` (n, 3) [m].

    Dofs with NaN coordinates (rigid interfaces, which touch many nodes) are eliminated with the last part. Sets of at
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
    """Graph (nodes, nodes) of the placed dofs' matrix, csr; its values mean nothing."""
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
        self.side = np.zeros(len(x), dtype=np.int8)  # of the cut in hand: 1 lower, 2 upper half, 0 elsewhere
        self.parts: list[Array] = []
        self.parent: list[int] = []

    def dissect(self) -> None:
        """Depth first without recursion: a set comes back, as its separator, after its halves are done."""
        stack: list[tuple[Array, int | None]] = [(np.arange(len(self.x)), None)]
        orphans: list[int] = []
        while stack:
            nodes, halves = stack.pop()  # halves: how many a separator joins, None for a set not looked at yet
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
        """Separator, lower and upper half of a set; None where all nodes are in one place."""
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
            cost = np.count_nonzero(separator) / max(min(halves), 1)  # small, and with halves of like size
            if cost < least:
                best, least = (nodes[separator], nodes[~upper & ~separator], nodes[upper & ~separator]), cost
        self.side[nodes] = 0
        return best
