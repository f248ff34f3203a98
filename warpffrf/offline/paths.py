"""Resolve contact shapes on their facets, and choose the cyclic or the general path."""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import Any

import numpy as np

from warpffrf.model.errors import InputError
from warpffrf.model.mesh import Mesh
from warpffrf.model.surfaces import CrownedCylinder, Cylinder
from warpffrf.offline.cyclic.sector import periodicity_fault
from warpffrf.offline.cyclic.surface import FacetPattern, facet_pattern
from warpffrf.offline.fe.materials import Assignment

COAXIAL = 1e-9  # of the radius: a shape this close to the axis of periodicity turns into itself, far below any gap
LEAST_SECTORS = 3  # harmonics 0 and 1 must differ from each other and from N/2 for the rigid motions to separate


@dataclass(frozen=True)
class PathChoice:
    """Shapes by set; facet patterns for the cyclic path, None for the general one; and the reason."""

    shapes: dict[str, Any]
    patterns: dict[str, FacetPattern] | None
    reason: str


def resolve_shapes(mesh: Mesh, shapes: dict[str, Any]) -> dict[str, Any]:
    """Fit what is open in each shape to the nodes of its facet set. Raises `InputError` naming the set where it does
    not fit."""
    resolved = {}
    for name, shape in shapes.items():
        points = mesh.points[mesh.facets(name).node_set]
        try:
            resolved[name] = _any_shape(points) if shape is None else _oriented(mesh, shape).fitted(points)
        except InputError as error:
            raise InputError(f"contact {name!r}: {error}") from None
    return resolved


def _oriented(mesh: Mesh, shape: Any) -> Any:
    """The shape with the mesh's axis of periodicity where its own direction is to be fitted: it is known exactly."""
    if mesh.cyclic is None or shape.axis_direction is not None:
        return shape
    candidate = replace(shape, axis_direction=mesh.cyclic.axis_direction)
    if shape.axis_point is None and isinstance(shape, Cylinder) and shape.kind == Cylinder.kind:
        candidate = replace(candidate, axis_point=mesh.cyclic.axis_point)
    return candidate


def _any_shape(points: np.ndarray) -> Any:
    try:
        return Cylinder().fitted(points)
    except InputError:
        return CrownedCylinder().fitted(points)


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
    axis = mesh.cyclic.axis_direction
    radius = float(shape.radius_at(0.0))
    offset = shape.axis_point - mesh.cyclic.axis_point
    offset = offset - np.dot(offset, axis) * axis
    tilt = np.linalg.norm(shape.e_a - axis)
    if np.linalg.norm(offset) > COAXIAL * radius or tilt > COAXIAL:
        return f"the axis of contact surface {name!r} is not the axis of periodicity (or points the other way)"
    return None
