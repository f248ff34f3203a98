r"""The online check of films of evaluation "hyper": a few profiles along beside all hats, on states of the run.

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
from warpffrf.online.compile.films.bases import Basis, basis_of
from warpffrf.online.diagnosis.film_hats import HatFilm, HatState, Pose, Rates, transport
from warpffrf.online.engine import Engine
from warpffrf_kernels.core import control as k
from warpffrf_kernels.films.sampling import FILLING, FORCE

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
    same places. missed: states of which no film of all hats was found, as where profiles close the gap at an end.
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
        label, states = f"{film.label}: evaluation 'hyper', axial_degrees {film.axial_degrees}", len(self.time)
        lost = f"no film of all hats was found in {self.missed} of {states + self.missed} states of the run"
        if not states:
            return (
                f"{label}: {lost}; {cure_of(film)}" if self.missed else f"{label} was not checked, no state with a load"
            )
        text = (
            f"{label}; against all hats in {states} states of the run at most {self.gap:.2%} of the smallest gap and "
            f"{self.pressure:.2%} of the largest pressure under the same force; where the bodies are, "
            f"{self.force:.2%} of the force, {_most(self.held_gaps):.2%} of the gap and "
            f"{_most(self.held_pressures):.2%} of the pressure; worst at "
            f"t = {self.worst:.6g} s; with all hats {1e9 * np.mean(self.feed_flow):.4g} mm3/s come in through feeds "
            f"and {1e9 * np.mean(self.end_flow):.4g} leave at the ends, on average; hats of {film.grid.rows} rows "
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
    return f"take more axial_degrees, as {more}{tilts}, or evaluation='semi'"


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
    """States of the films of evaluation "hyper" between smooth walls, the second rigid, of a run of user steps `first`
    to `last`."""

    def __init__(self, engine: Engine, first: int, last: int) -> None:
        self.films = [
            i for i, film in enumerate(engine.scene.films) if film.evaluation == "hyper" and not _beyond(film)
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
    """By name of the film, of evaluation "hyper"."""
    found = {}
    for i, seen in watch.seen.items():
        film = engine.scene.films[i]
        largest = max((float(np.linalg.norm(s.force)) for s in seen), default=0.0)
        loaded = [s for s in seen if np.linalg.norm(s.force) > LIGHT * largest]
        found[str(film.name)] = _compared(film, [loaded[j] for j in _chosen(film, loaded, sampled)])
    return found


def film_check_notes(engine: Engine, checks: dict[str, FilmCheck]) -> list[str]:
    """One note for each film of evaluation "hyper"."""
    found = []
    for film in engine.scene.films:
        if str(film.name) in checks:
            found.append(checks[str(film.name)].note(film))
        elif film.evaluation == "hyper":
            found.append(
                f"{film.label}: evaluation 'hyper' was not held beside all hats, as {_beyond(film)}; what the profiles "
                "cost shows beside evaluation='semi'"
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
