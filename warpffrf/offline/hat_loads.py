r"""Consistent nodal loads of the hats: `B psi_i`, `(B psi_i)_a = int N_a psi_i n dA`.

The integral runs over the *chart* of the true surface, pulled back to the facets: theta and z of a facet are
interpolated from its nodes' chart coordinates, `theta = sum N_a theta_a`, `z = sum N_a z_a`, and

    dA = R(z) sqrt(1 + R'(z)^2) |d(theta, z)/d(xi, eta)| dxi deta,      n the normal of the true surface at (theta, z).

So neighbouring facets meet without gap or overlap and the area is that of the true surface; since `sum_a N_a = 1` and
`sum_i psi_i = 1` a constant pressure is applied exactly, and on a structured linear mesh with the nodal grid
`N_a = psi_a`: the loads are then `f_a = sum_i M_ai s_i` with the hat Gram matrix `M`.
The transposed operator gives the coefficients of a displacement, `M^-1 B^T u`: loads and displacements are conjugate.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from warpffrf.offline.contact_grid import Chart, GridPlan
from warpffrf.offline.reference import FACET_DEGREE, rule

# Pieces of a facet edge for the quadrature: hats of the nodal grid have their kinks on the facet's own node lines,
# others anywhere; with 4 pieces a hat and degree 5 a kinked integrand is integrated to about 1e-3 of the hat's own
# load.
PIECES = {"quad4": 1, "quad9": 2}
PIECES_PER_HAT = 4
MOST_PIECES = 16  # a grid that would need more is far finer than the mesh and is refused afterwards


@dataclass(frozen=True)
class HatLoads:
    """Entries of B: load vectors `value` (e, 3) [m^2] on mesh `node` (e,) per unit coefficient of hat (`column`,
    `row`).

    `area` (e,) [m^2] is the part int N_a psi_i dA of the hat's area, so that the sum over nodes is int psi_i dA.
    Columns count from the plan's `theta_start` and on a full turn are not wrapped: take them modulo `columns`.
    """

    node: np.ndarray
    column: np.ndarray
    row: np.ndarray
    value: np.ndarray
    area: np.ndarray


def hat_loads(kind: str, nodes: np.ndarray, chart: Chart, shape, plan: GridPlan) -> HatLoads:
    """Loads of all hats that reach the facets `nodes` (m, k) of `kind`; rows and edge columns are clipped to the
    grid."""
    if plan.nodal and kind in PIECES:
        pieces = PIECES[kind]
    else:
        around = float(np.max(np.ptp(chart.theta, axis=1))) / plan.pitch
        along = float(np.max(np.ptp(chart.z, axis=1)) / np.min(np.diff(plan.z)))
        pieces = int(np.clip(np.ceil(PIECES_PER_HAT * max(around, along) - 1e-6), PIECES_PER_HAT, MOST_PIECES))
    r = rule(kind, FACET_DEGREE[kind], pieces)
    theta, z = chart.theta @ r.values.T, chart.z @ r.values.T  # (m, q)
    dtheta = np.einsum("mk,qkd->mqd", chart.theta, r.gradients)
    dz = np.einsum("mk,qkd->mqd", chart.z, r.gradients)
    stretch = np.abs(dtheta[..., 0] * dz[..., 1] - dtheta[..., 1] * dz[..., 0])
    area = r.weights * stretch * shape.radius_at(z) * np.sqrt(1.0 + shape.slope_at(z) ** 2)
    load = shape.normal(theta, z) * area[..., None]  # (m, q, 3)

    x = (theta - plan.theta_start) / plan.pitch
    if not plan.periodic:
        turn = 2.0 * np.pi / plan.pitch
        x = (x + 0.5) % turn - 0.5
    j = np.floor(x).astype(np.int64)
    if not plan.periodic:
        j = np.clip(j, 0, plan.columns - 2)
    k = np.clip(np.searchsorted(plan.z, z, side="right") - 1, 0, len(plan.z) - 2)
    s, t = x - j, (z - plan.z[k]) / (plan.z[k + 1] - plan.z[k])
    hats = np.stack([(1 - s) * (1 - t), (1 - s) * t, s * (1 - t), s * t], axis=2)  # (m, q, 4)
    column, row = np.stack([j, j, j + 1, j + 1], axis=2), np.stack([k, k + 1, k, k + 1], axis=2)
    share = r.values[None, :, :, None] * hats[:, :, None, :]  # N_a psi_i (m, q, k, 4)
    value = share[..., None] * load[:, :, None, None, :]
    part = share * area[:, :, None, None]
    shape_full = share.shape
    node = np.broadcast_to(nodes[:, None, :, None], shape_full)
    column, row = (np.broadcast_to(v[:, :, None, :], shape_full) for v in (column, row))
    return _merged(node.ravel(), column.ravel(), row.ravel(), value.reshape(-1, 3), part.ravel(), len(plan.z))


def _merged(node, column, row, value, area, rows: int) -> HatLoads:
    """Sum entries with the same node and hat."""
    low = column.min()
    width = (column.max() - low + 1) * rows
    key = node * width + (column - low) * rows + row
    _, first, inverse = np.unique(key, return_index=True, return_inverse=True)
    summed = [np.bincount(inverse, weights=w, minlength=len(first)) for w in (*value.T, area)]
    return HatLoads(node[first], column[first], row[first], np.stack(summed[:3], axis=1), summed[3])
