r"""Stress of a finite-element mesh at nodes and points, as a sparse operator on the nodal displacements.

**Patches.** The displacement gradient of quadratic cells and of hex8 is that of polynomials fitted to patches of cells,
at nodes and between them (`patches`).

**Nodal averaging** of wedge6 and tet4. The displacement gradient is taken at the recovery points of each cell, where it
is most accurate (Barlow 1976, Int. J. Numer. Methods Eng. 10, 243), extrapolated to the cell's nodes by the polynomial
through those points, and averaged over the cells that share a node, each with the same weight:

    g_a = 1/n_a sum_e sum_q E_aq sum_b u_b (x) dN_b/dx (xi_q),     sigma_a = lambda tr(e) 1 + 2 mu e,  e = sym g_a.

The recovery points are (`recovery_points`) of wedge6 the centre of the triangle at 2 Gauss points along the axis,
linear along it, of tet4 the centre, constant. Between nodes the nodal stresses are interpolated.

Only cells of one material form a patch or are averaged, so that Hooke's law and the mean commute and a jump between
materials is preserved: the unit is a (node, material) pair, called *slot* here. A slot shared by kinds of cells has the
value of quadratic cells, or that of hex8 if there are none.

For a mixed material the trace is not that of e but the projected dilatation (`offline.fe.dilatation`) at the nodes of
the cell: lambda times it is the cell's own pressure, whereas lambda tr(e) oscillates in proportion to lambda/mu.

**Traction.** On a surface with unit normal n the traction `t = sigma n` is known, but finite elements do not satisfy it
exactly: the derivative across the surface is inaccurate, not those along it. With e_ab the strains in the surface and
`t_n = n.t`, the normal strain follows from Hooke's law, `e_nn = (t_n - lambda (e_11 + e_22))/(lambda + 2 mu)`, and

    sigma_ab = 2 mu e_ab + (2 mu lambda/(lambda + 2 mu) (e_11 + e_22) + nu/(1 - nu) t_n) delta_ab,

since lambda/(lambda + 2 mu) = nu/(1 - nu). The finite-element stress sigma^h obeys the same with its own traction, so
the strains in the surface drop out of the difference: with the missing traction r = t - sigma^h n

    sigma = sigma^h + Q r,   Q r = n (x) r + r (x) n - r_n n (x) n + nu/(1 - nu) r_n (1 - n (x) n),   r_n = n.r.

Its traction is r, so sigma n = t exactly, and applying it twice changes nothing.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass

import numpy as np
import scipy.sparse as sp

from warpffrf.model.material import Orthotropic, SolidMaterial
from warpffrf.model.mesh.elements import cell_kind
from warpffrf.model.reduced.stress_field import from_tensor
from warpffrf.offline.fe import CHUNK_BYTES, Assignment, Sparse, gradients_at, is_mixed, projected_dilatation
from warpffrf.offline.stress.patches import cell_places, node_places, patch_gradients, patch_groups
from warpffrf.offline.stress.recovery_points import recovery_points, to_nodes

Array = np.ndarray


@dataclass(frozen=True)
class Slots:
    """Points of nodal stresses: `node` (K,) and the number of a material of the assignment, `material` (K,)."""

    node: Array
    material: Array

    def __len__(self) -> int:
        return len(self.node)


@dataclass(frozen=True)
class InCells:
    """Points in cells of one kind and one material: `nodes` (K, k) of each one's cell, and the position `xi` (K, 3)."""

    kind: str
    material: int
    nodes: Array
    xi: Array

    def __len__(self) -> int:
        return len(self.nodes)


@dataclass(frozen=True)
class _Derivatives:
    """Of a nodal field along x, y, z, and the dilatation of displacements along them: three csr (K, n) each [1/m]."""

    gradient: list[Sparse]
    dilatation: list[Sparse]

    def placed(self, rows: Array, count: int) -> _Derivatives:
        """As `rows` (K,) of `count`, the others zero."""
        place = sp.csr_matrix((np.ones(len(rows)), (rows, np.arange(len(rows)))), shape=(count, len(rows)))
        return _Derivatives([place @ g for g in self.gradient], [place @ d for d in self.dilatation])


def nodal_stress(points: Array, cells: Mapping[str, Array], assignment: Assignment, slots: Slots) -> Sparse:
    """Stress at the (node, material) pairs, csr (6 K, 3 n) [Pa/m]: six rows each (xx, yy, zz, xy, yz, zx), user axes.

    points (n, 3) [m]; cells {kind: (m, k)}. A pair without a cell of its material has zero rows.
    """
    parts = []
    for g, material in enumerate(assignment.materials):
        left = np.flatnonzero(slots.material == g)
        own = _of_material(cells, assignment, g)
        for group in patch_groups(own):
            on = np.isin(slots.node[left], np.concatenate([block.ravel() for block in group.values()]))
            if on.any():
                nodes = slots.node[left[on]]
                gradient = patch_gradients(points, group, node_places(points, group, nodes))
                found = _Derivatives(gradient, _dilatation(points, group, material, nodes) or gradient)
                parts.append(found.placed(left[on], len(slots)))
            left = left[~on]
        if len(left):
            gradient = _means(points, own, slots.node[left], _at_nodes)
            parts.append(_Derivatives(gradient, gradient).placed(left, len(slots)))
    return _hooke(parts, assignment.materials, slots.material)


