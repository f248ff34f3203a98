"""Public functions `simulate`, `static` and `equilibrium`: check the outputs, run, wrap the result, write the files."""

from __future__ import annotations

import logging
import os
from collections.abc import Callable, Sequence
from dataclasses import replace
from pathlib import Path
from typing import Any

from warpffrf.model.checks.scene import refuse_short_signals
from warpffrf.model.errors import InputError, RunError, nearest, require_number
from warpffrf.model.integrators import CHECK_INTEGRATORS
from warpffrf.model.messages.named_arguments import named_arguments
from warpffrf.model.messages.progress import speaking, terminated_as_interrupted
from warpffrf.model.messages.status import Status
from warpffrf.model.scene import Scene
from warpffrf.model.step_count import step_count
from warpffrf.online import Settings, find_equilibrium, run
from warpffrf.online.checkpoint import time_of
from warpffrf.online.history.history import BudgetLine, History
from warpffrf.online.load_steps import run_static
from warpffrf.online.local_modes import as_local_modes, refuse_other_modes
from warpffrf.online.released import enter, left
from warpffrf.online.stages import Stage, check_stages, joined, with_potential
from warpffrf.output.accuracy.choose import refuse_other_options, run_to_accuracy
from warpffrf.output.accuracy.limits import Limits
from warpffrf.output.accuracy.setting import Setting
from warpffrf.output.budget.budget import largest_of_each
from warpffrf.output.files.results import SUFFIXES
from warpffrf.output.files.unfinished import ENDING
from warpffrf.output.options import DEFAULT_INTEGRATOR, RunOptions, require_integrator, require_options
from warpffrf.output.outputs import Kind, Outputs
from warpffrf.output.result import Result

STARTS = ("initial", "equilibrium")

log = logging.getLogger("warpffrf")


class StagedResult(Result):
    """Result of a run in stages; `stages` maps each stage name to its Result, from which another run can start."""

    def __init__(self, history: Any, stages: dict[str, Result]) -> None:
        super().__init__(history)
        self.stages = stages

    def error_budget(self, *, progress: bool = False) -> list[BudgetLine]:
        """The largest line over the stages for each source and quantity; raises InputError as `Result.error_budget`."""
        if not self.history.budget:
            lines = [line for stage in self.stages.values() for line in stage.error_budget(progress=progress)]
            self.history.budget = largest_of_each(lines)
        return self.history.budget


