"""Errors of stresses of bodies: rules for stresses below contacts, no estimate for others.

Below patches of cells the half-space corrects the stress of the elements, and the largest von Mises stress errs by
`BELOW_CELLS` at most (docs/studies/coarse_points.md: 0.1 to 0.5 % below lines and points, of hexahedra and tetrahedra
with three to eight on the radius), and by the body errors of the pressures. On nodes of the contact grid it is the
error of the cells below a line (`contact.stress_errors`). Stresses deeper than `NEAR` half-widths are not those of a
contact: the error of the elements is not known from one mesh.
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import numpy as np

from warpffrf.online.history.history import BudgetLine
from warpffrf.output.budget.contacts import GRID
from warpffrf.output.budget.figures import UNKNOWN
from warpffrf.output.contact.hertz import flexible_sides

STRESS, PEAK = "stress recovery", "peak pressure of contact "
BELOW_CELLS = 0.004
NEAR = 3.0  # half-widths: the stress of a pressure has decreased to a third of its maximum
CURE = "a finer mesh behind the contact"
AWAY = "requires the points on a second mesh"


def stress_lines(result: Any) -> list[BudgetLine]:
    """For each body with stress one line for each contact above stress points, and one for other points."""
    lines = []
    for body in result.history.scene.bodies:
        if body.reduced is None or not body.reduced.stress:
            continue
        points = np.concatenate([field.points for field in body.reduced.stress.values()])
        away, owner = np.ones(len(points), dtype=bool), f"body {body.name!r}"
        for contact in result.history.scene.finite_sliding:
            found = result.contact(contact.name)
            if not np.any(found.touching):
                continue
            row = int(np.argmax(found.force_magnitude))
            for side, surface in flexible_sides(found.view):
                depth = -surface.shape.chart(points)[2]
                under = np.abs(depth) < NEAR * float(np.min(found.half_widths[row]))
                if side.name != body.name or not np.any(under):
                    continue
                away &= ~under
                size, basis = _below(found, row, body.name)
                of, source = f"{below(repr(contact.name))} of {owner}", STRESS if np.isfinite(size) else UNKNOWN
                lines.append(BudgetLine(source, of, size, basis, CURE))
        if np.any(away):
            lines.append(BudgetLine(UNKNOWN, f"stress away from contacts of {owner}", np.nan, AWAY))
    return lines


def below(contact: str) -> str:
    """The quantity name of stresses below a contact, from its name in quotes."""
    return f"stress below {contact}"


def _below(found: Any, row: int, body: str) -> tuple[float, str]:
    """Error of the largest von Mises stress, and its basis."""
    if found.loaded == "cells":
        return BELOW_CELLS, "the half-space under cells, by studies of cylinders and balls"
    known = found.stress_errors(row)
    if body not in known:
        return np.nan, "the rule below contacts on nodes of the contact grid is for hexahedra"
    one = known[body]
    return one.von_mises, one.reason or f"{one.spacings:.2g} spacings of nodes in the half-width"


def stress_by_pressure(lines: Sequence[BudgetLine]) -> list[BudgetLine]:
    """Errors of the peak pressures of contacts due to bodies and steps also apply to the stress below; those due to
    cells are included in the rule."""
    peaks = [line for line in lines if line.found and line.source != GRID and line.of.startswith(PEAK)]
    return [
        BudgetLine(peak.source, line.of, peak.size, "as the peak pressure", peak.cure)
        for line in lines
        if line.source == STRESS
        for peak in peaks
        if line.of.startswith(f"{below(peak.of.removeprefix(PEAK))} of ")
    ]
