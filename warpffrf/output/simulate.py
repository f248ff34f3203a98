"""Public functions `simulate` and `equilibrium`: check the outputs, run, wrap the result, write the files."""

from __future__ import annotations

import logging
import os
from collections.abc import Callable, Sequence
from dataclasses import replace
from pathlib import Path
from typing import Any, Literal

from warpffrf.model.checks.scene import refuse_short_signals
from warpffrf.model.errors import MOST_COUNTED, InputError, RunError, require_count, require_number
from warpffrf.model.integrators import CHECK_INTEGRATORS, INTEGRATORS, EnergyMomentum, Integrator, RungeKutta4
from warpffrf.model.messages.named_arguments import named_arguments
from warpffrf.model.messages.progress import speaking, terminated_as_interrupted
from warpffrf.model.scene import Scene
from warpffrf.online import GeneralizedAlpha, Settings, find_equilibrium, run
from warpffrf.online.checkpoint import time_of
from warpffrf.online.history.history import BudgetLine, History
from warpffrf.online.load_steps import run_static
from warpffrf.online.local_dynamics import LocalDynamics, as_local_dynamics, refuse_other_modes
from warpffrf.online.run import INTERRUPTED
from warpffrf.online.stages import KINDS, Stage, check_stages, joined, with_potential
from warpffrf.output.accuracy.choose import refuse_other_options, run_to_accuracy
from warpffrf.output.accuracy.limits import Limits
from warpffrf.output.accuracy.setting import Setting
from warpffrf.output.budget.budget import largest_of_each
from warpffrf.output.files.results import SUFFIXES
from warpffrf.output.files.unfinished import ENDING
from warpffrf.output.outputs import KEEP_EVERY, Kind, Outputs
from warpffrf.output.result import Result

