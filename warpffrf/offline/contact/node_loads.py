r"""Consistent nodal loads of the functions of a contact grid: `B psi_i`, `(B psi_i)_a = int N_a psi_i d dA`.

psi are the bilinear shape functions on the nodes of a grid or the cells around them (1 on a cell, 0 elsewhere;
`model.contact_grid` states why not between them), d a direction of the surface: the normal n away from the material,
the circumferential `e_theta`, or the meridian `t_z = (R' e_r + e_a)/sqrt(1 + R'^2)`, with `e_theta x t_z = n`; if the
material lies outside (a bore), e_theta points against the columns. The integral runs over the *chart* of the true
surface, pulled back to the facets: theta and z of a facet are interpolated from its nodes' chart coordinates,
`theta = sum N_a theta_a`, `z = sum N_a z_a`, and

    dA = R(z) sqrt(1 + R'(z)^2) |d(theta, z)/d(xi, eta)| dxi deta,      d taken on the true surface at (theta, z).

So neighbouring facets meet without gap or overlap and the area is that of the true surface; since `sum_a N_a = 1` and
`sum_i psi_i = 1` a constant pressure is applied exactly, and on a structured linear mesh with the nodal grid
`N_a = psi_a`: the loads are then `f_a = sum_i M_ai s_i` with the Gram matrix `M` of the shape functions.
The transposed operator gives the coefficients of a displacement, `M^-1 B^T u`: loads and displacements are conjugate.

Cut quadrature. Quadrature over facets that are cut by the lines of a contact grid.

The shape functions of a contact grid have kinks, and those of cells jumps, at its lines, which cross the facets of an
unstructured mesh anywhere. Facets are split into triangles of their domain, and each triangle is cut along the
lines that cross it, with theta and z taken as linear in the triangle. That is exact if they are linear (triangles with
straight edges, quadrilaterals that are parallelograms in the chart), and no piece then contains a kink: a Gauss rule on
each is exact for polynomials. Other facets are split until a line deviates by at most `BEND` of a spacing. The pieces
fill every facet in any case, so that areas and loads are complete.

Traction fields on the grid of a contact surface: their loads on the mesh and their Gram matrix, for both paths.

A field is a basis (shape functions on the nodes of one `GridPlan`, or cells around them) in one or several directions.
Coefficients s of a traction load the mesh by `B s`, and `M^-1 B^T u` are the coefficients of a displacement u: its L2
projection. Functions are numbered by direction, column, row.

If a reduced body has only some of the functions, K, the projection is that on their span, with the Gram matrix of
these alone,

    a = M_KK^-1 B_K^T u,        so that        sum_j (M_KK)_ij a_j = B_i^T u = int psi_i u dA for every i in K:

weak displacements, all that contact laws use, are exact up to the last kept column. Coefficients of the projection on
*all* functions, with those outside K discarded, would lose their contribution: for a constant
displacement a sixth at each end, on a single column a third.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from functools import cached_property
from typing import Any

import numpy as np
import scipy.sparse as sp

from warpffrf.model.mesh.elements import facet_kind
from warpffrf.model.mesh.facets import FacetSet
from warpffrf.model.reduced.contact_grid import meridian_gram
from warpffrf.offline.contact.contact_grid import Chart, GridPlan, facet_chart, nodal_plan, spaced_plan, wrapped
from warpffrf.offline.fe import FACET_DEGREE, Sparse, rule

# Lines of the nodal grid run along the edges of linear facets and through the middle of quadratic ones: this number of
# equal pieces of a facet contains no kink. All other grids cut the facets, see `cut_quadrature`.
PIECES = {"quad4": 1, "quad9": 2}
CHUNK = 2000  # facets processed together: with a grid as fine as the mesh some 100 MB
POINTS = 20_000  # quadrature points processed together: 9 nodes, 4 functions and 4 values of each are 23 MB
DIRECTIONS = ("normal", "theta", "meridian")
Direction = str | Callable[[np.ndarray, np.ndarray], np.ndarray]  # one of the names, or vectors (..., 3) at (theta, z)


@dataclass(frozen=True)
class NodeLoads:
    """Entries of B: load vectors `value` (e, 3) [m^2] on mesh `node` (e,) per unit coefficient of function (`column`,
    `row`).

    `area` (e,) [m^2] is the part int N_a psi_i dA of the function's area, so that the sum over nodes is int psi_i dA.
    Columns count from the plan's `theta_start` and on a full revolution are not wrapped: take them modulo `columns`.
    """

    node: np.ndarray
    column: np.ndarray
    row: np.ndarray
    value: np.ndarray
    area: np.ndarray


def node_loads(
    kind: str,
    nodes: np.ndarray,
    chart: Chart,
    shape,
    plan: GridPlan,
    *,
    basis: str = "nodes",
    direction: Direction = "normal",
) -> NodeLoads:
    """Loads of all functions of `plan` that reach the facets `nodes` (m, k) of `kind`: `basis` "nodes" on its nodes or
    "cells" around them, between the lines `GridPlan.lines`, in one of `DIRECTIONS` or in user-defined vectors. Rows and
    edge columns are clipped."""
    parts = []
    for start in range(0, len(nodes), CHUNK):
        here = slice(start, start + CHUNK)
        parts.append(_loads(kind, nodes[here], chart.theta[here], chart.z[here], shape, plan, basis, direction))
    return merged_loads(parts, len(plan.z))


def surface_vectors(shape, theta: np.ndarray, z: np.ndarray, direction: Direction) -> np.ndarray:
    """Unit vectors (..., 3), user axes, of a `direction` of the surface `shape` at (theta, z)."""
    if callable(direction):
        return direction(theta, z)
    if direction == "normal":
        return shape.normal(theta, z)
    return shape.around(theta, z) if direction == "theta" else shape.along(theta, z)


def _loads(kind, nodes, theta, z, shape, plan: GridPlan, basis: str, direction: Direction) -> NodeLoads:
    """Loads of some facets, see `node_loads`."""
    x = (theta - plan.theta_start) / plan.pitch
    if not plan.periodic:  # facets on either side of theta = 0 belong to one arc
        turn, low = shape.profile().turn / plan.pitch, x.min(axis=1, keepdims=True)
        x = x + (wrapped(low, turn, -0.5 / turn) - low)
    j = k = None  # the lines below each point
    if plan.nodal and kind in PIECES:
        r = rule(kind, FACET_DEGREE[kind], PIECES[kind])
        facet = np.repeat(np.arange(len(nodes)), len(r.weights))
        N, slopes, weight = (
            np.tile(v, (len(nodes),) + (1,) * (v.ndim - 1)) for v in (r.values, r.gradients, r.weights)
        )
    else:
        lines = (int(np.floor(x.min())), int(np.ceil(x.max())))
        facet, points, weight, j, k = cut_points(kind, x, z, lines, plan.z)
        N, slopes = facet_kind(kind).shape(points)  # (p, k), (p, k, 2)
    at_x, at_z = np.einsum("pk,pk->p", N, x[facet]), np.einsum("pk,pk->p", N, z[facet])
    if j is None:
        j = np.floor(at_x).astype(np.int64)
        k = np.clip(np.searchsorted(plan.z, at_z, side="right") - 1, 0, len(plan.z) - 2)
    dx = np.einsum("pk,pkd->pd", x[facet], slopes)
    dz = np.einsum("pk,pkd->pd", z[facet], slopes)
    stretch = np.abs(dx[:, 0] * dz[:, 1] - dx[:, 1] * dz[:, 0]) * plan.pitch
    area = weight * stretch * shape.measure_at(at_z)
    load = surface_vectors(shape, plan.theta_start + plan.pitch * at_x, at_z, direction) * area[:, None]

    # points of one facet under the same functions are summed first, which leaves fewer entries to sort
    column, row, psi = _functions(plan, basis, at_x, at_z, j, k)
    low = column[:, 0].min(initial=0)
    width = (column[:, 0].max(initial=0) - low + 1) * len(plan.z)
    group = facet * width + (column[:, 0] - low) * len(plan.z) + row[:, 0]
    _, first, member = np.unique(group, return_index=True, return_inverse=True)
    member = member.ravel()
    points, nodes_each, f = len(member), N.shape[1], psi.shape[1]
    sums = np.zeros((len(first), nodes_each * f * 4))
    four = np.concatenate([load, area[:, None]], axis=1)
    for start in range(0, points, POINTS):
        here = slice(start, start + POINTS)
        values = (N[here, :, None, None] * psi[here, None, :, None] * four[here, None, None, :]).reshape(
            -1, nodes_each * f * 4
        )
        ones = (np.ones(len(values)), (member[here], np.arange(len(values))))
        sums += sp.csr_matrix(ones, shape=(len(first), len(values))) @ values
    sums = sums.reshape(-1, 4)
    full = (len(first), nodes_each, f)
    return _summed(
        np.broadcast_to(nodes[facet[first]][:, :, None], full).ravel(),
        np.broadcast_to(column[first][:, None, :], full).ravel(),
        np.broadcast_to(row[first][:, None, :], full).ravel(),
        sums[:, :3],
        sums[:, 3],
        len(plan.z),
    )


def _functions(plan: GridPlan, basis: str, x, z, j, k) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Columns, rows and values (p, f) of the functions that are not zero at points (x, z) between the lines j, j + 1
    and k, k + 1."""
    if not plan.periodic:
        j = np.clip(j, 0, plan.columns - 2)
    if basis == "cells":
        return j[:, None], k[:, None], np.ones((len(x), 1))
    s, t = np.clip(x - j, 0.0, 1.0), np.clip((z - plan.z[k]) / (plan.z[k + 1] - plan.z[k]), 0.0, 1.0)
    psi = np.stack([(1 - s) * (1 - t), (1 - s) * t, s * (1 - t), s * t], axis=1)
    return np.stack([j, j, j + 1, j + 1], axis=1), np.stack([k, k + 1, k, k + 1], axis=1), psi


