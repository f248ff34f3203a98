"""Resolve contact shapes on their facets, and choose the cyclic or the general path."""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import Any

import numpy as np

from warpffrf.model.errors import InputError
from warpffrf.model.mesh import Mesh
from warpffrf.model.surfaces import (
    Bore,
    Cone,
    ConicalBore,
    CrownedCylinder,
    Cup,
    Cylinder,
    Groove,
    Plane,
    Ring,
    Sphere,
)
from warpffrf.offline.contact.contact_grid import largest_radius
from warpffrf.offline.cyclic.sector import periodicity_fault
from warpffrf.offline.cyclic.surface import FacetPattern, facet_pattern
from warpffrf.offline.fe.materials import Assignment

COAXIAL = 1e-9  # of the radius: a shape this close to the axis of periodicity turns into itself, far below any gap
# What is tried where no shape is given. A plane comes first, since a cylinder of a huge radius fits it too, a sphere
# before the crowns that it is one of.
PLAIN_SHAPES = (Plane, Cylinder, Bore, Sphere, Cup, CrownedCylinder, Ring, Groove, Cone, ConicalBore)
STRAIGHT = (Cylinder.kind, Bore.kind)  # no place along the axis to be fitted
TAPERED = (Cone.kind, ConicalBore.kind)  # place and radius are one unknown
LEAST_SECTORS = 3  # harmonics 0 and 1 must differ from each other and from N/2 for the rigid motions to separate


@dataclass(frozen=True)
class PathChoice:
    """Shapes by set; facet patterns for the cyclic path, None for the general one; and the reason."""

    shapes: dict[str, Any]
    patterns: dict[str, FacetPattern] | None
    reason: str


def resolve_shapes(mesh: Mesh, shapes: dict[str, Any]) -> dict[str, Any]:
    """Fit what is open in each shape to the nodes of its facet set; None: the first of `PLAIN_SHAPES` that fits.

    Raises `InputError` naming the set where it does not fit, or where the facets look to the side of the material.
    """
    resolved = {}
    for name, shape in shapes.items():
        facets = mesh.facets(name)
        points, normals = mesh.points[facets.node_set], facets.node_normals(mesh.points)
        try:
            resolved[name] = _any(mesh, points, normals) if shape is None else _fitted(mesh, shape, points, normals)
        except InputError as error:
            raise InputError(f"contact {name!r}: {error}") from None
    return resolved


def _fitted(mesh: Mesh, shape: Any, points: np.ndarray, normals: np.ndarray) -> Any:
    return _oriented(mesh, shape).fitted(points, normals)


def _oriented(mesh: Mesh, shape: Any) -> Any:
    """The shape with the mesh's axis of periodicity where its own direction is to be fitted: it is known exactly, and a
    straight profile has its whole axis from it."""
    if mesh.cyclic is None or getattr(shape, "axis_direction", "none of its own") is not None:
        return shape
    candidate = replace(shape, axis_direction=mesh.cyclic.axis_direction)
    straight = shape.kind in STRAIGHT or (shape.kind in TAPERED and shape.radius is None)
    if shape.axis_point is None and straight:
        candidate = replace(candidate, axis_point=mesh.cyclic.axis_point)
    return candidate


def _any(mesh: Mesh, points: np.ndarray, normals: np.ndarray) -> Any:
    """The first of `PLAIN_SHAPES` that the nodes lie on and whose free side the facets look to."""
    for shape in PLAIN_SHAPES:
        try:
            return _fitted(mesh, shape(), points, normals)
        except InputError:
            continue
    names = ", ".join(shape.kind for shape in PLAIN_SHAPES)
    raise InputError(f"the facets do not fit any of the shapes {names}; give a shape, or choose other facets")


def choose_path(
    mesh: Mesh,
    interface_sets: list[str],
    shapes: dict[str, Any],
    assignment: Assignment | None = None,
    reason: str | None = None,
) -> PathChoice:
    """Cyclic where mesh, interfaces and surfaces repeat from sector to sector, else general; never silently.

    `reason`: why the general path is taken in any case; None where it need not be.
    """
    fault = reason or periodicity_fault(mesh, interface_sets, assignment)
    patterns: dict[str, FacetPattern] = {}
    if fault is None and mesh.cyclic is not None:
        if mesh.cyclic.sectors < LEAST_SECTORS:
            fault = f"fewer than {LEAST_SECTORS} sectors"
        for name, shape in shapes.items():
            found = facet_pattern(mesh, name)
            if isinstance(found, str):
                fault = found
                break
            patterns[name] = found
            fault = fault or _axis_fault(mesh, name, shape)
    if fault is not None:
        return PathChoice(shapes, None, fault)
    return PathChoice(shapes, patterns, "mesh, interfaces and contact surfaces repeat from sector to sector")


def _axis_fault(mesh: Mesh, name: str, shape: Any) -> str | None:
    if mesh.cyclic is None:
        return "the mesh is not marked as rotationally periodic"
    if shape.profile().planar:
        return f"contact surface {name!r} is a plane, which no turn about an axis maps onto its next sector"
    axis = mesh.cyclic.axis_direction
    radius = largest_radius(shape, shape.chart(mesh.points[mesh.facets(name).node_set])[1])
    offset = shape.axis_point - mesh.cyclic.axis_point
    offset = offset - np.dot(offset, axis) * axis
    tilt = np.linalg.norm(shape.e_a - axis)
    if np.linalg.norm(offset) > COAXIAL * radius or tilt > COAXIAL:
        return f"the axis of contact surface {name!r} is not the axis of periodicity (or points the other way)"
    return None
