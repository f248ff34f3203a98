"""Run control: start, replay of the graph in chunks with progress, stop, and assembly of the History."""

from __future__ import annotations

import logging
import time
from typing import Any

import numpy as np

from warpffrf.model.bearings.bearing import refuse_unguided_thrust, without_cage
from warpffrf.model.checks.contacts import excessive_wedge, find_wedge, out_of_reach, refuse_overlap
from warpffrf.model.checks.redundancy import refuse_positions, refuse_singular_mass, refuse_velocities
from warpffrf.model.checks.scene import connecting, loose_preloads, refuse_short_signals
from warpffrf.model.errors import MOST_COUNTED, InputError, require_count, require_number
from warpffrf.model.films.film import refuse_touching
from warpffrf.model.forces import Pretension
from warpffrf.model.friction import RUBBED_REST, friction_notes, rolling_notes
from warpffrf.model.integrators import (
    CHECK_INTEGRATORS,
    EnergyMomentum,
    GeneralizedAlpha,
    Integrator,
    RungeKutta4,
    roots_at_infinity,
)
from warpffrf.model.joints import Drive
from warpffrf.model.lumped_contact import refuse_lumped_overlap
from warpffrf.model.messages.checkpoints import Keeper, Plan, Unfinished
from warpffrf.model.messages.progress import Progress, deferred_interrupts
from warpffrf.model.messages.status import Status
from warpffrf.model.placement.gap import facing_gap
from warpffrf.model.scene import Scene
from warpffrf.model.small_sliding.sliding import refuse_pushed_apart
from warpffrf.model.step_count import step_count
from warpffrf.online.checkpoint import is_dynamic, is_loaded, off_end_of, restore, time_of, turned_of
from warpffrf.online.diagnosis.cell_check import cell_check_notes, check_cells
from warpffrf.online.diagnosis.contact_notes import contact_notes, energy_notes, overlap_notes, sampling_notes
from warpffrf.online.diagnosis.energy_watch import EnergyWatch, round_off_energy
from warpffrf.online.diagnosis.failure_report import failure_owner
from warpffrf.online.diagnosis.film_grid import film_grid_errors, film_grid_notes
from warpffrf.online.diagnosis.film_notes import (
    FilmWatch,
    alternation_notes,
    check_films,
    film_check_notes,
    film_notes,
    squeezed_out,
)
from warpffrf.online.diagnosis.inertia_indicator import (
    deflection_lines,
    deflections,
    indicator_lines,
    term_sizes,
    unheld_lines,
)
from warpffrf.online.diagnosis.motion_notes import fall_notes, hidden_inertia, is_static, load_notes, steep_notes
from warpffrf.online.diagnosis.no_equilibrium import NEARER, NO_LOAD_PATH, STATIC_CURE, not_found
from warpffrf.online.diagnosis.patch_off_end import EndWatch, OffEnd
from warpffrf.online.engine import Engine, EngineOf
from warpffrf.online.free_flight.check_run import run_check
from warpffrf.online.history.history import History
from warpffrf.online.history.record import history_from_rows
from warpffrf.online.local_modes import LocalModes, as_local_modes
from warpffrf.online.periodic_checkpoint import Keeping, go_on
from warpffrf.online.samples import Samples
from warpffrf.online.settings import Settings
from warpffrf.online.start.consistent import RUB_IN, start_consistently, start_from_loads
from warpffrf.online.start.motions import slide_time
from warpffrf.online.start.static_equilibrium import settle
from warpffrf.online.start.static_friction import refuse_without_rest, rub_to_rest
from warpffrf.online.warp_lock import WARP_LOCK
from warpffrf.online.warp_start import untested_warp_note
from warpffrf_kernels.core import control as k
from warpffrf_kernels.core.model import LINE_OF_CENTRES

log = logging.getLogger("warpffrf")

