r"""Temperatures of bodies under oil films: equilibria, and slow transients.

A film responds within milliseconds, a body within seconds to minutes. So a run of the machine has the temperatures and
the expansion of its bodies fixed, and bodies advance between such runs with the heat that films conduct into them.
Every film with a temperature is coupled to those of its two bodies that were reduced with `thermal=`:

    walls   the first surface of a film has its body's temperature at each node, the second, which slides past, the
            mean over its surface
    heat    into the first body at each node, q = g w, g = k (1 - D/h)/h, w the wall's slope (`model.films.heat`), in
            sum exactly the film's `heat_to_a`; into the second, `heat_to_b` evenly over its surface
    growth  modal forces on the global modes (`forces.ThermalLoad`), and the surfaces' expansion in addition to these as
            forms of the film's gap

The unknowns are the heats p into all walls. From them follow the bodies' temperatures, by their steady states or at the
end of a step with constant fluxes, and so walls and growth; a run of the machine with these gives heats again, y(p).
y - p = 0 is solved by the iteration

    p + (1 + S R)^-1 (y - p)

with R the walls' temperatures per heat into the body, exact, and S an estimate of what the heat into walls falls by
with their temperatures, without which it would diverge where bodies insulate better than films. With conductances G of
all nodes to all walls at a given temperature of the oil, F the upwind matrix of a mean flow that the sliding carries
along, and E the exchange of oil,

    S = diag(G^T 1) - G^T (diag(G 1) + F + E)^-1 G.

The iteration is accelerated by D. G. Anderson's method (J. ACM 12, 1965, 547), and steps that fail, or after which the
next one would be larger, are halved; what it ends with depends on none of this.
"""

from __future__ import annotations

import copy
import logging
from collections.abc import Callable
from dataclasses import dataclass, field, replace
from typing import Any

import numpy as np
import scipy.linalg as sla

from warpffrf.model.errors import InputError, require_number
from warpffrf.model.films import Film, MeasuredForm
from warpffrf.model.films.film import places_around
from warpffrf.model.films.heat import COLDEST, HOTTEST, STEP
from warpffrf.model.forces import ThermalLoad
from warpffrf.model.messages.named_arguments import named_arguments
from warpffrf.model.messages.progress import Progress
from warpffrf.model.messages.status import Status
from warpffrf.model.reduced.thermal import ReducedThermal, Warmth
from warpffrf.model.scene import Scene
from warpffrf.model.step_count import step_count
from warpffrf.output.result import Result
from warpffrf.output.simulate import equilibrium

log = logging.getLogger("warpffrf")
Array = np.ndarray
Run = Callable[[Scene], Result]

SETTLED = 0.1  # K, of walls, of the next round: viscosities then change by 0.4 %
STILL = 5e-3  # of the smallest gap: change of the expansion
ROUNDS = 60
LEAST_STEP = 1e-12  # K
CAVITY = 1e-3  # least part of a node that conducts: a cavity conducts nothing, and has no flux to be known
DEPENDENT = 1e-8  # of the largest: singular value of the changes that the acceleration leaves out
LARGEST_STEP = 30.0  # K a round: viscosities change by three
GROWS = 1.2  # a round whose step is larger than the last one's by more is repeated with half of that step
LEAST_PART = 1.0 / 32.0  # of a step that is halved
REMEMBERED = 8  # rounds, by the acceleration
LINEAR = (4.0, 3.0)  # -dw/dT of a wall at a given temperature of the oil, with another wall of given temperature or not


