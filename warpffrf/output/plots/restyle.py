r"""Theme and size of a finished matplotlib figure: light or dark, for a screen or for a printed column.

Figures are drawn once, in light colours, and changed afterwards, so that no drawing function knows of themes. In the
dark theme greys exchange black for white, and colours darker than the middle become as much lighter, with their hue:
l' = (1 - w) (1 - l) + w max(l, 1 - l) of the lightness l, with w from 0 of a grey, up to the saturation `GREY`, to 1 of
a colour, from `COLORED` on; both then lie between the colours of paper and ink. In maps that begin with a light grey
only greys change, with w l in place of w max(l, 1 - l); maps of matplotlib that begin light are reversed.

Afterwards titles and labels longer than their axes are broken into lines, and a legend that covers a curve, or is wider
than its axes, moves to another corner or below the axes.
"""

from __future__ import annotations

import textwrap
from typing import Any

import numpy as np

from warpffrf.model.errors import InputError, require_number, suggestion

THEMES = ("light", "dark")
PAPER, INK = np.array([0.082, 0.094, 0.114]), np.array([0.93, 0.94, 0.95])  # of the dark theme
GREY, COLORED = 0.1, 0.4  # saturations
BRIGHT = 0.7  # lightness of the first colour of a map that is changed
BODIES = "bodies"  # name of colour maps of bodies, which have the same colours in both themes
CURVES = "curves"  # name of colour maps of curves, whose colours change as those of the curves
INCH = 0.0254  # m
PANEL = 0.088  # m: narrowest panel with legible text
FONTS, SHRUNK = (6.5, 8.5), 0.75  # points in print, and of the size on a screen
BROADER = 1.0  # of its axes: longest line of a title
COLUMN, POINTS = 5.0, 72.0  # heights of letters next to the text of a legend, and points in an inch
FEWEST = 12  # letters in a line
BELOW = -0.2  # of the height of axes: legends under their labels
CORNERS = ("upper right", "upper left", "lower right", "lower left")


def restyle(figure: Any, theme: str = "light", width: float | None = None) -> Any:
    """Change a matplotlib figure of this package to a `theme`, "light" or "dark", and to a `width` [m] of print, with
    text of 6.5 to 8.5 points; None: as drawn. Returns the figure. Raises InputError for an unknown theme and a width
    that is not positive."""
    require_theme(theme)
    if width is not None:
        _resize(figure, require_number(width, "restyle: width", positive=True) / INCH)
    if theme == "dark":
        darken(figure)
    _lay_out(figure)
    if _break_lines(figure):
        _lay_out(figure)
    while any([_clear_legend(ax) for ax in figure.axes]):  # one that is below leaves less room for the others
        _lay_out(figure)
    return figure


def require_theme(theme: str) -> None:
    """Raises InputError for an unknown theme."""
    if theme not in THEMES:
        raise InputError(f"theme is {theme!r}{suggestion(str(theme), THEMES)}")


def columns_in(width: float | None, most: int) -> int:
    """Panels side by side in a page of `width` [m], at most `most`."""
    return most if width is None else int(np.clip(np.floor(width / PANEL), 1, most))


def darkened(colors: Any, *, of_map: bool = False) -> np.ndarray:
    """(n, 4) colours of the dark theme for those of the light one, or of one of its maps."""
    from matplotlib.colors import to_rgba_array

    rgba = to_rgba_array(colors)
    rgb = rgba[:, :3]
    low, high = rgb.min(axis=1, keepdims=True), rgb.max(axis=1, keepdims=True)
    light = 0.5 * (low + high)
    room = np.maximum(1.0 - np.abs(2.0 * light - 1.0), 1e-9)  # of the saturation
    w = np.clip(((high - low) / room - GREY) / (COLORED - GREY), 0.0, 1.0)
    other = (1.0 - w) * (1.0 - light) + w * (light if of_map else np.maximum(light, 1.0 - light))
    rgb = other + (rgb - light) * (1.0 - np.abs(2.0 * other - 1.0)) / room
    return np.concatenate([PAPER + (INK - PAPER) * np.clip(rgb, 0.0, 1.0), rgba[:, 3:]], axis=1)


def darken(figure: Any) -> None:
    """Change the colours of a matplotlib figure to the dark theme, unless its paper is dark."""
    from matplotlib.cm import ScalarMappable
    from matplotlib.collections import LineCollection
    from matplotlib.contour import ContourSet
    from matplotlib.lines import Line2D
    from matplotlib.patches import Patch
    from matplotlib.text import Text

    if np.allclose(figure.get_facecolor()[:3], PAPER):
        return

    def other(color: Any) -> Any:
        return color if isinstance(color, str) and color in ("none", "auto") else darkened(color)[0]

    done, ink, grid = set(), other("black"), other("0.85")
    for ax in _axes_of(figure):
        for axis in (ax.xaxis, ax.yaxis):
            axis.set_tick_params(which="both", color=ink, labelcolor=ink, grid_color=grid)
            for tick in (*axis.get_major_ticks(), *axis.get_minor_ticks()):
                done |= {axis.offsetText, tick.tick1line, tick.tick2line, tick.gridline, tick.label1, tick.label2}
    for part in figure.findobj():
        if part in done:
            continue
        if isinstance(part, Text):
            if part.get_bbox_patch() is None:  # one with a box has a background of its own
                part.set_color(other(part.get_color()))
        elif isinstance(part, Line2D):
            edge, face = part.get_markeredgecolor(), part.get_markerfacecolor()
            part.set_color(other(part.get_color()))
            part.set(markeredgecolor=other(edge), markerfacecolor=other(face))
        elif isinstance(part, Patch):
            edge, face, alpha = part.get_edgecolor(), part.get_facecolor(), part.get_alpha()
            part.set(edgecolor=other(edge), facecolor=other(face), alpha=alpha)
        elif isinstance(part, LineCollection) or (isinstance(part, ContourSet) and not part.filled):
            part.set_edgecolor(list(darkened(part.get_edgecolor())))
        elif isinstance(part, ScalarMappable) and part.get_array() is not None:
            part.set_cmap(_dark_map(part.get_cmap()))


