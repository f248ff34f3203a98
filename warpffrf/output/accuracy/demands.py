"""Settings required by the error budget of a run: options of bodies and contacts, and the step.

    inertia level    the lowest that keeps every term above the limit (`online.diagnosis.inertia_indicator`)
    stiffening       if the deformed inertia, which is of the same size, is above the limit
    contact grid     nodes of the body-fixed grid instead of cells, if accurate enough for all contacts
    cells            smaller ones, if other cells differ by more than the limit
    gaps             at closest points, if parallel-axes kinematics neglects more of a moment than the limit
    energy tolerance a tenth, if the ledger of a run with steps halved in impacts is off
    step             h (limit/error)^(1/2), of second order; errors are those of the step, spurious energy, and
                    friction of patches that advance too fast

Options set by the user are kept: an inertia level other than "auto", a grid other than "auto", stiffening. Choices are
only ever refined, so that runs do not alternate between two settings; a run whose budget requires nothing finer is the
result, even if coarser settings would suffice. There is no error rule for friction on nodes of the contact grid: with
such a contact on cells all grids are kept. The treatment of local modes is kept: faces with mass chatter in an impact,
with forces that do not converge with the step; the budget states the effect of the missing inertia.
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
from warpffrf.online.diagnosis.inertia_indicator import TermSize, term_sizes
from warpffrf.online.history.history import BudgetLine
from warpffrf.online.settings import Settings
from warpffrf.output.accuracy.limits import Limits
from warpffrf.output.accuracy.setting import (
    AUTO,
    BODY_FIXED,
    CELL_ERROR,
    GRID,
    INERTIA,
    KINEMATICS,
    STIFFENING,
    Setting,
)
from warpffrf.output.budget import contacts, time_step
from warpffrf.output.budget.budget import percent
from warpffrf.output.budget.figures import is_main

ON_MESH = 2.0  # times the rule: linear cells as wide as the node spacing add the same error again (`grid_rule`)
FINER = 1.15  # times the steps according to second order
LEAST, MOST = 1.2, 3.0  # times the steps of the previous run: more would overshoot while vibrations are not resolved
CELLS = 2.0, 4.0  # refinement factors: less gives the same cells, more gives twice as many strips
TIGHTER, LEAST_TOLERANCE = 0.1, 1e-8  # factor of the energy tolerance, and its smallest value
WITHOUT_ESTIMATE = 2.0  # factor of the steps if a run with twice the step fails


@dataclass(frozen=True)
class Choice:
    """Value of an `option` of the body or contact `name`, and the reason `why`."""

    option: str
    name: str
    value: Any
    why: str


def inertia_choices(scene: Scene, result: Any, limits: Limits) -> list[Choice]:
    """Levels and stiffening of flexible bodies; `scene`: as given by the user, `result`: of the run."""
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
    """Grids and cells of loaded contacts; `scene`: as given by the user."""
    found = _grids(scene, result, limits)
    leaning = {line.of: line for line in lines if line.source == contacts.GAPS and line.size > limits.force}
    for contact in scene.finite_sliding:
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
    """Size relative to its limit."""
    return line.size / (limits.pressure if line.of.startswith(contacts.PRESSURE) else limits.force)


def _power(line: BudgetLine) -> float:
    """Power p such that an error varies with `cell_error`^(1/p): 1 for forces, with the square of the cells; 2 for
    pressures as a field."""
    return 2.0 if line.of.startswith(contacts.PRESSURE) else 1.0


def _grids(scene: Scene, result: Any, limits: Limits) -> list[Choice]:
    """Grids of contacts that are left to the program and can have cells: nodes of the body-fixed grid if accurate
    enough for all of them, since a body cannot have contacts of both kinds; else the default. Empty unless the rule
    covers each."""
    runs = {contact.name: result.contact(contact.name) for contact in scene.finite_sliding}
    chosen = {contact.name for contact in result.history.scene.finite_sliding if contact.grid == BODY_FIXED}
    free = [
        c
        for c in scene.finite_sliding
        if c.grid == AUTO and (c.name in chosen or runs[c.name].history.cells is not None)
    ]
    ruled = [not c.friction.acts and c.quadrature == "full" and np.any(runs[c.name].touching) for c in free]
    if not all(ruled):
        return []
    errors = {c.name: _nodes_errors(c, runs[c.name]) for c in free}
    right = all(force <= limits.force and pressure <= limits.pressure for force, pressure in errors.values())
    return [Choice(GRID, name, BODY_FIXED if right else AUTO, _told(*pair)) for name, pair in errors.items()]


def _told(force: float, pressure: float) -> str:
    """Errors of the nodes of the contact grid, as text."""
    if np.isnan(force + pressure):
        return "there is no error rule for nodes of the contact grid"
    return f"errors at nodes of the contact grid: {percent(force)} of the force, {percent(pressure)} of pressures"


def _nodes_errors(contact: Any, loaded: Any) -> tuple[float, float]:
    """Errors of force and pressures on the body-fixed grid of a contact, for its patch as it was `loaded`; NaN without
    a rule."""
    grid, shape = contact.a.surface.grid, loaded.view.first.shape
    spacing = float(shape.radius_at(0.5 * (grid.z[0] + grid.z[-1]))) * float(grid.pitch)
    force, pressure = (contacts.nodes_error(loaded, spacing, of) for of in (contacts.FORCE, contacts.PRESSURE))
    return ON_MESH * force, pressure


def of_the_step(lines: Sequence[BudgetLine]) -> list[BudgetLine]:
    """Errors that a smaller step reduces."""
    sources = time_step.SOURCE, contacts.SOURCE, contacts.ADVANCE
    return [line for line in lines if line.source in sources and is_main(line)]


def steps_wanted(steps: int, lines: Sequence[BudgetLine], limits: Limits) -> tuple[int, str]:
    """Steps of the next run, `steps` if these suffice, and the largest error of the step as text."""
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
    """The setting required by the run of `now`, or `now` itself if it suffices, and the reasons, one line per
    choice."""
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
    """Energy tolerance of the next run. Impact steps are halved according to it, so it governs their energy, not the
    step."""
    off = [line for line in lines if line.source == contacts.SOURCE and line.found and line.size > limits.force]
    tighter = TIGHTER * (Settings.energy_tolerance if now is None else now)
    halved = result.history.counters.get("rejected_steps", 0) > 0
    return tighter if off and halved and tighter >= LEAST_TOLERANCE else now


def _finer(choice: Choice, before: Any) -> bool:
    """Whether a choice is finer than the previous one."""
    if choice.option == INERTIA:
        return any(wanted and not kept for wanted, kept in zip(LEVELS[choice.value], LEVELS[before], strict=True))
    if choice.option == GRID:
        return choice.value == AUTO != before
    if choice.option == KINEMATICS:
        return choice.value != before
    return choice.value > before if choice.option == STIFFENING else choice.value < before


def _both(choice: Choice, before: Any) -> Any:
    """The choice; for an inertia level with the terms of the previous one."""
    if choice.option != INERTIA or before is None:
        return choice.value
    return least_level([one or other for one, other in zip(LEVELS[choice.value], LEVELS[before], strict=True)])


def _even(steps: float) -> int:
    """An even number of steps, so that twice the step also gives a whole number."""
    whole = math.ceil(steps)
    return whole + whole % 2
