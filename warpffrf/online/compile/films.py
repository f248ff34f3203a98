r"""Oil films of a scene -> device tables of their points, functions and compliances (kernels of `films`).

Pressures of evaluation "semi" are made of the hats of the first surface's grid: a function a hat. Points are Gauss
points, `ACROSS` x `ALONG` in each cell of the grid, on the true surface. With D the compliance of the surface's local
modes and M the Gram matrix of the hats, pressures open the gap at the hats by G p, G = D M; of pressures that are given
that is constant, `lift`. Voids stand at the hats, lumped on their areas, and leave through faces half-way between them.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
from warpffrf_kernels.core.model import Films
from warpffrf_kernels.films import asperities as asperity_kernels
from warpffrf_kernels.films import oil as oil_kernels
from warpffrf_kernels.films import sampling, system

from warpffrf.model import rotation as rot
from warpffrf.model.contact_grid import cell_edges
from warpffrf.model.contact_surface import ContactSurface
from warpffrf.model.errors import InputError
from warpffrf.model.films import Film
from warpffrf.model.oils import Barus, Newtonian, Oil, Roelands
from warpffrf.online.compile.collector import Collector
from warpffrf.online.compile.compliance_tables import hat_gram, modal_moments

Array = np.ndarray
ACROSS, ALONG = 3, 2  # Gauss points of a cell: h^3 of a cell's gap and its slopes squared
FORM_COLUMNS, FORM_ROWS = 720, 65  # of the table of the second surface's form: half a degree
RULES = {
    "mass_conserving": sampling.MASS_CONSERVING, "reynolds": sampling.REYNOLDS, "half": sampling.HALF,
    "none": sampling.NONE,
}  # fmt: skip
MANY = 1000  # unknowns


@dataclass(frozen=True)
class Points:
    """Of a film: the functions at each point (points, 4), their values and slopes [1/m], and weights [m2]."""

    theta: Array
    z: Array
    weight: Array
    function: Array
    value: Array
    around: Array
    along: Array


class Tables:
    """What is gathered of all films: one value each, or parts that stand one behind the other."""

    def __init__(self) -> None:
        self.ones: dict[str, list[Any]] = {}
        self.parts: dict[str, list[Array]] = {}

    def one(self, **values: Any) -> None:
        """A value of a film."""
        for name, value in values.items():
            self.ones.setdefault(name, []).append(value)

    def part(self, **values: Any) -> None:
        """Entries of a film."""
        for name, value in values.items():
            self.parts.setdefault(name, []).append(np.asarray(value))

    def length(self, name: str) -> int:
        """Entries so far."""
        return sum(map(len, self.parts.get(name, [])))

    def starts(self, name: str) -> Array:
        """Where the entries of each film begin, and their number."""
        return np.cumsum([0, *map(len, self.parts.get(name, []))])

    def values(self) -> dict[str, Any]:
        """All of them, as the model takes them."""
        found: dict[str, Any] = {name: np.asarray(ones) for name, ones in self.ones.items()}
        return found | {name: np.concatenate(parts) for name, parts in self.parts.items()}


def fill_films(collector: Collector) -> None:
    """Tables of all films. Raises `InputError` for what films do not do."""
    films, topic = collector.scene.films, collector.elements.films
    declared: Any = Films
    tables = Tables()
    for number, film in enumerate(films):
        _add_film(collector, film, number, tables)
    values = dict.fromkeys(declared.declarations, np.zeros(0)) | tables.values()
    if films:
        for name, of in (("hat", "lift"), ("function", "given"), ("point", "weight"), ("unknown", "function_of")):
            values[f"{name}_start"] = tables.starts(of)
        for name in ("compliance", "shape", "moment", "rough_moment", "table"):
            values[f"{name}_start"] = tables.starts(name)[:-1]
        lines, columns = values["unknowns"] + values["rough"], int(system.RIGID) + values["modes"]
        for name, sizes in (
            ("system", lines), ("matrix", lines * (lines + 1 + 2 * columns)), ("column", columns),
            ("square", columns**2),
        ):  # fmt: skip
            values[f"{name}_start"] = np.concatenate([[0], np.cumsum(sizes)])
        for name, of in (("entry", "entry_point"), ("near", "near")):
            values[f"{name}_start"] = np.append(values[f"{name}_start"], tables.length(of))
        values["rest_v"], values["rest_omega"] = _rest_velocities(collector)
    collector.fill(topic, count=len(films), **values)


def _add_film(collector: Collector, film: Film, number: int, tables: Tables) -> None:
    surface, grid, body = film.a.surface, film.grid, film.a.body
    hats = grid.columns * grid.rows
    held, given = film.held()
    free = np.flatnonzero(~held.ravel())
    unknown_of = np.full(hats, -1)
    unknown_of[free] = np.arange(len(free))
    G = _opening(surface)
    shape = np.asarray(surface.mode_normal).reshape(hats, -1)
    theta, z = (v.ravel() for v in np.meshgrid(film.theta, grid.z, indexing="ij"))
    points = _points(film)
    entries = _entries(points.function, hats)
    kind, numbers = _oil(film.oil, film.label)
    table, ranges = _second_form(film)
    travels = film.cavitation in ("mass_conserving", "reynolds")
    place = surface.shape.point(theta, z) - body.center_of_mass
    moment = modal_moments(surface).reshape(hats, -1).T
    law, law_numbers, law_table = _asperities(film)
    rough = hats if film.law is not None else 0
    faces = _faces(film)
    loaded = G[:, free] if film.law is None else np.hstack([G[:, free], G])
    tables.one(
        first=collector.film_sides[2 * number], second=collector.film_sides[2 * number + 1], modes=shape.shape[1],
        rule=int(RULES[film.cavitation]), oil_kind=kind, oil=numbers, unknowns=len(free),
        thickness=film.clearance() or float(np.median(film.initial_gap())), second_range=ranges,
        rough=rough, asperity_kind=law, asperity=law_numbers, asperity_friction=film.friction,
        table_count=len(law_table), second_counts=table.shape,
        second_start=tables.length("second_form") if table.size else -1,
    )  # fmt: skip
    tables.part(
        compliance=loaded.ravel(), shape=shape.ravel(), moment=moment.ravel(), table=law_table,
        rough_moment=moment[:, :rough].ravel(), hat_area=faces["area"],
        lift=G @ given.ravel(), hat_place=place, hat_form=film.gap_form(theta, z), hat_function=np.arange(hats),
        function_of=free, unknown_of=unknown_of, given=given.ravel(), feeds=_fed(film).ravel().astype(int),
        voids=np.full(hats, int(travels)), place=place, around=_around(surface, theta), along=_along(surface, theta, z),
        second_form=table.ravel(), **faces,
    )  # fmt: skip
    tables.part(
        entry_start=tables.length("entry_point") + entries.start, near_start=tables.length("near") + entries.near_start,
        entry_slot=entries.slot, entry_near=entries.near_at, near=entries.near,
    )  # fmt: skip
    tables.part(entry_point=tables.length("weight") + entries.point)
    tables.part(
        point_place=surface.shape.point(points.theta, points.z) - body.center_of_mass,
        point_around=_around(surface, points.theta), point_along=_along(surface, points.theta, points.z),
        form=film.gap_form(points.theta, points.z), weight=points.weight, function=points.function, value=points.value,
        slope_around=points.around, slope_along=points.along, hat=points.function, between=points.value,
        begin=_filling(film, points, G, given.ravel()),
    )  # fmt: skip
    collector.notes.extend(film.notes)
    if film.law is not None and film.law.remark:
        collector.notes.append(f"{film.label}: {film.law.remark}")
    if len(free) > MANY:
        collector.notes.append(
            f"{film.label}: {len(free)} unknown pressures, and each iteration factors a matrix of so many lines; fewer "
            "rows cost little accuracy"
        )
    if collector.local.count(body.index):
        collector.notes.append(f"{film.label}: local modes move without inertia under its pressure")


def _rest_velocities(collector: Collector) -> tuple[Array, Array]:
    """Velocity of each body's centre of mass, and angular velocity in its axes, as the scene begins."""
    v, omega = [], []
    for body in collector.scene.bodies:
        A = rot.matrix(body.rotation)
        v.append(body.velocity + np.cross(body.angular_velocity, A @ body.center_of_mass))
        omega.append(A.T @ body.angular_velocity)
    return np.array(v), np.array(omega)


