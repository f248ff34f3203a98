"""A picture of several plots side by side, each of curves over one pair of axes; matplotlib is imported when drawn.

Overlay. Curves of two runs, one over the other, one panel per quantity.

One row. Plots of a run of one saved row, such as an equilibrium: bars and numbers instead of histories with one point.

Histories. Plots of one named history of a run: its spectrum, and spectra of windows, over frequency or with the
rotation of a body.
"""

from __future__ import annotations

import math
import os
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any, Protocol

import numpy as np

from warpffrf.model.errors import InputError
from warpffrf.output.contact.hertz import hertz
from warpffrf.output.plots.colors import FINEST, LEAST, largest, no_finer
from warpffrf.output.plots.picture import write_picture
from warpffrf.output.plots.restyle import columns_in, restyle

PANEL_SIZE = (5.2, 3.9)  # inches
COLUMNS = 3  # maximum side by side
DPI = 110
COLORS = ("#1b6ca8", "#d1495b", "#2a9d6f", "#b57f00", "#6d5aa8", "#4f5d6b")
REFERENCE_DASH = (0, (5, 3))
STYLES = ("-", "--", ":", "-.")  # another line style after all colours, so that no line is used twice
MARKS = "os^D"
RINGS = 6  # with a value, of a polar panel, at most


class Drawn(Protocol):
    """An item of `save_panels`; one with a `projection` is drawn on axes of that kind."""

    def draw(self, ax: object) -> None:
        """Draw on matplotlib axes."""


