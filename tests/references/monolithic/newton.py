r"""One step of the monolithic system by Newton's method, contact included.

An iteration evaluates all residuals, factors (or reuses) K and solves for the changes of all unknowns and of the
contact multipliers at once. For one linearisation the active set is corrected until it is stationary, as in the
separated solver: a multiplier that is not positive leaves, a test whose linearised gap closes enters. Under law "nodes"
with an assembled Jacobian the set is that of the penetrating nodes (semismooth Newton); if that does not converge soon,
it is made stationary too, with one factorisation per correction.

Convergence is measured by fractions: unbalanced forces relative to the largest force, modal ones to the largest modal
force, joint defects and open gaps to the penetration (to 1 m without contact). The tolerance is not below the round-off
of accelerations due to that of increments, and that of forces in a stiff layer due to that of positions.

Oil films (`films`) are admitted only without contacts: their pressures and cavity volumes are unknowns of the same
system, and convergence is checked only after an iteration that leaves their sets unchanged.
"""

from __future__ import annotations

import time as clock
from dataclasses import dataclass, field
from typing import Any

import numpy as np
from scipy.linalg import cho_factor, cho_solve, lu_factor, lu_solve

from references.monolithic.core.description import SceneData
from references.monolithic.core.equations import Balance, Increment, LocalData, Trial, advance, balance, predicted
from references.monolithic.core.integrator import Formula
from references.monolithic.core.linear import Dense, LowRank, SingularError, Solver, dense_jacobian
from references.monolithic.core.state import Layout, State
from references.monolithic.films import newton as film_newton
from references.monolithic.films.film import FilmData, FilmState, Memory, Unknowns, rates_of
from references.monolithic.line_of_centres.window import windowed
from references.monolithic.nodal.newton import MAX_ITERATIONS as LONGEST
from references.monolithic.nodal.newton import (
    Halving,
    add_stiffness,
    cut_short,
    node_pair_state,
    size_of,
    stiffness_of,
    with_constants,
)
from references.monolithic.nodal.pair import ITERATE

MAX_ITERATIONS = 25  # Newton is quadratic; semismooth and modified iterations take some more
MAX_CORRECTIONS = 40  # of the active set for one linearisation: more means that it cycles
PLAIN = 8  # iterations with the set of the penetrating nodes; then every linearisation makes its set stationary
SLOW = 0.1  # contraction of the residual above which a kept factor is renewed
ROUND_OFF = 1e-15  # of increments: accelerations have it times ACC
EPSILON = 2.2e-16  # relative round-off of a coordinate
GAP_TOLERANCE = 1e-15  # m: a mean gap of round-off size does not close
NO_FORCE = 1e-30  # N: a scale that is never zero
SYMMETRIC = 1e-14  # of the diagonal: symmetric up to this round-off, the Cholesky factor is used
SHORT = 1e-6  # of the coordinates: defects are not related to a smaller penetration


@dataclass
class Counters:
    """Cost of a run: accepted steps, iterations, factorisations, and seconds by part."""

    steps: int = 0
    iterations: int = 0
    factorisations: int = 0
    seconds: dict[str, float] = field(default_factory=dict)

    def spend(self, part: str, begin: float) -> None:
        """Add the time since `begin`."""
        self.seconds[part] = self.seconds.get(part, 0.0) + clock.perf_counter() - begin


@dataclass(eq=False)
class System:
    """A scene as one system of equations."""

    data: SceneData
    layout: Layout
    local: LocalData
    pairs: list[Any]  # `line_of_centres.pair.PairData`, or all `nodal.pair.NodePairData`, at nodes of any surface
    surfaces: list[tuple[int, int | None]]
    variant: str
    assembled: bool  # contact stiffness is added to K
    tolerance: float
    nodal: bool = False  # pairs are `NodePairData`
    films: list[FilmData] = field(default_factory=list)
    film_stretch: float = 1.0  # time of films over that of the bodies in static steps
    counters: Counters = field(default_factory=Counters)
    kept: Solver | None = None
    kept_for: tuple = ()
    buffer: np.ndarray | None = None  # of K and, in place, of its factor

    def local_slices(self, pair: int) -> tuple[slice | None, slice | None]:
        """Position in `q` of the local coordinates of both sides of a pair; None for a rigid one."""
        starts, counts = self.layout.local_start, self.layout.local_count
        a, b = (None if s is None else slice(starts[s], starts[s] + counts[s]) for s in self.surfaces[pair])
        return a, b


