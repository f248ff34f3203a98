"""`simulate` and `equilibrium` as users call them: check the outputs, run, wrap, write."""

from __future__ import annotations

import logging
import os
from typing import Any

from warpffrf.model.errors import InputError
from warpffrf.online import GeneralizedAlpha, find_equilibrium, run
from warpffrf.output.paths import checked_output_path
from warpffrf.output.result import Result

METHODS = ("separated",)
LOCAL_TREATMENTS = ("quasi_static",)
STARTS = ("initial", "equilibrium")
DEFAULT_INTEGRATOR = GeneralizedAlpha(rho_inf=0.8)

log = logging.getLogger("warpffrf")


def simulate(
    scene: Any,
    duration: float,
    *,
    step: float,
    start: str | Result = "initial",
    method: str = "separated",
    local: str = "quasi_static",
    integrator: GeneralizedAlpha = DEFAULT_INTEGRATOR,
    save_every: int = 1,
    results: str | os.PathLike[str] | None = None,
    record: str | os.PathLike[str] | None = None,
    device: str = "cpu",
    progress: bool = True,
) -> Result:
    """Simulate `scene` for `duration` [s] with steps of `step` [s].

    start: "initial" (positions and velocities of the scene), "equilibrium" (static state under load first), or the
    Result of an earlier run of the same scene, which is continued bit for bit. results, record: files to write (.h5,
    .rrd); both are also written when the run is interrupted (Ctrl-C) or fails, with what there is. A solver that
    fails does not raise: see `status` and `message` of the Result. Wrong input raises InputError before the run.
    """
    _known("method", method, METHODS)
    _known("local", local, LOCAL_TREATMENTS)
    beginning = _start(scene, start)
    _check_outputs(results, record)
    history = run(
        scene,
        duration,
        step=step,
        start=beginning,
        integrator=integrator,
        save_every=save_every,
        device=device,
        progress=progress,
    )
    return _written(Result(history), results, record)


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
    _check_outputs(results, record)
    return _written(Result(find_equilibrium(scene, device=device)), results, record)


def _known(option: str, value: str, values: tuple[str, ...]) -> None:
    if value not in values:
        raise InputError(f"simulate: {option} is {value!r}; known: {', '.join(repr(v) for v in values)}")


def _start(scene: Any, start: str | Result) -> Any:
    if not isinstance(start, Result):
        _known("start", start, STARTS)
        return start
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
