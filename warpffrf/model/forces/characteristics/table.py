"""A force given by a table over deformation or rate, from a measurement or another program.

Between the points it is straight, or cubic with the slopes of Fritsch and Butland (SIAM J. Sci. Stat. Comput. 5, 1984):
without kinks, and without overshooting, so that forces that rise from point to point rise everywhere. Beyond the ends
it goes on straight with the slope that it has there; a run that has gone there says so. Play and stops are tables:
[(-2e-3, -1e4), (-1e-3, 0), (1e-3, 0), (2e-3, 1e4)] leaves 1 mm of play to either side, before stops of 10 N/um.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property
from typing import Any, ClassVar

import numpy as np

from warpffrf.model.errors import InputError, require_array
from warpffrf.model.forces.characteristics.characteristic import TERMS, Characteristic, Pieces
from warpffrf.model.messages.named_arguments import named_arguments


@named_arguments
@dataclass(frozen=True)
class ForceTable(Characteristic):
    """Forces over deformation or rate: `points` (n, 2), n >= 2, of x [m, rad, m/s or rad/s], which rises, and F [N or
    N m]; straight between them, or `smooth`. A force at x = 0 is a preload, which no damper may have. Raises
    `InputError`, of a table that folds over itself with the two points."""

    points: Any
    smooth: bool = False
    kind: ClassVar[str] = "force_table"

    def __post_init__(self) -> None:
        table = require_array(self.points, "ForceTable: points", (None, 2))
        if len(table) < 2:
            raise InputError(f"ForceTable: at least two points are needed, got {len(table)}")
        falls = np.diff(table[:, 0]) <= 0.0
        if np.any(falls):
            i = int(np.argmax(falls))
            raise InputError(
                f"ForceTable: the table folds over itself, x must rise from point to point, got {table[i, 0]:g} and "
                f"then {table[i + 1, 0]:g} (points {i} and {i + 1}); sort it, and give a jump a little width"
            )
        if not isinstance(self.smooth, (bool, np.bool_)):
            raise InputError(f"ForceTable: smooth must be True or False, got {self.smooth!r}")
        object.__setattr__(self, "points", tuple((x, F) for x, F in table.tolist()))
        object.__setattr__(self, "smooth", bool(self.smooth))

    @property
    def ends(self) -> tuple[float, float]:
        return self.points[0][0], self.points[-1][0]

    @cached_property
    def pieces(self) -> Pieces:
        x, F = np.array(self.points).T
        if self.smooth:
            from scipy.interpolate import PchipInterpolator

            cubic = PchipInterpolator(x, F)
            lines = np.zeros((len(x) + 1, TERMS))
            lines[1:-1, :4] = cubic.c[::-1].T
            lines[[0, -1], 0], lines[[0, -1], 1] = F[[0, -1]], cubic.derivative()(x[[0, -1]])
            breaks, origin = x, np.concatenate([x[:1], x])
        else:
            lines = np.zeros((len(x) - 1, TERMS))
            lines[:, 0], lines[:, 1] = F[:-1], np.diff(F) / np.diff(x)
            breaks, origin = x[1:-1], x[:-1]
        return Pieces(breaks, origin, lines, np.zeros(len(origin)), np.ones(len(origin)))

    def describe(self) -> dict[str, Any]:
        return {"kind": self.kind, "points": [list(point) for point in self.points], "smooth": self.smooth}
