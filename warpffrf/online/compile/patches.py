r"""Pairs whose pressures stand on cells that travel with the patch -> device tables (kernels of `patch`).

Across, cells are equal strips of 2 W/columns, W the half-width that follows the load. Along the meridian of the first
surface rows are

- of a *line* contact at fixed places of the width that both surfaces have in common, finer towards ends that carry
  pressure; the half-space between cells, with the ends of both bodies, is tabulated for levels of W;
- of a *point* contact, short beside its ends, about the nearest place, with an aspect that Hertz's ellipse has at any
  load, so that one table, for W = 1, is all: displacement per pressure grows with W. What the ends add is taken at the
  middle.

Love's integral over the rectangle of a cell at the centre of another (A. E. H. Love, 1929; K. L. Johnson, "Contact
Mechanics", 3.4), of both bodies with E and nu of their own, times the area of the cell that sees it, made symmetric.
"""

from __future__ import annotations

from collections.abc import Collection
from dataclasses import dataclass
from typing import Any

import numpy as np
from warpffrf_kernels.core.model import Model
from warpffrf_kernels.patch.spline_tables import LINE

from warpffrf.model.bodies import Body, Ground
from warpffrf.model.contact import Contact
from warpffrf.model.contact_surface import ContactSurface
from warpffrf.model.errors import InputError
from warpffrf.model.far_field import WHOLE, FarField
from warpffrf.online.compile.patch_sides import Surface, meridian
from warpffrf.online.compile.patches_beside import fill_beside

Array = np.ndarray
LINE_ASPECT = 8.0  # of Hertz's ellipse, from which rows stay where they are
ELLIPSE = 0.636  # aspect of Hertz's ellipse: the ratio of curvatures to this power (Hamrock and Brewe 1983)
# strips, of which the patch takes eight; rows. Odd numbers have a cell where Hertz's pressure is largest.
COLUMNS, LINE_ROWS, CROWNED_ROWS, POINT_ROWS = 11, 21, 27, 11
FIRST_ROW, ROW_GROWTH = 0.004, 1.6  # of the width: rows at ends under pressure; their growth from there
MIDDLE_ROW = 0.015  # of the width: rows where a crown carries; an ellipse of a third of the width takes a dozen
HUGGING = 0.2  # of the larger curvature: below it patches are wide beside the radius, and belong to material grids
NARROWEST = 1e-4  # W times the relative curvature
WIDEST = 0.5 * WHOLE * 0.95  # W over a radius of curvature: a patch keeps within WHOLE
STEP = 0.3  # of ln W between levels: cubic interpolation errs by 1e-5
FAR_COLUMNS = 4  # splines beside those over 2 W
TAPS = 3  # splines across that a window has room for at least, also where a surface has but two


@dataclass(frozen=True, eq=False)
class PatchPlan:
    """Cells of a pair: `columns` strips, rows at `z` with lengths `length` [m, or W where they follow]; and near
    tables (levels, columns, rows, rows) from ln W `first` on, `step` apart, over W^power."""

    columns: int
    z: Array
    length: Array
    follows: bool
    aspect: float
    curvature: float
    least: float
    most: float
    table: Array
    first: float
    step: float
    power: float
    ends: list[tuple[float, float]]  # z on A, strength

    @classmethod
    def of(cls, contact: Contact) -> PatchPlan:
        """The plan of a contact with grid "patch"."""
        a, b = contact.a.surface, contact.b.surface
        across, along = relative_curvatures(contact)
        if not across > 0.0:
            raise InputError(
                f"contact {contact.name!r}: the surfaces are as curved as each other, a patch of cells has no width "
                'there; use grid="material"'
            )
        least = NARROWEST / across
        most = WIDEST * min(radius for radius in (_radius(a), _radius(b)) if radius > 0.0)
        aspect, follows = _aspect(across, along), rows_follow(contact)
        columns, rows = contact.cells or (
            COLUMNS,
            POINT_ROWS if follows else CROWNED_ROWS if along > 0.0 else LINE_ROWS,
        )
        bodies = [_OnMeridian.of(contact, port) for port in contact.ports if port.surface.grid is not None]
        if follows:
            edges = aspect * np.linspace(-1.0, 1.0, rows + 1)
            most = min(most, most / aspect)
            first, step, power, levels = 0.0, 1.0, 3.0, np.array([0.0])
        else:
            low, high = common_width(contact)
            edges = crowned_edges(low, high, _nearest(contact, low, high), rows)
            if not along > 0.0:
                edges = line_edges(low, high, rows)
            count = int(np.ceil(np.log(most / least) / STEP)) + 1
            first, step, power = float(np.log(least)), STEP, 2.0
            levels = first + step * np.arange(max(count, 4))
        z, length = 0.5 * (edges[1:] + edges[:-1]), np.diff(edges)
        table = np.stack(
            [near_table(columns, np.exp(x), z, length, bodies, ends=not follows) / np.exp(power * x) for x in levels]
        )
        ends = [end for body in bodies for end in body.strengths()] if follows else []
        return cls(columns, z, length, follows, aspect, across, least, most, table, first, step, power, ends)


