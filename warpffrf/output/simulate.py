"""`simulate` and `equilibrium` as users call them: check the outputs, run, wrap, write."""

from __future__ import annotations

import logging
import os
from collections.abc import Sequence
from dataclasses import replace
from pathlib import Path
from typing import Any

from warpffrf.model.errors import InputError
from warpffrf.online import GeneralizedAlpha, find_equilibrium, run
from warpffrf.online.history import History
from warpffrf.online.stages import Stage, check_stages, joined, with_gravity
from warpffrf.output.paths import checked_output_path
from warpffrf.output.result import Result

METHODS = ("separated",)
LOCAL_TREATMENTS = ("quasi_static",)
STARTS = ("initial", "equilibrium")
RESULTS_SUFFIXES = (".h5", ".hdf5")
DEFAULT_INTEGRATOR = GeneralizedAlpha(rho_inf=0.8)

log = logging.getLogger("warpffrf")


class StagedResult(Result):
    """The result of a whole run in stages; `stages` holds the result of each, name -> Result, to start another from."""

    def __init__(self, history: Any, stages: dict[str, Result]) -> None:
        super().__init__(history)
        self.stages = stages


def simulate(
    scene: Any,
    duration: float | None = None,
    *,
    step: float | None = None,
    stages: Sequence[Stage] | None = None,
    start: str | os.PathLike[str] | Result = "initial",
    method: str = "separated",
    local: str = "quasi_static",
    integrator: GeneralizedAlpha = DEFAULT_INTEGRATOR,
    save_every: int = 1,
    results: str | os.PathLike[str] | None = None,
    record: str | os.PathLike[str] | None = None,
    device: str = "cpu",
    progress: bool = True,
) -> Result:
    """Simulate `scene` for `duration` [s] with steps of `step` [s], or in `stages` instead of the two.

    start: "initial" (positions and velocities of the scene), "equilibrium" (static state under load first), or the
    Result, or results file, of an earlier run or equilibrium of the same scene, which is continued bit for bit. stages:
    see `warpffrf.online.stages`; returns a StagedResult. results, record: files to write (.h5, .rrd); both are also
    written when the run is interrupted (Ctrl-C) or fails, with what there is. With stages, results "run.h5" also means
    "run.NAME.h5" at the end of each stage: a checkpoint to start from. A solver that fails does not raise: see `status`
    and `message` of the Result. Wrong input raises InputError before the run.
    """
    _known_scene(scene, "simulate")
    _known("method", method, METHODS)
    _known("local", local, LOCAL_TREATMENTS)
    _known_integrator(integrator, "simulate")
    beginning = _start(scene, start)
    _check_outputs(results, record)
    options = {"integrator": integrator, "save_every": save_every, "device": device, "progress": progress}
    if stages is None:
        if duration is None or step is None:
            raise InputError("simulate: give duration and step, or stages=[Stage(name, duration, step), ...]")
        return _written(Result(run(scene, duration, step=step, start=beginning, **options)), results, record)
    if duration is not None or step is not None:
        raise InputError("simulate: stages have their own duration and step; leave those of the run out")
    return _written(_staged(scene, check_stages(scene, stages), beginning, results, options), results, record)


def _staged(scene: Any, stages: list[Stage], beginning: Any, results: Any, options: dict[str, Any]) -> StagedResult:
    """The stages one after the other, each from the checkpoint of the one before."""
    for stage in stages:
        for name, values in (("method", METHODS), ("local", LOCAL_TREATMENTS)):
            _known(name, stage.options.get(name, values[0]), values)
        _known_integrator(stage.options.get("integrator", DEFAULT_INTEGRATOR), f"stage {stage.name!r}")
        if results is not None:
            checked_output_path(stage_file(results, stage.name), "results")
    parts: dict[str, Result] = {}
    for stage in stages:
        log.info("stage %s: %g s in steps of %g s", stage.name, stage.duration, stage.step)
        own = {name: value for name, value in stage.options.items() if name in options}
        staged = stage.scene(scene)
        if isinstance(beginning, History):
            loaded = with_gravity(beginning.checkpoint, scene, scene.gravity, staged.gravity)
            beginning = replace(beginning, checkpoint=loaded)
        history = run(staged, stage.duration, step=stage.step, start=beginning, **{**options, **own})
        # loads of one stage do not make another machine: it is continued with the scene
        history.scene = scene
        history.checkpoint = with_gravity(history.checkpoint, scene, staged.gravity, scene.gravity)
        parts[stage.name] = Result(history)
        if results is not None:
            log.info("results: %s", parts[stage.name].save(stage_file(results, stage.name)))
        beginning = history
        if history.status != "completed":
            break
    return StagedResult(joined([part.history for part in parts.values()], list(parts)), parts)


def stage_file(results: str | os.PathLike[str], name: str) -> Path:
    """Where the results of the stage called `name` go: run.h5 -> run.NAME.h5."""
    path = Path(results)
    return path.with_name(f"{path.stem}.{name}{path.suffix or '.h5'}")


def equilibrium(
    scene: Any,
    *,
    results: str | os.PathLike[str] | None = None,
    record: str | os.PathLike[str] | None = None,
    device: str = "cpu",
) -> Result:
    """The static state of `scene` under its loads and prescribed motions at time 0, as a Result with one row.

    Not converging is a status, not an exception; wrong input raises InputError.
    """
    _known_scene(scene, "equilibrium")
    _check_outputs(results, record)
    return _written(Result(find_equilibrium(scene, device=device)), results, record)


def _known(option: str, value: str, values: tuple[str, ...]) -> None:
    if value not in values:
        raise InputError(f"simulate: {option} is {value!r}; known: {', '.join(repr(v) for v in values)}")


def _known_scene(scene: Any, caller: str) -> None:
    if not hasattr(scene, "content_hash"):
        raise InputError(f"{caller}: a Scene is needed first, got {scene!r}")


def _known_integrator(integrator: Any, where: str) -> None:
    if not isinstance(integrator, GeneralizedAlpha):
        raise InputError(f"{where}: integrator must be GeneralizedAlpha(rho_inf=...), got {integrator!r}")


def _start(scene: Any, start: str | os.PathLike[str] | Result) -> Any:
    if not isinstance(start, Result):
        if start in STARTS:
            return start
        if not isinstance(start, str | os.PathLike) or Path(start).suffix.lower() not in RESULTS_SUFFIXES:
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


def _check_outputs(results: Any, record: Any) -> None:
    if results is not None:
        checked_output_path(results, "results")
    if record is not None:
        checked_output_path(record, "record")


def _written(result: Result, results: Any, record_path: Any) -> Result:
    """Write the wanted files; a run that ended early is written as well, one without any row is not recorded."""
    if result.status != "completed":
        log.warning("run ended early: %s: %s", result.status, result.message)
    if results is not None:
        log.info("results: %s", result.save(results))
    if record_path is not None and len(result.time):
        from warpffrf.output.recorder import record

        info = record(result, record_path)
        log.info("recording: %s, %d frames, stride %d", info.path, info.frames, info.stride)
    return result
