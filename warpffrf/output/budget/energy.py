r"""Energy that came from nowhere, by the ledger of the run itself.

With L = numerical + contact_grid, what the steps make of energy and what the grid of a contact does, a run has gained
max(L - running min L), over the energy at hand. Nothing real does that: it is an error of the step, of second order in
it where motion is smooth, also where coordinates are still right. What a run loses is another matter, numerical damping
of what its steps do not resolve, which the report states beside it; with lumped contacts, where all that yields in an
impact is the law of the contact, a loss is an error, too, and the larger of the two counts.

The lines have cures of their own: `numerical` is of the step, `contact_grid` of the grid under a patch that moves over
it, at any step. Between the rows of the largest rise or fall the one that changed more is named, with the other where
that made more than `SHARE` of it.
"""

from __future__ import annotations

from typing import Any

import numpy as np

from warpffrf.online.history.budget_line import BudgetLine

SOURCE, OF = "energy ledger", "energy at hand"
SHARE = 0.2  # of what was gained or lost: a line with less needs no cure
FINER_GRID = (
    "a finer contact grid (expected_half_width= or traction_spacing= of reduce), or more cells of a patch (cells=)"
)


def energy_lines(result: Any) -> list[BudgetLine]:
    """One line, where there is energy, and the ledger has booked what it takes."""
    hand = result.energy_scale
    ledger = {name: np.asarray(result.energy[name]) for name in ("numerical", "contact_grid")}
    L = ledger["numerical"] + ledger["contact_grid"]
    if not hand > 0.0 or not np.all(np.isfinite(L)):
        return []
    rises = L - np.minimum.accumulate(L)
    falls = np.maximum.accumulate(L) - L
    lost = bool(result.history.scene.lumped_contacts and falls.max() > rises.max())
    sign, basis = (-1.0, "lost") if lost else (1.0, "gained")
    end = int(np.argmax(falls if lost else rises))
    begin = int(np.argmin(sign * L[: end + 1]))
    made = {name: sign * (values[end] - values[begin]) for name, values in ledger.items()}
    size = float(sum(made.values()))
    own = [name for name in sorted(made, key=lambda name: -made[name]) if made[name] >= SHARE * size]
    or_else = ", or energy_tolerance=" if result.history.counters.get("rejected_steps") else ""
    cures = {"numerical": f"a smaller step{or_else}", "contact_grid": FINER_GRID}
    named = f"{basis} by line{'s' * (len(own) > 1)} {' and '.join(own)}"
    return [BudgetLine(SOURCE, OF, size / hand, named, "; ".join(cures[name] for name in own))]