@dataclass(frozen=True, eq=False)
class _OnMeridian:
    """A flexible body under the rows: its far field, and its meridian as the first surface counts it: z = sign z_A +
    offset."""

    far: FarField
    sign: float
    offset: float

    @classmethod
    def of(cls, contact: Contact, port: Any) -> _OnMeridian:
        return cls(port.surface.far, *meridian(contact, port))

    def seen(self, z: Array) -> Array:
        """z of this body at z of the first surface."""
        return self.sign * z + self.offset

    def strengths(self) -> list[tuple[float, float]]:
        """Of each end its place on the first surface's meridian, and displacement times E... of a unit force beside it,
        times the distance [m/N m]."""
        far = self.far
        if far.quarter is None:
            return []
        image = (1.0 - far.poisson_ratio**2) / (2.0 * np.pi)
        correction = float(far.quarter.displacement(0.0, 1.0, 1.0))
        return [((end.z - self.offset) / self.sign, (image + correction) / far.youngs_modulus) for end in far.ends]


def rows_follow(contact: Contact) -> bool:
    """Whether the rows of a contact lie about the nearest place: its patch is short."""
    return _aspect(*relative_curvatures(contact)) < LINE_ASPECT


def _aspect(across: float, along: float) -> float:
    """Length over width of Hertz's ellipse of the two relative curvatures."""
    return (across / along) ** ELLIPSE if along > 0.0 else np.inf


def end_places(contact: Contact) -> list[float]:
    """Where the free ends of both bodies lie on the first surface's meridian at the start, z [m]."""
    bodies = [_OnMeridian.of(contact, port) for port in contact.ports if not port.rigid]
    return [(end.z - body.offset) / body.sign for body in bodies if body.far is not None for end in body.far.ends]


def relative_curvatures(contact: Contact) -> tuple[float, float]:
    """Of the first surface against the second [1/m], across and along the meridian of the first, where they face each
    other at the start."""
    a, b = contact.a, contact.b
    z_a = _middle(a.surface)
    first = [float(k) for k in a.surface.shape.curvatures(0.0, z_a)]
    second = [float(k) for k in b.surface.shape.curvatures(0.0, _middle(b.surface))]
    axes = [port.body.to_world(port.surface.shape.e_a) - port.body.to_world(np.zeros(3)) for port in (a, b)]
    if b.surface.shape.profile().planar:
        return first[0], first[1]
    if a.surface.shape.profile().planar:
        return second[0], second[1]
    c2 = float(axes[0] @ axes[1]) ** 2
    return first[0] + c2 * second[0] + (1.0 - c2) * second[1], first[1] + c2 * second[1] + (1.0 - c2) * second[0]


