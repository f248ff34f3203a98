"""Limit of the number of cells of generated meshes."""

from __future__ import annotations

import math
from typing import Any

from warpffrf.model.errors import InputError

MOST_CELLS = 50_000_000  # some 30 GB of mesh, and far above what can be reduced


def require_cells(label: str, *counts: Any) -> None:
    """Raise `InputError` where the whole numbers of cells in all directions, multiplied, are more than `MOST_CELLS`;
    entries that are not numbers are left to other checks. To be called before anything is allocated."""
    cells = math.prod(max(n, 1) for n in counts if isinstance(n, int) and not isinstance(n, bool))
    if cells > MOST_CELLS:
        raise InputError(f"{label}: {cells:.3g} cells are more than {MOST_CELLS:.3g}; make the cells larger")
