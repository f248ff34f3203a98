r"""A contact surface of the general path: its grid, its traction fields, and its operators from the responses to them.

The loads of a surface are those of its fields, each a set of tractions with a Gram matrix `M`: the normal one first,
then the tangential one where it is wanted. With the compliance `C_ab = B_a^T G B_b` between fields a and b, of one
surface or of two, displacement coefficients of a per unit force of b are

    D_ab = M_a^-1 C_ab M_b^-1.

The loads stand on the whole rectangle of the grid's plan. On an arc or a plane the functions on its edges are half
ones; they are left out of the reduced body, as all that reaches beyond the facets. B and M above are those of the
functions that stay, so that the weak displacements `M_a D_ab M_b` and `M_a mode` of these are exact to the last column
(`TractionField`).
"""

from __future__ import annotations

from typing import Any

import numpy as np
import scipy.sparse as sp

from warpffrf.model.errors import InputError
from warpffrf.model.mesh import Mesh
from warpffrf.model.reduced.contact_grid import ContactGrid
from warpffrf.model.reduced.cross_compliance import CrossCompliance
from warpffrf.model.reduced.local_mass import LocalMass
from warpffrf.model.reduced.recovery import Recovery
from warpffrf.model.reduced.tangential import Tangential
from warpffrf.offline.contact.independence import check_traces, window_columns
from warpffrf.offline.contact.local_mass import dense_mass
from warpffrf.offline.contact.slopes import AROUND, slope_lags
from warpffrf.offline.contact.traction_fields import NORMAL, TANGENTIAL, ContactFacets, KeptFunctions, TractionField
from warpffrf.offline.general.observers import SKIN, Observer
from warpffrf.offline.products import SurfaceProduct

Array = np.ndarray
COVERED = 0.02  # a hat counts as inside the facets when its area is covered to this: the error of a kinked quadrature
ROWS = 4096  # rows of a transfer worked on at a time in double precision


class GeneralSurface:
    """Grid and fields of the contact surface `name` with resolved `shape`; kinds of functions as in `TractionField`."""

    def __init__(
        self,
        mesh: Mesh,
        name: str,
        shape: Any,
        spacing: float | None,
        traction: str = "hats",
        tangential: str | None = None,
        sloping: bool = False,
    ) -> None:
        self.name, self.shape, self.nodes = name, shape, len(mesh.points)
        facets = ContactFacets.of(mesh.points, mesh.facets(name), shape)
        self.plan = facets.plan(name, spacing, len(mesh.facets(name).node_set))
        self.first, self.columns = self._extent(TractionField("hats", NORMAL, self.plan, facets))
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
        """Where the loads of each field stand among all."""
        stops = np.cumsum([f.count for f in self.fields])
        return [slice(int(stop) - f.count, int(stop)) for f, stop in zip(self.fields, stops, strict=True)]

    def loads(self) -> Any:
        """B (3 n, count) of all fields, one field after the other, csc."""
        return sp.csc_matrix(sp.hstack([f.loads(self.nodes) for f in self.fields]))

    def observer(self) -> Observer | None:
        """What normal loads move along the surface, where that is wanted."""
        if self.around is None:
            return None
        return Observer(f"along/{self.name}", sp.csr_matrix(self.around.loads(self.nodes).T), np.dtype(np.float64))

    def _extent(self, hats: TractionField) -> tuple[int, int]:
        """First column, and number of columns, of those whose hats lie inside the facets. Raises `InputError` where
        there are holes."""
        inside = hats.covered(COVERED)
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

    def _grid(self, f: TractionField) -> ContactGrid:
        plan = self.plan
        start = plan.theta_start + plan.pitch * self.first
        e_0 = np.asarray(self.shape.e_0, dtype=float)
        return ContactGrid(e_0, start, plan.pitch, self.columns, plan.periodic, plan.z, self.columns, f.kind)

    def product(self, C: Array, transfers: dict[str, Array], loads_on_modes: Array, omega: Array) -> SurfaceProduct:
        """Operators from C (count, count), what the observers saw {name: (rows, count)}, and B^T Phi (count, m)."""
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
        """The inertia that the reduced body keeps, of N (normal functions) and W^T (normal functions, m)."""
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