@dataclass(frozen=True)
class Panel:
    """One plot: `curves` {name: (x (n,), y (n,))} as lines, `reference` likewise, dashed and on top of them, `points`
    likewise, as markers.

    `limits`: the range (low, high) of y to show, for diverging curves; `equal`: x and y on one scale, for paths.
    """

    title: str
    x_label: str
    y_label: str
    curves: Mapping[str, tuple[np.ndarray, np.ndarray]]
    reference: Mapping[str, tuple[np.ndarray, np.ndarray]] | None = None
    limits: tuple[float, float] | None = None
    points: Mapping[str, tuple[np.ndarray, np.ndarray]] | None = None
    equal: bool = False

    def draw(self, ax: object) -> None:
        """Draw on matplotlib axes."""
        axes: Any = ax
        for n, (name, (x, y)) in enumerate(self.curves.items()):
            style = STYLES[n // len(COLORS) % len(STYLES)]
            axes.plot(x, y, style, lw=1.4, color=COLORS[n % len(COLORS)], label=name)
        for n, (name, (x, y)) in enumerate((self.reference or {}).items()):
            color = "black" if n == 0 else COLORS[-1 - n]
            axes.plot(x, y, lw=1.0, color=color, ls=REFERENCE_DASH, marker="o" if len(x) == 1 else None, label=name)
        for n, (name, (x, y)) in enumerate((self.points or {}).items()):
            axes.plot(x, y, ls="none", marker=MARKS[n % len(MARKS)], ms=4.5, mfc="none", color="black", label=name)
        if self.limits is not None:
            axes.set_ylim(*self.limits)
        else:
            drawn = [y for of in (self.curves, self.reference or {}, self.points or {}) for _, y in of.values()]
            no_finer(axes, FINEST * largest([np.abs(np.asarray(y, dtype=float)) for y in drawn]))
        axes.set(xlabel=self.x_label, ylabel=self.y_label)
        axes.set_title(self.title, fontsize=10)
        axes.grid(alpha=0.25, lw=0.5)
        if self.equal:
            axes.set_aspect("equal", adjustable="datalim")
        if len(self.curves) + len(self.reference or {}) + len(self.points or {}) > 1:
            axes.legend(frameon=False, fontsize=8)


@dataclass(frozen=True)
class Polar(Panel):
    """A panel of curves (angle [rad], value) around a centre, angle 0 at the bottom."""

    projection = "polar"

    def draw(self, ax: object) -> None:
        """Draw on polar axes of matplotlib."""
        axes: Any = ax
        axes.set_theta_zero_location("S")
        axes.set_rlabel_position(200)
        super().draw(axes)
        axes.yaxis.get_major_locator().base.set_params(nbins=RINGS)  # of the locator that leaves the centre out
        axes.set(xlabel="", ylabel="")
        axes.set_title(f"{self.title} {self.y_label}", fontsize=10)
        axes.legend(frameon=False, fontsize=8, ncols=2, loc="upper center", bbox_to_anchor=(0.5, -0.1))


def save_panels(
    panels: Sequence[Drawn], path: str | os.PathLike[str], *, theme: str = "light", width: float | None = None,
    overwrite: bool = False,
) -> Path:  # fmt: skip
    """Draw the panels into one picture; the ending of `path` selects the format (.png, .pdf, .svg); returns its path.

    theme, width: as of `restyle`. Raises `InputError` for no panels, a path that cannot be written, an unknown ending,
    and an existing file, unless `overwrite` is set.
    """
    return write_picture(panels_figure(panels, theme=theme, width=width), path, "panels", overwrite=overwrite)


def panels_figure(panels: Sequence[Drawn], title: str = "", *, theme: str = "light", width: float | None = None) -> Any:
    """A matplotlib Figure with the panels, at most `COLUMNS` side by side; theme, width: as of `restyle`. Raises
    `InputError` if there are none."""
    if not panels:
        raise InputError("panels: there is nothing to draw")
    figure, places = page(len(panels), columns_in(width, COLUMNS), PANEL_SIZE, dpi=DPI)
    if title:
        figure.suptitle(title, fontsize=11)
    for place, panel in zip(places, panels, strict=True):
        panel.draw(figure.add_subplot(place, projection=getattr(panel, "projection", None)))
    return restyle(figure, theme, width)


def page(count: int, most: int, size: tuple[float, float], **options: Any) -> tuple[Any, list[Any]]:
    """An empty matplotlib Figure and the places of `count` panels of about `size` [inch], at most `most` side by side:
    rows that are filled from edge to edge, so that no place stays empty."""
    from matplotlib.backends.backend_agg import FigureCanvasAgg
    from matplotlib.figure import Figure

    rows = -(-count // most)
    lengths = [(count + rows - 1 - row) // rows for row in range(rows)]
    figure = Figure(figsize=(size[0] * lengths[0], size[1] * rows), layout="constrained", **options)
    FigureCanvasAgg(figure)
    cells = math.lcm(*lengths)
    grid = figure.add_gridspec(rows, cells)
    return figure, [grid[row, cells // n * k : cells // n * (k + 1)] for row, n in enumerate(lengths) for k in range(n)]


OVERLAY_COLUMNS = 2
PANEL = (5.6, 3.2)  # inches
FIRST, SECOND, APART = "#1b6ca8", "#d1495b", "#2a9d6f"


@dataclass(frozen=True, eq=False)
class Overlaid:
    """One quantity of both runs, each at its own times [s]: `first` and `second` are (times (T,), values (T,)); its
    axis shows a range of at least `least`. apart: their difference likewise, drawn instead of them."""

    label: str
    units: str
    title: str
    first: tuple[np.ndarray, np.ndarray]
    second: tuple[np.ndarray, np.ndarray]
    least: float
    apart: tuple[np.ndarray, np.ndarray] | None = None

    def draw(self, ax: Any, names: tuple[str, str]) -> None:
        """Draw on matplotlib axes, the runs called `names`."""
        ax.ticklabel_format(axis="y", scilimits=(-2, 5))
        if self.apart is not None:
            ax.plot(self.apart[0] * 1e3, self.apart[1], lw=1.2, color=APART, label="B - A, where A and B coincide")
            ax.axhline(0.0, color="0.7", lw=0.6)
            ax.set_xlabel("time [ms]")
            self._dress(ax)
            return
        if len(self.first[0]) == len(self.second[0]) == 1:
            self._bars(ax, names)
            return
        mark = "o" if min(len(self.first[0]), len(self.second[0])) == 1 else ""
        ax.plot(self.first[0] * 1e3, self.first[1], lw=2.2, color=FIRST, marker=mark, label=names[0])
        ax.plot(
            self.second[0] * 1e3, self.second[1], "--", lw=0.9, alpha=0.8, color=SECOND, marker=mark, label=names[1]
        )
        ax.set_xlabel("time [ms]")
        no_finer(ax, self.least)
        self._dress(ax)

    def _bars(self, ax: Any, names: tuple[str, str]) -> None:
        """Draw the numbers of two runs of one row, such as equilibria."""
        values = np.array([float(self.first[1][0]), float(self.second[1][0])])
        values[np.abs(values) < LEAST * np.max(np.abs(values))] = 0.0
        bars = ax.bar(range(2), values, width=0.5, color=(FIRST, SECOND), label=names)
        ax.bar_label(bars, fmt="%.6g", padding=2, fontsize=9)
        ax.axhline(0.0, color="0.7", lw=0.6)
        ax.set_xticks([])
        ax.use_sticky_edges = False  # room for the numbers, beyond zero as well
        ax.margins(x=0.5, y=0.2)
        self._dress(ax)

    def _dress(self, ax: Any) -> None:
        name = self.label.partition("[")[0].replace("_", " ")
        ax.set_ylabel(f"{name}{'' if self.apart is None else ', B - A'} [{self.units}]")
        ax.set_title(self.title, fontsize=9, loc="right")  # a power of ten is on the left
        ax.grid(alpha=0.3)


def overlay_figure(
    panels: Sequence[Overlaid], names: tuple[str, str], *, theme: str = "light", width: float | None = None
) -> Any:
    """A matplotlib Figure with one panel per quantity and one legend below; theme, width: as of `restyle`."""
    figure, places = page(len(panels), columns_in(width, OVERLAY_COLUMNS), PANEL)
    for place, panel in zip(places, panels, strict=True):
        panel.draw(figure.add_subplot(place), names)
    named = {label: handle for ax in figure.axes for handle, label in zip(*ax.get_legend_handles_labels(), strict=True)}
    figure.legend(named.values(), named.keys(), loc="outside lower center", ncols=3, frameon=False)
    return restyle(figure, theme, width)


BAR, TALL, FONT = "#1b6ca8", 12, 8  # more bars than `TALL` have smaller names
FEW = 4  # thickness of bars is limited to that of so many
ROOM = 1.3  # of the longest bar, for its number


def draw_bars(ax: Any, values: Mapping[str, np.ndarray], label: str) -> None:
    """One bar for each of `values` {name: (1,)}, from the top, with its number; `label` has the unit."""
    sizes = np.array([float(value[0]) for value in values.values()])
    sizes[sizes < LEAST * np.max(sizes, initial=0.0)] = 0.0
    bars = ax.barh(range(len(sizes)), sizes, color=BAR)
    small = FONT - 2 if len(sizes) > TALL else FONT
    ax.bar_label(bars, labels=[f"{size:.4g}" for size in sizes], padding=3, fontsize=small)
    ax.set_yticks(range(len(sizes)), list(values), fontsize=small)
    ax.set_ylim(max(len(sizes), FEW) - 0.5, -0.5)
    ax.set_xlim(0.0, ROOM * float(np.max(sizes, initial=0.0)) or 1.0)
    ax.set_xlabel(label)


def draw_numbers(ax: Any, numbers: Mapping[str, str], title: str) -> None:
    """A table of `numbers`, name -> number with its unit."""
    ax.axis("off")
    table = ax.table(
        [[name, text] for name, text in numbers.items()], loc="upper center", cellLoc="left", colWidths=[0.62, 0.38],
        edges="horizontal",
    )  # fmt: skip
    table.auto_set_font_size(False)
    table.set_fontsize(FONT)
    ax.set_title(title, fontsize=10)


def numbers_of(result: Any, contact: Any, friction: Any, film: Any, small: Any) -> dict[str, str]:
    """Values of the histories of a run in its only row; contact, friction, film, small: those to list, or None
    (friction: the contact with friction)."""
    found: dict[str, str] = {}
    if contact is not None and contact.touching[0]:
        found["half-width"] = f"{contact.half_width[0] * 1e3:.4g} mm"
        found["peak pressure"] = f"{contact.mid_peak_pressure[0] * 1e-6:.4g} MPa"
        try:
            line = hertz(contact, 0)
        except InputError:
            pass  # the Hertz solution does not apply
        else:
            found["Hertz at this load"] = f"{line.half_width * 1e3:.4g} mm, {line.peak_pressure * 1e-6:.4g} MPa"
    if friction is not None:
        found["tangential over normal load"] = load_ratio(friction.friction, 0)
    if film is not None:
        found["smallest film"] = f"{film.smallest_gap[0] * 1e6:.4g} µm"
        found["largest pressure of the film"] = f"{film.largest_pressure[0] * 1e-6:.4g} MPa"
    if small is not None:
        found[f"normal force of {small.name!r}"] = f"{small.normal_force[0] * 1e-3:.4g} kN"
        found[f"slipping area of {small.name!r}"] = f"{small.slip_area[0] * 1e6:.4g} mm²"
    found["energy scale"] = f"{result.energy_scale:.4g} J"
    return found


def load_ratio(friction: Any, row: int) -> str:
    """Tangential over normal load in a row; round-off is set to 0."""
    ratio = float(np.nan_to_num(friction.traction_coefficient[row]))
    return f"{ratio:.4g}" if abs(ratio) > LEAST else "0"


def spectrum(result: Any, ax: Any, channel: str, speed: str | None) -> None:
    """Amplitudes of a history by frequency, or by orders of the rotation of a body; requires a channel."""
    (result.spectrum(channel) if speed is None else result.orders(channel, speed)).draw(ax)


def waterfall(result: Any, ax: Any, channel: str, speed: str | None) -> None:
    """Spectra of consecutive windows of a history over time, or over the speed of a body with lines of constant order;
    requires a channel."""
    result.waterfall(channel, speed).draw(ax)


HISTORY_PLOTS: dict[str, Callable[[Any, Any, str, str | None], None]] = {"spectrum": spectrum, "waterfall": waterfall}


def the_channel(kind: str, channel: str | None) -> str:
    """The history of a plot. Raises InputError if none is named."""
    if channel is None:
        raise InputError(
            f"plot: '{kind}' needs the history to draw, channel='contact_force_z[NAME]'; columns of to_csv have the "
            "names"
        )
    return channel