def _summed(node, column, row, value, area, rows: int) -> NodeLoads:
    """Sum entries with the same node and function."""
    low = column.min(initial=0)
    width = (column.max(initial=0) - low + 1) * rows
    key = node * width + (column - low) * rows + row
    _, first, inverse = np.unique(key, return_index=True, return_inverse=True)
    summed = [np.bincount(inverse.ravel(), weights=w, minlength=len(first)) for w in (*value.T, area)]
    return NodeLoads(node[first], column[first], row[first], np.stack(summed[:3], axis=1), summed[3])


def merged_loads(parts: list[NodeLoads], rows: int) -> NodeLoads:
    """Loads of several groups of facets on one grid as one, entries of the same node and function summed."""
    if len(parts) == 1:
        return parts[0]
    node, column, row, value, area = (
        np.concatenate([getattr(p, name) for p in parts]) for name in ("node", "column", "row", "value", "area")
    )
    return _summed(node, column, row, value, area, rows)


Array = np.ndarray
# Degree of the rule on a piece: 4 of the product of node function and grid function, the rest for the rotating normal
# (1e-9 over 20 degrees). On facets split in three and more the pieces are small, and the bend limits the accuracy.
DEGREE, DEGREE_OF_SMALL, SMALL_PIECES = 8, 5, 3
TOUCHES = 1e-9  # of the distance between lines: a line this close to a vertex does not cut
# Distance of a cut from its true line, in spacings of the lines: this fraction of the area of a cell, and less of that
# of a shape function, which vanishes at its outer lines, is assigned to the neighbour.
BEND = 2e-3
MOST_PIECES = 4  # along an edge of a facet; a mesh that would need more is distorted beyond use


