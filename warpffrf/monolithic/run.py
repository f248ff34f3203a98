"""Driving the monolithic solver: start, time loop, stop."""

from __future__ import annotations

import logging
import time as clock
from typing import Any

import numpy as np

from warpffrf.model import rotation as rot
from warpffrf.model.errors import InputError, require_count, require_number
from warpffrf.model.evaluations import all_full
from warpffrf.model.friction import friction_notes
from warpffrf.model.progress import Progress
from warpffrf.model.step_count import step_count
from warpffrf.monolithic.core.description import describe_scene
from warpffrf.monolithic.core.integrator import REST, Formula, coefficients_of
from warpffrf.monolithic.core.local_coordinates import TREATMENTS
from warpffrf.monolithic.core.state import State, initial_state, layout_of
from warpffrf.monolithic.history import BodyMotion, ContactForces, MonolithicHistory
from warpffrf.monolithic.line_of_centres.pair import pair_data
from warpffrf.monolithic.line_of_centres.record import ContactRow, contact_arrays, contact_row, joined
from warpffrf.monolithic.local_systems import local_systems
from warpffrf.monolithic.newton import Evaluation, Solution, System, solve_step
from warpffrf.monolithic.nodal.build import memory, node_pairs
from warpffrf.monolithic.nodal.record import FrictionRow, friction_arrays, node_row
from warpffrf.monolithic.refusals import needs_nodes, refuse_contacts
from warpffrf.monolithic.settings import TOLERANCE, Monolithic, contact_layers
from warpffrf.monolithic.start import begin, standing

log = logging.getLogger("warpffrf")

REST_FIRST, REST_LAST, REST_GROWTH, REST_STEPS = 1e-3, 1.0, 10.0, 60  # s: proximal steps towards the static state
REST_TOLERANCE = 1e-12  # m, movement of the last of them
MESSAGES = {
    "not_converged": "the Newton iteration did not converge; reduce step",
    "cycling": "the active set of contact cycles; reduce step, or coarsen the contact grid (traction_spacing)",
    "not_finite": "a NaN or infinite number arose; look for extreme loads, masses or stiffnesses",
    "singular": "the equations are singular: redundant constraints, or a mechanism with no load path",
}


def build(
    scene: Any,
    *,
    variant: str = "full",
    law: str = "hats",
    local: str = "quasi_static",
    local_modes: dict[tuple[str, str], Any] | None = None,
    local_damping: float = 0.0,
    layer_stiffness: float | None = None,
    stick_stiffness: float | None = None,
    tolerance: float = TOLERANCE,
) -> tuple[System, State]:
    """The system of equations of `scene` and its initial state; arguments and errors as for `run`."""
    Monolithic(variant, law, layer_stiffness, tolerance, stick_stiffness)  # raises InputError
    if local not in TREATMENTS:
        known = ", ".join(map(repr, TREATMENTS))
        raise InputError(f"method 'monolithic': local must be one of {known}, got {local!r}")
    zeta = require_number(local_damping, "method 'monolithic': local_damping", non_negative=True)
    data = describe_scene(scene)
    full = all_full(scene)
    refuse_contacts(scene, full)
    law, layers = contact_layers(scene, full, law, layer_stiffness)
    nodal = full and needs_nodes(scene)
    systems = local_systems(scene, local, local_modes or {}, zeta)
    coordinates, surfaces = systems.coordinates, systems.surfaces
    data.notes += systems.notes
    layout = layout_of(data, systems.counts, systems.system_of)
    local_data, first = systems.data(), initial_state(scene, data, layout, len(scene.contacts))
    if nodal:
        pairs: list[Any] = list(node_pairs(scene, layout, surfaces, coordinates, stick_stiffness))
        first.nodes = memory(pairs)
        return System(data, layout, local_data, pairs, surfaces, variant, True, tolerance, nodal=True), first
    pairs = []
    for contact, (i, j), layer in zip(scene.contacts, surfaces, layers, strict=True):
        if j is not None:  # rigid partners have been refused, or have the law at nodes
            pairs.append(pair_data(contact, layout, (i, j), (coordinates[i], coordinates[j]), law, layer))
    assembled = law == "nodes" and variant != "low_rank"
    return System(data, layout, local_data, pairs, surfaces, variant, assembled, tolerance), first


