"""Public functions `simulate_worlds` and `equilibria`: many scenes at once, each with its Result."""

from __future__ import annotations

import logging
import os
import re
from collections.abc import Callable, Sequence
from dataclasses import dataclass
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
from warpffrf.online.run import find_equilibrium
from warpffrf.online.stages import KINDS
from warpffrf.online.warp_lock import WARP_LOCK
from warpffrf.online.worlds import side_by_side
from warpffrf.output.options import RunOptions, require_options
from warpffrf.output.outputs import Outputs, saved_options
from warpffrf.output.result import Result
from warpffrf.output.simulate import STARTS, known_scene, run_arguments, run_of_kind

OF_A_WORLD = re.compile(r"world_\d+\.h5")

log = logging.getLogger("warpffrf")

Each = Callable[[int, Result], Any]


@named_arguments
def simulate_worlds(
    scenes: Sequence[Scene],
    duration: float,
    *,
    step: float,
    start: Literal["initial", "equilibrium"] = "initial",
    kind: Literal["dynamic", "static"] = "dynamic",
    each: Each | None = None,
    results: str | os.PathLike[str] | None = None,
    overwrite: bool = False,
    check: bool = False,
    progress: bool = True,
    options: RunOptions = RunOptions(),  # noqa: B008 (frozen)
) -> list[Any]:
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

    start: "initial", or "equilibrium" of each. kind: "dynamic", or "static" for load steps. each: a function of the
    number of a scene and its Result, called as soon as its run has ended; what it returns is in the list in place of
    the Result, whose memory is free again: for thousands of scenes. results: a folder, with a file for each scene,
    world_000.h5 and so on, written as soon as its run has ended; overwrite: replace those of an earlier call, and
    remove those it has left of more scenes. check: worlds that do not complete raise `RunError`, which names them, and
    whose `result` is the list that is returned otherwise, after the files were written. progress: bar and notes on
    stderr, notes that several scenes share once. options: see `RunOptions`, the same for all scenes. Stages, accuracy,
    continuation of a Result, resume, recordings and check integrators are for single runs.

    Where the free memory of the device does not suffice for all worlds, a line in the log says for how many it does,
    and they run in batches.

    Raises InputError before the run for wrong input, with the number of the scene, counted from 0, in front; and where
    scenes are of another kind than the first, with what differs.

    >>> results = wf.simulate_worlds([scene, scene], 2e-3, step=2e-4, start="equilibrium", progress=False)
    >>> [result.status for result in results]
    ['completed', 'completed']
    """
    runs = simulations(duration, step=step, start=start, kind=kind, options=options)
    return _together("simulate_worlds", runs, scenes, each, results, overwrite, check, progress)


@named_arguments
def equilibria(
    scenes: Sequence[Scene],
    *,
    friction: bool = False,
    each: Each | None = None,
    results: str | os.PathLike[str] | None = None,
    overwrite: bool = False,
    device: str | None = None,
    check: bool = False,
    progress: bool = True,
) -> list[Any]:
    """The static equilibria of many scenes at once, as worlds of one graph: the Result of each, in their order, the
    same as `equilibrium` gives it, bit for bit on the CPU.

    scenes, each, results, overwrite, check, progress: as of `simulate_worlds`. friction, device: as of `equilibrium`.
    Raises InputError for wrong input, with the number of the scene in front.

    >>> forces = wf.equilibria(
    ...     [scene, scene], each=lambda i, run: run.contact("lower-upper").force_magnitude[0], progress=False
    ... )
    >>> [round(float(force)) for force in forces]  # N
    [150, 150]
    """
    runs = rests(friction=friction, device=device)
    return _together("equilibria", runs, scenes, each, results, overwrite, check, progress)


@dataclass(frozen=True)
class Runs:
    """What is run of each scene: `call`, with the scene and the factory of its engine, of so many `steps`; `named`:
    what identifies a run of a scene in its file. `text` is for the log."""

    call: Callable[[Scene, EngineOf], History]
    steps: int
    named: Callable[[Scene], dict[str, str]]
    text: str


def simulations(
    duration: float,
    *,
    step: float,
    start: Literal["initial", "equilibrium"] = "initial",
    kind: Literal["dynamic", "static"] = "dynamic",
    options: RunOptions = RunOptions(),  # noqa: B008 (frozen)
) -> Runs:
    """Runs in time or load steps; raises InputError as `simulate_worlds`."""
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

    def call(scene: Scene, engine_of: EngineOf) -> History:
        return run_of_kind(scene, duration, step=step, start=start, progress=False, engine_of=engine_of, **chosen)

    def named(scene: Scene) -> dict[str, str]:
        return saved_options(scene, start, duration, step, chosen)

    return Runs(call, steps, named, f"{duration:g} s in steps of {step:g} s")


def rests(*, friction: bool = False, device: str | None = None) -> Runs:
    """Equilibria; raises InputError for an unknown device."""
    with WARP_LOCK:
        ready_device(device)

    def call(scene: Scene, engine_of: EngineOf) -> History:
        return find_equilibrium(scene, friction=friction, device=device, engine_of=engine_of)

    return Runs(call, 0, lambda scene: {}, "equilibria")


def each_of(
    runs: Runs, scenes: Sequence[Scene], each: Callable[[int, History], Any], *, alike: bool, progress: bool
) -> list[Any]:
    """What `each` returns of the History of each scene, called as soon as its run has ended, one at a time; alike: as
    of `side_by_side`."""

    def run_of(i: int, scene: Scene) -> Callable[[EngineOf], Any]:
        def run(engine_of: EngineOf) -> Any:
            history = runs.call(scene, engine_of)
            history.options = runs.named(scene)
            with WARP_LOCK:
                return each(i, history)

        return run

    made = [run_of(i, scene) for i, scene in enumerate(scenes)]
    return side_by_side(made, runs.steps, progress=progress, alike=alike)


@dataclass(frozen=True)
class End:
    """How a run ended."""

    status: str
    message: str
    notes: list[str]


def _together(
    caller: str, runs: Runs, scenes: Any, each: Each | None, results: Any, overwrite: bool, check: bool, progress: bool
) -> list[Any]:
    """`simulate_worlds` or `equilibria`, called `caller`."""
    scenes = _known_scenes(caller, scenes)
    if each is not None and not callable(each):
        raise InputError(f"{caller}: each must be a function of the number of a scene and its Result, got {each!r}")
    outputs = Outputs(overwrite)
    files, left_over = _files(caller, results, len(scenes), outputs)
    ends: dict[int, End] = {}

    def end(i: int, history: History) -> Any:
        # the first file is locked during all runs, each other one while it is written: files may be thousands
        if i:
            with outputs.locked(files[i]) as whole:
                result = whole.kept(Result(history))
        else:
            result = first.kept(Result(history))
        ends[i] = End(history.status, history.message, history.notes)
        return result if each is None else each(i, result)

    with terminated_as_interrupted(), speaking(progress), outputs.locked(files[0]) as first:
        log.info("%s: %d scenes, %s", caller, len(scenes), runs.text)
        found = each_of(runs, scenes, end, alike=True, progress=progress)
        _tell_ends(ends)
        _remove(left_over)
        if check and any(one.status != Status.COMPLETED for one in ends.values()):
            raise RunError(found, [ends[i] for i in range(len(scenes))])
        return found


def _known(name: str, value: Any, values: tuple[str, ...]) -> None:
    """Raises `InputError` for a `value` of the argument `name` that is none of `values`."""
    if not isinstance(value, str) or value not in values:
        raise InputError(f"simulate_worlds: {name} is {value!r}{suggestion(str(value), values)}")


def _known_scenes(caller: str, scenes: Any) -> list[Scene]:
    if not isinstance(scenes, Sequence) or not scenes:
        alone = "equilibrium" if caller == "equilibria" else "simulate"
        raise InputError(f"{caller}: a list of scenes is needed first, got {scenes!r}; one alone goes to {alone}")
    for i, scene in enumerate(scenes):
        known_scene(scene, f"{caller}: scene {i}")
    return list(scenes)


def _files(caller: str, results: Any, count: int, outputs: Outputs) -> tuple[list[Path | None], list[Path]]:
    """The results files of the worlds, and those of an earlier call to remove. Raises `InputError` for files that
    cannot be written, or must not be replaced or removed."""
    if results is None:
        return [None] * count, []
    if not isinstance(results, str | os.PathLike):
        raise InputError(f"{caller}: results must be the name of a folder, got {results!r}")
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


def _tell_ends(ends: dict[int, End]) -> None:
    """Log the ends of all runs; messages shared by several runs are logged once."""
    said: dict[str, int] = {}
    for i, end in sorted(ends.items()):
        if end.status != Status.COMPLETED:
            after = f"; {what_follows()}" if end.status == Status.INTERRUPTED else ""
            log.warning("scene %d: run ended early: %s: %s%s", i, end.status, end.message, after)
        for note in end.notes:
            said[note] = said.get(note, 0) + 1
    for note, count in said.items():
        notes.info("note: %s%s", note, f" ({count} scenes)" if count > 1 else "")
