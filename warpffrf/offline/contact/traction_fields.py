r"""Traction fields on the grid of a contact surface: their loads on the mesh and their Gram matrix, for both paths.

A field is a basis (hats on the nodes of one `GridPlan`, or cells around them) in one direction or in several.
Coefficients s of a traction load the mesh by `B s`, and `M^-1 B^T u` are the coefficients of a displacement u: its L2
projection. Functions are numbered by direction, column, row.

Where a reduced body has only some of the functions, K, the projection is that on their span, with the Gram matrix of
these alone,

    a = M_KK^-1 B_K^T u,        so that        sum_j (M_KK)_ij a_j = B_i^T u = int psi_i u dA for every i in K:

weak displacements, all that contact laws use, are exact up to the last kept column. Coefficients of the projection on
*all* functions, of which those outside K are forgotten, would lose what the forgotten ones add to it: of a constant
displacement a sixth beside each end, on one lone column a third.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property

import numpy as np
import scipy.sparse as sp

from warpffrf.model.mesh.facets import FacetSet
from warpffrf.model.reduced.contact_grid import meridian_gram
from warpffrf.offline.contact.contact_grid import Chart, GridPlan, facet_chart, nodal_plan, spaced_plan
from warpffrf.offline.contact.hat_loads import Direction, HatLoads, hat_loads, merged_loads
from warpffrf.offline.fe.assembly import Sparse

Array = np.ndarray
NORMAL = ("normal",)
TANGENTIAL = ("theta", "meridian")
NODAL_KINDS = ("quad4", "quad9")  # facets whose nodes can be a full tensor product


@dataclass(frozen=True)
class ContactFacets:
    """Facets of a contact surface in the chart of its `shape`: (kind, nodes, chart) of each block."""

    shape: object
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
        """Grid for these facets: their nodes where they form one, else lines `spacing` [m] apart (None: the longest
        facet edge), on at most as many functions as there are `nodes`."""
        chart = self.chart
        found = None
        if spacing is None and len(self.blocks) == 1 and self.blocks[0][0] in NODAL_KINDS:
            found = nodal_plan(chart, name)
        return found or spaced_plan(chart, self.shape, name, chart.edge if spacing is None else spacing, nodes)

    def loads(self, plan: GridPlan, basis: str, direction: Direction) -> HatLoads:
        """Loads of the functions of `basis` on the nodes of `plan` on the nodes of all facets."""
        lines = plan.lines(basis)
        parts = [
            hat_loads(kind, nodes, chart, self.shape, lines, basis=basis, direction=direction)
            for kind, nodes, chart in self.blocks
        ]
        return merged_loads(parts, len(lines.z))

    def part(self, mask: Array) -> ContactFacets:
        """The facets that `mask` (m,), over the blocks in their order, keeps."""
        kept, start = [], 0
        for kind, nodes, chart in self.blocks:
            here = mask[start : start + len(nodes)]
            start += len(nodes)
            if here.any():
                kept.append((kind, nodes[here], chart.part(here)))
        return ContactFacets(self.shape, kept)


@dataclass(frozen=True)
class TractionField:
    """Functions of one `kind` ("hats", "cells") in `directions` on all nodes of `plan`, edge columns of arcs
    included, where hats and cells are half ones."""

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
    """Functions of `field` on `columns` neighbouring columns of it, from its column `first` on: those that a reduced
    body has."""

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
        """Of both Gram matrices; their condition is at most a few rows' and columns' worth (hats of equal size: 3)."""
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
