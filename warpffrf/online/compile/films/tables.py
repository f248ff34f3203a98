r"""Oil films of a scene -> device tables of their points, functions and compliances (kernels of `films`).

The functions of the pressure are in `film_bases`. With D the compliance of the surface's local modes, M the Gram matrix
of its nodes and T from functions to nodes, pressures open the gap at the nodes by G T p, G = D M. For given pressures
this is constant, `lift`; asperity pressures are defined at the nodes, and open by G.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
import scipy.sparse as sp

from warpffrf.model import rotation as rot
from warpffrf.model.errors import InputError
from warpffrf.model.films import Film
from warpffrf.model.films.film import places_around
from warpffrf.model.films.heat import COLDEST, ENTRIES, STEP
from warpffrf.model.films.roughness import factor_table
from warpffrf.model.oils import Oil
from warpffrf.model.reduced.contact_surface import ContactSurface
from warpffrf.online.compile.collector import Collector
from warpffrf.online.compile.compliance_tables import modal_moments, node_gram
from warpffrf.online.compile.films.bases import Basis, basis_of
from warpffrf.online.compile.films.smooth import Stations, lines_of, nodal_forces, rooms, smooth_tables, stations_of
from warpffrf_kernels.core.films import HEATS
from warpffrf_kernels.core.model import Films
from warpffrf_kernels.films import asperities as asperity_kernels
from warpffrf_kernels.films import heat as heat_kernels
from warpffrf_kernels.films import oil as oil_kernels
from warpffrf_kernels.films import sampling, unknowns

Array = np.ndarray
FORM_COLUMNS, FORM_ROWS = 720, 65  # of the table of the second surface's form: half a degree
OIL_FORMS = {"newtonian": oil_kernels.NEWTONIAN, "barus": oil_kernels.BARUS, "roelands": oil_kernels.ROELANDS}
RULES = {
    "jfo": sampling.MASS_CONSERVING, "reynolds": sampling.REYNOLDS, "half_sommerfeld": sampling.HALF,
    "full_sommerfeld": sampling.NONE,
}  # fmt: skip
BY_PRESS = ("press_function", "press_value")
BY_FUNCTION = (
    "function",
    "entry_room",
    "value",
    "slope_around",
    "slope_along",
    "void_value",
    "node_support",
    "node_value",
)


class Tables:
    """Tables of all films: one value per film, or entries concatenated over films."""

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
        """All tables, as the model takes them; functions at a point padded to the largest number, with -1 and zeros."""
        found: dict[str, Any] = {name: np.asarray(ones) for name, ones in self.ones.items()}
        widths = {
            name: max(part.shape[1] for part in self.parts[group[0]])
            for group in (BY_FUNCTION, BY_PRESS)
            for name in group
            if name in self.parts
        }
        for name, parts in self.parts.items():
            if name in widths:
                fill = -1 if name in ("function", "entry_room", "node_support", "press_function") else 0
                gaps = [widths[name] - part.shape[1] for part in parts]
                parts = [
                    np.pad(part, ((0, 0), (0, gap)), constant_values=fill)
                    for part, gap in zip(parts, gaps, strict=True)
                ]
            found[name] = np.concatenate(parts)
        return found


def fill_films(collector: Collector) -> None:
    """Tables of all films. Raises `InputError` for unsupported films."""
    films, topic = collector.scene.films, collector.films
    declared: Any = Films
    tables = Tables()
    for number, film in enumerate(films):
        _add_film(collector, film, number, tables)
    collector.notes.extend(_alone(collector))
    values = dict.fromkeys(declared.declarations, np.zeros(0)) | tables.values()
    if films:
        for name, of in (
            ("node", "lift"), ("function", "given"), ("point", "weight"), ("unknown", "function_of"),
            ("press", "press_seat"),
        ):  # fmt: skip
            values[f"{name}_start"] = tables.starts(of)
        for name in (
            "compliance", "shape", "moment", "rough_moment", "table", "factor", "second_row", "second_shape",
            "second_compliance", "line_at", "close", "smooth", "smooth_load", "smooth_compliance", "smooth_motion",
            "second_smooth", "second_near", "second_smooth_motion", "nodal_force", "heat_table",
        ):  # fmt: skip
            values[f"{name}_start"] = tables.starts(name)[:-1]
        lines = values["unknowns"] + values["rough"]
        columns = int(unknowns.RIGID) + values["modes"] + values["second_modes"]
        grid_nodes, width, second, reach = (
            values[name] for name in ("second_nodes", "width", "second_smooth_count", "reach")
        )
        r = values["smooth_count"] + second
        stations = values.pop("stations")
        moved = np.where(second > 0, stations, 0)
        length = 3 * values["most_band"] + reach * values["turns"] * width + r + 2 + columns - 6
        values |= {
            "most_smooth": int(r.max()), "most_columns": int(columns.max()),
            "most_room": int(((2 * reach + 4) * width).max()),
        }  # fmt: skip
        for name, sizes in (
            ("system", lines), ("matrix", lines * length), ("column", columns),
            ("square", columns**2), ("second_node", grid_nodes), ("moved", moved * second), ("station", stations),
            ("moved_load", lines * (second > 0) * second), ("moved_close", moved * (2 * reach + 3) * width),
            ("moved_room", moved * (2 * reach + 5) * values["grid_rows"]),
            ("heat", values.pop("heat_nodes")),
            ("seat", np.where(grid_nodes > 0, np.diff(values["point_start"]) + np.diff(values["node_start"]), 0)),
        ):  # fmt: skip
            values[f"{name}_start"] = np.concatenate([[0], np.cumsum(sizes)])
        for name, of in (("entry", "entry_point"), ("near", "near"), ("press_entry", "press_entry")):
            values[f"{name}_start"] = np.append(values[f"{name}_start"], tables.length(of))
        values["rest_v"], values["rest_omega"] = _rest_velocities(collector)
    collector.fill(topic, count=len(films), **values)


def _add_film(collector: Collector, film: Film, number: int, tables: Tables) -> None:
    surface, grid, body = film.a.surface, film.grid, film.a.body
    grid_nodes = grid.columns * grid.rows
    basis = basis_of(film)
    free = np.flatnonzero(~basis.held)
    unknown_of = np.full(basis.functions, -1)
    unknown_of[free] = np.arange(len(free))
    G = _opening(surface)
    of_functions = G @ basis.to_nodes
    shape = np.asarray(surface.mode_normal).reshape(grid_nodes, -1)
    moment = modal_moments(surface).reshape(grid_nodes, -1).T
    theta, z = (v.ravel() for v in np.meshgrid(film.theta, grid.z, indexing="ij"))
    stations = stations_of(film, basis)
    entries = _entries(basis, stations)
    kind, numbers = oil_numbers(film.oil)
    table, ranges = _second_form(film)
    travels = film.cavitation in ("jfo", "reynolds")
    law, law_numbers, law_table = _asperities(film)
    rough = grid_nodes if film.mixed.asperities is not None else 0
    mixed = film.mixed
    factors = factor_table(mixed.roughness_a, mixed.roughness_b) if mixed.deviation else np.zeros((0, 13))
    lines = lines_of(film, basis, rough)
    compliance = np.hstack([of_functions[:, free], G[:, :rough]])
    smooth = smooth_tables(film, stations, lines, compliance, nodal_forces(film, basis, rough))
    _add_heat(collector, film, tables)
    lift, voids = of_functions @ basis.given, (basis.voids & travels).astype(int)
    tables.one(
        first=collector.film_sides[2 * number], second=collector.film_sides[2 * number + 1], modes=shape.shape[1],
        rule=int(RULES[film.cavitation]), oil_kind=kind, oil=numbers, unknowns=len(free),
        thickness=film.clearance() or float(np.median(film.initial_gap())), second_range=ranges,
        rough=rough, asperity_kind=law, asperity=law_numbers, asperity_friction=film.mixed.boundary_friction,
        table_count=len(law_table), factor_count=len(factors), second_counts=table.shape,
        second_start=tables.length("second_form") if table.size else -1,
        grid_columns=grid.columns, grid_rows=grid.rows, turns=int(grid.periodic), seam=lines.seam,
        width=lines.at.shape[1], station_rows=stations.rows, station_seat=stations.seat, stations=stations.count,
        most_band=lines.most_band, reach=lines.reach, **smooth["ones"],
    )  # fmt: skip
    tables.part(**smooth["parts"], entry_room=rooms(basis, lines, entries.owner, entries.point))
    tables.part(
        compliance=compliance.T.ravel(), shape=shape.ravel(),
        moment=(moment @ basis.to_nodes).ravel(), table=law_table, rough_moment=moment[:, :rough].ravel(),
        node_area=node_gram(surface, 1)[0].sum(axis=1), lift=lift,
        node_place=surface.shape.point(theta, z) - body.center_of_mass, node_form=film.gap_form(theta, z),
        node_function=basis.node_function, node_support=basis.node_support, node_value=basis.node_value,
            function_of=free,
        unknown_of=unknown_of, given=basis.given, feeds=basis.fed.astype(int), voids=voids,
        place=surface.shape.point(*basis.at.T) - body.center_of_mass, around=_around(surface, basis.at[:, 0]),
        along=_along(surface, *basis.at.T), area=basis.area, second_form=table.ravel(), **basis.neighbours,
    )  # fmt: skip
    tables.part(factor=factors)
    tables.part(
        entry_start=tables.length("entry_point") + entries.start, near_start=tables.length("near") + entries.near_start,
        entry_slot=entries.slot, entry_near=entries.near_at, near=entries.near,
    )  # fmt: skip
    tables.part(entry_point=tables.length("weight") + entries.point)
    tables.part(
        point_place=surface.shape.point(basis.theta, basis.z) - body.center_of_mass,
        point_around=_around(surface, basis.theta), point_along=_along(surface, basis.theta, basis.z),
        form=film.gap_form(basis.theta, basis.z), weight=basis.weight, function=basis.function, value=basis.value,
        slope_around=basis.around, slope_along=basis.along, void_value=basis.void, grid_node=basis.grid_node,
            between=basis.between,
        begin=_filling(film, basis, lift), station=stations.at, station_part=stations.part,
    )  # fmt: skip
    _add_second(film, basis, tables)
    collector.notes.extend(film.notes)
    if film.cavitation == "half_sommerfeld":
        collector.notes.append(
            f"{film.label}: cavitation 'half_sommerfeld' omits negative pressures from the forces, though they drive "
            "oil: "
            "the ledger does not close, and created energy is not detected"
        )
    if film.mixed.asperities is not None and film.mixed.asperities.remark:
        collector.notes.append(f"{film.label}: {film.mixed.asperities.remark}")
    if film.quadrature == "reduced":
        collector.notes.append(
            f"{film.label}: its pressure consists of {len(free)} profiles in place of {grid_nodes} nodes, which "
            f"balance "
            "its oil in the axial mean: flows through feeds and ends are not recorded"
        )
    if collector.local.count(body.index) or (not film.b.rigid and collector.local.count(film.b.body.index)):
        collector.notes.append(f"{film.label}: local modes respond without inertia to its pressure")


def _add_heat(collector: Collector, film: Film, tables: Tables) -> None:
    """Its temperature, if it has one. Raises `InputError` for a film upstream that has none or is not in the scene."""
    heat, names = film.temperature, [other.name for other in collector.scene.films]
    if heat is None:
        tables.one(heat_nodes=0, heat=[0.0] * 8, heat_upstream=-1)
        tables.part(heat_table=np.zeros((0, 3)))
        return
    upstream = -1
    if heat.upstream is not None:
        upstream = names.index(heat.upstream) if heat.upstream in names else -1
        other = collector.scene.films[upstream]
        if upstream < 0 or other is film or other.temperature is None or other.grid.periodic:
            raise InputError(
                f"{film.label}: no pad upstream, upstream={heat.upstream!r} is not another film of the scene with a "
                f"temperature and edges; films: {', '.join(map(repr, names))}"
            )
    tables.one(
        heat_nodes=film.grid.columns * film.grid.rows, heat=heat.numbers(film.oil), heat_upstream=upstream,
    )  # fmt: skip
    deviations = np.column_stack([*heat.deviations(film), np.zeros(film.grid.columns * film.grid.rows)])
    tables.part(heat_table=np.concatenate([heat.table(film.oil), deviations]))


def heat_at_start(compiled: Any) -> dict[str, Array]:
    """Of all films: temperature [degC] and thinning of nodes, those of the supply, and the numbers of `films.heat`."""
    films = compiled.scene.films
    temperature, thinning, numbers = [np.zeros(0)], [np.zeros(0)], np.zeros((2, len(films), HEATS))
    for i, film in enumerate(films):
        if film.temperature is not None:
            nodes, T = film.grid.columns * film.grid.rows, film.temperature.supply
            table = film.temperature.table(film.oil)[:, 0]
            temperature.append(np.full(nodes, T))
            thinning.append(np.full(nodes, np.interp((T - COLDEST) / STEP, np.arange(ENTRIES), table)))
            numbers[:, i, int(heat_kernels.INLET)] = T
    return {"temperature": np.concatenate(temperature), "thinning": np.concatenate(thinning), "heat": numbers}


def _add_second(film: Film, basis: Basis, tables: Tables) -> None:
    """The grid of a compliant second surface, its compliance and the modes of its body; nothing for a rigid one."""
    surface = film.b.surface
    if not isinstance(surface, ContactSurface):
        tables.one(second_modes=0, second_nodes=0, second_grid=(0, 0, 0), second_pitch=(0.0, 1.0, 0.0))
        empty = np.zeros(0)
        tables.part(
            second_row=empty, second_shape=empty, second_compliance=empty, press_seat=empty, press_entry=empty,
            press_function=np.zeros((0, 1)), press_value=np.zeros((0, 1)), press_entry_value=empty,
            press_entry_start=np.zeros(basis.functions),
        )  # fmt: skip
        return
    grid = surface.grid
    grid_nodes = grid.columns * grid.rows
    shape = np.asarray(surface.mode_normal).reshape(grid_nodes, -1)
    turn = 0.0 if surface.shape.profile().planar else 2.0 * np.pi / grid.pitch
    tables.one(
        second_modes=shape.shape[1], second_nodes=grid_nodes, second_grid=(grid.columns, grid.rows, int(grid.periodic)),
        second_pitch=(float(places_around(surface)[0]), grid.pitch, turn),
    )  # fmt: skip
    tables.part(
        second_row=grid.z, second_shape=shape.ravel(),
        second_compliance=surface.compliance(np.arange(grid.columns)).ravel(),
    )  # fmt: skip
    seat, function, value = _presses(film, basis)
    place, slot = np.nonzero(function >= 0)
    owner = function[place, slot]
    order = np.argsort(owner, kind="stable")
    start = np.concatenate([[0], np.cumsum(np.bincount(owner, minlength=basis.functions))])
    tables.part(
        press_entry_start=tables.length("press_entry") + start[:-1],
        press_entry=tables.length("press_seat") + place[order], press_entry_value=value[place, slot][order],
    )  # fmt: skip
    tables.part(press_seat=seat, press_function=function, press_value=value)


def _presses(film: Film, basis: Basis) -> tuple[Array, Array, Array]:
    """Points at which a film loads a compliant second body: seats (places,), functions acting there, -1 for none, and
    the area of each [m2] (places, some): points, or, for profiles, which are evaluated at few points, nodes.
    """
    points = len(basis.weight)
    if film.quadrature != "reduced":
        return np.arange(points), basis.function, basis.value * basis.weight[:, None]
    forces = sp.csr_matrix(sp.csr_matrix(node_gram(film.a.surface, 1)[0]) @ basis.to_nodes)
    counts = np.diff(forces.indptr)
    slot = np.arange(forces.nnz) - np.repeat(forces.indptr[:-1], counts)
    function, value = np.full((len(counts), counts.max()), -1), np.zeros((len(counts), counts.max()))
    grid_node = np.repeat(np.arange(len(counts)), counts)
    function[grid_node, slot], value[grid_node, slot] = forces.indices, forces.data
    return points + np.arange(len(counts)), function, value


def _alone(collector: Collector) -> list[str]:
    """A note for each flexible body that a film loads in addition to other films or contacts."""
    scene, notes = collector.scene, []
    films = [port for film in scene.films for port in film.ports if not port.rigid]
    others = [port for contact in scene.finite_sliding for port in contact.ports if not port.rigid]
    for body in scene.bodies:
        names = [port.name for port in (*films, *others) if port.body is body]
        if len(names) > 1 and any(port.body is body for port in films):
            on = ", ".join(sorted(set(names)))
            notes.append(
                f"body {body.name!r}: {len(names)} films and contacts load it, on {on}; with a film, the influence of "
                "the others is included by its global modes alone; use more modes for a smaller error"
            )
    return notes


def _rest_velocities(collector: Collector) -> tuple[Array, Array]:
    """Velocity of each body's centre of mass, and angular velocity in its axes, as the scene begins."""
    v, omega = [], []
    for body in collector.scene.bodies:
        A = rot.matrix(body.rotation)
        v.append(body.velocity + np.cross(body.angular_velocity, A @ body.center_of_mass))
        omega.append(A.T @ body.angular_velocity)
    return np.array(v), np.array(omega)


