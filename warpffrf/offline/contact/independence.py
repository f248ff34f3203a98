r"""Are the hats independent on the surface mesh?

The contact problem is unique only if no combination of hats loads the mesh with nothing. A contact grid finer than
the mesh has such combinations: `C = (B psi)^T G (B psi)` becomes semidefinite (an eigenvalue ratio of -1.5e-16 was
met, with a wrong contact force). Two ratios of a window of neighbouring columns are looked at, because dependence is
local:

* the *traces*: with `b_ia = int psi_i N_a dA`, lumped areas `A_i = sum_a b_ia` of hats and `L_a = sum_i |b_ia|` of
  nodes (vertex functions of quadratic triangles have no area of their own), the smallest
  over the largest eigenvalue of `A^-1/2 b L^-1 b^T A^-1/2`. It is a number of the two grids alone: at best about
  (1/9)^2 for a nodal grid, where b is the hats' Gram matrix, and zero where hats outnumber nodes. The loads
  themselves cannot tell so sharply: the normal turns within a facet, so that a dependent combination still loads the
  mesh a little, tangentially. Being known before any solve, they are looked at first;
* C itself, taken with the global modes' part in it.
"""

from __future__ import annotations

from collections.abc import Mapping

import numpy as np

from warpffrf.model.errors import InputError
from warpffrf.model.mesh import Mesh
from warpffrf.model.reduced.contact_grid import ContactGrid
from warpffrf.offline.contact.contact_grid import GridPlan, too_fine
from warpffrf.offline.contact.traction_fields import ContactFacets

# Nodal grids have 3e-3 to 1e-2, a grid 1.4 times as fine as linear facets 1e-6 or less: in between, and towards the
# lower end more and more, the pressure oscillates from hat to hat but is unique.
TRACES = 1e-4
# Smallest over largest eigenvalue of C on a window. Nodal grids have 1e-2 to 1e-6 (rows much longer than columns
# lower it).
INDEPENDENCE = 1e-10
WINDOW_COLUMNS = 24  # shows a grid finer by 10 %
WINDOW_HATS = 600  # at most, but `LEAST_COLUMNS` whole columns: the eigenvalues of the window take 0.1 s
LEAST_COLUMNS = 7


def window_columns(columns: int, rows: int) -> int:
    """Number of neighbouring columns that are judged."""
    return min(columns, max(LEAST_COLUMNS, min(WINDOW_COLUMNS, WINDOW_HATS // rows)))


def eigenvalue_ratio(window: np.ndarray) -> float:
    """Smallest over largest eigenvalue of the symmetric `window` (h, h); NaN where it holds what is no number."""
    if not np.all(np.isfinite(window)):
        return np.nan
    values = np.linalg.eigvalsh(0.5 * (window + window.T))
    return float(values[0] / values[-1]) if values[-1] > 0.0 else -1.0


def trace_ratio(mesh: Mesh, name: str, shape, grid: ContactGrid) -> float:
    """Eigenvalue ratio of the traces of the grid's first columns on the facets of set `name` (module docstring).

    NaN where a hat has no area.
    """
    facets = ContactFacets.of(mesh.points, mesh.facets(name), shape)
    chart = facets.chart
    count, rows = window_columns(grid.columns, grid.rows), grid.rows
    # the window alone as a grid on an arc, with a margin of columns whose hats complete the lumped areas of its nodes
    # (a plane, which has no turn, gets one as long as all of its columns, that the margin is on both sides)
    turn = chart.turn if np.isfinite(chart.turn) else grid.pitch * np.ceil(np.ptp(chart.theta) / grid.pitch + 2.0)
    low = (chart.theta.min(axis=1) - grid.theta_start) % turn
    span = np.ptp(chart.theta, axis=1)
    reach = grid.pitch * count
    near = (low < reach) | (low + span > turn - grid.pitch)
    columns = int(np.ceil(turn / grid.pitch - 1e-6))
    plan = GridPlan(grid.theta_start, turn / columns, columns, True, grid.z, False)
    loads = facets.part(near).loads(plan, getattr(grid, "kind", "hats"), "normal")
    column = loads.column % columns
    nodes, node = np.unique(loads.node, return_inverse=True)
    lumped = np.bincount(node, weights=np.abs(loads.area))
    inside = column < count
    b = np.zeros((count * rows, len(nodes)))
    np.add.at(b, (column[inside] * rows + loads.row[inside], node[inside]), loads.area[inside])
    areas = b.sum(axis=1)
    if not np.all(areas > 0.0):
        return np.nan
    scaled = b / np.sqrt(areas)[:, None] / np.sqrt(lumped)
    return eigenvalue_ratio(scaled @ scaled.T)


def check_traces(mesh: Mesh, name: str, shape, grid: ContactGrid) -> float:
    """`trace_ratio` of the grid; raises `InputError` where it is too small."""
    traces = trace_ratio(mesh, name, shape, grid)
    _require_finite(traces, name)
    if not traces > TRACES:
        edge = ContactFacets.of(mesh.points, mesh.facets(name), shape).chart.edge
        detail = f"eigenvalue ratio of the traces of a window {traces:.2g}, at least {TRACES:g} is needed"
        raise too_fine(detail, name, edge)
    return traces


def check_compliance(window: np.ndarray, name: str, edge: float, held: str = "") -> float:
    """The eigenvalue ratio of C; raises `InputError` where it is too small.

    Cures that it names: the longest facet `edge` [m] as spacing, or what `held_nodes` says.
    """
    ratio = eigenvalue_ratio(window)
    _require_finite(ratio, name)
    if not ratio > INDEPENDENCE:
        detail = f"eigenvalue ratio of the compliance of a window {ratio:.2g}, at least {INDEPENDENCE:g} is needed"
        if held:
            raise InputError(f"{held} ({detail})")
        raise too_fine(detail, name, edge)
    return ratio


def _require_finite(ratio: float, name: str) -> None:
    if np.isnan(ratio):
        raise InputError(
            f"contact {name!r}: functions of its grid have no area on the facets, or no finite one: the shape does not "
            "belong to them; give another shape in reduce(contact=...), or None to have one found"
        )


def held_nodes(mesh: Mesh, name: str, interfaces: Mapping[str, str]) -> str:
    """What is wrong where nodes of the contact surface are on a rigid or free interface, "" where none is.

    Tractions on them move the interface alone: the local modes have no compliance there.
    """
    nodes = mesh.facets(name).node_set
    for other, kind in interfaces.items():
        shared = 0 if kind == "average" else len(np.intersect1d(nodes, mesh.facets(other).node_set))
        if shared:
            return (
                f"contact {name!r}: {shared} of its {len(nodes)} nodes are on the {kind} interface {other!r}, where "
                "local modes cannot deform the surface; separate the sets, or make the interface an 'average' one"
            )
    return ""
