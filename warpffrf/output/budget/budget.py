"""All lines of the budget of a run, and how a report shows them.

Where a run leaves more than one quantity, the report shows the largest of each source, and of all sources the largest
with its cure; sizes below `FLOOR` are told as such: they are smaller than what the estimates themselves leave open.
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import numpy as np

from warpffrf.online.checkpoint import is_dynamic
from warpffrf.online.history.budget_line import BudgetLine
from warpffrf.output.budget.bodies import inertia_lines, local_lines
from warpffrf.output.budget.contacts import (
    friction_lines,
    gap_lines,
    grid_lines,
    mesh_lines,
    point_lines,
    tolerance_lines,
)
from warpffrf.output.budget.energy import energy_lines
from warpffrf.output.budget.films import film_lines
from warpffrf.output.budget.time_step import SOURCE as TIME_STEP
from warpffrf.output.budget.time_step import time_step_lines

FLOOR, SMALL = 1e-3, "< 0.1 %"


def error_budget(result: Any, *, progress: bool = False) -> list[BudgetLine]:
    """The lines of `result`, a run of this process that has left its marks. progress: show how far it is."""
    history = result.history
    engine = history.marks.engine()
    return [
        *_of_steps(history, engine, progress), *energy_lines(result),
        *grid_lines(result, engine), *gap_lines(result, engine), *friction_lines(result), *point_lines(result),
        *film_lines(history), *mesh_lines(result),
        *inertia_lines(result, engine), *local_lines(result, engine), *tolerance_lines(result, engine),
    ]  # fmt: skip


def _of_steps(history: Any, engine: Any, progress: bool) -> list[BudgetLine]:
    """Of the step of a run in time; a load step of a static run ends in an equilibrium whatever its length."""
    if not history.marks.static:
        return time_step_lines(history, engine, progress=progress)
    basis = (
        "each load step ends in an equilibrium; its length matters to the path of friction, and to works, by what the "
        "ledger leaves open"
    )
    return [BudgetLine(TIME_STEP, "all results", np.nan, basis, "run it once more with smaller load steps, to see")]


def why_not(result: Any) -> str:
    """Why there can be no budget of `result`, or "" where there can."""
    history = result.history
    if len(history.time) == 1 and history.checkpoint and not is_dynamic(history.checkpoint):
        return "an equilibrium has no steps whose errors it would state; compare with finer meshes and grids"
    if history.marks is None:
        return "it takes the run itself, by the separated method and in the process that made it"
    if len(history.time) < 2:
        return "no step was saved"
    return ""


def largest_of_each(lines: Sequence[BudgetLine]) -> list[BudgetLine]:
    """Of each source and quantity the line with the largest size, of several runs one after the other."""
    found: dict[tuple[str, str], BudgetLine] = {}
    for line in lines:
        key = line.source, line.of
        if key not in found or not found[key].found or (line.found and line.size > found[key].size):
            found[key] = line
    return list(found.values())


def budget_text(lines: Sequence[BudgetLine]) -> list[str]:
    """The lines of a report: the largest of each source, and the largest of all."""
    text = ["error budget      largest of each source, found without a run to compare with"]
    largest = []
    for source in dict.fromkeys(line.source for line in lines):
        own = [line for line in lines if line.source == source]
        found = [line for line in own if line.found]
        if not found:
            text.append(f"  {source:<27} not found: {own[0].basis}" + (f"; {own[0].cure}" if own[0].cure else ""))
            continue
        worst = max(found, key=lambda line: line.size)
        largest.append(worst)
        text.append(f"  {source:<27} {percent(worst.size)} of the {worst.of} ({worst.basis})")
    if largest:
        worst = max(largest, key=lambda line: line.size)
        if worst.size >= FLOOR and worst.cure:
            text.append(f"  largest                     {worst.source}, {percent(worst.size)}; cure: {worst.cure}")
        elif worst.size < FLOOR:
            text.append(f"  largest                     all that were found are {SMALL}")
    return text


def percent(size: float) -> str:
    """A size in words."""
    if size < FLOOR:
        return SMALL
    return f"{100.0 * size:.2g} %" if size < 0.995 else f"{np.round(100.0 * size):.0f} %"
