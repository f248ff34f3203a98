r"""Cells of a pair on a contact-fixed grid, and their displacements by the half-space.

Across, cells are equal strips of 2 W/columns, W the half-width that follows the load. Along the meridian of the first
surface rows are

- of a *line* contact at fixed positions of the width that both surfaces have in common, finer towards ends under
  pressure, or about a crown, and at the ends, too, where patches of crowns run off them
  (`online.diagnosis.patch_off_end`); the half-space between cells, with the ends of both bodies, is tabulated for
  levels of W;
- of a *point* contact, short near its ends, about the nearest point, with an aspect that Hertz's ellipse has at any
  load, so that one table, for W = 1, suffices: displacement per pressure grows with W. The contribution of the ends is
  evaluated at the middle, lengths along the meridian are those at the slope of the start;
- between *given* boundaries, of a profile that touches in several places: at distances along the meridian, the
  half-space between rows cut off by the angle between their normals, as in the far field.

Love's integral over the rectangle of a cell at the centre of another (`warpffrf.model.half_space`), of both
bodies with their own E and nu, times the area of the receiving cell, symmetrised.

The number of cells follows from the error they may add to force and largest pressure, `Contact.cell_error`: at most
`STRIPS_ERROR` / columns^2, the same of rows that follow, and `CROWNED_ERROR` / rows^3 of fixed rows of a crown
(docs/studies/patch_cells.md); rows of straight rollers, which resolve their ends, grow with the strips.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, replace
from typing import Any

import numpy as np
from scipy.interpolate import PchipInterpolator

from warpffrf.model.contact import Contact
from warpffrf.model.errors import InputError
from warpffrf.model.half_space import rectangle
from warpffrf.model.placement.nearest import is_ball, meeting_place
from warpffrf.model.reduced.far_field import WHOLE, FarField, cutoff
from warpffrf.online.compile.patches.sides import PARALLEL, Surface, facing, in_world, levers, meridian, middle_of

Array = np.ndarray
LINE_ASPECT = 8.0  # of Hertz's ellipse, from which rows are fixed
ELLIPSE = 0.636  # aspect of Hertz's ellipse: the ratio of curvatures to this power (Hamrock and Brewe 1983)
# Of force or largest pressure, by strips^2 and by rows^3: docs/studies/patch_cells.md
STRIPS_ERROR, CROWNED_ERROR = 0.6, 100.0
SPAN = 1.3  # half-widths of the pressure, by its second moment, in W, about: Hertz's patch ends at 1/1.3 of it
ROUND_OFF = 1e-9
TAILED = 1.7  # the same of laws with pressure at a distance: a Gaussian's tail beyond has 7e-4 of the load
FEWEST = 7  # strips or rows: the error of fewer follows no rule
SAMPLES = 4001  # of the length of rows along the width
FIRST_ROW, ROW_GROWTH = 0.004, 1.6  # of the width: rows at ends under pressure; their growth from there
MIDDLE_ROW = 0.015  # of the width: rows at a loaded crown; an ellipse of a third of the width needs a dozen
STRAIGHT = 1e-6  # of the width, 20 nm of 20 mm: any load is carried by the whole width
NARROWEST = 1e-4  # W times the relative curvature
WIDEST = 0.5 * WHOLE * 0.95  # W over a radius of curvature: a patch stays within WHOLE
# The same of rows that follow, along: an ellipse of a half-axis of a third of a ball's radius, in a close groove under
# heavy load, is a little too long for WHOLE, but its far ends carry little pressure, and influence each other little:
# peak pressure and approach then are within 2 % of Hertz's, whose parabola is off by as much there
LONGEST_ROWS = 2.0 * WIDEST
LEANING = 0.15  # rad: at 0.1 pressures err by 0.5 %, at 0.2 by 2 %
ALONG = 0.9  # cosine of the angle between axes, 25 degrees, up to which ends of one count as those of the other
STEP = 0.3  # of ln W between levels: the error of cubic interpolation is 1e-5


def span_of(columns: int) -> float:
    """Half-widths in W, about `SPAN`, of a line contact without a layer, whose pressure across is Hertz's and
    determines its half-width by the second moment: such that the patch ends between two of its `columns` strips, with a
    whole number of them free on each side, the smaller of two equal candidates. The pressure of a strip that the edge
    crosses cannot be correct: with the edge in its middle, the error of the pressures is three times as large (root
    mean square).
    """
    free = max(int(np.ceil(0.5 * columns * (1.0 - 1.0 / SPAN) - 0.5 - ROUND_OFF)), 1)
    return columns / (columns - 2.0 * free)


@dataclass(frozen=True, eq=False)
class Along:
    """Rows by arc length along the first meridian: middles `s` and `length` (rows,) [m], the arc length of any z, and
    the `weight` (rows, rows) of the half-space between two of them, None: 1."""

    s: Array
    length: Array
    arc: Callable[[Array | float], Any]
    weight: Array | None = None


@dataclass(frozen=True, eq=False)
class PatchPlan:
    """Cells of a pair: `columns` strips, rows between `edges` [m; in W where they follow], and near
    tables (levels, columns, rows, rows) from ln W `first` on, `step` apart, over W^power.
    """

    columns: int
    edges: Array  # of the rows
    along: Along
    aspect: float  # extent in z over width of rows that follow; 0 of others
    curvature: float
    least: float
    most: float
    begins: float  # gap [m] below which the layer carries pressure
    span: float  # half-width of the pressure over W
    table: Array
    first: float
    step: float
    power: float
    ends: list[tuple[float, float]]  # z on A, strength
    crowned: bool = False  # fixed rows that are fine about a crown
    off_end: bool = False  # and at the ends

    @classmethod
    def of(cls, contact: Contact, *, off_end: bool = False) -> PatchPlan:
        """The plan of a contact with grid "contact_fixed"; `off_end`: patches of crowns run off an end of their
        surfaces."""
        across, along = relative_curvatures(contact)
        if not across > 0.0:
            raise InputError(
                f"contact {contact.name!r}: the surfaces are as curved as each other, a patch of cells has no width "
                'there; use grid="body_fixed"'
            )
        _refuse_lean(contact)
        least, most = NARROWEST / across, widest(contact)
        follows = rows_follow(contact)
        aspect = _aspect(across, along) / stretch_at_start(contact) if follows else 0.0
        crowned = is_crowned(contact)
        wanted = _counts(
            contact.cell_error, TAILED / SPAN if _begins(contact) else 1.0, follows=follows, crowned=crowned
        )
        columns, rows = contact.cells or wanted
        if follows:
            edges = aspect * np.linspace(-1.0, 1.0, rows + 1)
        elif rows_given(contact):
            edges = _given_edges(contact)
        else:
            _refuse_across(contact)
            low, high = common_width(contact)
            edges = line_edges(low, high, rows)
            if crowned and off_end:
                nearest = _nearest_tilted if np.any(levers(contact)) else _nearest
                about = crowned_edges(low, high, nearest(contact, low, high), wanted[1])
                edges = off_end_edges(about, None if contact.cells is None else rows)
            elif crowned:
                edges = crowned_edges(low, high, _nearest(contact, low, high), rows)
        plan = cls._tabulated(contact, columns, edges, aspect, across, least, most)
        return replace(plan, crowned=crowned, off_end=crowned and off_end)

    def spread(self, contact: Contact, columns: int, rows: int, least: float, most: float) -> PatchPlan:
        """The plan with other numbers of strips and rows, of the same distribution, for half-widths between `least` and
        `most` [m].
        """
        low = min(max(least, self.least), self.most)
        high = min(max(most, low), self.most)
        curve = PchipInterpolator(np.linspace(0.0, 1.0, len(self.edges)), self.edges)
        edges = curve(np.linspace(0.0, 1.0, rows + 1))
        plan = self._tabulated(contact, columns, edges, self.aspect, self.curvature, low, high)
        return replace(plan, crowned=self.crowned, off_end=self.off_end)

    @classmethod
    def _tabulated(
        cls, contact: Contact, columns: int, edges: Array, aspect: float, curvature: float, least: float, most: float
    ) -> PatchPlan:
        """The plan with its near tables."""
        bodies = bodies_under(contact)
        follows = aspect > 0.0
        first, step, power, levels = 0.0, 1.0, 3.0, np.array([0.0])
        if not follows:
            count = int(np.ceil(np.log(most / least) / STEP)) + 1
            first, step, power = float(np.log(least)), STEP, 2.0
            levels = first + step * np.arange(max(count, 4))
        along = _along_meridian(contact, edges, follows=follows)
        tables = [near_table(columns, np.exp(x), along, bodies, ends=not follows) / np.exp(power * x) for x in levels]
        ends = [end for body in bodies for end in body.strengths()] if follows else []
        begins = _begins(contact)
        of_hertz = not follows and contact.law.curve is None
        span = TAILED if begins else span_of(columns) if of_hertz else SPAN
        cells = (columns, edges, along, aspect, curvature, least, most, begins, span)
        return cls(*cells, np.stack(tables), first, step, power, ends)

    @property
    def follows(self) -> bool:
        """Whether rows move with the nearest point."""
        return self.aspect > 0.0

    @property
    def z(self) -> Array:
        """Middles (rows,) of the rows."""
        return 0.5 * (self.edges[1:] + self.edges[:-1])

    @property
    def length(self) -> Array:
        """Lengths (rows,) of the rows."""
        return np.diff(self.edges)


@dataclass(frozen=True, eq=False)
class OnMeridian:
    """A flexible body under the rows: its far field, and its meridian in the coordinate of the first surface: z = sign
    z_A + offset.
    """

    far: FarField
    sign: float
    offset: float
    way: float  # 1 of the first body of the pair, -1 of the second

    @classmethod
    def of(cls, contact: Contact, port: Any) -> OnMeridian:
        return cls(port.surface.far, *meridian(contact, port), 1.0 if port is contact.a else -1.0)

    @property
    def half_space(self) -> float:
        """(1 - nu^2)/(pi E) [1/Pa], displacement of the half-space times distance per force."""
        return (1.0 - self.far.poisson_ratio**2) / (np.pi * self.far.youngs_modulus)

    def strengths(self) -> list[tuple[float, float]]:
        """For each end its position on the first surface's meridian, and displacement times E... of a unit force next
        to it, times the distance [m/N m].
        """
        far = self.far
        if far.quarter is None:
            return []
        image = (1.0 - far.poisson_ratio**2) / (2.0 * np.pi)
        correction = float(far.quarter.displacement(0.0, 1.0, 1.0))
        return [((end.z - self.offset) / self.sign, (image + correction) / far.youngs_modulus) for end in far.ends]


def bodies_under(contact: Contact) -> list[OnMeridian]:
    """The flexible bodies under a patch."""
    return [OnMeridian.of(contact, port) for port in contact.ports if port.surface.grid is not None]


def _begins(contact: Contact) -> float:
    """The gap [m] below which the law carries pressure, 0 for one that begins at touch."""
    curve = contact.law.curve
    return max(-curve.begins, 0.0) if curve is not None else 0.0


def _counts(cell_error: float, wider: float, *, follows: bool, crowned: bool) -> tuple[int, int]:
    """Strips and rows that add about `cell_error` to force and largest pressure: odd numbers, which have a cell where
    Hertz's pressure is largest; `wider`: W over that of a patch of Hertz's pressure.
    """
    columns = _odd(wider * (STRIPS_ERROR / cell_error) ** 0.5)
    if follows:
        return columns, columns
    return columns, _odd((CROWNED_ERROR / cell_error) ** (1.0 / 3.0)) if crowned else 2 * columns - 1


def _odd(count: float) -> int:
    """The odd number nearest to `count`."""
    return max(2 * round(0.5 * (count - 1.0)) + 1, FEWEST)


def rows_follow(contact: Contact) -> bool:
    """Whether the rows of a contact move with the nearest point: its patch is short, and their boundaries not given."""
    return not rows_given(contact) and _aspect(*relative_curvatures(contact)) < LINE_ASPECT


def is_crowned(contact: Contact) -> bool:
    """Whether rows are fixed and fine about a crown, which deviates from the straight line between its ends by more
    than `STRAIGHT`: axes that cross by round-off, or slightly, do not count.
    """
    if rows_follow(contact) or rows_given(contact):
        return False
    low, high = common_width(contact)
    return relative_curvatures(contact)[1] * (high - low) > 8.0 * STRAIGHT


def widest(contact: Contact) -> float:
    """Largest W [m]: beyond it, the half-space does not represent the bodies."""
    across, along = smallest_radii(contact)
    aspect = _aspect(*relative_curvatures(contact)) if rows_follow(contact) else 0.0
    return min(across * WIDEST, along * (LONGEST_ROWS / aspect) if aspect > 0.0 else np.inf)


def smallest_radii(contact: Contact) -> tuple[float, float]:
    """Smallest radius of curvature [m] of the two surfaces, across and along the first meridian: of an extruded curve
    across which patches lie where they face each other, of one along which they travel where it is flattest, of others
    in any direction in their middles."""
    if faces_curve(contact) and (contact.meeting is not None or not _lies_along(contact)):
        across, along = (1.0 / k if k > 0.0 else np.inf for k in meeting_place(contact).sharper)
        return across, along
    radius = min((r for r in (radius_of(port.surface) for port in contact.ports) if r > 0.0), default=np.inf)
    return radius, radius


def _aspect(across: float, along: float) -> float:
    """Length over width of Hertz's ellipse of the two relative curvatures."""
    return (across / along) ** ELLIPSE if along > 0.0 else np.inf