def run(
    scene: Any,
    duration: float,
    *,
    step: float,
    start: Any = "initial",
    integrator: Any = None,
    variant: str = "full",
    law: str = "hats",
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
    with alpha = -0.3. variant: "full", "modified" or "low_rank" (`linear`). law: "hats", the weak unilateral law of the
    separated solver, or "nodes", a layer of `layer_stiffness` [Pa/m] at every node of the first surface
    (`line_of_centres`); contacts of evaluation "full" are nodes with the layer of their own law and with friction, for
    which `stick_stiffness` [Pa/m] is that of nodes that stick (`nodal.friction`).
    local: "quasi_static" or "hht", with the modes `local_modes` by (body, surface) and their damping ratio
    `local_damping`. tolerance: of the residuals, as fractions. Inertia "auto" of a body means all terms it has.

    A step that fails ends the run with its reason in `status`; what was found before is kept, also on Ctrl-C. Raises
    `InputError` for wrong input.
    """
    steps, uneven = step_count(duration, step)
    save_every = require_count(save_every, "simulate: save_every", 1)
    coefficients = coefficients_of(integrator)
    entered = clock.perf_counter()
    system, state = build(
        scene, variant=variant, law=law, local=local, local_modes=local_modes, local_damping=local_damping,
        layer_stiffness=layer_stiffness, stick_stiffness=stick_stiffness, tolerance=tolerance,
    )  # fmt: skip
    built = clock.perf_counter()
    records = _Records(scene, system)
    status, message = _begin(system, state, start, records)
    if status == "completed":
        system.counters.seconds.clear()
        status, message = _loop(system, state, coefficients, step, steps, save_every, records, progress)
    history = records.history(status, message, state)
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


def _begin(system: System, state: State, start: Any, records: _Records) -> tuple[str, str]:
    """Bring `state` to where the run starts, and save it."""
    if isinstance(start, MonolithicHistory):
        final = start.final
        if final is None or any(len(getattr(final, x)) != len(getattr(state, x)) for x in ("q", "r", "nodes")):
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
    _still(system, state)
    if system.nodal:
        state.nodes = standing(system, state)
    records.save(state, solution, 0.0)
    return "completed", ""


def _still(system: System, state: State) -> None:
    """Quasi-static coordinates have no rates: they follow the pressures."""
    at = system.layout.modes + np.flatnonzero(system.local.mass == 0.0)
    state.qd[at] = state.qdd[at] = state.q_alg[at] = 0.0


def _settle(system: System, state: State) -> str:
    """Proximal steps of growing size until nothing moves; the reason of a failure, or ''."""
    state.rest()
    tau = REST_FIRST
    for _ in range(REST_STEPS):
        solution = solve_step(system, state, Formula(REST, tau), state.time)
        if solution.failure or solution.evaluation is None:
            return solution.failure
        _keep_place(state, solution.evaluation)
        _keep_rest(system, state, solution)
        if tau >= REST_LAST and float(np.linalg.norm(solution.increment.dx, axis=1).max()) <= REST_TOLERANCE:
            return ""
        tau = min(tau * REST_GROWTH, REST_LAST)
    return "no_equilibrium"


def _loop(
    system: System, state: State, coefficients: Any, step: float, steps: int, save_every: int, records: _Records,
    progress: bool,
) -> tuple[str, str]:  # fmt: skip
    formula, first = Formula(coefficients, step), state.time
    bar = Progress("monolithic", steps, enabled=progress)
    entered = clock.perf_counter()
    try:
        for n in range(steps):
            solution = solve_step(system, state, formula, first + (n + 1) * step)
            system.counters.iterations += solution.iterations
            system.counters.factorisations += solution.factorisations
            if solution.failure or solution.evaluation is None:
                return solution.failure, f"at {first + (n + 1) * step:g} s: " + MESSAGES[solution.failure]
            _accept(system, state, formula, solution)
            system.counters.steps += 1
            if (n + 1) % save_every == 0 or n + 1 == steps:
                records.save(state, solution, step)
            bar.update(n + 1)
    except KeyboardInterrupt:
        return "interrupted", "interrupted by the user; results up to there are kept"
    finally:
        system.counters.seconds["loop"] = clock.perf_counter() - entered
        bar.close()
    return "completed", ""


def _accept(system: System, state: State, formula: Formula, solution: Solution) -> None:
    """Take a step over; where a pair has opened or closed, algorithmic accelerations restart from the true ones."""
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
    state.time = trial.time


def _keep_place(state: State, evaluation: Evaluation) -> None:
    trial = evaluation.trial
    state.r, state.p, state.q = trial.r, trial.p, trial.q


def _keep_rest(system: System, state: State, solution: Solution) -> None:
    evaluation = solution.evaluation
    if evaluation is None:
        return
    state.lam = solution.increment.lam.copy()
    state.stretch = evaluation.balance.stretch
    if system.nodal:
        state.nodes = state.nodes.copy()  # the evaluation still looks at what was before
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


class _Records:
    """Saved steps of a run being collected."""

    def __init__(self, scene: Any, system: System) -> None:
        self.scene, self.system = scene, system
        self.states: list[State] = []
        self.rows: list[tuple[float, int, int]] = []
        self.energy: list[dict[str, float]] = []
        self.reactions: list[np.ndarray] = []
        self.springs: list[np.ndarray] = []
        self.contacts: list[list[ContactRow]] = []
        self.friction: list[list[FrictionRow | None]] = []

    def save(self, state: State, solution: Solution, step: float) -> None:
        """Append the accepted state."""
        evaluation = solution.evaluation
        if evaluation is None:
            return
        self.states.append(state.copy())
        self.rows.append((step, solution.iterations, solution.factorisations))
        energy = dict(evaluation.balance.energy)
        if self.system.nodal:
            energy["contact"] += sum(pair.stored for pair in evaluation.pairs)
            energy |= {"friction": -float(state.lost[0]), "layer": float(state.lost[1])}
        self.energy.append(energy)
        self.reactions.append(-solution.increment.lam[:, None] * evaluation.balance.wrenches)
        self.springs.append(evaluation.balance.springs)
        if self.system.nodal:
            found = [node_row(pair) for pair in evaluation.pairs]
            self.contacts.append([row for row, _ in found])
            self.friction.append([rub for _, rub in found])
            return
        self.contacts.append(
            [contact_row(*found) for found in zip(evaluation.pairs, evaluation.pressures, strict=True)]
        )

    def history(self, status: str, message: str, final: State) -> MonolithicHistory:
        """All that was saved."""
        states, system = self.states, self.system

        def stack(name: str) -> np.ndarray:
            return np.array([getattr(s, name) for s in states]).reshape(len(states), *getattr(final, name).shape)

        r, p, v, v_rate, w, w_rate, q, qd, qdd = map(stack, ("r", "p", "v", "v_rate", "w", "w_rate", "q", "qd", "qdd"))
        bodies: dict[str, BodyMotion] = {}
        for b, body in enumerate(self.scene.bodies):
            A = np.array([rot.matrix(x) for x in p[:, b]]).reshape(-1, 3, 3)
            arm, omega, alpha = A @ body.center_of_mass, _apply(A, w[:, b]), _apply(A, w_rate[:, b])
            swing, at = np.cross(omega, arm), system.layout.body_modes(b)
            bodies[body.name] = BodyMotion(
                r[:, b] - arm, p[:, b], v[:, b] - swing, omega, q[:, at],
                v_rate[:, b] - np.cross(alpha, arm) - np.cross(omega, swing), alpha, qd[:, at], qdd[:, at],
            )  # fmt: skip
        rows = np.array(self.reactions).reshape(len(states), system.layout.rows, 6)
        owner = np.array([c.joint for c in system.data.constraints])
        reactions = {}
        for joint in self.scene.joints:
            total = rows[:, owner == str(joint.name)].sum(axis=1) if len(owner) else np.zeros((len(states), 6))
            reactions[str(joint.name)] = (total[:, :3], total[:, 3:])
        contacts = {}
        for n, data in enumerate(system.pairs):
            sides = (data.a, data.b)
            grounds = [side.body < 0 for side in sides]
            owners = tuple(
                self.scene.ground if ground else self.scene.bodies[side.body]
                for side, ground in zip(sides, grounds, strict=True)
            )
            A = tuple(
                np.tile(np.eye(3), (len(states), 1, 1)) if ground
                else np.array([rot.matrix(x) for x in p[:, side.body]]).reshape(-1, 3, 3)
                for side, ground in zip(sides, grounds, strict=True)
            )  # fmt: skip
            found = contact_arrays([x[n] for x in self.contacts], owners, A, [side.grid for side in sides])
            local = [np.zeros((len(states), 0)) if s is None else q[:, s] for s in system.local_slices(n)]
            rub = None
            if system.nodal and data.rough:
                rub = friction_arrays([x[n] for x in self.friction], joined, data.a.grid.rows)
            contacts[data.name] = ContactForces(
                **found, friction=rub, active=np.array([len(s.active[n]) for s in states], dtype=int),
                pressures=[s.active[n] for s in states], local=(local[0], local[1]),
            )  # fmt: skip
        numbers = np.array(self.rows).reshape(-1, 3)
        springs = np.array(self.springs).reshape(len(states), len(final.stretch), 7)
        lines = ("kinetic", "strain", "contact", "potential", *(("friction", "layer") if system.nodal else ()))
        return MonolithicHistory(
            self.scene, np.array([s.time for s in states]), numbers[:, 0], bodies, reactions, contacts,
            {line: np.array([e[line] for e in self.energy]) for line in lines},
            numbers[:, 1].astype(int), numbers[:, 2].astype(int), status, message, final=final.copy(),
            spring_rows=springs, dropped=system.data.dropped,
        )  # fmt: skip


def _apply(A: np.ndarray, x: np.ndarray) -> np.ndarray:
    """A_t x_t of (T, 3, 3) and (T, 3)."""
    return np.einsum("tij,tj->ti", A, x)
