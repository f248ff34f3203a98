"""The run of the monolithic solver: start, time loop, stop."""

from __future__ import annotations

import logging
import time as clock
from typing import Any

import numpy as np

from references.monolithic.core.description import describe_scene
from references.monolithic.core.integrator import BEGIN, FORGET, REST, Formula, coefficients_of
from references.monolithic.core.local_coordinates import TREATMENTS
from references.monolithic.core.state import State, initial_state, layout_of
from references.monolithic.core.tension import tensions_of
from references.monolithic.films.basis import bilinear_basis, node_basis
from references.monolithic.films.film import TURNS, FilmData, Memory, begin_films
from references.monolithic.history import MonolithicHistory
from references.monolithic.line_of_centres.pair import pair_data
from references.monolithic.local_systems import local_systems
from references.monolithic.newton import Evaluation, Solution, System, solve_step
from references.monolithic.nodal.build import memory, node_pairs
from references.monolithic.records import Records
from references.monolithic.refusals import needs_nodes, refuse_contacts, refuse_films
from references.monolithic.settings import TOLERANCE, check_choices, contact_layers
from references.monolithic.start import START_STEP, begin, standing
from warpffrf.model.errors import MOST_COUNTED, InputError, require_count, require_number
from warpffrf.model.friction import friction_notes
from warpffrf.model.messages.progress import Progress
from warpffrf.model.step_count import step_count

log = logging.getLogger("warpffrf")

REST_FIRST, REST_LAST, REST_GROWTH, REST_STEPS = 1e-3, 1.0, 10.0, 60  # s: proximal steps towards the static state
REST_TOLERANCE = 1e-12  # m, movement of the last of them
REST_SHRINK, REST_SHORTEST = 0.1, 1e-9  # with films: times a step that failed; s
SIZED = ("q", "r", "locked", "nodes", "film_nodes", "film_points")  # fields of a state whose sizes reveal another scene
VOIDS_STAY = 1e-9  # of the clearance: admissible change of cavity volumes in the last step
MESSAGES = {
    "not_converged": "the Newton iteration did not converge; reduce step",
    "cycling": "the active set of contact cycles; reduce step, or coarsen the contact grid, ContactGrid(spacing=)",
    "not_finite": "a NaN or infinite number arose; look for extreme loads, masses or stiffnesses",
    "singular": "the equations are singular: redundant constraints, or a mechanism with no load path",
}


def build(
    scene: Any,
    *,
    variant: str = "full",
    law: str = "hats",
    at_nodes: bool = False,
    local: str = "quasi_static",
    local_modes: dict[tuple[str, str], Any] | None = None,
    local_damping: float = 0.0,
    layer_stiffness: float | None = None,
    stick_stiffness: float | None = None,
    tolerance: float = TOLERANCE,
) -> tuple[System, State]:
    """The system of equations of `scene` and its initial state; arguments and errors as for `run`."""
    check_choices(variant, law, layer_stiffness, stick_stiffness, tolerance)
    if local not in TREATMENTS:
        known = ", ".join(map(repr, TREATMENTS))
        raise InputError(f"the monolithic reference: local must be one of {known}, got {local!r}")
    zeta = require_number(local_damping, "the monolithic reference: local_damping", non_negative=True)
    data = describe_scene(scene)
    refuse_contacts(scene, at_nodes)
    refuse_films(scene, local, variant)
    law, layers = contact_layers(scene, at_nodes, law, layer_stiffness)
    nodal = at_nodes and needs_nodes(scene)
    systems = local_systems(scene, local, local_modes or {}, zeta)
    coordinates, surfaces = systems.coordinates, systems.surfaces
    data.notes += systems.notes
    layout = layout_of(data, systems.counts, systems.system_of)
    local_data, first = systems.data(), initial_state(scene, data, layout, len(scene.finite_sliding))
    if nodal:
        pairs: list[Any] = list(node_pairs(scene, layout, surfaces, coordinates, stick_stiffness))
        first.nodes = memory(pairs)
        return System(data, layout, local_data, pairs, surfaces, variant, True, tolerance, nodal=True), first
    pairs = []
    for contact, (i, j), layer in zip(scene.finite_sliding, surfaces, layers, strict=True):
        if j is not None:  # rigid partners have been refused, or have the law at nodes
            pairs.append(pair_data(contact, layout, (i, j), (coordinates[i], coordinates[j]), law, layer))
    films: list[FilmData] = []
    for film, i in zip(scene.films, systems.films, strict=True):
        data.notes += [] if at_nodes else film.notes
        basis = node_basis(film) if at_nodes else bilinear_basis(film)
        films.append(FilmData(film, basis, layout, i, coordinates[i], films[-1] if films else None))
    begin_films(films, first)
    stretch = max([1.0, *(TURNS * film.slowness() / REST_LAST for film in films)])
    assembled = law == "nodes" and variant != "low_rank"
    system = System(
        data, layout, local_data, pairs, surfaces, variant, assembled, tolerance, films=films, film_stretch=stretch
    )
    return system, first