def cut_points(kind: str, x: Array, z: Array, columns: tuple[int, int], rows: Array) -> tuple[Array, ...]:
    """Facet number (p,), reference point (p, 2) and reference weight (p,) of a rule without kinks in its pieces, and
    the numbers (p,) of the column and of the row of lines below the piece of each point.

    `x`, `z` (m, k): chart coordinates of the facets' nodes, x counted in columns of the grid, whose lines are all
    integers from `columns[0]` to `columns[1]`; `rows`: the ascending lines of z.
    """
    pieces = _pieces(kind, x, z / np.min(np.diff(rows)))
    corners = _triangles(kind, pieces)  # (t, 3, 2) reference
    N, _ = facet_kind(kind).shape(corners.reshape(-1, 2))
    m, t = len(x), len(corners)
    facet = np.repeat(np.arange(m), t)
    place = np.tile(corners, (m, 1, 1))  # (m t, 3, 2)
    chart = np.stack([(v @ N.T).reshape(m * t, 3) for v in (x, z)], axis=2)
    lines = (np.arange(columns[0], columns[1] + 1, dtype=float), np.asarray(rows, dtype=float))
    for axis in (0, 1):
        facet, place, chart = _cut(facet, place, chart, axis, lines[axis])
    r = rule("tri3", DEGREE if pieces < SMALL_PIECES else DEGREE_OF_SMALL)
    points = np.einsum("qv,pvd->pqd", r.values, place)
    a, b = place[:, 1] - place[:, 0], place[:, 2] - place[:, 0]
    size = np.abs(a[:, 0] * b[:, 1] - a[:, 1] * b[:, 0])
    middle = chart.mean(axis=1)
    column = np.floor(middle[:, 0]).astype(np.int64)
    row = np.clip(np.searchsorted(rows, middle[:, 1], side="right") - 1, 0, len(rows) - 2)
    facet, column, row = (np.repeat(v, len(r.weights)) for v in (facet, column, row))
    return facet, points.reshape(-1, 2), np.outer(size, r.weights).ravel(), column, row