@dataclass(frozen=True, eq=False)
class WarmRun:
    """Temperatures of a machine's bodies at times `time` (T,) [s], one of an equilibrium.

    `states`: body name -> T states of `body.reduced.thermal`; `walls`: film name -> (T, 2) [degrees Celsius] of its
    first and second surface, means, NaN where that is no body's; `heat`: film name -> (T, 2) [W] into them. `result` is
    the last run of the machine and `scene` the scene of it, with these temperatures and expansions fixed, from which
    other runs can start. `status` and `message` as of a Result; `notes` name what is neglected.
    """

    time: Array
    states: dict[str, list[Warmth]]
    walls: dict[str, Array]
    heat: dict[str, Array]
    scene: Scene
    result: Result
    status: Status
    message: str
    notes: list[str] = field(default_factory=list)

    def mean_temperature(self, body: str) -> Array:
        """(T,) [degrees Celsius] of a body, weighted by capacity."""
        return np.array([self._thermal(body).mean_temperature(state) for state in self.states[body]])

    def hottest(self, body: str) -> Array:
        """(T,) [degrees Celsius], of the skin of a body."""
        return np.array([self._thermal(body).hottest(state) for state in self.states[body]])

    def _thermal(self, body: str) -> ReducedThermal:
        return _warm_bodies(self.scene)[body]


@named_arguments
def warm_equilibrium(scene: Scene, *, run: Run | None = None) -> WarmRun:
    """The equilibrium of `scene` with the steady temperatures of its bodies.

    run: a function of a scene that returns the Result of a run, over whose rows the heat of films is averaged; None:
    `wf.equilibrium`. For a shaft that whirls or a load that changes, `lambda scene: wf.simulate(scene, ...)`. At least
    one film needs a temperature and a body reduced with `thermal=`; a wall temperature given for such a body is
    replaced. What does not settle is a status: "too_hot" where temperatures run away, "no_equilibrium" where
    expansion closes a gap. Raises `InputError`.
    """
    walls = _walls(scene)
    bodies = _warm_bodies(scene)

    begin = {name: heat.steady() for name, heat in bodies.items()}
    row = _Round(scene, walls, begin, run).settle(None, np.inf)
    return _joined([row], np.zeros(1))


@named_arguments
def warm_up(
    scene: Scene,
    duration: float,
    *,
    step: float,
    start: float | WarmRun = 20.0,
    run: Run | None = None,
    progress: bool = True,
) -> WarmRun:
    """Temperatures of the bodies of `scene` over `duration` [s] in steps of `step` [s], slow compared with its motions,
    which `run` computes at the end of each step as in `warm_equilibrium`.

    start: uniform temperature [degrees Celsius] of all bodies, or an earlier WarmRun of the same scene, which is
    continued. Bodies advance exactly under fluxes constant over a step, those at its end: of first order in the step.
    The first row is that of the start. progress: show how many steps are done, and the time left. Ends early with the
    status of a run that fails or is interrupted. Raises `InputError`.
    """
    steps, _ = step_count(require_number(duration, "warm_up: duration", positive=True), step)
    walls, bodies = _walls(scene), _warm_bodies(scene)
    if isinstance(start, WarmRun):
        if set(start.states) != set(bodies):
            raise InputError("warm_up: start is of a scene with other warm bodies; continue with its own scene")
        states, begin = {name: found[-1] for name, found in start.states.items()}, float(start.time[-1])
    else:
        states, begin = {name: heat.uniform(start) for name, heat in bodies.items()}, 0.0

    bar = Progress("warm_up", steps, enabled=progress)
    rows = [_Round(scene, walls, states, run).settle(None, None)]
    for done in range(steps):
        if rows[-1].status != Status.COMPLETED:
            break
        rows.append(_Round(scene, walls, rows[-1].states, run).settle(rows[-1].p, float(step)))
        bar.update(done + 1)
    bar.close()
    return _joined(rows, begin + float(step) * np.arange(len(rows)))


# --- what is coupled