def end_places(contact: Contact) -> list[float]:
    """Positions of the free ends of both bodies on the first surface's meridian at the start, z [m]."""
    bodies = bodies_under(contact)
    return [(end.z - body.offset) / body.sign for body in bodies if body.far is not None for end in body.far.ends]


def relative_curvatures(contact: Contact) -> tuple[float, float]:
    """Curvatures of the first surface relative to the second [1/m], across and along the meridian of the first, where
    they face each other at the start: balls and extruded curves at their nearest points, others in their middles.
    """
    a, b = contact.a, contact.b
    if _faces_anywhere(contact):
        return meeting_place(contact).curvatures
    z_a = middle_of(a.surface)
    first = [float(k) for k in a.surface.shape.curvatures(0.0, z_a)]
    second = [float(k) for k in b.surface.shape.curvatures(0.0, middle_of(b.surface))]
    axes = [port.body.to_world(port.surface.shape.e_a) - port.body.to_world(np.zeros(3)) for port in (a, b)]
    if b.surface.shape.profile().planar:
        return first[0], first[1]
    if a.surface.shape.profile().planar:
        return second[0], second[1]
    lever = levers(contact)[0]
    if np.any(lever):
        normal = lever / np.linalg.norm(lever)
        if abs(float(axes[1] @ normal)) > PARALLEL:  # a tilt in the plane of both axes does not make them cross
            across_normal = axes[1] - (axes[1] @ normal) * normal
            axes[1] = across_normal / np.linalg.norm(across_normal)
    c2 = float(axes[0] @ axes[1]) ** 2
    return first[0] + c2 * second[0] + (1.0 - c2) * second[1], first[1] + c2 * second[1] + (1.0 - c2) * second[0]


