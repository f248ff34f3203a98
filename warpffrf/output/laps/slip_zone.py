r"""The slip zone of a lap in a time, and how well cells resolve it.

Where a joint slips in part, the loss is made in a zone between the outline and the stick region, a few cells wide or
many. Of a bar (stiffness EA) that is pulled at its end by +-F and held by friction tau per length, cells of length a,
K = EA/a springs between them, each cell gives at most tau a. At f = F/(tau a) = n + 1/2 the n first cells slip, and by
the differences of forces along the chain, a cycle takes

    D_cells = 4 (tau a)^2 / K  sum_{j=1..n} j (f - j) = (tau a)^2 / (3 K)  n (n + 1) (2 n + 1),

beside D = 2 F^3/(3 EA tau) of the continuous bar:

    D_cells / D = 4 n (n + 1) / (2 n + 1)^2 = 1 - 1/(2 n + 1)^2,        n cells across,

at f = n it is 1 - 1/n^2. `ACROSS` cells leave 1.6 % at most there, one or two cells anything. Zones that are not
straight, and pressures that fall across them, take more.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from scipy.spatial import KDTree

ACROSS = 8.0  # cells across the slip zone, below which the loss per cycle is uncertain (1/n^2, module docstring)
LEAST = 1e-6  # of the largest loss of a cell: below it is what tolerances leave of sticking


@dataclass(frozen=True, eq=False)
class SlipZone:
    """Cells of a lap that friction took energy in: `slips` (c,) bool, `area` [m2] of them, and `across`: the farthest
    of them from the cells that pressed and stuck, in cells; NaN where none slips, or no cell sticks."""

    slips: np.ndarray
    area: float
    across: float

    @property
    def cells(self) -> int:
        """Number of cells in the zone."""
        return int(self.slips.sum())

    @property
    def coarse(self) -> bool:
        """True where the zone has fewer than `ACROSS` cells across, so that the loss is uncertain."""
        return bool(self.across < ACROSS)


def slip_zone(points: np.ndarray, area: np.ndarray, loss: np.ndarray, pressed: np.ndarray) -> SlipZone:
    """Of cells at `points` (c, 3) [m] with `area` (c,) [m2] that lost `loss` (c,) [J], and were `pressed` (c,) at some
    time."""
    slips = loss > LEAST * max(float(loss.max(initial=0.0)), np.finfo(float).tiny)
    sticks = pressed & ~slips
    across = float("nan")
    if np.any(slips) and np.any(sticks):
        distance = KDTree(points[sticks]).query(points[slips])[0]
        across = float(np.max(distance / np.sqrt(area[slips])))
    return SlipZone(slips, float(area[slips].sum()), across)
