r"""Where a contact surface ends at a free face, and what such an end adds to the half-space.

Of a load at the distance d from a plane end face at right angles to the surface, the half-space field is mirrored at
the end, and `QuarterSpace` releases what the mirror image leaves on the face. Ends of other angles, fillets and
chamfers have no table: there the half-space is taken to go on, and what they change is left to the difference between
the body and the half-space, which is then not smooth within about a spacing of the grid.

Where a crown meets a plane face the edge is nearly square; up to the slope `SQUARE` it is taken as such, and its face
stands upright on the flat surface (`on_end`).
"""

from __future__ import annotations

from typing import Any

import numpy as np

from warpffrf.model.mesh import Mesh
from warpffrf.model.mesh.elements import facet_kind
from warpffrf.model.reduced.contact_grid import ContactGrid
from warpffrf.model.reduced.far_field import FreeEnd

Array = np.ndarray
ON_SURFACE = 1e-4  # of a facet's edge: nodes that lie nearer to the true surface are on it
SQUARE = 0.05  # slope dR/dz at an end up to which its edge counts as square: 3 degrees


def free_ends(mesh: Mesh, name: str, shape: Any, grid: ContactGrid, edge: float) -> tuple[list[FreeEnd], list[str]]:
    """The square ends of the contact surface, and notes on edges that are none. `edge`: longest facet edge [m]."""
    own = np.zeros(len(mesh.points), dtype=bool)
    own[mesh.facets(name).node_set] = True
    reach = ON_SURFACE * edge
    found: list[FreeEnd] = []
    notes: list[str] = []
    sides = ((grid.z[0], -1), (grid.z[-1], 1))
    at = {side: np.zeros(len(mesh.points), dtype=bool) for _, side in sides}
    nodes = np.flatnonzero(own)
    _, z, _ = shape.chart(mesh.points[nodes])
    for end, side in sides:
        at[side][nodes[np.abs(z - end) < reach]] = True
    beside: dict[int, list[Array]] = {-1: [], 1: []}
    for kind, faces in mesh.outer_facets().blocks.items():
        corners = faces[:, : facet_kind(kind).corner_count]
        others = ~own[corners].all(axis=1)
        for side, nodes_here in at.items():
            touching = corners[others & (nodes_here[corners].sum(axis=1) >= 2)]
            beside[side] += list(touching)
    for end, side in sides:
        if not beside[side]:
            continue
        touching = np.unique(np.concatenate(beside[side]))
        _, _, distance = shape.chart(mesh.points[touching])
        if (
            np.all(np.abs(along_axis(shape, mesh.points[touching]) - end) < reach)
            and abs(float(shape.slope_at(end))) <= SQUARE
        ):
            found.append(FreeEnd(float(end), side))
        elif np.max(np.abs(distance)) >= reach:
            where = "lower" if side < 0 else "upper"
            notes.append(
                f"contact {name!r}: the edge at its {where} end, z = {end:.4g} m, is no right angle between the "
                "surface and a plane face; within about a spacing of the grid from it a contact-fixed grid is less "
                "accurate"
            )
    return found, notes


def along_axis(shape: Any, points: Array) -> Array:
    """z [m] of `points` (n, 3) [m], user frame, along the axis."""
    return (points - shape.axis_point) @ shape.e_a


def on_end(shape: Any, points: Array, end: FreeEnd, edge: float) -> Array:
    """Which of `points` (n, 3) [m] lie on the plane of the end face (n,)."""
    return np.abs(along_axis(shape, points) - end.z) < ON_SURFACE * edge
