"""Errors of contacts: the grid or the cells of the pressure, few sampling points, the mesh, and the iteration.

*Hats of the material grid*: what the grid leaves of the force at a given approach, at most, for a patch of the size
found at the largest load, by the rule of `offline.contact.grid_rule` (worst position of the patch on the grid; the
mean one is about half of it). *Cells of a patch*: other cells at sampled steps (`online.diagnosis.cell_check`).
*Points*: all points at sampled steps (`online.diagnosis.sampling_check`). The mesh needs a second one,
`ReducedBody.mesh_error`.
"""

from __future__ import annotations

from typing import Any

import numpy as np

from warpffrf.model.evaluations import evaluation_of
from warpffrf.offline.contact.grid_rule import grid_error
from warpffrf.online.diagnosis.cell_check import check_cells
from warpffrf.online.diagnosis.sampling_check import check_sampling
from warpffrf.online.engine import Engine
from warpffrf.online.history.budget_line import BudgetLine

PATCHES = {"line": "line", "point": "ellipse"}  # kinds of patches that the rule knows
GRID, POINTS, MESH, TOLERANCE = "contact grid", "sampling points", "FE mesh", "iteration"


def grid_lines(result: Any, engine: Engine) -> list[BudgetLine]:
    """One line for each contact that was loaded."""
    history = result.history
    checks = check_cells(engine, history) if engine.compiled.patches else {}
    lines = []
    for number, contact in enumerate(history.scene.contacts):
        found = result.contact(contact.name)
        of = _force(contact.name)
        if not np.any(found.touching):
            continue
        if number in engine.compiled.patches:
            check = checks.get(number)
            size = check.force if check is not None and check.rows else np.nan
            other = "other cells at sampled steps" if np.isfinite(size) else "other cells found no state at the steps"
            lines.append(BudgetLine(GRID, of, size, other, "a smaller cell_error, or more cells"))
        else:
            lines.append(_of_hats(found, of))
    return lines


def _of_hats(found: Any, of: str) -> BudgetLine:
    """By the rule, at the largest load."""
    cure = "a finer grid (half_width= or traction_spacing= of reduce), or patch_grid=True"
    kind = PATCHES.get(found.patch_kind)
    if kind is None:
        return BudgetLine(GRID, of, np.nan, f"there is no rule for a patch that is {found.patch_kind!r}", cure)
    row = int(np.argmax(found.force_magnitude))
    widths = found.half_widths[row] if kind == "ellipse" else found.half_width[row : row + 1]
    rows = float(np.max(np.diff(found.view.first.grid.z)))
    sizes = [
        grid_error(float(spacing), float(width), patch=kind) if width > 0.0 else None
        for spacing, width in zip((found.spacing, rows), widths, strict=False)
    ]
    known = [size for size in sizes if size is not None]
    if len(known) < len(sizes):
        return BudgetLine(GRID, of, np.nan, "the patch is smaller than a column of the grid", cure)
    return BudgetLine(GRID, of, max(known), "the rule of the grid at the largest load, worst position", cure)


def point_lines(result: Any) -> list[BudgetLine]:
    """One line for each contact of evaluation "hyper"."""
    lines = []
    for contact in result.history.scene.contacts:
        if evaluation_of(contact) == "hyper" and np.any(result.contact(contact.name).touching):
            check = check_sampling(contact, result.history)
            cure = "a smaller sampling_error of the first body"
            lines.append(BudgetLine(POINTS, _force(contact.name), check.force, "all points at sampled steps", cure))
    return lines


def mesh_lines(result: Any) -> list[BudgetLine]:
    """What it takes to know the error of the mesh, for each contact that was loaded."""
    return [
        BudgetLine(
            MESH, _force(contact.name), np.nan,
            "needs the bodies on another mesh", "body.mesh_error(the same body on a finer mesh)",
        )
        for contact in result.history.scene.contacts
        if np.any(result.contact(contact.name).touching)
    ]  # fmt: skip


def tolerance_lines(result: Any, engine: Engine) -> list[BudgetLine]:
    """To what the iteration of a step is balanced."""
    if not result.history.scene.contacts:
        return []
    size = engine.settings.residual_tolerance
    return [BudgetLine(TOLERANCE, "force of all contacts", size, "the tolerance of the balance of forces")]


def _force(name: str) -> str:
    return f"force of contact {name!r}"
