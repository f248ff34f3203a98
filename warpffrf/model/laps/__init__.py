"""Small-sliding contact (joint interfaces, laps): its cells, and its data in a reduced body.

LapCells      the cells of a face, or of the overlap of two faces, as requested from `reduce`
LapSurface    the cells of a reduced body
Lap           the contact in a scene, within a body or between two
"""

from __future__ import annotations

from warpffrf.model.laps.lap import Lap
from warpffrf.model.laps.lap_surface import LapCells, LapSurface

__all__ = ["Lap", "LapCells", "LapSurface"]
