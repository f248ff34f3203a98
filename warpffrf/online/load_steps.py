"""Static runs: consecutive equilibria under varying loads and prescribed motions, with the history of friction.

    static(scene, 1.0, step=0.01)        Stage("press", 1.0, 0.01, kind="static")

At every time t_k = t_begin + k step the scene is at rest under the forces, drives and gravity of that time. Time is
only a load parameter: if nothing depends on rates, another duration with equally stretched signals gives the same
states. Rows are those of a run in time, with velocities and accelerations zero.

The load steps run on the device (`warpffrf_kernels.step.proximal`): a load step is an attempt in mode LOADING,
accepted, halved and recorded like a step in time, and continues bit for bit from a checkpoint. Halved steps record no
rows.

**Start.** From the scene itself, or the result of `equilibrium`, the scene first comes to rest under the
loads of that time and without friction in joints and contacts (`start.settle`). A start from a static run, or the
result of `equilibrium(friction=True)`, keeps its friction state. A start from a run in time drops
the velocities: the first load step ends at rest, and the lost kinetic energy is in
the numerical line of the ledger.

**Limit points.** A load step that fails at the largest number of halvings, because no equilibrium is near,
descends in energy to another one, and the jump is reported in the notes (`warpffrf.online.snap_through`).

**A run in time from the end of a static run** starts at rest, see `warpffrf.online.run`.

**Elements without meaning at rest** are refused, with the cure: films, which carry by sliding and squeezing. Dampers
carry no load. Friction laws that depend on the slip speed use the slip of a load step divided by its duration;
regularised friction and rolling resistance of lumped contacts, which need a velocity, do not act, with a note.

**Free motions.** Motions not resisted by contact and its friction are constrained, as in an equilibrium
(`start.free_motions`), and determined before every load step, from the state alone: a continued run is equal bit for
bit.
"""

from __future__ import annotations

import time
from typing import Any

import numpy as np

from warpffrf.model.checks.redundancy import refuse_singular_mass
from warpffrf.model.checks.scene import refuse_short_signals
from warpffrf.model.errors import MOST_COUNTED, InputError, require_count
from warpffrf.model.friction import RUBBED_REST, friction_notes, rolling_notes
from warpffrf.model.messages.checkpoints import Keeper, Plan, Unfinished
from warpffrf.model.messages.progress import Progress, deferred_interrupts
from warpffrf.model.messages.status import Status
from warpffrf.model.scene import Scene
from warpffrf.model.step_count import step_count
from warpffrf.online.checkpoint import is_dynamic, is_loaded, off_end_of, restore, time_of
from warpffrf.online.diagnosis.patch_off_end import EndWatch, OffEnd
from warpffrf.online.engine import Engine, EngineOf
from warpffrf.online.history.history import ENERGY_LINES, History
from warpffrf.online.local_modes import LocalModes, as_local_modes
from warpffrf.online.outcome import finish
from warpffrf.online.periodic_checkpoint import Keeping, go_on
from warpffrf.online.running import check_load_paths
from warpffrf.online.samples import Samples
from warpffrf.online.settings import Settings
from warpffrf.online.snap_through import snap_through
from warpffrf.online.start.free_motions import FreeMotions
from warpffrf.online.start.loading import begin_loading, not_at_rest
from warpffrf.online.start.static_equilibrium import settle
from warpffrf.online.warp_lock import WARP_LOCK
from warpffrf.online.warp_start import untested_warp_note

FROM_REST = "the first equilibrium of the static run"
MOST_ATTEMPTS = 8  # per load step, in one replay: more follow where steps are halved
MOVED = 1e-12  # of the largest energy of the ledger: kinetic energy above round-off