START_REST = "the equilibrium that the run starts from"
MOST_UNDAMPED = 0.95  # spectral radius at infinity up to which an alternation of reactions grows less than tenfold
OTHER_LEVELS = "a body has more inertia terms from here on than in the run that this one continues"
VELOCITY_JUMP = 1e-6  # of the largest velocity: rounding of a signal's coefficients
COARSEN = "coarsen the contact grid, ContactGrid(spacing=)"
UPHILL = "every step from here increases the energy; begin from another pose, or with a smaller load"
UNSOLVED = int(
    k.NOT_CONVERGED | k.CAPACITY | k.CYCLING | k.TRACTIONS | k.STENCIL
)  # failure bits of deeply wedged contact
RUNS_AWAY = int(
    k.NOT_CONVERGED | k.SINGULAR | k.NOT_FINITE | k.ENERGY | k.NOT_AT_REST | k.UNDERFLOW
)  # failure bits of an unconstrained body
MESSAGES = {
    k.NOT_CONVERGED: (Status.NOT_CONVERGED, "the Newton iteration did not converge; reduce step"),
    k.CYCLING: (Status.CYCLING, "the active set of contact cycles; reduce step, or {coarsen}"),
    k.TRACTIONS: (
        Status.CYCLING,
        "stick and slip of the cells of a contact do not settle, neither by Newton's method with its guard nor by the "
        "interior-point method; reduce step, or {coarsen}",
    ),
    k.CAPACITY: (Status.CAPACITY, "window overflow, raise capacity of the contact to >= {capacity}"),
    k.ROOM: (
        Status.MEMORY,
        "the memory does not suffice for {capacity} active nodes or cells; {coarsen}, "
        "give the contacts a capacity, or run fewer worlds",
    ),
    k.NOT_FINITE: (
        Status.NOT_FINITE,
        "a NaN or infinite number occurred; check for extreme loads, masses or stiffnesses",
    ),
    k.SINGULAR: (
        Status.SINGULAR,
        "the joint equations are singular: redundant constraints, or a mechanism with no load path",
    ),
    k.INDEFINITE: (Status.INDEFINITE, "the contact compliance is not positive definite; {coarsen}"),
    k.STENCIL: (
        Status.STENCIL,
        "a node of the first contact surface overlaps more of the second grid than its stencil allows (the bodies are "
        "rotated or tilted too far for the window); lower the capacity of the contact, or swap its surfaces",
    ),
    k.PASSED: (
        Status.PASSED,
        "a patch with friction advances by more than its own length in a step, so that none of its material was in it "
        "before; reduce step, to a tenth of that length over the rolling speed",
    ),
    k.LEAPT: (
        Status.LEAPT,
        "two surfaces change sides in a step without contact, so that they may pass through each other; reduce step",
    ),
    k.TOO_HOT: (Status.TOO_HOT, "an oil film runs away"),
    k.GAIN: (Status.ENERGY, "energy was created; reduce step"),
    k.NOT_AT_REST: (Status.NO_EQUILIBRIUM, "the bodies do not come to rest"),
    k.ENERGY: (Status.ENERGY, "the energy ledger does not close at an impact; reduce step"),
    k.STEP_ERROR: (
        Status.STEP_ERROR,
        "the local error of a step exceeds step_error; reduce step, or increase step_error",
    ),
}


@WARP_LOCK
def run(
    scene: Scene,
    duration: float,
    *,
    step: float,
    start: str | History | Unfinished = "initial",
    integrator: Integrator | RungeKutta4 | EnergyMomentum | None = None,
    local_modes: str | LocalModes = "quasi_static",
    step_error: float | None = None,
    save_every: int = 1,
    device: str | None = None,
    progress: bool = True,
    settings: Settings | None = None,
    project_start: bool = False,
    keeper: Keeper | None = None,
    engine_of: EngineOf = Engine,
) -> History:
    """Simulate `scene` for `duration` [s] in steps of `step` [s]; a solver failure is reported in `History.status`.

    start: "initial", "equilibrium", or the History of an earlier run of the same scene, or of its equilibrium, which
    is continued bit for bit, or of a static run, which starts from rest (`start_from_loads`), or an Unfinished run,
    which is continued to its end: the History covers the whole run, whose `duration` is used. keeper: receives the
    saved rows during the run. step_error: steps whose local error exceeds it are halved, see
    `warpffrf_kernels.step.local_error`. project_start: initial velocities that violate the joints are changed as little
    as possible (in the kinetic energy of the change) instead of refused. engine_of: creates the engine, alone or as one
    world of several (`warpffrf.online.worlds`). The run restarts if a body with inertia "auto" rotates faster than its
    level is valid for (`online.compile.inertia_plan`), or if a contact patch of a crowned surface runs off an end
    (`online.diagnosis.patch_off_end`). Raises InputError for wrong input.
    """
    options = {
        "step": step, "integrator": integrator, "local_modes": local_modes, "step_error": step_error,
        "save_every": save_every, "device": device, "progress": progress, "settings": settings,
        "project_start": project_start, "keeper": keeper, "engine_of": engine_of,
    }  # fmt: skip
    turned: np.ndarray = np.zeros(0)
    off_end = False
    while True:
        try:
            return _run(scene, duration, start=start, turned=turned, off_end=off_end, **options)
        except OffEnd:
            off_end = True
            start = start.start if isinstance(start, Unfinished) else start
        except _Outrun as faster:
            turned = faster.turned
            start = start.start if isinstance(start, Unfinished) else start
            log.info(
                "a body rotates faster than its inertia level is valid for: the run is restarted with all inertia terms"
            )


