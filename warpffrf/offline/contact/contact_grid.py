r"""Choice of the contact grid on a surface, in the chart (theta, z) of its true shape.

On a plane theta is a length without periodicity, and the corresponding radius is 1.

Two grids exist. The *nodal* one takes the surface nodes of a structured quadrilateral mesh, where they form a tensor
product with equal angles: then shape functions and finite-element trace have the same resolution and `G` is definite.
Every other mesh gets a structured grid of a given spacing, by default the longest facet edge, so that the trace stays
independent.

Grid rule. The required fineness of a contact grid for a patch of a given half-width.

Compared with the exact elastic half-space, the error of a pressure on a grid of spacing s is, for the worst position of
the patch (half-width b) over the grid and the worst position of the other body's grid,

    error <= c (s/b)^p.

**Rates.** A Hertz pressure ends in a square root at the edge of the patch. There, over a length s, the grid misses a
pressure of order sqrt(s), with an energy of order (sqrt(s) s)^2 = s^3: the *compliance* (the energy, or the mean
approach, under a given pressure) is too small by this amount, p = 3. Cells miss s^3 from every length s near the edge
too, s^3 ln(b/s) together, for which p = 2.5 is used. The contact on the grid is a minimum over the pressures of the
grid; its energy over the approach d is `W(d) (1 - k s^3)` with a k that varies as the edges of the patch pass the lines
of the grid. The *force* is dW/dd, and that derivative costs a factor 1/s: p = 2, with a sign that changes with position
and size. Around an ellipse the edge passes the lines at all phases and only the stretches along a line add up, of
length sqrt(s): p = 2.5. The *half-width*, defined by the second moment of the pressure, has the rate of the force.
Inside the patch the mean over a function misses s^2 times the curvature of the pressure: *peak pressure*, p = 2. The
*pressure* as a field, in the L2 norm: a square root that ends inside a length s is missed by sqrt(s) over s, which is
s^2 in the square of the norm, p = 1.

**Factors** c are the largest found by `studies.contact.contact_grid`, which sweeps sizes, positions and positions of
the opposite grid (docs/studies/contact_grid.md), rounded up. They hold for b/s >= 1; the rule gives no coarser grid.
On an ellipse b is the half-width *in the direction of the spacing*: apply the rule once for each semi-axis, or use the
smaller one for both directions, which is conservative. Errors of compliance and force of a line contact depend on the
depth of the body, because the rest of its compliance does: the factors are those of a depth of 10 half-widths, at 100
they are six tenths.

Grid values. Values of the functions of a contact grid at points of its surface.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np
import scipy.sparse as sp

from warpffrf.model.errors import InputError, require_number
from warpffrf.model.mesh.elements import facet_kind
from warpffrf.model.messages.named_arguments import named_arguments
from warpffrf.model.reduced.contact_grid import cell_edges, require_kind
from warpffrf.model.reduced.stress_field import GridSpan
from warpffrf.offline.fe import Sparse

SAME_PLACE = 1e-6  # nodes closer than this fraction of the extent (chart coordinates) are on the same line of the grid
ROUND_SPACING = 1e-9  # a spacing that divides a length up to this round-off counts as dividing it
FULL_TURN = 2.0 * np.pi
RADII = 33  # points along a meridian at which its radius is evaluated, to determine the number of columns only
FEWEST_COLUMNS = 4  # of a grid other than the mesh's own: fewer on a full revolution would overlap on both sides


@dataclass(frozen=True)
class GridPlan:
    """A full rectangle of nodes before those with supports beyond its edge are dropped: `columns` at `theta_start +
    j*pitch` (the full revolution if `periodic`, otherwise an arc with a node on both edges), rows at `z` (rows,)
    [m]."""

    theta_start: float
    pitch: float
    columns: int
    periodic: bool
    z: np.ndarray
    nodal: bool

    def lines(self, kind: str) -> GridPlan:
        """The lines at which functions of `kind` have kinks or jumps: the nodes' own, or those around the cells.

        An arc of n columns has n + 1 lines around its cells, the outer two beyond its edges.
        """
        if kind == "nodes":
            return self
        start, columns = self.theta_start - 0.5 * self.pitch, self.columns + (not self.periodic)
        return GridPlan(start, self.pitch, columns, self.periodic, cell_edges(self.z), False)


@dataclass(frozen=True)
class Chart:
    """Nodes of a facet set in the chart of its shape: `theta` (m, k) rad, unwrapped within each facet, `z` (m, k) m."""

    theta: np.ndarray
    z: np.ndarray
    edge: float  # longest distance between neighbouring corners [m]
    turn: float = FULL_TURN  # period of theta, that of the shape's profile

    def part(self, mask: np.ndarray) -> Chart:
        """The facets selected by `mask` (m,)."""
        return Chart(self.theta[mask], self.z[mask], self.edge, self.turn)

    @property
    def scale(self) -> float:
        """Reference length of theta for tolerances: the full revolution, or the extent on a plane."""
        return self.turn if np.isfinite(self.turn) else float(np.ptp(self.theta))

    @staticmethod
    def joined(charts: list[Chart]) -> Chart:
        """Facets of several kinds as one chart; rows of fewer nodes repeat their last one."""
        if len(charts) == 1:
            return charts[0]
        width = max(chart.theta.shape[1] for chart in charts)
        theta, z = (
            np.concatenate([np.pad(v, ((0, 0), (0, width - v.shape[1])), mode="edge") for v in values])
            for values in ([c.theta for c in charts], [c.z for c in charts])
        )
        return Chart(theta, z, max(chart.edge for chart in charts), charts[0].turn)


def facet_chart(points: np.ndarray, kind: str, nodes: np.ndarray, shape) -> Chart:
    """Chart coordinates of the nodes of facets `nodes` (m, k) of one `kind`; neighbours may differ by a revolution."""
    theta, z, _ = shape.chart(points[nodes.ravel()])
    theta, z = theta.reshape(nodes.shape), z.reshape(nodes.shape)
    turn = shape.profile().turn
    theta = theta[:, :1] + wrapped(theta - theta[:, :1], turn)
    x = points[nodes[:, : facet_kind(kind).corner_count]]
    edge = float(np.max(np.linalg.norm(x - np.roll(x, 1, axis=1), axis=2)))
    return Chart(theta, z, edge, turn)


def wrapped(theta: np.ndarray, turn: float, low: float = -0.5) -> np.ndarray:
    """theta, or a quantity counted like it, between `low` and `low` + 1 periods; unchanged if there is no period."""
    return (theta - low * turn) % turn + low * turn if np.isfinite(turn) else theta


def _lines(values: np.ndarray, extent: float) -> np.ndarray:
    """Sorted distinct values, those within `SAME_PLACE` of the extent merged to their mean."""
    ordered = np.sort(values)
    starts = np.flatnonzero(np.concatenate([[True], np.diff(ordered) > SAME_PLACE * extent]))
    return np.add.reduceat(ordered, starts) / np.diff(np.append(starts, len(ordered)))


def covered_arc(chart: Chart, name: str) -> tuple[float, float, bool]:
    """Start angle, extent [rad; m on a plane] of the facets, and whether they cover the full revolution.

    Raises `InputError` when the facets lie on more than one arc.
    """
    low, high = chart.theta.min(axis=1), chart.theta.max(axis=1)
    start, length = wrapped(low, chart.turn, 0.0), high - low
    order = np.argsort(start)
    low, length = start[order], length[order]
    reach = np.maximum.accumulate(low + length)
    slack = SAME_PLACE * chart.scale
    gaps = np.flatnonzero(low[1:] > reach[:-1] + slack)
    closing = low[0] + chart.turn > reach[-1] + slack
    if len(gaps) + closing == 0:
        return 0.0, chart.turn, True
    if len(gaps) + closing > 1:
        raise InputError(f"contact {name!r}: the facets lie on more than one arc; make a facet set of each")
    if closing:
        extent = float(reach[-1] - low[0])
        return centred(float(low[0]), extent, chart.turn), extent, False
    first = gaps[0] + 1  # the arc runs across theta = 0
    extent = float(reach[gaps[0]] + chart.turn - low[first])
    return centred(float(low[first]), extent, chart.turn), extent, False


def centred(start: float, extent: float, turn: float) -> float:
    """Start of an arc, shifted so that its middle lies within half a revolution of theta = 0, as the chart coordinates
    do."""
    return float(wrapped(np.asarray(start + 0.5 * extent), turn)) - 0.5 * extent if np.isfinite(turn) else start


def nodal_plan(chart: Chart, name: str, theta_first: float | None = None) -> GridPlan | None:
    """The grid of the surface nodes, or None if they form no tensor product with equal angles.

    `theta_first`: angle of the line that becomes column 0 of a full revolution (the first plane of sector 0).
    """
    start, extent, full = covered_arc(chart, name)
    turn, scale = chart.turn, chart.scale
    origin = (theta_first or 0.0) if full else start
    position = wrapped(chart.theta - origin, turn, -SAME_PLACE)
    theta = _lines(position.ravel(), scale)
    z = _lines(chart.z.ravel(), float(np.ptp(chart.z)))
    steps = np.diff(theta)
    if len(theta) < 3 or len(z) < 2 or np.ptp(steps) > SAME_PLACE * scale:
        return None
    j = np.searchsorted(theta - 0.5 * steps[0], position.ravel(), side="right") - 1
    k = np.argmin(np.abs(z[:, None] - chart.z.ravel()[None]), axis=0) if len(z) < 200 else None
    if k is None or len(np.unique(j * len(z) + k)) != len(theta) * len(z):
        return None
    if full:
        columns = len(theta)
        if abs(columns * steps[0] - turn) > SAME_PLACE * turn * columns:
            return None
        return GridPlan(origin + float(theta[0]), turn / columns, columns, True, z, True)
    return GridPlan(origin + float(theta[0]), float(np.mean(steps)), len(theta), False, z, True)


def spaced_plan(
    chart: Chart, shape, name: str, spacing: float, nodes: int | None = None, along: float | None = None
) -> GridPlan:
    """A structured grid of `spacing` [m] or slightly more around, and `along` or the same along, independent of the
    mesh.

    Raises `InputError` for a grid of more functions than there are supporting `nodes`, if these are given.
    """
    start, extent, full = covered_arc(chart, name)
    low, high = float(chart.z.min()), float(chart.z.max())
    radius = largest_radius(shape, np.array([low, high]))
    rows = max(int((high - low) / (along or spacing) + ROUND_SPACING) + 1, 2)
    columns = max(int(extent * radius / spacing + ROUND_SPACING) + (not full), FEWEST_COLUMNS)
    if nodes is not None:
        check_count(columns * rows, nodes, name, chart.edge)
    z = np.linspace(low, high, rows)
    if full:
        return GridPlan(0.0, chart.turn / columns, columns, True, z, False)
    return GridPlan(start, extent / (columns - 1), columns, False, z, False)


def largest_radius(shape, z: np.ndarray) -> float:
    """Largest metric radius R [m] of `shape` between the ends of the positions `z` [m]; 1 on a plane."""
    return float(np.max(shape.radius_at(np.linspace(np.min(z), np.max(z), RADII))))


def check_count(functions: int, nodes: int, name: str, edge: float) -> None:
    """Raises `InputError` for more functions than the facets have nodes: some combination of them causes no load.

    `edge` is the longest facet edge [m], named in the message as the cure.
    """
    if functions > nodes:
        raise too_fine(f"{functions} functions on {nodes} nodes", name, edge)


def too_fine(detail: str, name: str, edge: float) -> InputError:
    """The error for a contact grid whose functions are dependent on the surface mesh."""
    return InputError(
        f"contact {name!r}: contact grid finer than the surface mesh ({detail}); use spacing >= {edge:.3g} m, "
        "or a finer mesh"
    )


def thinned_rows(z: np.ndarray, spacing: float) -> np.ndarray:
    """Axial rows (rows,) [m] among the corner positions `z` [m] of a structured surface, at least `spacing` apart.

    Both ends are kept. Cells along a roller are often much longer than around it: a grid coarsened in circumferential
    direction then keeps its rows.
    """
    lines = _lines(z.ravel(), float(np.ptp(z)))
    rows = [lines[0]]
    for line in lines[1:-1]:
        if min(line - rows[-1], lines[-1] - line) >= spacing * (1.0 - ROUND_SPACING):
            rows.append(line)
    return np.array([*rows, lines[-1]])


FINER_BEHIND = "let its layers grow more slowly (mesh.roller: more layers, grading=1.2), or use quadratic cells"
QUANTITIES = ("compliance", "force", "peak_pressure", "half_width", "pressure")
RULES: dict[tuple[str, str], dict[str, tuple[float, float]]] = {  # (c, p) by (traction, patch), written from the study
    ("nodes", "line"): {
        "compliance": (0.012, 3.0),
        "force": (0.062, 2.0),
        "peak_pressure": (0.35, 2.0),
        "half_width": (0.34, 2.0),
        "pressure": (0.46, 1.0),
    },
    ("nodes", "ellipse"): {
        "compliance": (0.062, 3.0),
        "force": (0.22, 2.5),
        "peak_pressure": (0.66, 2.0),
        "half_width": (0.56, 2.5),
        "pressure": (0.67, 1.0),
    },
    ("cells", "line"): {
        "compliance": (0.024, 2.5),
        "force": (0.058, 2.0),
        "peak_pressure": (0.22, 2.0),
        "half_width": (0.36, 2.0),
        "pressure": (0.63, 1.0),
    },
    ("cells", "ellipse"): {
        "compliance": (0.13, 2.5),
        "force": (0.31, 2.5),
        "peak_pressure": (0.48, 2.0),
        "half_width": (0.67, 2.5),
        "pressure": (0.86, 1.0),
    },
}
PATCHES = ("line", "ellipse")
ROUND_OFF = 1e-12  # a spacing of one half-width up to round-off is one half-width
COARSEST = 1.0  # spacing in half-widths: beyond it a patch has one or two nodes, and the errors follow no rate


@named_arguments
def contact_spacing(
    half_width: float, *, error: float = 0.01, quantity: str = "force", patch: str = "line", traction: str = "nodes"
) -> float:
    """Spacing [m] of a contact grid, for `ContactGrid(spacing=)`, that keeps the error of the grid below
    `error` for any position of the patch on the grid.

    Parameters
    ----------
    half_width [m]: expected half-width b of the patch in the direction of the spacing. For varying loads, the smallest
        that must be accurate.
    error: relative, between 0 and 1.
    quantity: the quantity of `error`. "force": contact force at a given approach; "compliance": mean approach under a
        given pressure; "peak_pressure"; "half_width" of the patch; "pressure": all pressures, in the L2 norm.
    patch: "line" (long compared with its width; along it the pressure varies slowly and the spacing may be far larger)
        or "ellipse" (circle included).
    traction: "nodes" (normal pressure) or "cells" (friction).

    `s = b (error/c)^(1/p)`, at most b; c and p in the module docstring. This is the error of the grid alone: the mesh
    below must be as fine, otherwise `reduce` refuses it. Raises `InputError` for impossible numbers and unknown names.
    """
    b = require_number(half_width, "contact_spacing: half_width", positive=True)
    error = require_number(error, "contact_spacing: error", positive=True)
    if error >= 1.0:
        raise InputError(f"contact_spacing: error is a fraction below 1, got {error:g}; for one per cent give 0.01")
    factor, rate = rule(quantity, patch, traction)
    return b * min((error / factor) ** (1.0 / rate), COARSEST)


def grid_error(
    spacing: float, half_width: float, *, quantity: str = "force", patch: str = "line", traction: str = "nodes"
) -> float | None:
    """Bound on the error of a grid of `spacing` [m] on a patch of `half_width` [m]: `c (s/b)^p`, or None if the
    spacing is larger than the half-width and the rule does not hold."""
    s = require_number(spacing, "grid_error: spacing", positive=True)
    b = require_number(half_width, "grid_error: half_width", positive=True)
    factor, rate = rule(quantity, patch, traction)
    return None if s > b * COARSEST * (1.0 + ROUND_OFF) else factor * (s / b) ** rate


def rule(quantity: str, patch: str, traction: str) -> tuple[float, float]:
    """Factor c and rate p of the rule; raises `InputError` for unknown names."""
    if quantity not in QUANTITIES:
        raise InputError(f"contact_spacing: quantity {quantity!r} is not available, use one of {', '.join(QUANTITIES)}")
    if patch not in PATCHES:
        raise InputError(f"contact_spacing: patch {patch!r} is not available, use one of {', '.join(PATCHES)}")
    require_kind(traction, "contact_spacing: traction")
    return RULES[traction, patch][quantity]


@dataclass(frozen=True)
class GridChoice:
    """Spacing of a contact grid for an expected patch, and its expected error.

    `error`: for `quantity`, of the grid and of the mesh behind it; None if the patch is smaller than the spacing.
    `limited_by_mesh`: the required error needs a finer grid than the mesh admits. `mesh_error`: the part of the mesh,
    None if unknown (`mesh_error.line_mesh_error`).
    """

    spacing: float  # m
    error: float | None
    quantity: str
    half_width: float  # m, expected
    wanted_error: float
    wanted_spacing: float  # m, from the rule
    limited_by_mesh: bool
    mesh_error: float | None = None

    def facts(self) -> dict[str, float | str | bool | None]:
        """Plain data for the report of a reduced body."""
        return {
            "spacing": self.spacing,
            "promised_error": self.error,
            "mesh_error": self.mesh_error,
            "promised_quantity": self.quantity,
            "wanted_error": self.wanted_error,
            "expected_half_width": self.half_width,
            "limited_by_mesh": self.limited_by_mesh,
        }

    def warning(self, name: str) -> str | None:
        """The warning if the mesh of contact surface `name` cannot achieve the required error, else None."""
        behind = self.mesh_error or 0.0
        wanted = (
            f"contact {name!r}: an error of {self.wanted_error:g} in {self.quantity.replace('_', ' ')} at a half-width "
            f"of {self.half_width:.3g} m"
        )
        if not self.limited_by_mesh:
            kept = self.error is None or self.error <= self.wanted_error
            if kept or behind <= 0.5 * self.wanted_error:  # the remaining error is due to a spacing that was rounded up
                return None
            return (
                f"{wanted} is not achieved: the cells behind the surface alone cause an error of about "
                f"{behind:.2g}; {FINER_BEHIND}"
            )
        left = "is larger than the half-width" if self.error is None else f"achieves {self.error:.2g} only"
        return (
            f"{wanted} needs a contact grid of {self.wanted_spacing:.3g} m, finer than the mesh allows; its "
            f"{self.spacing:.3g} m {left}; refine the surface mesh"
            + (
                f", and behind it, where the cells cause an error of about {behind:.2g}"
                if behind > self.wanted_error
                else ""
            )
        )


def choose_spacing(
    half_width: float,
    finest: float,
    *,
    error: float = 0.01,
    quantity: str = "force",
    patch: str = "line",
    traction: str = "nodes",
) -> GridChoice:
    """The rule's spacing, but not below `finest` [m], the smallest that the surface mesh admits; `error` of the
    choice is the expected error of that spacing. Other arguments as in `contact_spacing`."""
    finest = require_number(finest, "choose_spacing: finest", positive=True)
    wanted = contact_spacing(half_width, error=error, quantity=quantity, patch=patch, traction=traction)
    spacing = max(wanted, finest)
    promised = grid_error(spacing, half_width, quantity=quantity, patch=patch, traction=traction)
    return GridChoice(spacing, promised, quantity, float(half_width), float(error), wanted, spacing > wanted)


Array = np.ndarray
BORDER = 1e-6  # of a cell: points this close to a border of two cells, such as mesh nodes, get the mean of both


def grid_values(theta: Array, z: Array, grid: Any, span: GridSpan, turn: float) -> Sparse:
    """Values of the functions of `grid` at chart points theta [rad], z [m] (n,): csr (n, whole columns * rows).

    z is cut to the grid; on an arc, points beyond the whole grid have zeros. `turn`: that of the shape's profile.
    """
    lines, whole = grid.z, span.columns
    x = (theta - grid.theta_start) / grid.pitch + span.first
    if span.closed:
        x = x % whole
    else:
        x = wrapped(x, turn / grid.pitch, -0.5 * grid.pitch / turn)
    if getattr(grid, "kind", "nodes") == "cells":
        margin = BORDER * np.min(np.diff(lines))
        sides = [(dx, dz) for dx in (-BORDER, BORDER) for dz in (-margin, margin)]
        column = np.stack([np.floor(x + dx).astype(np.int64) for dx, _ in sides], axis=1)
        row = np.stack([_interval(z + dz, lines) for _, dz in sides], axis=1)
        value = np.full(column.shape, 1.0 / len(sides))
    else:
        j, z = np.floor(x).astype(np.int64), np.clip(z, lines[0], lines[-1])
        k = _interval(z, lines)
        s, t = x - j, (z - lines[k]) / (lines[k + 1] - lines[k])
        column, row = np.stack([j, j, j + 1, j + 1], axis=1), np.stack([k, k + 1, k, k + 1], axis=1)
        value = np.stack([(1 - s) * (1 - t), (1 - s) * t, s * (1 - t), s * t], axis=1)
    if span.closed:
        column = column % whole
    else:
        value = np.where((column >= 0) & (column < whole), value, 0.0)
        column = np.clip(column, 0, whole - 1)
    point = np.repeat(np.arange(len(theta)), len(value.T))
    entries = (value.ravel(), (point, (column * grid.rows + row).ravel()))
    return sp.csr_matrix(entries, shape=(len(theta), whole * grid.rows))


def _interval(z: Array, lines: Array) -> Array:
    """Number of the interval between `lines` that contains z, the outermost for positions beyond."""
    return np.clip(np.searchsorted(lines, z, side="right") - 1, 0, len(lines) - 2)
