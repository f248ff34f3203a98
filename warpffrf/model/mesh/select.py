r"""Facet selection by geometry: on a plane, a cylinder or a sphere, in a box, or all that are reachable without
crossing an edge.

A facet lies on a surface where all its nodes (those in the middle of edges too) are within a tolerance of it and its
normal n is not far off the surface's normal m there, `|n . m| >= cos 60 degrees`: the end face of a coarse ring has all
its nodes on the cylinder, but not its normal. Distances:

    plane     (x - p) . n
    cylinder  |(x - p) - ((x - p) . a) a| - R
    sphere    |x - c| - R

The search starts at the facet nearest a seed point and crosses every edge whose dihedral angle, between the normals of
the two sides, is at most the given angle. Facets are split into triangles at their own nodes, so that a curved
quadratic facet bends within itself instead of at its edges.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace
from typing import TYPE_CHECKING, Any

import numpy as np

from warpffrf.model.errors import InputError, require_array, require_direction, require_number
from warpffrf.model.mesh.elements import facet_kind
from warpffrf.model.mesh.facets import FacetSet, triangles
from warpffrf.model.surfaces.fit import fit_revolution

if TYPE_CHECKING:
    from warpffrf.model.mesh.data import Mesh

# Of the diagonal of the bounding box: what coordinates written with 6 digits are off by, and far below any element.
ON_SURFACE = 1e-5
ALIGNED = 0.5  # cos 60 degrees: facets of a ring of 6 still lie along their cylinder, its end faces (0) do not
SEED_REACH = 0.1  # of the diagonal: a seed farther than this from every facet was given in another unit or frame

Array = np.ndarray


def plane(
    mesh: Mesh, name: str, *, point: Any, normal: Any, tolerance: float | None = None, from_set: str | None = None
) -> Mesh:
    """A new mesh with the facet set `name` on the plane through `point` (3,) [m] with `normal` (3,).

    `tolerance` [m] is the largest distance of a node, 1e-5 of the diagonal of the bounding box where None. `from_set`
    limits the search to a facet set; None: all outer facets. Raises `InputError` for a used name and for an
    empty selection, with the distance of the nearest facet.
    """
    label = f"select {name!r}"
    p = require_array(point, f"{label}: point", (3,))
    n = require_direction(normal, f"{label}: normal")
    return _on_surface(mesh, name, "plane", lambda x: ((x - p) @ n, np.broadcast_to(n, x.shape)), tolerance, from_set)


def cylinder(
    mesh: Mesh,
    name: str,
    *,
    axis_point: Any = None,
    axis_direction: Any = None,
    radius: float | None = None,
    tolerance: float | None = None,
    from_set: str | None = None,
) -> Mesh:
    """A new mesh with the facet set `name` on a circular cylinder; lengths in m.

    Axis and radius are fitted, where None, to the nodes of `from_set`, which must then be given: a set that is known
    to lie on the cylinder, at least for the most part. Other arguments and errors as for `plane`.
    """
    label = f"select {name!r}"
    source = _source(mesh, name, from_set)
    c = None if axis_point is None else require_array(axis_point, f"{label}: axis_point", (3,))
    a = None if axis_direction is None else require_direction(axis_direction, f"{label}: axis_direction")
    R = None if radius is None else require_number(radius, f"{label}: radius", positive=True)
    if c is None or a is None or R is None:
        if from_set is None:
            raise InputError(
                f"{label}: give axis_point, axis_direction and radius, or from_set to fit them to (select_feature "
                "makes such a set from one point on the surface)"
            )
        try:
            fit = fit_revolution(mesh.points[source.node_set], "cylinder", R, c, a, curvature=0.0)
        except InputError as error:
            raise InputError(f"{label} from {from_set!r}: {error}") from None
        c, a, R = fit.axis_point, fit.axis_direction, fit.radius

    def surface(x: Array) -> tuple[Array, Array]:
        radial = (x - c) - np.outer((x - c) @ a, a)
        rho = np.linalg.norm(radial, axis=1)
        return rho - R, radial / np.maximum(rho, np.finfo(float).tiny)[:, None]

    return _on_surface(mesh, name, "cylinder", surface, tolerance, from_set)


def sphere(
    mesh: Mesh, name: str, *, center: Any, radius: float, tolerance: float | None = None, from_set: str | None = None
) -> Mesh:
    """A new mesh with the facet set `name` on the sphere about `center` (3,) [m]; other arguments as for `plane`."""
    c = require_array(center, f"select {name!r}: center", (3,))
    R = require_number(radius, f"select {name!r}: radius", positive=True)

    def surface(x: Array) -> tuple[Array, Array]:
        distance = np.linalg.norm(x - c, axis=1)
        return distance - R, (x - c) / np.maximum(distance, np.finfo(float).tiny)[:, None]

    return _on_surface(mesh, name, "sphere", surface, tolerance, from_set)


def feature(mesh: Mesh, name: str, *, seed: Any, angle: float = 30.0, from_set: str | None = None) -> Mesh:
    """A new mesh with the facet set `name`: all facets reachable from the one nearest `seed` (3,) [m] without crossing
    an edge of more than `angle` [degrees].

    Raises `InputError` for a used name, an angle outside 0 to 180 and a seed far off the surface.
    """
    import trimesh
    from scipy.sparse import coo_matrix
    from scipy.sparse.csgraph import connected_components

    x = require_array(seed, f"select {name!r}: seed", (3,))
    limit = require_number(angle, f"select {name!r}: angle", positive=True)
    if limit >= 180.0:
        raise InputError(f"select {name!r}: angle must be below 180 degrees, got {limit:g}")
    source = _source(mesh, name, from_set)
    faces = triangles(source)
    # facet number of each triangle, in the same order
    per_facet = [np.full(len(nodes), len(facet_kind(kind).triangles)) for kind, nodes in source.blocks.items()]
    owner = np.repeat(np.arange(len(source)), np.concatenate(per_facet))
    surface = trimesh.Trimesh(vertices=mesh.points, faces=faces, process=False, validate=False)
    nearest = trimesh.triangles.closest_point(surface.triangles, np.broadcast_to(x, (len(faces), 3)))
    distance = np.linalg.norm(nearest - x, axis=1)
    start = int(np.argmin(distance))
    if not distance[start] <= SEED_REACH * _diagonal(mesh):
        raise InputError(
            f"select {name!r}: the seed {_place(x)} is {distance[start]:.3g} m away from the nearest facet, at "
            f"{_place(nearest[start])}; give a point on the surface, in m"
        )
    smooth = surface.face_adjacency_angles <= np.radians(limit)
    pairs = owner[surface.face_adjacency[smooth]]
    graph = coo_matrix((np.ones(len(pairs), dtype=np.int8), (pairs[:, 0], pairs[:, 1])), shape=(len(source),) * 2)
    label = connected_components(graph, directed=False)[1]
    return _with_set(mesh, name, source.kept(label == label[owner[start]]))


def box(mesh: Mesh, name: str, *, low: Any = -np.inf, high: Any = np.inf, from_set: str | None = None) -> Mesh:
    """A new mesh with the facet set `name`: the facets whose centres, the means of their corners, lie between the
    corners `low` and `high` (3,) [m] of a box along the axes, -inf and inf for no limit.

    Raises `InputError` for a used name and for an empty selection, with the box around the centres.
    """
    ends = []
    for label, value in (("low", low), ("high", high)):
        try:
            ends.append(np.broadcast_to(np.asarray(value, dtype=np.float64), 3))
        except (TypeError, ValueError):
            raise InputError(f"select {name!r}: {label} must be three numbers, got {value!r}") from None
    source = _source(mesh, name, from_set)
    centers = source.centers(mesh.points)
    keep = np.all((centers >= ends[0]) & (centers <= ends[1]), axis=1)
    if not keep.any():
        where = "outer facet" if from_set is None else f"facet of {from_set!r}"
        raise InputError(
            f"select {name!r}: the centre of no {where} lies in the box; they lie between {_place(centers.min(axis=0))}"
            f" and {_place(centers.max(axis=0))}; correct low and high"
        )
    return _with_set(mesh, name, source.kept(keep))


def _on_surface(
    mesh: Mesh,
    name: str,
    what: str,
    surface: Callable[[Array], tuple[Array, Array]],
    tolerance: float | None,
    from_set: str | None,
) -> Mesh:
    """Keep the facets on `surface`, a function points (n, 3) -> distances (n,) [m] and unit normals (n, 3)."""
    source = _source(mesh, name, from_set)
    if tolerance is None:
        limit = ON_SURFACE * _diagonal(mesh)
    else:
        limit = require_number(tolerance, f"select {name!r}: tolerance", positive=True)
    centers = source.centers(mesh.points)
    aligned = np.abs(np.sum(_normals(mesh.points, source) * surface(centers)[1], axis=1)) >= ALIGNED
    used = source.node_set
    of_node = np.zeros(len(mesh.points))
    of_node[used] = np.abs(surface(mesh.points[used])[0])
    distance = np.concatenate([of_node[nodes].max(axis=1) for nodes in source.blocks.values()])
    keep = (distance <= limit) & aligned
    if not keep.any():
        along = np.flatnonzero(aligned)
        if not len(along):
            near = "no facet lies along it"
        else:
            first = int(along[np.argmin(distance[along])])
            near = (
                f"the nearest one along it, at {_place(centers[first])}, has a node {distance[first]:.3g} m away "
                f"(tolerance {limit:.3g} m)"
            )
        where = "outer facet" if from_set is None else f"facet of {from_set!r}"
        raise InputError(f"select {name!r}: no {where} lies on the {what}; {near}; correct it or raise tolerance")
    return _with_set(mesh, name, source.kept(keep))


def _source(mesh: Mesh, name: str, from_set: str | None) -> FacetSet:
    """The facets to choose from; the new name must be free."""
    if name in mesh.facet_sets.keys():
        raise InputError(f"mesh: facet set {name!r} exists already, choose another name")
    source = mesh.outer_facets() if from_set is None else mesh.facets(from_set)
    if not len(source):
        raise InputError(f"select {name!r}: the mesh has no facets to choose from")
    return source


def _with_set(mesh: Mesh, name: str, facets: FacetSet) -> Mesh:
    return replace(mesh, facet_sets={**mesh.facet_sets, name: facets})


def _normals(points: Array, facets: FacetSet) -> Array:
    """Unit normals (m, 3) from the corners, half the cross product of the diagonals; zero for a degenerate facet."""
    parts = [np.zeros((0, 3))]
    for corners in facets.corners.values():
        x = points[corners]
        first = x[:, 2] - x[:, 0]
        parts.append(np.cross(first, x[:, 3] - x[:, 1]) if x.shape[1] == 4 else np.cross(x[:, 1] - x[:, 0], first))
    n = np.concatenate(parts)
    return n / np.maximum(np.linalg.norm(n, axis=1), np.finfo(float).tiny)[:, None]


def _diagonal(mesh: Mesh) -> float:
    return float(np.linalg.norm(np.ptp(mesh.points, axis=0)))


def _place(x: Array) -> str:
    return "(" + ", ".join(f"{c:.4g}" for c in x) + ") m"