def _pieces(kind: str, x: Array, z: Array) -> int:
    """Pieces along an edge of the facets with chart coordinates x, z (m, k) in spacings.

    A triangle's bend, the deviation of the middle of its edges from straight, falls with the square of their number.
    """
    corners = _triangles(kind, 1)
    middles = 0.5 * (corners + np.roll(corners, 1, axis=1))
    shape = facet_kind(kind).shape
    at, between = (shape(v.reshape(-1, 2))[0].reshape(*v.shape[:2], -1) for v in (corners, middles))
    off = between - 0.5 * (at + np.roll(at, 1, axis=1))  # (t, 3, k)
    bend = max(float(np.abs(v @ off.reshape(-1, off.shape[2]).T).max(initial=0.0)) for v in (x, z))
    return int(np.clip(np.ceil(np.sqrt(bend / BEND)), 1, MOST_PIECES))


def _triangles(kind: str, n: int) -> Array:
    """Triangles (t, 3, 2) that fill the reference domain of a facet with n pieces along each edge."""
    if facet_kind(kind).domain == "quad":
        line = np.linspace(-1.0, 1.0, n + 1)
        low = np.array([(line[i], line[j]) for i in range(n) for j in range(n)])
        a, b, c, d = (low + np.array(step) * (2.0 / n) for step in ((0, 0), (1, 0), (1, 1), (0, 1)))
        return np.concatenate([np.stack([a, b, c], axis=1), np.stack([a, c, d], axis=1)])
    up = [((i, j), (i + 1, j), (i, j + 1)) for i in range(n) for j in range(n - i)]
    down = [((i + 1, j + 1), (i, j + 1), (i + 1, j)) for i in range(n) for j in range(n - 1 - i)]
    return np.array(up + down, dtype=float) / n


