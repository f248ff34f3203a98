r"""Static responses to unit loads, in blocks: what observers see of them and the compliance among them.

Of the response `u_i` to load i, freed from rigid motion and from the global modes (`elastic.StaticResponse`), two
things are kept: `C_ji = b_j^T u_i` among all loads of one surface and of those before it, and `O u_i` for every
observer O; C between two surfaces is the transpose of that the other way round. Only the rows that loads or observers
touch are ever computed. Where the inertia of the responses is wanted, all rows of u are made, and

    N_ji = u_j^T M u_i = b_j^T v_i,      v_i = G_res M u_i,      W_ji = phi_j^T M u_i

with one more solve a load: G_res, the residual flexibility, is symmetric, so no response is kept. Blocks are
shared among threads where the solver can use them, are kept in a work file as they are finished, and each is the same
whoever computes it, so that a resumed run gives the same bits.
"""

from __future__ import annotations

from collections.abc import Generator, Sequence
from concurrent.futures import Future, ThreadPoolExecutor
from contextlib import closing
from dataclasses import dataclass
from itertools import combinations
from typing import Any

import numpy as np
import scipy.sparse as sp

from warpffrf.model.errors import InputError
from warpffrf.offline.elastic import Array, ElasticModel, StaticResponse
from warpffrf.offline.general.checkpoint import Checkpoint
from warpffrf.offline.general.observers import Observer
from warpffrf.offline.progress import Progress
from warpffrf.offline.threads import worker_count

# Right-hand sides solved together: 64 are 6 times cheaper a side than one, 128 another 10 %, more gain nothing.
BLOCK = 128
LEAST = 16  # below it a block is so dear a side that fewer threads with larger blocks do more
COPIES = 3  # arrays of a block's rows alive at once beside the solver's: response, directions' part, product
MASS_COPIES = 3  # arrays (n, block) alive at once for the inertia: response, M times it, response to that
SOLVER_COPIES = 2  # arrays (n, block) inside a solve: the loads in elimination order, and a front's part or a copy


@dataclass(frozen=True, eq=False)
class UnitLoads:
    """Loads (n, count) csc of one surface in the model's coordinates, and the surface's `name`. Of the first `massed`
    ones the inertia is wanted, too."""

    name: str
    loads: Any
    massed: int = 0


@dataclass(frozen=True, eq=False)
class UnitResponses:
    """Compliance C (count, count), symmetric, that of each earlier surface under these loads, `cross` (its count,
    count), and of each observer its transfer (rows, count); `mass` (massed, massed), symmetric, and `overlap`
    (massed, m) of the first ones with the global modes, see `contact.local_mass`."""

    compliance: Array
    cross: list[Array]
    transfers: list[Array]
    mass: Array
    overlap: Array


