"""Meshes of the package in scikit-fem: shape functions, linear matrices, loads on facets, in our numbering.

Dofs are 3 node + component, node numbers those of the mesh.
"""

from __future__ import annotations

from typing import Any

import numpy as np
import scipy.sparse as sp
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

from warpffrf.model.errors import unknown_name
from warpffrf.model.material import Material
from warpffrf.model.mesh import Mesh
from warpffrf.model.mesh.elements import cell_kind, facet_kind

Array = np.ndarray
Sparse = Any  # scipy.sparse
# of each kind of cell: element, straight mesh, mesh of its own nodes, degree of quadrature (along an axis of hexahedra)
KINDS: dict[str, tuple[Any, Any, Any, int]] = {
    "hex8": (ElementHex1, MeshHex, None, 3),
    "hex27": (ElementHex2, MeshHex, MeshHex2, 5),
    "tet4": (ElementTetP1, MeshTet, None, 2),
    "tet10": (ElementTetP2, MeshTet, MeshTet2, 4),
}
GAUSS = 3  # points per direction of a quadrilateral: exact for products of quadratic functions
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


def scalar_basis(mesh: Mesh) -> tuple[Basis, Array]:
    """The shape functions of a mesh of one kind of cells, at its quadrature points, and the mesh's node number (n,) of
    each of scikit-fem's dofs.

    Raises `InputError` for kinds of cells that are not supported here.
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
    return Basis(flat, element(), intorder=degree), node


def matrices(mesh: Mesh, material: Material) -> tuple[Sparse, Sparse]:
    """K [N/m] and M [kg] (3 n, 3 n) csr of a mesh of one kind of cells.

    Raises `InputError` for kinds of cells that are not supported here.
    """
    scalar, node = scalar_basis(mesh)
    basis = Basis(scalar.mesh, ElementVector(scalar.elem), intorder=KINDS[mesh.single[0]][3])
    number = scalar.element_dofs
    dof = np.empty(basis.N, dtype=np.int64)
    for local in range(3 * len(number)):  # of a cell: node after node, their three components
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