@named_arguments
def simulate(
    scene: Scene,
    duration: float | Sequence[Stage],
    *,
    step: float | None = None,
    start: str | os.PathLike[str] | Result = "initial",
    accuracy: float | None = None,
    results: str | os.PathLike[str] | None = None,
    record: str | os.PathLike[str] | None = None,
    overwrite: bool = False,
    resume: bool = False,
    check: bool = False,
    progress: bool = True,
    options: RunOptions = RunOptions(),  # noqa: B008 (frozen)
) -> Result:
    """Simulate `scene` for `duration` [s] with steps of `step` [s], or in a list of `Stage` without `step`.

    start: "initial" (positions and velocities of the scene), "equilibrium" (static state under load first), or the
    Result, or results file, of an earlier run or equilibrium of the same scene, which is continued bit for bit (with
    small-sliding contacts to round-off, some 1e-9). A list of stages (`warpffrf.online.stages`) gives a StagedResult.
    accuracy: the requested error of forces, motions and deformations (0.01 for one per cent; pressures may err by twice
    that). Step, inertia levels, stiffening, contact grids and cells are chosen from the error budgets of coarse runs
    (`warpffrf.output.accuracy`); the notes state the choices, the reasons, and what requires another reduction. `step`
    may be omitted, or is the longest. What the scene sets itself is kept, and the scene is not changed: continue with
    `result.scene`. options: local modes, integrator, saved steps, device, ..., see `RunOptions`.

    results, record: files to write (.h5, .rrd), also when the run is interrupted (Ctrl-C, SIGTERM) or fails, with the
    results so far; files that cannot be written are in `unwritten` of the Result and in its notes. A script continues
    with an interrupted result: after Ctrl-C it may start further runs, after SIGTERM it exits (code 143) where it would
    start another run. The recording shows at most 300 of the saved steps; `warpffrf.record` writes others. With stages,
    results "run.h5" also means "run.NAME.h5" at the end of each stage: a checkpoint to start from. progress: report the
    progress and the notes of the run on stderr: bars on a terminal, lines elsewhere; through `logging` alone where the
    application has configured it. A solver that fails does not raise, see `status` and `message` of the Result; with
    check a run that does not complete raises `RunError`, whose `result` has the data computed so far, after its files
    were written. Wrong input raises InputError before the run. Threads may call it concurrently, with bit-identical
    results: steps run in parallel, all else in sequence (`warpffrf.online.warp_lock`).

    overwrite: replace files of an earlier run; otherwise existing ones are refused, and files that warpffrf did not
    write always. During the run its output so far is stored in the folder `run.h5.unfinished` every 20 s of wall time
    (less often if a checkpoint takes more than 2 % of that). resume: continue from there, or from an interrupted run,
    with the same options, bit for bit as if it had not been stopped (with small-sliding contacts to round-off), with
    every integrator; a finished run is read, and one that never started is started.

    >>> result = wf.simulate(scene, 2e-3, step=2e-4, start="equilibrium", results="press.h5", progress=False)
    >>> result.status
    'completed'
    """
    known_scene(scene, "simulate")
    require_options(options, "simulate")
    beginning, outputs = _prepared("simulate", scene, start, results, record, overwrite, resume)
    stages: Any = duration if isinstance(duration, Sequence | Stage) else None
    whole: Any = duration  # s, where there are no stages
    limits = None
    if accuracy is not None:
        limits = Limits.of(accuracy)
        refuse_other_options(
            stages=stages, step_error=options.step_error, fixed=isinstance(options.integrator, CHECK_INTEGRATORS),
            resume=resume,
        )  # fmt: skip
    chosen = run_arguments(options) | {"progress": progress}
    with terminated_as_interrupted(), speaking(progress):
        if stages is not None:
            parts, scenes = check_stages(scene, stages)
            if step is not None:
                raise InputError("simulate: stages have their own step; leave that of the run out")
            found = _staged(scene, parts, scenes, beginning, results, chosen, outputs)
        elif limits is not None:
            found = _accurate(scene, beginning, whole, step, limits, chosen, outputs, results)
        elif step is None:
            raise InputError("simulate: give step, or accuracy=, or a list of Stage(name, duration, step) as duration")
        else:
            found = outputs.run(scene, _run, beginning, whole, step, chosen, results)
        return checked(outputs.record(found, record, progress), check)


@named_arguments
def static(
    scene: Scene,
    duration: float,
    *,
    step: float,
    start: str | os.PathLike[str] | Result = "initial",
    results: str | os.PathLike[str] | None = None,
    record: str | os.PathLike[str] | None = None,
    overwrite: bool = False,
    resume: bool = False,
    check: bool = False,
    progress: bool = True,
    options: RunOptions = RunOptions(),  # noqa: B008 (frozen)
) -> Result:
    """Equilibria of `scene` at the end of every load step of `step` [s], for `duration` [s].

    Loads and prescribed motions are those of the time of each step; friction keeps its history. Time is only a load
    parameter (`warpffrf.online.load_steps`). start: "initial", or the Result, or results file, of an earlier run or
    equilibrium of the same scene. options: local_modes, save_every and device of `RunOptions`. results, record,
    overwrite, resume, check, progress: as of `simulate`. A path of loads with motion in between is a list of `Stage`
    for `simulate`.

    A load step that finds no equilibrium does not raise, see `status` and `message` of the Result; with check it raises
    `RunError`. Wrong input, and films, which carry by sliding and squeezing, raise InputError before the run.

    >>> loaded = wf.static(scene, 1.0, step=0.5, progress=False)
    >>> loaded.status
    'completed'
    """
    known_scene(scene, "static")
    require_options(options, "static", static=True)
    beginning, outputs = _prepared("static", scene, start, results, record, overwrite, resume)
    chosen = run_arguments(options) | {"progress": progress, "kind": "static"}
    with terminated_as_interrupted(), speaking(progress):
        found = outputs.run(scene, _run, beginning, duration, step, chosen, results)
        return checked(outputs.record(found, record, progress), check)


def _prepared(
    caller: str, scene: Scene, start: Any, results: Any, record: Any, overwrite: bool, resume: bool
) -> tuple[Any, Outputs]:
    """Where a run begins, and its files, both checked."""
    if resume and results is None:
        raise InputError(f"{caller}: resume continues from the files of a run; give results")
    beginning, outputs = starting_from(caller, scene, start), Outputs(overwrite, resume)
    outputs.check(results, record)
    return beginning, outputs


def run_arguments(options: RunOptions) -> dict[str, Any]:
    """The options as arguments of `run_of_kind`; an energy_tolerance only where one is given."""
    found = vars(options).copy()
    if options.energy_tolerance is None:
        del found["energy_tolerance"]
    return found


