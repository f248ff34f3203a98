"""Run control: runs in time, from their start to their History, and equilibria."""

from __future__ import annotations

import logging
import time
from typing import Any

import numpy as np

from warpffrf.model.checks.redundancy import refuse_singular_mass
from warpffrf.model.errors import InputError, require_number
from warpffrf.model.films.film import refuse_touching
from warpffrf.model.friction import RUBBED_REST, friction_notes, rolling_notes
from warpffrf.model.integrators import CHECK_INTEGRATORS, EnergyMomentum, Integrator, RungeKutta4
from warpffrf.model.messages.checkpoints import Keeper, Unfinished
from warpffrf.model.scene import Scene
from warpffrf.model.step_count import step_count
from warpffrf.online.diagnosis.film_notes import FilmWatch
from warpffrf.online.diagnosis.patch_off_end import EndWatch, OffEnd
from warpffrf.online.engine import Engine, EngineOf
from warpffrf.online.free_flight.check_run import run_check
from warpffrf.online.history.history import History
from warpffrf.online.local_modes import LocalModes, as_local_modes
from warpffrf.online.outcome import finish
from warpffrf.online.running import Outrun, Running, check_load_paths
from warpffrf.online.samples import Samples
from warpffrf.online.settings import Settings
from warpffrf.online.start.static_equilibrium import settle
from warpffrf.online.start.static_friction import refuse_without_rest, rub_to_rest
from warpffrf.online.warp_lock import WARP_LOCK

log = logging.getLogger("warpffrf")


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
        except Outrun as faster:
            turned = faster.turned
            start = start.start if isinstance(start, Unfinished) else start
            log.info(
                "a body rotates faster than its inertia level is valid for: the run is restarted with all inertia terms"
            )


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
    progress: bool,
    keeper: Keeper | None,
    **options: Any,
) -> History:
    """`run` with the options of `Running`; raises `Outrun` if a body rotates faster than its inertia level is valid
    for, and `OffEnd`."""
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
    running = Running(
        scene, steps, step=step, start=start, integrator=integrator, local_modes=local_modes, step_error=step_error,
        save_every=save_every, progress=progress, keeper=keeper, uneven=uneven, **options,
    )  # fmt: skip
    if running.failed:
        return running.finish()
    try:
        running.advance(running.last_step)
        running.judge_end()
    except KeyboardInterrupt:
        running.interrupted = True
    except (Outrun, OffEnd):
        running.drop()
        raise
    return running.finish()


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