def _cut(facet: Array, place: Array, chart: Array, axis: int, lines: Array) -> tuple[Array, Array, Array]:
    """Cut triangles along `lines` of one chart coordinate; each pass halves the number of lines crossing a triangle."""
    slack = TOUCHES * np.min(np.diff(lines)) if len(lines) > 1 else 0.0
    done = []
    while len(facet):
        v = chart[:, :, axis]
        first = np.searchsorted(lines, v.min(axis=1) + slack, side="right")
        last = np.searchsorted(lines, v.max(axis=1) - slack, side="left")
        whole = last <= first
        done.append((facet[whole], place[whole], chart[whole]))
        facet, place, chart = facet[~whole], place[~whole], chart[~whole]
        at = lines[(first[~whole] + last[~whole]) // 2]
        order = np.argsort(chart[:, :, axis], axis=1)[:, :, None]
        both = np.take_along_axis(np.concatenate([place, chart], axis=2), order, axis=1)  # a <= b <= c, (n, 3, 4)
        a, b, c = both[:, 0], both[:, 1], both[:, 2]
        va, vb, vc = (both[:, i, 2 + axis] for i in range(3))
        above = (at >= vb)[:, None]
        # the vertex alone on its side, and the two others
        tip, one, two = np.where(above, c, a), np.where(above, a, b), np.where(above, b, c)
        vt, v1, v2 = (np.where(above[:, 0], *pair) for pair in ((vc, va), (va, vb), (vb, vc)))
        p = tip + (one - tip) * ((at - vt) / (v1 - vt))[:, None]
        q = tip + (two - tip) * ((at - vt) / (v2 - vt))[:, None]
        p[:, 2 + axis] = q[:, 2 + axis] = at
        split = np.concatenate([np.stack(t, axis=1) for t in ((tip, p, q), (p, one, two), (p, two, q))])
        facet = np.tile(facet, 3)
        place, chart = split[:, :, :2], split[:, :, 2:]
    return tuple(np.concatenate(parts) for parts in zip(*done, strict=True))  # type: ignore[return-value]


NORMAL = ("normal",)
TANGENTIAL = ("theta", "meridian")
NODAL_KINDS = ("quad4", "quad9")  # facets whose nodes can be a full tensor product


@dataclass(frozen=True)
class ContactFacets:
    """Facets of a contact surface in the chart of its `shape`: (kind, nodes, chart) of each block."""

    shape: Any
    blocks: list[tuple[str, Array, Chart]]

    @classmethod
    def of(cls, points: Array, facets: FacetSet | dict[str, Array], shape) -> ContactFacets:
        """The facets {kind: nodes (m, k)} over `points` (n, 3) [m]."""
        by_kind = facets.blocks if isinstance(facets, FacetSet) else facets
        return cls(shape, [(k, nodes, facet_chart(points, k, nodes, shape)) for k, nodes in by_kind.items()])

    @property
    def chart(self) -> Chart:
        """All facets as one chart."""
        return Chart.joined([chart for _, _, chart in self.blocks])

    def plan(self, name: str, spacing: float | None, nodes: int | None = None) -> GridPlan:
        """Grid for these facets: their nodes if they form one, otherwise lines `spacing` [m] apart (None: the longest
        facet edge, on a free surface the longest extent of a facet in each direction), with at most as many
        functions as there are `nodes`."""
        chart = self.chart
        found = None
        if spacing is None and len(self.blocks) == 1 and self.blocks[0][0] in NODAL_KINDS:
            found = nodal_plan(chart, name)
        if found is None and spacing is None and self.shape.profile().free:
            around, along = (float(np.ptp(v, axis=1).max()) for v in (chart.theta, chart.z))
            found = spaced_plan(chart, self.shape, name, around, nodes, along)
        return found or spaced_plan(chart, self.shape, name, chart.edge if spacing is None else spacing, nodes)

    def loads(self, plan: GridPlan, basis: str, direction: Direction) -> NodeLoads:
        """Loads of the functions of `basis` on the nodes of `plan` on the nodes of all facets."""
        lines = plan.lines(basis)
        parts = [
            node_loads(kind, nodes, chart, self.shape, lines, basis=basis, direction=direction)
            for kind, nodes, chart in self.blocks
        ]
        return merged_loads(parts, len(lines.z))

    def part(self, mask: Array) -> ContactFacets:
        """The facets selected by `mask` (m,), over the blocks in their order."""
        kept, start = [], 0
        for kind, nodes, chart in self.blocks:
            here = mask[start : start + len(nodes)]
            start += len(nodes)
            if here.any():
                kept.append((kind, nodes[here], chart.part(here)))
        return ContactFacets(self.shape, kept)


@dataclass(frozen=True)
class TractionField:
    """Functions of one `kind` ("nodes", "cells") in `directions` on all nodes of `plan`, edge columns of arcs
    included, where the functions are half ones."""

    kind: str
    directions: tuple[str, ...]
    plan: GridPlan
    facets: ContactFacets

    @property
    def columns(self) -> int:
        """Columns of functions."""
        return self.plan.columns

    @property
    def rows(self) -> int:
        """Rows of functions."""
        return len(self.plan.z)

    @property
    def count(self) -> int:
        """Functions of all directions."""
        return len(self.directions) * self.columns * self.rows

    def loads(self, node_count: int) -> Sparse:
        """B (3 n, count) [m^2], csr, user axes: nodal loads [N] of unit coefficients [Pa]."""
        rows, columns, values = [], [], []
        for number, direction in enumerate(self.directions):
            entries = self.facets.loads(self.plan, self.kind, direction)
            function = (entries.column % self.plan.columns) * self.rows + entries.row
            rows.append((3 * entries.node[:, None] + np.arange(3)).ravel())
            columns.append(np.repeat(function + number * self.columns * self.rows, 3))
            values.append(entries.value.ravel())
        data = (np.concatenate(values), (np.concatenate(rows), np.concatenate(columns)))
        return sp.csr_matrix(data, shape=(3 * node_count, self.count))

    def areas(self) -> Array:
        """int psi_i dA over the facets (columns, rows) [m^2]."""
        entries = self.facets.loads(self.plan, self.kind, self.directions[0])
        function = (entries.column % self.plan.columns) * self.rows + entries.row
        area = np.bincount(function, weights=entries.area, minlength=self.columns * self.rows)
        return area.reshape(self.columns, self.rows)

    def gram_theta(self) -> Array:
        """M_theta (columns, columns) [rad] of the whole plan."""
        n, pitch = self.columns, self.plan.pitch
        j = np.arange(n)
        M = np.zeros((n, n))
        if self.kind == "cells":
            M[j, j] = pitch
            if not self.plan.periodic:
                M[0, 0] = M[-1, -1] = 0.5 * pitch
            return M
        M[j, j] = 2.0 / 3.0 * pitch
        if self.plan.periodic:
            np.add.at(M, (j, (j + 1) % n), pitch / 6.0)
            np.add.at(M, ((j + 1) % n, j), pitch / 6.0)
        else:
            M[j[:-1], j[1:]] = M[j[1:], j[:-1]] = pitch / 6.0
            M[0, 0] = M[-1, -1] = pitch / 3.0
        return M

    def gram_z(self) -> Array:
        """M_z (rows, rows) [m^2/rad]."""
        return meridian_gram(self.kind, self.facets.shape, self.plan.z)

    @cached_property
    def whole(self) -> KeptFunctions:
        """All functions."""
        return KeptFunctions(self, 0, self.columns)

    def without_gram(self, values: Array) -> Array:
        """M^-1 `values` (count, m)."""
        return self.whole.without_gram(values)

    def covered(self, tolerance: float) -> Array:
        """Which columns have all their functions inside the facets, by area to `tolerance` (columns,)."""
        expected = np.outer(self.gram_theta().sum(axis=1), self.gram_z().sum(axis=1))
        return np.all(np.abs(self.areas() / expected - 1.0) < tolerance, axis=1)


@dataclass(frozen=True)
class KeptFunctions:
    """Functions of `field` on `columns` neighbouring columns of it, starting at column `first`: those of a reduced
    body."""

    field: TractionField
    first: int
    columns: int

    @cached_property
    def numbers(self) -> Array:
        """Their numbers (kept,) among those of the field, in its order."""
        f = self.field
        numbers = np.arange(f.count).reshape(len(f.directions), f.columns, f.rows)
        return numbers[:, self.first : self.first + self.columns].ravel()

    @cached_property
    def _inverse_grams(self) -> tuple[Array, Array]:
        """Of both Gram matrices; their condition is at most that of a few rows and columns (equal spacing: 3)."""
        part = slice(self.first, self.first + self.columns)
        return np.linalg.inv(self.field.gram_theta()[part, part]), np.linalg.inv(self.field.gram_z())

    def without_gram(self, values: Array) -> Array:
        """M_KK^-1 `values_K` (kept, m) of `values` (count, m) of all functions of the field."""
        around, along = self._inverse_grams
        directions, rows = len(self.field.directions), self.field.rows
        values = values[self.numbers]
        if self.field.kind == "cells":
            scale = np.outer(np.diag(around), np.diag(along)).ravel()
            return np.tile(scale, directions)[:, None] * values
        found = around @ values.reshape(directions, self.columns, -1)
        return (along @ found.reshape(directions, self.columns, rows, -1)).reshape(len(values), -1)