def common_width(contact: Contact) -> tuple[float, float]:
    """The places [m] of the first surface's meridian between which both surfaces have material at the start."""
    z = np.asarray(contact.a.surface.grid.z)
    low, high = float(z[0]), float(z[-1])
    other = contact.b.surface
    if other.grid is not None and not other.shape.profile().planar:
        shape, own = other.shape, contact.a.surface.shape
        ends = shape.axis_point + np.outer([other.grid.z[0], other.grid.z[-1]], shape.e_a)
        places = (contact.a.body.to_user(contact.b.body.to_world(ends)) - own.axis_point) @ own.e_a
        low, high = max(low, float(places.min())), min(high, float(places.max()))
    if not high > low:
        raise InputError(f"contact {contact.name!r}: the two surfaces have no width in common")
    return low, high


def _nearest(contact: Contact, low: float, high: float) -> float:
    """Where between `low` and `high` [m] on the first meridian the second surface, its axis parallel, is nearest."""
    z = np.linspace(low, high, 401)
    near = np.zeros(len(z))
    for port in contact.ports:
        shape = port.surface.shape
        if not shape.profile().planar:
            sign, offset = meridian(contact, port)
            near += shape.side * shape.radius_at(sign * z + offset)
    return float(np.mean(z[near >= near.max() - 1e-9 * (high - low)]))


def crowned_edges(low: float, high: float, middle: float, rows: int) -> Array:
    """Edges (rows + 1,) [m] of the rows between two ends that carry little: `MIDDLE_ROW` of the width around the
    `middle` [m], and growing from there, by x = c sinh(a y), y even."""
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


def line_edges(low: float, high: float, rows: int) -> Array:
    """Edges (rows + 1,) [m] of the rows between two ends under pressure: growing from both of them."""
    width = high - low
    half = rows // 2
    steps = FIRST_ROW * ROW_GROWTH ** np.arange(half)
    steps = np.minimum(steps, _largest_row(steps, rows))
    inner = np.concatenate([steps, steps[::-1]] if rows % 2 == 0 else [steps, steps[-1:], steps[::-1]])
    return low + width * np.concatenate([[0.0], np.cumsum(inner)]) / inner.sum()


def _largest_row(steps: Array, rows: int) -> float:
    """What rows must not exceed, so that they fill the width when the first ones are as wanted."""
    from scipy.optimize import brentq

    def missing(largest: float) -> float:
        cut = np.minimum(steps, largest)
        return float(2.0 * cut.sum() + (cut[-1] if rows % 2 else 0.0)) - 1.0

    if missing(float(steps[-1])) <= 0.0:
        return float(steps[-1])
    return float(brentq(missing, float(steps[0]) * 0.1, float(steps[-1])))  # pyright: ignore[reportArgumentType]


def near_table(columns: int, width: float, z: Array, length: Array, bodies: list[Any], *, ends: bool) -> Array:
    """Weak displacement (columns, rows, rows) [m^3/Pa] by distance in strips: of the row that sees, of the row under
    pressure. width W [m]; z, length [m] of the rows on the first surface."""
    strip = 2.0 * width / columns
    k = strip * np.arange(columns)[:, None, None]
    total = np.zeros((columns, len(z), len(z)))
    for body in bodies:
        far = body.far
        own = body.seen(z)
        seen, loaded = own[None, :, None], own[None, None, :]
        c = (1.0 - far.poisson_ratio**2) / (np.pi * far.youngs_modulus)
        total += c * rectangle(k, seen - loaded, strip, length)
        for end in far.ends if ends else ():
            a, b = (np.maximum(end.side * (end.z - v), 0.0) for v in (seen, loaded))
            total += c * rectangle(k, a + b, strip, length)
            total += far.quarter.displacement(k, a, b) * strip * length / far.youngs_modulus
    weak = total * strip * length[:, None]
    return 0.5 * (weak + weak.transpose(0, 2, 1))


def rectangle(x: Array, z: Array, width: float, length: Array) -> Array:
    """Integral of 1/r [m] over a rectangle about the origin, seen from (x, z)."""
    a, b = 0.5 * width, 0.5 * length
    return _corner(x + a, z + b) - _corner(x + a, z - b) - _corner(x - a, z + b) + _corner(x - a, z - b)


