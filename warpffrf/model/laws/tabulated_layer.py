r"""A layer whose pressure is given by a table against the gap, from a measurement or another program.

Between the points the curve is straight, so that pressure, slope and energy follow from the table alone, and nothing
overshoots it. Beyond the smallest gap the last piece goes on; beyond the largest one, where the pressure must be zero,
the surfaces are apart.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import ClassVar

import numpy as np

from warpffrf.model.errors import InputError, require_array
from warpffrf.model.laws.curves import Table
from warpffrf.model.laws.curves.table import MOST_POINTS
from warpffrf.model.laws.law import Law
from warpffrf.model.messages.named_arguments import named_arguments


@named_arguments
@dataclass(frozen=True)
class TabulatedLayer(Law):
    """A layer with tabulated pressures (n,) [Pa] at the gaps (n,) [m], which rise; the pressures must fall strictly and
    end at zero. Raises `InputError` for a table that folds over itself."""

    gaps: tuple[float, ...]
    pressures: tuple[float, ...]
    kind: ClassVar[str] = "tabulated_layer"

    def __post_init__(self) -> None:
        gaps = require_array(self.gaps, "TabulatedLayer: gaps [m]", (None,))
        pressures = require_array(self.pressures, "TabulatedLayer: pressures [Pa]", (None,))
        if len(gaps) != len(pressures) or len(gaps) < 2:
            raise InputError(
                f"TabulatedLayer: as many pressures as gaps are needed, two at least, got {len(gaps)} gaps and "
                f"{len(pressures)} pressures"
            )
        if len(gaps) > MOST_POINTS:
            raise InputError(f"TabulatedLayer: at most {MOST_POINTS} points, got {len(gaps)}; thin the table")
        for name, wrong, values in (
            ("gaps must rise", np.diff(gaps) <= 0.0, gaps),
            ("pressures must fall as the gap grows", np.diff(pressures) >= 0.0, pressures),
        ):
            if np.any(wrong):
                i = int(np.argmax(wrong))
                raise InputError(
                    f"TabulatedLayer: the table folds over itself, {name} strictly, got {values[i]:g} and then "
                    f"{values[i + 1]:g} (points {i} and {i + 1})"
                )
        if pressures[-1] != 0.0:
            raise InputError(
                f"TabulatedLayer: the last pressure must be 0, got {pressures[-1]:g} Pa; add the gap where contact ends"
            )
        object.__setattr__(self, "gaps", tuple(float(g) for g in gaps))
        object.__setattr__(self, "pressures", tuple(float(p) for p in pressures))

    @property
    def curve(self) -> Table:
        """Depths and pressures, both rising."""
        return Table(-np.array(self.gaps)[::-1], np.array(self.pressures)[::-1])