def faces_curve(contact: Contact) -> bool:
    """Whether one of the surfaces is an extruded curve, or over a plane."""
    return any(port.surface.shape.profile().free for port in contact.ports)


def _faces_anywhere(contact: Contact) -> bool:
    """Whether the place where the surfaces face each other is to be searched: of balls and extruded curves."""
    return faces_curve(contact) or any(is_ball(port) for port in contact.ports)


def stretch_at_start(contact: Contact) -> float:
    """Length along the meridian of the first surface per z where the surfaces face each other at the start; 1 in the
    middle of others than balls and extruded curves."""
    return float(np.hypot(1.0, meeting_place(contact).slope)) if _faces_anywhere(contact) else 1.0


def _along_meridian(contact: Contact, edges: Array, *, follows: bool) -> Along:
    """The rows between `edges` [m; in W where they follow] by arc length: of rows that follow, and along a helical
    surface, by the slope at the start, of given ones along the whole meridian; that of others is nearly straight."""
    stretch = stretch_at_start(contact) if follows or contact.a.surface.shape.profile().twist else 1.0
    if follows or not rows_given(contact):
        place = 1.0 if follows else stretch
        return Along(0.5 * stretch * (edges[1:] + edges[:-1]), stretch * np.diff(edges), lambda z: place * z)
    shape, grid = contact.a.surface.shape, np.asarray(contact.a.surface.grid.z)
    z = np.linspace(grid[0], grid[-1], SAMPLES)
    steep = stretch * np.hypot(1.0, shape.slope_at(z))
    length = np.append(0.0, np.cumsum(0.5 * (steep[1:] + steep[:-1]) * np.diff(z)))
    s, radial, axial = np.interp(edges, z, length), *shape.profile().normal_at(0.5 * (edges[1:] + edges[:-1]))
    weight = cutoff(np.outer(radial, radial) + np.outer(axial, axial))
    return Along(0.5 * (s[1:] + s[:-1]), np.diff(s), lambda at: np.interp(at, z, length), weight)


