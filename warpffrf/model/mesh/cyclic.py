"""How a mesh of equal sectors is numbered, and the axis that they stand around."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from warpffrf.model.errors import require_array, require_count, require_direction


@dataclass(frozen=True, eq=False)
class Cyclic:
    """Rotational periodicity: `sectors` equal sectors about the line `axis_point` + t `axis_direction` (user frame, m).

    Numbering is sector-major: with `nn` nodes a sector, node `s*nn + i` is node `i` turned by `2 pi s / sectors`,
    right-handed about `axis_direction`; cells and full facet sets likewise.
    """

    sectors: int
    axis_point: np.ndarray
    axis_direction: np.ndarray

    def __post_init__(self) -> None:
        object.__setattr__(self, "sectors", require_count(self.sectors, "cyclic: sectors", 3))
        object.__setattr__(self, "axis_point", require_array(self.axis_point, "cyclic: axis_point", (3,)))
        direction = require_direction(self.axis_direction, "cyclic: axis_direction")
        object.__setattr__(self, "axis_direction", direction)
