"""Pretensions from the rows that a run has saved."""

from __future__ import annotations

from warpffrf.online.arrays.ring import SavedRows
from warpffrf.online.compile.pretension import TensionTable
from warpffrf.online.history.history import ForceHistory


def tension_histories(table: TensionTable, rows: SavedRows) -> dict[str, ForceHistory]:
    """Force on the second body, and the coordinate, of every pretension."""
    found: dict[str, ForceHistory] = {}
    for name, row in table.rows.items():
        wrench = rows["saved_row_wrench"][:, row]
        found[name] = ForceHistory(
            wrench[:, :3].copy(), wrench[:, 3:].copy(), rows["saved_coordinate"][:, row, None].copy()
        )
    return found