@WARP_LOCK
def run_static(
    scene: Scene,
    duration: float,
    *,
    step: float,
    start: str | History | Unfinished = "initial",
    local_modes: str | LocalModes = "quasi_static",
    save_every: int = 1,
    device: str | None = None,
    progress: bool = True,
    settings: Settings | None = None,
    keeper: Keeper | None = None,
    engine_of: EngineOf = Engine,
) -> History:
    """Equilibria of `scene` for `duration` [s] in load steps of `step` [s]; arguments as of `online.run`.

    start: "initial" and "equilibrium" are equivalent here. A load step that finds no equilibrium at any halving,
    and none to jump to, ends the run with its reason in `History.status`. Raises InputError for wrong input, and for
    scenes with films. A run in which a patch of a crown runs off an end restarts (`online.diagnosis.patch_off_end`).
    """
    options: dict[str, Any] = {
        "step": step, "local_modes": local_modes, "save_every": save_every, "device": device, "progress": progress,
        "settings": settings, "keeper": keeper, "engine_of": engine_of,
    }  # fmt: skip
    try:
        return _run_static(scene, duration, start=start, off_end=False, **options)
    except OffEnd:
        start = start.start if isinstance(start, Unfinished) else start
        return _run_static(scene, duration, start=start, off_end=True, **options)