@dataclass(eq=False)
class Evaluation:
    """All residuals at a trial state."""

    trial: Trial
    balance: Balance
    pairs: list[Any]
    pressures: list[np.ndarray]  # multipliers (n,) of each pair's tests
    residual: np.ndarray  # with contact forces
    films: list[FilmState] = field(default_factory=list)

    def loads(self, nodal: bool) -> list[tuple[np.ndarray, np.ndarray]]:
        """Unknowns and generalised force of every active pair, and of every film."""
        found = []
        for pair, s in zip(self.pairs, self.pressures, strict=True):
            active = np.flatnonzero(s > 0.0)
            if len(active):
                found.append((pair.data.columns, pair.total() if nodal else pair.force(active, s[active])))
        return found + [(film.data.columns, film.total) for film in self.films]


@dataclass(eq=False)
class Solution:
    """A step: its result, and the reason of its failure ('' if none)."""

    increment: Increment
    evaluation: Evaluation | None
    iterations: int
    factorisations: int
    failure: str = ""


def evaluate(
    system: System, state: State, formula: Formula, x: Increment, time: float, carried: list[Any],
    oil: list[Unknowns] | None = None,
) -> Evaluation:  # fmt: skip
    """Residuals at the end of the step for increments x, multipliers `carried` (by number of the test), and pressures
    and cavity volumes of films, `oil`, None for those of the state."""
    layout, begin = system.layout, clock.perf_counter()
    trial = advance(state, formula, x, time)
    found = balance(system.data, layout, system.local, state, formula, x, trial)
    system.counters.spend("equations", begin)
    residual = found.residual.copy()
    pairs, pressures = [], []
    begin = clock.perf_counter()
    for n, data in enumerate(system.pairs):
        if system.nodal:
            pair = node_pair_state(data, layout, trial, state, formula, system.local_slices(n), carried[n])
            residual[data.columns] -= pair.total()
            pairs.append(pair)
            pressures.append(pair.force)
            continue
        pair, s = windowed(system, n, data, trial, carried[n])
        if system.assembled:
            s = np.where(pair.area > 0.0, np.maximum(-pair.gap / pair.softness, 0.0), 0.0)
        active = np.flatnonzero(s)
        if len(active):
            residual[data.columns] -= pair.force(active, s[active])
        pairs.append(pair)
        pressures.append(s)
    films = []
    for n, data in enumerate(system.films):
        memory = Memory.of(data, state)
        given = Unknowns(memory.pressure, memory.void, memory.full) if oil is None else oil[n]
        films.append(FilmState(data, trial, rates_of(data, memory, formula, system.film_stretch), given, formula.vel))
        residual[data.columns] -= films[-1].total
    system.counters.spend("contact", begin)
    return Evaluation(trial, found, pairs, pressures, residual, films)


def imbalance(system: System, formula: Formula, x: Increment, e: Evaluation) -> float:
    """The largest residual as a fraction, see the module."""
    layout, r, trial = system.layout, e.residual, e.trial
    force, depth, worst = max(e.balance.force, NO_FORCE), 0.0, 0.0
    modal, closure, unlike = NO_FORCE, 0.0, 0.0
    for pair, s in zip(e.pairs, e.pressures, strict=True):
        active = np.flatnonzero(s > 0.0)
        if not len(active):
            continue
        load = pair.total() if system.nodal else pair.force(active, s[active])
        force = max(force, float(np.linalg.norm(load[:3])))
        modal = max(modal, float(np.abs(load[pair.data.rigid :]).max(initial=0.0)))
        if system.nodal:
            extent = float(np.abs(trial.r).max())
            closure = max(closure, EPSILON * extent * float(np.abs(pair.stiffness[:, 0, 0]).sum()))
            depth = max(depth, float(np.abs(pair.rigid_gap[active]).max()))
            unlike += pair.off
            continue
        if system.assembled:  # round-off of the positions of nodes, times the stiffness of the layer
            extent = float(np.abs(trial.r).max())
            closure = max(closure, EPSILON * extent * float(np.sum(1.0 / pair.softness[active])))
        area = pair.area[active]
        closed = pair.rigid_gap[active] / area
        depth = max(depth, float(np.abs(closed).max()))
        if not system.assembled:
            open_gap = (pair.gap[active] + pair.softness[active] * s[active]) / area
            worst = max(worst, float(np.abs(open_gap).max()))
    for film in e.films:
        force = max(force, float(np.linalg.norm(film.total[:3])))
        modal = max(modal, float(np.abs(film.loads).max(initial=0.0)))
        extent = float(np.abs(trial.r).max()) + float(np.abs(film.data.points.x).max())
        worst = max(worst, film.off / max(1.0, film.blur(extent) / system.tolerance))
    blur = max(1.0, closure / (system.tolerance * force))
    force, modal = force * blur, modal * blur
    length = 1.0
    if depth > 0.0:
        length = max(depth, SHORT * max(1.0, float(np.abs(trial.r).max())))
    worst = max(worst / min(length, 1.0) if depth > 0.0 else 0.0, unlike / force)
    defects = np.abs(r[layout.coordinates :])
    worst = max(worst, float(defects.max(initial=0.0)) / min(length, 1.0))
    acc = formula.acc
    for b, body in enumerate(system.data.bodies):
        travel = float(np.linalg.norm(x.dx[b])) + body.gyration * float(np.linalg.norm(x.psi[b]))
        floor = ROUND_OFF / system.tolerance * acc * body.mass * travel
        scale = max(force, floor)
        part = r[6 * b : 6 * b + 6]
        worst = max(worst, float(np.linalg.norm(part[:3])) / scale)
        worst = max(worst, float(np.linalg.norm(part[3:])) / body.gyration / scale)
    flexible = r[6 * layout.bodies : layout.coordinates]
    if len(flexible):
        n = layout.modes
        stiffness = np.concatenate([b.stiffness for b in system.data.bodies] + [system.local.stiffness])
        mass = np.concatenate([np.ones(n), system.local.mass])
        modal = max(modal, float(np.abs(stiffness * trial.q).max()), float(np.abs(mass * trial.qdd).max()))
        floor = ROUND_OFF / system.tolerance * acc * float(np.abs(mass * x.dq).max())
        worst = max(worst, float(np.abs(flexible).max()) / max(modal, floor))
    if not np.isfinite(worst + float(np.sum(r)) + float(np.sum(trial.T_inverse))):
        return np.inf
    return worst


