"""What the error budget of a run asks for: other options of bodies and contacts, another step.

    inertia level    the least that keeps every term above the limit (`online.diagnosis.indicator`)
    stiffening       where the deformed inertia, which is of its size, is above the limit
    contact grid     hats of the material grid where they are right enough (`budget.contacts.hats_error`), else cells
    cells            smaller ones, where other cells differ by more than the limit
    step             h (limit/error)^(1/2), of second order

Options that the user has set are kept: an inertia level other than "auto", a grid other than "auto", stiffening. What
has been chosen once is only ever made finer, so that runs do not swing between two settings; a run whose budget asks
for nothing finer is the result, even where something coarser would have done, for it is there. Friction has no rule
that says how hats err: such contacts keep their grid. The treatment of local modes stays as it is: faces that have mass
chatter in an impact, with forces that do not settle with shorter steps; the budget says what their missing inertia is.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np

from warpffrf.model.contact import CELL_ERRORS
from warpffrf.model.evaluations import evaluation_of
from warpffrf.model.inertia import LEVELS, TERM_NAMES
from warpffrf.model.scene import Scene
from warpffrf.online.compile.inertia_plan import InertiaPlan, least_level
from warpffrf.online.diagnosis.indicator import TermSize, term_sizes
from warpffrf.online.history.budget_line import BudgetLine
from warpffrf.output.accuracy.limits import Limits
from warpffrf.output.accuracy.setting import AUTO, CELL_ERROR, GRID, HATS, INERTIA, PATCH, STIFFENING, Setting
from warpffrf.output.budget import contacts, time_step

ON_MESH = 2.0  # times the rule: linear cells as wide as the spacing of hats add as much again (`grid_rule`)
FINER = 1.15  # times the steps that second order asks for
LEAST, MOST = 1.2, 8.0  # times the steps of the run before
WITHOUT_ESTIMATE = 2.0  # times the steps, where twice the step fails


@dataclass(frozen=True)
class Choice:
    """Value of an `option` of the body or contact `name`, and `why`."""

    option: str
    name: str
    value: Any
    why: str


def inertia_choices(scene: Scene, result: Any, limits: Limits) -> list[Choice]:
    """Levels and stiffening of flexible bodies; `scene`: as the user gave it, `result`: of the run."""
    plans = InertiaPlan.of(result.history.scene).bodies
    levels = {body.name: plan.level for body, plan in zip(scene.bodies, plans, strict=True)}
    sizes = term_sizes(result.history.scene, result.history.bodies, levels)
    found = []
    for body in scene.bodies:
        own = [size for size in sizes if size.body == body.name]
        if not own or body.reduced is None:
            continue
        terms = body.reduced.inertia_terms
        if body.level == AUTO:
            level = least_level([_largest(own, name) > limits.force for name in TERM_NAMES])
            left = [_largest(own, name) for name, kept in zip(TERM_NAMES, LEVELS[level], strict=True) if not kept]
            why = f"{level!r} leaves out {percent(float(np.hypot.reduce(left)))}" if left else "all terms count"
            found.append(Choice(INERTIA, body.name, level, why))
        softened = next(size.on_modes for size in own if size.term == TERM_NAMES[1])
        if not body.stiffening and terms is not None and terms.stiffening is not None and softened > limits.force:
            found.append(Choice(STIFFENING, body.name, True, f"it is of the size of {percent(softened)}"))
    return found


def _largest(sizes: Sequence[TermSize], name: str) -> float:
    return max(size.size for size in sizes if size.term == name)


def contact_choices(scene: Scene, result: Any, lines: Sequence[BudgetLine], limits: Limits) -> list[Choice]:
    """Grids and cells of contacts that were loaded; `scene`: as the user gave it."""
    found = []
    for contact in scene.contacts:
        loaded = result.contact(contact.name)
        if not np.any(loaded.touching):
            continue
        used = result.history.scene.contact(contact.name)
        on_patch = loaded.history.cells is not None
        if contact.grid == AUTO and not contact.friction.acts and evaluation_of(contact) == "semi":
            choice = _grid(contact, loaded, limits)
            if choice is not None:
                found.append(choice)
        if on_patch and contact.cells is None:
            own = [line for line in lines if line.source == contacts.GRID and line.of.endswith(f"{contact.name!r}")]
            over = [_over(line, limits) for line in own if line.found]
            if over and max(over) > 1.0:
                smaller = max(used.cell_error / max(over), CELL_ERRORS[0])
                found.append(Choice(CELL_ERROR, contact.name, smaller, "other cells differ by more than the limit"))
    return found


def _over(line: BudgetLine, limits: Limits) -> float:
    """Size over its limit."""
    return line.size / (limits.pressure if line.of.startswith(contacts.PRESSURE) else limits.force)


def _grid(contact: Any, loaded: Any, limits: Limits) -> Choice | None:
    """Hats, if they are right enough, else cells where the bodies have what those need; None where no rule tells."""
    grid, shape = contact.a.surface.grid, loaded.view.first.shape
    spacing = float(shape.radius_at(0.5 * (grid.z[0] + grid.z[-1]))) * float(grid.pitch)
    errors = [contacts.hats_error(loaded, spacing, of) for of in (contacts.FORCE, contacts.PRESSURE)]
    errors[0] *= ON_MESH
    told = f"hats would err by {percent(errors[0])} of the force, {percent(errors[1])} of pressures"
    if np.all(np.isfinite(errors)) and errors[0] <= limits.force and errors[1] <= limits.pressure:
        return Choice(GRID, contact.name, HATS, told)
    if contact.without_patch() is not None:
        return None
    told = told if np.all(np.isfinite(errors)) else "no rule tells how hats would err"
    return Choice(GRID, contact.name, PATCH, told)


def steps_wanted(steps: int, lines: Sequence[BudgetLine], limits: Limits) -> tuple[int, str]:
    """Steps of the next run, `steps` where these are enough, and the largest error of the step in words."""
    own = [line for line in lines if line.source == time_step.SOURCE]
    known = [line for line in own if line.found]
    if len(known) < len(own):
        return _even(WITHOUT_ESTIMATE * steps), next(line.basis for line in own if not line.found)
    if not known:
        return steps, "nothing moves"
    worst = max(known, key=lambda line: line.size)
    told = f"it errs by {percent(worst.size)} of the {worst.of}"
    if worst.size <= limits.force:
        return steps, told
    more = FINER * math.sqrt(worst.size / limits.force)
    return _even(steps * min(max(more, LEAST), MOST)), told


def next_setting(
    scene: Scene, result: Any, now: Setting, lines: Sequence[BudgetLine], limits: Limits, *, first: bool
) -> tuple[Setting, list[str]]:
    """The setting that the run of `now` asks for, `now` itself where it is enough, and why, one line a choice."""
    options, why, finer = dict(now.options), [], False
    for choice in [*inertia_choices(scene, result, limits), *contact_choices(scene, result, lines, limits)]:
        key = choice.option, choice.name
        more = key not in options or _finer(choice, options[key])
        finer = finer or more
        if first or more:
            options[key] = _both(choice, options.get(key)) if more else choice.value
        kind = "body" if choice.option in (INERTIA, STIFFENING) else "contact"
        value = f"{choice.value:.3g}" if isinstance(choice.value, float) else repr(options[key])
        why.append(f"{choice.option}={value} of {kind} {choice.name!r} ({choice.why})")
    steps, told = steps_wanted(now.steps, lines, limits)
    if steps == now.steps and not finer:
        return now, [told, *why]
    return Setting(steps, now.local, options), [told, *why]


def _finer(choice: Choice, before: Any) -> bool:
    """Whether a choice is finer than what was chosen before."""
    if choice.option == INERTIA:
        return any(wanted and not kept for wanted, kept in zip(LEVELS[choice.value], LEVELS[before], strict=True))
    if choice.option == GRID:
        return choice.value == PATCH != before
    return choice.value > before if choice.option == STIFFENING else choice.value < before


def _both(choice: Choice, before: Any) -> Any:
    """The choice, of an inertia level with the terms of the one before."""
    if choice.option != INERTIA or before is None:
        return choice.value
    return least_level([one or other for one, other in zip(LEVELS[choice.value], LEVELS[before], strict=True)])


def _even(steps: float) -> int:
    """An even number of steps, so that twice the step takes a whole number too."""
    whole = math.ceil(steps)
    return whole + whole % 2


def percent(size: float) -> str:
    """A size in words."""
    return f"{100.0 * size:.2g} %"
