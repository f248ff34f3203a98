r"""Gears in mesh by full finite elements in the plane: the whole flanks in contact, wherever they touch.

Without lateral contraction, nu = 0, gears that are loaded evenly across their width are in a plane state, and one
section of them is exact; with other ratios it is plane strain. Quadratic (9-node) cells of the end face of `mesh.gear`,
no modes, no half-space, no line of action; K is condensed exactly onto the nodes of the flanks.

**Contact.** Pressures p of linear functions psi_i on the corner nodes of the flanks of gear 1, along its normals n, act
on both gears. A point of flank 1 faces flank 2 in the direction n, at the distance g; x is its place from the axis of
gear 1, A the condensed compliance, delta/r_b1 the rotation of gear 1 from where undeformed flanks without relief touch:

    int psi_i (g + A p - c delta) >= 0    _|_    p >= 0,      c = (n x x)/r_b1,      sum of int p c = T_1/r_b1,

by the active set of `contact`.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from scipy.sparse import coo_array, csr_array
from scipy.sparse.linalg import splu

from references.finite_elements.contact import active_set
from warpffrf.model.gears import Gear, GearPair
from warpffrf.model.material import Material
from warpffrf.model.mesh import gear as gear_mesh

Array = np.ndarray
NODES = np.array([(-1, -1), (1, -1), (1, 1), (-1, 1), (0, -1), (1, 0), (0, 1), (-1, 0), (0, 0)], dtype=float)
ENDS, GROWTH = 0.5e-3, 1.3  # m: of a flank, where tips touch
SLICE = 1e-3  # m: width of the mesh, of which one end face is used
NEAR = 60e-6  # m: flanks farther apart do not meet
POINTS = 6  # of Gauss's rule on an edge of flank 1; the edges of flank 2 end anywhere between them
BLOCK = 64  # right-hand sides solved at once


@dataclass(frozen=True, eq=False)
class Meshed:
    """Rotation of gear 1 under load times its base radius [m], shares (n,) of the pairs of teeth in the torque, and the
    forces (nodes, 2) [N/m] on the flanks of each gear."""

    approach: float
    shares: Array
    forces: tuple[Array, ...]


class Flanks:
    """A segment of a `gear` of one metre of width, held at its bore: the right flanks of the teeth `carrying`.

    cell, fine: lengths [m] of the cells along the involute and at its ends, where tips touch; points: teeth -> places
    (n, 2) [m] of the nodes of a flank, root to tip, corner, middle, ..., corner; compliance (n, 2, n, 2) [m2/N] of all
    flanks, one after the other.
    """

    def __init__(
        self, gear: Gear, material: Material, rim: float, teeth: int | None, carrying: Sequence[int], *, cell: float,
        fine: float, layers: int = 6,
    ) -> None:  # fmt: skip
        length = (gear.tip_form_rho**2 - gear.root_form_rho**2) / gear.base_diameter
        lines = _graded(length, cell, fine)
        mesh = gear_mesh(gear, SLICE, rim_radius=rim, teeth=teeth, along=lines, across=4, layers=layers, axial=1)
        cells = mesh.facet_sets["ends"].single[1]
        face = mesh.points[:, 1] < -0.49 * SLICE
        cells = cells[face[cells].all(axis=1)]
        x = mesh.points[:, [0, 2]] * [1.0, -1.0]
        held = np.intersect1d(mesh.facet_sets["bore"].node_set, cells)
        free = np.setdiff1d(np.unique(cells), held)
        dofs = _dofs(free)
        K = _stiffness(x, cells, material)[dofs][:, dofs].tocsc()
        factor = splu(K, permc_spec="MMD_AT_PLUS_A", diag_pivot_thresh=0.0, options={"SymmetricMode": True})
        self.x, self.dofs, self.factor, self.material = x, dofs, factor, material
        self.cells = cells
        self.roots = np.intersect1d(mesh.facet_sets["roots"].node_set, cells)
        order = {}
        for tooth in carrying:
            nodes = np.intersect1d(mesh.facet_sets[f"flank_right_{tooth}"].node_set, cells)
            order[tooth] = nodes[np.argsort(np.hypot(*x[nodes].T))]
        self.gear = gear
        self.points = {tooth: x[nodes] for tooth, nodes in order.items()}
        nodes = np.concatenate(list(order.values()))
        self.rows = rows = np.searchsorted(dofs, _dofs(nodes))
        C = np.empty((len(rows), len(rows)))
        for start in range(0, len(rows), BLOCK):
            unit = np.zeros((len(dofs), len(rows[start : start + BLOCK])))
            unit[rows[start : start + BLOCK], np.arange(unit.shape[1])] = 1.0
            C[:, start : start + BLOCK] = factor.solve(unit)[rows]
        self.compliance = (0.5 * (C + C.T)).reshape(len(nodes), 2, len(nodes), 2)

    def first(self, tooth: int) -> int:
        """Number of the first node of a flank in `compliance`."""
        numbers = list(self.points)
        return sum(len(self.points[k]) for k in numbers[: numbers.index(tooth)])

    def root_stress(self, forces: Array) -> tuple[float, Array]:
        """Largest tension [Pa] in fillets and root lands under the `forces` (nodes, 2) [N/m], and where (2,) [m]; the
        mean of the cells at a node."""
        load, u = np.zeros(len(self.dofs)), np.zeros(2 * len(self.x))
        load[self.rows] = forces.ravel()
        u[self.dofs] = self.factor.solve(load)
        total, count = np.zeros((len(self.x), 3)), np.zeros(len(self.x))
        for node, place in enumerate(NODES):
            B, _ = _strains(self.x, self.cells, place)
            stress = np.einsum("esd,ed->es", B, u[_dofs(self.cells)]) @ _elasticity(self.material)
            np.add.at(total, self.cells[:, node], stress)
            np.add.at(count, self.cells[:, node], 1.0)
        xx, yy, xy = (total[self.roots] / count[self.roots, None]).T
        tension = 0.5 * (xx + yy) + np.hypot(0.5 * (xx - yy), xy)
        return float(tension.max()), self.x[self.roots[np.argmax(tension)]]


def meshed(
    pair: GearPair, flanks: tuple[Flanks, Flanks], width: float, angles: tuple[float, float],
    teeth: Sequence[tuple[int, int]], load: float,
) -> Meshed:  # fmt: skip
    """Gears rotated by `angles` [rad], counter-clockwise from where tooth 1 lies on +x, the axis of gear 2 at +x; pairs
    of `teeth` may meet under the `load` [N], the torque on gear 1 over its base radius."""
    loads: list[list[Array]] = [[], []]  # of each gear, (functions, nodes, 2)
    gaps, levers, pair_of = [], [], []
    for number, (k, t) in enumerate(teeth):
        own = _rotated(flanks[0].points[k], angles[0])
        other = _rotated(flanks[1].points[t], angles[1]) + [pair.center_distance, 0.0]
        place, normal, psi, N = _quadrature(own)
        gap, N_other = _facing(place, normal, other)
        near = np.abs(gap) < NEAR
        psi = psi[:, (psi[~near] == 0.0).all(axis=0)]  # their whole support faces the other flank
        lever = -(place[:, 0] * normal[:, 1] - place[:, 1] * normal[:, 0]) / pair.gear_1.base_radius
        gaps.append(psi.T @ np.where(near, gap, 0.0))
        levers.append(psi.T @ lever)
        pair_of.append(np.full(psi.shape[1], number))
        for i, (tooth, shape) in enumerate(((k, N), (t, N_other))):
            force = np.einsum("qj,qn,qc->jnc", psi, shape, (-1.0, 1.0)[i] * _rotated(normal, -angles[i]))
            start, part = flanks[i].first(tooth), np.zeros((len(force), flanks[i].compliance.shape[0], 2))
            part[:, start : start + force.shape[1]] = force
            loads[i].append(part)
    whole = [np.concatenate(part) for part in loads]
    gap, lever, number = (np.concatenate(part) for part in (gaps, levers, pair_of))
    A = np.zeros((len(gap), len(gap)))
    for gear, f in zip(flanks, (part.reshape(len(gap), -1) for part in whole), strict=True):
        A += f @ gear.compliance.reshape(f.shape[1], -1) @ f.T
    pressure, _, approach, _ = active_set(A, gap, lever, np.eye(len(gap)), load / width, ())
    torque = np.bincount(number, lever * pressure, minlength=len(teeth))
    return Meshed(approach, torque / torque.sum(), tuple(np.tensordot(pressure, part, 1) for part in whole))


def _graded(length: float, cell: float, fine: float) -> Array:
    """Boundaries of cells along an involute, as shares of its length: `fine` ones at its ends, growing to `cell`."""
    ends = np.arange(round(ENDS / fine) + 1) * fine
    while ends[-1] - ends[-2] < cell / GROWTH:
        ends = np.append(ends, ends[-1] + GROWTH * (ends[-1] - ends[-2]))
    middle = np.linspace(ends[-1], length - ends[-1], int(np.ceil((length - 2.0 * ends[-1]) / cell)) + 1)
    return np.concatenate([ends, middle[1:-1], length - ends[::-1]]) / length


def _rotated(x: Array, angle: float) -> Array:
    c, s = np.cos(angle), np.sin(angle)
    return x @ np.array([[c, s], [-s, c]])  # rows


def _quadratic(t: Array) -> tuple[Array, Array]:
    """Values and derivatives (..., 3) at t in [-1, 1] of the functions of the nodes at -1, 0, 1."""
    values = np.stack([0.5 * t * (t - 1.0), 1.0 - t**2, 0.5 * t * (t + 1.0)], axis=-1)
    return values, np.stack([t - 0.5, -2.0 * t, t + 0.5], axis=-1)


def _quadrature(x: Array) -> tuple[Array, Array, Array, Array]:
    """Places and normals (q, 2) on a flank with the nodes x (n, 2), linear functions times weights (q, (n + 1)/2), and
    quadratic ones (q, n)."""
    t, w = np.polynomial.legendre.leggauss(POINTS)
    edges = np.arange(0, len(x) - 1, 2)
    values, slopes = _quadratic(t)
    at = edges[:, None] + [0, 1, 2]
    place = np.einsum("qa,eac->eqc", values, x[at]).reshape(-1, 2)
    tangent = np.einsum("qa,eac->eqc", slopes, x[at]).reshape(-1, 2)
    speed = np.linalg.norm(tangent, axis=1)
    row, edge = np.arange(len(place)), np.repeat(edges, POINTS)
    N, psi = np.zeros((len(place), len(x))), np.zeros((len(place), len(edges) + 1))
    for a in range(3):
        N[row, edge + a] = np.tile(values[:, a], len(edges))
    weight, share = np.tile(w, len(edges)) * speed, np.tile(0.5 * (1.0 + t), len(edges))
    psi[row, edge // 2], psi[row, edge // 2 + 1] = weight * (1.0 - share), weight * share
    return place, np.stack([tangent[:, 1], -tangent[:, 0]], axis=1) / speed[:, None], psi, N


def _facing(place: Array, normal: Array, other: Array) -> tuple[Array, Array]:
    """Distances (q,) [m] along the normals to a flank with the nodes `other` (n, 2), and its functions (q, n) there;
    infinite where it has no point."""
    away = other[None] - place[:, None]
    along = away[..., 0] * -normal[:, None, 1] + away[..., 1] * normal[:, None, 0]
    apart = np.einsum("qnc,qc->qn", away, normal)
    gap, N = np.full(len(place), np.inf), np.zeros((len(place), len(other)))
    for e in range(0, len(other) - 1, 2):
        low, middle, high = along[:, e : e + 3].T
        for row in np.flatnonzero(low * high <= 0.0):
            a, b, c = 0.5 * (low + high)[row] - middle[row], 0.5 * (high - low)[row], middle[row]
            t = -2.0 * c / (b + np.copysign(np.sqrt(b * b - 4.0 * a * c), b))
            values = _quadratic(t)[0]
            distance = float(values @ apart[row, e : e + 3])
            if abs(distance) < abs(gap[row]):
                gap[row], N[row] = distance, 0.0
                N[row, e : e + 3] = values
    return gap, N


def _dofs(nodes: Array) -> Array:
    """Numbers (..., 2 n) of the displacements of nodes (..., n)."""
    return (2 * nodes[..., None] + np.arange(2)).reshape(*nodes.shape[:-1], -1)


def _elasticity(material: Material) -> Array:
    """Plane strain: stresses xx, yy, xy by strains xx, yy and twice xy."""
    lam, mu = material.lame
    return np.array([[lam + 2 * mu, lam, 0.0], [lam, lam + 2 * mu, 0.0], [0.0, 0.0, mu]])


def _strains(x: Array, cells: Array, place: Array) -> tuple[Array, Array]:
    """Strains (m, 3, 18) by the displacements of cells (m, 9), nodes as `NODES`, at a `place` (2,) in them, and the
    determinants (m,) [m2] of their maps."""
    (N_r, d_r), (N_s, d_s) = (_quadratic(t) for t in place)
    r, s = (NODES + 1).astype(int).T
    slopes = np.stack([d_r[r] * N_s[s], N_r[r] * d_s[s]])
    J = np.einsum("ra,eac->erc", slopes, x[cells])
    grad = np.linalg.solve(J, np.broadcast_to(slopes, (len(cells), *slopes.shape)))
    B = np.zeros((len(cells), 3, 18))
    B[:, 0, 0::2], B[:, 1, 1::2] = grad[:, 0], grad[:, 1]
    B[:, 2, 0::2], B[:, 2, 1::2] = grad[:, 1], grad[:, 0]
    return B, np.abs(np.linalg.det(J))


def _stiffness(x: Array, cells: Array, material: Material) -> csr_array:
    """K of a metre of width."""
    g, w = np.polynomial.legendre.leggauss(3)
    D, ke = _elasticity(material), np.zeros((len(cells), 18, 18))
    for i, j in np.ndindex(3, 3):
        B, area = _strains(x, cells, g[[i, j]])
        ke += (w[i] * w[j] * area)[:, None, None] * (B.transpose(0, 2, 1) @ D @ B)
    dof = _dofs(cells)
    rows, columns = np.repeat(dof, 18, axis=1).ravel(), np.tile(dof, (1, 18)).ravel()
    return coo_array((ke.ravel(), (rows, columns)), shape=(2 * len(x),) * 2).tocsr()
