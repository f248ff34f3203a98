"""The cyclic reduction called directly, and the same operators by brute force on the whole mesh."""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np
from offline_bodies import STEEL
from reference_fe import free_response

from warpffrf.model.mesh import FacetSet, Mesh, roller
from warpffrf.model.mesh.facets import rigid_modes
from warpffrf.model.reduced.contact_surface import Tangential
from warpffrf.model.surfaces import Cylinder
from warpffrf.offline.contact.node_loads import NORMAL, TANGENTIAL, ContactFacets, TractionField
from warpffrf.offline.cyclic.path import axes_of, reduce_cyclic
from warpffrf.offline.cyclic.sector import assemble_sector
from warpffrf.offline.cyclic.surface import CyclicSurface, FacetPattern, facet_pattern
from warpffrf.offline.fe import assemble, assign
from warpffrf.offline.interfaces import rigid_interfaces
from warpffrf.offline.products import Limits, SurfaceProduct, choose_path, resolve_shapes
from warpffrf.offline.progress import Progress


def relative(a, b) -> float:
    return float(np.abs(a - b).max() / np.abs(b).max())


def split_hexahedra(mesh: Mesh, chosen) -> Mesh:
    """Some cells of a linear roller as two wedges each, with triangles on rim and bore: facets of both kinds."""
    cells = mesh.cells["hex8"]
    picked = chosen(mesh.points[cells].mean(axis=1))
    h = cells[picked]
    # (xi, eta, zeta) = (r, theta, y): the faces xi = -1, 1 are 0 3 7 4 and 1 2 6 5, cut along 0 7 and 1 6
    wedges = np.stack([h[:, [0, 3, 7, 1, 2, 6]], h[:, [0, 7, 4, 1, 6, 5]]], axis=1).reshape(-1, 6)
    faces = {}
    for name, (tri, quad) in {"rim": (wedges[:, 3:], [1, 2, 6, 5]), "bore": (wedges[:, :3], [0, 3, 7, 4])}.items():
        nodes = mesh.facets(name).node_set
        tri = tri[np.isin(tri, nodes).all(axis=1)]
        rest = cells[~picked][:, quad]
        faces[name] = FacetSet({"quad4": rest[np.isin(rest, nodes).all(axis=1)], "tri3": tri})
    return Mesh(mesh.points, {"hex8": cells[~picked], "wedge6": wedges}, faces, mesh.cyclic)


def mixed_roller(sectors=12) -> Mesh:
    mesh = roller(0.05, 0.02, 0.03, sectors=sectors, layers=2, axial=2, order=1)
    return split_hexahedra(mesh, lambda centers: centers[:, 1] < 0.0)


def sector_of(mesh):
    """Sector 0 of a steel body."""
    return assemble_sector(mesh, assign(mesh, STEEL), axes_of(mesh))


def cyclic_product(mesh, *, name="rim", shape=None, interfaces=(), modes=None, spacing=None, **settings):
    """What `reduce_cyclic` returns for one contact surface, and the resolved shape."""
    resolved = resolve_shapes(mesh, {name: Cylinder() if shape is None else shape})
    choice = choose_path(mesh, list(interfaces), resolved)
    assert choice.patterns is not None, choice.reason
    surfaces = [(name, resolved[name], choice.patterns[name])]
    rigid = rigid_interfaces(mesh, list(interfaces))
    limits = Limits(modes, None)
    given = (mesh, assign(mesh, STEEL), rigid, surfaces, limits, {name: spacing}, Progress(False))
    return reduce_cyclic(*given, **settings), resolved[name]


def the_surface(product) -> tuple[SurfaceProduct, Tangential]:
    """The only contact surface, and its tangential part."""
    (s,) = product.surfaces
    assert isinstance(s, SurfaceProduct) and s.tangential is not None
    return s, s.tangential


@dataclass
class Whole:
    """Operators of the whole grid by brute force, functions numbered by direction, column, row: free body, no global
    modes."""

    fields: list[TractionField]
    D: list[list[np.ndarray]]
    responses: list[np.ndarray]  # (3 n, count) displacement under unit forces
    loads: list[np.ndarray]


def whole_operators(mesh, shape, plan, kinds, name="rim") -> Whole:
    """Fields of `kinds` (normal, tangential) on all facets of the set, and the dense response of the free body."""
    facets = ContactFacets.of(mesh.points, mesh.facets(name), shape)
    fields = [
        TractionField(kind, directions, plan, facets)
        for kind, directions in zip(kinds, (NORMAL, TANGENTIAL), strict=False)
    ]
    K, M = assemble(mesh.points, mesh.cells, assign(mesh, STEEL))
    loads = [field.loads(len(mesh.points)).toarray() for field in fields]
    R = rigid_modes(mesh.points, mesh.points.mean(axis=0))
    u = [free_response(K.toarray(), M.toarray(), R, B) for B in loads]
    D = [
        [g.without_gram((f.without_gram(B.T @ v)).T).T for g, v in zip(fields, u, strict=True)]
        for f, B in zip(fields, loads, strict=True)
    ]
    responses = [f.without_gram(v.T).T for f, v in zip(fields, u, strict=True)]
    return Whole(fields, D, responses, loads)


def plan_of(mesh, shape, *, name="rim", spacing=None):
    """The columns and rows of the cyclic path's grid on the full turn, and its surface."""
    pattern = facet_pattern(mesh, name)
    assert isinstance(pattern, FacetPattern)
    surface = CyclicSurface(mesh, sector_of(mesh), name, shape, pattern, spacing)
    plan, q = surface.plan, surface.stride
    coarse = replace(plan, pitch=plan.pitch * q, columns=plan.columns // q, nodal=plan.nodal and q == 1)
    return coarse, surface
