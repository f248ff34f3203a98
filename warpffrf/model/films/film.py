"""An oil film between two surfaces: the surfaces it may join, and its parameters.

The film is discretised on the contact grid of the first surface, which belongs to a flexible body; the second surface
belongs to another flexible body, whose grid deforms under the film, or is the rigid surface of a rigid body or the
ground. Pressures are above the pressure of cavitation, which is zero. They are prescribed at the ends of the film (the
first and last row of the grid, for an arc or a plane also the first and last column) and in its feeds; the pressures
between are solved for.

Cavitation: treatment of the film where its pressure would fall below that of cavitation, zero here.
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import numpy as np

from warpffrf.model.bodies import SurfacePort
from warpffrf.model.errors import InputError, require_number, unknown_name
from warpffrf.model.films.feeds import FEEDS, Feed
from warpffrf.model.films.heat import FilmTemperature, require_heat_path
from warpffrf.model.films.roughness import MixedLubrication
from warpffrf.model.messages import reprs
from warpffrf.model.messages.named_arguments import named_arguments
from warpffrf.model.oils import Oil, as_oil
from warpffrf.model.reduced.contact_grid import SurfaceGrid
from warpffrf.model.reduced.contact_surface import ContactSurface
from warpffrf.model.surfaces.form_deviations import Form, as_form, refuse_form

QUADRATURES = ("full", "reduced")
PROFILES = (0, 1, 2)  # axial degrees: a tilting shaft requires odd ones
MOST_POWER = 8
LEAST_ROWS, LEAST_COLUMNS = 3, 8  # rows between the ends, and columns: fewer resolve no pressure
SAME = 0.01  # of the deviation of the summed heights, which walls and asperity law both define
LOOSEST = (
    0.1  # clearance over radius, far beyond any bearing: the gap is taken along normals, which then are not shared
)


@named_arguments
class Film(reprs.Item):
    """An oil film between two surfaces a and b, `body["bore"]` each; a must be flexible, b may be flexible or rigid.

    Forces are reported on the first body. oil: one of `warpffrf.oils`. feeds: grooves and holes that supply oil
    (`warpffrf.films`). cavitation: one of `films.CAVITATIONS`. ambient_pressure [Pa]: at the ends of the film, above
    the cavitation pressure. mixed: `films.MixedLubrication(...)`, asperities and roughness of the walls; None for
    smooth walls. form_a, form_b: form deviations of the two surfaces (`warpffrf.films`). quadrature: "full", all nodes
    of the contact grid at all points, or "reduced", in each column a few axial profiles (1 - zeta^2) zeta^m with m
    of `axial_degrees`, 0 first, at few points. temperature: `films.FilmTemperature(...)`, None for an isothermal film.
    name: default "<first body>-<second body>". Raises `InputError`.
    """

    scene_list = "films"
    kind = "film"

    def __init__(
        self,
        a: SurfacePort,
        b: SurfacePort,
        *,
        oil: Oil,
        feeds: Sequence[Feed] = (),
        cavitation: str = "jfo",
        ambient_pressure: float = 0.0,
        mixed: MixedLubrication | None = None,
        form_a: Form | None = None,
        form_b: Form | None = None,
        quadrature: str = "full",
        axial_degrees: Sequence[int] = PROFILES,
        temperature: FilmTemperature | None = None,
        name: str | None = None,
    ) -> None:
        for port, place in ((a, "first"), (b, "second")):
            _require_surface(port, place)
        self.a: SurfacePort = a
        self.b: SurfacePort = b
        self.name = f"{a.body.name}-{b.body.name}" if name is None else name
        label = self.label
        self._require_bodies()
        if cavitation not in CAVITATIONS:
            raise unknown_name(f"{label}: cavitation", cavitation, CAVITATIONS)
        if quadrature not in QUADRATURES:
            raise unknown_name(f"{label}: quadrature", quadrature, QUADRATURES)
        self.cavitation = str(cavitation)
        self.quadrature = str(quadrature)
        self.oil: Oil = as_oil(oil, label)
        self.mixed: MixedLubrication = MixedLubrication() if mixed is None else mixed
        if not isinstance(self.mixed, MixedLubrication):
            raise InputError(f"{label}: mixed must be films.MixedLubrication(...) or None, got {mixed!r}")
        self.ambient_pressure = require_number(ambient_pressure, f"{label}: ambient_pressure [Pa]", non_negative=True)
        self.feeds: tuple[Feed, ...] = _feeds(feeds, label)
        self.form_a: Form | None = self._as_form(form_a, "form_a", a)
        self.form_b: Form | None = self._as_form(form_b, "form_b", b)
        self._require_gap()
        self._require_grid()
        held, _, _ = self._held()
        self.axial_degrees = self._as_degrees(axial_degrees)
        if held.all():
            raise InputError(f"{label}: its feeds hold all nodes of the grid, no film is left; make them smaller")
        if self.cavitation == "jfo" and not self.feeds and not self.ambient_pressure:
            raise InputError(
                f"{label}: the film has no supply, and oil leaves at its ends; give it "
                "feeds=[films.AxialGroove(theta, width, pressure)], or an ambient_pressure above 0 at the ends"
            )
        self.temperature: FilmTemperature | None = temperature
        if temperature is not None:
            require_heat_path(self)

    @property
    def label(self) -> str:
        """Readable name, for messages."""
        return f"film {self.name!r}"

    @property
    def ports(self) -> tuple[SurfacePort, SurfacePort]:
        return self.a, self.b

    @property
    def grid(self) -> SurfaceGrid:
        """The contact grid of the first surface, whose nodes carry the film."""
        return self.a.surface.grid

    @property
    def theta(self) -> np.ndarray:
        """Coordinates of the columns (columns,) [rad, of a plane m] in the chart of the first shape: those of the grid
        are measured from its own direction e_0."""
        return places_around(self.a.surface)

    @property
    def notes(self) -> list[str]:
        """Notes for the user on the discretisation of the film and its rough walls."""
        return self._held()[2] + self._rough_notes() + self._cold_notes()

    def held(self) -> tuple[np.ndarray, np.ndarray]:
        """Which nodes (columns, rows) have a given pressure, and that pressure (columns, rows) [Pa], 0 elsewhere. Where
        a feed reaches an end, the feed's pressure applies."""
        return self._held()[:2]

    def clearance(self) -> float | None:
        """Radius of the bore minus that of the shaft [m], both at the middle of their shapes (z = 0); None for planes
        and cones, whose gap depends on their position."""
        shapes = [port.surface.shape for port in self.ports]
        if any(shape.profile().planar or shape.profile().tangent for shape in shapes):
            return None
        first, second = (float(shape.radius_at(0.0)) for shape in shapes)
        return first - second if shapes[0].side < 0.0 else second - first

    def gap_form(self, theta: Any, z: Any) -> np.ndarray:
        """Contribution of the form of the first surface to the gap [m] at theta [rad, of a plane m], z [m] of its chart
        (arguments broadcast); positive where material is missing."""
        return _deviation(self.form_a, theta, z)

    def second_form(self, theta: Any, z: Any) -> np.ndarray:
        """Contribution of the form of the second surface to the gap [m] at theta [rad, of a plane m], z [m] of its own
        chart; arguments broadcast."""
        return _deviation(self.form_b, theta, z)

    def initial_gap(self) -> np.ndarray:
        """Gap [m] at the nodes (columns, rows), at the current initial pose, undeformed, with the forms of both
        surfaces; negative where they overlap."""
        return self.gap_at(self.theta[:, None], self.grid.z[None, :])

    def gap_at(self, theta: Any, z: Any) -> np.ndarray:
        """The same at theta [rad, of a plane m], z [m] of the first surface's chart; arguments broadcast."""
        first, second = (port.surface.shape for port in self.ports)
        world = self.a.body.to_world(first.point(theta, z))
        theta_b, z_b, distance = second.chart(self.b.body.to_user(world))
        return distance + self.gap_form(theta, z) + self.second_form(theta_b, z_b)

    def describe(self) -> dict[str, Any]:
        """Plain data for hashing."""
        surfaces = {"a": [self.a.body.name, self.a.name], "b": [self.b.body.name, self.b.name]}
        parts = {"oil": self.oil, "form_a": self.form_a, "form_b": self.form_b}
        return {
            "name": self.name,
            **surfaces,
            **{name: None if part is None else part.describe() for name, part in parts.items()},
            "feeds": [feed.describe() for feed in self.feeds],
            "cavitation": self.cavitation,
            "ambient_pressure": self.ambient_pressure,
            "quadrature": self.quadrature,
            "axial_degrees": list(self.axial_degrees) if self.quadrature == "reduced" else None,
            **({} if self.temperature is None else {"temperature": self.temperature.describe()}),
            **self.mixed.describe(),
        }

    def _cold_notes(self) -> list[str]:
        """Walls of bodies with temperatures, whose own the film does not have."""
        if self.temperature is None:
            return []
        bare = [
            port.label
            for port, mean in zip(self.ports, self.temperature.means, strict=True)
            if mean is None and port.body.reduced is not None and port.body.reduced.thermal is not None
        ]
        return [
            f"{self.label}: {label} is adiabatic here, although its body conducts heat; study.warm_equilibrium and "
            "study.warm_up find the temperatures of both"
            for label in bare
        ]

    def _rough_notes(self) -> list[str]:
        s = self.mixed.deviation
        told = getattr(self.mixed.asperities, "deviation", s)
        if not s or abs(told - s) <= SAME * s:
            return []
        return [
            f"{self.label}: the heights of both rough walls have the standard deviation {s:.3g} m, those of its law "
            f"of asperities {told:.3g} m"
        ]

    def _as_degrees(self, degrees: Any) -> tuple[int, ...]:
        """Powers of the profiles. Raises `InputError` for unsupported and invalid ones."""
        try:
            found = tuple(int(m) for m in degrees)
        except (TypeError, ValueError):
            found = ()
        if found != tuple(sorted(set(found))) or not found or found[0] != 0 or found[-1] > MOST_POWER:
            raise InputError(
                f"{self.label}: axial_degrees must rise from 0 to {MOST_POWER} at most, as (0, 2) of a shaft that "
                f"stays straight or (0, 1, 2), got {degrees!r}"
            )
        if self.quadrature != "reduced":
            return found
        cure = "take quadrature='full'"
        if self.ambient_pressure:
            raise InputError(
                f"{self.label}: the profiles of quadrature 'reduced' end without pressure, and ambient_pressure is "
                f"{self.ambient_pressure:g} Pa; {cure}"
            )
        if self.cavitation == "half_sommerfeld":
            raise InputError(
                f"{self.label}: cavitation 'half_sommerfeld' cuts pressures at zero, which profiles do not do; {cure}"
            )
        if self.mixed.asperities is not None:
            raise InputError(f"{self.label}: asperities stand at nodes, which quadrature 'reduced' lacks; {cure}")
        partly = self._held()[0][:, 1:-1]
        if np.any(partly.any(axis=1) != partly.all(axis=1)):
            raise InputError(
                f"{self.label}: quadrature 'reduced' has a profile along for each column, and holds none of it: a feed "
                f"must be a Groove over the whole length; {cure}"
            )
        return found

    def _held(self) -> tuple[np.ndarray, np.ndarray, list[str]]:
        """Nodes with prescribed pressure, their pressures, and notes. Raises `InputError` for feeds outside the film,
        or feeds that share nodes but not the pressure."""
        grid = self.grid
        held = np.zeros((grid.columns, grid.rows), dtype=bool)
        held[:, [0, -1]] = True
        if not grid.periodic:
            held[[0, -1], :] = True
        pressure = np.where(held, self.ambient_pressure, 0.0)
        owner = np.full(held.shape, -1)
        notes: list[str] = []
        for number, feed in enumerate(self.feeds):
            nodes, covered = feed.nodes(self.a.surface.shape, self.theta, grid.z)
            if not covered:
                self._require_inside(feed, number)
                notes.append(
                    f"{self.label}: feed {number + 1}, the {feed.label}, lies between nodes of the grid of "
                    f"{self.a.label}: the nearest {'ones have' if np.sum(nodes) > 1 else 'one has'} its pressure"
                )
            for other in np.unique(owner[nodes & (owner >= 0)]):
                if self.feeds[other].pressure != feed.pressure:
                    raise InputError(
                        f"{self.label}: feed {other + 1}, the {self.feeds[other].label}, and feed {number + 1}, the "
                        f"{feed.label}, share nodes of the grid but not their pressure, {self.feeds[other].pressure:g} "
                        f"and {feed.pressure:g} Pa; move them apart, or give both the same"
                    )
            owner[nodes] = number
            held |= nodes
            pressure[nodes] = feed.pressure
        return held, pressure, notes

    def _require_inside(self, feed: Feed, number: int) -> None:
        """Raises `InputError` for a feed that covers no node because it lies outside the film."""
        grid, (theta, along) = self.grid, feed.place
        off = None
        if theta is not None and not grid.periodic:
            middle, half = 0.5 * (self.theta[0] + self.theta[-1]), 0.5 * grid.pitch * (grid.columns - 1)
            away = theta - middle
            if not self.a.surface.shape.profile().planar:
                away = np.remainder(away + np.pi, 2.0 * np.pi) - np.pi
            if abs(away) > half:
                off = f"which reaches from theta = {middle - half:.4g} to {middle + half:.4g}"
        if along is not None and (along[1] < grid.z[0] or along[0] > grid.z[-1]):
            off = f"which reaches from z = {grid.z[0]:.4g} to {grid.z[-1]:.4g} m"
        if off is not None:
            raise InputError(
                f"{self.label}: feed {number + 1}, the {feed.label}, lies outside the grid of {self.a.label}, {off}; "
                "move it into the grid"
            )

    def _as_form(self, value: Any, name: str, port: SurfacePort) -> Form | None:
        form = as_form(value, f"{self.label}: {name}")
        if form is not None and form.turns and port.surface.shape.profile().planar:
            raise InputError(
                f"{self.label}: {name} is periodic around the axis, but {port.label} is a plane; take "
                "films.BarrelForm, or films.MeasuredForm(..., periodic=False)"
            )
        return form

    def _require_bodies(self) -> None:
        a, b, label = self.a, self.b, self.label
        if a.body is b.body:
            raise InputError(f"{label}: {a.label} and {b.label} are on one body; a film stands between two bodies")
        if a.rigid and b.rigid:
            raise InputError(
                f"{label}: {a.label} and {b.label} are both rigid, but a film stands on the contact grid of a flexible "
                "body; make one of the two flexible, scene.add_body(reduce(...)), and name it first"
            )
        if a.rigid:
            raise InputError(
                f"{label}: the film stands on the contact grid of the first surface, which must be flexible, {a.label} "
                f"is rigid; name the flexible body first, Film({b.label}, {a.label}, ...)"
            )
        if b.rigid:
            refuse_form(b, label)
        for port, place in ((a, "first"), (b, "second")):
            if not port.rigid and port.surface.grid.kind != "nodes":
                raise InputError(
                    f"{label}: the {place} surface, {port.label}, was reduced with traction={port.surface.grid.kind!r};"
                    " a film stands on nodes: reduce the body with traction='nodes'"
                )

    def _require_gap(self) -> None:
        """Raises `InputError` for surfaces that cannot enclose a thin film."""
        a, b, label = self.a, self.b, self.label
        for port in self.ports:
            if port.surface.shape.profile().free:
                kind = port.surface.shape.kind
                raise InputError(f"{label}: {port.label} is of kind {kind}; films are between planes or about an axis")
        sides = [port.surface.shape.side for port in self.ports]
        planar = [port.surface.shape.profile().planar for port in self.ports]
        names = f"{a.label} and {b.label}"
        if not any(planar) and sides[0] > 0.0 and sides[1] > 0.0:
            raise InputError(
                f"{label}: {names} are both outer surfaces, and films between rollers are not supported; use "
                "Contact(...), or a surface around the other (surfaces.Bore, surfaces.Cup)"
            )
        if sides[0] < 0.0 and sides[1] < 0.0:
            raise InputError(
                f"{label}: {names} are both inner surfaces, which enclose no gap; one of them must be a shaft"
            )
        if any(planar) and min(sides) < 0.0:
            raise InputError(f"{label}: of {names} one is a plane and one an inner surface, which enclose no thin film")
        clearance = self.clearance()
        if clearance is None or any(planar):
            return
        radii = [float(port.surface.shape.radius_at(0.0)) for port in self.ports]
        told = f"{a.label} with radius {radii[0]:.9g} m and {b.label} with radius {radii[1]:.9g} m"
        bore = (a if sides[0] < 0.0 else b).label
        if clearance <= 0.0:
            raise InputError(
                f"{label}: {told} leave no gap, the clearance is {clearance:.3g} m; {bore} lies around the other and "
                "must have the larger radius"
            )
        if clearance > LOOSEST * min(radii):
            raise InputError(
                f"{label}: {told} are not conformal, the clearance is {clearance / min(radii):.2g} of the radius and "
                f"may be {LOOSEST:g}; bring the radii closer, or use Contact(...): films between rollers are not "
                "supported"
            )

    def _require_grid(self) -> None:
        for port in self.ports:
            if not port.rigid and port.surface.half_space:
                raise InputError(
                    f"{self.label}: {port.label} is a half-space, which is elastic only under the cells of a contact; "
                    "reduce its body from a mesh"
                )
        grid = self.grid
        free = grid.rows - 2
        if free < LEAST_ROWS or grid.columns < LEAST_COLUMNS:
            raise InputError(
                f"{self.label}: the contact grid of {self.a.label} has {grid.columns} columns and {max(free, 0)} rows "
                f"between its ends, and a film needs {LEAST_COLUMNS} columns and {LEAST_ROWS} rows at least; reduce "
                "the body with more cells at the surface, or a smaller spacing of the contact grid"
            )