def oil_numbers(oil: Oil) -> tuple[int, list[float]]:
    """Kind and numbers of an oil."""
    a, b = (0.0, 0.0) if oil.density is None else (oil.density.a, oil.density.b)
    return int(OIL_FORMS[oil.form]), [oil.viscosity, *oil.numbers, a, b]


def _asperities(film: Film) -> tuple[int, list[float], Array]:
    """Kind, numbers and table of the law of asperities."""
    if film.mixed.asperities is None:
        return int(asperity_kernels.SMOOTH), [0.0] * 4, np.zeros((0, 3))
    curve: Any = film.mixed.asperities.curve
    if curve.form == "exponential":
        return int(asperity_kernels.EXPONENTIAL), list(curve.numbers), np.zeros((0, 3))
    return int(asperity_kernels.TABLE), [0.0] * 4, curve.table


def _opening(surface: ContactSurface) -> Array:
    """G = D M (nodes, nodes) [m/Pa]."""
    D = surface.compliance(np.arange(surface.grid.columns))
    return D @ node_gram(surface, 1)[0]


def _around(surface: ContactSurface, theta: Array) -> Array:
    """Unit vectors (n, 3) along the first coordinate of the chart, for either side."""
    found = np.asarray(surface.shape.around(theta))
    if not surface.shape.profile().planar:
        found = found * surface.shape.side
    return np.broadcast_to(found, (len(theta), 3))