def run(
    scene: Any,
    duration: float,
    *,
    step: float,
    start: Any = "initial",
    integrator: Any = None,
    variant: str = "full",
    law: str = "hats",
    at_nodes: bool = False,
    local: str = "quasi_static",
    local_modes: dict[tuple[str, str], Any] | None = None,
    local_damping: float = 0.0,
    layer_stiffness: float | None = None,
    stick_stiffness: float | None = None,
    save_every: int = 1,
    tolerance: float = TOLERANCE,
    progress: bool = True,
) -> MonolithicHistory:
    """Simulate `scene` for `duration` [s] in fixed steps of `step` [s], all coordinates in one Newton system.

    start: "initial", "equilibrium", or the history of an earlier run. integrator: see `coefficients_of`; None is HHT
    with alpha = -0.3. variant of the linear systems: "full", dense LU in each iteration, "modified", LU kept over
    iterations, or "low_rank", local coordinates condensed (`core.linear`). law of contacts without a layer: "hats", the
    weak unilateral law of the separated solver, or "nodes", a layer of `layer_stiffness` [Pa/m] at every node of the
    first surface (`line_of_centres`), None for 300 times the stiffness of the surface under it. at_nodes: contacts
    use their own law, which must be a layer, at every node of the first surface, with friction, where
    `stick_stiffness` [Pa/m] is that of sticking nodes, None for that of the layer (`nodal.friction`); films have
    pressures at the nodes.
    local: "quasi_static" or "hht", with the modes `local_modes` by (body, surface) and their damping ratio
    `local_damping`. tolerance: of the residuals, as fractions. Inertia "auto" of a body means all available terms.

    A step that fails ends the run with its reason in `status`; previous results are kept, also on Ctrl-C. Raises
    `InputError` for wrong input.
    """
    steps, uneven = step_count(duration, step)
    save_every = require_count(save_every, "simulate: save_every", 1, most=MOST_COUNTED)
    coefficients = coefficients_of(integrator)
    entered = clock.perf_counter()
    system, state = build(
        scene, variant=variant, law=law, at_nodes=at_nodes, local=local, local_modes=local_modes,
        local_damping=local_damping, layer_stiffness=layer_stiffness, stick_stiffness=stick_stiffness,
        tolerance=tolerance,
    )  # fmt: skip
    built = clock.perf_counter()
    records = Records(system)
    status, message = _begin(system, state, start, records)
    if status == "completed":
        system.counters.seconds.clear()
        status, message = _loop(system, state, Formula(coefficients, step), steps, save_every, records, progress)
    history = records.history(scene, status, message, state)
    spent = system.counters
    history.counters = {
        "steps": spent.steps,
        "mean_iterations": spent.iterations / max(spent.steps, 1),
        "factorisations": spent.factorisations,
        "unknowns": system.layout.size,
        "local_coordinates": system.layout.local,
        "build_seconds": built - entered,
        "loop_seconds": spent.seconds.pop("loop", 0.0),
        **{f"{part}_seconds": value for part, value in spent.seconds.items()},
    }
    resting = friction_notes(scene, "the equilibrium that the run starts from") if start == "equilibrium" else []
    history.notes = [*system.data.notes, *uneven, *resting]
    return history