def _oil(oil: Oil, label: str) -> tuple[int, list[float]]:
    """Kind and numbers of an oil. Raises `InputError` for one that kernels do not know."""
    a, b = (0.0, 0.0) if oil.density is None else (oil.density.a, oil.density.b)
    if isinstance(oil, Newtonian):
        return int(oil_kernels.NEWTONIAN), [oil.viscosity, 0.0, 0.0, 0.0, a, b]
    if isinstance(oil, Barus):
        return int(oil_kernels.BARUS), [oil.viscosity, oil.coefficient, 0.0, 0.0, a, b]
    if isinstance(oil, Roelands):
        return int(oil_kernels.ROELANDS), [oil.viscosity, oil.coefficient, oil.rise, oil.exponent, a, b]
    raise InputError(f"{label}: an oil of a kind of its own, {oil.label}, is not known to the kernels; take oils.Barus")


def _asperities(film: Film) -> tuple[int, list[float], Array]:
    """Kind, numbers and table of the law of asperities."""
    if film.law is None:
        return int(asperity_kernels.SMOOTH), [0.0] * 4, np.zeros((0, 3))
    curve: Any = film.law.curve
    if curve.form == "exponential":
        return int(asperity_kernels.EXPONENTIAL), list(curve.numbers), np.zeros((0, 3))
    return int(asperity_kernels.TABLE), [0.0] * 4, curve.table


