r"""A run to a wanted accuracy: `simulate(..., accuracy=0.01)`.

The error budget of a run (`output.budget`) says of each source what it does, without a run to compare with. So the
machine is run with few steps first (`first`), and what its budget asks for is chosen for the next (`demands`), until a
budget asks for nothing more; that run is the result. As errors fall with the square of the step, the runs before it
take a part of its time:

    n_k+1 = 1.15 n_k root(error/limit)        1.2 to 3 times n_k

At most `RUNS` are made. Where `PATIENCE` of them in turn, each with more steps, do not lower the error of the step, or
two leave it as it is, more would not either: hats of a surface that rolls pass faster than the steps. A contact that
was put on hats then gets its cells back; if there is none, the run ends there, and its result says so, as it says of
all else that is above the wanted accuracy, with what would lower it: mostly another reduction.

Choices follow from results alone, never from the clock: the same call chooses the same again.

First. What a run to a wanted accuracy begins with: few steps, which still see what the scene says of its time.
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
from warpffrf.output.accuracy.setting import AUTO, CELL_ERROR, GRID, HATS, INERTIA, Setting
from warpffrf.output.budget import contacts
from warpffrf.output.budget.figures import is_main
from warpffrf.output.result import Result

RUNS = 10
MOST_STEPS = 1_000_000
AFTER_FAILURE = 4  # times the steps, where a run does not get through
FAILURES = 2  # in turn, after a run that got through, which then is the result
FALLS = 0.8  # of the error before: with 1.2 times the steps it is 0.7 at second order
STANDS = 0.05, 2  # an error that changes by less from run to run, twice in turn, is not one of the step
PATIENCE = 3  # runs in turn whose error does not fall: vibrations that more steps begin to see let it rise

Run = Callable[[Setting], History]

log = logging.getLogger("warpffrf")


def run_to_accuracy(
    scene: Scene, duration: float, limits: Limits, longest: float | None, run: Run, *, local_modes: Any,
    energy_tolerance: float | None, start: Any, progress: bool,
) -> Result:  # fmt: skip
    """The run of `scene` over `duration` [s] that is within `limits`, or the last one that got through. longest:
    step [s] that the user allows. run: makes a run of the scene with a setting. local_modes: the treatment
    that the user asked for. energy_tolerance: that of the user, None: left to the program. start: where it begins;
    one that goes on from another run has the options of that, and only its steps are chosen."""
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
    result.history.counters["accuracy_seconds"] = own - begin  # of the runs before
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
    """Whether the error of the step falls from run to run."""

    def __init__(self) -> None:
        self.steps, self.size, self.times, self.stood, self.told = 0, 0.0, 0, 0, ""

    def look(self, steps: int, lines: list[BudgetLine]) -> bool:
        """Look at the budget of a run of so many `steps`; whether it is time to give up."""
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
    """`now` with cells again for contacts that could have them and were put on hats."""
    options = dict(now.options)
    for contact in scene.contacts:
        if options.get((GRID, contact.name)) == HATS:
            options[GRID, contact.name] = AUTO
    return replace(now, options=options)


def _told(result: Result, duration: float, limits: Limits, now: Setting, why: list[str]) -> Result:
    """The result with what was chosen for it and why, and what is above the wanted accuracy."""
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
    """Raises `InputError` for what `simulate` does not take beside accuracy=."""
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


FEWEST = 64  # steps: below, twice the step says little
A_RISE = 4  # steps in the quickest rise of a signal: a load that begins and ends between two steps is not seen
TURN = 0.5  # rad in a step, of what is driven or turns at the start
MOST = 4000  # steps of the first run, whatever signals say: the error of the step is measured then


def first_setting(
    scene: Scene, begin: float, duration: float, longest: float | None, local_modes: Any, limits: Limits
) -> Setting:
    """Of a run from `begin` [s] on, with what the scene itself would take. longest: step [s] that the user allows, None
    for any."""
    steps = math.ceil(min(max(FEWEST, steps_to_see(scene, begin, duration)), MOST))
    if longest is not None:
        steps = max(steps, math.ceil(duration / longest * (1.0 - 1e-9)))
    options: dict[tuple[str, str], Any] = {}
    for body, plan in zip(scene.bodies, InertiaPlan.of(scene).bodies, strict=True):
        if body.level == AUTO and body.reduced is not None:
            options[INERTIA, body.name] = plan.level
    for contact in scene.contacts:
        if contact.grid == AUTO:
            options[GRID, contact.name] = AUTO
        if contact.cells is None and contact.cell_error == USUAL_CELL_ERROR and contact.without_patch() is None:
            options[CELL_ERROR, contact.name] = float(np.clip(limits.force, *CELL_ERRORS))
    return Setting(steps + steps % 2, local_modes, options)


def steps_to_see(scene: Scene, begin: float, duration: float) -> float:
    """Steps of a run from `begin` [s] on that see what signals do, and what the scene states of its turning."""
    rise = quickest_rise(scene, begin, begin + duration)
    return duration * max(A_RISE / rise, fastest_turning(scene) / TURN)