def _dark_map(cmap: Any) -> Any:
    from matplotlib.colors import ListedColormap

    table = cmap(np.arange(cmap.N))
    if cmap.name in (BODIES, CURVES):
        return cmap if cmap.name == BODIES else ListedColormap(darkened(table), CURVES)
    if table[0, :3].min() + table[0, :3].max() < 2.0 * BRIGHT:
        return cmap
    return cmap.reversed() if cmap.name.endswith("_r") else ListedColormap(darkened(table, of_map=True), cmap.name)


def _axes_of(figure: Any) -> list[Any]:
    """All axes, those of colour bars as well."""
    return [part for ax in figure.axes for part in (ax, *ax.child_axes)]


def _resize(figure: Any, width: float) -> None:
    from matplotlib.lines import Line2D
    from matplotlib.text import Text

    high = figure.get_figheight() * width / figure.get_figwidth()
    figure.set_size_inches(width, high)
    for text in figure.findobj(Text):
        text.set_fontsize(np.clip(SHRUNK * text.get_fontsize(), *FONTS))
    for line in figure.findobj(Line2D):
        line.set(linewidth=SHRUNK * line.get_linewidth(), markersize=SHRUNK * line.get_markersize())
    for ax in _axes_of(figure):
        for axis in (ax.xaxis, ax.yaxis):
            sizes = [text.get_fontsize() for text in axis.get_ticklabels()]
            axis.set_tick_params(which="both", labelsize=sizes[0] if sizes else FONTS[0])


def _lay_out(figure: Any) -> None:
    engine = figure.get_layout_engine()
    figure.draw_without_rendering() if engine is None else engine.execute(figure)


def _break_lines(figure: Any) -> bool:
    """Break titles and labels that are longer than their axes; True if there were some."""
    broken = False
    for ax in _axes_of(figure):
        box = ax.get_window_extent()
        along = ((ax.title, BROADER * box.width), (ax.xaxis.label, BROADER * box.width))
        for text, room in along:
            broken |= _break(text, text.get_window_extent().width, room)
        broken |= _break(ax.yaxis.label, ax.yaxis.label.get_window_extent().height, box.height)
    for text in figure.texts:
        broken |= _break(text, text.get_window_extent().width, figure.bbox.width)
    return broken


def _break(text: Any, length: float, room: float) -> bool:
    """Break the lines of a text of this length where there is less room."""
    if length <= room:
        return False
    lines = text.get_text().replace(" = ", "\N{NO-BREAK SPACE}=\N{NO-BREAK SPACE}").split("\n")
    most = max(int(max(map(len, lines)) * room / length), FEWEST)
    broken = [part for line in lines for part in textwrap.wrap(line, most, break_long_words=False)]
    text.set_text("\n".join(broken))
    return len(broken) > len(lines)


def _clear_legend(ax: Any) -> bool:
    """Move the legend of `ax` to a corner where it covers no curve; if there is none, below the axes. True if there."""
    legend = ax.get_legend()
    if legend is None or ax.name != "rectilinear" or not ax.bbox.overlaps(legend.get_window_extent()):
        return False
    axes = [one for one in ax.figure.axes if one.bbox.bounds == ax.bbox.bounds]  # with its twin
    if legend.get_window_extent().width < ax.bbox.width:
        for corner in (None, *CORNERS):
            if corner is not None:
                legend.set_loc(corner)
            if not any(_covers(legend, one) for one in axes):
                return False
    texts = legend.get_texts()
    size, color = texts[0].get_fontsize(), texts[0].get_color()
    letter = size * ax.figure.dpi / POINTS
    column = max(text.get_window_extent().width for text in texts) + COLUMN * letter
    labels = ax.bbox.y0 - ax.xaxis.get_tightbbox().y0
    below = ax.legend(
        legend.legend_handles, [text.get_text() for text in texts], loc="upper center", bbox_to_anchor=(0.5, 0.0),
        ncols=int(np.clip(ax.bbox.width / column, 1, len(texts))), fontsize=size, labelcolor=color, frameon=False,
        borderaxespad=labels / letter,
    )  # fmt: skip
    if len(ax.figure.axes) == 1:  # a page keeps its height
        ax.figure.set_figheight(ax.figure.get_figheight() + below.get_window_extent().height / ax.figure.dpi)
    return True


def _covers(legend: Any, ax: Any) -> bool:
    box = legend.get_window_extent()
    paths = [line.get_transform().transform_path(line.get_path()) for line in ax.get_lines() if len(line.get_xdata())]
    return any(path.intersects_bbox(box, filled=False) for path in paths)
