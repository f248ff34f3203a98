"""All lines of the budget of a run, and their text in a report.

If a run has more than one quantity, the report shows the largest of each source, and the largest of all sources with
its remedy; sizes below `FLOOR` are reported as such: they are below the accuracy of the estimates.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np

from warpffrf.model.friction import rubbing
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
from warpffrf.output.budget.figures import NEGLIGIBLE, UNKNOWN, is_main, part_of, with_all_figures
from warpffrf.output.budget.stresses import PEAK, stress_by_pressure, stress_lines
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
    """Whether it is a single equilibrium, or several of a machine without friction, which depend on no path."""
    history = result.history
    single = len(history.time) == 1 or not (rubbing(history.scene) or history.scene.small_sliding)
    return bool(history.samples.static and single)


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
        return (
            "it requires the process of the run, by simulate or static (result.report() before result.save()), and an "
            "integrator other than those for checks"
        )
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


def worst_lines(lines: Sequence[BudgetLine]) -> list[BudgetLine]:
    """The line with the largest effect of each source, on a deformation with a `NEGLIGIBLE` share only where there is
    no other; one that was not found likewise."""
    worst = []
    for source in dict.fromkeys(line.source for line in lines if line.source != UNKNOWN):
        every = [line for line in lines if line.source == source]
        main = [line for line in every if is_main(line) or line.of.startswith(PEAK)] or every
        own = [line for line in main if line.share >= NEGLIGIBLE] or main
        worst.append(max((line for line in own if line.found), key=lambda line: line.size, default=own[0]))
    return worst


def effect(line: BudgetLine) -> str:
    """The size of a line and the quantity that it refers to."""
    if not line.found:
        return "not found"
    return f"{percent(line.size)} of {line.of if line.of.startswith('all ') else f'the {line.of}'}"


def conclusion(worst: Sequence[BudgetLine]) -> str:
    """The largest of all sources, and its cure; "" without a size or a cure."""
    found = [line for line in worst if line.found and line.share >= NEGLIGIBLE]
    if not found:
        return ""
    largest = max(found, key=lambda line: line.size)
    if largest.size < FLOOR:
        return f"all estimates are {SMALL}"
    return f"{largest.source}, {percent(largest.size)}; cure: {largest.cure}" if largest.cure else ""


def budget_text(lines: Sequence[BudgetLine]) -> list[str]:
    """The lines of a report: the largest of each source, and the largest of all."""
    text, worst = ["error budget      largest of each source, estimated without a reference run"], worst_lines(lines)
    for line in worst:
        why = f" ({line.basis})" if line.found else f": {line.basis}" + (f"; {line.cure}" if line.cure else "")
        text.append(f"  {line.source:<27} {effect(line)}{why}")
    small = [line for line in lines if line.share < NEGLIGIBLE and line.found and line.size >= FLOOR]
    text += [f"  {'small deformations':<27} {effect(line)} ({line.source}{part_of(line.share)})" for line in small]
    said = conclusion(worst)
    return [*text, *([f"  largest                     {said}"] if said else [])]


def percent(size: float) -> str:
    """A size as text."""
    if size < FLOOR:
        return SMALL
    return f"{100.0 * size:.2g} %" if size < 0.995 else f"{np.round(100.0 * size):.0f} %"
