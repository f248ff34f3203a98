r"""Geometric stiffness of the modes: what the prestress of turning and of interface loads adds to their stiffness.

A displacement u of a body under the stress sigma0 turns and shortens its fibres; of second order in u the strain is
`d_a u . d_b u/2`, on which sigma0 works, so that (Washizu, Variational Methods in Elasticity and Plasticity, ch. 5)

    K_sigma,ij = sum_c int d_a phi_i^c sigma0_ab d_b phi_j^c dV,        V = q.K_sigma q/2.

Tension stiffens. On a mesh it is one scalar matrix for all three components, `k_ab = int grad N_a . sigma0 grad N_b`,
and `K_sigma = sum_c U_c^T k U_c` over the components U_c of the modes at the nodes. A bar under the axial force F gives
`int F w'^2` for a deflection w.

sigma0 is linear in what causes it. A unit load f at rest in the body's frame is balanced by the inertia of rigid motion
(inertia relief), so that the stress is the elastic one of `flexibility(f)`:

* turning with w: the body force `-rho w x (w x X)`, with X about the centre of mass. Per product of two components
  `-(R_a R_b + R_b R_a) X` times the mass matrix, `-R_a R_a X` of squares, R_a u = e_a x u. Its moment is what
  makes the body tumble (wdot of free motion), so that free motion at constant w about a principal axis has none;
* a unit force or moment on an interface, as its kind applies it.

Integrals use the points of the stiffness matrix. The stress is that of the finite elements at these points, not
smoothed: what is left of equilibrium goes to zero with the mesh as fast as their energy does.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any

import numpy as np
import scipy.sparse as sp

from warpffrf.model.errors import InputError
from warpffrf.model.mesh import Mesh
from warpffrf.model.reduced.inertia import PRODUCTS, GeometricStiffness
from warpffrf.offline.elastic import ElasticModel
from warpffrf.offline.fe.assembly import CHUNK_BYTES, Sparse, scatter
from warpffrf.offline.fe.dilatation import is_mixed, projected_dilatation
from warpffrf.offline.fe.materials import Assignment
from warpffrf.offline.fe.reference import physical_gradients
from warpffrf.offline.inertia.invariants import turned
from warpffrf.offline.interfaces.system import InterfaceSystem

Array = np.ndarray


def require_cells(mesh: Mesh, material: Any, stiffening: bool | str) -> None:
    """Raises `InputError` where there is nothing to compute stresses from."""
    if not mesh.cells or not material:
        raise InputError(
            f"reduce: stiffening={stiffening!r} needs the stresses in cells of a known material, the body has matrices "
            "only; give a mesh with its material, or leave stiffening out"
        )


@dataclass(frozen=True, eq=False)
class Prestress:
    """The loads that stiffen: turning (six products of its components), then six unit loads of each interface.

    `loads` (n^, l) on the coordinates of the constrained model, of these `nodal` (3 n, l) on nodes, `static` (3 n, l)
    [m] what the free body answers, `names` of the interfaces.
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
        """Stiffness K (l, k, k) of all loads, as the terms of turning and of each interface."""
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
                sigma = stress(gradient, *material.lame, dilatation) * weight[:, :, None, None, None]
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


def stress(gradient: Array, lam: float, mu: float, dilatation: Array | None = None) -> Array:
    """Stress (..., 3, 3, l) [Pa] of displacement gradients (..., 3, 3, l), isotropic with Lame's `lam`, `mu` [Pa];
    `dilatation` (..., l): where it is not their trace."""
    sigma = mu * (gradient + gradient.swapaxes(-3, -2))
    trace = np.einsum("...iil->...l", gradient) if dilatation is None else dilatation
    for i in range(3):
        sigma[..., i, i, :] += lam * trace
    return sigma
