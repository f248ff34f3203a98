"""Small-sliding contact (joint interfaces): its options in a scene, and its cells in a reduced body.

SmallSliding  options of a `Contact` with small sliding
LapSurface    the cells of a matched face of a reduced body
"""

from __future__ import annotations

from warpffrf.model.laps.lap_surface import LapSurface
from warpffrf.model.laps.sliding import SmallSliding

__all__ = ["LapSurface", "SmallSliding"]