@dataclass(frozen=True, eq=False)
class _Wall:
    """The surface `side` (0: first, 1: second) of a film, of a body with temperatures."""

    film: Film
    side: int

    @property
    def port(self) -> Any:
        return self.film.ports[self.side]

    @property
    def thermal(self) -> ReducedThermal:
        return self.port.body.reduced.thermal

    @property
    def area(self) -> Array:
        """int psi dA (columns, rows) [m2] of the nodes of its grid."""
        surface = self.port.surface
        return np.tile(surface.grid.pitch * surface.grid.gram_z(surface.shape).sum(axis=1), (surface.grid.columns, 1))

    @property
    def key(self) -> str:
        """Its argument of `FilmTemperature`."""
        return ("wall_a", "wall_b")[self.side]

    @property
    def to_unknowns(self) -> Array:
        """(unknowns, nodes): those of a first surface are its nodes, that of a second its mean."""
        area = self.area.ravel()
        return np.eye(len(area)) if self.side == 0 else (area / area.sum())[None]

    @property
    def to_flux(self) -> Array:
        """(nodes, unknowns) [1/m2]: flux of the heat at each unknown."""
        area = self.area.ravel()
        return np.diag(1.0 / area) if self.side == 0 else np.full((len(area), 1), 1.0 / area.sum())

    def temperature(self, state: Warmth) -> Array:
        """(unknowns,) [degrees Celsius] of the body."""
        return self.to_unknowns @ self.thermal.temperature(state, self.port.name).ravel()


def _warm_bodies(scene: Scene) -> dict[str, ReducedThermal]:
    return {b.name: b.reduced.thermal for b in scene.bodies if b.reduced is not None and b.reduced.thermal is not None}


def _walls(scene: Scene) -> list[_Wall]:
    if not isinstance(scene, Scene):
        raise InputError(f"warm bodies: a Scene is needed first, got {scene!r}")
    bodies = _warm_bodies(scene)
    found = [
        _Wall(film, side)
        for film in scene.films
        if film.temperature is not None
        for side in (0, 1)
        if film.ports[side].body.name in bodies
    ]
    if not found:
        raise InputError(
            "warm bodies: no film with a temperature is on a body with temperatures; give wf.Film("
            "temperature=films.FilmTemperature(...)) and wf.reduce(thermal=films.BodyTemperature(...))"
        )
    return found


# --- one state of the machine and its bodies


