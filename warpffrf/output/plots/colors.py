"""Colour maps and legend pictures; colour ranges are fixed over a run.

Value colors. Colours of numbers between two limits, on a linear or logarithmic scale, for lines on white.

Scales of axes: from zero, so that a small change looks small; cut if that would hide all variation, which the label
then states; and never so fine that round-off looks like a signal.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np

from warpffrf.output.contact.friction import STATES
from warpffrf.output.plots.restyle import BODIES, CURVES

LEVELS = 256
MOST_BARS = 3  # of a legend in one column
PRESSURE_STOPS = ("#c9ced6", "#ffe066", "#ff9f1c", "#e63946", "#6a040f")  # grey: no pressure
TRACTION_STOPS = ("#c9ced6", "#a8ddb5", "#43a2ca", "#0868ac", "#081d58")
SLIP_STOPS = ("#c9ced6", "#fdd0a2", "#fd8d3c", "#d94801", "#7f2704")
WEAR_STOPS = ("#c9ced6", "#d4b9da", "#df65b0", "#ce1256", "#67001f")
STATE_COLORS = ("#c9ced6", "#2a7fb8", "#ff9f1c")  # open, stick, slip
DISPLACEMENT_STOPS = ("#dfe7ee", "#74c0e3", "#2a7fb8", "#1b3a8a", "#2d0a4e")
STRESS_STOPS = ("#2b4c9b", "#3fa7d6", "#7bd389", "#f6d743", "#d7263d")
GAP_STOPS = ("#440154", "#3b528b", "#21918c", "#5ec962", "#fde725")
FRACTION_STOPS = ("#f6f1d5", "#74c0e3", "#1b3a8a")  # empty, full
INK = "#757c84"  # lines and text that are visible on black and on white
INK_RGB = (133, 140, 148)
UNKNOWN = (118, 118, 118)  # values that are not finite: dark grey, in no scale


def largest(values: list[np.ndarray]) -> float:
    """Largest finite value in the arrays; 0 if there is none."""
    tops = [float(np.max(v[np.isfinite(v)], initial=0.0)) for v in values]
    return max(tops, default=0.0)


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
        """(..., 3) uint8 colours of SI values, clipped to [0, top]; NaN is `UNKNOWN`."""
        level = (
            np.clip(np.nan_to_num(values) / self.top * (LEVELS - 1), 0, LEVELS - 1)
            if self.top > 0
            else np.zeros(np.shape(values))
        )
        found = self.table()[level.astype(int)]
        found[np.isnan(values)] = UNKNOWN
        return found

    def packed(self, values: np.ndarray) -> np.ndarray:
        """(n,) uint32 0xRRGGBBAA."""
        return _packed(self.rgb(values))


def _packed(rgb: np.ndarray) -> np.ndarray:
    c = rgb.astype(np.uint32)
    return (c[:, 0] << 24) | (c[:, 1] << 16) | (c[:, 2] << 8) | np.uint32(0xFF)


@dataclass(frozen=True)
class ColorClasses:
    """Colours of a classification: class n is called `names[n]`."""

    label: str
    names: tuple[str, ...]
    colors: tuple[str, ...]

    def table(self) -> np.ndarray:
        """(classes, 3) uint8."""
        return np.array([[int(c[i : i + 2], 16) for i in (1, 3, 5)] for c in self.colors], dtype=np.uint8)

    def rgb(self, values: np.ndarray) -> np.ndarray:
        """(..., 3) uint8 colours of class numbers."""
        return self.table()[np.clip(np.asarray(values).astype(int), 0, len(self.colors) - 1)]

    def packed(self, values: np.ndarray) -> np.ndarray:
        """(n,) uint32 0xRRGGBBAA."""
        return _packed(self.rgb(values))


def displacement_scale(top: float) -> ColorScale:
    """Colours of displacements up to `top` [m], in a suitable unit."""
    unit, per_metre = ("mm", 1e3) if top > 1e-3 else ("µm", 1e6)
    return ColorScale(f"elastic displacement of the bodies [{unit}]", top, per_metre, DISPLACEMENT_STOPS)


def field_scale(field: str, top: float, of: str = "") -> ColorScale | ColorClasses:
    """Colours of a field of `Skin.fields` or of the displacement up to `top` [SI]; `of`: the owner of the pressure."""
    if field == "displacement":
        return displacement_scale(top)
    if field == "state":
        return ColorClasses("state of the cells", STATES, STATE_COLORS)
    label, factor, stops = {
        "pressure": (f"{of} pressure [MPa]".strip(), 1e-6, PRESSURE_STOPS),
        "traction": ("tangential traction [MPa]", 1e-6, TRACTION_STOPS),
        "slip": ("slip speed [mm/s]", 1e3, SLIP_STOPS),
        "wear": ("wear index, pressure times slip speed [W/mm²]", 1e-6, WEAR_STOPS),
        "von_mises": ("von Mises stress [MPa]", 1e-6, STRESS_STOPS),
        "gap": ("gap of the film [µm]", 1e6, GAP_STOPS),
        "fraction": ("film fraction of the gap [-]", 1.0, FRACTION_STOPS),
    }[field]
    return ColorScale(label, top, factor, stops)


def legend_rows(scales: Sequence[ColorScale | ColorClasses]) -> int:
    """Bars below each other in `legend_picture`: more than `MOST_BARS` are placed in two columns."""
    return len(scales) if len(scales) <= MOST_BARS else -(-len(scales) // 2)


def legend_picture(scales: Sequence[ColorScale | ColorClasses]) -> np.ndarray:
    """Horizontal colour bars with ticks and units, or names, in one or two columns: (height, width, 4) uint8, on a
    transparent ground."""
    from matplotlib.backends.backend_agg import FigureCanvasAgg
    from matplotlib.figure import Figure

    rows = legend_rows(scales)
    columns = -(-len(scales) // rows)
    figure = Figure(figsize=(6.0 if columns == 1 else 8.0, 0.95 * rows), dpi=110)
    canvas = FigureCanvasAgg(figure)
    for n, scale in enumerate(scales):
        column, row = divmod(n, rows)
        corner = (column + 0.05) / columns, 1.0 - (row + 0.48) / rows
        axes = figure.add_axes((*corner, 0.9 / columns, 0.26 / rows))
        draw_bar(axes, scale)
        _in_ink(axes)
    return _transparent(figure, canvas)


def _in_ink(axes: Any) -> None:
    """Colour lines and text of matplotlib axes so that they are visible on black and on white."""
    axes.tick_params(colors=INK)
    axes.title.set_color(INK)
    axes._left_title.set_color(INK)
    axes.xaxis.label.set_color(INK)
    axes.yaxis.label.set_color(INK)
    axes.set_facecolor("none")
    for spine in axes.spines.values():
        spine.set_color(INK)


def _transparent(figure: Any, canvas: Any) -> np.ndarray:
    figure.patch.set_alpha(0.0)
    canvas.draw()
    return np.asarray(canvas.buffer_rgba()).copy()


def draw_bar(axes: Any, scale: ColorScale | ColorClasses) -> None:
    """A horizontal colour bar with ticks and unit, or names, on matplotlib axes."""
    from matplotlib.colorbar import ColorbarBase
    from matplotlib.colors import BoundaryNorm, ListedColormap, Normalize

    colors = ListedColormap(scale.table() / 255.0, BODIES)
    if isinstance(scale, ColorClasses):
        edges = np.arange(len(scale.names) + 1) - 0.5
        bar = ColorbarBase(
            axes, cmap=colors, norm=BoundaryNorm(edges, len(scale.names)), orientation="horizontal",
            ticks=[float(n) for n in range(len(scale.names))],
        )  # fmt: skip
        bar.minorticks_off()  # at the boundaries of classes
        bar.ax.set_xticklabels(scale.names)
    else:
        top = scale.top * scale.factor if scale.top > 0 else 1.0
        ColorbarBase(axes, cmap=colors, norm=Normalize(0.0, top), orientation="horizontal")
    axes.set_title(scale.label, fontsize=9, loc="left", pad=3)
    axes.tick_params(labelsize=8)


def map_axes_picture(
    right: tuple[float, float], up: tuple[float, float], labels: tuple[str, str], shape: tuple[int, int]
) -> tuple[np.ndarray, tuple[int, int]]:
    """Labelled axes around an empty frame of `shape` (height, width) pixels, (h, w, 4) uint8 on a transparent ground,
    and the frame's upper left corner (x, y) in pixels. right, up: first and last value of both axes."""
    from matplotlib.backends.backend_agg import FigureCanvasAgg
    from matplotlib.figure import Figure

    height, width = shape
    left, beside, top, bottom, dpi = 80, 30, 14, 64, 100
    total = (width + left + beside, height + top + bottom)
    figure = Figure(figsize=(total[0] / dpi, total[1] / dpi), dpi=dpi)
    canvas = FigureCanvasAgg(figure)
    axes = figure.add_axes((left / total[0], bottom / total[1], width / total[0], height / total[1]))
    axes.set(xlim=right, ylim=up, xlabel=labels[0], ylabel=labels[1])
    _in_ink(axes)
    return _transparent(figure, canvas), (left, top)


