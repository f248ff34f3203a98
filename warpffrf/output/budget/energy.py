r"""Energy that came from nowhere, by the ledger of the run itself.

With L = numerical + contact_grid, what the steps make of energy and what the grid of a contact does, a run has gained
max(L - running min L), over the energy at hand. Nothing real does that: it is an error of the step, of second order in
it where motion is smooth, also where coordinates are still right. What a run loses is another matter, numerical damping
of what its steps do not resolve, which the report states beside it; with lumped contacts, where all that yields in an
impact is the law of the contact, a loss is an error, too, and the larger of the two counts.
"""

from __future__ import annotations

from typing import Any

import numpy as np

from warpffrf.online.history.budget_line import BudgetLine

SOURCE, OF = "energy ledger", "energy at hand"


def energy_lines(result: Any) -> list[BudgetLine]:
    """One line, where there is energy, and the ledger has booked what it takes."""
    hand = result.energy_scale
    L = np.asarray(result.energy["numerical"] + result.energy["contact_grid"])
    if not hand > 0.0 or not np.all(np.isfinite(L)):
        return []
    size, basis = float(np.max(L - np.minimum.accumulate(L))) / hand, "gained"
    loss = float(np.max(np.maximum.accumulate(L) - L)) / hand
    if result.history.scene.lumped_contacts and loss > size:
        size, basis = loss, "lost"
    cure = "a smaller step" + (", or energy_tolerance=" if result.history.counters.get("rejected_steps") else "")
    return [BudgetLine(SOURCE, OF, size, f"{basis} by lines numerical and contact_grid", cure)]
