"""Quality of a reduced body on one page: mode shapes, compliance decay, frequency coverage, key figures."""

from __future__ import annotations

import os
import textwrap
from pathlib import Path
from typing import Any

import numpy as np

from warpffrf.model.errors import InputError, require_count
from warpffrf.model.reduced.body import ReducedBody
from warpffrf.model.reduced.contact_surface import ContactSurface
from warpffrf.output.plots.figure import PROFILE, REFERENCE
from warpffrf.output.plots.modes import MovedSkin, draw_shape, mode_skin, shapes_figure
from warpffrf.output.plots.picture import write_picture
from warpffrf.output.plots.restyle import restyle

GALLERY = (2, 4)  # rows and columns of mode pictures
FIRST_ELASTIC = 7  # modes 1 to 6 of a free body are rigid-body motions
DPI = 100
SIZE = (16.0, 12.0)  # inch: 1600 x 1200 pixels
TEXT_WIDTH = 52  # characters per line of the text column
TEXT_LINES = 70  # lines of the text column
MOST_SURFACES = 2  # contact surfaces in the plot of decay
ALONG, OTHER = "#2a9d5c", "#8a5bb5"


def write_quality_page(
    body: ReducedBody, path: str | os.PathLike[str], *, theme: str = "light", overwrite: bool = False
) -> Path:
    """Write the page to `path` (.png, .pdf, .svg), in the "light" or "dark" theme; returns the path. Raises
    `InputError` if it cannot be written, or exists and `overwrite` is not set."""
    return write_picture(restyle(quality_figure(body), theme), path, "quality page", overwrite=overwrite, dpi=DPI)


def quality_figure(body: ReducedBody) -> Any:
    """The page as a matplotlib Figure, 1600 x 1200 pixels at `DPI`."""
    from matplotlib.backends.backend_agg import FigureCanvasAgg
    from matplotlib.figure import Figure

    figure = Figure(figsize=SIZE)
    FigureCanvasAgg(figure)
    grid = figure.add_gridspec(
        3, 3, width_ratios=[1, 1, 1.0], height_ratios=[1, 1, 1.25], left=0.055, right=0.985, top=0.925, bottom=0.06
    )
    figure.suptitle(f"Reduced body {body.provenance.get('mesh_name') or '(unnamed)'}: quality", fontsize=15, x=0.5)
    gallery(figure, grid[:2, :2], body)
    decay(figure.add_subplot(grid[2, 0]), body)
    frequencies(figure.add_subplot(grid[2, 1]), body)
    _text(figure.add_subplot(grid[:, 2]), body)
    return figure


def gallery(figure: Any, place: Any, body: ReducedBody) -> None:
    """The first elastic modes on the skin, coloured by displacement; the undeformed skin if there are none."""
    rows, columns = GALLERY
    count = min(len(body.frequencies), rows * columns)
    skin = mode_skin(body)
    if not len(skin.triangles):
        _say(figure.add_subplot(place), "this body has no skin to draw")
        return
    cells = place.subgridspec(rows, columns, wspace=0.04, hspace=0.14) if count else place.subgridspec(1, 1)
    for mode in range(max(count, 1)):
        ax = figure.add_subplot(cells[divmod(mode, columns)])
        u = skin.shape(body, mode) if count else np.zeros_like(skin.points)
        title = _mode_name(body, mode) if count else "no global modes: the skin, undeformed"
        draw_shape(ax, [MovedSkin(skin.points, skin.triangles, u)], title)


def modes_figure(body: ReducedBody, count: int = GALLERY[0] * GALLERY[1]) -> Any:
    """A matplotlib Figure of the first `count` elastic modes, deformed skins in colour over the undeformed one in grey.
    Raises `InputError` for a body without skin or without elastic modes, and a count below 1."""
    count = min(require_count(count, "plot_modes: count", 1), len(body.frequencies))
    skin = mode_skin(body)
    if not len(skin.triangles):
        raise InputError("plot_modes: this body has no skin to draw; reduce it from a mesh with cells or facets")
    if not count:
        raise InputError("plot_modes: this body has no elastic modes; reduce it with modes= or max_frequency=")
    shapes = [
        (_mode_name(body, mode), [MovedSkin(skin.points, skin.triangles, skin.shape(body, mode))])
        for mode in range(count)
    ]
    return shapes_figure(
        shapes, f"{body.provenance.get('mesh_name') or 'reduced body'}: elastic modes of the free body"
    )


def _mode_name(body: ReducedBody, mode: int) -> str:
    return f"{mode + FIRST_ELASTIC}: {_hertz(body.frequencies[mode])}"


