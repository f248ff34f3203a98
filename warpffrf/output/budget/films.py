"""Errors of oil films: of evaluation "hyper" a few profiles along beside all hats, in states of the run; of hats their
grid beside finer ones, in the last state.

The smallest gap and the largest pressure are those under the same force, the force that at the same places
(`online.diagnosis.film_check`); force, flow and torque of finer grids are those at the same gap
(`online.diagnosis.film_grid`).
"""

from __future__ import annotations

import numpy as np

from warpffrf.online.diagnosis.film_check import cure_of
from warpffrf.online.history.budget_line import BudgetLine
from warpffrf.online.history.history import History

PROFILES, GRID = "film profiles", "film grid"


def film_lines(history: History) -> list[BudgetLine]:
    """Three lines for each film."""
    lines = []
    for film in history.scene.films:
        grid = history.film_grids.get(str(film.name))
        if grid is not None:
            told = f"twice {film.grid.columns} columns and {film.grid.rows} rows at the gap of the last state"
            cure = f"reduce with a finer mesh {grid.finer}"
            for of, size in (("force", grid.load), ("end flow", grid.flow), ("torque", grid.torque)):
                lines.append(BudgetLine(GRID, f"{of} of film {film.name!r}", float(size), told, cure))
        check = history.film_checks.get(str(film.name))
        if check is None:
            continue
        basis = f"all hats in {len(check.time)} states of the run"
        if not len(check.time):
            basis = "the film of all hats was found in no state of the run"
        for of, size, where in (
            ("force", check.force, "where the bodies are"),
            ("smallest gap", check.gap, "under the same force"),
            ("largest pressure", check.pressure, "under the same force"),
        ):
            told = basis
            if np.isfinite(size):
                told += f", {where}; hats of {film.grid.rows} rows err by {check.own:.1%} themselves"
            lines.append(BudgetLine(PROFILES, f"{of} of film {film.name!r}", float(size), told, cure_of(film)))
    return lines
