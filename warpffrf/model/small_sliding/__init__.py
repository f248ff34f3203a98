"""Small-sliding contact (joint interfaces): its options in a scene, and its cells in a reduced body.

SmallSliding    options of a `Contact` with small sliding
MatchedSurface  the cells of a matched face of a reduced body
"""

from __future__ import annotations

from warpffrf.model.small_sliding.matched_surface import MatchedSurface
from warpffrf.model.small_sliding.sliding import SmallSliding

__all__ = ["MatchedSurface", "SmallSliding"]
