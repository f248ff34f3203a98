r"""A contact surface of a rotationally periodic body: grid, loads per harmonic, Gram matrix per harmonic.

Functions (of nodes or cells) of sector o load the nodes of sector 0 by `B_o` (in that sector's axes); a wave of
coefficients `s_o = s e^{i k o phi}` loads it by `B_k s`, `B_k = sum_o B_o e^{i k o phi}`, and `B_k^H u` are the
conjugate displacements. A grid coarser than the sectors, one column in q of them, has functions that are sums of fine
ones with weights w_a: nodes `1 - |a|/q`, cells 1 for -q/2 <= a < q/2 (cells around the fine columns for odd q, between
them for even q: the sum is centred). Padded with zeros it is a periodic signal on the fine columns, so `B_k` is
multiplied by `w_k = sum_a w_a e^{-i k a phi}` and results are read at every q-th column: the harmonics stay
decoupled.

A facet set on an arc uses the operators of the full revolution, of which it is a part: its functions keep their whole
support, and D is that of the full revolution restricted to the columns of the arc. So `M D M`, with M of the full
revolution, is exact on the arc. The displacements u of the global modes are multiplied by the Gram matrix M_KK of the
arc alone, which lacks the overlap of an outermost function with the next one beyond the arc. They are therefore
projected on the arc's own functions, `u_K = M_KK^-1 (M u)_K`, and the weak displacements `M_KK u_K` are exact to the
last column.

Cross. Compliance between two contact surfaces of a periodic body, harmonic by harmonic.

In harmonic k the residual response to the loads `B_k^s` of surface s is, for the functions of surface t,

    C_k = (B_k^t)^H G_res,k B_k^s,      D_k = M_k^t^-1 C_k M_k^s^-1,

and the block of two sectors that are l apart is `1/N sum_k D_k e^{i k l phi}`, as on one surface. Column J of a grid
lies on the fine column `offset + stride J` (`surface`); if both grids are full revolutions of the same stride, that
gives a block-circulant operator, every stride-th of the blocks. An arc, or two strides, has the dense operator of its
columns: like the compliance of an arc itself that of the full revolution, restricted to the existing columns, so that
own and cross compliances stay one symmetric positive semidefinite matrix.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np
import scipy.sparse as sp

from warpffrf.model.errors import InputError
from warpffrf.model.mesh import Mesh
from warpffrf.model.mesh.elements import facet_kind
from warpffrf.model.reduced.contact_grid import SurfaceGrid, meridian_gram, require_kind
from warpffrf.model.reduced.contact_surface import CrossCompliance
from warpffrf.offline.contact.contact_grid import (
    FEWEST_COLUMNS,
    FULL_TURN,
    ROUND_SPACING,
    SAME_PLACE,
    GridPlan,
    centred,
    check_count,
    largest_radius,
    nodal_plan,
    thinned_rows,
)
from warpffrf.offline.contact.local_mass import AROUND, check_traces
from warpffrf.offline.contact.node_loads import NODAL_KINDS, NORMAL, TANGENTIAL, ContactFacets
from warpffrf.offline.cyclic.sector import Sector, phase, turned
from warpffrf.offline.fe import Sparse

Array = np.ndarray


@dataclass(frozen=True)
class FacetPattern:
    """Facets of one sector, `nodes` {kind: (u, k)} (numbers below 2 nn), and the run of sectors that contain them."""

    nodes: dict[str, np.ndarray]
    first: int
    count: int


def facet_pattern(mesh: Mesh, name: str) -> FacetPattern | str:
    """The repetition of the facet set from sector to sector, or the reason why there is none."""
    if mesh.cyclic is None:
        return "the mesh is not marked as rotationally periodic"
    N, n = mesh.cyclic.sectors, len(mesh.points)
    nn = n // N
    patterns, carriers = {}, []
    for kind, nodes in mesh.facets(name).blocks.items():
        sector = nodes // nn
        low, high = sector.min(axis=1), sector.max(axis=1)
        own = np.where((low == 0) & (high == N - 1), N - 1, low)
        local = (nodes - nn * own[:, None]) % n
        if local.max() >= 2 * nn:
            return f"facets of {name!r} reach over more than two sectors"
        unique, which = np.unique(local, axis=0, return_inverse=True)
        present = np.unique(own)
        if len(nodes) != len(present) * len(unique) or len(np.unique(own * len(unique) + which.ravel())) != len(nodes):
            return f"facet set {name!r} differs from sector to sector"
        patterns[kind] = unique
        carriers.append(present)
    present = carriers[0]
    if any(not np.array_equal(present, other) for other in carriers):
        return f"facet set {name!r} differs from sector to sector"
    breaks = np.flatnonzero((present + 1) % N != np.roll(present, -1))
    if len(breaks) > 1:
        return f"facet set {name!r} covers more than one run of sectors"
    first = 0 if len(present) == N else int(present[(breaks[0] + 1) % len(present)])
    return FacetPattern(patterns, first, len(present))


class CyclicSurface:
    """Grid and traction fields of one contact surface: `normal`, and `tangential` (None if not requested); `around`:
    no load, but the direction of observed tangential displacements (`contact.slopes`; None if not requested)."""

    def __init__(
        self,
        mesh: Mesh,
        sector: Sector,
        name: str,
        shape,
        pattern: FacetPattern,
        spacing: float | None,
        traction: str = "nodes",
        tangential: str | None = None,
        sloping: bool = False,
    ) -> None:
        self.name, self.shape, self.N = name, shape, sector.count
        facets = ContactFacets.of(mesh.points, pattern.nodes, shape)
        self.edge = facets.chart.edge
        self.stride, self.plan = self._plan(mesh, facets, pattern, spacing)
        self.c = self.plan.columns // self.N
        self.first, self.columns, self.periodic = self._extent(pattern)
        self.normal = CyclicField(self, facets, sector, traction, NORMAL)
        self.tangential = None if tangential is None else CyclicField(self, facets, sector, tangential, TANGENTIAL)
        self.around = CyclicField(self, facets, sector, traction, AROUND) if sloping else None
        self.traces = check_traces(mesh, name, shape, self.normal.grid())

    @property
    def fields(self) -> list[CyclicField]:
        """The existing fields."""
        return [self.normal] if self.tangential is None else [self.normal, self.tangential]

    @property
    def offset(self) -> int:
        """Fine column of column 0 of the grid."""
        return self.first * self.stride

    def _plan(self, mesh: Mesh, facets: ContactFacets, pattern: FacetPattern, spacing: float | None):
        """Distance between columns in sectors (1 where a sector has columns), and the plan of the fine columns."""
        chart = facets.chart
        first = float(chart.theta.min())
        if spacing is None:
            if len(pattern.nodes) == 1 and next(iter(pattern.nodes)) in NODAL_KINDS:
                plan = nodal_plan(self._whole(mesh, pattern).chart, self.name, first)
                if plan is not None and plan.columns % self.N == 0:
                    return 1, plan
            spacing = chart.edge
        arc = 2.0 * np.pi / self.N * largest_radius(self.shape, chart.z)
        per_sector, stride = int(arc / spacing * (1.0 + ROUND_SPACING)), 1
        if per_sector < 1:
            reach = spacing * (1.0 + SAME_PLACE)
            strides = range(2, self.N // FEWEST_COLUMNS + 1)
            stride = max([q for q in strides if not self.N % q and q * arc <= reach], default=1)
        corners = [c.z[:, : facet_kind(kind).corner_count].ravel() for kind, _, c in facets.blocks]
        rows = thinned_rows(np.concatenate(corners), spacing)
        local = np.concatenate([block.ravel() for block in pattern.nodes.values()])
        nodes = np.unique(local % (len(mesh.points) // self.N))
        check_count(max(per_sector, 1) * len(rows), len(nodes), self.name, chart.edge)
        columns = self.N * max(per_sector, 1)
        return stride, GridPlan(first, 2.0 * np.pi / columns, columns, True, rows, False)

    def _whole(self, mesh: Mesh, pattern: FacetPattern) -> ContactFacets:
        """The facets of the full revolution."""
        n = len(mesh.points)
        shift = n // self.N * np.arange(self.N)[:, None, None]
        whole = {kind: (nodes[None] + shift).reshape(-1, nodes.shape[1]) % n for kind, nodes in pattern.nodes.items()}
        return ContactFacets.of(mesh.points, whole, self.shape)

    def _extent(self, pattern: FacetPattern) -> tuple[int, int, bool]:
        """First column of the grid, number of columns of nodes, full revolution or not."""
        q, c = self.stride, self.c
        if pattern.count == self.N:
            return 0, self.plan.columns // q, True
        if q > 1:
            first = -(-pattern.first // q) + 1
            columns = (pattern.first + pattern.count) // q - first
        else:
            first, columns = c * (pattern.first + 1), c * (pattern.count - 1)
        if columns < 1:
            raise InputError(
                f"contact {self.name!r}: the facets span {pattern.count} sectors, too short for one node; "
                "choose a longer arc or a smaller spacing of the contact grid"
            )
        return first, columns, False


def by_distance(of_harmonics: Array, first: CyclicField, second: CyclicField) -> Array:
    """Blocks (N, count of `first`, count of `second`) of `M_first^-1 C M_second^-1` by distance in sectors, of C in the
    harmonics 0 to N//2."""
    D = np.empty_like(of_harmonics)
    for k, C in enumerate(of_harmonics):
        half = first.without_gram(k, C)
        D[k] = second.without_gram(k, half.conj().T).conj().T
    return np.fft.irfft(D, n=first.N, axis=0)