class ResponseSolver:
    """Responses of one model to the loads of several surfaces.

    `T` (3 n, n^) maps the model's coordinates to displacements of all nodes, which the `observers` see. `memory_limit`
    [byte] bounds factors, results and blocks together. Raises `InputError` where it is too small for one load at a
    time.
    """

    def __init__(
        self,
        model: ElasticModel,
        omega: Array,
        Phi: Array,
        T: Any,
        surfaces: Sequence[UnitLoads],
        observers: Sequence[Observer],
        memory_limit: int,
    ) -> None:
        operators: list[Any] = [sp.csr_matrix(o.operator @ T) for o in observers]
        touched = np.zeros(model.size, dtype=bool)
        for matrix in operators:
            touched[matrix.indices] = True
        for s in surfaces:
            touched[sp.csc_matrix(s.loads).indices] = True
        rows = np.flatnonzero(touched)
        self.surfaces, self.observers = surfaces, observers
        self.operators: list[Any] = [sp.csr_matrix(matrix[:, rows]) for matrix in operators]
        self.loads: list[Any] = [sp.csc_matrix(s.loads) for s in surfaces]
        self.on_rows = [sp.csr_matrix(sp.csr_matrix(s.loads)[rows].T) for s in surfaces]
        self.response = StaticResponse(model, rows, omega, Phi)
        self.model, self.stiffness, self.Phi = model, omega**2, Phi
        massed = any(s.massed for s in surfaces)
        self.whole = StaticResponse(model, np.arange(model.size), omega, Phi) if massed else None
        concurrent = model.factor is not None and model.factor.concurrent and not self.response.refined
        self.workers = worker_count() if concurrent else 1
        self.width = self._width(model, memory_limit)

    def _width(self, model: ElasticModel, limit: int) -> int:
        """Loads of a block, so that blocks of all workers fit into `limit` beside factors, modes and results."""
        kept = 0 if model.factor is None else model.factor.bytes
        kept += self.response.directions.nbytes + self.response.Phi.nbytes
        kept += results_bytes(
            [s.loads.shape[1] for s in self.surfaces], self.observers, [s.massed for s in self.surfaces]
        )
        seen = max((m.shape[0] for m in self.operators), default=0)
        column = 8 * (SOLVER_COPIES * model.size + COPIES * len(self.response.rows) + seen)
        if self.whole is not None:
            kept += self.whole.directions.nbytes
            column += 8 * MASS_COPIES * model.size
        while self.workers > 1 and (limit - kept) // (column * self.workers) < LEAST:
            self.workers -= 1
        width = int((limit - kept) // (column * self.workers))
        if width < 1:
            raise InputError(
                f"memory_limit of {limit / 2**30:.3g} GiB is too small: factors, modes and results take "
                f"{kept / 2**30:.3g} GiB, a block of one load {column / 2**20:.3g} MiB more; raise memory_limit to "
                f"{int(np.ceil((kept + column) / 2**20))} MiB or more, or raise traction_spacing"
            )
        return min(width, BLOCK)

    def responses(self, surface: int, progress: Progress, checkpoint: Checkpoint) -> UnitResponses:
        """All responses to the loads of one surface."""
        name, count = self.surfaces[surface].name, self.loads[surface].shape[1]
        C = np.zeros((count, count))
        cross = [np.zeros((earlier.shape[1], count)) for earlier in self.loads[:surface]]
        massed = self.surfaces[surface].massed
        N, W = np.zeros((massed, massed)), np.zeros((massed, self.Phi.shape[1]))
        transfers = [np.zeros((o.rows, count), dtype=o.dtype) for o in self.observers]
        starts = list(range(0, count, self.width))
        with closing(self._blocks(surface, starts, checkpoint)) as blocks:
            for start in progress.track(starts, f"static responses of {name}"):
                part, block = slice(start, start + self.width), next(blocks)
                C[:, part] = block["compliance"]
                for i, other in enumerate(cross):
                    other[:, part] = block[f"cross{i}"]
                for i, transfer in enumerate(transfers):
                    transfer[:, part] = block[f"observer{i}"]
                if start < massed:
                    N[:, part], W[part] = block["mass"], block["overlap"]
        C += C.T
        C *= 0.5
        return UnitResponses(C, cross, transfers, 0.5 * (N + N.T), W)

    def _blocks(
        self, surface: int, starts: list[int], checkpoint: Checkpoint
    ) -> Generator[dict[str, Array], None, None]:
        """Blocks in order, those of the work file or computed; at most one more than the workers wait at a time."""
        name = self.surfaces[surface].name
        with ThreadPoolExecutor(self.workers) as pool:
            waiting: list[tuple[int, dict[str, Array] | Future[dict[str, Array]]]] = []
            try:
                for start in [*starts, *[-1] * self.workers]:
                    if start >= 0:
                        known = checkpoint.get(_key(name, start, self.width))
                        waiting.append((start, known or pool.submit(self._block, surface, start)))
                    if waiting and (start < 0 or len(waiting) > self.workers):
                        at, block = waiting.pop(0)
                        if isinstance(block, Future):
                            block = block.result()
                            checkpoint.put(_key(name, at, self.width), block)
                        yield block
            finally:
                pool.shutdown(wait=True, cancel_futures=True)

    def _block(self, surface: int, start: int) -> dict[str, Array]:
        loads = self.loads[surface][:, start : start + self.width]
        massed = self.surfaces[surface].massed - start
        block: dict[str, Array] = {}
        if self.whole is not None and massed > 0:
            whole = self.whole(loads)
            block["mass"], block["overlap"] = self._inertia(surface, whole[:, :massed])
            u = whole[self.response.rows]
        else:
            u = self.response(loads)
        block["compliance"] = self.on_rows[surface] @ u
        for i, on_rows in enumerate(self.on_rows[:surface]):
            block[f"cross{i}"] = on_rows @ u
        for i, (operator, observer) in enumerate(zip(self.operators, self.observers, strict=True)):
            block[f"observer{i}"] = np.asarray(operator @ u, dtype=observer.dtype)
        return block

    def _inertia(self, surface: int, u: Array) -> tuple[Array, Array]:
        """N (massed, w) and W^T (w, m) of responses u (n, w), see the module docstring."""
        loads = self.loads[surface][:, : self.surfaces[surface].massed]
        inertia = self.model.M @ u
        on_modes = self.Phi.T @ inertia
        N = loads.T @ self.model.flexibility(inertia)
        return N - (loads.T @ self.Phi) @ (on_modes / self.stiffness[:, None]), on_modes.T


def results_bytes(counts: Sequence[int], observers: Sequence[Observer], massed: Sequence[int] = ()) -> int:
    """Memory of the dense results of surfaces with `counts` loads: compliances, also between them, with two working
    copies, transfers; of the `massed` ones their mass Gram matrices likewise."""
    dense = sum(8 * 3 * n * n for n in (*counts, *massed))
    dense += sum(8 * 3 * m * n for m, n in combinations(counts, 2))
    return dense + sum(o.rows * n * o.dtype.itemsize for n in counts for o in observers)


def _key(surface: str, start: int, width: int) -> str:
    return f"responses of {surface}, loads {start} and on, {width} a block"
