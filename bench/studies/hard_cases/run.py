"""One run of a case with a setting, and the row that is kept of it."""

from __future__ import annotations

import time
from collections.abc import Callable
from dataclasses import dataclass, field, replace
from typing import Any

import numpy as np

from studies.hard_cases.case import Case, Finding, Setting
from studies.hard_cases.classes import FAIL, REFUSED, Verdict, judge
from studies.hard_cases.memory import MemoryWatch
from warpffrf.model.errors import InputError
from warpffrf.model.messages.status import Status
from warpffrf.online import Settings
from warpffrf.online.run import run
from warpffrf.output.result import Result
from warpffrf.output.simulate import simulate

CRASHES = (ArithmeticError, ValueError, LookupError, TypeError, RuntimeError, MemoryError)


@dataclass
class Row:
    """What came of a run: its class and why, the worst comparison with its limits, all of them [name, error, good,
    bad], notes of the run, steps taken and halved, seconds."""

    case: str
    column: str
    kind: str
    why: str
    findings: list[list[Any]] = field(default_factory=list)
    notes: list[str] = field(default_factory=list)
    simulated: float = 0.0
    steps: int = 0
    halved: int = 0
    seconds: float = 0.0

    def plain(self) -> dict[str, Any]:
        """As plain data."""
        return dict(vars(self))


def run_case(case: Case, setting: Setting) -> tuple[Result | None, Row]:
    """One run, judged; the result is None where the input was refused or the program broke down. Raises
    KeyboardInterrupt where the run was interrupted."""
    begin = time.perf_counter()
    result = None
    try:
        with MemoryWatch() as memory:
            result = _run(case, setting, case.build)
        twin = None if case.twin is None else _run(*_same_steps(case, setting, result), _alike(case.twin, result))
    except InputError as error:
        verdict = Verdict(REFUSED, str(error))
    except CRASHES as error:
        verdict = Verdict(FAIL, f"{type(error).__name__}: {error}")
    else:
        own = _own(case, result, twin)
        if case.memory is not None and np.isfinite(memory.grown):
            own.append(Finding("memory grown by [MB]", memory.grown, *case.memory))
        verdict = judge(result, own, case.ledger, case.said)
    row = Row(case.name, setting.column, verdict.kind, verdict.why, seconds=time.perf_counter() - begin)
    row.findings = [[f.of, float(f.error), f.good, f.bad] for f in verdict.findings]
    if result is not None:
        row.notes = list(result.history.notes)
        row.simulated = float(result.time[-1]) if len(result.time) else 0.0
        row.steps = int(result.history.counters["steps"])
        row.halved = int(result.history.counters["rejected_steps"])
    return result, row


def _same_steps(case: Case, setting: Setting, result: Result) -> tuple[Case, Setting]:
    """The case and setting of a run that is compared with one of `setting`, which has found its own step: as many steps
    of that size, with the energy tolerance that it found."""
    if setting.accuracy is None or len(result.time) < 2:
        return case, setting
    steps = len(result.time) - 1
    step = float(result.time[-1]) / steps
    energy = result.history.counters.get("energy_tolerance", setting.energy)
    return replace(case, most_steps=steps, rows=steps), replace(setting, accuracy=None, step=step, energy=energy)


def _alike(build: Callable[[], Any], result: Result) -> Callable[[], Any]:
    """What makes a scene, with what bodies and contacts of those names have in the scene of `result`: a run to an
    accuracy has chosen it."""

    def built() -> Any:
        scene, chosen = build(), result.history.scene
        for items, others, options in (
            (scene.bodies, chosen.bodies, ("level", "stiffening")),
            (scene.contacts, chosen.contacts, ("grid", "kinematics", "cell_error")),
        ):
            by_name = {other.name: other for other in others}
            for item in items:
                for option in options if item.name in by_name else ():
                    setattr(item, option, getattr(by_name[item.name], option))
        return scene

    return built


def _run(case: Case, setting: Setting, build: Callable[[], Any]) -> Result:
    if setting.accuracy is not None:
        result = simulate(build(), case.duration, accuracy=setting.accuracy, progress=False,
                          start=case.options.get("start", "initial"))  # fmt: skip
        if result.status == Status.INTERRUPTED:
            raise KeyboardInterrupt
        return result
    steps = case.step_count(setting.step)
    history = run(
        build(), steps * setting.step, step=setting.step, save_every=-(-steps // case.rows), step_error=setting.error,
        settings=Settings(residual_tolerance=setting.tolerance, energy_tolerance=setting.energy), progress=False,
        **case.options,
    )  # fmt: skip
    if history.status == Status.INTERRUPTED:
        raise KeyboardInterrupt
    return Result(history)


def _own(case: Case, result: Result, twin: Result | None) -> list[Finding]:
    """The case's comparisons of runs that were completed."""
    if result.status != "completed":
        return []
    found = list(case.check(result))
    if twin is not None and case.alike is not None:
        if twin.status != result.status or len(twin.time) != len(result.time):
            return [*found, Finding("end of the twin", float("nan"), 0.0, 0.0)]
        found += case.alike(result, twin)
    return found
