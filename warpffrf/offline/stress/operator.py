r"""Stress at the nodes of a finite-element mesh, as a sparse operator on the nodal displacements.

**Quadratic cells.** The displacement gradient at a node is that of polynomials fitted to patches of cells (`patches`).

**Linear cells: nodal averaging.** The displacement gradient is taken at the recovery points of each cell, where it is
most accurate (Barlow 1976, Int. J. Numer. Methods Eng. 10, 243), carried to the cell's nodes by the polynomial through
those points, and averaged over the cells that share a node, each with the same weight:

    g_a = 1/n_a sum_e sum_q E_aq sum_b u_b (x) dN_b/dx (xi_q),     sigma_a = lambda tr(e) 1 + 2 mu e,  e = sym g_a.

Only cells of one material are averaged, so that Hooke's law and the mean commute and a jump between materials stays
one: the unit of averaging, and of patches, is a (node, material) pair, here a *slot*; nodes of quadratic cells have the
value of their patches. The recovery points are (`recovery_points`)

    hex8, hex20, hex27   2 x 2 x 2 Gauss points, trilinear;
    wedge6               centre of the triangle, 2 Gauss points along the axis, linear along it;
    wedge15              3 points of the triangle, 2 along the axis, linear times linear;
    tet4 the centre, constant;     tet10 4 points, linear.

Of a mixed material the trace is not that of e but the projected dilatation (`offline.fe.dilatation`) at the nodes of
the cell: lambda times it is the cell's own pressure, where lambda tr(e) wavers by as much as lambda exceeds mu.

**Traction.** On a surface with unit normal n the traction `t = sigma n` is known, and finite elements miss it: it is
the derivative across the surface that is poor there, not those along it. With e_ab the strains in the surface and
`t_n = n.t`, the normal strain follows from Hooke's law, `e_nn = (t_n - lambda (e_11 + e_22))/(lambda + 2 mu)`, and

    sigma_ab = 2 mu e_ab + (2 mu lambda/(lambda + 2 mu) (e_11 + e_22) + nu/(1 - nu) t_n) delta_ab,

since lambda/(lambda + 2 mu) = nu/(1 - nu). The finite-element stress sigma^h obeys the same with its own traction, so
the strains in the surface drop out of the difference: with the missing traction r = t - sigma^h n

    sigma = sigma^h + Q r,   Q r = n (x) r + r (x) n - r_n n (x) n + nu/(1 - nu) r_n (1 - n (x) n),   r_n = n.r.

Its traction is r, so sigma n = t exactly, and doing it twice changes nothing.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass

import numpy as np
import scipy.sparse as sp

from warpffrf.model.material import Material
from warpffrf.model.mesh.elements import cell_kind
from warpffrf.model.stress_field import from_tensor
from warpffrf.offline.fe.assembly import CHUNK_BYTES, Sparse
from warpffrf.offline.fe.dilatation import is_mixed, projected_dilatation
from warpffrf.offline.fe.materials import Assignment
from warpffrf.offline.fe.reference import gradients_at
from warpffrf.offline.stress.patches import patch_gradients
from warpffrf.offline.stress.recovery_points import recovery_points, to_nodes

Array = np.ndarray


@dataclass(frozen=True)
class Slots:
    """Where nodal stresses are wanted: `node` (K,) and the number of a material of the assignment, `material` (K,)."""

    node: Array
    material: Array

    def __len__(self) -> int:
        return len(self.node)


def nodal_stress(points: Array, cells: Mapping[str, Array], assignment: Assignment, slots: Slots) -> Sparse:
    """Stress at the slots, csr (6 K, 3 n) [Pa/m]: six rows a slot (xx, yy, zz, xy, yz, zx), user axes.

    points (n, 3) [m]; cells {kind: (m, k)}. A slot that no cell of its material touches has zero rows.
    """
    n, count = len(points), len(slots)
    gradient = [sp.csr_matrix((count, n)) for _ in range(3)]
    dilatation = [sp.csr_matrix((count, n)) for _ in range(3)]
    for g, material in enumerate(assignment.materials):
        mine = np.flatnonzero(slots.material == g)
        own = {kind: block[assignment.of_cell[kind] == g] for kind, block in cells.items()}
        curved = {kind: block for kind, block in own.items() if len(block) and cell_kind(kind).degree > 1}
        on_curved = np.isin(slots.node[mine], np.concatenate([np.zeros(0, int), *map(np.ravel, curved.values())]))
        for these, by_patches in ((mine[on_curved], True), (mine[~on_curved], False)):
            if not len(these):
                continue
            nodes, kinds = slots.node[these], curved if by_patches else own
            mean = patch_gradients(points, kinds, nodes) if by_patches else _means(points, kinds, nodes, _at_nodes)
            trace = mean
            if any(is_mixed(kind, material) for kind in kinds):
                trace = _means(points, kinds, nodes, _projected_for(material))
            place = sp.csr_matrix((np.ones(len(these)), (these, np.arange(len(these)))), shape=(count, len(these)))
            gradient = [total + place @ part for total, part in zip(gradient, mean, strict=True)]
            dilatation = [total + place @ part for total, part in zip(dilatation, trace, strict=True)]
    lame = np.array([m.lame for m in assignment.materials])[slots.material]
    return _hooke([sp.csr_matrix(g) for g in gradient], [sp.csr_matrix(d) for d in dilatation], lame)


CellValues = Callable[[Array, str], Array]  # node coordinates (e, k, 3) of cells of a kind to (e, k, k, 3) at nodes


def _at_nodes(x: Array, kind: str) -> Array:
    """Derivatives at the nodes of cells by the polynomial through the recovery points [1/m]."""
    slopes, _ = gradients_at(x, recovery_points(kind)[1])
    return np.einsum("aq,eqbi->eabi", to_nodes(kind), slopes, optimize=True)


def _projected_for(material: Material) -> CellValues:
    """The dilatation at the nodes of cells: projected where these are mixed."""

    def values(x: Array, kind: str) -> Array:
        if not is_mixed(kind, material):
            return _at_nodes(x, kind)
        return projected_dilatation(x, kind, np.eye(x.shape[1]))

    return values


def _means(points: Array, cells: Mapping[str, Array], wanted: Array, values: CellValues) -> list[Sparse]:
    """The mean of `values` over the cells at each of the nodes `wanted` (K,), along x, y, z: three csr (K, n)."""
    n, count = len(points), len(wanted)
    total, shared = [sp.csr_matrix((count, n)) for _ in range(3)], np.zeros(count)
    place = np.full(n, -1)
    place[wanted] = np.arange(count)
    for kind, block in cells.items():
        here = block[np.any(place[block] >= 0, axis=1)]
        chunk = max(1, CHUNK_BYTES // (8 * 6 * block.shape[1] ** 2))
        for start in range(0, len(here), chunk):
            part = here[start : start + chunk]
            found = values(points[part], kind)
            cell, a = np.nonzero(place[part] >= 0)
            row = place[part][cell, a]
            shared += np.bincount(row, minlength=count)
            rows, columns = np.repeat(row, part.shape[1]), part[cell].ravel()
            for i in range(3):
                data = found[cell, a, :, i].ravel()
                total[i] = total[i] + sp.csr_matrix((data, (rows, columns)), shape=(count, n))
    mean = sp.diags(1.0 / np.maximum(shared, 1.0))
    return [sp.csr_matrix(mean @ part) for part in total]


def _hooke(gradient: list[Sparse], dilatation: list[Sparse], lame: Array) -> Sparse:
    """csr (6 K, 3 n) from the derivatives along x, y, z, each (K, n), the dilatation of displacements along x, y, z,
    each (K, n), and (lambda, mu) (K, 2)."""
    count, n = gradient[0].shape
    lam, mu = sp.diags(lame[:, 0]), sp.diags(lame[:, 1])
    zero = sp.csr_matrix((count, n))
    blocks = []
    for i in range(3):
        blocks.append([lam @ dilatation[j] + (2.0 * mu @ gradient[i] if i == j else zero) for j in range(3)])
    for i, j in ((0, 1), (1, 2), (2, 0)):
        row = [zero, zero, zero]
        row[i], row[j] = mu @ gradient[j], mu @ gradient[i]
        blocks.append(row)
    stacked = sp.csr_matrix(sp.bmat(blocks, format="csr"))  # component-major: to node- and point-major
    rows = np.arange(6 * count).reshape(6, count).T.ravel()
    columns = np.arange(3 * n).reshape(3, n).T.ravel()
    return sp.csr_matrix(stacked[rows][:, columns])


def traction_operator(normal: Array) -> Array:
    """N (p, 3, 6): stress (6,) to its traction on a plane with unit `normal` (p, 3)."""
    unit = np.zeros((6, 3, 3))
    for c, (i, j) in enumerate(((0, 0), (1, 1), (2, 2), (0, 1), (1, 2), (2, 0))):
        unit[c, i, j] = unit[c, j, i] = 1.0
    return np.einsum("cij,pj->pic", unit, normal)


def traction_correction(normal: Array, poisson: Array) -> Array:
    """Q (p, 6, 3): missing traction to the stress that brings it in (module docstring); `poisson` ratio (p,)."""
    one = np.eye(3)
    n = normal[:, :, None] * normal[:, None, :]
    side = (poisson / (1.0 - poisson))[:, None, None] * (one - n)
    first = np.einsum("pi,jr->pijr", normal, one)
    tensor = first + first.swapaxes(1, 2) + np.einsum("pij,pr->pijr", side - n, normal)
    return np.moveaxis(from_tensor(np.moveaxis(tensor, 3, 1)), 1, 2)


def point_blocks(blocks: Array) -> Sparse:
    """Block-diagonal csr of `blocks` (p, a, b): one block a point."""
    p, a, b = blocks.shape
    return sp.csr_matrix(sp.bsr_matrix((blocks, np.arange(p), np.arange(p + 1)), shape=(p * a, p * b)))