class CyclicField:
    """Functions of one kind in one or two directions: loads and Gram matrix of every harmonic.

    Functions of a sector are numbered by direction, column, row.
    """

    def __init__(
        self, surface: CyclicSurface, facets: ContactFacets, sector: Sector, kind: str, directions: tuple[str, ...]
    ) -> None:
        self.surface, self.kind, self.directions = surface, require_kind(kind), directions
        self.c, self.N, self.stride = surface.c, surface.N, surface.stride
        plan = surface.plan
        self._axes = sector.axes
        self.rows, self.columns = len(plan.z), surface.columns
        self.pitch = plan.pitch * self.stride
        self._gram_z = meridian_gram(kind, surface.shape, plan.z)
        self._B: dict[int, Sparse] = {}
        if kind == "cells" and self.stride % 2 == 0:
            plan = replace(plan, theta_start=plan.theta_start + 0.5 * plan.pitch)
        for number, direction in enumerate(directions):
            self._add_loads(facets.loads(plan, kind, direction), sector, number)

    @property
    def count(self) -> int:
        """Functions of one sector, all directions."""
        return len(self.directions) * self.c * self.rows

    def grid(self) -> SurfaceGrid:
        """The grid of the field as stored in the reduced body."""
        s = self.surface
        start = s.plan.theta_start + s.first * self.pitch
        if not s.periodic:
            start = centred(start, self.pitch * (self.columns - 1), FULL_TURN)
        e_0 = np.asarray(s.shape.e_0, dtype=float)
        return SurfaceGrid(e_0, start, self.pitch, self.columns, s.periodic, s.plan.z, self.c, self.kind)

    def _add_loads(self, loads, sector: Sector, number: int) -> None:
        nn = sector.nodes
        of_node, node = loads.node // nn, loads.node % nn
        of_shape_function, part = loads.column // self.c, loads.column % self.c
        for s in (0, 1):
            axes = np.stack([turned(a[None], sector.axes, s * sector.phi)[0] for a in sector.axes.T], axis=1)
            for o in np.unique(of_shape_function[of_node == s]):
                here = (of_node == s) & (of_shape_function == o)
                function = (number * self.c + part[here]) * self.rows + loads.row[here]
                dofs = (3 * node[here][:, None] + np.arange(3)).ravel()
                entries = ((loads.value[here] @ axes).ravel(), (dofs, np.repeat(function, 3)))
                block = sp.csr_matrix(entries, shape=(3 * nn, self.count))
                at = int(o) - s
                self._B[at] = block if at not in self._B else self._B[at] + block

    def loaded_nodes(self) -> Array:
        """Nodes of the sector with loads."""
        return np.unique(np.concatenate([np.flatnonzero(np.diff(block.indptr)) // 3 for block in self._B.values()]))

    def load(self, k: int) -> Sparse:
        """B_k (3 nn, count), csr."""
        total = sum(phase(k * o, self.N) * block for o, block in self._B.items())
        q = self.stride
        if q == 1:
            return sp.csr_matrix(total)
        if self.kind == "cells":
            return sp.csr_matrix(total * sum(phase(-k * a, self.N) for a in range(-(q // 2), q - q // 2)))
        weight = sum((1.0 - abs(a) / q) * np.cos(2.0 * np.pi * k * a / self.N) for a in range(1 - q, q))
        return sp.csr_matrix(total * weight)

    def phases(self, k: int) -> Array:
        """Unit factors p (count,): loads `Q_k^H B_k diag(p)` of functions on node planes are real in the coordinates of
        `waves`."""
        plan, shape = self.surface.plan, self.surface.shape
        around = np.cross(shape.e_a, shape.e_0)
        start = (np.cos(plan.theta_start) * shape.e_0 + np.sin(plan.theta_start) * around) @ self._axes
        angle = np.arctan2(start[1], start[0]) + plan.pitch * np.arange(self.c)
        turned_by = np.array([1.0j if direction == "theta" else 1.0 for direction in self.directions])
        wave = turned_by[:, None] * np.exp(1j * k * angle)
        return np.repeat(wave.ravel(), self.rows)

    def without_gram(self, k: int, values: Array) -> Array:
        """M_k^-1 `values` (count, m), M_k the Gram matrix in harmonic k."""
        c, rows, directions = self.c, self.rows, len(self.directions)
        parts = values.reshape(directions, c, rows, -1)
        if self.kind == "cells":
            return (parts / (self.pitch * np.diag(self._gram_z))[:, None]).reshape(values.shape)
        M = np.zeros((c, c), dtype=complex)
        for a in range(c):
            for d, entry in ((-1, 1.0 / 6.0), (0, 2.0 / 3.0), (1, 1.0 / 6.0)):
                M[a, (a + d) % c] += self.pitch * entry * phase(self.stride * k * ((a + d) // c), self.N)
        around = np.linalg.solve(M, parts.reshape(directions, c, -1)).reshape(directions * c, rows, -1)
        return np.linalg.solve(self._gram_z, around).reshape(values.shape)

    def sampled(self, k: int, amplitude: Array, columns: int | None = None, start: int = 0) -> Array:
        """Waves `amplitude` (count, m) e^{i k s phi} at the columns of the grid, or at the `columns` starting at column
        `start`: (directions columns rows, m)."""
        fine = self.surface.offset + self.stride * (start + np.arange(self.columns if columns is None else columns))
        wave = np.array([phase(k * int(s), self.N) for s in fine // self.c])
        parts = amplitude.reshape(len(self.directions), self.c, self.rows, -1)[:, fine % self.c]
        return (parts * wave[:, None, None]).reshape(len(self.directions) * len(fine) * self.rows, -1)

    def projected(self, k: int, amplitude: Array) -> Array:
        """As `sampled` at the columns of the grid; on an arc projected on its own functions."""
        if self.surface.periodic or self.kind == "cells":
            return self.sampled(k, amplitude)
        around = self.sampled(k, amplitude, self.columns + 2, -1)
        u = around.reshape(len(self.directions), self.columns + 2, -1)
        weak = self.pitch * (2.0 / 3.0 * u[:, 1:-1] + (u[:, :-2] + u[:, 2:]) / 6.0)
        found = np.linalg.solve(self.grid().gram_theta(), weak)
        return found.reshape(len(self.directions) * self.columns * self.rows, -1)


class CyclicCross:
    """Displacements of surface `target` under loads on surface `source`, accumulated over the harmonics."""

    def __init__(self, target: CyclicSurface, source: CyclicSurface) -> None:
        self.target, self.source = target, source
        self._C = {
            (a, b): np.zeros((target.N // 2 + 1, of_target.count, of_source.count), dtype=complex)
            for a, of_target in enumerate(target.fields)
            for b, of_source in enumerate(source.fields)
        }

    def add(
        self,
        k: int,
        targets: Sequence[Sparse],
        response: Array,
        parts: Sequence[Array],
        scaled: Array | None,
        on_modes: Sequence[Array],
    ) -> None:
        """Harmonic k: `targets` (n, count) are the loads of the target's fields, `response @ parts[b]` the responses
        (n, count) to those of the source's field b; `scaled` (n, p) the global modes over their frequencies, None if
        there are none, and `on_modes[b]` (count, p) those loads on them."""
        for a, load in enumerate(targets):
            seen = load.conj().T @ response
            for b, part in enumerate(parts):
                self._C[a, b][k] = seen @ part
                if scaled is not None:
                    self._C[a, b][k] -= (load.conj().T @ scaled) @ on_modes[b].conj().T

    def product(self) -> CrossCompliance:
        """The finished operators."""
        names = self.target.name, self.source.name
        if len(self._C) == 1:
            return CrossCompliance(*names, self._lags(0, 0))
        return CrossCompliance(*names, self._lags(0, 0), self._lags(1, 1), self._lags(0, 1), self._lags(1, 0))

    def _lags(self, a: int, b: int) -> Array:
        t, s = self.target, self.source
        first, second = t.fields[a], s.fields[b]
        blocks = by_distance(self._C[a, b], first, second)
        if t.periodic and s.periodic and t.stride == s.stride:
            return np.ascontiguousarray(blocks[:: t.stride])
        (sector, part), (other, other_part) = _places(t), _places(s)
        lag = (sector[:, None] - other) % t.N
        parted = blocks.reshape(t.N, *_numbers(first), *_numbers(second))
        D = parted[lag, :, part[:, None], :, :, other_part, :]  # (columns, columns, d_t, rows, d_s, rows)
        D = D.transpose(2, 0, 3, 4, 1, 5)
        return np.ascontiguousarray(D).reshape(1, np.prod(D.shape[:3]), np.prod(D.shape[3:]))


def _places(surface: CyclicSurface) -> tuple[Array, Array]:
    """Sector of the grid's columns and position in it."""
    fine = surface.offset + surface.stride * np.arange(surface.columns)
    return fine // surface.c, fine % surface.c


def _numbers(field: CyclicField) -> tuple[int, int, int]:
    """Directions, columns of a sector, rows."""
    return len(field.directions), field.c, field.rows