def solve_step(system: System, state: State, formula: Formula, time: float) -> Solution:
    """The state at `time`, from `state`."""
    if system.films:
        return _solve_with_films(system, state, formula, time)
    layout = system.layout
    x = predicted(state, formula)
    carried: list[Any] = [dict(p) for p in state.active]
    if system.nodal:
        carried = [state.nodes[data.rows][:, ITERATE] for data in system.pairs]
    factorisations, before = 0, np.inf
    most = LONGEST if system.nodal else MAX_ITERATIONS
    halving = Halving()
    key = (formula.h, formula.coefficients)
    if system.kept_for != key:
        system.kept, system.kept_for = None, key
    for iteration in range(most + 1):
        e = evaluate(system, state, formula, x, time, carried)
        size = size_of(e.balance, e.residual, layout) if system.nodal else 0.0
        while system.nodal and (shorter := halving.shortened(iteration, size, layout)) is not None:
            x, carried = shorter
            e = evaluate(system, state, formula, x, time, carried)
            size = size_of(e.balance, e.residual, layout)
        off = imbalance(system, formula, x, e)
        if not np.isfinite(off):
            return Solution(x, None, iteration, factorisations, "not_finite")
        if iteration > 0 and off <= system.tolerance and _complementary(system, e):
            return Solution(x, e, iteration, factorisations)
        if iteration == most:
            break
        try:
            renew = system.variant != "modified" or system.kept is None or off > SLOW * before
            if system.variant == "modified" and iteration == 0 and system.kept is not None:
                renew = False
            begin = clock.perf_counter()
            if renew or system.kept is None:
                z, carried, settled, count = _renewed(system, e, settle=iteration >= PLAIN)
                factorisations += count
            else:
                z, carried, settled = _correction(system, e, system.kept)
                system.counters.spend("solve", begin)
        except FloatingPointError:
            return Solution(x, None, iteration, factorisations, "not_finite")
        except (SingularError, np.linalg.LinAlgError):
            return Solution(x, None, iteration, factorisations, "singular")
        if not settled:
            return Solution(x, None, iteration, factorisations, "cycling")
        before = off
        if system.nodal:
            z, carried = cut_short(e.pairs, z)
            halving.keep(x, z, e, carried, size)
        x.add(z, layout, e.trial.T_inverse)
    return Solution(x, None, most, factorisations, "not_converged")