def _run_static(
    scene: Scene,
    duration: float,
    *,
    step: float,
    start: str | History | Unfinished,
    local_modes: str | LocalModes,
    save_every: int,
    device: str | None,
    progress: bool,
    settings: Settings | None,
    keeper: Keeper | None,
    engine_of: EngineOf,
    off_end: bool,
) -> History:
    """`run_static`, with cells for crowns that run `off_end`; raises `OffEnd`."""
    if scene.films:
        raise InputError(
            f"static: film {scene.films[0].name!r} carries by sliding and squeezing, which a static run has not; use "
            "a stage in time, or equilibrium(), in which films slide as the scene begins"
        )
    steps, uneven = step_count(duration, step)
    save_every = require_count(save_every, "static: save_every", 1, most=MOST_COUNTED)
    refuse_singular_mass(scene)
    if not isinstance(start, Unfinished):
        began = time_of(start.checkpoint) if isinstance(start, History) else 0.0
        refuse_short_signals(scene, began, began + steps * step)
    if isinstance(start, History) and start.status != Status.COMPLETED and not len(start.time):
        raise InputError(f"static: start has no row to go on from ({start.status}: {start.message})")
    begin = time.perf_counter()
    made_with = {
        "device": device, "settings": (settings or Settings()).for_rows(steps // save_every),
        "local_modes": as_local_modes(local_modes), "progress": progress,
        "off_end": off_end or isinstance(start, History | Unfinished) and off_end_of(start.checkpoint),
    }  # fmt: skip
    engine = engine_of(scene, **made_with)
    built = time.perf_counter()
    notes = [*engine.compiled.notes, *uneven, *_without_velocity(scene), *untested_warp_note()]
    free = FreeMotions(engine, rubs=True)
    first_step, rejected = 0, 0
    if isinstance(start, Unfinished):
        first_step = go_on(engine, start, step)
    else:
        if isinstance(start, History):
            first_step = restore(engine, start.checkpoint, step)
            rejected = int(engine.word("rejected")[0])
        if not isinstance(start, History) or not (is_loaded(start.checkpoint) or is_dynamic(start.checkpoint)):
            engine.control(saved=0)
            engine.drained[:] = 0
            notes.extend([*check_load_paths(scene), *friction_notes(scene, FROM_REST, RUBBED_REST)])
            if not settle(engine):
                return finish(engine, begin, built, notes, "equilibrium: ")
            notes.extend(engine.start_notes)
            begin_loading(engine, step)
            engine.control(rejected=0, steps=0, iterations=0, worst=0, pending=0, pending_solves=0)
            engine.save_now()
            first_step, rejected = 0, 0
        elif is_dynamic(start.checkpoint):
            notes.extend(_without_velocities(engine))
            begin_loading(engine, step)
            first_step = 0
    # errors of energy of contact grids exceed its change in a load step where contact closes or opens
    engine.control(every=save_every, energy_bounded=int(engine.compiled.model.pairs.count == 0))
    engine.seconds_in_graph = 0.0
    plan = Plan(first_step + steps, rejected, tuple(notes))
    if isinstance(start, Unfinished):
        plan = start.plan
    last_step, notes = plan.last_step, list(plan.notes)
    keeping = Keeping(engine, keeper, plan)
    ends = EndWatch(engine, keeps=isinstance(start.start if isinstance(start, Unfinished) else start, History))
    loop = time.perf_counter()
    interrupted = False
    bar = Progress("simulate", last_step - first_step, enabled=progress)
    try:
        chunk = 1 if free.possible else 4
        done = first_step
        while done < last_step:
            if np.any(engine.word("status")):
                jump = snap_through(engine)
                if jump is None:
                    break
                notes.append(jump.note())
                done = int(engine.word("step").min())
                continue
            free.hold_here()
            engine.control(target=min(done + chunk, last_step))
            seconds = engine.replay(MOST_ATTEMPTS * chunk)
            now = int(engine.word("step").min())
            if not free.possible:
                rate = max(now - done, 1) / max(seconds, 1e-9)
                most = engine.settings.ring_rows * save_every - 1
                chunk = int(np.clip(rate * engine.settings.chunk_seconds, 1, most))
            done = now
            bar.update(done - first_step)
            ends.look()
            keeping.look()
    except KeyboardInterrupt:
        interrupted = True
    except OffEnd:
        bar.close()
        if keeper is not None:
            keeper.clear()
        raise
    bar.close()
    with deferred_interrupts() as asked:
        if interrupted:
            engine.drain()
            keeping.end()
        failed = bool(np.any(engine.word("status")))
        if not interrupted and not failed and last_step % save_every:
            engine.save_now()
        free.release()
        ended = time.perf_counter()
        engine.not_at_rest = free.unbalanced() or not_at_rest(engine) if failed else ""
        history = finish(engine, begin, built, notes, _where(engine) if failed else "", plan.rejected)
    history.stopping = bool(asked)
    history.samples = Samples(engine, made_with, step, first_step, last_step, static=True)
    history.counters["loop_seconds"] = ended - loop
    history.counters["finish_seconds"] = time.perf_counter() - ended
    if interrupted and history.status == Status.COMPLETED:
        history.status, history.message = Status.INTERRUPTED, "interrupted by the user; results up to there are kept"
    return history


def _without_velocities(engine: Engine) -> list[str]:
    """Stop all motion; returns a note of the energy lost."""
    energy = engine.state.energy.numpy()[:, 0]
    kinetic = float(energy[:, ENERGY_LINES.index("kinetic")].max())
    engine.rates_to_zero()
    if kinetic <= MOVED * float(np.abs(energy).max()):
        return []
    return [
        f"the static run goes on from a motion with {kinetic:.3g} J of kinetic energy, which it gives up (ledger line "
        "numerical): velocities are zero from its first load step on"
    ]


def _without_velocity(scene: Scene) -> list[str]:
    """Notes of resistances of lumped contacts that act only with a velocity."""
    resting = rolling_notes(scene, "a static run")
    names = [c.name for c in scene.lumped_contacts if c.friction.acts and c.friction.creep_limit > 0.0]
    if not names:
        return resting
    return [
        f"regularised friction of {', '.join(map(repr, names))} does not act in a static run: it needs a slip "
        "velocity; laws.Coulomb sticks and slips by displacements",
        *resting,
    ]


def _where(engine: Engine) -> str:
    words: Any = engine.state.ctl.numpy()[0]
    whole = int(words["step"]) + (int(words["sub"]) + 1) / 2 ** int(words["level"])
    t = float(engine.word("start_time")[0]) + whole * float(engine.word("user_step")[0])
    return f"equilibrium at t = {t:.6g} s: "
