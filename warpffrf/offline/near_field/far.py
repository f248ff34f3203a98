"""The far field of a contact surface: whether it is required, whether it is available, and its accuracy."""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import Any

import numpy as np

from warpffrf.model.errors import InputError
from warpffrf.model.half_space import FarSplines
from warpffrf.model.material import Material
from warpffrf.model.mesh import Mesh
from warpffrf.model.mesh.elements import facet_kind
from warpffrf.model.reduced.contact_grid import SurfaceGrid
from warpffrf.model.reduced.contact_surface import Tangential
from warpffrf.model.reduced.far_field import ASYMMETRIC, FarField, FarTangential
from warpffrf.offline.contact.contact_choice import wall
from warpffrf.offline.contact.mesh_error import touched_in_lines
from warpffrf.offline.contact.node_loads import ContactFacets
from warpffrf.offline.fe import Assignment
from warpffrf.offline.general.checkpoint import Checkpoint
from warpffrf.offline.near_field.compliance import NearTangential, near_compliance
from warpffrf.offline.near_field.quarter_space import LARGEST_RATIO, QuarterSpace
from warpffrf.offline.near_field.window import NearFunctions, free_ends, sharpest
from warpffrf.offline.progress import Progress

# Distance of nodes in radii, or extents of a surface if they are smaller, above which a mesh counts as coarse: four
# nodes per half-width resolve b = 0.016 R, in steel a line contact of 900 MPa, and no lighter one. The admissible
# pressure of a material scales about with the root of its Young's modulus (500 MPa of aluminium, 90 MPa of polymers,
# 5 MPa of rubber), so the half-width scales with its inverse; patches are at most 0.18 R wide (`patch_plan.WIDEST`).
COARSE, AT_MODULUS = 0.004, 210e9  # Pa
COARSEST = 0.045
NODES_PER_HALF_WIDTH = 4
# Error of the force of a line contact due to the wall t behind it, fixed inside, in longest facet edges h: c (h/t)^p,
# hollow rollers, one cell and more through the wall. Linear cells: -10.5, -4.4, -2.0, -0.8 % at t/h = 1, 1.5, 2, 3,
# quadratic ones -2.2, -0.6, -0.2, -0.1 %. By degree; walls with an error above THIN are named.
WALL_ERROR = {1: (0.105, 2.3), 2: (0.022, 3.2)}
# For lines h is that of the edges across, for triangles the longest, which are stiffer. At the free ends of a wall,
# where it is softer, facets of the length l along it cause END (l/t)^q t/L of the width L: for 10 mm of rubber, 100 mm
# wide, the total of both is +2.9, +0.2 % for linear cells at l/t = 2.5, 1.25, +1.0, +0.06 % for quadratic ones; for
# 5 mm +5.6, -1.0 % at 5, 2.5; for Poisson's ratio 0.3 half as much.
END_ERROR = {1: (0.0073, 4.0), 2: (0.0024, 4.0)}
# Of the error of pressures within a thickness of the ends, in the largest pressure, which is further inside: for cells
# of 2.5 and 5 thicknesses, Poisson's ratio 0.49, 0.35 and 0.15 were measured; on `FEW` cells along there is no inside:
# 0.5 to 1.3 at 2.7. Peaks err by no more than `MOST_AT_ENDS` of it.
AT_ENDS, FEW, MOST_AT_ENDS = 0.25, 3, 0.35
THIN = 0.01


@dataclass(frozen=True, eq=False)
class FoundField:
    """A far field, or the reason why there is none; `facts` for the report, `notes`, `warnings`."""

    far: FarField | None
    facts: dict[str, Any] = field(default_factory=dict)
    notes: list[str] = field(default_factory=list)
    warnings: list[str] = field(default_factory=list)