def _begin(system: System, state: State, start: Any, records: Records) -> tuple[str, str]:
    """Bring `state` to the start of the run, and save it."""
    if isinstance(start, MonolithicHistory):
        final = start.final
        if final is None or any(len(getattr(final, x)) != len(getattr(state, x)) for x in SIZED):
            raise InputError("simulate: start is the history of another scene, or of other local coordinates")
        _assign(state, final)
        return "completed", ""
    if start not in ("initial", "equilibrium"):
        raise InputError(f"simulate: start must be 'initial', 'equilibrium' or a history, got {start!r}")
    if start == "equilibrium":
        given = state.copy()
        failure = _settle(system, state)
        if failure:
            return failure, "equilibrium: " + MESSAGES.get(failure, "the bodies do not come to rest")
        for name in ("v", "w"):
            getattr(state, name)[:] = getattr(given, name)
    solution = begin(system, state)
    if solution.failure or solution.evaluation is None:
        return solution.failure, "start: " + MESSAGES[solution.failure]
    _keep_rest(system, state, solution)
    _keep_films(system, state, solution, Formula(BEGIN, START_STEP))
    _still(system, state)
    if system.nodal:
        state.nodes = standing(system, state)
    records.save(state, solution, 0.0)
    return "completed", ""


def _still(system: System, state: State) -> None:
    """Quasi-static coordinates have no rates of their own: they follow the pressures."""
    at = system.layout.modes + np.flatnonzero(system.local.mass == 0.0)
    state.qd[at] = state.qdd[at] = state.q_alg[at] = 0.0


def _settle(system: System, state: State) -> str:
    """Proximal steps of growing size until the motion stops; the reason of a failure, or ''. With films a step that
    fails is repeated with a shorter one, and cavity volumes must be stationary too."""
    state.rest()
    tau = REST_FIRST
    for _ in range(REST_STEPS):
        formula = Formula(REST, tau)
        solution = solve_step(system, state, formula, state.time)
        if solution.failure or solution.evaluation is None:
            if not system.films or solution.failure != "not_converged" or tau <= REST_SHORTEST:
                return solution.failure
            tau *= REST_SHRINK
            continue
        _keep_place(state, solution.evaluation)
        _keep_rest(system, state, solution)
        voids = state.film_nodes[:, 1].copy()
        _keep_films(system, state, solution, formula)
        gone = np.abs(state.film_nodes[:, 1] - voids)
        steady = all(gone[film.in_nodes].max() <= VOIDS_STAY * film.thickness for film in system.films)
        moved = float(np.linalg.norm(solution.increment.dx, axis=1).max())
        if tau >= REST_LAST and moved <= REST_TOLERANCE and steady:
            return ""
        tau = min(tau * REST_GROWTH, REST_LAST)
    return "no_equilibrium"


def _loop(
    system: System, state: State, formula: Formula, steps: int, save_every: int, records: Records, progress: bool
) -> tuple[str, str]:
    step, begin, locked = formula.h, state.time, False
    bar = Progress("monolithic", steps, enabled=progress)
    entered = clock.perf_counter()
    try:
        for n in range(1, steps + 1):
            end = begin + n * step
            tensions = tensions_of(system.data, state, formula, end)
            locks = bool(np.any(tensions.holds & (state.locked[:, 0] == 0.0)))
            now = _forgetful(state, step) if locks or locked else formula
            solution = solve_step(system, state, now, end)
            system.counters.iterations += solution.iterations
            system.counters.factorisations += solution.factorisations
            if solution.failure or solution.evaluation is None:
                return solution.failure, f"at {end:g} s: " + MESSAGES[solution.failure]
            _accept(system, state, now, solution)
            locked = locks
            system.counters.steps += 1
            if n % save_every == 0 or n == steps:
                records.save(state, solution, step)
            bar.update(n)
    except KeyboardInterrupt:
        return "interrupted", "interrupted by the user; results up to there are kept"
    finally:
        system.counters.seconds["loop"] = clock.perf_counter() - entered
        bar.close()
    return "completed", ""