STARTS = ("initial", "equilibrium")
DEFAULT_INTEGRATOR = GeneralizedAlpha(rho_inf=0.8)

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
    duration: float | None = None,
    *,
    step: float | None = None,
    stages: Sequence[Stage] | None = None,
    start: str | os.PathLike[str] | Result = "initial",
    local: str | LocalDynamics = "quasi_static",
    integrator: Integrator | RungeKutta4 | EnergyMomentum | None = None,
    accuracy: float | None = None,
    step_error: float | None = None,
    energy_tolerance: float | None = None,
    save_every: int = 1,
    results: str | os.PathLike[str] | None = None,
    record: str | os.PathLike[str] | None = None,
    record_every: int | None = None,
    device: str | None = None,
    progress: bool = True,
    check: bool = False,
    project_start: bool = False,
    overwrite: bool = False,
    resume: bool = False,
    keep_every: float = KEEP_EVERY,
    kind: Literal["dynamic", "static"] = "dynamic",
) -> Result:
    """Simulate `scene` for `duration` [s] with steps of `step` [s], or simulate the `stages`.

    start: "initial" (positions and velocities of the scene), "equilibrium" (static equilibrium under load first), or
    the Result or results file of an earlier run or equilibrium of the same scene, which is continued bit for bit (to
    round-off, about 1e-9, with small-sliding contacts). Every `save_every`th step and the last step are saved.
    project_start: change initial velocities that violate the joints as little as possible and add a note, instead of
    refusing them; velocities prescribed by a drive are always imposed. stages: see `warpffrf.online.stages`; the
    function then returns a StagedResult. integrator: GeneralizedAlpha, HHT or Newmark; RungeKutta4 and EnergyMomentum
    for checks on free bodies; None: GeneralizedAlpha(rho_inf=0.8). accuracy: required relative error of forces, motions
    and deformations (0.01 for 1 %; pressures may err by twice as much). Step, inertia levels, stiffening, contact grids
    and cells are chosen from the error budgets of coarse runs (`warpffrf.output.accuracy`); the notes state the
    choices, their reasons, and what only another reduction could improve. `step` may be omitted; if given it is the
    largest step. Settings made in the scene are kept, and the scene is not modified: continue with `result.scene`.
    step_error: halve steps whose local error exceeds this value (positions relative to the radius of gyration,
    rotations in rad; stiff local modes are excluded); `step` is then the largest step. energy_tolerance: relative
    energy gain [-] of an impact step above which the step is halved; default 2.5e-4. local: treatment of the local
    modes, "quasi_static", "hht", "exponential", "auto" or a LocalDynamics, for bodies reduced with local_dynamics=True.
    results, record: files to write (.h5, .rrd); both are also written, with the data computed so far, if the run is
    interrupted (Ctrl-C, SIGTERM) or fails; files that cannot be written are listed in `unwritten` of the Result and in
    its notes. A script continues with an interrupted result: after Ctrl-C it may start further runs, after SIGTERM it
    exits (exit code 143) when it would start another run. record_every: number of saved steps per frame of the
    recording; None: at most 300 frames. device: "cpu" or "cuda:0"; None: the environment variable WARPFFRF_DEVICE, else
    the CPU. progress: report the progress and the notes of the run on stderr, as bars on a terminal and as lines
    elsewhere; only through `logging` if the application has configured it. With stages, results "run.h5" also writes
    "run.NAME.h5" at the end of each stage, a checkpoint to start from. A failing solver does not raise, see `status`
    and `message` of the Result; with check, a run that does not complete raises `RunError`, whose `result` has the data
    computed, after its files were written. Wrong input raises InputError before the run. Threads may call this function
    concurrently and obtain the same bits: steps run in parallel, everything else one after the other
    (`warpffrf.online.turn`).

    overwrite: replace files of an earlier run; otherwise existing files are refused. Files that warpffrf did not write
    are always refused. During the run, completed parts are saved to the folder `run.h5.unfinished` every `keep_every`
    [s] of wall time by a separate thread (less often if a checkpoint takes more than 2 % of that time). resume:
    continue from this folder, or from an interrupted run, with the same options, bit for bit as if it had not been
    stopped (to round-off with small-sliding contacts), with every integrator; a finished run is read, and a run without
    a folder is started.

    kind: "dynamic", or "static" for equilibria at the end of every step, under the forces and prescribed motions of
    that time, with the friction history (`warpffrf.online.load_steps`); stages have their own kind.

    >>> result = wf.simulate(scene, 2e-3, step=2e-4, start="equilibrium", results="press.h5", progress=False)
    >>> result.status
    'completed'
    """
    known_scene(scene, "simulate")
    as_local_dynamics(local)
    known_integrator(integrator, "simulate")
    known("kind", kind, KINDS)
    if kind == "static":
        refuse_in_statics(
            "simulate", integrator=integrator, step_error=step_error, accuracy=accuracy,
            energy_tolerance=energy_tolerance, project_start=project_start or None, stages=stages,
        )  # fmt: skip
    if resume and results is None:
        raise InputError("simulate: resume continues from the files of a run; give results")
    require_number(keep_every, "simulate: keep_every", positive=True)
    if record_every is not None:
        require_count(record_every, "simulate: record_every", 1, most=MOST_COUNTED)
    beginning = _start(scene, start)
    outputs = Outputs(overwrite, resume, keep_every)
    outputs.check(results, record)
    limits = None
    if accuracy is not None:
        limits = Limits.of(accuracy)
        refuse_other_options(
            stages=stages, step_error=step_error, fixed=isinstance(integrator, CHECK_INTEGRATORS), resume=resume
        )  # fmt: skip
    options = {"integrator": integrator, "save_every": save_every, "device": device, "progress": progress}
    options |= {"project_start": project_start, "local": local, "step_error": step_error}
    if kind == "static":
        options["kind"] = kind
    if energy_tolerance is not None:
        options["energy_tolerance"] = require_number(energy_tolerance, "simulate: energy_tolerance", positive=True)
    with terminated_as_interrupted(), speaking(progress):
        if stages is None:
            if limits is not None and duration is not None:
                found = _accurate(scene, beginning, duration, step, limits, options, outputs, results)
                return checked(outputs.record(found, record, record_every, progress), check)
            if duration is None or step is None:
                raise InputError(
                    "simulate: give duration and step, or stages=[Stage(name, duration, step), ...], or duration and "
                    "accuracy="
                )
            found = outputs.run(scene, _run, beginning, duration, step, options, results)
            return checked(outputs.record(found, record, record_every, progress), check)
        if duration is not None or step is not None:
            raise InputError("simulate: stages have their own duration and step; leave those of the run out")
        found = _staged(scene, check_stages(scene, stages), beginning, results, options, outputs)
        return checked(outputs.record(found, record, record_every, progress), check)