def _corner(x: Array, z: Array) -> Array:
    """The integral over the rectangle between the origin and (x, z), odd in both."""

    def part(s: Array, t: Array) -> Array:
        return s * np.arcsinh(t / np.where(s == 0.0, np.inf, np.abs(s)))

    return part(x, z) + part(z, x)


def _middle(surface: Surface) -> float:
    return 0.0 if surface.grid is None else float(np.mean(np.asarray(surface.grid.z)[[0, -1]]))


def _radius(surface: Surface) -> float:
    """Smallest radius of curvature [m]; 0 of a plane."""
    k = max(abs(float(v)) for v in surface.shape.curvatures(0.0, _middle(surface)))
    return 1.0 / k if k > 0.0 else 0.0


def patch_plans(contacts: list[Contact], dynamic: Collection[int]) -> tuple[dict[int, PatchPlan], list[str]]:
    """Plans by number of the contact, of those on patches, and notes on what grid="auto" has chosen. Raises
    `InputError` where one of their bodies is loaded by a contact on a material grid too. dynamic: indices of bodies
    whose local modes have inertia."""
    taken = {
        i
        for i, contact in enumerate(contacts)
        if contact.grid == "patch" or (contact.grid == "auto" and _fits(contact, dynamic))
    }
    notes: list[str] = []
    while beside := next(_beside_a_grid(contacts, taken), None):  # one that goes may take others along
        i, port, other = beside
        if contacts[i].grid == "patch":
            raise InputError(
                f"contact {contacts[i].name!r}: body {port.body.name!r} is loaded by {other.name!r} too, whose hats "
                "and the cells of a patch do not feel each other by its local modes; give both the same grid="
            )
        taken.remove(i)
        notes.append(
            f"contact {contacts[i].name!r}: pressures on the material grid, as those of {other.name!r} on body "
            f"{port.body.name!r} are"
        )
    notes += [
        f"contact {contacts[i].name!r}: pressures on cells that travel with the patch, for which its bodies were "
        'reduced (patch_grid); grid="material" takes the contact grid instead'
        for i in sorted(taken)
        if contacts[i].grid == "auto"
    ]
    return {i: PatchPlan.of(contacts[i]) for i in sorted(taken)}, notes


def _fits(contact: Contact, dynamic: Collection[int]) -> bool:
    """Whether grid="auto" takes a patch of cells: the contact is none of what they cannot do, and no conformal one."""
    if contact.without_patch() is not None or any(port.body.index in dynamic for port in contact.ports):
        return False
    across, _ = relative_curvatures(contact)
    sharpest = max(1.0 / radius for radius in (_radius(p.surface) for p in contact.ports) if radius > 0.0)
    return across > HUGGING * sharpest


def _beside_a_grid(contacts: list[Contact], taken: set[int]) -> Any:
    """Of those `taken` for patches the ones on a body that another contact loads on a material grid: number, port, and
    the other."""
    for i in sorted(taken):
        for port in (port for port in contacts[i].ports if not port.rigid):
            for j, other in enumerate(contacts):
                if j not in taken and any(q.body is port.body for q in other.ports):
                    yield i, port, other


