"""A run in time as an object: begun, advanced to any later step, and finished.

`warpffrf.online.run.run` advances it to its end in chunks of steps; a `Simulation` advances it step by step. Between
two chunks the run is watched: films and samples are kept, created energy, patches that run off an end and bodies that
rotate too fast are looked for. When this happens does not change the numbers of a step.
"""

from __future__ import annotations

import time

import numpy as np

from warpffrf.model.bearings.bearing import refuse_unguided_thrust
from warpffrf.model.checks.contacts import excessive_wedge, find_wedge, out_of_reach, refuse_overlap
from warpffrf.model.checks.redundancy import refuse_positions, refuse_singular_mass, refuse_velocities
from warpffrf.model.checks.scene import connecting, loose_preloads, refuse_short_signals
from warpffrf.model.errors import MOST_COUNTED, InputError, require_count
from warpffrf.model.films.film import refuse_touching
from warpffrf.model.forces import Pretension
from warpffrf.model.friction import RUBBED_REST, friction_notes, rolling_notes
from warpffrf.model.integrators import GeneralizedAlpha, Integrator, roots_at_infinity
from warpffrf.model.joints import Drive
from warpffrf.model.lumped_contact import refuse_lumped_overlap
from warpffrf.model.messages.checkpoints import Keeper, Plan, Unfinished
from warpffrf.model.messages.progress import Progress, deferred_interrupts
from warpffrf.model.messages.status import Status
from warpffrf.model.placement.gap import facing_gap
from warpffrf.model.scene import Scene
from warpffrf.model.small_sliding.sliding import refuse_pushed_apart
from warpffrf.online.checkpoint import is_dynamic, is_loaded, off_end_of, restore, time_of, turned_of
from warpffrf.online.diagnosis.contact_notes import overlap_notes
from warpffrf.online.diagnosis.energy_watch import EnergyWatch
from warpffrf.online.diagnosis.film_notes import FilmWatch
from warpffrf.online.diagnosis.patch_off_end import EndWatch
from warpffrf.online.engine import Engine, EngineOf
from warpffrf.online.history.history import History
from warpffrf.online.local_modes import LocalModes, as_local_modes
from warpffrf.online.outcome import finish
from warpffrf.online.periodic_checkpoint import Keeping, go_on
from warpffrf.online.released import begin_changed
from warpffrf.online.samples import Samples
from warpffrf.online.settings import Settings
from warpffrf.online.start.consistent import RUB_IN, start_consistently, start_from_loads
from warpffrf.online.start.static_equilibrium import settle
from warpffrf.online.warp_start import untested_warp_note
from warpffrf_kernels.core import control as k

START_REST = "the equilibrium that the run starts from"
MOST_UNDAMPED = 0.95  # spectral radius at infinity up to which an alternation of reactions grows less than tenfold
OTHER_LEVELS = "a body has more inertia terms from here on than in the run that this one continues"
VELOCITY_JUMP = 1e-6  # of the largest velocity: rounding of a signal's coefficients
FIRST_CHUNK = 4  # steps, before their rate is known
ATTEMPTS = 4  # per step of a chunk, in one replay: more follow where steps are halved


class Outrun(Exception):
    """Bodies rotate at `turned` (bodies,) [rad/s], faster than their inertia levels are valid for."""

    def __init__(self, turned: np.ndarray) -> None:
        super().__init__()
        self.turned = turned