def rows_given(contact: Contact) -> bool:
    """Whether the boundaries of the rows are given."""
    return contact.cells is not None and np.ndim(contact.cells[1]) > 0


def _given_edges(contact: Contact) -> Array:
    """The given boundaries (rows + 1,) [m]. Raises `InputError` where they leave the surfaces, and for friction on rows
    whose normals differ by more than the half-space between them allows."""
    edges = np.asarray(contact.cells[1] if contact.cells else ())
    low, high = common_width(contact)
    if edges[0] < low or edges[-1] > high:
        raise InputError(
            f"contact {contact.name!r}: cells: the rows reach from z = {edges[0]:g} to {edges[-1]:g} m, the surfaces "
            f"only from {low:g} to {high:g} m"
        )
    angle = np.arctan(contact.a.surface.shape.slope_at(np.linspace(edges[0], edges[-1], SAMPLES)))
    if contact.friction.acts and np.ptp(angle) > WHOLE:
        raise InputError(
            f"contact {contact.name!r}: cells: the normals of the rows differ by {np.ptp(angle):.2g} rad, with "
            f"friction at most by {WHOLE:g}; take fewer of them"
        )
    return edges


def widths(contact: Contact) -> Array:
    """The limits (n, 2) [m] on the first surface's meridian between which it, and the second where that ends, have
    material where they face each other at the start. A rigid surface ends where the table of its profile does.
    """
    z = np.asarray(contact.a.surface.grid.z)
    found = [np.asarray([z[0], z[-1]], float)]
    other = contact.b.surface
    along = getattr(other.shape, "table", [None])[0] if other.grid is None else other.grid.z
    if along is not None and (_lies_along(contact) or not other.shape.profile().planar):
        shape, own = other.shape, contact.a.surface.shape
        ends = shape.axis_point + np.outer([along[0], along[-1]], shape.e_a)
        places = (contact.a.body.to_user(contact.b.body.to_world(ends)) - own.axis_point) @ own.e_a
        found.append(np.sort(places + levers(contact)[1] @ in_world(contact.a, own.e_a)))
    return np.array(found)