def places_around(surface: ContactSurface) -> np.ndarray:
    """Coordinates of the columns (columns,) [rad, of a plane m] of a surface's grid in the chart of its shape: those of
    the grid are measured from its own direction e_0."""
    shape, grid = surface.shape, surface.grid
    return grid.theta + float(np.arctan2(grid.e_0 @ shape.e_1, grid.e_0 @ shape.e_0))


def refuse_touching(films: Sequence[Film]) -> None:
    """Raises `InputError` for surfaces that touch at the initial pose: the film must separate them from the start."""
    for film in films:
        gap = film.initial_gap()
        if gap.min() <= 0.0:
            j, k = np.unravel_index(int(np.argmin(gap)), gap.shape)
            theta, z = float(film.theta[j]), float(film.grid.z[k])
            raise InputError(
                f"{film.label}: {film.a.label} and {film.b.label} overlap at the start by {-gap.min():.3g} m, at "
                f"theta = {theta:.4g}, z = {z:.4g} of the first; a film begins with a gap everywhere: move a body to "
                "where there is one, for example to the middle, from which an equilibrium is found"
            )


def _require_surface(port: Any, place: str) -> None:
    if not isinstance(port, SurfacePort):
        raise InputError(
            f"film: the {place} surface must be a contact surface, body['bore'] with 'bore' named in "
            "reduce(contact=...) or in add_rigid_body(surfaces=...), got "
            f"{getattr(port, 'label', None) or repr(getattr(port, 'name', port))}"
        )
    if port.matched:
        raise InputError(
            f"film: the {place} surface, {port.label}, was reduced as surfaces.Matched, for contact with small "
            "sliding; reduce the body with a shape in its place, such as surfaces.Bore()"
        )


def _feeds(value: Any, label: str) -> tuple[Feed, ...]:
    names = ", ".join(f"films.{feed.__name__}" for feed in FEEDS.values())
    if isinstance(value, Feed) or not isinstance(value, Sequence) or isinstance(value, str):
        raise InputError(f"{label}: feeds must be a list of {names}, got {value!r}")
    for number, feed in enumerate(value, start=1):
        if not isinstance(feed, Feed):
            raise InputError(f"{label}: feeds must be a list of {names}, number {number} is {feed!r}")
    return tuple(value)


def _deviation(form: Form | None, theta: Any, z: Any) -> np.ndarray:
    if form is not None:
        return form(theta, z)
    return np.zeros(np.broadcast_shapes(np.shape(theta), np.shape(z)))


CAVITATIONS = {
    "jfo": "film or void, and the oil that enters a cavity comes out of it: p >= 0, void D >= 0, p D = 0",
    "reynolds": "the film ends where pressure and slope vanish; oil is lost where it ends and found where it begins",
    "full_sommerfeld": "pressures of any sign, a film that never breaks",
    "half_sommerfeld": "as 'full_sommerfeld', and negative pressures are left out of the forces",
}