def _forgetful(state: State, step: float) -> Formula:
    """The formula of a step without memory of accelerations, which are removed from `state`."""
    for name in ("v_alg", "w_alg", "q_alg"):
        setattr(state, name, np.zeros_like(getattr(state, name)))
    return Formula(FORGET, step)


def _accept(system: System, state: State, formula: Formula, solution: Solution) -> None:
    """Accept a step; if a pair has opened or closed, algorithmic accelerations restart from the true ones."""
    evaluation, x = solution.evaluation, solution.increment
    if evaluation is None:
        return
    trial = evaluation.trial
    event = any(bool(old) != bool(np.any(new > 0.0)) for old, new in zip(
        state.active, evaluation.pressures, strict=True
    ))  # fmt: skip
    v_alg = formula.algorithmic(x.dx, state.v, state.v_alg)
    w_alg = formula.algorithmic(x.psi, state.w, state.w_alg)
    q_alg = formula.algorithmic(x.dq, state.qd, state.q_alg)
    if event:
        v_alg, w_alg, q_alg = trial.v_rate.copy(), trial.w_rate.copy(), trial.qdd.copy()
    _keep_place(state, evaluation)
    state.v, state.w, state.qd = trial.v, trial.w, trial.qd
    state.v_rate, state.w_rate, state.qdd = trial.v_rate, trial.w_rate, trial.qdd
    state.v_alg, state.w_alg, state.q_alg = v_alg, w_alg, q_alg
    _still(system, state)
    _keep_rest(system, state, solution)
    if event:
        state.lag = state.lag[[1, 1]]
    _keep_films(system, state, solution, formula)
    state.time = trial.time


def _keep_films(system: System, state: State, solution: Solution, formula: Formula) -> None:
    """Memory of films: after the tiny step of a start pressures alone, after static steps no rates."""
    if solution.evaluation is None:
        return
    state.film_nodes, state.film_points = state.film_nodes.copy(), state.film_points.copy()
    state.film_step = state.film_step.copy()
    for film in solution.evaluation.films:
        before = Memory.of(film.data, state)
        if formula.coefficients is BEGIN:
            kept = film.begun(before)
        else:
            kept = film.remembered(before, 0.0 if formula.coefficients is REST else formula.h)
        kept.keep(film.data, state)


def _keep_place(state: State, evaluation: Evaluation) -> None:
    trial = evaluation.trial
    state.r, state.p, state.q = trial.r, trial.p, trial.q


def _keep_rest(system: System, state: State, solution: Solution) -> None:
    evaluation = solution.evaluation
    if evaluation is None:
        return
    state.lam = solution.increment.lam.copy()
    state.stretch, state.locked = evaluation.balance.stretch, evaluation.balance.locked
    state.pulls, state.lag = evaluation.balance.pulls, evaluation.balance.lag
    if system.nodal:
        state.nodes = state.nodes.copy()  # the evaluation still uses the previous values
        for pair in evaluation.pairs:
            state.nodes[pair.data.rows] = pair.remembered()
            state.lost += (pair.friction_lost, pair.layer_lost)
        state.active = [{int(t): float(s[t]) for t in np.flatnonzero(s > 0.0)} for s in evaluation.pressures]
        return
    state.active = [
        {int(pair.number[t]): float(s[t]) for t in np.flatnonzero(s > 0.0)}
        for pair, s in zip(evaluation.pairs, evaluation.pressures, strict=True)
    ]


def _assign(state: State, other: State) -> None:
    for name, value in vars(other.copy()).items():
        setattr(state, name, value)