@dataclass(eq=False)
class _Round:
    """The machine with wall temperatures x, one array for each wall, under heats p, from the bodies' `states`; `settle`
    finds them."""

    scene: Scene
    walls: list[_Wall]
    states: dict[str, Warmth]
    run: Run | None
    x: list[Array] = field(default_factory=list)
    p: Array = field(default_factory=lambda: np.zeros(0))
    heat: Array = field(default_factory=lambda: np.zeros(0))
    fixed: Any = None
    result: Any = None
    status: Status = Status.COMPLETED
    message: str = ""

    def settle(self, guess: Array | None, duration: float | None) -> _Round:
        """From a guess of the heats p [W], None: none. Bodies advance by `duration` [s], infinite: to their steady
        states, None: not at all."""
        before, R = dict(self.states), self._response(duration)
        p = np.zeros(len(R)) if guess is None else guess.copy()
        past: list[tuple[Array, Array]] = []
        best: tuple[float, Array] | None = None
        part, direction, off = 1.0, p, p
        for _ in range(ROUNDS):
            self.states = self._advanced(before, p, duration)
            self.x = [w.temperature(self.states[w.port.body.name]) for w in self.walls]
            hottest = self.walls[int(np.argmax([T.max() for T in self.x]))]
            if not max(float(T.max()) for T in self.x) <= HOTTEST:
                return self._failed(
                    Status.TOO_HOT,
                    f"temperatures run away: {hottest.port.label} exceeds {HOTTEST:g} degrees Celsius under "
                    f"{hottest.film.label}; cool its body more (films.BodyTemperature), or supply more oil",
                )
            better = False
            if self._run_machine():
                self.p, S = self._heats()
                grown, self.states = self._growth(), self._advanced(before, self.p, duration)
                off = R @ (self.p - p)
                gap = min(float(self._history(w).gap[-1].min()) for w in self.walls)
                moved = max(float(np.abs(now - was).max()) for now, was in zip(self._growth(), grown, strict=True))
                log.info("warm bodies: walls off by %.3g K, expansion by %.3g um", np.abs(off).max(), 1e6 * moved)
                if np.abs(off).max() < SETTLED and moved < STILL * gap:
                    return self
                step = np.linalg.solve(np.eye(len(p)) + S @ R, self.p - p)
                size = float(np.linalg.norm(R @ step))
                better = best is None or size < GROWS * best[0] or part <= LEAST_PART
            elif best is None or part <= LEAST_PART or self.status == Status.INTERRUPTED:
                return self
            if better:
                past = [*past[-REMEMBERED:], (p, step)]
                best, part, direction = (size, p), 1.0, _accelerated(past) - p
                direction *= min(1.0, LARGEST_STEP / max(float(np.abs(R @ direction).max()), LEAST_STEP))
            else:
                past, part = past[-1:], 0.5 * part
            assert best is not None  # the first run completed
            p = best[1] + part * direction
        return self._failed(
            Status.NO_EQUILIBRIUM,
            f"temperatures of bodies and films do not settle in {ROUNDS} rounds, walls are off by "
            f"{np.abs(off).max():.3g} K; take shorter steps of warm_up, or begin warm_up at other temperatures",
        )

    def _advanced(self, before: dict[str, Warmth], p: Array, duration: float | None) -> dict[str, Warmth]:
        """The bodies' states under the heats p [W] at the unknowns."""
        if duration is None:
            return before
        flux: dict[str, dict[str, Array]] = {name: {} for name in before}
        ends = np.cumsum([len(w.to_unknowns) for w in self.walls])[:-1]
        for w, heat in zip(self.walls, np.split(p, ends), strict=True):
            into = flux[w.port.body.name]
            into[w.port.name] = into.get(w.port.name, 0.0) + (w.to_flux @ heat).reshape(w.area.shape)
        bodies, steady = _warm_bodies(self.scene), np.isinf(duration)
        return {
            name: bodies[name].steady(q) if steady else bodies[name].advance(before[name], duration, flux=q)
            for name, q in flux.items()
        }

    def _response(self, duration: float | None) -> Array:
        """R [K/W] of all unknowns."""
        rows = []
        for w in self.walls:
            row = []
            for source in self.walls:
                if duration is None or source.port.body is not w.port.body:
                    row.append(np.zeros((len(w.to_unknowns), len(source.to_unknowns))))
                else:
                    gain = w.thermal.response(w.port.name, source.port.name, duration)
                    row.append(w.to_unknowns @ (gain @ source.to_flux))
            rows.append(np.concatenate(row, axis=1))
        return np.concatenate(rows)

    def _history(self, w: _Wall) -> Any:
        return self.result.history.films[str(w.film.name)]

    def _failed(self, status: Status, message: str) -> _Round:
        self.status, self.message = status, message
        return self

    def _run_machine(self) -> bool:
        """One run with these walls and expansions; whether it completed."""
        self.fixed = self._fixed()
        try:
            self.result = self.run(self.fixed) if self.run else equilibrium(self.fixed, progress=False)
        except InputError as error:
            if self.result is None:
                raise
            self._failed(Status.NO_EQUILIBRIUM, f"with the expansion of its bodies: {error}")
            return False
        if self.result.status != Status.COMPLETED:
            self._failed(self.result.status, self.result.message)
            return False
        self.status, self.message = Status.COMPLETED, ""
        return True

    def _fixed(self) -> Scene:
        """The scene with the present temperatures and expansions."""
        fixed = copy.copy(self.scene)
        fixed.films = [self._film(film) for film in self.scene.films]
        fixed.forces = list(self.scene.forces)
        for body in self.scene.bodies:
            if body.name in self.states:
                load = ThermalLoad(body, self.states[body.name], name=f"expansion of {body.name}")
                fixed.forces.append(load)
        return fixed

    def _film(self, film: Film) -> Film:
        here = [(w, T) for w, T in zip(self.walls, self.x, strict=True) if w.film is film]
        if not here or film.temperature is None:
            return film
        made = copy.copy(film)
        temperatures = {w.key: T.reshape(w.area.shape) if w.side == 0 else float(T[0]) for w, T in here}
        made.temperature = replace(film.temperature, **temperatures)
        for w, _ in here:
            key, surface = ("form_a", "form_b")[w.side], w.port.surface
            grown = w.thermal.local_expansion(self.states[w.port.body.name], w.port.name)
            form = MeasuredForm(places_around(surface), surface.grid.z, -grown, periodic=surface.grid.periodic)
            own = getattr(film, key)
            setattr(made, key, form if own is None else own + form)
        return made

    def _growth(self) -> list[Array]:
        """Normal displacement of each wall by expansion [m], global modes included."""
        found = []
        for w in self.walls:
            state, body = self.states[w.port.body.name], w.port.body.reduced
            q = w.thermal.modal_force(state) / (2.0 * np.pi * body.frequencies) ** 2
            local = w.thermal.local_expansion(state, w.port.name)
            found.append(local + (w.port.surface.mode_normal @ q).reshape(local.shape))
        return found

    def _heats(self) -> tuple[Array, Array]:
        """Heat [W] into each wall at its unknowns, and S [W/K] of all unknowns."""
        heats, slopes = [], []
        self.heat = np.zeros(len(self.walls))
        for number, given in enumerate(self.scene.films):
            here = [i for i, w in enumerate(self.walls) if w.film is given]
            if not here:
                continue
            film, made = self.result.history.films[str(given.name)], self.fixed.films[number]
            rows = slice(1 if len(film.heat_to_a) > 1 else 0, None)  # a motion's first row has had no step
            g, q = _conduction(made, film, rows)
            for i in here:
                self.heat[i] = total = float(np.mean((film.heat_to_a, film.heat_to_b)[self.walls[i].side][rows]))
                spread = (q + g * (total - q.sum()) / g.sum()).ravel()
                heats.append(spread if self.walls[i].side == 0 else np.array([total]))
            slopes.append(_slope(made, film, [self.walls[i].side for i in here], g))
        return np.concatenate(heats), np.asarray(sla.block_diag(*slopes))


