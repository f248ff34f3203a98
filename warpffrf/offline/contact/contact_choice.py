r"""Grid spacing and sampling points of a contact for a required error.

The error of a contact force has two parts: that of the contact grid, and that of the few sampling points compared with
all points. The required error is divided equally between them. The spacing follows from the rule of `grid_rule`,
error <= c (s/b)^p. For the points, an error e of the integrals over training patches changes the gap of a patch by at
most e of its depth; the force is a power of at most 3/2 of the approach (an ellipse; 1 for a line), so that
e = share/(3/2) suffices. This is conservative: on rollers the force changed by a tenth of it
(`tests/offline/contact/test_contact_choice.py`, `bench/evaluations.py`).

The mesh must be as fine as the grid; `reduce` refuses a finer grid.

Cell depth. Whether the cells behind a contact surface are shallow enough for the pressures on its grid.

A pressure that varies over a length a deforms the body down to a depth of about a. Deeper cells cannot represent this:
the surface is too stiff for short waves, the patch too narrow and the pressure too high, without any other indication.
The criterion is the distance between layers of nodes, `depth / degree` of the cells, relative to the spacing of the
grid, the shortest length over which the pressure can vary.

Wall. The thickness of one material behind a contact surface: a half-space, or a thin cover.

Expected contact. The contact grid of each surface if an expected half-width is given instead of a spacing.
"""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import Any

import numpy as np

from warpffrf.model.errors import InputError, require_number
from warpffrf.model.mesh import Mesh
from warpffrf.model.mesh.elements import cell_kind, facet_kind
from warpffrf.model.reduced.contact_grid import SurfaceGrid
from warpffrf.offline.contact.contact_grid import (
    GridChoice,
    choose_spacing,
    contact_spacing,
    grid_error,
    largest_radius,
    nodal_plan,
    wrapped,
)
from warpffrf.offline.contact.mesh_error import line_mesh_error, touched_in_lines
from warpffrf.offline.contact.node_loads import ContactFacets
from warpffrf.offline.fe import Assignment, facet_material
from warpffrf.offline.options import ContactGrid
from warpffrf.offline.settings import Settings

GRID_SHARE = 0.5  # of the required error
POWERS = {"line": 1.0, "ellipse": 1.5}  # of the force in the approach: Hertz, line (up to a logarithm) and point


@dataclass(frozen=True)
class ContactChoice:
    """For `ContactGrid`: spacing [m] and sampling_error; `grid_error` and `sampling_share` are their parts
    of the required error, None if the patch is smaller than the spacing."""

    spacing: float
    sampling_error: float
    grid_error: float | None
    sampling_share: float

    def grid(self) -> ContactGrid:
        """The grid for `reduce`."""
        return ContactGrid(spacing=self.spacing, sampling_error=self.sampling_error)


def contact_choice(half_width: float, *, error: float = 0.01, patch: str = "line") -> ContactChoice:
    """Grid and points for a contact force accurate to `error` on patches of `half_width` [m] or larger.

    patch: "line" or "ellipse", as in `contact_spacing`. Raises `InputError` for impossible numbers and unknown names.
    """
    b = require_number(half_width, "contact_choice: half_width", positive=True)
    error = require_number(error, "contact_choice: error", positive=True)
    if error >= 1.0:
        raise InputError(f"contact_choice: error is a fraction below 1, got {error:g}; for one per cent give 0.01")
    spacing = contact_spacing(b, error=GRID_SHARE * error, quantity="force", patch=patch)
    share = (1.0 - GRID_SHARE) * error
    return ContactChoice(spacing, share / POWERS[patch], grid_error(spacing, b, quantity="force", patch=patch), share)


