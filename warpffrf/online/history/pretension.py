"""Pretensions, and preloads of springs in time, from the rows that a run has saved."""

from __future__ import annotations

from dataclasses import replace

from warpffrf.online.arrays.ring import SavedRows
from warpffrf.online.compile.pretension import TensionTable
from warpffrf.online.history.history import ForceHistory


def with_pulls(forces: dict[str, ForceHistory], pulls: dict[str, ForceHistory]) -> dict[str, ForceHistory]:
    """`forces` with the `pulls`; that of a spring, by the same name, is part of its force."""
    found = dict(forces)
    for name, pull in pulls.items():
        own = forces.get(name)
        found[name] = (
            pull if own is None else replace(own, force=own.force + pull.force, torque=own.torque + pull.torque)
        )
    return found


def tension_histories(table: TensionTable, rows: SavedRows) -> dict[str, ForceHistory]:
    """Force on the second body, and the coordinate, of every pretension."""
    found: dict[str, ForceHistory] = {}
    for name, row in table.rows.items():
        wrench = rows["saved_row_wrench"][:, row]
        found[name] = ForceHistory(
            wrench[:, :3].copy(), wrench[:, 3:].copy(), rows["saved_coordinate"][:, row, None].copy()
        )
    return found
