r"""Stress at the nodes of a finite-element mesh, as a sparse operator on the nodal displacements.

**Nodal averaging.** The displacement gradient is taken at the recovery points of each cell, where it is most accurate
(Barlow 1976, Int. J. Numer. Methods Eng. 10, 243), carried to the cell's nodes by the polynomial through those points,
and averaged over the cells that share a node, each with the same weight:

    g_a = 1/n_a sum_e sum_q E_aq sum_b u_b (x) dN_b/dx (xi_q),     sigma_a = lambda tr(e) 1 + 2 mu e,  e = sym g_a.

Only cells of one material are averaged, so that Hooke's law and the mean commute and a jump between materials stays
one: the unit of averaging is a (node, material) pair, here a *slot*. The recovery points are

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

from collections.abc import Mapping
from dataclasses import dataclass
from functools import cache

import numpy as np
import scipy.sparse as sp

from warpffrf.model.mesh.elements import cell_kind
from warpffrf.model.mesh.elements.domains import CONSTANT, LINEAR, powers_up_to
from warpffrf.model.mesh.elements.kinds import monomials
from warpffrf.model.stress_field import from_tensor
from warpffrf.offline.fe.assembly import CHUNK_BYTES, Sparse
from warpffrf.offline.fe.dilatation import is_mixed, projected_dilatation
from warpffrf.offline.fe.materials import Assignment

Array = np.ndarray
_GAUSS = 1.0 / np.sqrt(3.0)  # two-point Gauss rule on [-1, 1]
_TET = (5.0 - np.sqrt(5.0)) / 20.0  # four-point rule of degree 2 on the unit tetrahedron


def _line_by(flat: list[tuple[float, float]]) -> Array:
    return np.array([(a, b, z) for z in (-_GAUSS, _GAUSS) for a, b in flat])


_CUBE = _line_by([(x, y) for x in (-_GAUSS, _GAUSS) for y in (-_GAUSS, _GAUSS)])
_TRIANGLE_BY_LINE = np.array([(*flat, z) for z in (0, 1) for flat in ((0, 0), (1, 0), (0, 1))])
_SIXTHS = [(1.0 / 6.0, 1.0 / 6.0), (2.0 / 3.0, 1.0 / 6.0), (1.0 / 6.0, 2.0 / 3.0)]
# recovery points (q, 3) of each kind, and the exponents (q, 3) of the polynomial through them
RECOVERY = {
    "hex8": (_CUBE, powers_up_to(1, 1, 1)),
    "hex20": (_CUBE, powers_up_to(1, 1, 1)),
    "hex27": (_CUBE, powers_up_to(1, 1, 1)),
    "wedge6": (_line_by([(1.0 / 3.0, 1.0 / 3.0)]), np.array([(0, 0, 0), (0, 0, 1)])),
    "wedge15": (_line_by(_SIXTHS), _TRIANGLE_BY_LINE),
    "tet4": (np.full((1, 3), 0.25), CONSTANT),
    "tet10": (_TET + (1.0 - 4.0 * _TET) * LINEAR, LINEAR),
}


@cache
def recovery(kind: str) -> tuple[Array, Array]:
    """Reference gradients (q, k, 3) at the recovery points of `kind`, and E (k, q), their values to the nodes."""
    points, powers = RECOVERY[kind]
    cell = cell_kind(kind)
    through = np.linalg.inv(monomials(points, powers))
    return cell.shape(points)[1], monomials(cell.nodes, powers) @ through


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
    excess = [sp.csr_matrix((count, n)) for _ in range(3)]  # of the projected dilatation over the trace of the strain
    shared = np.zeros(count)
    for g, material in enumerate(assignment.materials):
        slot_of = np.full(n, -1)
        mine = slots.material == g
        slot_of[slots.node[mine]] = np.flatnonzero(mine)
        for kind, block in cells.items():
            dN, E = recovery(kind)
            touching = (assignment.of_cell[kind] == g) & np.any(slot_of[block] >= 0, axis=1)
            here = block[touching]
            chunk = max(1, CHUNK_BYTES // (8 * 6 * block.shape[1] ** 2))
            for start in range(0, len(here), chunk):
                part = here[start : start + chunk]
                J = np.einsum("eai,qaj->eqij", points[part], dN)
                slopes = np.einsum("qbj,eqji->eqbi", dN, np.linalg.inv(J))
                at_nodes = np.einsum("aq,eqbi->eabi", E, slopes, optimize=True)
                slot = slot_of[part]
                cell, a = np.nonzero(slot >= 0)
                shared += np.bincount(slot[cell, a], minlength=count)
                rows = np.repeat(slot[cell, a], part.shape[1])
                columns = part[cell].ravel()
                parts = [(gradient, at_nodes)]
                if is_mixed(kind, material):
                    parts.append((excess, projected_dilatation(points[part], kind, np.eye(part.shape[1])) - at_nodes))
                for total, values in parts:
                    for i in range(3):
                        data = values[cell, a, :, i].ravel()
                        total[i] = total[i] + sp.csr_matrix((data, (rows, columns)), shape=(count, n))
    mean = sp.diags(1.0 / np.maximum(shared, 1.0))
    lame = np.array([m.lame for m in assignment.materials])[slots.material]
    gradient = [sp.csr_matrix(mean @ g) for g in gradient]
    return _hooke(gradient, [sp.csr_matrix(g + mean @ e) for g, e in zip(gradient, excess, strict=True)], lame)


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
