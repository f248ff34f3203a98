"""One run of a case with a setting, and the row that is kept of it."""

from __future__ import annotations

import time
from dataclasses import dataclass, field
from typing import Any

from warpffrf.model.errors import InputError
from warpffrf.online import Settings
from warpffrf.online.run import INTERRUPTED, run
from warpffrf.output.result import Result
from warpffrf.study.hard_cases.case import Case, Setting
from warpffrf.study.hard_cases.classes import FAIL, REFUSED, Verdict, judge

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
    steps = case.step_count(setting.step)
    every = -(-steps // case.rows)
    result = None
    try:
        scene = case.build()
        settings = Settings(residual_tolerance=setting.tolerance, energy_tolerance=setting.energy)
        history = run(
            scene, steps * setting.step, step=setting.step, save_every=every, accuracy=setting.error,
            settings=settings, progress=False, **case.options,
        )  # fmt: skip
        if history.status == INTERRUPTED:
            raise KeyboardInterrupt
        result = Result(history)
        own = case.check(result) if history.status == "completed" else []
        verdict = judge(result, own, case.ledger)
    except InputError as error:
        verdict = Verdict(REFUSED, str(error))
    except CRASHES as error:
        verdict = Verdict(FAIL, f"{type(error).__name__}: {error}")
    row = Row(case.name, setting.column, verdict.kind, verdict.why, seconds=time.perf_counter() - begin)
    row.findings = [[f.of, float(f.error), f.good, f.bad] for f in verdict.findings]
    if result is not None:
        row.notes = list(result.history.notes)
        row.simulated = float(result.time[-1]) if len(result.time) else 0.0
        row.steps = int(result.history.counters["steps"])
        row.halved = int(result.history.counters["rejected_steps"])
    return result, row