def common_width(contact: Contact) -> tuple[float, float]:
    """The limits [m] on the first surface's meridian between which both surfaces have material at the start."""
    found = widths(contact)
    low, high = float(found[:, 0].max()), float(found[:, 1].min())
    if not high > low:
        raise InputError(f"contact {contact.name!r}: the two surfaces have no width in common")
    return low, high


def _lies_along(contact: Contact) -> bool:
    """Whether the axes of the two surfaces are nearly parallel, so that ends of one are ends on the other's
    meridian.
    """
    e_a = [port.body.to_world(port.surface.shape.e_a) - port.body.to_world(np.zeros(3)) for port in contact.ports]
    return abs(float(e_a[0] @ e_a[1])) > ALONG


def _refuse_lean(contact: Contact) -> None:
    """Raises `InputError` for a first surface over a plane that leans where it is touched: its cells are equal in the
    plane, and their half-space is that of level ones."""
    if faces_curve(contact) and (lean := meeting_place(contact).lean) > LEANING:
        raise InputError(
            f"contact {contact.name!r}: {contact.a.label} leans by {lean:.2g} rad to its plane where the surfaces face "
            f"each other, {LEANING:g} are allowed of a first surface; give it outward, the direction of its normal "
            "there, or make it the second one"
        )


def _refuse_across(contact: Contact) -> None:
    """Raises `InputError` for a plane or an extruded surface whose axis is across that of the rolling body: its ends
    are not ends of rows.
    """
    for port in contact.ports:
        if port.surface.shape.profile().planar and port.surface.grid is not None and not _lies_along(contact):
            roller = contact.b if port is contact.a else contact.a
            if port is contact.a or port.surface.far.ends:
                cure = "reduce its body with that axis as the direction of the surface, Plane(..., direction=...)"
                if port.surface.shape.profile().curve is not None:
                    cure = "rotate a body so that the axes are parallel"
                raise InputError(
                    f"contact {contact.name!r}: the ends of {port.label} lie across the axis of {roller.label}, along "
                    f"which rows of cells lie; {cure}"
                )