def _slope(film: Film, history: Any, sides: list[int], g: Array) -> Array:
    """S [W/K] of the walls `sides` of a film with conductances g (columns, rows) [W/K], see the module."""
    heat: Any = film.temperature
    linear = LINEAR[None in heat.means] * g.ravel()
    G = np.concatenate([np.diag(linear) if side == 0 else linear[:, None] for side in sides], axis=1)
    lost = linear * len(heat.means) - linear * heat.means.count(None)  # to all walls of given temperature
    capacity = film.oil.thermal.density * film.oil.thermal.heat_capacity  # type: ignore[union-attr]
    warmer = max(abs(float(history.temperature[-1].mean()) - heat.supply), 1.0)
    exchange = abs(float(history.heat_carried[-1])) / warmer / g.size
    M = np.diag(lost + exchange)
    columns, rows = g.shape
    width = _Wall(film, 0).area[0] / _spacing(film)
    content = np.median(history.gap[-1] - history.void[-1], axis=0)
    sliding = _sliding(film)
    fed = film.held()[0]
    number = np.arange(columns * rows).reshape(columns, rows)
    for k in range(rows):
        flow = 0.5 * capacity * abs(sliding[k]) * content[k] * width[k]
        upwind = 1 if sliding[k] > 0.0 else -1
        rise = history.temperature[-1][:, k] - heat.supply
        kept = np.where(fed[:, k], np.clip(rise / np.maximum(np.roll(rise, upwind), 1.0), 0.0, 1.0), 1.0)
        M[number[:, k], number[:, k]] += flow
        M[number[:, k], np.roll(number[:, k], upwind)] -= flow * kept
    if not np.any(sliding):
        return np.diag(G.sum(axis=0))
    return np.diag(G.sum(axis=0)) - G.T @ np.linalg.solve(M, G)


