r"""Accuracy of the results of oil films: whether their columns are fine enough for the thinnest film of a run.

Where a film of revolution is thinnest, h = c (1 - eps cos phi) is a parabola of the half-width sqrt(2 h_min/c) [rad].
The pressure on nodes spaced by a RULE-th of this width has the error ERROR at its peak, proportional to the square of
the pitch (rigid bearings, nodes compared with fine volumes: docs/studies/oil_film.md). An elastic surface flattens the
film there, so the estimate is conservative.

Film check. The online check of films of quadrature "reduced": a few axial profiles compared with all nodes, on states
of the run.

A run keeps up to `SEEN` states on the way, an equilibrium its own: positions, velocities, global coordinates, pressures
and cavity fractions, and the rates of film and cavity fractions of the step. On `SAMPLED` of them (those of the largest
force and the largest pressure, the last one and others spread between) the film of all nodes is solved with all of
these fixed (`film_nodes`): first with the bodies at their positions, then with the second one displaced until the force
is restored, across the axis of the first surface, or normal to a plane. A load would displace it in this direction, and
the *smallest gap* and the *largest pressure* are compared there. At the same position the *force* is compared; it
differs more than under a given load.

The solution at all nodes has an error, too. For a pressure 1 - zeta^2 along the axis, rows at a distance d lose
sum d^3/L^3 of the force, 1/n^2 with n cells. Differences of that size say nothing about the profiles, and require no
cure.

Refilling and cavitation over many steps are not included: the cavity fractions are those of the run.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from scipy.interpolate import CubicSpline

from warpffrf.model import rotation as rot
from warpffrf.model.films import Film
from warpffrf.model.films.film import places_around
from warpffrf.model.films.roughness import least_gap
from warpffrf.model.integrators import Integrator, roots_at_infinity
from warpffrf.model.scene import Scene
from warpffrf.online.compile.films.bases import Basis, basis_of
from warpffrf.online.diagnosis.film_grid import NodeFilm, NodeState, Pose, Rates, transport
from warpffrf.online.engine import Engine
from warpffrf.online.history.films import TURNED_BACK
from warpffrf.online.history.history import History
from warpffrf.online.history.interface_motion import turned
from warpffrf_kernels.core import control as k
from warpffrf_kernels.films.sampling import FILLING, FORCE, GAP

RULE, ERROR = 6.0, 0.01
DAMPS = 0.55  # spectral radius at infinity, of 0.5 with round-off: alternation has decayed within a few steps
SQUEEZED = 0.01  # of the clearance: a run that ends at this thickness has no film left


def film_notes(scene: Scene, history: History) -> list[str]:
    """One line for each film whose columns are too coarse for the eccentricity reached, for rough walls that came
    closer than flow factors are known, for walls that overlap where the pressure is given, and for a film that went
    beyond the grid of a compliant second surface.
    """
    notes = []
    for film in scene.films:
        found, clearance = history.films.get(str(film.name)), film.clearance()
        if found is None or not len(found.smallest_gap):
            continue
        thinnest = float(found.smallest_gap.min())
        notes.extend(_thinner_than_known(film, thinnest))
        notes.extend(_overlapping(film, found.gap))
        if not film.b.rigid:
            notes.extend(_beyond_second(film, history))
        if clearance is None:
            continue
        fine = np.sqrt(2.0 * max(thinnest, 0.0) / clearance) / RULE
        error = ERROR * (film.grid.pitch / fine) ** 2 if fine > 0.0 else np.inf
        if error > ERROR:
            columns = int(np.ceil(2.0 * np.pi / fine)) if fine > 0.0 else None
            more = f", {columns} columns per revolution are sufficient for 1 %" if columns else ""
            notes.append(
                f"{film.label}: its smallest film, {thinnest:.3g} m, is {thinnest / clearance:.2g} of the clearance, "
                f"too thin for columns of {np.degrees(film.grid.pitch):.3g} degrees: the peak pressure may have an "
                f"error of {min(error, 1.0):.1%}, for a rigid surface{more}; reduce with a finer mesh around"
            )
    return notes


def _thinner_than_known(film: Film, thinnest: float) -> list[str]:
    known = least_gap(film.mixed.roughness_a, film.mixed.roughness_b)
    if known <= 0.0 or thinnest >= known:
        return []
    s = film.mixed.deviation
    return [
        f"{film.label}: its smallest film, {thinnest:.3g} m, is {thinnest / s:.2g} deviations of its rough walls, and "
        f"flow factors are known from {known / s:.2g} on: below, those of the flow by pressure keep their values"
    ]


def _overlapping(film: Film, gap: np.ndarray) -> list[str]:
    """Walls at nodes of given pressure: no pressure pushes the walls apart, and nothing keeps them from overlapping."""
    held = film.held()[0]
    least = float(gap[:, held].min())
    if least > 0.0:
        return []
    j, k = np.argwhere(held)[np.argmin(gap[:, held].min(axis=0))]
    return [
        f"{film.label}: its walls overlap by up to {-least:.3g} m at theta = {film.theta[j]:.4g}, z = "
        f"{film.grid.z[k]:.4g} m, where the pressure is given and nothing keeps them apart: the adjacent film is "
        "squeezed by a nonphysical shape; give the first surface a form with relieved ends "
        "(films.BarrelForm), or asperities (mixed=)"
    ]


def _beyond_second(film: Film, history: History) -> list[str]:
    """Ends of the film more than a cell beyond the grid of the second surface, which is rigid there
    (`warpffrf_kernels.films.seats`).
    """
    surface, grid = film.b.surface, film.b.surface.grid
    first, second = (history.bodies[port.body.name] for port in film.ports)
    theta, z = (v.ravel() for v in np.meshgrid(film.theta, film.grid.z[[0, -1]], indexing="ij"))
    out = 0.0
    for place in film.a.surface.shape.point(theta, z):
        world = first.position + turned(first.rotation, place)
        theta_b, z_b, _ = surface.shape.chart(turned(second.rotation * TURNED_BACK, world - second.position))
        out = max(out, float(np.max(grid.z[0] - np.diff(grid.z[:2]) - z_b)))
        out = max(out, float(np.max(z_b - grid.z[-1] - np.diff(grid.z[-2:]))))
        if not grid.periodic:
            columns = places_around(surface)
            away = np.abs(theta_b - 0.5 * (columns[0] + columns[-1]))
            if not surface.shape.profile().planar:
                away = np.minimum(away % (2.0 * np.pi), -away % (2.0 * np.pi))
            beyond = away - 0.5 * (columns[-1] - columns[0]) - grid.pitch
            out = max(out, float(np.max(beyond * np.asarray(surface.shape.radius_at(z_b)))))
    if out <= 0.0:
        return []
    return [
        f"{film.label}: it reaches up to {out:.3g} m beyond the grid of {film.b.label} and a cell, where that surface "
        "is rigid; reduce its body with a longer contact surface"
    ]


def alternation_notes(scene: Scene, integrator: Integrator) -> list[str]:
    """For a run whose steps were halved: how the integrator treats overdamped motions, as those of thin films, in steps
    that are long compared with their time constant.
    """
    if not scene.films or np.abs(roots_at_infinity(integrator.coefficients)).max() <= DAMPS:
        return []
    return [
        "thin films damp motions within less than a step, which then alternate from step to step: "
        "fewer steps are halved with integrator=GeneralizedAlpha(0.5), or shorter steps"
    ]


def squeezed_out(engine: Engine, still: Sequence[Film] = ()) -> str:
    """For a run or an equilibrium that failed, a clause that names the film that was squeezed out, "" where none was.
    still: films in which nothing slides at any time.
    """
    films = engine.compiled.films
    for i, film in enumerate(engine.scene.films):
        first, end = films.point_start.numpy()[i : i + 2]
        gap = engine.scratch.film_line.numpy()[:, first:end, int(GAP)]
        least, thick = float(np.nanmin(gap, initial=np.inf)), float(films.thickness.numpy()[i])
        if least < SQUEEZED * thick:
            why, cure = "it does not carry its load", "it more speed, a thicker oil or less load"
            if film in still:
                why, cure = "nothing slides and it carries no load at rest", "one of its bodies a velocity"
            return (
                f"{film.label} is squeezed to {least:.2g} m, {least / thick:.1g} of its clearance, where {why}; give "
                f"{cure}, or mixed=films.MixedLubrication(laws.ExponentialAsperities(...))"
            )
    return ""


SEEN, SAMPLED = 32, 8  # states of a run: kept, and compared
NOTED = {"force": 0.005, "gap": 0.01, "pressure": 0.03}  # larger differences require a cure
LIGHT = 0.01  # of the largest force of a film in the run: below, relative errors say little
RISES = 3  # largest axial power with which rates of the film fraction are interpolated between points

Array = np.ndarray


@dataclass(frozen=True)
class FilmCheck:
    """Change of a film when it is solved at all nodes, in states at `time` (n,) [s], as fractions (n,): `forces` at the
    same positions, as vectors; `gaps` and `pressures`, the smallest and the largest, with sign, under the same force,
    `held_gaps` and `held_pressures` at the same positions. Of all nodes: flows in through feeds and out at the ends
    (n,) [m3/s], at the same positions. missed: states without a solution at all nodes, as where profiles close the gap
    at an end. own: loss of force by the rows of nodes.
    """

    time: Array
    forces: Array
    gaps: Array
    pressures: Array
    held_gaps: Array
    held_pressures: Array
    feed_flow: Array
    end_flow: Array
    missed: int = 0
    own: float = 0.0

    @property
    def force(self) -> float:
        """The largest of `forces`, NaN without states; so are `gap` and `pressure`."""
        return _most(self.forces)

    @property
    def gap(self) -> float:
        """Of `gaps`."""
        return _most(self.gaps)

    @property
    def pressure(self) -> float:
        """Of `pressures`."""
        return _most(self.pressures)

    @property
    def worst(self) -> float:
        """Time [s] of the largest of these three relative to what is noted."""
        sizes = [getattr(self, f"{name}s") / most for name, most in NOTED.items()]
        return float(self.time[int(np.argmax(np.max(np.abs(sizes), axis=0)))])

    @property
    def too_large(self) -> bool:
        """Whether one of them requires a cure."""
        return self.missed > 0 or any(getattr(self, name) > most + self.own for name, most in NOTED.items())

    def note(self, film: Film) -> str:
        """The line for the report."""
        label, states = f"{film.label}: quadrature 'reduced', axial_degrees {film.axial_degrees}", len(self.time)
        lost = f"no film of all nodes was found in {self.missed} of {states + self.missed} states of the run"
        if not states:
            return (
                f"{label}: {lost}; {cure_of(film)}" if self.missed else f"{label} was not checked, no state with a load"
            )
        text = (
            f"{label}; compared with all nodes in {states} states of the run at most {self.gap:.2%} of the smallest "
            f"gap and {self.pressure:.2%} of the largest pressure under the same force; at the same positions, "
            f"{self.force:.2%} of the force, {_most(self.held_gaps):.2%} of the gap and "
            f"{_most(self.held_pressures):.2%} of the pressure; worst at "
            f"t = {self.worst:.6g} s; with all nodes {1e9 * np.mean(self.feed_flow):.4g} mm3/s come in through feeds "
            f"and {1e9 * np.mean(self.end_flow):.4g} leave at the ends, on average; the error of {film.grid.rows} rows "
            f"of nodes is about {self.own:.2%} of the force"
        )
        if self.missed:
            text += f"; {lost}"
        return f"{text}; {cure_of(film)}" if self.too_large else text


def _of_rows(film: Film) -> float:
    """Loss of the force of an axial parabola by the rows of nodes."""
    z = film.grid.z
    return float(np.sum((np.diff(z) / (z[-1] - z[0])) ** 3))


def _most(sizes: Array) -> float:
    return float(np.abs(sizes).max()) if len(sizes) else np.nan


def cure_of(film: Film) -> str:
    """Cure that makes the differences smaller."""
    even = tuple(range(0, max(film.axial_degrees) + 3, 2))
    more = even if not any(m % 2 for m in film.axial_degrees) else tuple(range(max(film.axial_degrees) + 2))
    tilts = "" if any(m % 2 for m in film.axial_degrees) else ", odd ones too where the shaft tilts"
    return f"take more axial_degrees, as {more}{tilts}, or quadrature='full'"


@dataclass(frozen=True)
class _Seen:
    """State of a film kept by a run: time [s], positions; pressure, cavity fraction and side of functions, from which
    their rates follow; force on A [N].
    """

    time: float
    pose: Pose
    pressure: Array
    void: Array
    full: Array
    filling: Array
    refill: Array
    carried: Array
    a0: float
    force: Array


class FilmWatch:
    """States of films of quadrature "reduced" between smooth walls, the second rigid, of a run of user steps `first`
    to `last`."""

    def __init__(self, engine: Engine, first: int, last: int) -> None:
        self.films = [
            i for i, film in enumerate(engine.scene.films) if film.quadrature == "reduced" and not _beyond(film)
        ]
        steps = np.unique(np.linspace(first, last, SEEN + 1).astype(int))[1:]
        self.steps = steps if self.films else steps[:0]
        self.seen: dict[int, list[_Seen]] = {i: [] for i in self.films}

    def until(self, target: int, done: int) -> int:
        """The step to go to from `done`: `target`, or an earlier one at which the state is kept."""
        ahead = self.steps[self.steps > done]
        return min(target, int(ahead[0])) if len(ahead) else target

    def look(self, engine: Engine, done: int) -> None:
        """Keep the state where one is due."""
        if done in self.steps and not np.any(engine.word("status")):
            self.keep(engine)

    def keep(self, engine: Engine) -> None:
        """Keep the present state, that of the last attempt."""
        for i in self.films:
            self.seen[i].append(_seen(engine, i))


def check_films(engine: Engine, watch: FilmWatch, sampled: int = SAMPLED) -> dict[str, FilmCheck]:
    """Checks by name of the film, of quadrature "reduced"."""
    found = {}
    for i, seen in watch.seen.items():
        film = engine.scene.films[i]
        largest = max((float(np.linalg.norm(s.force)) for s in seen), default=0.0)
        loaded = [s for s in seen if np.linalg.norm(s.force) > LIGHT * largest]
        found[str(film.name)] = _compared(film, [loaded[j] for j in _chosen(film, loaded, sampled)])
    return found


def film_check_notes(engine: Engine, checks: dict[str, FilmCheck]) -> list[str]:
    """One note for each film of quadrature "reduced"."""
    found = []
    for film in engine.scene.films:
        if str(film.name) in checks:
            found.append(checks[str(film.name)].note(film))
        elif film.quadrature == "reduced":
            found.append(
                f"{film.label}: quadrature 'reduced'was not compared with all nodes, as {_beyond(film)}; compare "
                "with quadrature='full'"
            )
    return found


def _beyond(film: Film) -> str:
    """Why a film is not compared with all nodes, "" where it is."""
    if not film.b.rigid:
        return "its second surface is compliant"
    return "its walls are rough" if film.mixed.deviation > 0.0 else ""


def _seen(engine: Engine, i: int) -> _Seen:
    films = engine.compiled.films
    functions, points = (
        slice(*(int(n) for n in getattr(films, f"{name}_start").numpy()[i : i + 2])) for name in ("function", "point")
    )
    state, scratch = engine.state, engine.scratch
    weight = films.weight.numpy()[points]
    return _Seen(
        float(engine.word("time")[0]), _pose(engine, i), state.film_pressure.numpy()[0, 0, functions].copy(),
        state.film_void.numpy()[0, 0, functions].copy(), state.film_full.numpy()[0, 0, functions] != 0,
        scratch.film_line.numpy()[0, points, int(FILLING)] / weight, scratch.film_refill.numpy()[0, functions].copy(),
        scratch.film_carried.numpy()[0, functions].copy(), float(scratch.film_rates.numpy()[0, 0]),
        scratch.film_sums.numpy()[0, i, int(FORCE) : int(FORCE) + 3].copy(),
    )  # fmt: skip


def _pose(engine: Engine, i: int) -> Pose:
    """Positions and velocities of both bodies of film i, in static steps as the scene begins."""
    state, films, film = engine.state, engine.compiled.films, engine.scene.films[i]
    static = int(engine.word("mode")[0]) == int(k.STATIC)
    places, v, omega, turns = [], [], [], []
    for body in (film.a.body, film.b.body):
        b = body.index
        turns.append(np.eye(3) if b < 0 else rot.matrix(state.p.numpy()[0, b]))
        places.append(np.zeros(3) if b < 0 else state.r.numpy()[0, b].copy())
        v.append(np.zeros(3) if b < 0 else (films.rest_v.numpy()[b] if static else state.v.numpy()[0, b]).copy())
        of = np.zeros(3) if b < 0 else (films.rest_omega.numpy()[b] if static else state.omega.numpy()[0, b]).copy()
        omega.append(of)
    shape = film.a.surface.shape
    spin = np.zeros(3)
    if static and not shape.profile().planar:
        spin = (omega[0] @ shape.e_a) * shape.e_a
    surfaces = engine.compiled.model.surfaces
    first = int(surfaces.modal_start.numpy()[int(films.first.numpy()[i])])
    modes = np.asarray(film.a.surface.mode_normal).shape[-1]
    q = np.asarray(state.q.numpy()).reshape(engine.worlds, -1)[0, first : first + modes].copy()
    return Pose(turns[0], turns[1], places[0] - places[1], v[0], v[1], omega[0], turns[1] @ omega[1], spin, q)


def _chosen(film: Film, seen: Sequence[_Seen], sampled: int) -> list[int]:
    """States to compare: the extreme ones and others spread between."""
    if len(seen) <= sampled:
        return list(range(len(seen)))
    to_nodes = basis_of(film).to_nodes
    force = [float(np.linalg.norm(s.force)) for s in seen]
    largest = [float((to_nodes @ s.pressure).max()) for s in seen]
    first = [int(np.argmax(force)), int(np.argmax(largest)), len(seen) - 1]
    spread = np.linspace(0, len(seen) - 1, sampled - len(set(first)) + 2).astype(int)[1:-1]
    return sorted({*first, *(int(j) for j in spread)})


def _compared(film: Film, states: Sequence[_Seen]) -> FilmCheck:
    grid_nodes, own = NodeFilm(film), basis_of(film)
    rows = []
    for seen in states:
        rates = Rates(_filling(film, own, grid_nodes.basis, seen), _void_rates(own, grid_nodes.basis, seen), seen.a0)
        held = grid_nodes.solve(seen.pose, rates, _start(own, grid_nodes.basis, seen))
        if not held.found:
            continue
        moved = grid_nodes.solve(seen.pose, rates, held, _ways(film, seen.pose), seen.force)
        own_pressure = own.to_nodes @ seen.pressure
        gap, largest = grid_nodes.least(seen.pose, own_pressure), float(own_pressure.max())
        apart = [
            (state.smallest_gap / gap - 1.0, state.largest_pressure / largest - 1.0)
            for state in (moved if moved.found else held, held)
        ]
        force = float(np.linalg.norm(held.force - seen.force) / np.linalg.norm(seen.force))
        rows.append((seen.time, force, *apart[0], *apart[1], held.feed_flow, held.end_flow))
    return FilmCheck(*np.array(rows).reshape(-1, 8).T, missed=len(states) - len(rows), own=_of_rows(film))


def _column_of(own: Basis, all_nodes: Basis) -> Array:
    """(nodes,) the function that has the cavity fraction of each node."""
    return np.asarray(own.node_function)[: all_nodes.functions]


def _start(own: Basis, all_nodes: Basis, seen: _Seen) -> NodeState:
    """Values of the profiles at nodes."""
    column = _column_of(own, all_nodes)
    full = seen.full[column]
    return NodeState(np.where(full, own.to_nodes @ seen.pressure, 0.0), np.where(full, 0.0, seen.void[column]), full)


def _void_rates(own: Basis, all_nodes: Basis, seen: _Seen) -> Array:
    """delta_t D (nodes,) [m/s], of the column."""
    flow = seen.refill - transport(own, seen.carried) @ seen.void
    rate = np.divide(flow, own.area, out=np.zeros_like(flow), where=own.area > 0.0)
    return rate[_column_of(own, all_nodes)]


def _filling(film: Film, own: Basis, all_nodes: Basis, seen: _Seen) -> Array:
    """delta_t(r h) [m/s] at the points of all nodes: an axial polynomial in each strip between columns, a
    circumferential spline through their middles.
    """
    grid = film.grid
    strips = grid.columns if grid.periodic else grid.columns - 1
    middle, half = 0.5 * float(grid.z[0] + grid.z[-1]), 0.5 * float(grid.z[-1] - grid.z[0])
    rate, zeta = seen.filling.reshape(strips, -1), (own.z.reshape(strips, -1)[0] - middle) / half
    along = np.polynomial.legendre.legfit(zeta, rate.T, min(len(zeta) - 1, RISES)).T  # (strips, powers)
    x = (all_nodes.theta - film.theta[0]) / grid.pitch - 0.5
    at = np.arange(strips, dtype=float)
    if grid.periodic:
        at, along = np.append(at, strips), np.concatenate([along, along[:1]])
        around = CubicSpline(at, along, bc_type="periodic")(np.mod(x, strips))
    else:
        around = CubicSpline(at, along)(x)
    return np.polynomial.legendre.legval((all_nodes.z - middle) / half, around.T, tensor=False)


def _ways(film: Film, pose: Pose) -> Array:
    """(3, n) directions in the world in which a load moves the second body: across the axis of the first surface, or
    normal to a plane.
    """
    frame = np.asarray(film.a.surface.shape.frame)
    return pose.turn_a @ (frame[:1] if film.a.surface.shape.profile().planar else frame[:2]).T