def filled(count: int) -> int:
    """`count` numbers filled up to whole lines of LINE."""
    return -(-count // LINE) * LINE


def fill_patches(collector: Any, m: Model) -> None:
    """Cells, near tables and far fields of all pairs on patches."""
    plans, contacts = collector.patches, collector.scene.contacts
    per_pair: dict[str, list] = {
        name: [] for name in ("columns", "first", "second", "curvature", "follows", "aspect", "middle",
                              "least_width",
                              "most_width", "layer", "row_start", "near_start", "near_levels", "near_first",
                              "near_step", "near_power", "end_start")
    }  # fmt: skip
    z, length, near, end_z, strength = [np.zeros(0)], [np.zeros(0)], [np.zeros(0)], [], []
    for i, contact in enumerate(contacts):
        plan = plans.get(i)
        sides = [collector.surfaces[s].surface for s in collector.sides[2 * i : 2 * i + 2]]
        values = dict.fromkeys(per_pair, 0)
        values |= {"row_start": sum(map(len, z)), "near_start": sum(map(len, near)), "end_start": len(end_z)}
        if plan is not None:
            first, second = (side.number for side in sides)
            values |= {
                "columns": plan.columns, "first": first, "second": second, "curvature": plan.curvature,
                "follows": int(plan.follows), "aspect": plan.aspect if plan.follows else 1.0,
                "middle": float(np.mean(plan.z)), "least_width": plan.least, "most_width": plan.most,
                "layer": contact.law.compliance, "near_levels": len(plan.table), "near_first": plan.first,
                "near_step": plan.step, "near_power": plan.power,
            }  # fmt: skip
            z.append(plan.z)
            length.append(plan.length)
            near.append(plan.table.ravel())
            end_z += [at for at, _ in plan.ends]
            strength += [value for _, value in plan.ends]
        for name, value in values.items():
            per_pair[name].append(value)
    per_pair["end_start"].append(len(end_z))
    far: dict[str, list] = {
        name: [] for name in ("far_start", "far_sectors", "far_columns", "column_knots", "row_knots", "mode_start")
    }
    operators, knots, modes = [np.zeros(0)], [np.zeros(0)], [np.zeros(0)]
    far_of, nodes = [], LINE
    for body, _, surface in collector.surfaces:
        if not plans or not isinstance(surface, ContactSurface) or surface.far is None:
            far_of.append(-1)
            continue
        far_of.append(len(far["far_start"]))
        splines, grid = surface.splines, surface.grid
        column_knots = np.zeros(0)
        if not splines.turn:
            column_knots = (splines.theta_knots - grid.theta_start) / grid.pitch
        values = {
            "far_start": sum(map(len, operators)), "far_sectors": len(surface.far.lags),
            "far_columns": grid.columns_per_sector, "column_knots": sum(map(len, knots)),
            "row_knots": sum(map(len, knots)) + len(column_knots), "mode_start": sum(map(len, modes)),
        }  # fmt: skip
        for name, value in values.items():
            far[name].append(value)
        operators.append(surface.far.lags.ravel())
        knots += [column_knots, splines.z_knots]
        modes.append(_spline_modes(body, collector, surface).ravel())
        widest = max((plan.most for plan in plans.values()), default=0.0)
        radius = float(np.min(surface.shape.radius_at(np.asarray(grid.z))))
        columns = min(int(np.ceil(2.0 * widest / (grid.pitch * radius))) + FAR_COLUMNS, splines.turn or grid.columns)
        nodes = max(nodes, filled(max(columns, TAPS) * grid.rows))
    places = max((plan.columns * filled(len(plan.z)) for plan in plans.values()), default=0)
    beside = fill_beside(collector)
    if beside["beside_side"]:
        m.pairs.beside = 1
    collector.fill(
        collector.elements.patches, **beside,
        count=len(plans), touching=len(beside["beside_side"]), far_nodes=nodes, places=places, **per_pair, **far,
        far_of=far_of, row_z=np.concatenate(z), row_length=np.concatenate(length), near=np.concatenate(near),
        end_z=end_z, end_strength=strength, far=np.concatenate(operators), knot=np.concatenate(knots),
        mode=np.concatenate(modes),
    )  # fmt: skip


def _spline_modes(body: Body | Ground, collector: Any, surface: ContactSurface) -> Array:
    """Normal displacement (columns rows, modes) of the body's modes, as splines."""
    if collector.local.count(body.index):
        raise InputError(
            f"body {body.name!r}: its local modes have inertia, and a patch of cells needs them quasi-static; use "
            'local="quasi_static", or grid="material"'
        )
    return np.ascontiguousarray(surface.splines.of_hats(surface.mode_normal))
