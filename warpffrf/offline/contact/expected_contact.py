"""The contact grid of each surface where an expected half-width is given instead of a spacing."""

from __future__ import annotations

from dataclasses import replace
from typing import Any

import numpy as np

from warpffrf.model.mesh import Mesh
from warpffrf.model.reduced.contact_grid import ContactGrid
from warpffrf.offline.contact.contact_grid import largest_radius, nodal_plan
from warpffrf.offline.contact.grid_rule import GridChoice, choose_spacing, grid_error
from warpffrf.offline.contact.mesh_error import line_mesh_error, touched_in_lines
from warpffrf.offline.contact.traction_fields import ContactFacets
from warpffrf.offline.settings import Settings


def expected_grids(mesh: Mesh, shapes: dict[str, Any], settings: Settings) -> dict[str, GridChoice]:
    """The rule's choice by surface; empty where no half-width is expected. A surface that is curved in both directions,
    or a plane, on which anything may lie, is touched in an ellipse; one with a straight or a slightly profiled meridian
    along a line."""
    if settings.expected_half_width is None:
        return {}
    return {
        name: choose_spacing(
            settings.expected_half_width,
            _finest(mesh, name, shape),
            error=settings.contact_error,
            patch=_patch(shape),
            traction=settings.traction,
        )
        for name, shape in shapes.items()
    }


def _patch(shape: Any) -> str:
    return "line" if touched_in_lines(shape) else "ellipse"


def _finest(mesh: Mesh, name: str, shape: Any) -> float:
    """Spacing [m] that the surface mesh can carry: the distance of its nodes where they form a grid, else its longest
    facet edge."""
    chart = ContactFacets.of(mesh.points, mesh.facets(name), shape).chart
    plan = nodal_plan(chart, name)
    return chart.edge if plan is None else plan.pitch * largest_radius(shape, plan.z)


def spacings(mesh: Mesh, shapes: dict[str, Any], settings: Settings, chosen: dict[str, GridChoice]) -> dict[str, Any]:
    """Spacing [m] by surface, None for the mesh's own grid.

    Columns divide a sector of a periodic mesh evenly; where one is wider than the spacing, the spacing is rounded down
    to do so, since rounding up could double it.
    """
    found = {}
    for name, shape in shapes.items():
        spacing = settings.traction_spacing
        if name in chosen:
            spacing = None if chosen[name].limited_by_mesh else chosen[name].spacing
        if name in chosen and spacing is not None and mesh.cyclic is not None and not shape.profile().planar:
            arc = 2.0 * np.pi * _radius(mesh, name, shape) / mesh.cyclic.sectors
            even = arc / np.ceil(arc / spacing)
            spacing = float(even) if arc > spacing and even >= _finest(mesh, name, shape) else spacing
        found[name] = spacing
    return found


def _radius(mesh: Mesh, name: str, shape: Any) -> float:
    """Largest radius [m] of the surface where its facets are."""
    return largest_radius(shape, shape.chart(mesh.points[mesh.facets(name).node_set])[1])


def promised(choice: GridChoice, grid: ContactGrid, shape: Any, mesh: Mesh) -> GridChoice:
    """The choice with the spacing that the finished grid has, and what that promises on the mesh."""
    spacing = grid.pitch * largest_radius(shape, grid.z)
    error = grid_error(spacing, choice.half_width, quantity=choice.quantity, patch=_patch(shape), traction=grid.kind)
    behind = line_mesh_error(mesh, shape, grid, choice.half_width)
    error = None if error is None else error + (behind or 0.0)
    return replace(choice, spacing=spacing, error=error, mesh_error=behind)
