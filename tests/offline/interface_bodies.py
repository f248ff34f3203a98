"""Small bodies with several interfaces that the tests of interfaces and bases share."""

from __future__ import annotations

import numpy as np
import scipy.sparse as sp
from offline_bodies import STEEL

from warpffrf.model.mesh import Mesh, roller
from warpffrf.offline.elastic import ElasticModel, free_model
from warpffrf.offline.fe import assemble, assign
from warpffrf.offline.interfaces import InterfaceSystem, body_interfaces


def box(counts: tuple[int, int, int], size: tuple[float, float, float]) -> Mesh:
    """hex8 block with one corner in the origin; facet sets `low` and `high` are its ends along z."""
    nx, ny, nz = counts
    grid = np.stack(np.meshgrid(*(np.linspace(0, s, n + 1) for n, s in zip(counts, size, strict=True)), indexing="ij"))
    points = grid.reshape(3, -1).T
    number = np.arange(len(points)).reshape(nx + 1, ny + 1, nz + 1)
    corners = [(0, 0, 0), (1, 0, 0), (1, 1, 0), (0, 1, 0), (0, 0, 1), (1, 0, 1), (1, 1, 1), (0, 1, 1)]
    cells = np.stack([number[i : i + nx, j : j + ny, k : k + nz].ravel() for i, j, k in corners], axis=1)
    bare = Mesh(points, {"hex8": cells})
    outer = bare.outer_facets()
    z = outer.centers(points)[:, 2]
    return Mesh(points, bare.cells, {"low": outer.kept(z < 1e-9), "high": outer.kept(z > size[2] - 1e-9)})


def two_bearing_roller(order: int = 1) -> Mesh:
    """A hollow roller about y with facet sets `left` and `right`, the ends of its bore, and `rim`."""
    mesh = roller(0.05, 0.015, 0.06, sectors=12, layers=2, axial=4, order=order)
    bore = mesh.facets("bore")
    y = bore.centers(mesh.points)[:, 1]
    return Mesh(
        mesh.points, mesh.cells, {**mesh.facet_sets, "left": bore.kept(y < -0.02), "right": bore.kept(y > 0.02)}
    )


def free_body(mesh: Mesh, kinds: dict[str, str]) -> tuple[ElasticModel, InterfaceSystem]:
    """The constrained model of a steel body with interfaces {facet set: kind}, as the general path builds it."""
    system = InterfaceSystem(mesh.points, body_interfaces(mesh, kinds))
    K, M = assemble(mesh.points, mesh.cells, assign(mesh, STEEL))
    T = system.T
    K, M = sp.csr_matrix(T.T @ K @ T), sp.csr_matrix(T.T @ M @ T)
    return free_model(K, M, system.rigid(mesh.points.mean(axis=0)), system.pinned, system.coordinates), system
