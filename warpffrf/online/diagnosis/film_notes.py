r"""What the results of oil films are worth: whether their columns are fine enough for the thinnest film of a run.

Where a film of revolution is thinnest, h = c (1 - eps cos phi) is a parabola of the half-width sqrt(2 h_min/c) [rad]; a
pressure of hats that are a RULE-th of it wide errs by ERROR at its peak, and by the square of the pitch (rigid
bearings, hats beside fine volumes: docs/studies/oil_film.md). An elastic surface flattens the place, so the figure is
on the safe side there.

Film check. The online check of films of quadrature "reduced": a few profiles along compared with all nodes.

A run leaves up to `SEEN` states on the way, an equilibrium its own: places, velocities, global coordinates, pressures
and voids, and the rates of filling and voids of the step. On `SAMPLED` of them, those of the largest force and the
largest pressure, the last one and others spread between, the film of all hats is solved for with all of that held
(`film_hats`): first with the bodies where they are, then with the second one moved until the force is what it was,
across the axis of the first surface, or to and from a plane. There a load would move it, and the *smallest gap* and the
*largest pressure* are compared there; at the same place the *force* differs, and more of it than a load would see.

Hats err too. Of a pressure 1 - zeta^2 along those of rows d apart lose sum d^3/L^3 of the force, 1/n^2 with n cells;
differences of that size say nothing about the profiles, and are worth no cure.

What oil does over many steps, filling a film again or leaving it, is not in it: the voids are those of the run.
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
from warpffrf.online.diagnosis.film_grid import HatFilm, HatState, Pose, Rates, transport
from warpffrf.online.engine import Engine
from warpffrf.online.history.films import TURNED_BACK
from warpffrf.online.history.history import History
from warpffrf.online.history.interface_motion import turned
from warpffrf_kernels.core import control as k
from warpffrf_kernels.films.sampling import FILLING, FORCE, GAP

RULE, ERROR = 6.0, 0.01
DAMPS = 0.55  # spectral radius at infinity, of 0.5 with round-off: what alternates is gone in a few steps
SQUEEZED = 0.01  # of the clearance: no film is left where a run ends at that


def film_notes(scene: Scene, history: History) -> list[str]:
    """One line a film whose columns are too coarse for the eccentricity that it reached, one of rough walls that came
    closer than flow factors are known, one of walls that overlap where the pressure is given, and one of a film that
    went beyond the grid of a second surface that yields."""
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
            more = f", {columns} columns on a turn would do for 1 %" if columns else ""
            notes.append(
                f"{film.label}: its smallest film, {thinnest:.3g} m, is {thinnest / clearance:.2g} of the clearance, "
                f"coarse columns of {np.degrees(film.grid.pitch):.3g} degrees for that: the peak pressure may err by "
                f"{min(error, 1.0):.1%}, where the surface does not yield{more}; reduce with a finer mesh around"
            )
    return notes


def _thinner_than_known(film: Film, thinnest: float) -> list[str]:
    known = least_gap(film.roughness_a, film.roughness_b)
    if known <= 0.0 or thinnest >= known:
        return []
    s = film.deviation
    return [
        f"{film.label}: its smallest film, {thinnest:.3g} m, is {thinnest / s:.2g} deviations of its rough walls, and "
        f"flow factors are known from {known / s:.2g} on: below, those of the flow by pressure keep their values"
    ]


def _overlapping(film: Film, gap: np.ndarray) -> list[str]:
    """Of nodes whose pressure is given: where none pushes the walls apart, nothing keeps them from overlapping."""
    held = film.held()[0]
    least = float(gap[:, held].min())
    if least > 0.0:
        return []
    j, k = np.argwhere(held)[np.argmin(gap[:, held].min(axis=0))]
    return [
        f"{film.label}: its walls overlap by up to {-least:.3g} m at theta = {film.theta[j]:.4g}, z = "
        f"{film.grid.z[k]:.4g} m, where the pressure is given and nothing keeps them apart: the film beside it is "
        "squeezed by a shape that is not there; give the first surface a form that falls off to its ends "
        "(films.BarrelForm), or asperities that carry there (law=)"
    ]


def _beyond_second(film: Film, history: History) -> list[str]:
    """Of ends of the film that lay more than a cell beyond the grid of the second surface, which does not yield there
    (`warpffrf_kernels.films.seats`)."""
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
        "does not yield; reduce its body with a longer contact surface"
    ]


def alternation_notes(scene: Scene, integrator: Integrator) -> list[str]:
    """Of a run whose steps were halved: what the integrator makes of overdamped motions, as those of thin films are,
    in steps that are long against them."""
    if not scene.films or np.abs(roots_at_infinity(integrator.coefficients)).max() <= DAMPS:
        return []
    return [
        "thin films damp motions within less than a step, which the integrator leaves alternating from step to step: "
        "steps are halved less with integrator=GeneralizedAlpha(0.5), or shorter ones"
    ]


def squeezed_out(engine: Engine, still: Sequence[Film] = ()) -> str:
    """Of a run or an equilibrium that failed, a clause that names the film that was squeezed out, "" where none was.
    still: films in which nothing slides, and never will."""
    films = engine.compiled.films
    for i, film in enumerate(engine.scene.films):
        first, end = films.point_start.numpy()[i : i + 2]
        gap = engine.scratch.film_line.numpy()[:, first:end, int(GAP)]
        least, thick = float(np.nanmin(gap, initial=np.inf)), float(films.thickness.numpy()[i])
        if least < SQUEEZED * thick:
            why, cure = "it does not carry what is on it", "it more speed, a thicker oil or less load"
            if film in still:
                why, cure = "nothing slides and it carries nothing at rest", "one of its bodies a velocity"
            return (
                f"{film.label} is squeezed to {least:.2g} m, {least / thick:.1g} of its clearance, where {why}; give "
                f"{cure}, or asperities=laws.ExponentialAsperities(...)"
            )
    return ""


SEEN, SAMPLED = 32, 8  # states of a run: kept, and looked at
NOTED = {"force": 0.005, "gap": 0.01, "pressure": 0.03}  # larger differences are worth a cure
LIGHT = 0.01  # of the largest force of a film in the run: beside less, errors say little
RISES = 3  # power along with which rates of filling are carried from points to points, at most

Array = np.ndarray


@dataclass(frozen=True)
class FilmCheck:
    """What all hats change of a film in states at `time` (n,) [s], as fractions (n,): `forces` at the same places, as
    vectors; `gaps` and `pressures`, the smallest and the largest, with sign, under the same force, `held_gaps` and
    `held_pressures` at the same places. Of all hats: flows in through feeds and out at the ends (n,) [m3/s], at the
    same places. missed: states of which no film of all nodes was found, as where profiles close the gap at an end.
    own: what rows of hats leave of the force."""

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
        """Time [s] of the largest of these three beside what is noted."""
        sizes = [getattr(self, f"{name}s") / most for name, most in NOTED.items()]
        return float(self.time[int(np.argmax(np.max(np.abs(sizes), axis=0)))])

    @property
    def too_large(self) -> bool:
        """Whether one of them is worth a cure."""
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
            f"{label}; against all nodes in {states} states of the run at most {self.gap:.2%} of the smallest gap and "
            f"{self.pressure:.2%} of the largest pressure under the same force; where the bodies are, "
            f"{self.force:.2%} of the force, {_most(self.held_gaps):.2%} of the gap and "
            f"{_most(self.held_pressures):.2%} of the pressure; worst at "
            f"t = {self.worst:.6g} s; with all nodes {1e9 * np.mean(self.feed_flow):.4g} mm3/s come in through feeds "
            f"and {1e9 * np.mean(self.end_flow):.4g} leave at the ends, on average; nodes of {film.grid.rows} rows "
            f"err by about {self.own:.2%} of the force themselves"
        )
        if self.missed:
            text += f"; {lost}"
        return f"{text}; {cure_of(film)}" if self.too_large else text


def _of_rows(film: Film) -> float:
    """What hats leave of the force of a parabola along."""
    z = film.grid.z
    return float(np.sum((np.diff(z) / (z[-1] - z[0])) ** 3))


def _most(sizes: Array) -> float:
    return float(np.abs(sizes).max()) if len(sizes) else np.nan


def cure_of(film: Film) -> str:
    """What makes the differences smaller."""
    even = tuple(range(0, max(film.axial_degrees) + 3, 2))
    more = even if not any(m % 2 for m in film.axial_degrees) else tuple(range(max(film.axial_degrees) + 2))
    tilts = "" if any(m % 2 for m in film.axial_degrees) else ", odd ones too where the shaft tilts"
    return f"take more axial_degrees, as {more}{tilts}, or quadrature='full'"


@dataclass(frozen=True)
class _Seen:
    """What a run leaves of a film: time [s], places; of functions pressure, void and side, what
    their rates follow from; force on A [N]."""

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
        """The step to go to from `done`: `target`, or one to look at before it."""
        ahead = self.steps[self.steps > done]
        return min(target, int(ahead[0])) if len(ahead) else target

    def look(self, engine: Engine, done: int) -> None:
        """Keep the state where one is to be looked at."""
        if done in self.steps and not np.any(engine.word("status")):
            self.keep(engine)

    def keep(self, engine: Engine) -> None:
        """The state of now, that of the last attempt."""
        for i in self.films:
            self.seen[i].append(_seen(engine, i))


def check_films(engine: Engine, watch: FilmWatch, sampled: int = SAMPLED) -> dict[str, FilmCheck]:
    """By name of the film, of quadrature "reduced"."""
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
                f"{film.label}: quadrature 'reduced' was not compared with all nodes, as {_beyond(film)}; what the "
                "profiles cost shows beside quadrature='full'"
            )
    return found


def _beyond(film: Film) -> str:
    """Why a film of all hats is not compared, "" where it is."""
    if not film.b.rigid:
        return "its second surface yields"
    return "its walls are rough" if film.deviation > 0.0 else ""


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
    """Where both bodies of film i are and how they move, in static steps as the scene begins."""
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
    """Which states to look at: the extreme ones and others spread between."""
    if len(seen) <= sampled:
        return list(range(len(seen)))
    to_hats = basis_of(film).to_hats
    force = [float(np.linalg.norm(s.force)) for s in seen]
    largest = [float((to_hats @ s.pressure).max()) for s in seen]
    first = [int(np.argmax(force)), int(np.argmax(largest)), len(seen) - 1]
    spread = np.linspace(0, len(seen) - 1, sampled - len(set(first)) + 2).astype(int)[1:-1]
    return sorted({*first, *(int(j) for j in spread)})


def _compared(film: Film, states: Sequence[_Seen]) -> FilmCheck:
    hats, own = HatFilm(film), basis_of(film)
    rows = []
    for seen in states:
        rates = Rates(_filling(film, own, hats.basis, seen), _void_rates(own, hats.basis, seen), seen.a0)
        held = hats.solve(seen.pose, rates, _start(own, hats.basis, seen))
        if not held.found:
            continue
        moved = hats.solve(seen.pose, rates, held, _ways(film, seen.pose), seen.force)
        own_pressure = own.to_hats @ seen.pressure
        gap, largest = hats.least(seen.pose, own_pressure), float(own_pressure.max())
        apart = [
            (state.smallest_gap / gap - 1.0, state.largest_pressure / largest - 1.0)
            for state in (moved if moved.found else held, held)
        ]
        force = float(np.linalg.norm(held.force - seen.force) / np.linalg.norm(seen.force))
        rows.append((seen.time, force, *apart[0], *apart[1], held.feed_flow, held.end_flow))
    return FilmCheck(*np.array(rows).reshape(-1, 8).T, missed=len(states) - len(rows), own=_of_rows(film))


def _column_of(own: Basis, all_hats: Basis) -> Array:
    """(hats,) the function that has the void of each hat."""
    return np.asarray(own.hat_function)[: all_hats.functions]


def _start(own: Basis, all_hats: Basis, seen: _Seen) -> HatState:
    """What the profiles are at hats."""
    column = _column_of(own, all_hats)
    full = seen.full[column]
    return HatState(np.where(full, own.to_hats @ seen.pressure, 0.0), np.where(full, 0.0, seen.void[column]), full)


def _void_rates(own: Basis, all_hats: Basis, seen: _Seen) -> Array:
    """delta_t D (hats,) [m/s], of the column."""
    flow = seen.refill - transport(own, seen.carried) @ seen.void
    rate = np.divide(flow, own.area, out=np.zeros_like(flow), where=own.area > 0.0)
    return rate[_column_of(own, all_hats)]


def _filling(film: Film, own: Basis, all_hats: Basis, seen: _Seen) -> Array:
    """delta_t(r h) [m/s] at the points of all hats: a polynomial along in each strip between columns, a spline around
    through their middles."""
    grid = film.grid
    strips = grid.columns if grid.periodic else grid.columns - 1
    middle, half = 0.5 * float(grid.z[0] + grid.z[-1]), 0.5 * float(grid.z[-1] - grid.z[0])
    rate, zeta = seen.filling.reshape(strips, -1), (own.z.reshape(strips, -1)[0] - middle) / half
    along = np.polynomial.legendre.legfit(zeta, rate.T, min(len(zeta) - 1, RISES)).T  # (strips, powers)
    x = (all_hats.theta - film.theta[0]) / grid.pitch - 0.5
    at = np.arange(strips, dtype=float)
    if grid.periodic:
        at, along = np.append(at, strips), np.concatenate([along, along[:1]])
        around = CubicSpline(at, along, bc_type="periodic")(np.mod(x, strips))
    else:
        around = CubicSpline(at, along)(x)
    return np.polynomial.legendre.legval((all_hats.z - middle) / half, around.T, tensor=False)


def _ways(film: Film, pose: Pose) -> Array:
    """(3, n) directions in the world in which a load moves the second body: across the axis of the first surface, or to
    and from a plane."""
    frame = np.asarray(film.a.surface.shape.frame)
    return pose.turn_a @ (frame[:1] if film.a.surface.shape.profile().planar else frame[:2]).T
