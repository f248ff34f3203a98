r"""Stiffness and mass matrices of linear elasticity on isoparametric cells.

With scalar shape functions `N_a` and `g_ab^ij = int dN_a/dx_i dN_b/dx_j dV` the stiffness of an isotropic material is

    K_(a,i),(b,j) = lambda g_ab^ij + mu g_ab^ji + mu delta_ij sum_k g_ab^kk,

and the consistent mass `M_(a,i),(b,j) = delta_ij rho int N_a N_b dV`: everything follows from *scalar* integrals,
batched over components and cells. Dofs are node-interleaved, `3*node + component`, in mesh numbering.
"""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

import numpy as np
import scipy.sparse as sp

from warpffrf.model.material import Material
from warpffrf.model.mesh import Mesh
from warpffrf.model.mesh.elements import determinants
from warpffrf.offline.fe.dilatation import is_mixed, projected_dilatation
from warpffrf.offline.fe.materials import Assignment
from warpffrf.offline.fe.reference import MASS_DEGREE, physical_gradients, rule

Sparse = Any  # a scipy.sparse csr matrix; the stubs of scipy lose its type on every product and slice
CHUNK_BYTES = 1 << 26  # element matrices worked on together: 64 MiB keeps the peak far below that of a factorisation


def fe_matrices(mesh: Mesh, assignment: Assignment) -> tuple[Sparse, Sparse]:
    """K [N/m] and M [kg] of the body: those that the mesh carries, or those of its cells."""
    if mesh.matrices is not None:
        return mesh.matrices.stiffness, mesh.matrices.mass
    return assemble(mesh.points, mesh.cells, assignment)


def assemble(points: np.ndarray, cells: Mapping[str, np.ndarray], assignment: Assignment) -> tuple[Sparse, Sparse]:
    """K [N/m] and M [kg], both (3 n, 3 n) sparse, of the `cells` {kind: (m, k)} over the nodes `points` (n, 3) [m]."""
    n = len(points)
    K = sp.csr_matrix((3 * n, 3 * n))
    m = sp.csr_matrix((n, n))
    for kind, all_cells in cells.items():
        for i, material in enumerate(assignment.materials):
            here = all_cells[assignment.of_cell[kind] == i]
            k = here.shape[1]
            chunk = max(1, CHUNK_BYTES // (8 * 3 * (3 * k) ** 2))
            for start in range(0, len(here), chunk):
                part = here[start : start + chunk]
                x = points[part]
                dofs = (3 * part[:, :, None] + np.arange(3)).reshape(len(part), -1)
                K = K + scatter(_stiffness(x, kind, material), dofs, 3 * n)
                m = m + scatter(_mass(x, kind, material.density), part, n)
    return sp.csr_matrix(K), sp.csr_matrix(sp.kron(m, sp.identity(3), format="csr"))


def scatter(local: np.ndarray, dofs: np.ndarray, size: int) -> Sparse:
    """(size, size) csr: the sum of the cells' matrices `local` (e, k, k) at their `dofs` (e, k)."""
    k = dofs.shape[1]
    rows = np.repeat(dofs, k, axis=1).ravel().astype(np.int32)
    columns = np.tile(dofs, (1, k)).ravel().astype(np.int32)
    return sp.coo_matrix((local.ravel(), (rows, columns)), shape=(size, size)).tocsr()


def _stiffness(x: np.ndarray, kind: str, material: Material) -> np.ndarray:
    lam, mu = material.lame
    slopes, weight = physical_gradients(x, kind)
    e, q, k, _ = slopes.shape
    flat = slopes.reshape(e, q, 3 * k)
    g = np.matmul((flat * weight[..., None]).transpose(0, 2, 1), flat).reshape(e, k, 3, k, 3)
    trace = np.einsum("eaibi->eab", g)
    K = mu * g.transpose(0, 1, 4, 3, 2)
    if is_mixed(kind, material):
        D = projected_dilatation(x, kind).reshape(e, q, 3 * k)
        K += lam * np.matmul((D * weight[..., None]).transpose(0, 2, 1), D).reshape(e, k, 3, k, 3)
    else:
        K += lam * g
    for i in range(3):
        K[:, :, i, :, i] += mu * trace
    return K.reshape(e, 3 * k, 3 * k)


def _mass(x: np.ndarray, kind: str, density: float) -> np.ndarray:
    r = rule(kind, MASS_DEGREE[kind])
    J = np.einsum("eai,qaj->eqij", x, r.gradients)
    weight = determinants(J) * r.weights * density
    return np.einsum("qa,qb,eq->eab", r.values, r.values, weight, optimize=True)
