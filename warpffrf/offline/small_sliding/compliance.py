r"""The joint interfaces of one body on the general path: cells, unit loads, and the compliance among all of them.

With the loads B of all cells of all interfaces in one matrix (`loads`), the responses of the residual flexibility

    G_res = P^T K^+ P - Phi omega^-2 Phi^T,        C = B^T G_res B,        modes = (B^T Phi)^T

are those of `general.unit_loads`, in blocks. It contains the cells of both faces of a pair, D_AA - D_AB - D_BA +
D_BB, and the coupling between the interfaces of a body, as in leaves of a spring connected at their clamp.

Loads. Frames of cells, and the loads of unit forces along them.

The first tangent of all cells is the projection of one axis of the user frame, that which is furthest from all normals
of the interface: one direction on a plane, along the axis on a cylinder. If a normal is close to it, as on a
sphere, the axis furthest from that normal is used instead.

A force of 1 N along d, mean traction times area, loads a face by `d` times the weights of its mean displacement
(`cells`), so that `B^T u` is that displacement; a pair has the opposite load on its first face.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
import scipy.sparse as sp
from scipy.linalg import lapack as _lapack

from warpffrf.model.errors import InputError
from warpffrf.model.mesh import Mesh
from warpffrf.model.small_sliding import MatchedSurface
from warpffrf.model.surfaces import Matched
from warpffrf.offline.elastic import ElasticModel
from warpffrf.offline.general.checkpoint import Checkpoint
from warpffrf.offline.general.observers import Observer
from warpffrf.offline.general.unit_loads import ResponseSolver, UnitLoads, results_bytes
from warpffrf.offline.products import MatchedProduct
from warpffrf.offline.progress import Progress
from warpffrf.offline.small_sliding.cells import Cells, make_cells

lapack: Any = _lapack  # routines made at import, unknown to type checkers
TITLE = "matched"  # of the responses, in the work file and on the progress bar
# Active cells are solved simultaneously: a factorisation of 1,200 takes 83 ms, of 2,400 half a second.
MANY_CELLS = 1500
# Of the compliance of a cell under its own load: the remainder beyond the previous cells, in the order of a pivoted
# Cholesky factorisation, if it depends on these. Round-off of a compliance is far below, cells of a mesh far above.
DEPENDENT = 1e-10
SKIN_BYTES = 1 << 28  # of the response of the display skin to interface forces; larger files are slow to read
HELD = 1e-9  # of the largest residual compliance of a cell: below it a rigid interface constrains the cell


@dataclass(frozen=True, eq=False)
class MatchedFaces:
    """Cells and frames of the joint interfaces of a body, by name."""

    cells: dict[str, Cells]
    axes: dict[str, Array]
    by: dict[str, str]

    @classmethod
    def of(cls, mesh: Mesh, matched: Mapping[str, Matched]) -> MatchedFaces:
        """The joint interfaces requested of a mesh; raises `InputError` as `cells.make_cells` does."""
        cells = {name: make_cells(mesh, name, wanted) for name, wanted in matched.items()}
        axes = {name: frames(found.normals) for name, found in cells.items()}
        return cls(cells, axes, {name: wanted.by for name, wanted in matched.items()})

    @property
    def unknowns(self) -> int:
        """Forces of all cells."""
        return 3 * sum(cells.count for cells in self.cells.values())

    def loads(self) -> Any:
        """B (3 n, unknowns) csc of all interfaces, one after the other."""
        return sp.csc_matrix(sp.hstack([unit_loads(cells, self.axes[name]) for name, cells in self.cells.items()]))

    def observers(self, skin: Observer, others: Sequence[Observer]) -> list[Observer]:
        """The observers of the responses to interface forces: the skin too, as long as it stays small."""
        return [*others, skin] if self._small(skin) else [*others]

    def _small(self, skin: Observer) -> bool:
        return skin.rows * self.unknowns * skin.dtype.itemsize <= SKIN_BYTES

    def require_room(self, observers: Sequence[Observer], limit: int) -> None:
        """Raises `InputError` if the compliance and the observed responses do not fit into `limit` [byte]."""
        needed = results_bytes([self.unknowns], observers)
        if needed > limit:
            counts = ", ".join(f"{name!r} {cells.count}" for name, cells in self.cells.items())
            raise InputError(
                f"matched faces: the compliance of {self.unknowns} forces (cells: {counts}) needs {needed} bytes "
                f"({needed / 2**30:.3g} GiB), memory_limit is {limit / 2**30:.3g} GiB; make larger cells by "
                "surfaces.Matched(size=, growth=), or raise memory_limit"
            )

    def product(
        self,
        model: ElasticModel,
        omega: Array,
        Phi: Array,
        T: Any,
        observers: Sequence[Observer],
        limit: int,
        progress: Progress,
        checkpoint: Checkpoint,
    ) -> MatchedProduct:
        """Cells with their modes, and the compliance; arguments as those of `ResponseSolver`."""
        B = self.loads()
        loads = sp.csc_matrix(T.T @ B)
        solver = ResponseSolver(model, omega, Phi, T, [UnitLoads(TITLE, loads)], observers, limit)
        found = solver.responses(0, progress, checkpoint)
        modes = np.asarray(loads.T @ Phi).T
        surfaces, start = {}, 0
        for name, cells in self.cells.items():
            part = slice(start, start + 3 * cells.count)
            surfaces[name] = _surface(name, cells, self.axes[name], modes[:, part], self.by[name])
            start = part.stop
        return MatchedProduct(
            surfaces=surfaces,
            compliance=found.compliance,
            observed={o.name: t for o, t in zip(observers, found.transfers, strict=True)},
            notes=[*(note for cells in self.cells.values() for note in cells.notes), *_gaps(surfaces)],
            warnings=_doubts(surfaces, found.compliance, modes / omega[:, None]),
        )


def _surface(name: str, cells: Cells, axes: Array, modes: Array, by: str) -> MatchedSurface:
    edges = np.sqrt(cells.area)
    pair = cells.second is not None
    return MatchedSurface(
        name=name,
        pair=pair,
        points=cells.points,
        frames=axes,
        area=cells.area,
        gap=cells.gap,
        modes=np.ascontiguousarray(modes),
        triangles=cells.triangles,
        cell=cells.cell,
        covered=cells.covered,
        distance=(float(cells.area @ cells.gap / cells.area.sum()), float(cells.gap.max())) if pair else (0.0, 0.0),
        size=(float(edges.min()), float(edges.max())),
        by=by,
    )


def _gaps(surfaces: Mapping[str, MatchedSurface]) -> list[str]:
    """Notes on initial gaps."""
    return [
        f"contact {name!r}: the faces are {s.distance[0]:.3g} m apart in the mean, {s.distance[1]:.3g} m at most"
        + (f", and overlap by up to {-s.gap.min():.3g} m" if s.gap.min() < 0.0 else "")
        for name, s in surfaces.items()
        if s.pair and np.abs(s.gap).max() > 1e-9 * np.ptp(s.triangles.reshape(-1, 3), axis=0).max()
    ]


def _doubts(surfaces: Mapping[str, MatchedSurface], C: Array, softness: Array) -> list[str]:
    """Warnings: cells dependent on the mesh, constrained cells, very many cells. `softness` (m, unknowns):
    modes over angular frequencies."""
    found = []
    total = sum(s.cells for s in surfaces.values())
    if total > MANY_CELLS:
        found.append(
            f"matched faces: {total} cells, more than {MANY_CELLS}: steps solve for all that are in play at once, at a "
            "cost that grows with the third power; make larger cells by surfaces.Matched(size=, growth=)"
        )
    start = 0
    for name, s in surfaces.items():
        normal = start + 3 * np.arange(s.cells)
        start += s.unknowns
        own = C[np.ix_(normal, normal)]
        held = np.diag(own) < HELD * np.diag(C).max()
        if held.any():
            found.append(
                f"contact {name!r}: {int(held.sum())} of {s.cells} cells hardly give way, a rigid interface holds "
                "their nodes; end the face a row of facets before it, or make it 'average', which holds them in the "
                "mean alone"
            )
            own, normal = own[np.ix_(~held, ~held)], normal[~held]
        own = own + softness[:, normal].T @ softness[:, normal]
        if len(own) and (rank := _rank(own)) < len(own):
            cure = "end the face a row of facets before a rigid interface, which takes what its nodes get"
            if s.by == "facets":
                cure += "; where there is none, make larger cells by surfaces.Matched(size=), or take by='nodes'"
            found.append(
                f"contact {name!r}: {len(own) - rank} of {s.cells} cells depend on the others: some pressures that "
                f"change from cell to cell load no node; {cure}"
            )
    return found


def _rank(matrix: Array) -> int:
    """Rank of a semidefinite matrix scaled to a unit diagonal, by Cholesky factorisation with pivoting."""
    scale = 1.0 / np.sqrt(np.diag(matrix))
    return int(lapack.dpstrf(matrix * scale[:, None] * scale, tol=DEPENDENT, lower=1)[2])


Array = np.ndarray
NEAR = 0.9  # |cosine| between a normal and the common axis above which the cell uses another


def frames(normals: Array) -> Array:
    """Frames (c, 3, 3), rows n, t_1, t_2, right-handed, of unit normals (c, 3); see the module docstring."""
    leaning = np.abs(normals)
    common = int(np.argmin(np.round(leaning.max(axis=0), 9)))
    axis = np.where(leaning[:, common] < NEAR, common, np.argmin(np.round(leaning, 9), axis=1))
    e = np.eye(3)[axis]
    first = e - np.einsum("ci,ci->c", e, normals)[:, None] * normals
    first /= np.linalg.norm(first, axis=1, keepdims=True)
    return np.stack([normals, first, np.cross(normals, first)], axis=1)


def unit_loads(cells: Cells, axes: Array) -> Any:
    """B (3 n, 3 c) csc: nodal loads of a unit force of each cell along each row of its frame `axes` (c, 3, 3); for a
    pair on the second face, and the opposite on the first."""
    weights = cells.first if cells.second is None else cells.second - cells.first
    W = sp.coo_matrix(weights)
    entries = W.data[:, None, None] * axes[W.row]  # (e, 3 rows of the frame, 3 user axes)
    rows = np.broadcast_to(3 * W.col[:, None, None] + np.arange(3), entries.shape)
    columns = np.broadcast_to(3 * W.row[:, None, None] + np.arange(3)[:, None], entries.shape)
    shape = (3 * weights.shape[1], 3 * weights.shape[0])
    return sp.csc_matrix((entries.ravel(), (rows.ravel(), columns.ravel())), shape=shape)
