r"""Cholesky factors of many matrices with one pattern, by dense blocks in a chain.

The nodes of a sector are divided into levels: the loaded ones first, then their neighbours, and so on. A level is split
into the nodes that touch the next level (S) and those that do not (I). With elimination from the farthest level
inwards, in the order `S_l, I_l, S_(l-1), I_(l-1), ...`, a block S is coupled to the next two blocks of the order and a
block I to the next one only, also after fill. For quadratic cells I are the layers of mid-cell nodes. With blocks
of b columns and panels of r rows the work is

    sum over blocks of  b^3/3 + b^2 r + b r^2,

a third of that of a band Cholesky factorisation of the same matrix, and all of it in dense level-3 BLAS.

For every block i with diagonal D_i and panel P_i (its columns in the rows of the blocks it is coupled to)

    D_i = L_i L_i^H,   P_i := P_i L_i^-H,   (rows coupled) -= P_i P_i^H.

Entries are summed directly into the blocks: `BlockPattern.place` is the position of entry (row, column) of the reduced
matrix, so that a factorisation starts from an array of values and not from a sparse matrix.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from scipy.linalg import get_blas_funcs, get_lapack_funcs

from warpffrf.offline.fe import Sparse

Array = np.ndarray


class NotDefiniteError(np.linalg.LinAlgError):
    """The matrix to be factorised is not positive definite."""


def _levels(graph: Sparse, roots: Array) -> list[Array]:
    """Nodes by distance from `roots`; components that are not connected to them follow as levels of their own."""
    n = graph.shape[0]
    seen = np.zeros(n, dtype=bool)
    levels: list[Array] = []
    front = np.unique(roots)
    while True:
        if not len(front):
            left = np.flatnonzero(~seen)
            if not len(left):
                return levels
            front = left[:1]
        seen[front] = True
        levels.append(front)
        near = np.unique(graph[front].indices)
        front = near[~seen[near]]


def chain(graph: Sparse, roots: Array) -> tuple[list[Array], list[int]]:
    """Blocks of nodes in the order of elimination, and the number of following blocks coupled to each (0, 1, 2).

    `graph` (n, n): non-zero where nodes are coupled, with its diagonal; `roots`: the nodes eliminated last.
    """
    blocks, reach = [], []
    levels = _levels(graph, roots)
    beyond = np.zeros(graph.shape[0], dtype=bool)
    for number in range(len(levels) - 1, 0, -1):
        level = levels[number]
        touches = np.asarray(graph[level].astype(bool) @ beyond.astype(float)) > 0.0
        split = [part for part in (level[touches], level[~touches]) if len(part)]
        for i, part in enumerate(split):
            blocks.append(part)
            reach.append(len(split) - i)
        beyond[:] = False
        beyond[level] = True
    return [*blocks, levels[0]], [*reach, 0]


def work(blocks: list[Array], reach: list[int]) -> float:
    """Multiplications of a factorisation with these blocks of nodes, up to a common factor."""
    sizes = np.array([len(b) for b in blocks], dtype=float)
    rows = np.array([sizes[i + 1 : i + 1 + r].sum() for i, r in enumerate(reach)])
    return float(np.sum(sizes**3 / 3.0 + sizes**2 * rows + sizes * rows**2))


@dataclass(frozen=True)
class _Block:
    start: int  # first of its columns in the order
    size: int
    rows: int  # rows of its panel, the columns that follow it
    diagonal: int  # position of its entries (size, size), column by column
    panel: int  # position of its entries (rows, size), column by column


class BlockPattern:
    """Blocks of the dofs of a matrix (n, n); `order` (n,) is the dof at each position of the elimination."""

    def __init__(self, graph: Sparse, candidates: list[Array], dofs_per_node: int = 3) -> None:
        """`candidates`: sets of root nodes; the one with the least work is used."""
        chains = [chain(graph, roots) for roots in candidates if len(roots)] or [chain(graph, np.zeros(1, np.int64))]
        nodes, reach = min(chains, key=lambda c: work(*c))
        d = dofs_per_node
        self.order = (d * np.concatenate(nodes)[:, None] + np.arange(d)).ravel()
        self.rank = np.empty_like(self.order)
        self.rank[self.order] = np.arange(len(self.order))
        sizes = [d * len(part) for part in nodes]
        starts = np.concatenate([[0], np.cumsum(sizes)])
        self.blocks: list[_Block] = []
        self.length = 0
        for i, size in enumerate(sizes):
            rows = int(starts[i + 1 + reach[i]] - starts[i + 1])
            self.blocks.append(_Block(int(starts[i]), size, rows, self.length, self.length + size**2))
            self.length += size * (size + rows)
        self._block_of = np.repeat(np.arange(len(sizes)), sizes)

    @property
    def widest(self) -> int:
        """Columns of the largest block."""
        return max(block.size for block in self.blocks)

    def place(self, row: Array, column: Array) -> tuple[Array, Array]:
        """Which entries (row, column) of the matrix are stored, (mask), and their positions.

        Entries of the lower triangle, in the order of elimination, are stored; the upper ones follow by symmetry.
        """
        i, j = self.rank[row], self.rank[column]
        kept = i >= j
        i, j = i[kept], j[kept]
        of = self._block_of[j]
        start, size, rows, diagonal, panel = (
            np.array([getattr(b, name) for b in self.blocks])[of]
            for name in ("start", "size", "rows", "diagonal", "panel")
        )
        inside = i < start + size
        at = np.where(inside, diagonal + (j - start) * size + i - start, panel + (j - start) * rows + i - start - size)
        return kept, at

    def factor(self, values: Array) -> BlockCholesky:
        """Factors of the matrix whose stored entries are `values` (length,), overwritten. Raises `NotDefiniteError`."""
        return BlockCholesky(self, values)


class BlockCholesky:
    """Factors L_i and panels of one matrix."""

    def __init__(self, pattern: BlockPattern, values: Array) -> None:
        self.pattern = pattern
        (potrf,) = get_lapack_funcs(("potrf",), (values,))
        (self._trsm,) = get_blas_funcs(("trsm",), (values,))
        self.L: list[Array] = []
        self.P: list[Array] = []
        blocks = pattern.blocks

        def diagonal(b: _Block) -> Array:
            return values[b.diagonal : b.diagonal + b.size**2].reshape(b.size, b.size, order="F")

        def panel(b: _Block) -> Array:
            return values[b.panel : b.panel + b.size * b.rows].reshape(b.rows, b.size, order="F")

        for i, b in enumerate(blocks):
            L, info = potrf(diagonal(b), lower=1, clean=0, overwrite_a=1)
            if info != 0:
                raise NotDefiniteError(f"not positive definite at column {b.start + info - 1} of {len(pattern.order)}")
            P = panel(b)
            if b.rows:
                P = self._trsm(1.0, L, P, side=1, lower=1, trans_a=2, overwrite_b=1)
                after = blocks[i + 1]
                head = P[: after.size]
                diagonal(after)[...] -= head @ head.conj().T
                if b.rows > after.size:
                    tail = P[after.size :]
                    panel(after)[: b.rows - after.size] -= tail @ head.conj().T
                    diagonal(blocks[i + 2])[...] -= tail @ tail.conj().T
            self.L.append(L)
            self.P.append(P)

    def solve(self, F: Array) -> Array:
        """K^-1 F for F (n, m); complex F with real factors are two real ones."""
        if np.iscomplexobj(F) and not np.iscomplexobj(self.L[0]):
            both = self.solve(np.concatenate([np.real(F), np.imag(F)], axis=1))
            return both[:, : F.shape[1]] + 1j * both[:, F.shape[1] :]
        order, blocks = self.pattern.order, self.pattern.blocks
        y = np.asfortranarray(F[order].astype(self.L[0].dtype, copy=False))
        loaded = np.flatnonzero(np.any(y != 0.0, axis=1))
        if not len(loaded):
            return np.zeros(F.shape, dtype=y.dtype)
        parts = [y[b.start : b.start + b.size] for b in blocks]
        first = max(i for i, b in enumerate(blocks) if b.start <= loaded[0])
        for i in range(first, len(blocks)):
            b = blocks[i]
            parts[i] = self._trsm(1.0, self.L[i], parts[i], lower=1)
            if b.rows:
                carried = self.P[i] @ parts[i]
                size = blocks[i + 1].size
                parts[i + 1] = parts[i + 1] - carried[:size]
                if b.rows > size:
                    parts[i + 2] = parts[i + 2] - carried[size:]
        x = np.empty(y.shape, dtype=y.dtype)
        for i in range(len(blocks) - 1, -1, -1):
            b = blocks[i]
            rest = parts[i]
            if b.rows:
                back = self.P[i].conj().T @ x[b.start + b.size : b.start + b.size + b.rows]
                rest = rest - back if i >= first else -back
            x[b.start : b.start + b.size] = self._trsm(1.0, self.L[i], rest, lower=1, trans_a=2)
        out = np.empty_like(x)
        out[order] = x
        return out