def point_stress(points: Array, cells: Mapping[str, Array], assignment: Assignment, where: InCells) -> Sparse:
    """Stress at points in cells of a kind that has patches, csr (6 K, 3 n) as `nodal_stress`."""
    material = assignment.materials[where.material]
    own = _of_material(cells, assignment, where.material)
    (group,) = (group for group in patch_groups(own) if where.kind in group)
    gradient = patch_gradients(points, group, cell_places(points, where.kind, where.nodes, where.xi))
    nodes, column = np.unique(where.nodes, return_inverse=True)
    dilatation = gradient
    if (at_nodes := _dilatation(points, group, material, nodes)) is not None:
        N = cell_kind(where.kind).shape(where.xi)[0]
        rows = np.repeat(np.arange(len(where)), N.shape[1])
        between = sp.csr_matrix((N.ravel(), (rows, column.ravel())), shape=(len(where), len(nodes)))
        dilatation = [sp.csr_matrix(between @ part) for part in at_nodes]
    numbers = np.full(len(where), where.material)
    return _hooke([_Derivatives(gradient, dilatation)], assignment.materials, numbers)


def _of_material(cells: Mapping[str, Array], assignment: Assignment, material: int) -> dict[str, Array]:
    own = {kind: block[assignment.of_cell[kind] == material] for kind, block in cells.items()}
    return {kind: block for kind, block in own.items() if len(block)}


def _dilatation(
    points: Array, cells: Mapping[str, Array], material: SolidMaterial, nodes: Array
) -> list[Sparse] | None:
    """The dilatation at `nodes` (K,) if it is not that of the gradient, i.e. if a cell is mixed."""
    if not any(is_mixed(kind, material) for kind in cells):
        return None
    return _means(points, cells, nodes, _projected_for(material))


CellValues = Callable[[Array, str], Array]  # node coordinates (e, k, 3) of cells of a kind to (e, k, k, 3) at nodes


def _at_nodes(x: Array, kind: str) -> Array:
    """Derivatives at the nodes of cells by the polynomial through the recovery points [1/m]."""
    slopes, _ = gradients_at(x, recovery_points(kind)[1])
    return np.einsum("aq,eqbi->eabi", to_nodes(kind), slopes, optimize=True)


def _projected_for(material: SolidMaterial) -> CellValues:
    """The dilatation at the nodes of cells: projected in mixed cells."""

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


def _hooke(parts: list[_Derivatives], materials: Sequence[SolidMaterial], material: Array) -> Sparse:
    """csr (6 K, 3 n) from the sum of `parts`, each row of its `material` (K,)."""
    gradient: list[Sparse] = [sp.csr_matrix(sum(part.gradient[i] for part in parts)) for i in range(3)]
    dilatation: list[Sparse] = [sp.csr_matrix(sum(part.dilatation[i] for part in parts)) for i in range(3)]
    count, n = gradient[0].shape
    lame = np.array([(0.0, 0.0) if isinstance(m, Orthotropic) else m.lame for m in materials])[material]
    lam, mu = sp.diags(lame[:, 0]), sp.diags(lame[:, 1])
    zero = sp.csr_matrix((count, n))
    blocks = []
    for i in range(3):
        blocks.append([lam @ dilatation[j] + (2.0 * mu @ gradient[i] if i == j else zero) for j in range(3)])
    for i, j in ((0, 1), (1, 2), (2, 0)):
        row = [zero, zero, zero]
        row[i], row[j] = mu @ gradient[j], mu @ gradient[i]
        blocks.append(row)
    if any(isinstance(m, Orthotropic) for m in materials):
        c = np.array([m.stiffness if isinstance(m, Orthotropic) else np.zeros((3, 3, 3, 3)) for m in materials])
        for row, (i, j) in zip(blocks, ((0, 0), (1, 1), (2, 2), (0, 1), (1, 2), (2, 0)), strict=True):
            for k in range(3):
                row[k] = row[k] + sum(sp.diags(c[material, i, j, k, m]) @ gradient[m] for m in range(3))
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
    """Q (p, 6, 3): missing traction to the stress that restores it (module docstring); `poisson` ratio (p,)."""
    one = np.eye(3)
    n = normal[:, :, None] * normal[:, None, :]
    side = (poisson / (1.0 - poisson))[:, None, None] * (one - n)
    first = np.einsum("pi,jr->pijr", normal, one)
    tensor = first + first.swapaxes(1, 2) + np.einsum("pij,pr->pijr", side - n, normal)
    return np.moveaxis(from_tensor(np.moveaxis(tensor, 3, 1)), 1, 2)


def point_blocks(blocks: Array) -> Sparse:
    """Block-diagonal csr of `blocks` (p, a, b): one block per point."""
    p, a, b = blocks.shape
    return sp.csr_matrix(sp.bsr_matrix((blocks, np.arange(p), np.arange(p + 1)), shape=(p * a, p * b)))
