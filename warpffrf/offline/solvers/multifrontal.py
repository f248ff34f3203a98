r"""Multifrontal Cholesky factorisation in NumPy: the default for large systems.

Over the fronts of a nested dissection (`fronts.py`) the elimination is a sequence of dense operations. With the front
of part p, pivots 1 and border 2, assembled from K's entries in the columns of its pivots and the updates S of its
children,

    F = [F11 F21^H; F21 F22],    F11 = L11 L11^H,    L21 = F21 L11^-H,    S = F22 - L21 L21^H  (passed to the parent).

On a solid mesh nearly all work is in fronts of hundreds to thousands of dofs, so it runs at the speed of BLAS with
little interpreter overhead. `L11^-1` is stored instead of L11: a solve then consists of matrix products alone,

    down:  y1 = L11^-1 b1,  b2 -= L21 y1;          up:  x1 = L11^-H (y1 - L21^H x2),

which release the interpreter's lock, so that threads can share blocks of right-hand sides and subtrees of the
elimination. (Inverses of triangular factors keep the residual small: the condition of L11 is the root of that of F11;
Higham 2002, ch. 14.) The downward pass needs only fronts at or above a load, the upward pass only those at or above a
requested row. Each number is computed by one thread in one order: the result does not depend on the number of threads.

Measured by `bench/offline.py --solvers --large` on a hex8 cube of 104,544 dofs, one thread, factorisation time and time
per right-hand side in blocks of 64: 9.7 s and 12 ms; SuperLU with the same ordering 29 s and 63 ms, CHOLMOD 6.7 s and
14 ms, Pardiso 8.9 s and 52 ms. Loads on one face and rows on the skin cost 5 ms per side.
"""

from __future__ import annotations

from concurrent.futures import ThreadPoolExecutor
from typing import Any

import numpy as np
import scipy.sparse as sp
from scipy.linalg import get_lapack_funcs

from warpffrf.model.errors import InputError
from warpffrf.offline.progress import worker_count
from warpffrf.offline.solvers.factor import Factor, not_definite
from warpffrf.offline.solvers.ordering import Array, Fronts, find_fronts, nested_dissection


