"""Choice of the hats' grid on a contact surface, in the chart (theta, z) of its true shape.

On a plane theta is a length, never comes back to where it was, and the radius that makes it one is 1.

Two grids exist. The *nodal* one takes the surface nodes of a structured quadrilateral mesh, where they form a tensor
product with equal angles: then hats and finite-element trace are as fine as each other and `G` is definite. Every other
mesh gets a structured grid of a given spacing, by default the longest facet edge, so that the trace stays independent.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from warpffrf.model.errors import InputError
from warpffrf.model.mesh.elements import facet_kind
from warpffrf.model.reduced.contact_grid import cell_edges

SAME_PLACE = 1e-6  # chart coordinates of nodes closer than this fraction of the extent are the same line of the grid
ROUND_SPACING = 1e-9  # a spacing that divides a length up to round-off divides it
FULL_TURN = 2.0 * np.pi
RADII = 33  # places along a meridian at which its radius is looked at: it decides how many columns there are, no more
FEWEST_COLUMNS = 4  # of a grid that is not the mesh's own: on a full turn fewer hats would overlap on both sides


@dataclass(frozen=True)
class GridPlan:
    """A full rectangle of hats before those that reach over its edge are dropped: `columns` at `theta_start + j*pitch`
    (the full turn when `periodic`, otherwise an arc with a hat on both edges), rows at `z` (rows,) [m]."""

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
        if kind == "hats":
            return self
        start, columns = self.theta_start - 0.5 * self.pitch, self.columns + (not self.periodic)
        return GridPlan(start, self.pitch, columns, self.periodic, cell_edges(self.z), False)


@dataclass(frozen=True)
class Chart:
    """Nodes of a facet set in the chart of its shape: `theta` (m, k) rad, unwrapped within each facet, `z` (m, k) m."""

    theta: np.ndarray
    z: np.ndarray
    edge: float  # longest distance between neighbouring corners [m]
    turn: float = FULL_TURN  # after which theta is the same place again: 2 pi, or infinity on a plane

    def part(self, mask: np.ndarray) -> Chart:
        """The facets that `mask` (m,) keeps."""
        return Chart(self.theta[mask], self.z[mask], self.edge, self.turn)

    @property
    def scale(self) -> float:
        """Length of theta that tolerances are fractions of: the full turn, or the extent on a plane."""
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
    """Chart coordinates of the nodes of facets `nodes` (m, k) of one `kind`; neighbours may differ by a full turn."""
    theta, z, _ = shape.chart(points[nodes.ravel()])
    theta, z = theta.reshape(nodes.shape), z.reshape(nodes.shape)
    turn = full_turn(shape)
    theta = theta[:, :1] + wrapped(theta - theta[:, :1], turn)
    x = points[nodes[:, : facet_kind(kind).corner_count]]
    edge = float(np.max(np.linalg.norm(x - np.roll(x, 1, axis=1), axis=2)))
    return Chart(theta, z, edge, turn)


def full_turn(shape) -> float:
    """theta after which the chart of `shape` comes back to the same place: 2 pi, or infinity on a plane."""
    return np.inf if shape.profile().planar else FULL_TURN


def wrapped(theta: np.ndarray, turn: float, low: float = -0.5) -> np.ndarray:
    """theta, or anything counted like it, between `low` and `low` + 1 turns; as it is where there is no turn."""
    return (theta - low * turn) % turn + low * turn if np.isfinite(turn) else theta


def _lines(values: np.ndarray, extent: float) -> np.ndarray:
    """Sorted distinct values, those within `SAME_PLACE` of the extent merged to their mean."""
    ordered = np.sort(values)
    starts = np.flatnonzero(np.concatenate([[True], np.diff(ordered) > SAME_PLACE * extent]))
    return np.add.reduceat(ordered, starts) / np.diff(np.append(starts, len(ordered)))


def covered_arc(chart: Chart, name: str) -> tuple[float, float, bool]:
    """Start angle, extent [rad; m on a plane] of the facets, and whether they cover the full turn.

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
    """Start of an arc, counted so that its middle lies within half a turn of theta = 0, where charts have their
    points."""
    return float(wrapped(np.asarray(start + 0.5 * extent), turn)) - 0.5 * extent if np.isfinite(turn) else start


def nodal_plan(chart: Chart, name: str, theta_first: float | None = None) -> GridPlan | None:
    """The grid of the surface nodes, or None where they form no tensor product with equal angles.

    `theta_first`: angle of the line that shall be column 0 of a full turn (the first plane of sector 0).
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


def spaced_plan(chart: Chart, shape, name: str, spacing: float, nodes: int | None = None) -> GridPlan:
    """A structured grid of `spacing` [m] or a little more around and along, whatever the mesh.

    Raises `InputError` for a grid of more functions than there are `nodes` to carry them, where those are given.
    """
    start, extent, full = covered_arc(chart, name)
    low, high = float(chart.z.min()), float(chart.z.max())
    radius = largest_radius(shape, np.array([low, high]))
    rows = max(int((high - low) / spacing + ROUND_SPACING) + 1, 2)
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
    """Raises `InputError` for more functions than the facets have nodes: some combination of them loads none.

    `edge` is the longest facet edge [m], named as the cure.
    """
    if functions > nodes:
        raise too_fine(f"{functions} functions on {nodes} nodes", name, edge)


def too_fine(detail: str, name: str, edge: float) -> InputError:
    """The error for a contact grid whose functions the surface mesh cannot tell apart."""
    return InputError(
        f"contact {name!r}: contact grid finer than the surface mesh ({detail}); use traction_spacing >= {edge:.3g} m, "
        "or a finer mesh"
    )


def thinned_rows(z: np.ndarray, spacing: float) -> np.ndarray:
    """Axial rows (rows,) [m] among the corner positions `z` [m] of a structured surface, at least `spacing` apart.

    Both ends are kept. Cells along a roller are often much longer than around it: a grid coarsened around the roller
    then keeps its rows.
    """
    lines = _lines(z.ravel(), float(np.ptp(z)))
    rows = [lines[0]]
    for line in lines[1:-1]:
        if min(line - rows[-1], lines[-1] - line) >= spacing * (1.0 - ROUND_SPACING):
            rows.append(line)
    return np.array([*rows, lines[-1]])