def _run(
    scene: Any, duration: float, *, integrator: Any, energy_tolerance: float | None = None, kind: str = "dynamic",
    **options: Any,
) -> History:  # fmt: skip
    """Run `scene` by its kind, dynamic or static."""
    log.info("%s", _what_is_run(scene, duration, options["step"], options["start"], kind))
    if kind == "static":
        own = {name: value for name, value in options.items() if name not in ("step_error", "project_start")}
        return run_static(scene, duration, **own)
    if energy_tolerance is not None:
        if isinstance(integrator, CHECK_INTEGRATORS):
            raise InputError("simulate: energy_tolerance halves steps, which this integrator cannot; leave it out")
        options["settings"] = Settings(energy_tolerance=energy_tolerance)
    return run(scene, duration, integrator=DEFAULT_INTEGRATOR if integrator is None else integrator, **options)


def _what_is_run(scene: Any, duration: Any, step: Any, start: Any, kind: str) -> str:
    """One line that describes the run that starts."""
    holds = _holds(scene)
    first = "the equilibrium, then " if start == "equilibrium" and kind != "static" else ""
    what = "load steps" if kind == "static" else "steps"
    return f"simulate: {holds}; {first}{duration} s in {what} of {step} s"


def _holds(scene: Any) -> str:
    """Number of items of each kind in a scene, as text."""
    kinds = {"body": scene.bodies, "joint": scene.joints, "contact": scene.finite_sliding, "film": scene.films}
    counts = [(len(items), kind) for kind, items in kinds.items() if len(items)]
    named = (f"{n} {kind if n == 1 else kind.replace('y', 'ie') + 's'}" for n, kind in counts)
    return ", ".join(named) or "an empty scene"


def refuse_in_statics(where: str, **options: Any) -> None:
    """Raises `InputError` for an option that does not apply to static runs."""
    for name, value in options.items():
        if value is not None:
            raise InputError(f"{where}: {name} is for runs in time, not for kind='static'; leave one of them out")


def _accurate(
    scene: Any, beginning: Any, duration: float, step: float | None, limits: Limits, options: dict[str, Any],
    outputs: Outputs, results: Any,
) -> Result:  # fmt: skip
    """Run whose error budget is within the limits."""
    require_number(duration, "simulate: duration", positive=True)
    if step is not None:
        require_number(step, "simulate: step", positive=True)

    def one(setting: Setting) -> History:
        own = {**options, "local": setting.local, "energy_tolerance": setting.energy_tolerance}
        return _run(setting.scene(scene), duration, step=duration / setting.steps, start=beginning, **own)

    with outputs.locked(results) as whole:
        return whole.written(
            run_to_accuracy(
                scene,
                duration,
                limits,
                step,
                one,
                local=options["local"],
                energy_tolerance=options.get("energy_tolerance"),
                start=beginning,
                progress=options["progress"],
            )  # fmt: skip
        )


