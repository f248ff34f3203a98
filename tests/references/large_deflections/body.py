r"""A body of St. Venant-Kirchhoff's material in total Lagrangian finite elements of scikit-fem.

With H = grad u and F = 1 + H the energy, the nodal forces and the tangent are (T. Belytschko, W. K. Liu, B. Moran,
Nonlinear Finite Elements for Continua and Structures, ch. 4)

    V = int E.C E/2 dV,       E = (H + H^T + H^T H)/2,      S = C E = lambda tr(E) 1 + 2 mu E,
    f_a = int F S grad N_a dV,
    K_ab = int (grad N_a.S grad N_b) 1 + B_a^T C B_b dV,        B_a v = sym(F^T (v x grad N_a)).

E is invariant under rigid rotations, so that these are exact for any size of the displacements; the material law is
valid for small strains. Integrals use the points of the linear stiffness matrix, which is K(0).
"""

from __future__ import annotations

from functools import cached_property

import numpy as np
import scipy.sparse as sp

from references.finite_elements.meshes import Sparse, facet_shares, matrices, scalar_basis
from warpffrf.model.errors import InputError, require_array
from warpffrf.model.material import Material
from warpffrf.model.mesh import Mesh

Array = np.ndarray
# a symmetric tensor (6,) as xx, yy, zz, xy, yz, zx
FIRST, SECOND = np.array([0, 1, 2, 0, 1, 2]), np.array([0, 1, 2, 1, 2, 0])
PLACE = np.array([[0, 3, 5], [3, 1, 4], [5, 4, 2]])


class StVenantKirchhoffBody:
    """A `mesh` of one kind of cells and its `material`; displacements u (3 n,) [m], dof 3 node + component.

    Raises `InputError` for kinds of cells that are not supported.
    """

    def __init__(self, mesh: Mesh, material: Material) -> None:
        self.mesh, self.material = mesh, material
        basis, node = scalar_basis(mesh)
        self.nodes = node[np.asarray(basis.element_dofs)].T  # (e, a)
        self.slopes = np.stack([np.asarray(f[0].grad) for f in basis.basis]).transpose(2, 3, 0, 1)  # (e, q, a, 3)
        self.weight = np.asarray(basis.dx)  # (e, q) m^3
        self.size = 3 * len(mesh.points)
        self.dofs = (3 * self.nodes[:, :, None] + np.arange(3)).reshape(len(self.nodes), -1)
        lam, mu = material.lame
        self.hooke = np.diag([2 * mu] * 3 + [mu] * 3)  # on strains with twice the shear
        self.hooke[:3, :3] += lam

    @cached_property
    def _linear(self) -> tuple[Sparse, Sparse]:
        return matrices(self.mesh, self.material)

    @property
    def K(self) -> Sparse:
        """Linear stiffness (3 n, 3 n) [N/m], csr."""
        return self._linear[0]

    @property
    def M(self) -> Sparse:
        """Mass (3 n, 3 n) [kg], csr."""
        return self._linear[1]

    def gradient(self, u: Array) -> Array:
        """H (e, q, 3, 3) at the points of quadrature, H_cd = du_c/dx_d."""
        local = u.reshape(-1, 3)[self.nodes]
        return np.einsum("eac,eqad->eqcd", local, self.slopes, optimize=True)

    def strain(self, u: Array) -> Array:
        """Green-Lagrange strain E (e, q, 6) with twice the shear."""
        H = self.gradient(u)
        E = H + H.swapaxes(2, 3) + np.matmul(H.swapaxes(2, 3), H)
        return np.where(np.arange(6) < 3, 0.5, 1.0) * E[:, :, FIRST, SECOND]

    def stress(self, u: Array) -> Array:
        """Second Piola-Kirchhoff stress S (e, q, 6) [Pa]."""
        return self.strain(u) @ self.hooke

    def energy(self, u: Array) -> float:
        """V [J]."""
        E = self.strain(u)
        return float(0.5 * np.einsum("eqi,eqi,eq", E, E @ self.hooke, self.weight))

    def forces(self, u: Array) -> Array:
        """f (3 n,) [N], the derivative of the energy."""
        F = self.gradient(u) + np.eye(3)
        P = np.matmul(F, self.stress(u)[:, :, PLACE]) * self.weight[:, :, None, None]
        local = np.einsum("eqcd,eqad->eac", P, self.slopes, optimize=True)
        return np.bincount(self.dofs.ravel(), local.ravel(), minlength=self.size)

    def tangent(self, u: Array) -> Sparse:
        """K (3 n, 3 n) [N/m] csr, the derivative of the forces."""
        F = self.gradient(u) + np.eye(3)
        S = self.stress(u)[:, :, PLACE] * self.weight[:, :, None, None]
        e, q, a, _ = self.slopes.shape
        local = np.zeros((e, 3 * a, 3 * a))
        for k in range(q):  # one point at a time: the matrices of all cells together are too large
            g = self.slopes[:, k]
            X = np.einsum("eci,eaj->eacij", F[:, k], g)
            X = X + X.swapaxes(3, 4)  # twice dE
            B = (np.where(np.arange(6) < 3, 0.5, 1.0) * X[..., FIRST, SECOND]).reshape(e, 3 * a, 6)
            local += np.matmul(B, (self.hooke * self.weight[:, k, None, None]) @ B.transpose(0, 2, 1))
            geometric = np.matmul(np.matmul(g, S[:, k]), g.transpose(0, 2, 1))
            for c in range(3):
                local[:, c::3, c::3] += geometric
        rows = np.repeat(self.dofs, 3 * a, axis=1).ravel()
        columns = np.tile(self.dofs, (1, 3 * a)).ravel()
        return sp.coo_matrix((local.ravel(), (rows, columns)), shape=(self.size, self.size)).tocsr()

    # --- supports and loads ---

    def held(self, *names: str) -> Array:
        """Dofs (h,) of the nodes of facet sets. Raises `InputError` for sets that the mesh does not have."""
        nodes = np.unique(np.concatenate([self.mesh.facets(name).node_set for name in names]))
        return (3 * nodes[:, None] + np.arange(3)).ravel()

    def free(self, held: Array) -> Array:
        """Dofs that are not `held`. Raises `InputError` if none is held, or none is free."""
        free = np.setdiff1d(np.arange(self.size), held)
        if not len(free) or len(free) == self.size:
            raise InputError("large deflections: hold some dofs of the body, and not all; see `held`")
        return free

    def body_force(self, acceleration: Array | tuple[float, float, float]) -> Array:
        """Loads (3 n,) [N] of a uniform acceleration (3,) [m/s^2]."""
        return self.M @ np.tile(require_array(np.asarray(acceleration, float), "acceleration", (3,)), self.size // 3)

    def spread(self, name: str, force: Array | tuple[float, float, float]) -> Array:
        """Loads (3 n,) [N] of a dead `force` (3,) [N] spread evenly over a facet set."""
        share = np.zeros(self.size // 3)
        for kind, nodes in self.mesh.facets(name).blocks.items():
            np.add.at(share, nodes, facet_shares(kind, self.mesh.points[nodes])[0])
        return np.outer(share / share.sum(), require_array(np.asarray(force, float), "force", (3,))).ravel()

    def nearest_node(self, place: Array | tuple[float, float, float]) -> int:
        """The node nearest to `place` (3,) [m]."""
        return int(np.argmin(np.linalg.norm(self.mesh.points - np.asarray(place, float), axis=1)))