def _nearest(contact: Contact, low: float, high: float) -> float:
    """Position between `low` and `high` [m] on the first meridian where the second surface, its axis parallel, is
    nearest; of an extruded curve across it where they are nearest.
    """
    if faces_curve(contact) and not _lies_along(contact):
        return float(np.clip(meeting_place(contact).z, low, high))
    z = np.linspace(low, high, 401)
    near = np.zeros(len(z))
    for port in contact.ports:
        shape = port.surface.shape
        if not shape.profile().planar:
            sign, offset = meridian(contact, port)
            near += shape.side * shape.radius_at(sign * z + offset)
    return float(np.mean(z[near >= near.max() - 1e-9 * (high - low)]))


def _nearest_tilted(contact: Contact, low: float, high: float) -> float:
    """The same, of axes that are tilted against each other at the start."""
    a, b = contact.ports
    shape, other, lever = a.surface.shape, b.surface.shape, levers(contact)[0]
    z = np.linspace(low, high, 401)
    axis = a.body.to_world(shape.axis_point + np.outer(z, shape.e_a))
    radius = np.zeros(len(z)) if shape.profile().planar else shape.radius_at(z)
    away = b.body.to_user(axis + np.outer(radius / shape.radius_at(middle_of(a.surface)), lever)) - other.axis_point
    if other.profile().planar:
        return float(z[np.argmin(away @ facing(b, a))])
    along = away @ other.e_a
    apart = np.linalg.norm(away - np.outer(along, other.e_a), axis=1)
    return float(z[np.argmax(other.side * (other.radius_at(along) - apart))])


def crowned_edges(low: float, high: float, middle: float, rows: int) -> Array:
    """Edges (rows + 1,) [m] of the rows between two lightly loaded ends: `MIDDLE_ROW` of the width around the
    `middle` [m], and growing from there, by x = c sinh(a y), y even.
    """
    width = high - low
    first = min(MIDDLE_ROW, 0.999 / rows) * width

    def edges(c: float) -> Array:
        y = np.linspace(np.arcsinh((low - middle) / c), np.arcsinh((high - middle) / c), rows + 1)
        return middle + c * np.sinh(y)

    from scipy.optimize import brentq

    def excess(log_c: float) -> float:
        return float(np.diff(edges(np.exp(log_c))).min() - first)

    root: Any = brentq(excess, float(np.log(1e-4 * width)), float(np.log(1e3 * width)))
    return edges(float(np.exp(root)))


