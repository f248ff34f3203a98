"""Colours of numbers between two ends, evenly or in equal ratios, for lines on white."""

from __future__ import annotations

from typing import Any

MAP = "viridis"
BRIGHTEST = 0.93  # of the colour map; above it lines are hard to see on white
LEVELS = 256


def value_colors(low: float, high: float, *, ratios: bool) -> Any:
    """A matplotlib `ScalarMappable`: its `to_rgba(value)` is the colour of a value, and a colour bar is made of it."""
    from matplotlib import colormaps
    from matplotlib.cm import ScalarMappable
    from matplotlib.colors import ListedColormap, LogNorm, Normalize

    whole = colormaps[MAP]
    shown = ListedColormap([whole(BRIGHTEST * n / (LEVELS - 1)) for n in range(LEVELS)])
    return ScalarMappable((LogNorm if ratios else Normalize)(low, high), shown)
