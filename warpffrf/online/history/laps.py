"""Histories of laps, from the saved rows of their cells."""

from __future__ import annotations

import numpy as np

from warpffrf.model.laps import Lap
from warpffrf.model.laps.lap import LapCellsOf
from warpffrf.online.arrays.ring import SavedRows
from warpffrf.online.compile.laps import lap_order
from warpffrf.online.compile.scene import CompiledScene
from warpffrf.online.history.history import BodyHistory, LapHistory
from warpffrf.online.history.interface_motion import turned
from warpffrf_kernels.laps import keeping


def lap_histories(compiled: CompiledScene, rows: SavedRows, bodies: dict[str, BodyHistory]) -> dict[str, LapHistory]:
    """By name, in the order of the scene."""
    laps = compiled.scene.laps
    found, start = {}, 0
    for number in lap_order(laps):
        lap = laps[number]
        cells = lap.cells()
        count = len(cells.cell)
        found[lap.name] = _history(lap, cells, rows["saved_lap"][:, start : start + count], bodies)
        start += count
    return {lap.name: found[lap.name] for lap in laps}


def _history(lap: Lap, cells: LapCellsOf, saved: np.ndarray, bodies: dict[str, BodyHistory]) -> LapHistory:
    """Of the numbers (T, c, `keeping.NUMBERS`) of its cells."""
    force = np.einsum("tck,cki->tci", saved[:, :, :3], cells.frames)
    arm = cells.points - lap.a.surface.points.mean(axis=0)
    rotation = bodies[lap.a.body.name].rotation
    area = cells.area[None, :]
    slipped = slice(int(keeping.SLIPPED), int(keeping.SLIPPED) + 2)
    return LapHistory(
        force=turned(rotation, force.sum(axis=1)), torque=turned(rotation, np.cross(arm, force).sum(axis=1)),
        normal_force=saved[:, :, 0].sum(axis=1), pressure=saved[:, :, 0] / area,
        traction=saved[:, :, 1:3] / area[:, :, None], gap=saved[:, :, int(keeping.GAP)].copy(),
        slip=saved[:, :, slipped].copy(), state=saved[:, :, int(keeping.STATE)].astype(np.int8),
        loss=saved[:, :, int(keeping.LOST)].copy(),
    )  # fmt: skip
