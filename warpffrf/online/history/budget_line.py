"""One line of the error budget of a run, `warpffrf.output.budget`."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np


@dataclass(frozen=True)
class BudgetLine:
    """What one source of error does to one quantity of a run.

    size: a fraction of the quantity (`of` says which), NaN where it could not be found; `basis` says how it was found,
    or why not, `cure` what makes it smaller.
    """

    source: str
    of: str
    size: float
    basis: str
    cure: str = ""

    @property
    def found(self) -> bool:
        """Whether there is a size."""
        return bool(np.isfinite(self.size))
