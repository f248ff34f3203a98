"""What the error budget of a run asks for: other options of bodies and contacts, another step.

    inertia level    the least that keeps every term above the limit (`online.diagnosis.indicator`)
    stiffening       where the deformed inertia, which is of its size, is above the limit
    contact grid     hats of the material grid in place of cells, where they are right enough for all contacts
    cells            smaller ones, where other cells differ by more than the limit
    gaps             at points, where lines of centres leave out more of a moment than the limit
    energy tolerance a tenth, where the ledger of a run is off whose steps were halved in impacts
    step             h (limit/error)^(1/2), of second order; errors are those of the step, energy from nowhere, and
                    friction of patches that advance too fast

Options that the user has set are kept: an inertia level other than "auto", a grid other than "auto", stiffening. What
has been chosen once is only ever made finer, so that runs do not swing between two settings; a run whose budget asks
for nothing finer is the result, even where something coarser would have done, for it is there. Friction has no rule
that says how hats err: with such a contact on cells all grids stay. The treatment of local modes stays as it is: faces
that have mass chatter in an impact, with forces that do not settle with shorter steps; the budget says what their
missing inertia is.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np

from warpffrf.model.contact import CELL_ERRORS
from warpffrf.model.reduced.inertia import LEVELS, TERM_NAMES
from warpffrf.model.scene import Scene
from warpffrf.online.compile.inertia_plan import InertiaPlan, least_level
from warpffrf.online.diagnosis.indicator import TermSize, term_sizes
from warpffrf.online.history.history import BudgetLine
from warpffrf.online.settings import Settings
from warpffrf.output.accuracy.limits import Limits
from warpffrf.output.accuracy.setting import AUTO, CELL_ERROR, GRID, HATS, INERTIA, KINEMATICS, STIFFENING, Setting
from warpffrf.output.budget import contacts, time_step
from warpffrf.output.budget.budget import percent
from warpffrf.output.budget.figures import is_main

ON_MESH = 2.0  # times the rule: linear cells as wide as the spacing of hats add as much again (`grid_rule`)
FINER = 1.15  # times the steps that second order asks for
LEAST, MOST = 1.2, 3.0  # times the steps of the run before: more overshoots where vibrations are not resolved yet
CELLS = 2.0, 4.0  # times finer than before in `cell_error`: less is the same number of cells, more twice as many strips
TIGHTER, LEAST_TOLERANCE = 0.1, 1e-8  # times the energy tolerance before, down to this
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
    found = _grids(scene, result, limits)
    leaning = {line.of: line for line in lines if line.source == contacts.GAPS and line.size > limits.force}
    for contact in scene.contacts:
        if (line := leaning.get(f"moment of contact {contact.name!r}")) is not None and contact.kinematics == AUTO:
            found.append(Choice(KINEMATICS, contact.name, "closest_point", line.basis))
        loaded = result.contact(contact.name)
        used = result.history.scene.contact(contact.name)
        if loaded.history.cells is not None and contact.cells is None and np.any(loaded.touching):
            own = [line for line in lines if line.source == contacts.GRID and line.of.endswith(f"{contact.name!r}")]
            over = [_over(line, limits) ** _power(line) for line in own if line.found]
            if over and max(over) > 1.0:
                smaller = max(used.cell_error / float(np.clip(max(over), *CELLS)), CELL_ERRORS[0])
                found.append(Choice(CELL_ERROR, contact.name, smaller, "other cells differ by more than the limit"))
    return found


def _over(line: BudgetLine, limits: Limits) -> float:
    """Size over its limit."""
    return line.size / (limits.pressure if line.of.startswith(contacts.PRESSURE) else limits.force)


def _power(line: BudgetLine) -> float:
    """Of `cell_error` an error goes with 1/power: forces as it, with the square of the cells; pressures as a field with
    its root."""
    return 2.0 if line.of.startswith(contacts.PRESSURE) else 1.0


def _grids(scene: Scene, result: Any, limits: Limits) -> list[Choice]:
    """Of contacts whose grid is left to the program and that can have cells: hats, if they are right enough for all of
    them, since one body has no contacts on both; else what the program takes by itself. None without a rule for each.
    """
    runs = {contact.name: result.contact(contact.name) for contact in scene.contacts}
    chosen = {contact.name for contact in result.history.scene.contacts if contact.grid == HATS}
    free = [
        c for c in scene.contacts if c.grid == AUTO and (c.name in chosen or runs[c.name].history.cells is not None)
    ]
    ruled = [not c.friction.acts and c.evaluation == "semi" and np.any(runs[c.name].touching) for c in free]
    if not all(ruled):
        return []
    errors = {c.name: _hats_errors(c, runs[c.name]) for c in free}
    right = all(force <= limits.force and pressure <= limits.pressure for force, pressure in errors.values())
    return [Choice(GRID, name, HATS if right else AUTO, _told(*pair)) for name, pair in errors.items()]


def _told(force: float, pressure: float) -> str:
    """Errors of hats in words."""
    if np.isnan(force + pressure):
        return "no rule tells how hats would err"
    return f"hats would err by {percent(force)} of the force, {percent(pressure)} of pressures"


def _hats_errors(contact: Any, loaded: Any) -> tuple[float, float]:
    """Of force and pressures on the material grid of a contact, for its patch as it was `loaded`; NaN without rule."""
    grid, shape = contact.a.surface.grid, loaded.view.first.shape
    spacing = float(shape.radius_at(0.5 * (grid.z[0] + grid.z[-1]))) * float(grid.pitch)
    force, pressure = (contacts.hats_error(loaded, spacing, of) for of in (contacts.FORCE, contacts.PRESSURE))
    return ON_MESH * force, pressure


def of_the_step(lines: Sequence[BudgetLine]) -> list[BudgetLine]:
    """Errors that a smaller step lowers."""
    sources = time_step.SOURCE, contacts.SOURCE, contacts.ADVANCE
    return [line for line in lines if line.source in sources and is_main(line)]


def steps_wanted(steps: int, lines: Sequence[BudgetLine], limits: Limits) -> tuple[int, str]:
    """Steps of the next run, `steps` where these are enough, and the largest error of the step in words."""
    own = of_the_step(lines)
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
    tolerance = energy_tolerance_wanted(now.energy_tolerance, result, lines, limits)
    tighter = tolerance != now.energy_tolerance
    if tighter:
        why.append(f"energy_tolerance={tolerance:.2g} (steps of impacts were halved, and the energy ledger is off)")
        lines = [line for line in lines if line.source != contacts.SOURCE]
    steps, told = steps_wanted(now.steps, lines, limits)
    if steps == now.steps and not finer and not tighter:
        return now, [told, *why]
    return Setting(steps, now.local_modes, options, tolerance), [told, *why]


def energy_tolerance_wanted(
    now: float | None, result: Any, lines: Sequence[BudgetLine], limits: Limits
) -> float | None:
    """That of the next run. Steps of impacts are halved to it, so that it rules their energy, not the step."""
    off = [line for line in lines if line.source == contacts.SOURCE and line.found and line.size > limits.force]
    tighter = TIGHTER * (Settings.energy_tolerance if now is None else now)
    halved = result.history.counters.get("rejected_steps", 0) > 0
    return tighter if off and halved and tighter >= LEAST_TOLERANCE else now


def _finer(choice: Choice, before: Any) -> bool:
    """Whether a choice is finer than what was chosen before."""
    if choice.option == INERTIA:
        return any(wanted and not kept for wanted, kept in zip(LEVELS[choice.value], LEVELS[before], strict=True))
    if choice.option == GRID:
        return choice.value == AUTO != before
    if choice.option == KINEMATICS:
        return choice.value != before
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
