r"""Consistent nodal loads of the functions of a contact grid: `B psi_i`, `(B psi_i)_a = int N_a psi_i d dA`.

psi are the hats on the nodes of a grid or the cells around them (1 on a cell, 0 elsewhere; `model.contact_grid` says
why not between them), d a direction of the surface: the normal n away from the material, the circumferential
`e_theta`, or the meridian `t_z = (R' e_r + e_a)/sqrt(1 + R'^2)`, with `e_theta x t_z = n`; where the material lies
outside (a bore), e_theta points against the columns. The integral runs over the *chart* of the true
surface, pulled back to the facets: theta and z of a facet are interpolated from its nodes' chart coordinates,
`theta = sum N_a theta_a`, `z = sum N_a z_a`, and

    dA = R(z) sqrt(1 + R'(z)^2) |d(theta, z)/d(xi, eta)| dxi deta,      d taken on the true surface at (theta, z).

So neighbouring facets meet without gap or overlap and the area is that of the true surface; since `sum_a N_a = 1` and
`sum_i psi_i = 1` a constant pressure is applied exactly, and on a structured linear mesh with the nodal grid
`N_a = psi_a`: the loads are then `f_a = sum_i M_ai s_i` with the hat Gram matrix `M`.
The transposed operator gives the coefficients of a displacement, `M^-1 B^T u`: loads and displacements are conjugate.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
import scipy.sparse as sp

from warpffrf.model.mesh.elements import facet_kind
from warpffrf.offline.contact.contact_grid import Chart, GridPlan, full_turn, wrapped
from warpffrf.offline.contact.cut_quadrature import cut_points
from warpffrf.offline.fe.reference import FACET_DEGREE, rule

# Lines of the nodal grid run along the edges of linear facets and through the middle of quadratic ones: these many
# equal pieces of a facet hold no kink. All other grids cut the facets, see `cut_quadrature`.
PIECES = {"quad4": 1, "quad9": 2}
CHUNK = 2000  # facets worked on together: with a grid as fine as the mesh some 100 MB
POINTS = 20_000  # quadrature points worked on together: 9 nodes, 4 hats and 4 values of each are 23 MB
DIRECTIONS = ("normal", "theta", "meridian")
Direction = str | Callable[[np.ndarray, np.ndarray], np.ndarray]  # one of them, or vectors (..., 3) at (theta, z)


@dataclass(frozen=True)
class HatLoads:
    """Entries of B: load vectors `value` (e, 3) [m^2] on mesh `node` (e,) per unit coefficient of function (`column`,
    `row`).

    `area` (e,) [m^2] is the part int N_a psi_i dA of the function's area, so that the sum over nodes is int psi_i dA.
    Columns count from the plan's `theta_start` and on a full turn are not wrapped: take them modulo `columns`.
    """

    node: np.ndarray
    column: np.ndarray
    row: np.ndarray
    value: np.ndarray
    area: np.ndarray


def hat_loads(
    kind: str,
    nodes: np.ndarray,
    chart: Chart,
    shape,
    plan: GridPlan,
    *,
    basis: str = "hats",
    direction: Direction = "normal",
) -> HatLoads:
    """Loads of all functions of `plan` that reach the facets `nodes` (m, k) of `kind`: `basis` "hats" on its nodes or
    "cells" around them, between the lines `GridPlan.lines`, in one of `DIRECTIONS` or in
    vectors of one's own. Rows and edge columns are clipped."""
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
    return shape.around(theta) if direction == "theta" else shape.along(theta, z)


def _loads(kind, nodes, theta, z, shape, plan: GridPlan, basis: str, direction: Direction) -> HatLoads:
    """Loads of some facets, see `hat_loads`."""
    x = (theta - plan.theta_start) / plan.pitch
    if not plan.periodic:  # facets on either side of theta = 0 belong to one arc
        turn, low = full_turn(shape) / plan.pitch, x.min(axis=1, keepdims=True)
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

    # points of one facet under the same functions are summed first: few sums instead of many entries to sort
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


def _summed(node, column, row, value, area, rows: int) -> HatLoads:
    """Sum entries with the same node and function."""
    low = column.min(initial=0)
    width = (column.max(initial=0) - low + 1) * rows
    key = node * width + (column - low) * rows + row
    _, first, inverse = np.unique(key, return_index=True, return_inverse=True)
    summed = [np.bincount(inverse.ravel(), weights=w, minlength=len(first)) for w in (*value.T, area)]
    return HatLoads(node[first], column[first], row[first], np.stack(summed[:3], axis=1), summed[3])


def merged_loads(parts: list[HatLoads], rows: int) -> HatLoads:
    """Loads of several groups of facets on one grid as one, entries of the same node and function summed."""
    if len(parts) == 1:
        return parts[0]
    node, column, row, value, area = (
        np.concatenate([getattr(p, name) for p in parts]) for name in ("node", "column", "row", "value", "area")
    )
    return _summed(node, column, row, value, area, rows)