def _solve_with_films(system: System, state: State, formula: Formula, time: float) -> Solution:
    """The same for a scene with oil films: no contacts, and a new factor in each iteration."""
    layout, x = system.layout, predicted(state, formula)
    memories = [Memory.of(data, state) for data in system.films]
    oil = [Unknowns(m.pressure, m.void, m.full) for m in memories]
    ahead = evaluate(system, state, formula, x, time, [], oil)
    still = Increment(np.zeros_like(x.dx), np.zeros_like(x.psi), np.zeros_like(x.dq), x.lam)
    there = evaluate(system, state, formula, still, time, [], oil)
    film_newton.guard([(a.gap, b.gap) for a, b in zip(there.films, ahead.films, strict=True)], x)
    changed = True
    for iteration in range(film_newton.MAX_ITERATIONS + 1):
        e = evaluate(system, state, formula, x, time, [], oil)
        if any(not film.gap.min() > 0.0 for film in e.films):
            return Solution(x, None, iteration, iteration, "not_converged")
        off = imbalance(system, formula, x, e)
        if not np.isfinite(off):
            return Solution(x, None, iteration, iteration, "not_finite")
        if not changed and off <= system.tolerance:
            return Solution(x, e, iteration, iteration)
        try:
            begin = clock.perf_counter()
            K, slopes = dense_jacobian(layout, e.balance, [], []), [film.slopes() for film in e.films]
            z, changes = film_newton.correction(K, layout.coordinates, e.residual, e.films, slopes)
            system.counters.spend("factor", begin)
        except FloatingPointError:
            return Solution(x, None, iteration, iteration, "not_finite")
        except SingularError:
            return Solution(x, None, iteration, iteration, "singular")
        part = film_newton.part_of(e.films, slopes, z)
        new = [film_newton.taken(film, change, part) for film, change in zip(e.films, changes, strict=True)]
        oil, changed = [found for found, _ in new], part < 1.0 or any(switched for _, switched in new)
        x.add(part * z, layout, e.trial.T_inverse)
    return Solution(x, None, film_newton.MAX_ITERATIONS, film_newton.MAX_ITERATIONS, "not_converged")


def _complementary(system: System, e: Evaluation) -> bool:
    """Whether all tests outside the active set are open."""
    if system.assembled:
        return True
    for pair, s in zip(e.pairs, e.pressures, strict=True):
        idle = (s <= 0.0) & (pair.area > 0.0)
        depth = float(np.abs(pair.rigid_gap / np.where(pair.area > 0.0, pair.area, 1.0))[s > 0.0].max(initial=0.0))
        allowed = pair.area[idle] * max(GAP_TOLERANCE, system.tolerance * depth)
        if np.any(pair.gap[idle] < -allowed):
            return False
    return True


def _renewed(system: System, e: Evaluation, *, settle: bool) -> tuple[np.ndarray, list[dict[int, float]], bool, int]:
    """A correction with a new factor, and the number of factorisations.

    With an assembled contact stiffness every correction of the active set requires a new matrix: if the set is to
    `settle`, the nodes with closed linearised gap have `s = -(g + dg)/E` in the next one.
    """
    sets = [s > 0.0 for s in e.pressures]
    for count in range(1, MAX_CORRECTIONS + 1):
        begin = clock.perf_counter()
        system.kept = solver = _factor(system, e, sets)
        system.counters.spend("factor", begin)
        begin = clock.perf_counter()
        if system.nodal or not system.assembled:
            found = *_correction(system, e, solver), count
            system.counters.spend("solve", begin)
            return found
        residual = e.balance.residual.copy()
        for pair, on in zip(e.pairs, sets, strict=True):
            at = np.flatnonzero(on)
            if len(at):
                residual[pair.data.columns] -= pair.force(at, -pair.gap[at] / pair.softness[at])
        z = solver.solve(-residual)
        closed = [(p.gap + p.change(z[p.data.columns]) < -GAP_TOLERANCE) & (p.area > 0.0) for p in e.pairs]
        system.counters.spend("solve", begin)
        if not settle or all(np.array_equal(a, b) for a, b in zip(closed, sets, strict=True)):
            return z, [{} for _ in e.pairs], True, count
        sets = closed
    return np.zeros(system.layout.size), [{} for _ in e.pairs], False, MAX_CORRECTIONS


def _factor(system: System, e: Evaluation, sets: list[np.ndarray]) -> Solver:
    turnings, stiffness = [], []
    if system.nodal:
        turnings = [(pair, pair.turning()) for pair in e.pairs if len(pair.active)]
        if system.variant == "low_rank":
            return add_stiffness(LowRank(system.layout, e.balance, turnings), system.layout.size, e.pairs)
        stiffness = [found for pair in e.pairs if (found := stiffness_of(pair)) is not None]
        return _dense(system, e, turnings, stiffness)
    for pair, s, on in zip(e.pairs, e.pressures, sets, strict=True):
        active = np.flatnonzero(s > 0.0)
        if len(active):
            turnings.append((pair, pair.turning(active, s[active])))
        carrying = np.flatnonzero(on)
        if system.assembled and len(carrying):
            gradient, force = pair.rows(carrying)
            stiffness.append((pair.data.columns, force, gradient, pair.softness[carrying]))
    if system.variant == "low_rank":
        return LowRank(system.layout, e.balance, turnings)
    return _dense(system, e, turnings, stiffness)


