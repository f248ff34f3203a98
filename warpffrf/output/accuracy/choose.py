r"""A run to a required accuracy: `simulate(..., accuracy=0.01)`.

The error budget of a run (`output.budget`) estimates the effect of each source of error without a reference run. The
machine is first run with few steps (`first`); the settings of the next run follow from the budget (`demands`), until it
requires no change; that run is the result. Because errors decrease with the square of the step, the earlier runs take a
fraction of its time:

    n_k+1 = 1.15 n_k root(error/limit)        1.2 to 3 times n_k

There are at most `RUNS` runs. If `PATIENCE` consecutive runs, each with more steps, do not reduce the error of the
step, or two leave it unchanged, further steps will not either: nodes of a rolling surface pass faster than the steps. A
contact on the nodes of the contact grid is then set back to cells; if there is none, the iteration ends, and the notes
state every error above the required accuracy with its remedy, mostly another reduction.

Choices depend only on results, never on computing time: the same call makes the same choices.

First. Initial settings of a run to a required accuracy: few steps, which resolve the time scales stated by the scene.
"""

from __future__ import annotations

import logging
import math
import time
from collections.abc import Callable
from dataclasses import replace
from typing import Any

import numpy as np

from warpffrf.model.checks.scene import quickest_rise
from warpffrf.model.contact import CELL_ERROR as USUAL_CELL_ERROR
from warpffrf.model.contact import CELL_ERRORS
from warpffrf.model.errors import InputError
from warpffrf.model.messages.status import Status
from warpffrf.model.scene import Scene
from warpffrf.online.checkpoint import time_of
from warpffrf.online.compile.inertia_plan import InertiaPlan, fastest_turning
from warpffrf.online.history.history import BudgetLine, History
from warpffrf.output.accuracy.demands import next_setting, of_the_step
from warpffrf.output.accuracy.limits import PRESSURES, Limits
from warpffrf.output.accuracy.setting import AUTO, BODY_FIXED, CELL_ERROR, GRID, INERTIA, Setting
from warpffrf.output.budget import contacts
from warpffrf.output.budget.figures import is_main
from warpffrf.output.result import Result

RUNS = 10
MOST_STEPS = 1_000_000
AFTER_FAILURE = 4  # factor of the steps after a failed run
FAILURES = 2  # consecutive failures after a successful run, which then is the result
FALLS = 0.8  # of the previous error: with 1.2 times the steps it is 0.7 at second order
STANDS = 0.05, 2  # an error that changes by less between runs, twice in a row, is not one of the step
PATIENCE = 3  # consecutive runs whose error does not decrease: vibrations first resolved by more steps may increase it

Run = Callable[[Setting], History]

log = logging.getLogger("warpffrf")


def run_to_accuracy(
    scene: Scene, duration: float, limits: Limits, longest: float | None, run: Run, *, local_modes: Any,
    energy_tolerance: float | None, start: Any, progress: bool,
) -> Result:  # fmt: skip
    """The run of `scene` over `duration` [s] that is within `limits`, or the last one that completed. longest: step [s]
    that the user allows. run: runs the scene with a setting. local_modes: the treatment that the user requested.
    energy_tolerance: that of the user, None: chosen by the program. start: initial state; a continuation of another run
    has the options of that run, and only its steps are chosen."""
    begin = time.perf_counter()
    continued = isinstance(start, History)
    at = time_of(start.checkpoint) if isinstance(start, History) else 0.0
    now = replace(first_setting(scene, at, duration, longest, local_modes, limits), energy_tolerance=energy_tolerance)
    if continued:
        now = replace(now, options={})
    refused, why = "", list[str]()
    stuck, good, failed = Stuck(), None, 0
    for number in range(1, RUNS + 1):
        own = time.perf_counter()
        result = Result(run(now))
        log.info("accuracy %g, run %d: %d steps of %.3g s: %s", limits.accuracy, number, now.steps,
                 duration / now.steps, result.status)  # fmt: skip
        if result.status == Status.INTERRUPTED:
            return _told(result, duration, limits, now, ["the run was interrupted before its errors were known"])
        if result.status != Status.COMPLETED:
            failed += 1
            more = now.steps * AFTER_FAILURE
            if number < RUNS and more <= MOST_STEPS and (good is None or failed < FAILURES):
                now = replace(now, steps=more)
                continue
            if good is None:
                return _told(result, duration, limits, now, [])
            refused = f"with {now.steps} steps the run fails ({result.status})"
            result, now, why = good
            break
        failed = 0
        lines = result.error_budget(progress=progress)
        wanted, why = next_setting(scene, result, now, lines, limits, first=number == 1)
        if energy_tolerance is not None:
            wanted = replace(wanted, energy_tolerance=energy_tolerance)
        if continued:
            wanted, why = (
                replace(wanted, local_modes=local_modes, options={}),
                [why[0], "the rest is that of the run before"],
            )
        log.info("accuracy %g: %s", limits.accuracy, "; ".join(why))
        good = result, now, why
        if wanted == now:
            break
        if stuck.look(now.steps, lines):
            wanted = _with_cells(scene, now)
            if wanted == now:
                refused = f"it does not fall with more steps, {stuck.told}"
                break
        if number == RUNS or wanted.steps > MOST_STEPS:
            refused = f"{number} runs were made, of at most {RUNS} and {MOST_STEPS} steps"
            break
        now = wanted
    result.history.counters["accuracy_runs"] = number
    result.history.counters["accuracy_seconds"] = own - begin  # of the earlier runs
    if now.energy_tolerance is not None:
        result.history.counters["energy_tolerance"] = now.energy_tolerance
    if refused:
        why.append(f"not reached: {refused}")
    if now.steps < (needed := steps_to_see(scene, at, duration)):
        why.append(
            f"signals or driven turns change so quickly that it takes {needed:.3g} steps to see all of them; give step="
        )
    return _told(result, duration, limits, now, why)


