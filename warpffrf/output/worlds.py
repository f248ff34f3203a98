"""Public function `simulate_worlds`: many scenes at once, each with its Result."""

from __future__ import annotations

import logging
import os
import re
from collections.abc import Callable, Sequence
from contextlib import ExitStack
from pathlib import Path
from typing import Any, Literal

from warpffrf.model.errors import MOST_COUNTED, InputError, require_count, require_number
from warpffrf.model.integrators import CHECK_INTEGRATORS, Integrator
from warpffrf.model.messages.named_arguments import named_arguments
from warpffrf.model.messages.progress import notes, speaking, terminated_as_interrupted, what_follows
from warpffrf.model.scene import Scene
from warpffrf.model.step_count import step_count
from warpffrf.online import Settings, run
from warpffrf.online.engine import EngineOf, ready_device
from warpffrf.online.history.history import History
from warpffrf.online.load_steps import run_static
from warpffrf.online.local_dynamics import LocalDynamics, as_local_dynamics
from warpffrf.online.run import INTERRUPTED
from warpffrf.online.stages import KINDS
from warpffrf.online.turn import TURN
from warpffrf.online.worlds import side_by_side
from warpffrf.output.outputs import Outputs, run_options
from warpffrf.output.result import Result
from warpffrf.output.simulate import (
    DEFAULT_INTEGRATOR,
    STARTS,
    known,
    known_integrator,
    known_scene,
    refuse_in_statics,
)

OF_A_WORLD = re.compile(r"world_\d+\.h5")

log = logging.getLogger("warpffrf")


@named_arguments
def simulate_worlds(
    scenes: Sequence[Scene],
    duration: float,
    *,
    step: float,
    start: Literal["initial", "equilibrium"] = "initial",
    kind: Literal["dynamic", "static"] = "dynamic",
    local: str | LocalDynamics = "quasi_static",
    integrator: Integrator | None = None,
    step_error: float | None = None,
    energy_tolerance: float | None = None,
    save_every: int = 1,
    results: str | os.PathLike[str] | None = None,
    device: str | None = None,
    progress: bool = True,
    project_start: bool = False,
    overwrite: bool = False,
) -> list[Result]:
    """Simulate many scenes at once, for `duration` [s] with steps of `step` [s], as worlds of one graph.

    Returns the Result of each scene, in their order, identical to that of `simulate`: bit for bit on the CPU. On the
    CPU the set-up is shared, which saves time for short runs; a GPU steps all worlds in parallel. A world whose solver
    fails ends alone, with its `status` and `message`, and the others continue; slow equilibria and halved steps also
    affect only their own world. Seconds in `counters` are wall times, which include the work on other worlds.

    scenes: scenes of the same structure, which differ only in numbers: loads, speeds, prescribed motions, stiffnesses,
    coefficients of friction, masses, positions, initial velocities, profiles. They must have the same bodies, joints,
    contacts and so on, with the same modes and grids, in the same order, and contact windows of the same size. A scene
    may be listed several times. Reduced bodies should be shared objects.

    results: a folder with one file per scene, world_000.h5 and so on, written when all have ended; overwrite: replace
    those of an earlier call, and remove surplus ones. Other options: as of `simulate`, for all scenes alike. start:
    "initial", or "equilibrium" of each. kind: "dynamic", or "static" for load steps. local: treatment of the local
    modes. integrator: None for GeneralizedAlpha(rho_inf=0.8). step_error: local error of a step [m, rad] above which it
    is halved. energy_tolerance: relative energy gain of an impact step [J/J] above which it is halved. save_every:
    number of steps between saved ones; the last is also saved. device: "cpu" or "cuda:0", None: the environment
    variable WARPFFRF_DEVICE. progress: bar and notes on stderr; notes of several scenes are shown once. project_start:
    change initial velocities that violate the joints. Stages, accuracy, continuation from a Result, resume, recordings
    and check integrators are for single runs.

    Raises InputError before the run for wrong input, with the index of the scene, from 0, in front; and if a scene has
    a different structure from the first, with the difference.

    >>> results = wf.simulate_worlds([scene, scene], 2e-3, step=2e-4, start="equilibrium", progress=False)
    >>> [result.status for result in results]
    ['completed', 'completed']
    """
    scenes = _known_scenes(scenes)
    known("start", start, STARTS)
    known("kind", kind, KINDS)
    as_local_dynamics(local)
    known_integrator(integrator, "simulate_worlds")
    if isinstance(integrator, CHECK_INTEGRATORS):
        raise InputError(
            f"simulate_worlds: {type(integrator).__name__} steps without the graph; run the scenes one by one, with "
            "simulate"
        )
    if kind == "static":
        refuse_in_statics(
            "simulate_worlds", integrator=integrator, step_error=step_error, energy_tolerance=energy_tolerance,
            project_start=project_start or None,
        )  # fmt: skip
    steps, _ = step_count(duration, step)
    with TURN:
        ready_device(device)
    save_every = require_count(save_every, "simulate_worlds: save_every", 1, most=MOST_COUNTED)
    options: dict[str, Any] = {"save_every": save_every, "device": device, "local": local}
    if energy_tolerance is not None:
        energy_tolerance = require_number(energy_tolerance, "simulate_worlds: energy_tolerance", positive=True)
        options["settings"] = Settings(energy_tolerance=energy_tolerance)
    if step_error is not None:
        require_number(step_error, "simulate_worlds: step_error", positive=True)
    if kind == "dynamic":
        options |= {"integrator": DEFAULT_INTEGRATOR if integrator is None else integrator}
        options |= {"step_error": step_error, "project_start": project_start}

    def run_of(scene: Scene) -> Callable[[EngineOf], History]:
        one = run_static if kind == "static" else run
        return lambda engine_of: one(
            scene, duration, step=step, start=start, progress=False, engine_of=engine_of, **options
        )

    named = {"integrator": integrator, "save_every": save_every, "project_start": project_start, "local": local}
    named |= {"step_error": step_error} | ({"kind": kind} if kind == "static" else {})
    named |= {} if energy_tolerance is None else {"energy_tolerance": energy_tolerance}
    outputs = Outputs(overwrite)
    files, left_over = _files(results, len(scenes), outputs)
    with terminated_as_interrupted(), speaking(progress), ExitStack() as locks:
        log.info("simulate_worlds: %d scenes, %s s in steps of %s s", len(scenes), duration, step)
        wholes = [locks.enter_context(outputs.locked(file)) for file in files]
        histories = side_by_side([run_of(scene) for scene in scenes], steps, progress=progress)
        for scene, history in zip(scenes, histories, strict=True):
            history.options = run_options(scene, start, duration, step, named)
        found = [Result(history) for history in histories]
        _tell_ends(found)
        found = [whole.kept(result) for whole, result in zip(wholes, found, strict=True)]
        _remove(left_over)
        return found