class Running:
    """A run of `scene` for `steps` user steps of `step` [s], None: until it is left, which keeps no samples.

    Other arguments as of `warpffrf.online.run.run`. `turned`: angular speeds [rad/s] of the bodies that select their
    inertia levels. off_end: cells for crowns that run off an end. uneven: notes of the caller on the step. `failed`:
    where it ended, if before its first step, else "". Raises `InputError` for wrong input.
    """

    def __init__(
        self,
        scene: Scene,
        steps: int | None,
        *,
        step: float,
        start: str | History | Unfinished,
        integrator: Integrator | None,
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
        uneven: list[str],
    ) -> None:
        refuse_singular_mass(scene)
        self.start, self.step = start, step
        continued = isinstance(start, History | Unfinished)
        if not isinstance(start, Unfinished):
            began = time_of(start.checkpoint) if isinstance(start, History) else 0.0
            if steps is not None:
                refuse_signals(scene, began, began + steps * step)
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
        self.begin = time.perf_counter()
        integrator = integrator or GeneralizedAlpha()
        settings = settings or Settings()
        made_with = {
            "device": device, "settings": settings if steps is None else settings.for_rows(steps // save_every),
            "integrator": integrator, "step_error": step_error, "local_modes": as_local_modes(local_modes),
            "progress": progress,
        }  # fmt: skip
        before = turned_of(start.checkpoint, scene) if isinstance(start, History | Unfinished) else turned[:0]
        anew = len(turned) > 0
        if len(before):
            turned = np.maximum(before, turned if anew else 0.0)
        made_with["turned"] = turned
        made_with["off_end"] = off_end or isinstance(start, History | Unfinished) and off_end_of(start.checkpoint)
        self.engine = engine = engine_of(scene, **made_with)
        self.built = time.perf_counter()
        self.failed = ""
        self.interrupted = False
        first_step, rejected = 0, 0
        self.notes = [*engine.compiled.notes, *_reaction_notes(integrator, engine), *uneven, *untested_warp_note()]
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
            elif not at_rest:
                begin_changed(engine, step)
            if not at_rest:
                self.notes.extend(engine.start_notes)
                self.notes.extend([OTHER_LEVELS] if anew and not loaded else [])
            if np.any(engine.word("status")):
                self.failed = "start: "
                return
        elif isinstance(start, Unfinished):
            first_step = go_on(engine, start, step)
        if at_rest:
            rejected = 0
            engine.control(saved=0)
            engine.drained[:] = 0
        if not continued or at_rest:
            self.failed = self._set_out(at_rest)
            if self.failed:
                return
            first_step = 0
        engine.has_turned(turned)
        engine.control(every=save_every)
        engine.seconds_in_graph = 0.0
        self.loop = time.perf_counter()
        plan = Plan(first_step + (steps or 0), rejected, tuple(self.notes))
        if isinstance(start, Unfinished):
            plan = start.plan
        self.plan, self.notes = plan, list(plan.notes)
        self.first_step = self.done = first_step
        self.last_step = plan.last_step
        self.save_every = save_every
        self.chunk = FIRST_CHUNK
        self.gain = ""
        self.keeping = Keeping(engine, keeper, plan)
        self.keeper = keeper
        self.samples = None if steps is None else Samples(engine, made_with, step, first_step, self.last_step)
        if self.samples is not None:
            self.samples.look(engine, first_step)
        self.films = FilmWatch(engine, first_step, self.last_step)
        self.ends = EndWatch(engine, keeps=isinstance(start.start if isinstance(start, Unfinished) else start, History))
        self.watch = EnergyWatch(engine, step, set_down=isinstance(start, str) and start == "initial")
        self.bar = Progress("simulate", self.last_step - first_step, enabled=progress and steps is not None)

    def _set_out(self, at_rest: bool) -> str:
        """Consistent velocities, accelerations and reactions at the start of the time count, and the first row;
        where that failed, else ""."""
        engine, scene, start = self.engine, self.engine.scene, self.start
        if start == "equilibrium":
            self.notes.extend(check_load_paths(scene))
        if start == "initial":
            self.notes.extend(overlap_notes(scene))
        if start == "equilibrium" or at_rest:
            self.notes.extend(friction_notes(scene, START_REST, RUBBED_REST) + rolling_notes(scene, START_REST))
        if start == "equilibrium" and not settle(engine):
            return "equilibrium: "
        engine.initial_rates()
        start_consistently(engine, self.step)
        self.notes.extend(engine.start_notes)
        if np.any(engine.word("status")):
            return "start: "
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
        engine.enter(k.DYNAMIC, self.step, target=0)
        if engine.compiled.model.capacity.cells or any(c.friction.acts for c in scene.lumped_contacts):
            engine.control(level=min(RUB_IN, engine.settings.max_level))
        engine.save_now()
        return ""

    @property
    def over(self) -> bool:
        """Whether the run has ended: it has failed, before its first step or in one."""
        return bool(self.failed) or bool(np.any(self.engine.word("status")))

    def advance(self, target: int) -> None:
        """Go on to user step `target`, in chunks, or as far as the run goes. Raises `Outrun` and `OffEnd`, upon which
        it is begun anew, and KeyboardInterrupt between two chunks."""
        engine = self.engine
        most = engine.settings.ring_rows * self.save_every - 1
        while self.done < target and not np.any(engine.word("status")):
            until = min(self.done + self.chunk, target)
            if self.samples is not None:
                until = self.samples.until(until, self.done)
            engine.control(target=self.films.until(until, self.done))
            seconds = engine.replay(ATTEMPTS * self.chunk)
            now = int(engine.word("step").min())
            rate = max(now - self.done, 1) / max(seconds, 1e-9)
            self.chunk = int(np.clip(rate * engine.settings.chunk_seconds, 1, most))
            self.done = now
            self.bar.update(now - self.first_step)
            self.look()

    def look(self) -> None:
        """Watch the run after a chunk, see the module; raises as `advance`."""
        engine = self.engine
        if self.samples is not None:
            self.samples.look(engine, self.done)
        self.films.look(engine, self.done)
        if self.watch.look():
            self.gain = self.watch.end()
        self.ends.look()
        if (faster := engine.outrun()) is not None:
            raise Outrun(faster)
        self.keeping.look()

    def judge_end(self) -> None:
        """At the last step: end the run where the energy created last was not confirmed yet."""
        if not np.any(self.engine.word("status")) and self.watch.gained_at_end():
            self.gain = self.watch.end()

    def watch_from_here(self) -> None:
        """Watch the run from its present state on, to which it was set."""
        self.watch = EnergyWatch(self.engine, self.step)
        self.ends = EndWatch(self.engine, keeps=True)

    def so_far(self) -> History:
        """The History up to here; evaluations for its notes change the engine, not its checkpoint."""
        films = FilmWatch(self.engine, 0, 0)
        films.keep(self.engine)
        ended = time.perf_counter()
        history = finish(self.engine, self.begin, self.built, list(self.notes), "", self.plan.rejected, films)
        history.message = self.gain or history.message
        history.counters["loop_seconds"] = ended - self.loop
        history.counters["finish_seconds"] = time.perf_counter() - ended
        return history

    def drop(self) -> None:
        """Leave the run, which is begun anew: its display and what its keeper has."""
        self.bar.close()
        if self.keeper is not None:
            self.keeper.clear()

    def finish(self) -> History:
        """The History, up to here, of a run that is not advanced any more."""
        if self.failed:
            return finish(self.engine, self.begin, self.built, self.notes, self.failed)
        engine = self.engine
        self.bar.close()
        with deferred_interrupts() as asked:
            if self.interrupted:
                engine.drain()
                self.keeping.end()
            elif not np.any(engine.word("status")) and self.last_step % self.save_every:
                engine.save_now()
            ended = time.perf_counter()
            history = finish(engine, self.begin, self.built, self.notes, "", self.plan.rejected, self.films)
        history.stopping = bool(asked)
        history.samples = self.samples
        history.message = self.gain or history.message
        history.counters["loop_seconds"] = ended - self.loop
        history.counters["finish_seconds"] = time.perf_counter() - ended  # notes and checks of the cells
        if self.interrupted and history.status == Status.COMPLETED:
            history.status = Status.INTERRUPTED
            history.message = "interrupted by the user; results up to there are kept"
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


def refuse_signals(scene: Scene, began: float, end: float) -> None:
    """Raise `InputError` for signals that do not cover `began` to `end` [s], and for prescribed positions whose
    velocity jumps there."""
    for drive in scene.drives:
        times, jumps = velocity_jumps(drive)
        if np.any(within := (times >= began) & (times < end)):
            at = int(np.argmax(np.where(within, jumps, 0.0)))
            raise InputError(
                f"drive {drive.name!r}: the prescribed position jumps in velocity by {jumps[at]:.3g} at "
                f"t = {times[at]:g} s, which needs an infinite force; use SmoothStep, Table(..., cubic=True), or "
                "prescribe the velocity"
            )
    refuse_short_signals(scene, began, end)


def velocity_jumps(drive: Drive) -> tuple[np.ndarray, np.ndarray]:
    """Times [s] at which the velocity of a prescribed position jumps, and by how much."""
    breaks, c = drive.position().polynomial()
    powers = np.arange(1, c.shape[1])
    lengths = np.diff(breaks)
    ends = [float(np.sum(powers * c[i, 1:] * lengths[i] ** (powers - 1))) for i in range(len(c) - 1)]
    begins = c[1:, 1]
    largest = np.abs(powers * c[:, 1:] * lengths[:, None] ** (powers - 1)).max()
    if breaks[0] > 0.0:  # held at the first value until then
        ends, begins, breaks = [0.0, *ends], c[:, 1], np.concatenate([[0.0], breaks])
    jumps = np.abs(begins - np.array(ends))
    large = jumps > VELOCITY_JUMP * largest
    return breaks[1:-1][large], jumps[large]


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
