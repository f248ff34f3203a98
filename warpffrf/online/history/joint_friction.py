"""Friction in joints from the rows that a run has saved."""

from __future__ import annotations

import numpy as np

from warpffrf.online.arrays.ring import SavedRows
from warpffrf.online.compile.joint_friction import SlipTable
from warpffrf.online.history.history import ForceHistory, JointFrictionHistory

ALONG, AROUND = 0, 1


def friction_histories(table: SlipTable, rows: SavedRows) -> dict[str, ForceHistory]:
    """Force and torque of the friction in every joint, and stick and slip."""
    found: dict[str, ForceHistory] = {}
    T = len(rows["saved_time"])
    for e, (name, law) in enumerate(table.laws.items()):
        own = table.rows[name]
        wrench = rows["saved_row_wrench"][:, own]
        velocity, traction = np.zeros((T, 2)), np.zeros((T, 2))
        for r, coordinate in enumerate(law.coordinates):
            direction = ALONG if coordinate.kind == "translation" else AROUND
            velocity[:, direction] = rows["saved_surface_velocity"][:, e, r]
            traction[:, direction] = rows["saved_surface_traction"][:, e, r]
        found[name] = ForceHistory(
            wrench[:, :, :3].sum(axis=1), wrench[:, :, 3:].sum(axis=1), rows["saved_coordinate"][:, own].copy(),
            JointFrictionHistory(
                state=(rows["saved_slipping"][:, e] + 1).astype(np.int8), slip_velocity=velocity, traction=traction,
                bound=rows["saved_slip_bound"][:, e].copy(), power=rows["saved_slip_power"][:, e].copy(),
            ),
        )  # fmt: skip
    return found
