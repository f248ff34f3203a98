"""Public function `simulate_worlds`: many scenes at once, each with its Result."""

from __future__ import annotations

import logging
import os
import re
from collections.abc import Callable, Sequence
from contextlib import ExitStack
from pathlib import Path
from typing import Any, Literal

from warpffrf.model.errors import InputError, RunError, suggestion
from warpffrf.model.integrators import CHECK_INTEGRATORS
from warpffrf.model.messages.named_arguments import named_arguments
from warpffrf.model.messages.progress import notes, speaking, terminated_as_interrupted, what_follows
from warpffrf.model.messages.status import Status
from warpffrf.model.scene import Scene
from warpffrf.model.step_count import step_count
from warpffrf.online.engine import EngineOf, ready_device
from warpffrf.online.history.history import History
from warpffrf.online.stages import KINDS
from warpffrf.online.warp_lock import WARP_LOCK
from warpffrf.online.worlds import side_by_side
from warpffrf.output.options import RunOptions, require_options
from warpffrf.output.outputs import Outputs, saved_options
from warpffrf.output.result import Result
from warpffrf.output.simulate import STARTS, known_scene, run_arguments, run_of_kind

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
    results: str | os.PathLike[str] | None = None,
    overwrite: bool = False,
    check: bool = False,
    progress: bool = True,
    options: RunOptions = RunOptions(),  # noqa: B008 (frozen)
) -> list[Result]:
    """Simulate many scenes at once, for `duration` [s] with steps of `step` [s], as worlds of one graph.

    Returns the Result of each, in their order, the same as `simulate` gives it, or `static`: bit for bit on the CPU.
    There the set-up is done once for all, an advantage for short runs; a GPU steps all worlds in parallel. A world
    whose solver fails ends alone, with its `status` and `message`, and the others continue; iterations to its
    equilibrium and halved steps of a world are also its own. Seconds in `counters` are wall times, shared with the
    other worlds.

    scenes: of one kind, so that they differ in numbers only: loads, speeds, prescribed motions, stiffnesses,
    coefficients of friction, masses, positions, initial velocities, profiles, as long as they have the same bodies,
    joints, contacts and so on, of the same modes and grids, in the same order, and contact windows of the same size.
    One scene may occur several times. Their reduced bodies should be the same objects.

    start: "initial", or "equilibrium" of each. kind: "dynamic", or "static" for load steps. results: a folder, with a
    file for each scene, world_000.h5 and so on, written when all have ended; overwrite: replace those
    of an earlier call, and remove those it has left of more scenes. check: worlds that do not complete raise
    `RunError`, which names them, and whose `result` is the list of all results, after their files were written.
    progress: bar and notes on stderr, notes that several scenes share once. options: see `RunOptions`, the same for
    all scenes. Stages, accuracy, continuation of a Result, resume, recordings and check integrators are for single
    runs.

    Raises InputError before the run for wrong input, with the number of the scene, counted from 0, in front; and where
    scenes are of another kind than the first, with what differs.

    >>> results = wf.simulate_worlds([scene, scene], 2e-3, step=2e-4, start="equilibrium", progress=False)
    >>> [result.status for result in results]
    ['completed', 'completed']
    """
    scenes = _known_scenes(scenes)
    _known("start", start, STARTS)
    _known("kind", kind, KINDS)
    require_options(options, "simulate_worlds", static=kind == "static")
    if isinstance(options.integrator, CHECK_INTEGRATORS):
        raise InputError(
            f"simulate_worlds: {type(options.integrator).__name__} steps without the graph; run the scenes one by one, "
            "with simulate"
        )
    steps, _ = step_count(duration, step)
    with WARP_LOCK:
        ready_device(options.device)
    chosen: dict[str, Any] = run_arguments(options) | ({"kind": kind} if kind == "static" else {})

    def run_of(scene: Scene) -> Callable[[EngineOf], History]:
        return lambda engine_of: run_of_kind(
            scene, duration, step=step, start=start, progress=False, engine_of=engine_of, **chosen
        )

    outputs = Outputs(overwrite)
    files, left_over = _files(results, len(scenes), outputs)
    with terminated_as_interrupted(), speaking(progress), ExitStack() as locks:
        log.info("simulate_worlds: %d scenes, %g s in steps of %g s", len(scenes), duration, step)
        wholes = [locks.enter_context(outputs.locked(file)) for file in files]
        histories = side_by_side([run_of(scene) for scene in scenes], steps, progress=progress)
        for scene, history in zip(scenes, histories, strict=True):
            history.options = saved_options(scene, start, duration, step, chosen)
        found = [Result(history) for history in histories]
        _tell_ends(found)
        found = [whole.kept(result) for whole, result in zip(wholes, found, strict=True)]
        _remove(left_over)
        if check and any(result.status != Status.COMPLETED for result in found):
            raise RunError(found)
        return found


def _known(name: str, value: Any, values: tuple[str, ...]) -> None:
    """Raises `InputError` for a `value` of the argument `name` that is none of `values`."""
    if not isinstance(value, str) or value not in values:
        raise InputError(f"simulate_worlds: {name} is {value!r}{suggestion(str(value), values)}")


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
        if result.status != Status.COMPLETED:
            after = f"; {what_follows()}" if result.status == Status.INTERRUPTED else ""
            log.warning("scene %d: run ended early: %s: %s%s", i, result.status, result.message, after)
        for note in result.history.notes:
            said[note] = said.get(note, 0) + 1
    for note, count in said.items():
        notes.info("note: %s%s", note, f" ({count} scenes)" if count > 1 else "")
