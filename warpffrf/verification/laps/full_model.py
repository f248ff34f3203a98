r"""Bodies by full finite elements of scikit-fem, in the numbering of their meshes, with supports, loads and springs.

Dofs are 3 (offset of the body + node) + component, body after body. A load that is spread evenly over a set of facets
is a vector a of nodal forces int N dA/A; a^T u is then the mean displacement of the set, and a spring of stiffness k on
the difference of two such means is K + k a a^T.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from functools import cached_property
from typing import Any

import numpy as np
import scipy.sparse as sp
from scipy.sparse.linalg import splu
from skfem import (
    Basis,
    BilinearForm,
    ElementHex1,
    ElementHex2,
    ElementTetP1,
    ElementTetP2,
    ElementVector,
    MeshHex,
    MeshHex2,
    MeshTet,
    MeshTet2,
)
from skfem.helpers import dot
from skfem.models.elasticity import linear_elasticity

from warpffrf.model.errors import InputError, require_array, unknown_name
from warpffrf.model.material import Material
from warpffrf.model.mesh import Mesh
from warpffrf.model.mesh.elements import cell_kind, facet_kind
from warpffrf.model.mesh.rigid import rigid_modes

Array = np.ndarray
Sparse = Any  # scipy.sparse
# of each kind of cell: element, straight mesh, mesh of its own nodes, degree of quadrature (along an axis of hexahedra)
KINDS: dict[str, tuple[Any, Any, Any, int]] = {
    "hex8": (ElementHex1, MeshHex, None, 3),
    "hex27": (ElementHex2, MeshHex, MeshHex2, 5),
    "tet4": (ElementTetP1, MeshTet, None, 2),
    "tet10": (ElementTetP2, MeshTet, MeshTet2, 4),
}
HELD = 1e-9  # of the largest entry of K: what a rigid motion must feel at least; round-off is 1e-14
GAUSS = 3  # points a direction of a quadrilateral: exact for products of quadratic functions
# of the unit triangle: exact to the fourth degree (Dunavant 1985)
TRIANGLE = (
    np.array(
        [
            [0.445948490915965, 0.445948490915965],
            [0.108103018168070, 0.445948490915965],
            [0.445948490915965, 0.108103018168070],
            [0.091576213509771, 0.091576213509771],
            [0.816847572980459, 0.091576213509771],
            [0.091576213509771, 0.816847572980459],
        ]
    ),
    np.array([0.223381589678011] * 3 + [0.109951743655322] * 3) / 2.0,
)


def matrices(mesh: Mesh, material: Material) -> tuple[Sparse, Sparse]:
    """K [N/m] and M [kg] (3 n, 3 n) csr of a mesh of one kind of cells, dof 3 node + component.

    Raises `InputError` for kinds of cells that scikit-fem is not asked for here.
    """
    kind, cells = mesh.single
    if kind not in KINDS:
        raise unknown_name("full model: kind of cells", kind, KINDS)
    element, straight, curved, degree = KINDS[kind]
    shape = cell_kind(kind)
    corners, vertices = np.unique(cells[:, : shape.corner_count], return_inverse=True)
    unit = 0.5 * (shape.nodes + 1.0) if shape.domain == "hex" else shape.nodes
    ours = [int(np.argmin(np.linalg.norm(unit - place, axis=1))) for place in element().doflocs]
    vertices = vertices.reshape(len(cells), -1)
    flat = straight(
        np.ascontiguousarray(mesh.points[corners].T), np.ascontiguousarray(vertices[:, ours[: shape.corner_count]].T)
    )
    number = Basis(flat, element()).element_dofs  # (k, cells) of scikit-fem's own nodes
    node = np.empty(number.max() + 1, dtype=np.int64)
    node[number] = cells[:, ours].T
    if curved is not None:
        flat = curved(np.ascontiguousarray(mesh.points[node].T), flat.t)
    basis = Basis(flat, ElementVector(element()), intorder=degree)
    dof = np.empty(basis.N, dtype=np.int64)
    k = len(number)
    for local in range(3 * k):  # of a cell: node after node, their three components
        dof[basis.element_dofs[local]] = 3 * node[number[local // 3]] + local % 3
    density = material.density
    stiffness = linear_elasticity(*material.lame).assemble(basis)
    mass = BilinearForm(lambda u, v, w: density * dot(u, v)).assemble(basis)
    to_mesh = sp.csr_matrix((np.ones(basis.N), (dof, np.arange(basis.N))), shape=(3 * len(mesh.points), basis.N))
    return tuple(sp.csr_matrix(to_mesh @ A @ to_mesh.T) for A in (stiffness, mass))  # type: ignore[return-value]


def facet_shares(kind: str, x: Array) -> tuple[Array, Array]:
    """int N_a dA (m, k) [m2] and int n dA (m, 3) [m2] of facets of `kind` with nodes x (m, k, 3) [m]."""
    shape = facet_kind(kind)
    if shape.domain == "quad":
        g, w = np.polynomial.legendre.leggauss(GAUSS)
        a, b = (v.ravel() for v in np.meshgrid(g, g, indexing="ij"))
        xi, weight = np.stack([a, b], axis=1), np.outer(w, w).ravel()
    else:
        xi, weight = TRIANGLE
    N, dN = shape.shape(xi)
    along = np.einsum("mkx,qkd->mqdx", x, dN)
    normal = np.cross(along[:, :, 0], along[:, :, 1])
    return np.einsum("q,mq,qk->mk", weight, np.linalg.norm(normal, axis=2), N), np.einsum("q,mqx->mx", weight, normal)


@dataclass(frozen=True, eq=False)
class Part:
    """A body of the model: mesh (in the frame that all share), material, facet sets that are held."""

    mesh: Mesh
    material: Material
    held: tuple[str, ...] = ()


@dataclass(frozen=True, eq=False)
class FullModel:
    """Bodies side by side; `springs`: pairs of a vector a (dofs,) and a stiffness k [N/m], see the module docstring.

    Raises `InputError` for sets that a mesh does not have.
    """

    parts: Sequence[Part]
    springs: tuple[tuple[Array, float], ...] = ()

    @cached_property
    def offsets(self) -> Array:
        """First node of each body, and the number of all nodes."""
        return np.concatenate([[0], np.cumsum([len(p.mesh.points) for p in self.parts])])

    @property
    def size(self) -> int:
        """Number of dofs, held ones included."""
        return 3 * int(self.offsets[-1])

    @cached_property
    def points(self) -> Array:
        """All nodes (n, 3) [m]."""
        return np.concatenate([p.mesh.points for p in self.parts])

    @cached_property
    def _matrices(self) -> tuple[Sparse, Sparse]:
        K, M = zip(*(matrices(p.mesh, p.material) for p in self.parts), strict=True)
        return sp.csr_matrix(sp.block_diag(K)), sp.csr_matrix(sp.block_diag(M))

    @cached_property
    def K(self) -> Sparse:
        """Stiffness (dofs, dofs) [N/m], springs included."""
        K = self._matrices[0]
        for a, k in self.springs:
            column = sp.csr_matrix(a[:, None])
            K = K + k * (column @ column.T)
        return sp.csr_matrix(K)

    @property
    def M(self) -> Sparse:
        """Mass (dofs, dofs) [kg]."""
        return self._matrices[1]

    @cached_property
    def free(self) -> Array:
        """Dofs that are not held."""
        held = [
            self.offsets[i] + part.mesh.facets(name).node_set for i, part in enumerate(self.parts) for name in part.held
        ]
        fixed = np.unique(np.concatenate([np.zeros(0, dtype=np.int64), *held]))
        return np.setdiff1d(np.arange(self.size), (3 * fixed[:, None] + np.arange(3)).ravel())

    def factor(self, A: Sparse) -> Any:
        """Solver of free dofs with the symmetric definite A (dofs, dofs): an object with `solve(F)`."""
        block = sp.csc_matrix(A[self.free][:, self.free])
        return splu(block, permc_spec="MMD_AT_PLUS_A", diag_pivot_thresh=0.0, options={"SymmetricMode": True})

    @cached_property
    def _static(self) -> Any:
        for i, part in enumerate(self.parts):
            if not part.held:
                self._require_springs(i, part)
        return self.factor(self.K)

    def _require_springs(self, i: int, part: Part) -> None:
        """Raises `InputError` where springs do not hold a body that nothing else holds."""
        x = part.mesh.points
        R = rigid_modes(x, x.mean(axis=0))
        R[:, 3:] /= np.ptp(x, axis=0).max()  # rotations times a length are displacements
        dofs = slice(3 * int(self.offsets[i]), 3 * int(self.offsets[i + 1]))
        held = np.linalg.eigvalsh(R.T @ (self.K[dofs, dofs] @ R))[0]
        if held < HELD * abs(self.K[dofs, dofs]).max():
            raise InputError(
                f"full model: nothing holds body {i} ({part.mesh.name or 'unnamed'}) against all rigid motions; hold a "
                "facet set of it, or add springs"
            )

    def solve(self, F: Any) -> Array:
        """K^-1 F (dofs, m) with the supports; F (dofs, m), dense or sparse."""
        F = F.toarray() if sp.issparse(F) else np.asarray(F, dtype=float)
        U = np.zeros(F.shape)
        U[self.free] = self._static.solve(np.ascontiguousarray(F[self.free]))
        return U

    def spread(self, part: int, name: str, direction: Any) -> Array:
        """a (dofs,): the force `direction` (3,) [N] spread evenly over a facet set of a body."""
        vector = require_array(direction, f"load on {name!r}", (3,))
        mesh = self.parts[part].mesh
        share = np.zeros(len(mesh.points))
        for kind, nodes in mesh.facets(name).blocks.items():
            np.add.at(share, nodes, facet_shares(kind, mesh.points[nodes])[0])
        a = np.zeros((int(self.offsets[-1]), 3))
        a[self.offsets[part] : self.offsets[part + 1]] = share[:, None] / share.sum() * vector
        return a.ravel()

    def body_force(self, acceleration: Any) -> Array:
        """Loads (dofs,) [N] of a uniform acceleration (3,) [m/s2] of all bodies."""
        field = np.tile(require_array(acceleration, "acceleration", (3,)), int(self.offsets[-1]))
        return self.M @ field

    def with_springs(self, *springs: tuple[Array, float]) -> FullModel:
        """The same with more springs. Raises `InputError` for a stiffness that is not positive."""
        for _, k in springs:
            if not k > 0.0:
                raise InputError(f"full model: the stiffness of a spring must be positive, got {k:g}")
        return replace(self, springs=(*self.springs, *springs))
