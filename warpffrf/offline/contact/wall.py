"""How much of one material lies behind a contact surface: a half-space, or a thin cover?"""

from __future__ import annotations

from typing import Any

import numpy as np

from warpffrf.model.mesh import Mesh
from warpffrf.model.reduced.contact_grid import ContactGrid
from warpffrf.offline.contact.contact_grid import full_turn, wrapped
from warpffrf.offline.fe.materials import Assignment, facet_material

ROUND_OFF = 1e-9  # of the size of the mesh: other nodes on the surface itself are not below it
INSIDE = 0.05  # of the extent of the grid: end faces, which meet the surface there, are no other side of the body


def wall(mesh: Mesh, name: str, shape: Any, grid: ContactGrid, assignment: Assignment) -> float | None:
    """Smallest distance [m] from the surface `shape` of facet set `name` with the `grid` to where its material ends.

    That is the outside of the body, or another material than most facets have. None where there is nothing below the
    facets, as in a solid shaft.
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
    rough = float(np.abs(shape.chart(mesh.points[facets.node_set])[2]).max())  # nodes of the surface lie so far off it
    theta, z, height = shape.chart(mesh.points[ends])
    below = (height < -2.0 * rough - ROUND_OFF * np.ptp(mesh.points, axis=0).max()) & _inside(
        z - grid.z[0], float(grid.z[-1] - grid.z[0])
    )
    if not grid.periodic:
        theta = wrapped(theta - grid.theta_start, full_turn(shape), 0.0)
        below &= _inside(theta, grid.pitch * (grid.columns - 1))
    return float(-height[below].max()) if below.any() else None


def _inside(x: np.ndarray, extent: float) -> np.ndarray:
    return (x > INSIDE * extent) & (x < (1.0 - INSIDE) * extent)