# First layer of nodes in spacings of the grid. Two equal steel rollers, 35 mm wall, layers growing by 1.3 inwards,
# worst of four phases: errors of half-width and of peak pressure at mid-width against Hertz.
#
#     depth / spacing                       0.5           1            2            4            8
#     hex8,  2 spacings per half-width   -7, -4 %     -8, +4 %    -11, +10 %   -19, +19 %   -41, +68 %
#     hex8,  4                           -3,  0       -3, +1       -5,  +2     -10,  +7     -18, +21
#     hex27, 2                           -6, -6       -6, -6       -7,  -5     -12, +10     -37, +41
#     hex27, 4                           -2, -1       -2, -1       -2,  -1      -5,  +3
#
# The limit costs up to 4 % of the half-width and 6 % of the peak; twice the limit three times as much.
DEEPEST = 2.0


def layer_depth(mesh: Mesh, name: str, shape) -> float:
    """Largest distance [m] between the surface and the first layer of nodes behind the facets of set `name`.

    The depth of a cell is that of its deepest node under the true surface `shape`, divided by the degree of the cell.
    """
    deepest = 0.0
    for kind, cells in _behind(mesh, name).items():
        _, _, height = shape.chart(mesh.points[cells.ravel()])
        deepest = max(deepest, float(np.max(-height)) / cell_kind(kind).degree)
    return deepest


def node_spacing(mesh: Mesh, name: str, shape, grid: SurfaceGrid) -> float | None:
    """Distance [m] of nodes and of the columns of the `grid`, along the surface or into the depth, whichever is larger;
    None if cells behind the facets are not hexahedra."""
    kinds = _behind(mesh, name)
    if not kinds or any(cell_kind(kind).corner_count != 8 for kind in kinds):
        return None
    return max(layer_depth(mesh, name, shape), grid.pitch * largest_radius(shape, grid.z))


def _behind(mesh: Mesh, name: str) -> dict[str, np.ndarray]:
    """The cells behind the facets of set `name`, by kind."""
    on_set = np.zeros(len(mesh.points), dtype=bool)
    on_set[mesh.facets(name).node_set] = True
    found = {}
    for kind, cells in mesh.cells.items():
        cell = cell_kind(kind)
        shared = min(facet_kind(facet).corner_count for facet in cell.faces)
        behind = cells[on_set[cells[:, : cell.corner_count]].sum(axis=1) >= shared]
        if len(behind):
            found[kind] = behind
    return found


def depth_ratio(depth: float, shape, grid: SurfaceGrid) -> float:
    """`depth` [m] over the smaller spacing of the grid, around the largest circle or along the axis."""
    around = grid.pitch * largest_radius(shape, grid.z)
    return depth / min(around, float(np.min(np.diff(grid.z))))


def depth_warning(name: str, depth: float, ratio: float) -> str | None:
    """The warning if the cells are too deep, else None."""
    if ratio <= DEEPEST:
        return None
    return (
        f"contact {name!r}: the first layer of nodes lies {depth:.3g} m behind the surface, {ratio:.3g} spacings of "
        f"the contact grid, where at most {DEEPEST:g} is admissible: patches come out too narrow and their pressure "
        "too high; grade the mesh towards the surface (mesh.roller: leave grading out, or more layers), or use "
        f"spacing >= {depth / DEEPEST:.3g} m"
    )


ROUND_OFF = 1e-9  # of the size of the mesh: other nodes on the surface itself are not below it
INSIDE = 0.05  # of the extent of the grid: end faces, which meet the surface there, are not another side of the body