class Multifrontal(Factor):
    """See the module docstring."""

    name = "multifrontal"
    concurrent = True

    def __init__(self, K: Any, coordinates: Array | None, memory_limit: int | None = None) -> None:
        if coordinates is None:
            raise InputError("solver 'multifrontal' needs the coordinates of the dofs; choose 'superlu'")
        fronts = find_fronts(K, nested_dissection(K, coordinates))
        dtype = np.dtype(np.result_type(K.dtype, np.float64))
        super().__init__(K.shape[0], dtype, fronts.entries, fronts.entries * dtype.itemsize)
        needed = fronts.peak * dtype.itemsize
        if memory_limit is not None and needed > memory_limit:
            raise InputError(
                f"the factorisation of {self.size} dofs needs {needed / 2**30:.3g} GiB, memory_limit is "
                f"{memory_limit / 2**30:.3g} GiB; raise memory_limit or coarsen the mesh"
            )
        self.fronts = fronts
        self._coordinates = coordinates
        self._blocks: list[tuple[Array, Array]] = [(np.zeros(0), np.zeros(0))] * len(fronts.ends)  # L11^-1, L21
        self._updates: dict[int, Array] = {}
        self._factorise()

    def _factorise(self) -> None:
        """Subtrees in parallel, then the fronts above them."""
        workers = worker_count()
        subtrees, top = _split(self.fronts, workers)
        if workers > 1 and len(subtrees) > 1:
            with ThreadPoolExecutor(workers) as pool:
                list(pool.map(self._eliminate_all, subtrees))
        else:
            for subtree in subtrees:
                self._eliminate_all(subtree)
        self._eliminate_all(top)

    def _eliminate_all(self, fronts: Array) -> None:
        for p in fronts:
            self._eliminate(int(p))

    def _eliminate(self, p: int) -> None:
        fronts = self.fronts
        start, end, border = int(fronts.starts[p]), int(fronts.ends[p]), fronts.borders[p]
        pivots = end - start
        F11 = np.zeros((pivots, pivots), dtype=self.dtype)
        F21 = np.zeros((len(border), pivots), dtype=self.dtype)
        F22 = np.zeros((len(border), len(border)), dtype=self.dtype)
        K = fronts.matrix
        span = slice(K.indptr[start], K.indptr[end])
        row, value = K.indices[span], K.data[span]
        column = np.repeat(np.arange(pivots), np.diff(K.indptr[start : end + 1]))
        own, later = (row >= start) & (row < end), row >= end
        F11[row[own] - start, column[own]] = value[own]
        F21[np.searchsorted(border, row[later]), column[later]] = value[later]
        for child in fronts.children[p]:
            if not len(fronts.borders[child]):  # a part that no dof connects with the others
                continue
            S, reached = self._updates.pop(child), fronts.borders[child]
            cut = int(np.searchsorted(reached, end))
            inside, beyond = reached[:cut] - start, np.searchsorted(border, reached[cut:])
            _add(F11, inside, inside, S[:cut, :cut])
            _add(F21, beyond, inside, S[cut:, :cut])
            _add(F22, beyond, beyond, S[cut:, cut:])
        if pivots:
            try:
                L11 = np.linalg.cholesky(F11)
            except np.linalg.LinAlgError:
                places = self._coordinates[fronts.order[start:end]]
                place = places[np.isfinite(places[:, 0])].mean(axis=0) if np.isfinite(places).any() else None
                where = "at a rigid interface" if place is None else "near ({:.4g}, {:.4g}, {:.4g}) m".format(*place)
                raise not_definite(f"noticed {where}") from None
            (trtri,) = get_lapack_funcs(("trtri",), (L11,))
            F11 = trtri(L11.T, lower=0, overwrite_c=1)[0].T  # of the transpose, in the storage order of LAPACK
            if len(border):
                F21 = F21 @ F11.conj().T
                F22 -= F21 @ F21.conj().T
        self._blocks[p] = F11, F21
        if len(border):
            self._updates[p] = F22

    def _solve(self, F: Any, rows: Array | None) -> Array:
        fronts = self.fronts
        X = np.zeros((self.size, F.shape[1]), dtype=self.dtype)
        if sp.issparse(F):
            entries = sp.coo_matrix(F)
            entries.sum_duplicates()
            X[fronts.position[entries.row], entries.col] = entries.data
            loaded = fronts.above(fronts.of_positions(fronts.position[entries.row]))
        else:
            X[fronts.position] = F
            loaded = np.ones(len(fronts.ends), dtype=bool)
        for p in np.flatnonzero(loaded):
            inverse, below = self._blocks[p]
            span, border = slice(fronts.starts[p], fronts.ends[p]), fronts.borders[p]
            if inverse.size:
                X[span] = inverse @ X[span]
                if len(border):
                    X[border] -= below @ X[span]
        places = fronts.position if rows is None else fronts.position[rows]
        wanted = fronts.above(fronts.of_positions(places))
        for p in np.flatnonzero(wanted)[::-1]:
            inverse, below = self._blocks[p]
            span, border = slice(fronts.starts[p], fronts.ends[p]), fronts.borders[p]
            if inverse.size:
                y = X[span] - below.conj().T @ X[border] if len(border) else X[span]
                X[span] = inverse.conj().T @ y
        return X[places]


def _add(target: Array, rows: Array, columns: Array, part: Array) -> None:
    """target[rows x columns] += part, by runs of neighbouring columns: in a front of a mesh they are long."""
    if not part.size:
        return
    breaks = np.flatnonzero(np.diff(columns) != 1) + 1
    starts, stops = [0, *breaks.tolist()], [*breaks.tolist(), len(columns)]
    whole = rows[-1] - rows[0] + 1 == len(rows)
    taken = slice(rows[0], rows[-1] + 1) if whole else rows
    for a, b in zip(starts, stops, strict=True):
        target[taken, columns[a] : columns[a] + b - a] += part[:, a:b]


def _split(fronts: Fronts, workers: int) -> tuple[list[Array], Array]:
    """Subtrees, one or a few per worker, each as its fronts in order; and the fronts above them."""
    first = np.arange(len(fronts.parent))  # of each subtree; children come before parents
    for p, children in enumerate(fronts.children):
        if children:
            first[p] = min(first[c] for c in children)
    work = np.cumsum(np.concatenate([[0.0], fronts.work]))
    roots = [int(p) for p in np.flatnonzero(fronts.parent < 0)]
    while len(roots) < workers:
        largest = max(roots, key=lambda p: work[p + 1] - work[first[p]])
        if not fronts.children[largest]:
            break
        roots.remove(largest)
        roots.extend(fronts.children[largest])
    subtrees = [np.arange(first[p], p + 1) for p in sorted(roots)]
    inside = np.concatenate(subtrees)
    return subtrees, np.setdiff1d(np.arange(len(fronts.parent)), inside)