def _dense(system: System, e: Evaluation, turnings: list[Any], stiffness: list[Any]) -> Solver:
    n = system.layout.size
    if system.buffer is None or system.buffer.shape != (n, n):
        system.buffer = np.zeros((n, n), order="F")
    K = dense_jacobian(system.layout, e.balance, turnings, stiffness, system.buffer)
    return Dense(K, system.layout.coordinates)


def _correction(system: System, e: Evaluation, solver: Solver) -> tuple[np.ndarray, list[dict[int, float]], bool]:
    """Changes (size,) of the unknowns, the new multipliers, and whether the active set is stationary."""
    free = solver.solve(-(with_constants(e.residual, e.pairs) if system.nodal else e.residual))
    if system.assembled or not e.pairs:
        return free, [{} for _ in e.pairs], True
    size = system.layout.size
    active = [(s > 0.0) | ((s <= 0.0) & (p.gap < -GAP_TOLERANCE * p.area) & (p.area > 0.0)) for p, s in zip(
        e.pairs, e.pressures, strict=True
    )]  # fmt: skip
    base = e.pressures
    columns: dict[tuple[int, int], int] = {}
    gradients, responses = np.zeros((0, size)), np.zeros((size, 0))
    z, new = free, [s.copy() for s in base]
    for _ in range(MAX_CORRECTIONS):
        involved = [np.flatnonzero(a | (s > 0.0)) for a, s in zip(active, base, strict=True)]
        fresh_g, fresh_f = [], []
        for n, (pair, tests) in enumerate(zip(e.pairs, involved, strict=True)):
            missing = np.array([t for t in tests if (n, int(t)) not in columns], dtype=np.intp)
            if not len(missing):
                continue
            gradient, force = pair.rows(missing)
            for block, into in ((gradient, fresh_g), (force, fresh_f)):
                wide = np.zeros((len(missing), size))
                wide[:, pair.data.columns] = block
                into.append(wide)
            for t in missing:
                columns[(n, int(t))] = len(columns)
        if fresh_g:
            gradients = np.vstack([gradients, *fresh_g])
            responses = np.hstack([responses, solver.solve(np.asfortranarray(np.vstack(fresh_f).T))])
        on, off, right, softness, leaving = [], [], [], [], []
        for n, (pair, tests) in enumerate(zip(e.pairs, involved, strict=True)):
            for t in tests:
                at = columns[(n, int(t))]
                if active[n][t]:
                    on.append((n, int(t), at))
                    right.append(pair.gap[t] + pair.softness[t] * base[n][t])
                    softness.append(pair.softness[t])
                else:
                    off.append(at)
                    leaving.append(-base[n][t])
        start = free + (responses[:, off] @ np.array(leaving) if off else 0.0)
        at = np.array([c for _, _, c in on], dtype=np.intp)
        new = [np.zeros_like(s) for s in base]
        z = start
        if len(at):
            G, X = gradients[at], responses[:, at]
            S = G @ X + np.diag(softness)
            ds = _solve_small(S, -(np.array(right) + G @ start))
            z = start + X @ ds
            for (n, t, _), change in zip(on, ds, strict=True):
                new[n][t] = base[n][t] + change
        settled = True
        for n, pair in enumerate(e.pairs):
            linear = pair.gap + pair.change(z[pair.data.columns])
            leave = active[n] & (new[n] <= 0.0)
            enter = ~active[n] & (pair.area > 0.0) & (linear < -GAP_TOLERANCE * pair.area)
            if np.any(leave) or np.any(enter):
                settled = False
                active[n] = (active[n] & ~leave) | enter
        if settled:
            carried = [
                {int(pair.number[t]): float(s[t]) for t in np.flatnonzero(s > 0.0)}
                for pair, s in zip(e.pairs, new, strict=True)
            ]
            return z, carried, True
    return z, [{} for _ in e.pairs], False


def _solve_small(S: np.ndarray, right: np.ndarray) -> np.ndarray:
    """S^-1 `right` of an equilibrated Schur complement, symmetric except for rotations of the grids with the bodies."""
    d = 1.0 / np.sqrt(np.abs(np.diag(S)))
    scaled = S * d[:, None] * d[None, :]
    if np.abs(scaled - scaled.T).max() < SYMMETRIC:
        return d * cho_solve(cho_factor(scaled), d * right)
    return d * lu_solve(lu_factor(scaled), d * right)
