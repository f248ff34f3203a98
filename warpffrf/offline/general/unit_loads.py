r"""Static responses to unit loads, in blocks: their observed values and the compliance among them.

Of the response `u_i` to load i, without rigid motion and the part of the global modes (`elastic.StaticResponse`), two
results are stored: `C_ji = b_j^T u_i` among all loads of one surface and of those before it, and `O u_i` for every
observer O; C between two surfaces is the transpose of that in the opposite order. Only the rows of loads or observers
are computed. If the inertia of the responses is requested, all rows of u are computed, and

    N_ji = u_j^T M u_i = b_j^T v_i,      v_i = G_res M u_i,      W_ji = phi_j^T M u_i

with one more solve per load: G_res, the residual flexibility, is symmetric, so no response is stored. Blocks are
distributed over threads if the solver supports it, are written to a work file when finished, and do not depend on the
thread, so that a resumed run gives bitwise identical results.

Surface. A contact surface of the general path: its grid, its traction fields, and its operators from the responses to
them.

The loads of a surface are those of its fields, each a set of tractions with a Gram matrix `M`: the normal one first,
then the tangential one if requested. With the compliance `C_ab = B_a^T G B_b` between fields a and b, of one
surface or of two, displacement coefficients of a per unit force of b are

    D_ab = M_a^-1 C_ab M_b^-1.

The loads cover the whole rectangle of the grid's plan. On an arc or a plane the functions on its edges are half
ones; they are omitted from the reduced body, as are all that reach beyond the facets. B and M above are those of the
remaining functions, so that the weak displacements `M_a D_ab M_b` and `M_a mode` of these are exact to the last column
(`TractionField`).
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
from warpffrf.model.mesh import Mesh
from warpffrf.model.reduced.contact_grid import SurfaceGrid
from warpffrf.model.reduced.contact_surface import CrossCompliance, Recovery, Tangential
from warpffrf.model.reduced.local_mass import LocalMass
from warpffrf.offline.contact.local_mass import AROUND, check_traces, dense_mass, slope_lags, window_columns
from warpffrf.offline.contact.node_loads import NORMAL, TANGENTIAL, ContactFacets, KeptFunctions, TractionField
from warpffrf.offline.elastic import ElasticModel, StaticResponse
from warpffrf.offline.general.checkpoint import Checkpoint
from warpffrf.offline.general.observers import SKIN, Observer
from warpffrf.offline.products import SurfaceProduct
from warpffrf.offline.progress import Progress, worker_count

# Right-hand sides per block: with 64 each is 6 times cheaper than one alone, with 128 another 10 %, more gain nothing.
BLOCK = 128
LEAST = 16  # smaller blocks cost so much per side that fewer threads with larger blocks are faster
COPIES = 3  # arrays of a block's rows that exist at once, without the solver's: response, directions' part, product
MASS_COPIES = 3  # arrays (n, block) that exist at once for the inertia: response, M times it, response to that
SOLVER_COPIES = 2  # arrays (n, block) inside a solve: the loads in elimination order, and a front's part or a copy


@dataclass(frozen=True, eq=False)
class UnitLoads:
    """Loads (n, count) csc of one surface in the model's coordinates, and the surface's `name`. The inertia of the
    first `massed` ones is computed too."""

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

    `T` (3 n, n^) maps the model's coordinates to displacements of all nodes, on which the `observers` act.
    `memory_limit` [byte] bounds factors, results and blocks together. Raises `InputError` if it is too small for one
    load at a time.
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
        """Loads per block, so that blocks of all workers fit into `limit` with factors, modes and results."""
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
                f"{int(np.ceil((kept + column) / 2**20))} MiB or more, or raise the spacing of the contact grid"
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
        """Blocks in order, from the work file or computed; at most one more than the workers is pending at a time."""
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


Array = np.ndarray
COVERED = 0.02  # relative area at which a node counts as inside the facets: the error of a kinked quadrature
ROWS = 4096  # rows of a transfer processed at a time in double precision


class GeneralSurface:
    """Grid and fields of the contact surface `name` with resolved `shape`; kinds of functions as in `TractionField`."""

    def __init__(
        self,
        mesh: Mesh,
        name: str,
        shape: Any,
        spacing: float | None,
        traction: str = "nodes",
        tangential: str | None = None,
        sloping: bool = False,
    ) -> None:
        self.name, self.shape, self.nodes = name, shape, len(mesh.points)
        facets = ContactFacets.of(mesh.points, mesh.facets(name), shape)
        self.plan = facets.plan(name, spacing, len(mesh.facets(name).node_set))
        self.first, self.columns = self._extent(TractionField("nodes", NORMAL, self.plan, facets))
        self.fields = [TractionField(traction, NORMAL, self.plan, facets)]
        if tangential is not None:
            self.fields.append(TractionField(tangential, TANGENTIAL, self.plan, facets))
        self.around = TractionField(traction, AROUND, self.plan, facets) if sloping else None
        self.kept = [KeptFunctions(f, self.first, self.columns) for f in self.fields]
        self.traces = check_traces(mesh, name, shape, self._grid(self.fields[0]))

    @property
    def count(self) -> int:
        """Number of loads of all fields."""
        return sum(f.count for f in self.fields)

    @property
    def parts(self) -> list[slice]:
        """Positions of the loads of each field among all."""
        stops = np.cumsum([f.count for f in self.fields])
        return [slice(int(stop) - f.count, int(stop)) for f, stop in zip(self.fields, stops, strict=True)]

    def loads(self) -> Any:
        """B (3 n, count) of all fields, one field after the other, csc."""
        return sp.csc_matrix(sp.hstack([f.loads(self.nodes) for f in self.fields]))

    def observer(self) -> Observer | None:
        """Tangential displacements under normal loads, if requested."""
        if self.around is None:
            return None
        return Observer(f"along/{self.name}", sp.csr_matrix(self.around.loads(self.nodes).T), np.dtype(np.float64))

    def _extent(self, grid_nodes: TractionField) -> tuple[int, int]:
        """First column, and number of columns, of those whose functions lie inside the facets. Raises `InputError` if
        there are holes."""
        inside = grid_nodes.covered(COVERED)
        if not self.plan.periodic:
            inside[[0, -1]] = False
        kept = np.flatnonzero(inside)
        whole = len(kept) == len(inside) if self.plan.periodic else len(kept) and kept[-1] - kept[0] + 1 == len(kept)
        if not whole:
            between = "fill a rectangle" if self.shape.profile().planar else "cover the surface between two angles"
            raise InputError(
                f"contact {self.name!r}: the facets leave part of {int(np.sum(~inside))} of {self.plan.columns} grid "
                f"columns uncovered; choose facets that {between} over its whole width"
            )
        return int(kept[0]), len(kept)

    def _grid(self, f: TractionField) -> SurfaceGrid:
        plan = self.plan
        start = plan.theta_start + plan.pitch * self.first
        e_0 = np.asarray(self.shape.e_0, dtype=float)
        return SurfaceGrid(e_0, start, plan.pitch, self.columns, plan.periodic, plan.z, self.columns, f.kind)

    def product(self, C: Array, transfers: dict[str, Array], loads_on_modes: Array, omega: Array) -> SurfaceProduct:
        """Operators from C (count, count), the observed values {name: (rows, count)}, and B^T Phi (count, m)."""
        parts = self.parts
        along = None if (own := self.observer()) is None else transfers[own.name][:, parts[0]]
        transfers = {name: t for name, t in transfers.items() if not name.startswith("along/")}
        modes = [k.without_gram(loads_on_modes[p]) for k, p in zip(self.kept, parts, strict=True)]
        seen = [
            {name: _recovery(t[:, p], k) for name, t in transfers.items()}
            for k, p in zip(self.kept, parts, strict=True)
        ]

        tangential = None
        if len(self.fields) > 1:
            tangential = Tangential(
                self._grid(self.fields[1]),
                _symmetric(_between(self, 1, self, 1, C))[None],
                np.ascontiguousarray(_between(self, 0, self, 1, C))[None],
                np.ascontiguousarray(modes[1].reshape(2, len(modes[1]) // 2, -1)),
                seen[1].pop(SKIN),
            )
        grid = self._grid(self.fields[0])
        judged = self.kept[0].numbers[: window_columns(grid.columns, grid.rows) * grid.rows]
        window, on_modes = C[np.ix_(judged, judged)], loads_on_modes[judged] / omega
        sloped = None
        if along is not None:
            half = self.kept[0].without_gram(along)
            sloped = slope_lags(self.kept[0].without_gram(half.T).T[None], grid.pitch, grid.rows)
        return SurfaceProduct(
            grid=grid,
            slope_lags=sloped,
            lags=_symmetric(_between(self, 0, self, 0, C))[None],
            mode_normal=modes[0],
            recovery=seen[0].pop(SKIN),
            window=window + on_modes @ on_modes.T,
            residual_window=window,
            traces=self.traces,
            tangential=tangential,
            observed=seen[0],
            observed_tangential=seen[1] if len(seen) > 1 else {},
            first_column=self.first,
            whole_columns=self.plan.columns,
        )

    def local_mass(self, N: Array, W: Array) -> LocalMass:
        """The inertia stored in the reduced body, from N (normal functions) and W^T (normal functions, m)."""
        return dense_mass(self.kept[0], N, W)


def cross_compliance(target: GeneralSurface, source: GeneralSurface, C: Array) -> CrossCompliance:
    """Operators from C (count of `target`, count of `source`) between the loads of two surfaces of a body."""

    def lags(a: int, b: int) -> Array:
        return np.ascontiguousarray(_between(target, a, source, b, C))[None]

    if len(source.fields) == 1:
        return CrossCompliance(target.name, source.name, lags(0, 0))
    return CrossCompliance(target.name, source.name, lags(0, 0), lags(1, 1), lags(0, 1), lags(1, 0))


def _between(target: GeneralSurface, a: int, source: GeneralSurface, b: int, C: Array) -> Array:
    """D_ab of field `a` of `target` and field `b` of `source`, of C between all their loads."""
    half = target.kept[a].without_gram(C[target.parts[a], source.parts[b]])
    return source.kept[b].without_gram(half.T).T


def _symmetric(D: Array) -> Array:
    return np.ascontiguousarray(0.5 * (D + D.T))


def _recovery(transfer: Array, kept: KeptFunctions) -> Recovery:
    """Transfer (rows, count) per unit coefficient -> (rows, kept) per unit force, in its own precision."""
    out = np.empty((len(transfer), len(kept.numbers)), dtype=transfer.dtype)
    for start in range(0, len(transfer), ROWS):
        part = slice(start, start + ROWS)
        out[part] = kept.without_gram(transfer[part].T.astype(np.float64)).T
    return Recovery(out[None], 1, np.eye(3))
