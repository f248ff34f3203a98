r"""A layer whose pressure is given by a table against the gap, from a measurement or another program.

Between the points the curve is straight, so that pressure, slope and energy follow from the table alone, and nothing
overshoots it. Beyond the smallest gap the last piece goes on; beyond the largest one, where the pressure must be zero,
the surfaces are apart.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any, ClassVar

import numpy as np

from warpffrf.model.errors import InputError, require_array
from warpffrf.model.laws.layer import Curve

MOST_POINTS = 256  # a lookup is a walk along the table


@dataclass(frozen=True)
class TableLayer:
    """A layer with tabulated pressures (n,) [Pa] at the gaps (n,) [m], which rise; the pressures must fall strictly and
    end at zero. Raises `InputError` for a table that folds over itself."""

    gaps: tuple[float, ...]
    pressures: tuple[float, ...]
    kind: ClassVar[str] = "table_layer"

    def __post_init__(self) -> None:
        gaps = require_array(self.gaps, "TableLayer: gaps [m]", (None,))
        pressures = require_array(self.pressures, "TableLayer: pressures [Pa]", (None,))
        if len(gaps) != len(pressures) or len(gaps) < 2:
            raise InputError(
                f"TableLayer: as many pressures as gaps are needed, two at least, got {len(gaps)} gaps and "
                f"{len(pressures)} pressures"
            )
        if len(gaps) > MOST_POINTS:
            raise InputError(f"TableLayer: at most {MOST_POINTS} points, got {len(gaps)}; thin the table")
        for name, wrong, values in (
            ("gaps must rise", np.diff(gaps) <= 0.0, gaps),
            ("pressures must fall as the gap grows", np.diff(pressures) >= 0.0, pressures),
        ):
            if np.any(wrong):
                i = int(np.argmax(wrong))
                raise InputError(
                    f"TableLayer: the table folds over itself, {name} strictly, got {values[i]:g} and then "
                    f"{values[i + 1]:g} (points {i} and {i + 1})"
                )
        if pressures[-1] != 0.0:
            raise InputError(
                f"TableLayer: the last pressure must be 0, got {pressures[-1]:g} Pa; add the gap where contact ends"
            )
        object.__setattr__(self, "gaps", tuple(float(g) for g in gaps))
        object.__setattr__(self, "pressures", tuple(float(p) for p in pressures))

    @property
    def compliance(self) -> float:
        """0: the yield is no constant, see `curve`."""
        return 0.0

    @property
    def curve(self) -> Curve:
        """Form "table": depths and pressures, both rising."""
        return Curve("table", (), np.stack([-np.array(self.gaps)[::-1], np.array(self.pressures)[::-1]], axis=1))

    def pressure(self, gap: Any) -> np.ndarray:
        """Pressure [Pa] at the gaps [m], any shape."""
        d, i, t = self._place(gap)
        slope = np.diff(t[:, 1]) / np.diff(t[:, 0])
        return np.where(d > t[0, 0], t[i, 1] + slope[i] * (d - t[i, 0]), 0.0)

    def energy(self, gap: Any) -> np.ndarray:
        """Energy [J/m^2] of the layer at the gaps [m], any shape."""
        d, i, t = self._place(gap)
        whole = np.concatenate([[0.0], np.cumsum(0.5 * (t[1:, 1] + t[:-1, 1]) * np.diff(t[:, 0]))])
        return np.where(d > t[0, 0], whole[i] + 0.5 * (t[i, 1] + self.pressure(-d)) * (d - t[i, 0]), 0.0)

    def describe(self) -> dict[str, Any]:
        """Plain data for hashing."""
        return {"kind": self.kind, "gaps": list(self.gaps), "pressures": list(self.pressures)}

    def _place(self, gap: Any) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
        """Depths, the pieces they lie on, and the table (n, 2) by depth."""
        table = self.curve.table
        depth = -np.asarray(gap, float)
        return depth, np.clip(np.searchsorted(table[:, 0], depth) - 1, 0, len(table) - 2), table