def is_coarse(
    mesh: Mesh, name: str, shape: Any, grid: SurfaceGrid, half_width: float | None, material: Material | None
) -> bool:
    """Whether the nodes of the surface are too far apart for nodal pressures: for the expected `half_width` [m] if
    known, otherwise for all but heavily loaded contacts of the `material` (`COARSE`). On a cylinder, loaded along its
    axis, only circumferential distances count."""
    middle = float(np.mean(grid.z))
    radius = float(shape.radius_at(middle))
    around = grid.columns * grid.pitch * radius
    facets = mesh.facets(name)
    chart = ContactFacets.of(mesh.points, facets, shape).chart
    if shape.kind == "cylinder":
        spacing, size = radius * float(np.ptp(chart.theta, axis=1).max()), min(around, radius)
    else:
        curvature = max(sharpest(shape, grid))
        spacing = chart.edge
        size = min(around, float(np.ptp(grid.z)), 1.0 / curvature if curvature > 0.0 else np.inf)
    spacing /= max(facet_kind(kind).degree for kind in facets.blocks)
    if half_width is not None:
        return NODES_PER_HALF_WIDTH * spacing > half_width
    softer = np.sqrt(AT_MODULUS / material.youngs_modulus) if material is not None else 1.0
    return spacing > min(COARSE * max(softer, 1.0), COARSEST) * size


def find_far_field(
    mesh: Mesh,
    name: str,
    shape: Any,
    grid: SurfaceGrid,
    lags: np.ndarray,
    tangential: Tangential | None,
    material: Material | None,
    assignment: Assignment,
    checkpoint: Checkpoint,
    progress: Progress,
) -> FoundField:
    """The far field of the surface `name` with its nodal compliance `lags`, also that of its `tangential` part if it
    exists and its tractions are on cells."""
    # cases without a far field
    if grid.kind != "nodes":
        return FoundField(None, notes=[_none(name, "its tractions are constant on cells; use traction='nodes'")])
    if material is None or mesh.matrices is not None:
        return FoundField(None, notes=[_none(name, "a body of matrices has no cells near a load; use a mesh")])
    if min(grid.columns, grid.rows) < 2:
        few = f"its contact grid has {grid.columns} x {grid.rows} functions, from one of which nothing varies"
        return FoundField(None, notes=[_none(name, f"{few}; use a finer mesh, or a larger contact surface")])
    cells = tangential if tangential is not None and tangential.grid.kind == "cells" else None
    functions = NearFunctions(mesh, name, shape, grid, None if cells is None else cells.grid)
    ends, notes = free_ends(mesh, name, shape, grid, functions.edge)
    if tangential is not None and cells is None:
        notes.append(
            f"contact {name!r}: a contact-fixed grid supports normal pressures only, its tangential tractions are "
            f"{tangential.grid.kind}; use tangential='cells'"
        )
    if ends and cells is not None:
        notes.append(
            f"contact {name!r}: under friction within about a spacing of the contact grid ({functions.spacing:.3g} m) "
            "from its ends a contact-fixed grid is less accurate: there tangential tractions are corrected by their "
            "mirror images only, not by the full effect of a free end"
        )
    quarter = None
    if ends:
        with progress.stage("quarter space"):
            quarter = QuarterSpace(min(material.poisson_ratio, LARGEST_RATIO))
    # near compliance on windows of the mesh; the remainder of the compliance as splines
    sectors = len(lags)
    try:
        near = near_compliance(functions, sectors, material, assignment, ends, quarter, checkpoint, progress)
    except InputError as error:
        return FoundField(None, notes=[_none(name, str(error))])
    turn = sectors * grid.columns_per_sector if sectors > 1 or grid.periodic else 0
    splines = FarSplines(grid, shape, turn)
    far = FarField(
        splines.compliance(lags - near.lags),
        material.youngs_modulus,
        material.poisson_ratio,
        tuple(ends),
        near.asymmetry,
        None if quarter is None else quarter.on_surface,
        None if cells is None else _far_tangential(cells, near.tangential, splines),
    )
    warnings = []
    if near.asymmetry > ASYMMETRIC:
        warnings.append(
            f"contact {name!r}: the half-space on this mesh is not symmetric ({near.asymmetry:.1%}, "
            f"from {ASYMMETRIC:.0%} on forces of a contact-fixed grid err by more than 1 %); use quadratic cells, or "
            f"a finer "
            "mesh at the surface"
        )
    # accuracy with the wall behind the surface
    wall_error, end_error, thin = _thin_wall(mesh, name, shape, grid, assignment, functions.edge)
    warnings += [thin] if thin else []
    facts = {
        "asymmetry": near.asymmetry,
        "windows": near.windows,
        "largest_window_dofs": near.largest,
        "ends": [end.z for end in ends],
        "wall_error": wall_error,
        "end_error": end_error,
    }
    if far.tangential is not None:
        facts["tangential_asymmetry"] = far.tangential.asymmetry
    return FoundField(far, facts, notes, warnings)