def wall(mesh: Mesh, name: str, shape: Any, grid: SurfaceGrid, assignment: Assignment) -> float | None:
    """Smallest distance [m] from the surface `shape` of facet set `name` with the `grid` to the end of its material.

    That is the outside of the body, or another material than that of most facets. None if there is no such limit, as
    in a solid shaft.
    """
    facets = mesh.facets(name)
    ends = np.zeros(len(mesh.points), dtype=bool)
    ends[mesh.outer_facets().node_set] = True
    own = facet_material(mesh, facets, assignment)
    other = np.array([material != own for material in assignment.materials], dtype=bool)
    for kind, cells in mesh.cells.items():
        ends[cells[other[assignment.of_cell[kind]]]] = True
    ends[facets.node_set] = False
    if not ends.any():
        return None
    rough = float(np.abs(shape.chart(mesh.points[facets.node_set])[2]).max())  # deviation of nodes from the shape
    theta, z, height = shape.chart(mesh.points[ends])
    below = (height < -2.0 * rough - ROUND_OFF * np.ptp(mesh.points, axis=0).max()) & _inside(
        z - grid.z[0], float(grid.z[-1] - grid.z[0])
    )
    if not grid.periodic:
        theta = wrapped(theta - grid.theta_start, shape.profile().turn, 0.0)
        below &= _inside(theta, grid.pitch * (grid.columns - 1))
    return float(-height[below].max()) if below.any() else None


def _inside(x: np.ndarray, extent: float) -> np.ndarray:
    return (x > INSIDE * extent) & (x < (1.0 - INSIDE) * extent)


def expected_grids(mesh: Mesh, shapes: dict[str, Any], settings: Settings) -> dict[str, GridChoice]:
    """The rule's choice by surface; empty if no half-width is expected. Contact on a surface curved in both directions,
    or on a plane, on which anything may lie, is taken as an ellipse; on one with a straight or slightly profiled
    meridian as a line."""
    if settings.grid.expected_half_width is None:
        return {}
    return {
        name: choose_spacing(
            settings.grid.expected_half_width,
            _finest(mesh, name, shape),
            error=settings.grid.force_error,
            patch=_patch(shape),
            traction=settings.grid.traction,
        )
        for name, shape in shapes.items()
    }


def _patch(shape: Any) -> str:
    return "line" if touched_in_lines(shape) else "ellipse"


def _finest(mesh: Mesh, name: str, shape: Any) -> float:
    """Finest spacing [m] of the surface mesh: the distance of its nodes if they form a grid, otherwise its longest
    facet edge."""
    chart = ContactFacets.of(mesh.points, mesh.facets(name), shape).chart
    plan = nodal_plan(chart, name)
    return chart.edge if plan is None else plan.pitch * largest_radius(shape, plan.z)


def spacings(mesh: Mesh, shapes: dict[str, Any], settings: Settings, chosen: dict[str, GridChoice]) -> dict[str, Any]:
    """Spacing [m] by surface, None for the mesh's own grid.

    Columns divide a sector of a periodic mesh evenly; if a sector is wider than the spacing, the spacing is rounded
    down to do so, since rounding up could double it.
    """
    found = {}
    for name, shape in shapes.items():
        spacing = settings.grid.spacing
        if name in chosen:
            spacing = None if chosen[name].limited_by_mesh else chosen[name].spacing
        if name in chosen and spacing is not None and mesh.cyclic is not None and not shape.profile().planar:
            arc = 2.0 * np.pi * _radius(mesh, name, shape) / mesh.cyclic.sectors
            even = arc / np.ceil(arc / spacing)
            spacing = float(even) if arc > spacing and even >= _finest(mesh, name, shape) else spacing
        found[name] = spacing
    return found


def _radius(mesh: Mesh, name: str, shape: Any) -> float:
    """Largest radius [m] of the surface on its facets."""
    return largest_radius(shape, shape.chart(mesh.points[mesh.facets(name).node_set])[1])


def promised(choice: GridChoice, grid: SurfaceGrid, shape: Any, mesh: Mesh) -> GridChoice:
    """The choice with the spacing of the finished grid, and its expected error on the mesh."""
    spacing = grid.pitch * largest_radius(shape, grid.z)
    error = grid_error(spacing, choice.half_width, quantity=choice.quantity, patch=_patch(shape), traction=grid.kind)
    behind = line_mesh_error(mesh, shape, grid, choice.half_width)
    error = None if error is None else error + (behind or 0.0)
    return replace(choice, spacing=spacing, error=error, mesh_error=behind)