def _spacing(film: Film) -> float:
    """Distance of two columns [m], in the middle of the film."""
    shape, grid = film.a.surface.shape, film.grid
    return float(grid.pitch * shape.measure_at(0.5 * (grid.z[0] + grid.z[-1])))


def _sliding(film: Film) -> Array:
    """Velocity (rows,) [m/s] of the second surface along the columns of the first, initial, mean around."""
    shape, grid = film.a.surface.shape, film.grid
    theta, z = np.meshgrid(film.theta, grid.z, indexing="ij")
    here, there = (film.a.body.to_world(shape.point(at, z)) for at in (theta, theta + 1e-3 * grid.pitch))
    along = (there - here) / np.linalg.norm(there - here, axis=-1, keepdims=True)
    a, b = (
        body.velocity + np.cross(body.angular_velocity, here - body.position) if body.index >= 0 else 0.0 * here
        for body in (film.a.body, film.b.body)
    )
    return np.einsum("jki,jki->jk", b - a, along).mean(axis=0)


def _accelerated(past: list[tuple[Array, Array]]) -> Array:
    """The next x from those before and their steps, by Anderson's method."""
    x, step = past[-1]
    if len(past) < 2:
        return x + step
    dx = np.diff([at for at, _ in past], axis=0).T
    change = np.diff([s for _, s in past], axis=0).T
    gamma = np.linalg.lstsq(change, step, rcond=DEPENDENT)[0]
    return x + step - (dx + change) @ gamma


def _conduction(film: Film, history: Any, rows: slice) -> tuple[Array, Array]:
    """Conductance g (columns, rows) [W/K] of a film at its nodes, and the heat g w [W] into its first wall, means over
    `rows`."""
    heat, oil = film.temperature, film.oil.thermal
    assert heat is not None and oil is not None
    area = _Wall(film, 0).area
    h, void, T = (getattr(history, name)[rows] for name in ("gap", "void", "temperature"))
    g = oil.conductivity * area * np.clip(1.0 - void / h, CAVITY, 1.0) / h
    if heat.wall_a is None:
        return g.mean(axis=0), np.zeros(area.shape)
    table = heat.table(film.oil)
    alpha = np.interp(T, COLDEST + STEP * np.arange(len(table)), table[:, 1])
    across = 0.0 if heat.wall_b is None else np.asarray(heat.wall_b) - np.asarray(heat.wall_a)
    w = across + alpha * (T - heat.wall_a - 0.5 * across)
    return g.mean(axis=0), (g * w).mean(axis=0)


def _joined(rows: list[_Round], time: Array) -> WarmRun:
    first, last = rows[0], rows[-1]
    walls: dict[str, Array] = {}
    heat: dict[str, Array] = {}
    for i, w in enumerate(first.walls):
        for found, values in ((walls, [r.x for r in rows]), (heat, [r.heat for r in rows])):
            table = found.setdefault(str(w.film.name), np.full((len(rows), 2), np.nan))
            table[:, w.side] = [np.mean(v[i]) if len(v) else np.nan for v in values]
    notes = []
    warm = _warm_bodies(first.scene)
    contacts = [c.label for c in first.scene.finite_sliding if any(port.body.name in warm for port in c.ports)]
    if contacts:
        notes.append(
            f"{', '.join(contacts)}: of thermal expansion, contacts have that of the global modes of their bodies alone"
        )
    return WarmRun(
        time=time, states={name: [r.states[name] for r in rows] for name in warm}, walls=walls, heat=heat,
        scene=last.fixed, result=last.result, status=last.status, message=last.message, notes=notes,
    )  # fmt: skip
