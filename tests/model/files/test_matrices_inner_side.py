"""Facets of a body that comes as matrices, against the body: K shows which side of a facet is inside."""

from __future__ import annotations

from functools import cache
from typing import Any

import numpy as np
import pytest
from scipy.sparse import coo_matrix

from warpffrf.model import mesh as wfmesh
from warpffrf.model.errors import InputError
from warpffrf.model.mesh import FacetSet, Mesh
from warpffrf.model.mesh.elements import CELL_KINDS, cell_kind
from warpffrf.model.mesh.files.matrices.inner_side import require_on_surface

# a hexahedron's corners as six tetrahedra around one diagonal
TETRAHEDRA = np.array([[0, 1, 2, 6], [0, 2, 3, 6], [0, 3, 7, 6], [0, 7, 4, 6], [0, 4, 5, 6], [0, 5, 1, 6]])


@cache
def ring(kind: str) -> Mesh:
    """A ring with a bore, of hexahedra or tetrahedra: convex, concave and flat surfaces."""
    mesh = wfmesh.roller(0.05, 0.015, 0.02, sectors=8, layers=2, axial=2, order=2 if kind == "hex27" else 1)
    nodes = mesh.single[1]
    if kind == "tet4":
        nodes = nodes[:, TETRAHEDRA].reshape(-1, 4)
    return Mesh(mesh.points, {kind: nodes})


def coupling(mesh: Mesh) -> Any:
    """A matrix (3n, 3n) with the pattern of K: ones where two nodes have a cell in common."""
    kind, nodes = mesh.single
    dofs = (3 * nodes[:, :, None] + np.arange(3)).reshape(len(nodes), -1)
    i, j = (np.broadcast_to(d, (*dofs.shape, dofs.shape[1])) for d in (dofs[:, :, None], dofs[:, None, :]))
    size = 3 * len(mesh.points)
    return coo_matrix((np.ones(i.size), (i.ravel(), j.ravel())), shape=(size, size)).tocsr()


@pytest.mark.parametrize("kind", ["hex8", "hex27", "tet4"])
def test_outward_facets_pass_and_inward_ones_do_not(kind: str) -> None:
    mesh = ring(kind)
    K = coupling(mesh)
    outer = mesh.outer_facets()
    facet, nodes = outer.single
    radius = np.hypot(*outer.centers(mesh.points)[:, [0, 2]].T)
    for part in (nodes, nodes[radius < 0.016], nodes[radius > 0.045], *(nodes[i : i + 1] for i in range(len(nodes)))):
        require_on_surface(K, FacetSet({facet: part}), mesh.points, "facets 'part'")
    turned = {"quad4": [0, 3, 2, 1], "quad9": [0, 3, 2, 1, 7, 6, 5, 4, 8], "tri3": [0, 2, 1]}[facet]
    for i in range(0, len(nodes), 7):
        with pytest.raises(InputError, match="facets 'part': the normals point into the body; reverse the order"):
            require_on_surface(K, FacetSet({facet: nodes[i : i + 1, turned]}), mesh.points, "facets 'part'")


@pytest.mark.parametrize("kind", ["hex8", "hex27", "tet4"])
def test_facets_inside_the_body_or_of_no_cell_are_refused(kind: str) -> None:
    mesh = ring(kind)
    K = coupling(mesh)
    facet, outer = mesh.outer_facets().single
    local = cell_kind(kind).faces[facet]
    every = mesh.single[1][:, local].reshape(-1, local.shape[1])
    known = {tuple(row) for row in np.sort(outer, axis=1).tolist()}
    inner = every[[tuple(row) not in known for row in np.sort(every, axis=1).tolist()]]
    assert kind in CELL_KINDS and len(inner)
    with pytest.raises(InputError, match="on both sides of them; choose facets on the surface"):
        require_on_surface(K, FacetSet({facet: inner}), mesh.points, "facets 'inner'")
    odd = outer.copy()
    odd[3, 0] = odd[-1, 0]
    with pytest.raises(InputError, match="1 .* facet.s. are no face of a cell, .* the first is number 3 with corners"):
        require_on_surface(K, FacetSet({facet: odd}), mesh.points, "facets 'odd'")


def test_a_dense_matrix_says_nothing() -> None:
    """A condensed K, every node coupled with every other, is taken as it is."""
    n = 1200
    points = np.random.default_rng(2).uniform(size=(n, 3))
    from warpffrf.model.mesh.files.matrices import inner_side

    K = np.ones((9, 3 * n))
    rows = coo_matrix((K.ravel(), np.indices(K.shape).reshape(2, -1)), shape=(3 * n, 3 * n)).tocsr()
    assert n > inner_side.LONGEST_ROW
    require_on_surface(rows, FacetSet({"tri3": np.array([[0, 1, 2]])}), points, "facets 'a'")