def _opening(surface: ContactSurface) -> Array:
    """G = D M (hats, hats) [m/Pa]."""
    D = surface.compliance(np.arange(surface.grid.columns))
    return D @ hat_gram(surface, 1)[0]


def _around(surface: ContactSurface, theta: Array) -> Array:
    """Unit vectors (n, 3) along the first coordinate of the chart, whatever the side."""
    found = np.asarray(surface.shape.around(theta))
    if not surface.shape.profile().planar:
        found = found * surface.shape.side
    return np.broadcast_to(found, (len(theta), 3))


def _along(surface: ContactSurface, theta: Array, z: Array) -> Array:
    """Unit vectors (n, 3) along z."""
    return np.broadcast_to(np.asarray(surface.shape.along(theta, z)), (len(theta), 3))


def _radius(surface: ContactSurface, z: Array) -> Array:
    """R(z) [m], of a plane 1."""
    return np.broadcast_to(np.asarray(surface.shape.radius_at(z), dtype=float), np.shape(z))


def _stretch(surface: ContactSurface, z: Array) -> Array:
    """Length of the meridian over z."""
    return np.sqrt(1.0 + np.broadcast_to(np.asarray(surface.shape.slope_at(z), dtype=float), np.shape(z)) ** 2)


def _points(film: Film) -> Points:
    surface, grid = film.a.surface, film.grid
    rows, cells_x = grid.rows, grid.columns if grid.periodic else grid.columns - 1
    a, wa = np.polynomial.legendre.leggauss(ACROSS)
    b, wb = np.polynomial.legendre.leggauss(ALONG)
    a, b = (v.ravel() for v in np.meshgrid(0.5 * (a + 1.0), 0.5 * (b + 1.0), indexing="ij"))
    w = 0.25 * np.outer(wa, wb).ravel()
    dz = np.diff(grid.z)
    j, k = (v.ravel()[:, None] for v in np.meshgrid(np.arange(cells_x), np.arange(rows - 1), indexing="ij"))
    theta = (film.theta[j] + a * grid.pitch).ravel()
    z = (grid.z[k] + b * dz[k]).ravel()
    left, right = j * rows + k, (j + 1) % grid.columns * rows + k
    corners = np.repeat(np.concatenate([left, left + 1, right, right + 1], axis=1)[:, None], len(a), axis=1)
    value = np.stack([(1 - a) * (1 - b), (1 - a) * b, a * (1 - b), a * b], axis=1)
    by_a = np.stack([-(1 - b), -b, 1 - b, b], axis=1)
    by_b = np.stack([-(1 - a), 1 - a, -a, a], axis=1)
    cells = len(j)
    radius, stretch = _radius(surface, z), _stretch(surface, z)
    around = np.tile(by_a, (cells, 1)) / (radius * grid.pitch)[:, None]
    along = np.tile(by_b, (cells, 1)) / (np.repeat(dz[k[:, 0]], len(a)) * stretch)[:, None]
    weight = np.tile(w, cells) * grid.pitch * np.repeat(dz[k[:, 0]], len(a)) * radius * stretch
    return Points(theta, z, weight, corners.reshape(-1, 4), np.tile(value, (cells, 1)), around, along)