MAP = "viridis"
BRIGHTEST = 0.93  # of the colour map; brighter lines are hard to see on white


def value_colors(low: float, high: float, *, ratios: bool) -> Any:
    """A matplotlib `ScalarMappable`: `to_rgba(value)` returns the colour of a value; it also defines a colour bar."""
    from matplotlib import colormaps
    from matplotlib.cm import ScalarMappable
    from matplotlib.colors import ListedColormap, LogNorm, Normalize

    whole = colormaps[MAP]
    shown = ListedColormap([whole(BRIGHTEST * n / (LEVELS - 1)) for n in range(LEVELS)], CURVES)
    return ScalarMappable((LogNorm if ratios else Normalize)(low, high), shown)


HEADROOM = 1.08  # of the largest value of a plot
SMALL = 0.1  # of the mean: a smaller variation is a flat line on a scale from zero
FLAT = 1e-3  # of the mean: a smaller variation is not drawn, so that a constant does not look like a vibration
ROOM = 0.1  # of the range, above and below the values on a cut axis
FINEST = 1e-4  # of the largest value: smallest range of a panel's axis
LEAST = 1e-6  # of a quantity's size: smallest range of an axis, except for motions, which no iteration computes


def from_zero(ax: Any, values: Any, *beside: Any, least: float = 0.0) -> None:
    """Scale the y axis of `ax`, which has its label, from zero to slightly above the largest of `values` (n,) and of
    the other values drawn, `beside`, at least to `least`: smaller values are round-off.

    If all of them vary by less than `SMALL` of their mean, and `values` by more than `FLAT`, the axis is cut to their
    range instead, and its label states the variation of `values`. Non-finite values are ignored.
    """
    own = _finite(values)
    drawn = np.concatenate([own, *(_finite(v) for v in beside)])
    low, high = float(drawn.min(initial=np.inf)), float(drawn.max(initial=0.0))
    mean, spread = 0.5 * (low + high), high - low
    if low > 0.0 and high > least and np.isfinite(mean) and spread < SMALL * mean and np.ptp(own) > FLAT * mean:
        ax.set_ylim(low - ROOM * spread, high + ROOM * spread)
        ax.ticklabel_format(axis="y", useOffset=False, style="plain")
        label = ax.yaxis.label
        vary = 100.0 * np.ptp(own) / np.mean(own)
        ax.set_ylabel(f"{label.get_text()}\naxis cut, varies by {vary:.2g} %", color=label.get_color())
    else:
        ax.set_ylim(0.0, HEADROOM * max(high, least) or 1.0)


def no_finer(ax: Any, least: float) -> None:
    """Widen the y axis of `ax` about its middle to a range of at least `least`."""
    low, high = ax.get_ylim()
    if high - low < least:
        middle = 0.5 * (low + high)
        ax.set_ylim(middle - 0.5 * least, middle + 0.5 * least)


def about_zero(ax: Any, least: float) -> None:
    """Extend the y axis of `ax` to at least -`least` to `least`."""
    low, high = ax.get_ylim()
    ax.set_ylim(min(low, -least), max(high, least))


def instant(time: float) -> str:
    """A time [s] as text, in ms below a second."""
    return f"{time:.6g} s" if abs(time) >= 1.0 else f"{1e3 * time:.4g} ms"


def side_bar(ax: Any, image: Any, **options: Any) -> Any:
    """A colour bar of `image` at the right of `ax`, as high as these, whatever their aspect."""
    return ax.figure.colorbar(image, cax=ax.inset_axes((1.03, 0.0, 0.045, 1.0)), **options)


def _finite(values: Any) -> np.ndarray:
    found = np.ravel(np.asarray(values, dtype=float))
    return found[np.isfinite(found)]