class _Outrun(Exception):
    """Bodies rotate at `turned` (bodies,) [rad/s], faster than their inertia levels are valid for."""

    def __init__(self, turned: np.ndarray) -> None:
        super().__init__()
        self.turned = turned


def _run(
    scene: Scene,
    duration: float,
    *,
    step: float,
    start: str | History | Unfinished,
    integrator: Integrator | RungeKutta4 | EnergyMomentum | None,
    local_modes: str | LocalModes,
    step_error: float | None,
    save_every: int,
    device: str | None,
    progress: bool,
    settings: Settings | None,
    project_start: bool,
    keeper: Keeper | None,
    engine_of: EngineOf,
    turned: np.ndarray,
    off_end: bool,
) -> History:
    """`run`, with inertia levels for the angular speeds `turned` [rad/s] of the bodies, and cells for crowns that run
    `off_end`; raises `_Outrun` if a body rotates faster than its level is valid for, and `OffEnd`."""
    if isinstance(integrator, CHECK_INTEGRATORS):
        if step_error is not None or as_local_modes(local_modes).treatment != "quasi_static":
            raise InputError(
                f"simulate: {type(integrator).__name__} uses a constant step; remove step_error and local_modes"
            )
        return run_check(
            scene, duration, step=step, integrator=integrator, save_every=save_every, progress=progress, start=start,
            keeper=keeper,
        )  # fmt: skip
    if step_error is not None:
        step_error = require_number(step_error, "simulate: step_error", positive=True)
    steps, uneven = step_count(duration, step)
    refuse_singular_mass(scene)
    continued = isinstance(start, History | Unfinished)
    if not isinstance(start, Unfinished):
        began = time_of(start.checkpoint) if isinstance(start, History) else 0.0
        for drive in scene.drives:
            _check_velocity(drive, began, began + steps * step)
        refuse_short_signals(scene, began, began + steps * step)
    save_every = require_count(save_every, "simulate: save_every", 1, most=MOST_COUNTED)
    loaded = isinstance(start, History) and is_loaded(start.checkpoint)  # result of `run_static`
    # result of `find_equilibrium`
    at_rest = isinstance(start, History) and not loaded and not is_dynamic(start.checkpoint)
    if not continued or at_rest:
        if start == "initial":
            refuse_positions(scene)
            refuse_overlap(scene)
            refuse_lumped_overlap(scene.lumped_contacts)
        if not at_rest:
            refuse_touching(scene.films)
        if not project_start:
            refuse_velocities(scene)
    begin = time.perf_counter()
    integrator = integrator or GeneralizedAlpha()
    made_with = {
        "device": device, "settings": (settings or Settings()).for_rows(steps // save_every), "integrator": integrator,
        "step_error": step_error, "local_modes": as_local_modes(local_modes), "progress": progress,
    }  # fmt: skip
    before = turned_of(start.checkpoint, scene) if isinstance(start, History | Unfinished) else turned[:0]
    anew = len(turned) > 0
    if len(before):
        turned = np.maximum(before, turned if anew else 0.0)
    made_with["turned"] = turned
    made_with["off_end"] = off_end or isinstance(start, History | Unfinished) and off_end_of(start.checkpoint)
    engine = engine_of(scene, **made_with)
    built = time.perf_counter()
    first_step, rejected = 0, 0
    notes = [*engine.compiled.notes, *_reaction_notes(integrator, engine), *uneven, *untested_warp_note()]
    if isinstance(start, History) and at_rest and start.status != Status.COMPLETED:
        raise InputError(
            f"simulate: start ended before its first step ({start.status}: {start.message}); repair that first"
        )
    if isinstance(start, History):
        first_step = restore(engine, start.checkpoint, step)
        rejected = int(engine.word("rejected")[0])
        if loaded:
            start_from_loads(engine, step)
            first_step = 0
        if not at_rest:
            notes.extend(engine.start_notes)
            notes.extend([OTHER_LEVELS] if anew and not loaded else [])
        if np.any(engine.word("status")):
            return finish(engine, begin, built, notes, "start: ")
    elif isinstance(start, Unfinished):
        first_step = go_on(engine, start, step)
    if at_rest:
        rejected = 0
        engine.control(saved=0)
        engine.drained[:] = 0
    if not continued or at_rest:
        if start == "equilibrium":
            notes.extend(check_load_paths(scene))
        if start == "initial":
            notes.extend(overlap_notes(scene))
        if start == "equilibrium" or at_rest:
            notes.extend(friction_notes(scene, START_REST, RUBBED_REST) + rolling_notes(scene, START_REST))
        if start == "equilibrium" and not settle(engine):
            return finish(engine, begin, built, notes, "equilibrium: ")
        engine.initial_rates()
        start_consistently(engine, step)
        notes.extend(engine.start_notes)
        if np.any(engine.word("status")):
            return finish(engine, begin, built, notes, "start: ")
        engine.control(
            rejected=0,
            repeated=0,
            impulses=0,
            restarted_steps=0,
            steps=0,
            iterations=0,
            worst=0,
            pending=0,
            pending_solves=0,
        )
        engine.enter(k.DYNAMIC, step, target=0)
        if engine.compiled.model.capacity.cells or any(c.friction.acts for c in scene.lumped_contacts):
            engine.control(level=min(RUB_IN, engine.settings.max_level))
        engine.save_now()
        first_step = 0
    engine.has_turned(turned)
    engine.control(every=save_every)
    engine.seconds_in_graph = 0.0
    loop = time.perf_counter()
    interrupted = False
    plan = Plan(first_step + steps, rejected, tuple(notes))
    if isinstance(start, Unfinished):
        plan = start.plan
    last_step, notes = plan.last_step, list(plan.notes)
    keeping = Keeping(engine, keeper, plan)
    samples = Samples(engine, made_with, step, first_step, last_step)
    samples.look(engine, first_step)
    films = FilmWatch(engine, first_step, last_step)
    ends = EndWatch(engine, keeps=isinstance(start.start if isinstance(start, Unfinished) else start, History))
    watch = EnergyWatch(engine, step, set_down=isinstance(start, str) and start == "initial")
    gain = ""
    bar = Progress("simulate", last_step - first_step, enabled=progress)
    try:
        chunk = 4
        done = first_step
        while done < last_step and not np.any(engine.word("status")):
            target = films.until(samples.until(min(done + chunk, last_step), done), done)
            engine.control(target=target)
            seconds = engine.replay(4 * chunk)
            now = int(engine.word("step").min())
            rate = max(now - done, 1) / max(seconds, 1e-9)
            chunk = int(np.clip(rate * engine.settings.chunk_seconds, 1, engine.settings.ring_rows * save_every - 1))
            done = now
            bar.update(done - first_step)
            samples.look(engine, done)
            films.look(engine, done)
            if watch.look():
                gain = watch.end()
            ends.look()
            if (faster := engine.outrun()) is not None:
                raise _Outrun(faster)
            keeping.look()
        if not np.any(engine.word("status")) and watch.gained_at_end():
            gain = watch.end()
    except KeyboardInterrupt:
        interrupted = True
    except (_Outrun, OffEnd):
        bar.close()
        if keeper is not None:
            keeper.clear()
        raise
    bar.close()
    with deferred_interrupts() as asked:
        if interrupted:
            engine.drain()
            keeping.end()
        elif not np.any(engine.word("status")) and last_step % save_every:
            engine.save_now()
        ended = time.perf_counter()
        history = finish(engine, begin, built, notes, "", plan.rejected, films)
    history.stopping = bool(asked)
    history.samples = samples
    history.message = gain or history.message
    history.counters["loop_seconds"] = ended - loop
    history.counters["finish_seconds"] = time.perf_counter() - ended  # notes and checks of the cells
    if interrupted and history.status == Status.COMPLETED:
        history.status, history.message = Status.INTERRUPTED, "interrupted by the user; results up to there are kept"
    return history


@WARP_LOCK
def find_equilibrium(
    scene: Scene, *, friction: bool = False, device: str | None = None, settings: Settings | None = None,
    progress: bool = False, engine_of: EngineOf = Engine,
) -> History:  # fmt: skip
    """Static state of `scene` under its loads and prescribed motions at time 0, as a History of one row.

    friction: joint and contact friction acts on the slip from the initial state (`start.rub_to_rest`); friction of
    small-sliding contacts always does. engine_of: as of `run`. Raises InputError for wrong input.
    """
    refuse_singular_mass(scene)
    if friction:
        refuse_without_rest(scene)
    refuse_touching(scene.films)
    made_with = {"device": device, "settings": (settings or Settings()).for_rows(1), "progress": progress}
    try:
        return _find_equilibrium(scene, friction, made_with, engine_of)
    except OffEnd:
        return _find_equilibrium(scene, friction, made_with | {"off_end": True}, engine_of)


def _find_equilibrium(scene: Scene, friction: bool, made_with: dict[str, Any], engine_of: EngineOf) -> History:
    """`find_equilibrium`, with an engine `made_with` these options; raises `OffEnd`."""
    begin = time.perf_counter()
    engine = engine_of(scene, **made_with)
    built = time.perf_counter()
    apart = check_load_paths(scene)
    if not friction:
        apart += friction_notes(scene, "the equilibrium", RUBBED_REST) + rolling_notes(scene, "the equilibrium")
    films, ends = FilmWatch(engine, 0, 0), EndWatch(engine)
    if rub_to_rest(engine) if friction else settle(engine):
        films.keep(engine)
        engine.save_now()
        ends.look()
    notes = [*engine.compiled.notes, *apart, *engine.start_notes]
    history = finish(engine, begin, built, notes, "equilibrium: ", films=films)
    history.samples = Samples(engine, made_with, 0.0, 0, 0, static=True)
    return history


def finish(
    engine: Engine, begin: float, built: float, notes: list[str], prefix: str, rejected_before: int = 0,
    films: FilmWatch | None = None,
) -> History:  # fmt: skip
    """The History of the saved rows; `rejected_before`: attempts rejected by the earlier run that is continued;
    `films`: intermediate states of the oil films."""
    left = engine.checkpoint()  # before the evaluations for the notes
    bits = int(engine.word("status")[0])
    wanted = engine.no_room.get(0)
    if wanted is None:
        bits &= ~int(k.ROOM)  # remains set when the user interrupts
    status, message = describe(bits, wanted or int(engine.word("spare")[0]), coarser(engine))
    at_rest = prefix.startswith("equilibrium")
    if at_rest and bits:
        uphill = bits & int(k.ENERGY) and not bits & int(k.CAPACITY)  # too small a window also causes it
        message = UPHILL if uphill else message.replace("; reduce step", NEARER if engine.unconverged else STATIC_CURE)
    hidden = hidden_inertia(engine) if bits & int(k.SINGULAR) else ""
    owner = failure_owner(engine, bits) if bits and not hidden else ""
    message = hidden or (f"{message} ({owner})" if owner else message)
    if (at_rest or bits & UNSOLVED) and bits and (wedge := find_wedge(engine.scene)) is not None:
        said = message.split("; ")[0] if prefix else message
        message = str(wedge) if wedge.all_round else f"{said}; {wedge}"
    nowhere = at_rest and not bits and not engine.chunks[0]
    still = [film for film in engine.scene.films if at_rest and slide_time(film) is None]
    if (bits or nowhere) and (squeezed := squeezed_out(engine, still)):
        status, message = (Status.NO_EQUILIBRIUM, squeezed) if at_rest else (status, f"{message}; {squeezed}")
    elif at_rest and engine.not_at_rest and not bits & ~RUNS_AWAY:
        status, message = (
            Status.NO_EQUILIBRIUM,
            f"{engine.not_at_rest}: {without_cage(engine.scene.bearings) or NO_LOAD_PATH}",
        )
    elif nowhere:
        status, message = not_found(engine)
    history = history_from_rows(engine.compiled, engine.saved())
    history.status, history.message = status, (prefix + message if message else "")
    steps = int(engine.word("steps")[0])
    history.counters = {
        "steps": steps,
        "rejected_steps": int(engine.word("rejected")[0]),
        "max_iterations": int(engine.word("worst")[0]),
        "mean_iterations": float(engine.word("iterations")[0]) / max(steps, 1),
        "build_seconds": built - begin,
        "seconds_in_graph": engine.seconds_in_graph,
        "coarse_steps": int(engine.word("coarse")[0]),
        "repeated_steps": int(engine.word("repeated")[0]),
        "impulsive_steps": int(engine.word("impulses")[0]),
        "idle_steps": int(engine.word("idle_steps")[0]),
        "retained_columns": engine.compiled.model.retained.count + engine.compiled.model.modes.count,
    }
    if engine.compiled.slips.laws or engine.compiled.tensions.laws:
        history.counters["restarted_steps"] = int(engine.word("restarted_steps")[0])
    if engine.graph.pattern is not None:
        factors = engine.scratch.fallback, engine.scratch.cell_fallback  # of pressures and tractions
        history.counters["dense_fallbacks"] = sum(int(factor.numpy()[0, 1]) for factor in factors)
    if engine.word("edge")[0]:
        arcs = [c.name for c in engine.scene.finite_sliding if not c.a.surface.grid.periodic]
        notes.append(
            f"a contact patch reached the end of a contact surface that covers an arc only ({', '.join(arcs)}): the "
            "pressure is cut there: where the body goes on, give it a larger contact surface; where it ends too, the "
            "pressure at its edge is as sharp as the grid"
        )
    notes.extend(steep_notes(engine.scene, engine.scratch.steep.numpy()[0]))
    notes.extend(film_notes(engine.scene, history))
    if history.status == Status.COMPLETED and engine.worlds == 1:
        history.film_grids = film_grid_errors(engine)
        notes.extend(film_grid_notes(engine, history.film_grids))
    if films is not None:
        history.film_checks = check_films(engine, films)
        notes.extend(film_check_notes(engine, history.film_checks))
    halved = int(engine.word("rejected")[0]) - rejected_before
    if halved and not at_rest:
        reasons = [text for bit, (text, _) in MESSAGES.items() if int(engine.word("reason")[0]) & int(bit)]
        notes.append(f"{halved} steps were halved ({', '.join(reasons)})")
        notes.extend(alternation_notes(engine.scene, engine.integrator))
    repeated = int(engine.word("repeated")[0])
    if repeated and engine.compiled.model.modes.dynamic_count:
        notes.append(
            f"{repeated} steps were repeated with a contact force without history: impacts on local modes with "
            "inertia, in which the faces lose their own kinetic energy"
        )
    levels = {
        body.name: plan.level for body, plan in zip(engine.scene.bodies, engine.compiled.inertia.bodies, strict=True)
    }
    stiffened = {body.name for body in engine.scene.bodies if body.stiffening}
    inertia = indicator_lines(term_sizes(engine.scene, history.bodies, levels), levels, stiffened)
    inertia += unheld_lines(engine.scene, history.bodies)
    inertia += deflection_lines(engine.scene, deflections(engine.scene, history.bodies), at_rest=at_rest)
    falls = [] if at_rest or is_static(engine) else fall_notes(engine.scene, history)
    families = engine.compiled.model.pairs.family.numpy()
    on_axes = [c.name for c, f in zip(engine.scene.finite_sliding, families, strict=False) if f == LINE_OF_CENTRES]
    contact = [*contact_notes(engine.scene, history, on_axes), *sampling_notes(engine.scene, history)]
    history.cell_checks = check_cells(engine, history)
    contact += cell_check_notes(engine, history.cell_checks)
    contact = [note for note in contact if note not in notes]
    if is_static(engine):
        energy = load_notes(engine, history.energy)
    else:
        energy = energy_notes(history.energy, round_off_energy(engine))
    history.notes = [*notes, *falls, *inertia, *contact, *energy, *history.notes]
    history.checkpoint = left
    return history


def _reaction_notes(integrator: Integrator, engine: Engine) -> list[str]:
    """A note if the integrator hardly damps joint reactions that alternate from step to step.

    With position-level constraints (index 3) the multipliers obey a recursion with the double root
    -rho_inf (Cardona and Geradin 1989): a disturbance grows like n rho^n, 1/(e (1 - rho)) times at most, and at rho 1
    without bound, until large rotations make the whole iteration diverge.
    """
    rho = float(np.abs(roots_at_infinity(integrator.coefficients)).max())
    if rho <= MOST_UNDAMPED or not any(engine.compiled.joints.rows.values()):
        return []
    return [
        f"{type(integrator).__name__} has the root {rho:g} at infinity and hardly damps alternating joint "
        "reactions from step to step, which may grow until steps fail; with joints choose rho_inf 0.9 or less"
    ]


def _check_velocity(drive: Drive, began: float, end: float) -> None:
    """Raise `InputError` if the velocity of a prescribed position jumps between `began` and `end` [s]."""
    breaks, c = drive.position().polynomial()
    powers = np.arange(1, c.shape[1])
    ends = [float(np.sum(powers * c[i, 1:] * (breaks[i + 1] - breaks[i]) ** (powers - 1))) for i in range(len(c) - 1)]
    begins = c[1:, 1]
    if breaks[0] > 0.0:  # held at the first value until then
        ends, begins, breaks = [0.0, *ends], c[:, 1], np.concatenate([[0.0], breaks])
    jumps = np.where((breaks[1:-1] >= began) & (breaks[1:-1] < end), np.abs(begins - np.array(ends)), 0.0)
    lengths = np.diff(drive.position().polynomial()[0])
    largest = np.abs(powers * c[:, 1:] * lengths[:, None] ** (powers - 1)).max()
    if jumps.size and jumps.max() > VELOCITY_JUMP * largest:
        at = int(np.argmax(jumps))
        raise InputError(
            f"drive {drive.name!r}: the prescribed position jumps in velocity by {jumps[at]:.3g} at "
            f"t = {breaks[at + 1]:g} s, which needs an infinite force; use SmoothStep, Table(..., cubic=True), or "
            "prescribe the velocity"
        )


def check_load_paths(scene: Scene) -> list[str]:
    """Refuse small-sliding contacts that push bodies apart, pretensions and thrust without a load path; notes on
    contacts that wedge deeply or will hardly touch."""
    refuse_pushed_apart(scene)
    refuse_unguided_thrust(scene.bearings, connecting(scene), scene.forces, scene.gravity)
    loose = loose_preloads(scene)
    for force in scene.forces:
        if isinstance(force, Pretension) and force.name in loose:
            raise InputError(f"equilibrium: {loose[str(force.name)]}")
    gaps = {contact.name: facing_gap(contact) for contact in scene.finite_sliding}
    wedge = find_wedge(scene, gaps)
    wedged = "" if wedge is None else excessive_wedge(wedge)
    return [note for note in (wedged, *out_of_reach(scene, gaps)) if note]


def coarser(engine: Engine) -> str:
    """The cure that reduces the contact unknowns: nodes of body-fixed grids, cells of contact-fixed grids."""
    cells = f"take fewer cells (cells= of {'the contact' if len(engine.compiled.patches) == 1 else 'contacts'})"
    on_cells = len(engine.compiled.patches)
    return " or ".join([cells] * (on_cells > 0) + [COARSEN] * (on_cells < len(engine.scene.finite_sliding)))


def describe(bits: int, capacity: int, coarsen: str = COARSEN) -> tuple[Status, str]:
    """Status and message of the failure bits of a world; `coarsen`: the cure of `coarser`."""
    if bits == 0:
        return Status.COMPLETED, ""
    for bit, (status, message) in MESSAGES.items():
        if bits & int(bit):
            text = message.format(capacity=capacity, coarsen=coarsen)
            return status, text + (" (the step was halved as often as allowed)" if bits & int(k.UNDERFLOW) else "")
    return Status.STEP_UNDERFLOW, "the step became too small"
