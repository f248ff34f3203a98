"""What a study runs of each scene: `wf.simulate`, `wf.static` or `wf.equilibrium`, with arguments."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import fields, replace
from functools import partial
from typing import Any

from warpffrf.model.errors import InputError
from warpffrf.output.options import RunOptions
from warpffrf.output.result import Result
from warpffrf.output.simulate import equilibrium, simulate, static

CALLS: dict[str, Callable[..., Result]] = {"simulate": simulate, "static": static, "equilibrium": equilibrium}
Run = tuple[str, dict[str, Any]]  # name of the call, and its arguments


def run_of(run: Any, where: str) -> Run:
    """The call and the arguments of `run`, one of `CALLS` or functools.partial of one. Raises `InputError`."""
    call = run.func if isinstance(run, partial) else run
    names = [name for name, known in CALLS.items() if known is call]
    if not names or (isinstance(run, partial) and run.args):
        raise InputError(
            f"{where}: run must be wf.simulate, wf.static or wf.equilibrium, or functools.partial(wf.simulate, "
            f"duration=..., step=...) with all arguments by name, got {run!r}"
        )
    return names[0], dict(run.keywords) if isinstance(run, partial) else {}


def combined(of_scene: Mapping[str, Any], given: Mapping[str, Any]) -> dict[str, Any]:
    """Arguments that come with a scene, and those given for all scenes, which prevail; of `options` each field that is
    not at its default."""
    found = {**of_scene, **given}
    if "options" in of_scene and "options" in given:
        found["options"] = replace(of_scene["options"], **changed(given["options"]))
    return found


def changed(options: RunOptions) -> dict[str, Any]:
    """The fields of `options` that are not at their default."""
    return {f.name: value for f in fields(options) if (value := getattr(options, f.name)) != f.default}


def with_options(arguments: Mapping[str, Any], **values: Any) -> dict[str, Any]:
    """`arguments` with other `values` in their options."""
    return {**arguments, "options": replace(arguments.get("options", RunOptions()), **values)}