def off_end_edges(about: Array, rows: int | None) -> Array:
    """Edges (rows + 1,) [m] of rows as short as those between the edges `about` a crown, and towards both ends as those
    of `line_edges`; rows: their number, with all lengths scaled; None: as many as needed.
    """
    low, width = about[0], about[-1] - about[0]
    z = width * 0.5 * (1.0 - np.cos(np.linspace(0.0, np.pi, SAMPLES)))
    crown = np.interp(z, 0.5 * (about[1:] + about[:-1]) - low, np.diff(about))
    end = FIRST_ROW * width + (ROW_GROWTH - 1.0) * np.minimum(z, width - z)
    per_length = 1.0 / np.minimum(crown, end)
    count = np.append(0.0, np.cumsum(0.5 * (per_length[1:] + per_length[:-1]) * np.diff(z)))
    edges = low + np.interp(np.linspace(0.0, count[-1], (rows or _odd(count[-1])) + 1), count, z)
    edges[[0, -1]] = about[[0, -1]]
    return edges


def line_edges(low: float, high: float, rows: int) -> Array:
    """Edges (rows + 1,) [m] of the rows between two ends under pressure: growing from both of them."""
    width = high - low
    half = rows // 2
    steps = FIRST_ROW * ROW_GROWTH ** np.arange(half)
    steps = np.minimum(steps, _largest_row(steps, rows))
    inner = np.concatenate([steps, steps[::-1]] if rows % 2 == 0 else [steps, steps[-1:], steps[::-1]])
    return low + width * np.concatenate([[0.0], np.cumsum(inner)]) / inner.sum()


def _largest_row(steps: Array, rows: int) -> float:
    """Upper bound of the rows such that they fill the width when the first ones have the given size."""
    from scipy.optimize import brentq

    def missing(largest: float) -> float:
        cut = np.minimum(steps, largest)
        return float(2.0 * cut.sum() + (cut[-1] if rows % 2 else 0.0)) - 1.0

    if missing(float(steps[-1])) <= 0.0:
        return float(steps[-1])
    return float(brentq(missing, float(steps[0]) * 0.1, float(steps[-1])))  # pyright: ignore[reportArgumentType]


def near_table(columns: int, width: float, along: Along, bodies: list[Any], *, ends: bool) -> Array:
    """Weak displacement (columns, rows, rows) [m^3/Pa] by distance in strips, of the receiving row, of the row under
    pressure. width W [m].
    """
    strip, z, length = 2.0 * width / columns, along.s, along.length
    k = strip * np.arange(columns)[:, None, None]
    seen, loaded = z[None, :, None], z[None, None, :]
    total = sum(body.half_space for body in bodies) * rectangle(k, seen - loaded, strip, length)
    for (end, side, _), those in _ends_of(bodies).items() if ends else ():
        place = along.arc(end)
        a, b = (np.maximum(side * (place - v), 0.0) for v in (seen, loaded))
        total += sum(body.half_space for body in those) * rectangle(k, a + b, strip, length)
        quarter = those[0].far.quarter.displacement(k, a, b)
        total += sum(1.0 / body.far.youngs_modulus for body in those) * quarter * strip * length
    weak = total * strip * length[:, None]
    if along.weight is not None:
        weak *= along.weight
    return 0.5 * (weak + weak.transpose(0, 2, 1))


def _ends_of(bodies: list[Any]) -> dict[tuple[float, int, float], list[Any]]:
    """Bodies by position and side of their ends on the first meridian, and Poisson ratio: equal rollers displace the
    surface equally.
    """
    found: dict[tuple[float, int, float], list[Any]] = {}
    for body in bodies:
        for end in body.far.ends:
            place = (end.z - body.offset) / body.sign
            found.setdefault((place, int(body.sign) * end.side, body.far.poisson_ratio), []).append(body)
    return found


def radius_of(surface: Surface) -> float:
    """Smallest radius of curvature [m]; 0 of a plane; of an extruded curve where it is flattest, at most its length."""
    if surface.shape.profile().height is not None:
        return 1.0 / max(float(np.min(np.abs(surface.shape.sampled_curvatures()))), 1.0 / surface.shape.size)
    if (curve := surface.shape.profile().curve) is not None:
        theta = curve.knots if surface.grid is None else surface.grid.theta
        return 1.0 / max(float(np.min(np.abs(curve.curvature(theta)))), 1.0 / curve.length)
    k = max(abs(float(v)) for v in surface.shape.curvatures(0.0, middle_of(surface)))
    return 1.0 / k if k > 0.0 else 0.0
