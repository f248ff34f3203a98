"""All lines of the budget of a run, and their text in a report.

If a run has more than one quantity, the report shows the largest of each source, and the largest of all sources with
its remedy; sizes below `FLOOR` are reported as such: they are below the accuracy of the estimates.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np

from warpffrf.online.engine import Engine
from warpffrf.online.history.history import BudgetLine
from warpffrf.output.budget.contacts import (
    energy_lines,
    film_lines,
    friction_lines,
    gap_lines,
    grid_lines,
    inertia_lines,
    local_lines,
    mesh_lines,
    point_lines,
    tolerance_lines,
)
from warpffrf.output.budget.figures import UNKNOWN, is_main, with_all_figures
from warpffrf.output.budget.stresses import stress_by_pressure, stress_lines
from warpffrf.output.budget.time_step import SOURCE as TIME_STEP
from warpffrf.output.budget.time_step import time_step_lines

FLOOR, SMALL = 1e-3, "< 0.1 %"


@dataclass(frozen=True)
class Run:
    """Input of a source: the result of a run, its engine rebuilt, and whether to show progress."""

    result: Any
    engine: Engine
    progress: bool = False


# Each source is a file of its own that returns lines of its effect on quantities, by the names of `quantities` and
# `figures`. Effects on the force of a contact are propagated to the other quantities of that contact.
SOURCES: tuple[Callable[[Run], list[BudgetLine]], ...] = (
    lambda run: _of_steps(run),
    lambda run: [] if at_rest(run.result) else energy_lines(run.result),
    lambda run: grid_lines(run.result, run.engine),
    lambda run: gap_lines(run.result, run.engine),
    lambda run: friction_lines(run.result),
    lambda run: point_lines(run.result),
    lambda run: film_lines(run.result.history),
    lambda run: mesh_lines(run.result),
    lambda run: stress_lines(run.result),
    lambda run: inertia_lines(run.result, run.engine),
    lambda run: [] if run.result.history.samples.static else local_lines(run.result, run.engine),
    lambda run: tolerance_lines(run.result, run.engine),
)


def error_budget(result: Any, *, progress: bool = False) -> list[BudgetLine]:
    """The lines of `result`, a run of this process with recorded marks. progress: report the progress."""
    run = Run(result, result.history.samples.engine(), progress)
    lines = with_all_figures(result, [line for source in SOURCES for line in source(run)])
    return [*lines, *stress_by_pressure(lines)]


def at_rest(result: Any) -> bool:
    """Whether it is a single equilibrium."""
    return bool(result.history.samples.static and len(result.history.time) == 1)


def _of_steps(run: Run) -> list[BudgetLine]:
    """Lines of the step of a run in time; a load step of a static run ends in an equilibrium for any length, and a
    single equilibrium has no step."""
    if at_rest(run.result):
        return []
    history = run.result.history
    if not history.samples.static:
        return time_step_lines(history, run.result.view, run.engine, progress=run.progress)
    basis = (
        "each load step ends in an equilibrium; its length matters to the path of friction, and to works, by what the "
        "ledger leaves open"
    )
    return [BudgetLine(TIME_STEP, "all results", np.nan, basis, "repeat the run with smaller load steps")]


def why_not(result: Any) -> str:
    """The reason why there is no budget of `result`, or ""."""
    history = result.history
    if history.samples is None or not hasattr(history.scene, "contacts"):
        return "it requires the process of the run, and an integrator other than those for checks"
    if len(history.time) < (1 if history.samples.static else 2):
        return "no step was saved"
    return ""


def largest_of_each(lines: Sequence[BudgetLine]) -> list[BudgetLine]:
    """The largest line of each source and quantity, over several consecutive runs."""
    found: dict[tuple[str, str], BudgetLine] = {}
    for line in lines:
        key = line.source, line.of
        if key not in found or not found[key].found or (line.found and line.size > found[key].size):
            found[key] = line
    return list(found.values())


def budget_text(lines: Sequence[BudgetLine]) -> list[str]:
    """The lines of a report: the largest of each source, and the largest of all."""
    text = ["error budget      largest of each source, estimated without a reference run"]
    largest = []
    for source in dict.fromkeys(line.source for line in lines if line.source != UNKNOWN):
        every = [line for line in lines if line.source == source]
        own = [line for line in every if is_main(line)] or every
        found = [line for line in own if line.found]
        if not found:
            text.append(f"  {source:<27} not found: {own[0].basis}" + (f"; {own[0].cure}" if own[0].cure else ""))
            continue
        worst = max(found, key=lambda line: line.size)
        largest.append(worst)
        text.append(f"  {source:<27} {percent(worst.size)} of {_named(worst.of)} ({worst.basis})")
    if largest:
        worst = max(largest, key=lambda line: line.size)
        if worst.size >= FLOOR and worst.cure:
            text.append(f"  largest                     {worst.source}, {percent(worst.size)}; cure: {worst.cure}")
        elif worst.size < FLOOR:
            text.append(f"  largest                     all estimates are {SMALL}")
    return text


def _named(quantity: str) -> str:
    """The quantity as text."""
    return quantity if quantity.startswith("all ") else f"the {quantity}"


def percent(size: float) -> str:
    """A size as text."""
    if size < FLOOR:
        return SMALL
    return f"{100.0 * size:.2g} %" if size < 0.995 else f"{np.round(100.0 * size):.0f} %"