def _along(surface: ContactSurface, theta: Array, z: Array) -> Array:
    """Unit vectors (n, 3) along z."""
    return np.broadcast_to(np.asarray(surface.shape.along(theta, z)), (len(theta), 3))


@dataclass(frozen=True)
class Entries:
    """Points of each function: start (functions,), owner, point and slot (entries,); their stations: near_start
    (functions,), near, and the indices in it of the four nodes of an entry's point, near_at (entries, 4).
    """

    start: Array
    owner: Array
    point: Array
    slot: Array
    near_start: Array
    near: Array
    near_at: Array


def _entries(basis: Basis, stations: Stations) -> Entries:
    width = basis.function.shape[1]
    owner = basis.function.ravel()
    order = np.argsort(owner, kind="stable")
    start = np.concatenate([[0], np.cumsum(np.bincount(owner, minlength=basis.functions))])
    point, slot = order // width, order % width
    near, near_start, near_at = [], [0], np.zeros((len(order), 4), dtype=int)
    for f in range(basis.functions):
        mine = slice(start[f], start[f + 1])
        found, at = np.unique(stations.at[point[mine]], return_inverse=True)
        near.append(found)
        near_start.append(near_start[-1] + len(found))
        near_at[mine] = at.reshape(-1, 4)
    return Entries(start[:-1], owner[order], point, slot, np.asarray(near_start[:-1]), np.concatenate(near), near_at)