class Stuck:
    """Detects whether the error of the step decreases from run to run."""

    def __init__(self) -> None:
        self.steps, self.size, self.times, self.stood, self.told = 0, 0.0, 0, 0, ""

    def look(self, steps: int, lines: list[BudgetLine]) -> bool:
        """Evaluate the budget of a run of `steps` steps; returns whether to give up."""
        known = [line for line in of_the_step(lines) if line.found]
        if not known:
            return False
        worst = max(known, key=lambda line: line.size)
        if self.steps and steps > self.steps:
            self.times = self.times + 1 if worst.size > FALLS * self.size else 0
            self.stood = self.stood + 1 if abs(worst.size - self.size) < STANDS[0] * self.size else 0
            self.told = f"{self.size:.2%} with {self.steps} and {worst.size:.2%} with {steps} of the {worst.of}"
        self.steps, self.size = steps, worst.size
        if self.times < PATIENCE and self.stood < STANDS[1]:
            return False
        self.times = self.stood = 0
        return True


def _with_cells(scene: Scene, now: Setting) -> Setting:
    """`now` with cells for contacts that can have them and were set to nodes of the contact grid."""
    options = dict(now.options)
    for contact in scene.finite_sliding:
        if options.get((GRID, contact.name)) == BODY_FIXED:
            options[GRID, contact.name] = AUTO
    return replace(now, options=options)


def _told(result: Result, duration: float, limits: Limits, now: Setting, why: list[str]) -> Result:
    """The result with notes on the choices and their reasons, and on errors above the required accuracy."""
    head = f"accuracy {limits.accuracy:g}"
    tolerance = "" if now.energy_tolerance is None else f" with energy_tolerance={now.energy_tolerance:.2g}"
    step = f"{head}: step={duration / now.steps:.6g}{tolerance} was chosen" + (f", {why[0]}" if why else "")
    notes = [step, *(f"{head}: {line}" for line in why[1:])]
    for line in filter(is_main, result.history.budget):
        allowed = limits.accuracy * (PRESSURES if line.of.startswith(contacts.PRESSURE) else 1.0)
        if line.found and line.size > allowed:
            cure = f"; {line.cure}" if line.cure else ""
            notes.append(f"{head} is not kept: {line.source}, {line.size:.2%} of the {line.of}{cure}")
        elif not line.found:
            notes.append(f"{head} is not known to be kept: {line.source} of the {line.of}, {line.basis}; {line.cure}")
    result.history.notes[:0] = notes
    return result


def refuse_other_options(*, stages: Any, step_error: Any, fixed: bool, resume: bool) -> None:
    """Raises `InputError` for options of `simulate` that exclude accuracy=."""
    if stages is not None:
        raise InputError(
            "simulate: accuracy= is that of one run; run the stages one after the other, each from the result before "
            "(start=), with the step that its notes name"
        )
    if step_error is not None:
        raise InputError("simulate: accuracy= chooses the step and step_error= halves it; give one of the two")
    if fixed:
        raise InputError("simulate: accuracy= goes by error budgets, which integrators for checks do not make")
    if resume:
        raise InputError(
            "simulate: a run with accuracy= is not kept on the way; leave resume out, or run with the step and options "
            "that were chosen (they are in the notes and the log)"
        )


FEWEST = 64  # steps: with fewer, twice the step is not meaningful
A_RISE = 4  # steps in the fastest rise of a signal: a load between two steps would not be resolved
TURN = 0.5  # rad per step, of driven or initially rotating bodies
MOST = 4000  # steps of the first run, whatever the signals: the error of the step is then measured


def first_setting(
    scene: Scene, begin: float, duration: float, longest: float | None, local_modes: Any, limits: Limits
) -> Setting:
    """Setting of the first run, starting at `begin` [s], with the defaults of the scene. longest: largest step [s]
    allowed by the user, None for any."""
    steps = math.ceil(min(max(FEWEST, steps_to_see(scene, begin, duration)), MOST))
    if longest is not None:
        steps = max(steps, math.ceil(duration / longest * (1.0 - 1e-9)))
    options: dict[tuple[str, str], Any] = {}
    for body, plan in zip(scene.bodies, InertiaPlan.of(scene).bodies, strict=True):
        if body.level == AUTO and body.reduced is not None:
            options[INERTIA, body.name] = plan.level
    for contact in scene.finite_sliding:
        if contact.grid == AUTO:
            options[GRID, contact.name] = AUTO
        if contact.cells is None and contact.cell_error == USUAL_CELL_ERROR and contact.without_patch() is None:
            options[CELL_ERROR, contact.name] = float(np.clip(limits.force, *CELL_ERRORS))
    return Setting(steps + steps % 2, local_modes, options)


def steps_to_see(scene: Scene, begin: float, duration: float) -> float:
    """Number of steps of a run starting at `begin` [s] that resolves the signals and the rotations stated by the
    scene."""
    rise = quickest_rise(scene, begin, begin + duration)
    return duration * max(A_RISE / rise, fastest_turning(scene) / TURN)