def run_of_kind(
    scene: Any, duration: float, *, integrator: Any, energy_tolerance: float | None = None, kind: str = "dynamic",
    **options: Any,
) -> History:  # fmt: skip
    """Run `scene` by its kind, dynamic or static."""
    if kind == "static":
        own = {name: value for name, value in options.items() if name not in ("step_error", "project_start")}
        return run_static(scene, duration, **own)
    if energy_tolerance is not None:
        options["settings"] = Settings(energy_tolerance=energy_tolerance)
    return run(scene, duration, integrator=DEFAULT_INTEGRATOR if integrator is None else integrator, **options)


def _run(scene: Any, duration: float, *, kind: str = "dynamic", **options: Any) -> History:
    """`run_of_kind`, with a line in the log."""
    step_count(duration, options["step"])  # refuses both before the line in the log
    log.info("%s", _what_is_run(scene, duration, options["step"], options["start"], kind))
    return run_of_kind(scene, duration, kind=kind, **options)


def _what_is_run(scene: Any, duration: Any, step: Any, start: Any, kind: str) -> str:
    """One line that describes the run that starts."""
    holds = _holds(scene)
    first = "the equilibrium, then " if start == "equilibrium" and kind != "static" else ""
    what = "load steps" if kind == "static" else "steps"
    caller = "static" if kind == "static" else "simulate"
    return f"{caller}: {holds}; {first}{duration:g} s in {what} of {step:g} s"


def _holds(scene: Any) -> str:
    """Number of items of each kind in a scene, as text."""
    kinds = {"body": scene.bodies, "joint": scene.joints, "contact": scene.finite_sliding, "film": scene.films}
    counts = [(len(items), kind) for kind, items in kinds.items() if len(items)]
    named = (f"{n} {kind if n == 1 else kind.replace('y', 'ie') + 's'}" for n, kind in counts)
    return ", ".join(named) or "an empty scene"


def _accurate(
    scene: Any, beginning: Any, duration: float, step: float | None, limits: Limits, options: dict[str, Any],
    outputs: Outputs, results: Any,
) -> Result:  # fmt: skip
    """Run whose error budget is within the limits."""
    require_number(duration, "simulate: duration", positive=True)
    if step is not None:
        require_number(step, "simulate: step", positive=True)

    def one(setting: Setting) -> History:
        own = {**options, "local_modes": setting.local_modes, "energy_tolerance": setting.energy_tolerance}
        return _run(setting.scene(scene), duration, step=duration / setting.steps, start=beginning, **own)

    with outputs.locked(results) as whole:
        return whole.written(
            run_to_accuracy(
                scene,
                duration,
                limits,
                step,
                one,
                local_modes=options["local_modes"],
                energy_tolerance=options.get("energy_tolerance"),
                start=beginning,
                progress=options["progress"],
            )  # fmt: skip
        )


def _staged(
    scene: Any, stages: list[Stage], scenes: list[Scene], beginning: Any, results: Any, options: dict[str, Any],
    outputs: Outputs,
) -> StagedResult:  # fmt: skip
    """The stages in sequence, each from the checkpoint of the previous stage."""
    for stage in stages:
        as_local_modes(stage.options.get("local_modes", options["local_modes"]))
        require_integrator(stage.options.get("integrator"), f"stage {stage.name!r}")
        if results is not None:
            outputs.check(stage_file(results, stage.name), None)
    refuse_other_modes(scene, stages, options["local_modes"])
    end = time_of(beginning.checkpoint) if isinstance(beginning, History) else 0.0
    for stage, staged in zip(stages, scenes, strict=True):
        begin, end = end, end + stage.duration
        refuse_short_signals(staged, begin, end)
    parts: dict[str, Result] = {}
    interrupted = ""
    with outputs.locked(results) as whole:
        for stage, staged in zip(stages, scenes, strict=True):
            log.info("stage %s: %g s in steps of %g s", stage.name, stage.duration, stage.step)
            own = {name: value for name, value in stage.options.items() if name in options}
            if stage.kind == "static":
                own |= {"kind": stage.kind, "integrator": None, "step_error": None, "project_start": False}
            file = None if results is None else stage_file(results, stage.name)
            run_stage = _in_its_loads(scene, staged)
            try:
                if isinstance(beginning, History) and beginning.stopping:
                    raise KeyboardInterrupt
                part = outputs.run(scene, run_stage, beginning, stage.duration, stage.step, {**options, **own}, file)
            except KeyboardInterrupt:
                if not parts:
                    raise
                interrupted = f"interrupted before stage {stage.name!r} started"
                break
            part.history.scene = scene  # a stage read from a file has only the scene data of the file
            parts[stage.name], beginning = part, part.history
            if part.status != Status.COMPLETED:
                break
        found = StagedResult(joined([part.history for part in parts.values()], list(parts)), parts)
        if interrupted:
            found.history.status, found.history.message, found.history.stopping = Status.INTERRUPTED, interrupted, True
        return whole.written(found)