def _staged(
    scene: Any, stages: list[Stage], beginning: Any, results: Any, options: dict[str, Any], outputs: Outputs
) -> StagedResult:
    """The stages in sequence, each from the checkpoint of the previous stage."""
    for stage in stages:
        as_local_dynamics(stage.options.get("local", options["local"]))
        known_integrator(stage.options.get("integrator"), f"stage {stage.name!r}")
        if results is not None:
            outputs.check(stage_file(results, stage.name), None)
    refuse_other_modes(scene, stages, options["local"])
    end = time_of(beginning.checkpoint) if isinstance(beginning, History) else 0.0
    for stage in stages:
        begin, end = end, end + stage.duration
        refuse_short_signals(stage.scene(scene), begin, end)
    parts: dict[str, Result] = {}
    interrupted = ""
    with outputs.locked(results) as whole:
        for stage in stages:
            log.info("stage %s: %g s in steps of %g s", stage.name, stage.duration, stage.step)
            own = {name: value for name, value in stage.options.items() if name in options}
            if stage.kind == "static":
                own |= {"kind": stage.kind, "integrator": None, "step_error": None, "project_start": False}
            file = None if results is None else stage_file(results, stage.name)
            run_stage = _in_its_loads(scene, stage.scene(scene))
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
            if part.status != "completed":
                break
        found = StagedResult(joined([part.history for part in parts.values()], list(parts)), parts)
        if interrupted:
            found.history.status, found.history.message, found.history.stopping = INTERRUPTED, interrupted, True
        return whole.written(found)


def _in_its_loads(scene: Any, staged: Any) -> Callable[..., History]:
    """`_run` of the scene `staged`, a stage of `scene`, from and to checkpoints of `scene`."""

    def run_stage(_scene: Any, duration: float, *, start: Any, **options: Any) -> History:
        if isinstance(start, History):
            start = replace(start, checkpoint=with_potential(start.checkpoint, scene, staged))
        history = _run(staged, duration, start=start, **options)
        # the loads of a stage do not change the system: it is continued with the scene
        history.scene = scene
        history.checkpoint = with_potential(history.checkpoint, staged, scene)
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
    (`warpffrf.online.start.rub_to_rest` describes the load path that this implies). Dynamic and static runs that
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
        return checked(outputs.record(found, record, None, progress), check)


def checked(result: Kind, check: bool) -> Kind:
    """Returns `result`; raises `RunError` if `check` and the run did not complete."""
    if check and result.status != "completed":
        raise RunError(result)
    return result


def known(option: str, value: str, values: tuple[str, ...]) -> None:
    if not isinstance(value, str) or value not in values:
        raise InputError(f"simulate: {option} is {value!r}; known: {', '.join(repr(v) for v in values)}")


def known_scene(scene: Any, caller: str) -> None:
    if not hasattr(scene, "content_hash"):
        raise InputError(f"{caller}: a Scene is needed first, got {scene!r}")


def known_integrator(integrator: Any, where: str) -> None:
    if integrator is not None and not isinstance(integrator, (Integrator, *CHECK_INTEGRATORS)):
        names = ", ".join(f"integrators.{kind.__name__}()" for kind in INTEGRATORS.values())
        raise InputError(
            f"{where}: integrator must be one of {names}, or an integrators.Integrator of your own, got "
            f"{integrator!r}; names are for scene files"
        )


def _start(scene: Any, start: str | os.PathLike[str] | Result) -> Any:
    if not isinstance(start, Result):
        if start in STARTS:
            return start
        if not isinstance(start, str | os.PathLike) or Path(start).suffix.lower() not in (*SUFFIXES, ENDING):
            known = ", ".join(repr(v) for v in STARTS)
            raise InputError(f"simulate: start is {start!r}; known: {known}, a Result, or a results file (.h5)")
        start = Result.load(start)
    if start.view.content_hash != scene.content_hash():
        raise InputError(
            "simulate: start is the result of another scene (their content differs); continue with the scene that it "
            "came from, or start from 'initial'"
        )
    if not start.history.checkpoint:
        raise InputError("simulate: start has no checkpoint to continue from; run it again")
    return start.history