def _filling(film: Film, basis: Basis, lift: Array) -> Array:
    """Gap at the points [m] at the start of the scene, opened by the given pressures, times rho/rho_0 there."""
    pressure = np.sum(basis.value * basis.given[basis.function], axis=1)
    opened = np.sum(basis.between * lift[basis.grid_node], axis=1)
    return film.oil.density_at(pressure) * (film.gap_at(basis.theta, basis.z) + opened)


def _second_form(film: Film) -> tuple[Array, Sequence[float]]:
    """A table of the form of the second surface [m], and its sampling: first theta and step, first z and step."""
    if film.form_b is None:
        return np.zeros((0, 0)), [0.0, 1.0, 0.0, 1.0]
    shape, grid = film.b.surface.shape, film.grid
    half = 0.5 * float(grid.z[-1] - grid.z[0])
    world = film.a.body.to_world(film.a.surface.shape.point(np.zeros(2), grid.z[[0, -1]]))
    ends = np.sort(np.asarray(shape.chart(film.b.body.to_user(world))[1], dtype=float))
    z = np.linspace(ends[0] - 0.1 * half, ends[1] + 0.1 * half, FORM_ROWS)
    step = 2.0 * np.pi / FORM_COLUMNS
    theta = step * np.arange(FORM_COLUMNS)
    return film.second_form(theta[:, None], z[None, :]), [0.0, step, float(z[0]), float(z[1] - z[0])]