def _in_its_loads(scene: Any, staged: Any) -> Callable[..., History]:
    """`_run` of the scene `staged`, a stage of `scene`, from and to checkpoints of `scene`."""

    def run_stage(_scene: Any, duration: float, *, start: Any, **options: Any) -> History:
        begin: dict[str, Any] = {}
        if isinstance(start, History):
            begin = with_potential(start.checkpoint, scene, staged)
            start = replace(start, checkpoint=begin)
            if staged.released.rows:
                enter(begin, staged)
        history = _run(staged, duration, start=start, **options)
        # the loads of a stage do not change the system: it is continued with the scene
        history.scene = scene
        end = with_potential(history.checkpoint, staged, scene)
        history.checkpoint = left(begin, end, staged) if staged.released.rows else end
        return history

    return run_stage


def stage_file(results: str | os.PathLike[str], name: str) -> Path:
    """Path of the results file of the stage called `name`: run.h5 -> run.NAME.h5."""
    path = Path(results)
    return path.with_name(f"{path.stem}.{name}{path.suffix or '.h5'}")


@named_arguments
def equilibrium(
    scene: Scene,
    *,
    friction: bool = False,
    results: str | os.PathLike[str] | None = None,
    record: str | os.PathLike[str] | None = None,
    device: str | None = None,
    progress: bool = True,
    check: bool = False,
    overwrite: bool = False,
) -> Result:
    """The static equilibrium of `scene` under its loads and prescribed motions at time 0, as a Result with one row.

    friction: include friction of joints and contacts. Friction acts on the slip from the initial configuration, that of
    contact surfaces on the slip from the start of contact; friction of small-sliding contacts is always included
    (`warpffrf.online.start.static_friction` describes the load path that this implies). Dynamic and static runs that
    `start` from the Result continue this friction history. Non-convergence is a status; with check it raises
    `RunError`. Wrong input raises InputError. results, record: files to write (.h5, .rrd). device: where kernels run,
    "cpu" or "cuda:0". progress: report the progress and the notes on stderr. overwrite: replace files of an earlier
    call.

    >>> rest = wf.equilibrium(scene, progress=False)
    >>> round(float(rest.contact("lower-upper").force_magnitude[0]))  # N, of the spring and the push
    150
    """
    known_scene(scene, "equilibrium")
    outputs = Outputs(overwrite)
    outputs.check(results, record)
    with terminated_as_interrupted(), speaking(progress), outputs.locked(results) as whole:
        log.info("equilibrium: %s", _holds(scene))
        found = whole.written(Result(find_equilibrium(scene, friction=friction, device=device, progress=progress)))
        return checked(outputs.record(found, record, progress), check)


def checked(result: Kind, check: bool) -> Kind:
    """Returns `result`; raises `RunError` if `check` and the run did not complete."""
    if check and result.status != Status.COMPLETED:
        raise RunError(result)
    return result


def known_scene(scene: Any, caller: str) -> None:
    if not hasattr(scene, "content_hash"):
        raise InputError(f"{caller}: a Scene is needed first, got {scene!r}")


def starting_from(caller: str, scene: Any, start: str | os.PathLike[str] | Result) -> Any:
    """`start` of a run as the History of an earlier one, or its word. Raises `InputError`."""
    if not isinstance(start, Result):
        if start in STARTS:
            return start
        if not isinstance(start, str | os.PathLike) or Path(start).suffix.lower() not in (*SUFFIXES, ENDING):
            known = ", ".join(repr(v) for v in STARTS)
            close = f"did you mean {near!r}? " if (near := nearest(start, STARTS)) else ""
            raise InputError(f"{caller}: start is {start!r}; {close}known: {known}, a Result, or a results file (.h5)")
        start = Result.load(start)
    if start.view.content_hash != scene.content_hash():
        raise InputError(
            f"{caller}: start is the result of another scene (their content differs); continue with the scene that it "
            "came from, or start from 'initial'"
        )
    if not start.history.checkpoint:
        raise InputError(f"{caller}: start has no checkpoint to continue from; run it again")
    return start.history