def node_response(surface: ContactSurface, column: int, row: int) -> np.ndarray:
    """D (columns, rows) [m/N]: normal displacement of every contact node per unit force on one, by the local modes."""
    grid = surface.grid
    c, rows = grid.columns_per_sector, grid.rows
    blocks = surface.lags.reshape(len(surface.lags), c, rows, c, rows)
    j = np.arange(grid.columns)
    lag = (j // c - column // c) % len(surface.lags)
    return blocks[lag, j % c, :, column % c, row]


def decay(ax: Any, body: ReducedBody) -> None:
    """Displacement per unit force on a central contact node, against the distance from it."""
    if not body.contact_surfaces:
        _say(ax, "no contact surface, no local modes")
        return
    stiffness = (2.0 * np.pi * body.frequencies) ** 2
    shown = list(body.contact_surfaces.values())[:MOST_SURFACES]
    for n, surface in enumerate(shown):
        grid = surface.grid
        j, k = grid.columns // 2, grid.rows // 2
        local = node_response(surface, j, k)
        normal = surface.mode_normal.reshape(grid.columns, grid.rows, -1)
        whole = local + (normal / stiffness) @ normal[j, k] if len(stiffness) else local
        steps = np.abs(np.arange(grid.columns) - j)
        if grid.periodic:
            steps = np.minimum(steps, grid.columns - steps)
        arc = steps * grid.pitch * float(surface.shape.radius_at(grid.z[k]))
        prefix = f"{surface.name}, " if len(shown) > 1 else ""
        marker = "os"[n]
        _decay_line(ax, arc, local[:, k], PROFILE, marker, f"{prefix}around, local modes")
        _decay_line(ax, arc, whole[:, k], OTHER, marker, f"{prefix}around, with global modes", thin=True)
        _decay_line(ax, np.abs(grid.z - grid.z[k]), local[j], ALONG, marker, f"{prefix}along, local modes")
        ax.axhline(float(local[j, k]), color="0.6", lw=0.8, ls="--", label=None if n else "under the force itself")
    ax.set(xscale="log", yscale="log", xlabel="distance [mm]", ylabel="|displacement| per force [m/N]")
    ax.set_title("Decay of the compliance from a force in the middle\n(hollow: against the force)", fontsize=10)
    ax.grid(True, which="major", color="0.9", lw=0.6)
    ax.legend(frameon=False, fontsize=8, loc="lower left")


def _decay_line(
    ax: Any, distance: np.ndarray, values: np.ndarray, color: str, marker: str, label: str, *, thin: bool = False
) -> None:
    """Absolute values over the distance in mm; negative values have hollow markers."""
    use = np.flatnonzero((distance > 0.0) & (values != 0.0))
    use = use[np.argsort(distance[use], kind="stable")]
    x, y = distance[use] * 1e3, values[use]
    ax.plot(x, np.abs(y), color=color, lw=0.7 if thin else 1.0, label=label)
    against = y < 0.0
    size = 1.5 if thin else 3.0
    ax.plot(x[~against], np.abs(y[~against]), marker, ms=size, color=color)
    ax.plot(x[against], np.abs(y[against]), marker, ms=size, mfc="white", color=color, mew=0.7)


def frequencies(ax: Any, body: ReducedBody) -> None:
    """The number of modes up to each frequency, the covered range, and the requested one."""
    from matplotlib.ticker import MaxNLocator

    f = body.frequencies * 1e-3
    if not len(f):
        _say(ax, "no global modes, no range of frequencies")
        return
    facts = body.report.get("quality", {}).get("frequencies", {})
    number = np.arange(1, len(f) + 1)
    vibration = facts.get("vibration_modes") or 0
    covered, asked = facts.get("covered"), facts.get("max_frequency")
    if covered:
        ax.axvspan(0.0, covered * 1e-3, color=PROFILE, alpha=0.09, lw=0, label="covered: every mode of the FE model")
    if asked is not None:
        ax.axvline(asked * 1e-3, color=REFERENCE, lw=1.2, label=f"max_frequency {_hertz(asked)}")
    other = "attachment modes" if facts.get("covered") is not None else "modes of the basis"
    parts = ((slice(0, vibration), PROFILE, "vibration modes"), (slice(vibration, None), ALONG, other))
    for part, color, label in parts:
        if len(f[part]):
            ax.vlines(f[part], 0.0, number[part], color=color, lw=0.9)
            ax.plot(f[part], number[part], "o", ms=4.0, color=color, label=label)
    wide = f[-1] > 20.0 * f[0]
    ax.set(xlabel="frequency [kHz]", ylabel="number of modes up to it", ylim=(0.0, 1.08 * len(f)))
    if wide:
        ax.set_xscale("log")
        ax.set_xlim(0.7 * f[0], 1.4 * max(f[-1], (asked or 0.0) * 1e-3))
    else:
        ax.set_xlim(0.0, 1.05 * max(f[-1], (asked or 0.0) * 1e-3))
    ax.set_title("Frequencies of the global modes", fontsize=10)
    ax.yaxis.set_major_locator(MaxNLocator(integer=True))
    ax.legend(framealpha=0.85, edgecolor="none", fontsize=8, loc="upper left")


def _text(ax: Any, body: ReducedBody) -> None:
    """Key figures, wrapped to the column width."""
    ax.set_axis_off()
    lines: list[str] = []
    for line in body.info().splitlines():
        lines += textwrap.wrap(line, TEXT_WIDTH, subsequent_indent=" " * 6, drop_whitespace=True) or [""]
    if len(lines) > TEXT_LINES:
        lines = [*lines[: TEXT_LINES - 1], "... more: warpffrf info FILE"]
    ax.text(0.0, 1.0, "\n".join(lines), family="monospace", fontsize=9, va="top", transform=ax.transAxes)


def _say(ax: Any, text: str) -> None:
    ax.set_axis_off()
    ax.text(0.5, 0.5, text, ha="center", va="center", fontsize=11, color="0.4", transform=ax.transAxes)


def _hertz(frequency: float) -> str:
    return f"{frequency * 1e-3:.4g} kHz" if frequency >= 1e3 else f"{frequency:.4g} Hz"
