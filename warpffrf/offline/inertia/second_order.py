r"""The second-order motion of a body in its modes: the stretching of its fibres, and the motion that relieves it.

With u = sum_i q_i phi_i + Theta(q, q) and H_i = grad phi_i the strain of St. Venant-Kirchhoff's material is, up to
second order,

    E = eps(phi_i) q_i + E2,        E2 = sum_ij q_i q_j (eta_ij/2 + eps(Theta_ij)),        eta_ij = sym(H_i^T H_j).

Theta minimises the energy of E2: 0 = int grad N . C E2 = K Theta + a, a_ij = int grad N . C eta_ij/2 for all motions
of the free body with its interfaces, so that

    Theta = -K_f^+ a,        int eps(phi_i) . C E2 = 0    for every mode:

there is no cubic energy, bending is decoupled from the second order, and interfaces move by F^T Theta, which is the
-q.K_k q/2 of `stiffening` (F^T K_f^+ a_ij = int eps(K_f^+ F) . C eta_ij/2). The forces a are in equilibrium: E2 of a
small rotation W x is eta = -W W, whose stress is symmetric.

**Rigid interfaces** move by t + theta x r + theta x (theta x r)/2, r from the interface's point: their nodes do not
follow T alone, whose linear rotation would expand them. With their lift G

    Theta = G + T z,      z = -K_f^+ T^T (a + K G) - R (R^T T^T M G),

the last term because modes, second-order ones too, exclude rigid motion. For the interfaces' motion it follows that

    K_k,ij  is greater by  2 f.G_ij,        f = K u_k + M R R^T F_k - (load k on nodes),

f the forces by which a rigid interface constrains its nodes in the static response u_k to load k: by their virial
N = sum f r^T it is theta_i.(sym N - tr N) theta_j.

**Pairs.** Of q_i q_j only i <= j are kept, those with i < j count twice. Modes are taken at unit energy, phi_i/omega_i,
and pairs times sqrt(1) or sqrt(2), so that the coordinates r_ij = sqrt(1 or 2) z_i z_j, z_i = omega_i q_i, have
|r| = |z|^2 = 2 V2, whichever modes span the space. Strain fields are computed cell by cell and never stored.

Second order shapes. The second-order motion of a body on few shapes.

Theta = theta r, r the products of `second_order.Pairs`, has a field for each pair of modes. In the mass norm it is

    int |Theta|^2 dm = r.G r,      G = theta^T M theta = sum_s mu_s v_s v_s^T,
    Theta = sum_s g_s B_s,      g_s = sqrt(mu_s) v_s.r = q.S_s q/2,      B_s = theta v_s/sqrt(mu_s),

B_s of modal mass 1 and orthogonal to one another. As |r| = 2 V2, shapes with sqrt(mu_s) below `TRUNCATION` of the
largest omit at most this fraction of the largest root mean square of Theta of all states of the same strain energy
V2, whichever modes span the space.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from typing import Any

import numpy as np
import scipy.sparse as sp

from warpffrf.model.errors import InputError
from warpffrf.model.material import Orthotropic, SolidMaterial
from warpffrf.model.reduced.inertia import SecondOrderMotion
from warpffrf.offline.elastic import ElasticModel
from warpffrf.offline.fe import CHUNK_BYTES, Assignment, Sparse, is_mixed, physical_gradients, projection
from warpffrf.offline.inertia.invariants import Prestress
from warpffrf.offline.interfaces import InterfaceSystem

Array = np.ndarray
FIRST, SECOND = np.array([0, 1, 2, 0, 1, 2]), np.array([0, 1, 2, 1, 2, 0])  # xx, yy, zz, xy, yz, zx
# Strains (6,) contain shear times sqrt 2, so that their dot product is that of tensors.
SHEAR = np.where(np.arange(6) < 3, 1.0, np.sqrt(2.0))
BLOCK_BYTES = 1 << 28  # loads of pairs solved together, including the memory of a solve
SOLVE_COPIES = 6  # approximate number of arrays of the size of a block of loads that exist during a solve


@dataclass(frozen=True, eq=False)
class Pairs:
    """Products z_i z_j, i <= j, of `modes` coordinates: `first` i, `second` j, `weight` 1 or sqrt 2, all (P,)."""

    modes: int

    @property
    def first(self) -> Array:
        """i."""
        return np.triu_indices(self.modes)[0]

    @property
    def second(self) -> Array:
        """j."""
        return np.triu_indices(self.modes)[1]

    @property
    def weight(self) -> Array:
        """Weight for which |r| = |z|^2 of r = weight z_i z_j."""
        return np.where(self.first == self.second, 1.0, np.sqrt(2.0))

    def __len__(self) -> int:
        return self.modes * (self.modes + 1) // 2

    def products(self, z: Array) -> Array:
        """r (P,) of z (modes,)."""
        return self.weight * z[self.first] * z[self.second]

    def forms(self, vectors: Array) -> Array:
        """S (R, modes, modes), symmetric, with z.S_r z = vectors_r.r, of `vectors` (P, R)."""
        S = np.zeros((vectors.shape[1], self.modes, self.modes))
        half = 0.5 * (vectors * self.weight[:, None]).T
        S[:, self.first, self.second] += half
        S[:, self.second, self.first] += half
        return S


@dataclass(frozen=True, eq=False)
class CellStrains:
    """Strains and stresses of a few cells of one kind and one material, of all pairs.

    `nodes` (e, a), `slopes` dN_a/dx (e, q, a, 3) [1/m], `weight` (e, q) [m^3], `strain` (e, q, 6, P), `stress`
    (e, q, 6, P) [Pa], both with shear times sqrt 2, `material` its number.
    """

    nodes: Array
    slopes: Array
    weight: Array
    strain: Array
    stress: Array
    material: int

    def loads(self) -> Array:
        """int grad N . stress (e, a, 3 P) [N]."""
        e, q, a, _ = self.slopes.shape
        P = self.stress.shape[3]
        S = np.empty((e, q, 3, 3, P))
        scaled = self.stress / SHEAR[:, None] * self.weight[:, :, None, None]
        S[:, :, FIRST, SECOND] = scaled
        S[:, :, SECOND, FIRST] = scaled
        along = self.slopes.transpose(0, 2, 1, 3).reshape(e, a, 3 * q)
        return np.matmul(along, S.transpose(0, 1, 3, 2, 4).reshape(e, 3 * q, 3 * P))

    def energies(self) -> Array:
        """int strain . stress (P, P) [J]."""
        flat = (self.stress * self.weight[:, :, None, None]).reshape(-1, self.stress.shape[3])
        return self.strain.reshape(flat.shape).T @ flat


@dataclass(frozen=True, eq=False)
class SecondOrderStrain:
    """E2 of the modes `Z` (3 n, m) of unit energy, over the `cells` {kind: (e, a)} at `points` (n, 3) [m].

    `chunk_bytes`: size of the cells processed together.
    """

    points: Array
    cells: Mapping[str, Array]
    assignment: Assignment
    Z: Array
    chunk_bytes: int = CHUNK_BYTES

    @property
    def pairs(self) -> Pairs:
        """The products of the strains."""
        return Pairs(self.Z.shape[1])

    def chunks(self, chosen: Array, theta: Array | None = None) -> Iterator[CellStrains]:
        """eta/2 + eps(theta) of the pairs with the numbers `chosen` (p,), `theta` (3 n, p) [m], None: zero."""
        n, p = len(self.points), len(chosen)
        for kind, all_cells in self.cells.items():
            for i, material in enumerate(self.assignment.materials):
                here = all_cells[self.assignment.of_cell[kind] == i]
                if not len(here):
                    continue
                a = here.shape[1]
                slopes, _ = physical_gradients(self.points[here[:1]], kind)
                count = max(1, self.chunk_bytes // (8 * slopes.shape[1] * (30 * p + 9 * self.Z.shape[1] ** 2)))
                for start in range(0, len(here), count):
                    nodes = here[start : start + count]
                    slopes, weight = physical_gradients(self.points[nodes], kind)
                    E = self._stretching(nodes, slopes, chosen)
                    if theta is not None:
                        E += strain_of(theta.reshape(n, 3 * p)[nodes].reshape(len(nodes), a, 3, p), slopes)
                    P = projection(self.points[nodes], kind) if is_mixed(kind, material) else None
                    yield CellStrains(nodes, slopes, weight, E, hooke(E, material, P), i)

    def _stretching(self, nodes: Array, slopes: Array, chosen: Array) -> Array:
        """eta/2 (e, q, 6, p) times the weights of the pairs."""
        m = self.Z.shape[1]
        H = np.einsum("eacm,eqad->eqcdm", self.Z.reshape(-1, 3, m)[nodes], slopes, optimize=True)
        e, q = H.shape[:2]
        flat = H.reshape(e, q, 3, 3 * m)
        both = np.matmul(flat.swapaxes(2, 3), flat).reshape(e, q, 3, m, 3, m)  # H_i^T H_j
        i, j = self.pairs.first[chosen], self.pairs.second[chosen]
        E = np.empty((e, q, 6, len(chosen)))
        for c, (a, b) in enumerate(zip(FIRST, SECOND, strict=True)):
            X = both[:, :, a, :, b]
            E[:, :, c] = 0.25 * SHEAR[c] * (X[:, :, i, j] + X[:, :, j, i])
        return E * self.pairs.weight[chosen]

    def loads(self, chosen: Array, theta: Array) -> tuple[Array, Array]:
        """a + K theta (3 n, p) [N] of the pairs `chosen` (p,), and int of their strain energy density times two (p,)
        [J]; `theta` (3 n, p) [m]."""
        n, p = len(self.points), len(chosen)
        total, energy = np.zeros((n, 3 * p)), np.zeros(p)
        for part in self.chunks(chosen, theta):
            rows = part.nodes.ravel()
            gather = sp.csr_matrix((np.ones(len(rows)), (rows, np.arange(len(rows)))), shape=(n, len(rows)))
            total += gather @ part.loads().reshape(len(rows), 3 * p)
            energy += np.einsum("eqcp,eqcp,eq->p", part.strain, part.stress, part.weight, optimize=True)
        return total.reshape(3 * n, p), energy

    def energies(self, theta: Array) -> Array:
        """int E2 . C E2 (P, P) [J], symmetric, with the second-order motion `theta` (3 n, P) [m]."""
        total = sum(part.energies() for part in self.chunks(np.arange(len(self.pairs)), theta))
        return 0.5 * (total + np.transpose(total))


def strain_of(u: Array, slopes: Array) -> Array:
    """eps (e, q, 6, p) of nodal displacements u (e, a, 3, p) [m], shear times sqrt 2."""
    e, q, a, _ = slopes.shape
    p = u.shape[3]
    along = slopes.transpose(0, 1, 3, 2).reshape(e, 3 * q, a)
    H = np.matmul(along, u.reshape(e, a, 3 * p)).reshape(e, q, 3, 3, p)  # d, c
    return 0.5 * SHEAR[:, None] * (H[:, :, FIRST, SECOND] + H[:, :, SECOND, FIRST])


def hooke(E: Array, material: SolidMaterial, P: Array | None = None) -> Array:
    """Stress of strains (e, q, 6, p), shear times sqrt 2 in both; `P` (e, q, q) projects the trace."""
    if isinstance(material, Orthotropic):
        c = SHEAR[:, None] * SHEAR * material.stiffness[FIRST, SECOND][:, FIRST, SECOND]
        return np.einsum("ij,eqjp->eqip", c, E, optimize=True)
    lam, mu = material.lame
    S = 2.0 * mu * E
    trace = E[:, :, 0] + E[:, :, 1] + E[:, :, 2]
    if P is not None:
        trace = np.matmul(P, trace)
    S[:, :, :3] += lam * trace[:, :, None]
    return S


def lift(system: InterfaceSystem, rotations: Mapping[str, Array], pairs: Pairs, theta: Array) -> None:
    """Write weight (theta_i x (theta_j x r) + theta_j x (theta_i x r))/4 of the nodes of rigid interfaces into `theta`
    (3 n, P) [m]; `rotations` (m, 3) [rad] of each by name, of modes of unit energy."""
    for interface in system.rigid_interfaces:
        r = system.points[interface.nodes] - interface.point
        turn = rotations[interface.name]
        a, b = turn[pairs.first], turn[pairs.second]
        twice = np.cross(a[:, None], np.cross(b[:, None], r)) + np.cross(b[:, None], np.cross(a[:, None], r))
        theta[interface.dofs] = (0.25 * pairs.weight[:, None, None] * twice).reshape(len(pairs), -1).T


def second_order_motion(
    strain: SecondOrderStrain,
    model: ElasticModel,
    system: InterfaceSystem,
    M: Sparse,
    rotations: Mapping[str, Array],
    *,
    memory_limit: int,
) -> tuple[Array, Array]:
    """Theta (3 n, P) [m] of all pairs, and int of (eta/2) . C (eta/2) (P,) [J], the energy of stretching alone.

    `M` (3 n, 3 n) [kg] nodal mass matrix; `rotations` as in `lift`. Raises `InputError` if Theta is larger than
    `memory_limit` [byte].
    """
    pairs, size = strain.pairs, strain.Z.shape[0]
    needed = 8 * size * len(pairs)
    if needed > memory_limit:
        fits = int(np.sqrt(2.0 * memory_limit / (8 * size)))
        raise InputError(
            f"membrane energy: the second-order motion of {pairs.modes} modes has {len(pairs)} fields, "
            f"{needed / 2**30:.3g} GiB, memory_limit is {memory_limit / 2**30:.3g} GiB; use membrane_modes={fits} or "
            "raise memory_limit"
        )
    theta, bare = np.zeros((size, len(pairs))), np.zeros(len(pairs))
    lift(system, rotations, pairs, theta)
    T = system.T
    width = max(1, BLOCK_BYTES // (8 * SOLVE_COPIES * size))
    for start in range(0, len(pairs), width):
        chosen = np.arange(start, min(start + width, len(pairs)))
        a, bare[chosen] = strain.loads(chosen, theta[:, chosen])
        rigid = np.asarray(T.T @ (M @ theta[:, chosen]))
        z = model.flexibility(np.asarray(T.T @ a)) + model.R @ (model.R.T @ rigid)
        theta[:, chosen] -= T @ z
    return theta, bare


def lifted_stiffness(
    prestress: Prestress,
    model: ElasticModel,
    system: InterfaceSystem,
    K: Sparse,
    M: Sparse,
    rotations: Mapping[str, Array],
    modes: int,
) -> Array:
    """Part of the lift of rigid interfaces in the geometric stiffness (l, k, k) of the loads of `prestress`; `K`,
    `M` (3 n, 3 n) nodal, `rotations` (k, 3) [rad] of the k `modes` by name."""
    T = system.T
    moving = T @ (model.R @ (model.R.T @ prestress.loads))
    f = (K @ prestress.static + M @ moving - prestress.nodal).reshape(len(system.points), 3, -1)
    found = np.zeros((f.shape[2], modes, modes))
    for interface in system.rigid_interfaces:
        r = system.points[interface.nodes] - interface.point
        N = np.einsum("nal,nb->lab", f[interface.nodes], r)
        form = 0.5 * (N + N.transpose(0, 2, 1)) - np.trace(N, axis1=1, axis2=2)[:, None, None] * np.eye(3)
        turn = rotations[interface.name]
        found += turn @ form @ turn.T
    return found


TRUNCATION = 3e-3  # of the largest second-order motion; at 1e-2 strains of skins were wrong by half of them
COLUMNS = 64  # fields multiplied by the mass together


@dataclass(frozen=True, eq=False)
class SecondOrderShapes:
    """`motion`, the amplitudes of the `shapes` B (3 n, R), and `facts` for the report."""

    motion: SecondOrderMotion
    shapes: Array
    facts: dict[str, Any]


def second_order_shapes(pairs: Pairs, theta: Array, scale: Array, M: Sparse, U: Array) -> SecondOrderShapes:
    """Shapes of the second-order motion `theta` (3 n, P) [m] of `pairs` of the first of the modes `U` (3 n, k), at unit
    energy, `scale` (m,) [rad/s] their frequencies; `M` (3 n, 3 n) [kg] nodal mass matrix."""
    count, covered = pairs.modes, U.shape[1]
    G = np.empty((len(pairs), len(pairs)))
    for start in range(0, len(pairs), COLUMNS):
        part = slice(start, start + COLUMNS)
        G[:, part] = theta.T @ (M @ theta[:, part])
    values, vectors = np.linalg.eigh(0.5 * (G + G.T))
    size, vectors = np.sqrt(values[::-1].clip(0.0)), vectors[:, ::-1]
    kept = int(np.sum(size > TRUNCATION * size[0]))
    vectors = vectors[:, :kept] * np.sign(vectors[np.abs(vectors[:, :kept]).argmax(axis=0), np.arange(kept)])
    forms = np.zeros((kept, covered, covered))
    forms[:, :count, :count] = 2.0 * size[:kept, None, None] * pairs.forms(vectors) * np.outer(scale, scale)
    shapes = theta @ (vectors / size[:kept])
    left_out = float(size[kept] / size[0]) if 0 < kept < len(size) else 0.0
    return SecondOrderShapes(
        SecondOrderMotion(forms, U.T @ (M @ shapes)), shapes, {"shapes": kept, "motion_left_out": left_out}
    )
