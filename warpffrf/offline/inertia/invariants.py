r"""Inertia invariants from any mass matrix and modes at all nodes (definitions: `warpffrf.model.reduced.inertia`).

A rotation about axis a moves the nodes by `R_a u`, `e_a x u` at every node. The kinetic energy of the nodal velocities
`R_w (X + U q) + U qdot` is a quadratic form of M, without lumping it:

    w.J1_i w = 2 (R_w X)^T M (R_w phi_i),     w.J2_ij w = (R_w phi_i)^T M (R_w phi_j),
    2 e_a.G_ij = (R_a phi_i)^T M phi_j - (R_a phi_j)^T M phi_i,

J2 is symmetrised in its axes, which does not change w.J2_ij w. For the mass matrix of finite elements, or any
other isotropic one, G is antisymmetric in itself. With `(R_a u)^T y = -u^T (R_a y)` only products of M with rotated
modes are formed, a block of modes at a time; `BLOCK` bounds the memory in addition to the modes themselves.

The consistent mass of finite elements is one scalar matrix m for all three components. All then follows from the
moments `int X phi_i^T dm` and `int phi_i phi_j^T dm` with three products by m, at a tenth of the cost (`from_moments`).

Centrifugal. The static response of a body to its own rotation: its attachment modes, and the part that a reduced body
omits.

At constant angular velocity w the load of a body is `-int rho w x (w x X) dV`, one field for each of the six products
w_a w_b. For loads on interfaces attachment modes make the static response exact for any number of modes; the same holds
for the loads of rotation. With

    F_c = T^T M a,        a_ab = -(R_a R_b + R_b R_a) X,   a_aa = -R_a R_a X,        A_c = G F_c,

in addition to the interface loads (`ReductionOptions(centrifugal=True)`), Phi Omega^-2 Phi^T F_c = G F_c. Vibration
modes alone hardly contain it: that of a disc is the breathing one, above hundreds of others, and interface modes only
by accident.

Without it, or if the inertia terms cover the lowest k modes only, a part of G F_c is omitted,

    u = G F_c - Phi_k Omega_k^-2 Phi_k^T F_c,        S = u^T M u (6, 6).

The products, with those of two axes multiplied by root 2, have the length |w|^2 in any axes. So, with those columns
divided by root 2, the omitted displacement at the angular speed |w| has a root mean square over the radius of gyration
of at most

    |w|^2 left_out,        left_out = root(largest eigenvalue of S) / root(tr J0/2)      [s^2].

Stiffening. Geometric stiffness of the modes due to the prestress of rotation and of interface loads.

A displacement u of a body under the stress sigma0 rotates and shortens its fibres. The second-order strain is
`d_a u . d_b u/2`, on which sigma0 does work, so that (Washizu, Variational Methods in Elasticity and Plasticity, ch. 5)

    K_sigma,ij = sum_c int d_a phi_i^c sigma0_ab d_b phi_j^c dV,        V = q.K_sigma q/2.

Tension stiffens. On a mesh it is one scalar matrix for all three components, `k_ab = int grad N_a . sigma0 grad N_b`,
and `K_sigma = sum_c U_c^T k U_c` over the components U_c of the modes at the nodes. A bar under the axial force F gives
`int F w'^2` for a deflection w.

sigma0 is linear in its cause. A unit load f at rest in the body's frame is balanced by the inertia of rigid motion
(inertia relief), so that the stress is the elastic one of `flexibility(f)`:

* rotation with w: the body force `-rho w x (w x X)`, with X about the centre of mass. Per product of two components
  `-(R_a R_b + R_b R_a) X` times the mass matrix, `-R_a R_a X` for squares, R_a u = e_a x u. Its moment makes the body
  tumble (wdot of free motion), so that free motion at constant w about a principal axis has none;
* a unit force or moment on an interface, as its kind applies it.

Integrals use the quadrature points of the stiffness matrix. The stress is that of the finite elements at these points,
not smoothed: the equilibrium error converges with the mesh at the rate of their energy.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass
from typing import Any

import numpy as np
import scipy.sparse as sp

from warpffrf.model.errors import InputError
from warpffrf.model.material import Orthotropic, SolidMaterial
from warpffrf.model.mesh import Mesh
from warpffrf.model.mesh.facets import rigid_modes
from warpffrf.model.reduced.inertia import PRODUCTS, GeometricStiffness, InertiaTerms
from warpffrf.offline.bases.modes import whole_multiples
from warpffrf.offline.elastic import ElasticModel
from warpffrf.offline.fe import (
    CHUNK_BYTES,
    Assignment,
    Sparse,
    is_mixed,
    physical_gradients,
    projected_dilatation,
    scatter,
)
from warpffrf.offline.interfaces import InterfaceSystem

Array = np.ndarray
MODES = 60  # default limit: tables grow with the square, and higher modes follow rotation quasi-statically
BLOCK = 16  # modes rotated at a time


def covered_modes(omega: Array, asked: int | None) -> int:
    """Number of the modes `omega` (m,) [rad/s] with inertia terms: `asked`, None: `MODES`; raised if it would split a
    multiple frequency, so that the terms of a round body stay isotropic."""
    return whole_multiples(omega, MODES if asked is None else asked)


def inertia_terms(M: Any, U: Array, points: Array, center: Array) -> InertiaTerms:
    """Invariants of the modes `U` (3 n, k) at the nodes `points` (n, 3) [m]; `M` (3 n, 3 n) [kg] sparse mass matrix,
    `center` (3,) [m] of mass."""
    if (m := scalar_mass(M)) is not None:
        return from_moments(*moments(m, U, points - center))
    k = U.shape[1]
    RX = rigid_modes(points, center)[:, 3:]
    first, second, gyroscopic = np.zeros((k, 3, 3)), np.zeros((k, k, 3, 3)), np.zeros((k, k, 3))
    for start in range(0, k, BLOCK):
        part = slice(start, start + BLOCK)
        block = U[:, part]
        MU = M @ block
        for b in range(3):
            gyroscopic[:, part, b] = -(U.T @ turned(MU, b))
            turn = M @ turned(block, b)
            first[part, :, b] = turn.T @ RX
            for a in range(b + 1):
                second[:, part, a, b] = -(U.T @ turned(turn, a))
    for a, b in ((0, 1), (0, 2), (1, 2)):
        mixed = 0.5 * (second[:, :, a, b] + second[:, :, a, b].T)
        second[:, :, a, b] = second[:, :, b, a] = mixed
    return InertiaTerms(
        first + first.transpose(0, 2, 1),
        0.5 * (second + second.transpose(1, 0, 2, 3)),
        0.5 * (gyroscopic - gyroscopic.transpose(1, 0, 2)),
    )


def turned(U: Array, axis: int) -> Array:
    """e_axis x u at every node, of fields (3 n, k)."""
    a, b = (axis + 1) % 3, (axis + 2) % 3
    out = np.zeros_like(U)
    out[a::3], out[b::3] = -U[b::3], U[a::3]
    return out


def scalar_mass(M: Any) -> Any | None:
    """m (n, n) csr where M (3 n, 3 n) is m for every component and couples none, else None."""
    M = sp.csr_matrix(M)
    entries = M.tocoo()
    apart = entries.row % 3 != entries.col % 3
    if np.any(entries.data[apart] != 0.0):
        return None
    m = M[0::3][:, 0::3]
    alike = all((m != M[c::3][:, c::3]).nnz == 0 for c in (1, 2))
    return m if alike else None


def moments(m: Any, U: Array, X: Array) -> tuple[Array, Array]:
    """int X phi_i^T dm (k, 3, 3) [kg m] and int phi_i phi_j^T dm (k, k, 3, 3) [kg] of the modes `U` (3 n, k) with the
    scalar mass matrix `m` (n, n) [kg]; `X` (n, 3) [m] about the centre of mass."""
    k = U.shape[1]
    first, second = np.zeros((k, 3, 3)), np.zeros((k, k, 3, 3))
    for b in range(3):
        moving = m @ U[b::3]
        first[:, :, b] = moving.T @ X
        for a in range(b + 1):
            second[:, :, a, b] = U[a::3].T @ moving
            second[:, :, b, a] = second[:, :, a, b].T
    return first, second


def from_moments(first: Array, second: Array) -> InertiaTerms:
    """Invariants from the moments `first` (k, 3, 3) = int X phi_i^T dm [kg m] about the centre of mass and `second`
    (k, k, 3, 3) = int phi_i phi_j^T dm [kg]: the definitions for an isotropic mass."""
    one = np.eye(3)
    trace_1 = np.trace(first, axis1=1, axis2=2)[:, None, None]
    trace_2 = np.trace(second, axis1=2, axis2=3)[:, :, None, None]
    J1 = 2.0 * trace_1 * one - first - first.transpose(0, 2, 1)
    J2 = trace_2 * one - 0.5 * (second + second.transpose(0, 1, 3, 2))
    skew = second - second.transpose(0, 1, 3, 2)
    G = np.stack([skew[:, :, 1, 2], skew[:, :, 2, 0], skew[:, :, 0, 1]], axis=2)
    return InertiaTerms(J1, 0.5 * (J2 + J2.transpose(1, 0, 2, 3)), 0.5 * (G - G.transpose(1, 0, 2)))


# Part of the static response to rotation that may be left to modes beyond those with inertia terms: the usual
# accuracy of displacements.
BEYOND = 0.01


@dataclass(frozen=True, eq=False)
class TurningResponse:
    """Static response u (n, c) to loads F (n, c) of rotation relative to the modes Phi (n, m), `omega` (m,) [rad/s]
    ascending: `on_modes` Phi^H F (m, c), `overlap` Phi^H M u (m, c), `gram` u^H M u (c, c)."""

    omega: Array
    on_modes: Array
    overlap: Array
    gram: Array

    @classmethod
    def of(cls, M, F: Array, u: Array, omega: Array, Phi: Array) -> TurningResponse:
        """Of loads `F`, whose flexible response is `u`, and M-orthonormal modes `Phi`; M (n, n) mass matrix."""
        Mu = M @ u
        return cls(omega, Phi.conj().T @ F, Phi.conj().T @ Mu, u.conj().T @ Mu)

    def beyond(self, limit: float) -> Array:
        """S (c, c): M-products of the part of the response outside the modes up to `limit` [rad/s]."""
        inside = self.omega <= limit
        c = self.on_modes[inside] / (self.omega[inside] ** 2)[:, None]
        both = self.overlap[inside].conj().T @ c
        return self.gram - both - both.conj().T + c.conj().T @ c


def covering_turning(omega: Array, least: int, lacking: Callable[[float], float]) -> int:
    """Number of the modes `omega` (m,) [rad/s], `least` at least, with inertia terms, so that they contain the static
    response to rotation up to `BEYOND`; `lacking`: `left_out` [s^2] of the modes up to a limit [rad/s]."""
    allowed = BEYOND * lacking(0.0)
    for kept in range(least, len(omega)):
        whole = covered_modes(omega, kept) == kept  # splits no multiple frequency
        if whole and lacking(float(omega[kept - 1]) if kept else 0.0) <= allowed:
            return kept
    return len(omega)


def left_out(S: Array, inertia: Array) -> float:
    """Bound of the omitted displacement [s^2], see the module: S (6, 6) [kg m2 s4] in the order of `PRODUCTS`,
    `inertia` J0 (3, 3) [kg m2]."""
    scale = np.array([1.0 if a == b else np.sqrt(0.5) for a, b in PRODUCTS])
    largest = float(np.linalg.eigvalsh(0.5 * (S + S.T) * np.outer(scale, scale))[-1])
    return float(np.sqrt(max(largest, 0.0) / (0.5 * np.trace(inertia))))


def turning_response(model: ElasticModel, F: Array, omega: Array, Phi: Array) -> TurningResponse:
    """`TurningResponse` of the free body `model` to loads F (n, c) relative to modes Phi (n, m)."""
    return TurningResponse.of(model.M, F, model.flexibility(F), omega, Phi)


def require_cells(mesh: Mesh, material: Any, stiffening: bool | str) -> None:
    """Raises `InputError` if there is nothing to compute stresses from."""
    if not mesh.cells or not material:
        raise InputError(
            f"reduce: stiffening={stiffening!r} needs the stresses in cells of a known material, the body has matrices "
            "only; give a mesh with its material, or leave stiffening out"
        )


@dataclass(frozen=True, eq=False)
class Prestress:
    """The loads that cause stiffening: rotation (six products of its components), then six unit loads per interface.

    `loads` (n^, l) on the coordinates of the constrained model, of these `nodal` (3 n, l) on nodes, `static` (3 n, l)
    [m] the response of the free body, `names` of the interfaces.
    """

    loads: Array
    nodal: Array
    static: Array
    names: tuple[str, ...]

    @classmethod
    def of(cls, model: ElasticModel, system: InterfaceSystem, M: Sparse, center: Array) -> Prestress:
        """Those of the free constrained body `model` with the interfaces of `system`; `M` (3 n, 3 n) [kg] nodal mass
        matrix, `center` (3,) [m] of mass."""
        turning = np.asarray(M @ centrifugal_acceleration(system.points, center))
        wrenches = system.wrenches()
        loads = np.concatenate([system.T.T @ turning, *wrenches.values()], axis=1)
        static = np.asarray(system.T @ model.flexibility(loads))
        nodal = np.zeros_like(static)
        nodal[:, :6] = turning
        return cls(loads, nodal, static, tuple(wrenches))

    def by_load(self, K: Array) -> GeometricStiffness:
        """Stiffness K (l, k, k) of all loads, as the terms of rotation and of each interface."""
        named = {name: K[6 * (i + 1) : 6 * (i + 2)] for i, name in enumerate(self.names)}
        return GeometricStiffness(K[:6], named)


def centrifugal_acceleration(points: Array, center: Array) -> Array:
    """(3 n, 6) [1/s^2 -> m/s^2]: -w x (w x X) per product of components of w, in the order of `PRODUCTS`."""
    X = (points - center).reshape(-1, 1)
    columns = []
    for a, b in PRODUCTS:
        both = turned(turned(X, b), a)
        columns.append(-both if a == b else -both - turned(turned(X, a), b))
    return np.concatenate(columns, axis=1)


def prestress_stiffness(
    points: Array, cells: Mapping[str, Array], assignment: Assignment, static: Array, U: Array
) -> Array:
    """K_sigma (l, k, k) of the modes `U` (3 n, k) for the elastic stress of each displacement in `static` (3 n, l) [m],
    over the `cells` {kind: (m, nodes)} at `points` (n, 3) [m]."""
    n, count = len(points), static.shape[1]
    scalar = [sp.csr_matrix((n, n)) for _ in range(count)]
    for kind, all_cells in cells.items():
        for i, material in enumerate(assignment.materials):
            here = all_cells[assignment.of_cell[kind] == i]
            chunk = max(1, CHUNK_BYTES // (8 * 9 * (count + here.shape[1]) * here.shape[1]))
            for start in range(0, len(here), chunk):
                part = here[start : start + chunk]
                slopes, weight = physical_gradients(points[part], kind)
                u = static.reshape(n, 3, count)[part]
                gradient = np.einsum("eacl,eqad->eqcdl", u, slopes, optimize=True)
                dilatation = None
                if is_mixed(kind, material):
                    D = projected_dilatation(points[part], kind)
                    dilatation = np.einsum("eacl,eqac->eql", u, D, optimize=True)
                sigma = stress(gradient, material, dilatation) * weight[:, :, None, None, None]
                for load in range(count):
                    pulled = np.matmul(slopes, sigma[..., load])
                    local = np.matmul(pulled.transpose(0, 2, 1, 3).reshape(*part.shape, -1), _across(slopes))
                    scalar[load] = scalar[load] + scatter(local, part, n)
    K = np.stack([sum(U[c::3].T @ (k @ U[c::3]) for c in range(3)) for k in scalar])
    return 0.5 * (K + K.transpose(0, 2, 1))


def _across(slopes: Array) -> Array:
    """Gradients (e, q, a, 3) as (e, 3 q, a)."""
    e, q, a, _ = slopes.shape
    return slopes.transpose(0, 1, 3, 2).reshape(e, 3 * q, a)


def stress(gradient: Array, material: SolidMaterial, dilatation: Array | None = None) -> Array:
    """Stress (..., 3, 3, l) [Pa] of displacement gradients (..., 3, 3, l); `dilatation` (..., l): where it is not their
    trace, of isotropic materials."""
    if isinstance(material, Orthotropic):
        return np.einsum("ijkm,...kml->...ijl", material.stiffness, gradient, optimize=True)
    lam, mu = material.lame
    sigma = mu * (gradient + gradient.swapaxes(-3, -2))
    trace = np.einsum("...iil->...l", gradient) if dilatation is None else dilatation
    for i in range(3):
        sigma[..., i, i, :] += lam * trace
    return sigma