def _far_tangential(own: Tangential, near: NearTangential | None, grid_nodes: FarSplines) -> FarTangential:
    """Remainder of the `own` compliance of cells without the half-space; `grid_nodes`: the splines of normal loads."""
    if near is None:
        raise TypeError("the half-space was not computed for tangential tractions")
    cells = FarSplines(own.grid, grid_nodes.shape, grid_nodes.turn)
    lags_nt = cells.sources(grid_nodes.targets(own.lags_nt - near.lags_nt), directions=2)
    return FarTangential(cells.compliance(own.lags_tt - near.lags_tt, directions=2), lags_nt, near.asymmetry)


def _thin_wall(
    mesh: Mesh, name: str, shape: Any, grid: SurfaceGrid, assignment: Assignment, edge: float
) -> tuple[float, float, str]:
    """Relative errors due to the cells of the wall behind the surface, of the force at a given approach, and of the
    largest pressure by long cells at free ends, and a message if the wall is as thin as they are wide, else ""; `edge`:
    longest facet edge [m]."""
    thickness = wall(mesh, name, shape, grid, assignment)
    if thickness is None:
        return 0.0, 0.0, ""
    facets = mesh.facets(name)
    degree = min(facet_kind(kind).degree for kind in facets.blocks)
    c, p = WALL_ERROR[degree]
    peak = ends = 0.0
    if shape.kind == "cylinder" and touched_in_lines(shape):
        chart = ContactFacets.of(mesh.points, facets, shape).chart
        along, width = float(np.ptp(chart.z, axis=1).max()), float(np.ptp(grid.z))
        if all(facet_kind(kind).domain == "quad" for kind in facets.blocks):
            edge = min(edge, float(shape.radius_at(float(np.mean(grid.z)))) * float(np.ptp(chart.theta, axis=1).max()))
        factor, power = END_ERROR[degree]
        local = min(factor * (along / thickness) ** power, 1.0)
        ends = local * thickness / width
        peak = min(local, MOST_AT_ENDS) * (1.0 if width < (FEW + 0.5) * along else AT_ENDS)
    error = c * (edge / thickness) ** p
    if error + ends <= THIN:
        return error + ends, peak, ""
    thin = (
        f"contact {name!r}: the wall behind it is {thickness:.3g} m thick, {thickness / edge:.2g} facet edges, and "
        f"{'linear' if degree == 1 else 'quadratic'} cells cause an error: forces at a given approach deviate by "
        f"about {min(error, 1.0):.0%} where it is held inside; use shorter "
        f"facets{' or quadratic cells' * (degree == 1)}"
    )
    if ends > error:
        thin = (
            f"contact {name!r}: facets are {along:.3g} m long along the surface, and the wall behind it is "
            f"{thickness:.3g} m thick: such cells cause an error at its free ends of about {ends:.1%} of the force at "
            "a given approach; use more cells along"
        )
    return error + ends, peak, thin


def _none(name: str, reason: str) -> str:
    return f"contact {name!r}: no contact-fixed grid: {reason}"
