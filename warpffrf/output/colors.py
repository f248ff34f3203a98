"""Colour maps and legend pictures of the recording; ranges are fixed over a run."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

LEVELS = 256
PRESSURE_STOPS = ("#c9ced6", "#ffe066", "#ff9f1c", "#e63946", "#6a040f")  # grey where nothing presses
DISPLACEMENT_STOPS = ("#dfe7ee", "#74c0e3", "#2a7fb8", "#1b3a8a", "#2d0a4e")


@dataclass(frozen=True)
class ColorScale:
    """A fixed range [0, top] of a quantity and its colours; `label` has the unit, `factor` converts SI to that unit."""

    label: str
    top: float
    factor: float
    stops: tuple[str, ...]

    def table(self) -> np.ndarray:
        """(LEVELS, 3) uint8 colours from 0 to top."""
        stops = np.array([[int(s[i : i + 2], 16) for i in (1, 3, 5)] for s in self.stops], dtype=float)
        t = np.linspace(0.0, len(stops) - 1.0, LEVELS)
        return (
            np.stack([np.interp(t, np.arange(len(stops)), stops[:, c]) for c in range(3)], axis=1)
            .round()
            .astype(np.uint8)
        )

    def rgb(self, values: np.ndarray) -> np.ndarray:
        """(..., 3) uint8 colours of SI values; below 0 and above the top take the end colours."""
        level = (
            np.clip(np.nan_to_num(values) / self.top * (LEVELS - 1), 0, LEVELS - 1)
            if self.top > 0
            else np.zeros_like(values)
        )
        return self.table()[level.astype(int)]

    def packed(self, values: np.ndarray) -> np.ndarray:
        """(n,) uint32 0xRRGGBBAA."""
        c = self.rgb(values).astype(np.uint32)
        return (c[:, 0] << 24) | (c[:, 1] << 16) | (c[:, 2] << 8) | np.uint32(0xFF)


def legend_picture(scales: list[ColorScale]) -> np.ndarray:
    """Horizontal colour bars with ticks and units, one under the other: (height, width, 3) uint8."""
    from matplotlib.backends.backend_agg import FigureCanvasAgg
    from matplotlib.colorbar import ColorbarBase
    from matplotlib.colors import ListedColormap, Normalize
    from matplotlib.figure import Figure

    figure = Figure(figsize=(6.0, 0.95 * len(scales)), dpi=110)
    canvas = FigureCanvasAgg(figure)
    for n, scale in enumerate(scales):
        axes = figure.add_axes((0.05, 1.0 - (n + 0.48) / len(scales), 0.9, 0.26 / len(scales)))
        top = scale.top * scale.factor if scale.top > 0 else 1.0
        ColorbarBase(
            axes, cmap=ListedColormap(scale.table() / 255.0), norm=Normalize(0.0, top), orientation="horizontal"
        )
        axes.set_title(scale.label, fontsize=9, loc="left", pad=3)
        axes.tick_params(labelsize=8)
    canvas.draw()
    return np.asarray(canvas.buffer_rgba())[..., :3].copy()


def map_axes_picture(
    reach: float, z_first: float, z_last: float, shape: tuple[int, int]
) -> tuple[np.ndarray, tuple[int, int]]:
    """Labelled axes around an empty frame of `shape` (height, width) pixels, and the frame's upper left corner
    (x, y) in pixels.

    The arc runs from -reach to reach [m] to the right, the axis from z_first to z_last [m] upwards. Returns (h, w, 3)
    uint8.
    """
    from matplotlib.backends.backend_agg import FigureCanvasAgg
    from matplotlib.figure import Figure

    height, width = shape
    left, right, top, bottom, dpi = 80, 30, 14, 64, 100
    total = (width + left + right, height + top + bottom)
    figure = Figure(figsize=(total[0] / dpi, total[1] / dpi), dpi=dpi)
    canvas = FigureCanvasAgg(figure)
    axes = figure.add_axes((left / total[0], bottom / total[1], width / total[0], height / total[1]))
    axes.set(xlim=(-reach * 1e3, reach * 1e3), ylim=(z_first * 1e3, z_last * 1e3))
    axes.set(xlabel="arc from the line of centres [mm]", ylabel="along the axis [mm]")
    canvas.draw()
    return np.asarray(canvas.buffer_rgba())[..., :3].copy(), (left, top)
