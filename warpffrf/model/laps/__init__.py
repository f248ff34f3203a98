"""Laps, joints that slide a little: how their faces are split into cells, and what a reduced body knows of them.

LapCells      the cells of a face, or of the overlap of two faces, as `reduce` is asked for them
LapSurface    the cells of a reduced body
Lap           the joint in a scene, within a body or between two
"""

from __future__ import annotations

from warpffrf.model.laps.lap import Lap
from warpffrf.model.laps.lap_surface import LapCells, LapSurface

__all__ = ["Lap", "LapCells", "LapSurface"]