def _faces(film: Film) -> dict[str, Array]:
    """Areas of the hats' voids, their neighbours and the faces between."""
    surface, grid = film.a.surface, film.grid
    columns, rows = grid.columns, grid.rows
    number = np.arange(columns * rows).reshape(columns, rows)
    edges = cell_edges(grid.z)
    long = np.diff(edges)  # of each row's cell, along z
    wide = np.full(columns, grid.pitch)
    if not grid.periodic:
        wide[[0, -1]] *= 0.5
    middle = 0.5 * (edges[1:] + edges[:-1])
    length = long * _stretch(surface, middle)
    next_around, before_around = np.roll(number, -1, axis=0), np.roll(number, 1, axis=0)
    if not grid.periodic:
        next_around, before_around = next_around.copy(), before_around.copy()
        next_around[-1], before_around[0] = -1, -1
    next_along, before_along = np.full_like(number, -1), np.full_like(number, -1)
    next_along[:, :-1], before_along[:, 1:] = number[:, 1:], number[:, :-1]
    face_along = np.zeros((columns, rows))
    face_along[:, :-1] = wide[:, None] * _radius(surface, edges[1:-1])[None, :]
    return {
        "area": np.outer(wide, length * _radius(surface, middle)).ravel(),
        "next_around": next_around.ravel(), "before_around": before_around.ravel(),
        "next_along": next_along.ravel(), "before_along": before_along.ravel(),
        "face_around": np.tile(length, columns), "face_along": face_along.ravel(),
    }  # fmt: skip


def _fed(film: Film) -> Array:
    """Nodes (columns, rows) whose pressure a feed gives."""
    found = np.zeros((film.grid.columns, film.grid.rows), dtype=bool)
    for feed in film.feeds:
        found |= feed.nodes(film.a.surface.shape, film.theta, film.grid.z)[0]
    return found


@dataclass(frozen=True)
class Entries:
    """Points of each function: start (functions,), point and slot (entries,); the hats around them: near_start
    (functions,), near, and where the four hats of an entry's point are among them, near_at (entries, 4)."""

    start: Array
    point: Array
    slot: Array
    near_start: Array
    near: Array
    near_at: Array


def _entries(function: Array, functions: int) -> Entries:
    width = function.shape[1]
    owner = function.ravel()
    order = np.argsort(owner, kind="stable")
    start = np.concatenate([[0], np.cumsum(np.bincount(owner, minlength=functions))])
    point, slot = order // width, order % width
    near, near_start, near_at = [], [0], np.zeros((len(order), 4), dtype=int)
    for f in range(functions):
        mine = slice(start[f], start[f + 1])
        found, at = np.unique(function[point[mine]], return_inverse=True)
        near.append(found)
        near_start.append(near_start[-1] + len(found))
        near_at[mine] = at.reshape(-1, 4)
    return Entries(start[:-1], point, slot, np.asarray(near_start[:-1]), np.concatenate(near), near_at)


def _filling(film: Film, points: Points, G: Array, given: Array) -> Array:
    """Gap at the points [m] where the scene begins, opened by the pressures that are given, times rho/rho_0 there."""
    pressure = np.sum(points.value * given[points.function], axis=1)
    opened = np.sum(points.value * (G @ given)[points.function], axis=1)
    return film.oil.density_at(pressure) * (film.gap_at(points.theta, points.z) + opened)


def _second_form(film: Film) -> tuple[Array, Sequence[float]]:
    """A table of what the form of the second surface adds [m], and where its places are: first theta and step, first z
    and step."""
    if film.form_second is None:
        return np.zeros((0, 0)), [0.0, 1.0, 0.0, 1.0]
    shape, grid = film.b.surface.shape, film.grid
    half = 0.5 * float(grid.z[-1] - grid.z[0])
    world = film.a.body.to_world(film.a.surface.shape.point(np.zeros(2), grid.z[[0, -1]]))
    ends = np.sort(np.asarray(shape.chart(film.b.body.to_user(world))[1], dtype=float))
    z = np.linspace(ends[0] - 0.1 * half, ends[1] + 0.1 * half, FORM_ROWS)
    step = 2.0 * np.pi / FORM_COLUMNS
    theta = step * np.arange(FORM_COLUMNS)
    return film.second_form(theta[:, None], z[None, :]), [0.0, step, float(z[0]), float(z[1] - z[0])]