def _known_scenes(scenes: Any) -> list[Scene]:
    if not isinstance(scenes, Sequence) or not scenes:
        raise InputError(
            f"simulate_worlds: a list of scenes is needed first, got {scenes!r}; one alone goes to simulate"
        )
    for i, scene in enumerate(scenes):
        known_scene(scene, f"simulate_worlds: scene {i}")
    return list(scenes)


def _files(results: Any, count: int, outputs: Outputs) -> tuple[list[Path | None], list[Path]]:
    """The results files of the worlds, and those of an earlier call to remove. Raises `InputError` for files that
    cannot be written, or must not be replaced or removed."""
    if results is None:
        return [None] * count, []
    if not isinstance(results, str | os.PathLike):
        raise InputError(f"simulate_worlds: results must be the name of a folder, got {results!r}")
    digits = max(3, len(str(count - 1)))
    folder = Path(results).expanduser()
    files = [folder / f"world_{i:0{digits}d}.h5" for i in range(count)]
    left_over = sorted(file for file in folder.glob("world_*.h5") if OF_A_WORLD.fullmatch(file.name))
    left_over = [file for file in left_over if file not in files]
    for file in (*files, *left_over):
        outputs.check(file, None)
    return [*files], left_over


def _remove(left_over: Sequence[Path]) -> None:
    for file in left_over:
        try:
            file.unlink(missing_ok=True)
        except OSError as error:
            log.error("results: '%s' of an earlier call could not be removed: %s; it is not of this one", file, error)
        else:
            log.info("results: '%s' of an earlier call with more scenes is removed", file)


def _tell_ends(found: Sequence[Result]) -> None:
    """Log the ends of all runs; messages shared by several runs are logged once."""
    said: dict[str, int] = {}
    for i, result in enumerate(found):
        if result.status != "completed":
            after = f"; {what_follows()}" if result.status == INTERRUPTED else ""
            log.warning("scene %d: run ended early: %s: %s%s", i, result.status, result.message, after)
        for note in result.history.notes:
            said[note] = said.get(note, 0) + 1
    for note, count in said.items():
        notes.info("note: %s%s", note, f" ({count} scenes)" if count > 1 else "")
