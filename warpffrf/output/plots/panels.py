"""A picture of several plots side by side, each of curves over one pair of axes; matplotlib is imported when drawn."""

from __future__ import annotations

import os
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any, Protocol

import numpy as np

from warpffrf.model.errors import InputError
from warpffrf.output.plots.colors import largest
from warpffrf.output.plots.picture import write_picture
from warpffrf.output.plots.scales import LEAST, no_finer

PANEL_SIZE = (5.2, 3.9)  # inches
COLUMNS = 3  # side by side at most
DPI = 110
COLORS = ("#1b6ca8", "#d1495b", "#2a9d6f", "#b57f00", "#6d5aa8", "#4f5d6b")
REFERENCE_DASH = (0, (5, 3))
MARKS = "os^D"


class Drawn(Protocol):
    """What `save_panels` takes; one that has a `projection` is drawn on axes of that kind."""

    def draw(self, ax: object) -> None:
        """Draw on matplotlib axes."""


@dataclass(frozen=True)
class Panel:
    """One plot: `curves` {name: (x (n,), y (n,))} as lines, `reference` likewise, dashed and on top of them, `points`
    likewise, as marks.

    `limits`: the range (low, high) of y to show, for curves of which one runs away.
    """

    title: str
    x_label: str
    y_label: str
    curves: Mapping[str, tuple[np.ndarray, np.ndarray]]
    reference: Mapping[str, tuple[np.ndarray, np.ndarray]] | None = None
    limits: tuple[float, float] | None = None
    points: Mapping[str, tuple[np.ndarray, np.ndarray]] | None = None

    def draw(self, ax: object) -> None:
        """Draw on matplotlib axes."""
        axes: Any = ax
        for n, (name, (x, y)) in enumerate(self.curves.items()):
            axes.plot(x, y, lw=1.4, color=COLORS[n % len(COLORS)], label=name)
        for n, (name, (x, y)) in enumerate((self.reference or {}).items()):
            color = "black" if n == 0 else COLORS[-1 - n]
            axes.plot(x, y, lw=1.0, color=color, ls=REFERENCE_DASH, marker="o" if len(x) == 1 else None, label=name)
        for n, (name, (x, y)) in enumerate((self.points or {}).items()):
            axes.plot(x, y, ls="none", marker=MARKS[n % len(MARKS)], ms=4.5, mfc="none", color="black", label=name)
        if self.limits is not None:
            axes.set_ylim(*self.limits)
        else:
            drawn = [y for of in (self.curves, self.reference or {}, self.points or {}) for _, y in of.values()]
            no_finer(axes, LEAST * largest([np.abs(np.asarray(y, dtype=float)) for y in drawn]))
        axes.set(xlabel=self.x_label, ylabel=self.y_label)
        axes.set_title(self.title, fontsize=10)
        axes.grid(alpha=0.25, lw=0.5)
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
        axes.set(xlabel="", ylabel="")
        axes.set_title(f"{self.title} {self.y_label}", fontsize=10)
        axes.legend(frameon=False, fontsize=8, loc="upper right", bbox_to_anchor=(1.25, 1.1))


def save_panels(panels: Sequence[Drawn], path: str | os.PathLike[str], *, overwrite: bool = False) -> Path:
    """Draw the panels into one picture; the ending of `path` chooses the format (.png, .pdf, .svg); returns its path.

    Raises `InputError` for no panels, a path that cannot be written, an unknown ending, and a file that exists where
    `overwrite` is not set.
    """
    return write_picture(panels_figure(panels), path, "panels", overwrite=overwrite)


def panels_figure(panels: Sequence[Drawn], title: str = "") -> Any:
    """A matplotlib Figure with the panels, `COLUMNS` of them side by side. Raises `InputError` for none."""
    from matplotlib.backends.backend_agg import FigureCanvasAgg
    from matplotlib.figure import Figure

    if not panels:
        raise InputError("panels: there is nothing to draw")
    rows = -(-len(panels) // COLUMNS)
    columns = -(-len(panels) // rows)
    figure = Figure(figsize=(PANEL_SIZE[0] * columns, PANEL_SIZE[1] * rows), dpi=DPI, layout="constrained")
    FigureCanvasAgg(figure)
    if title:
        figure.suptitle(title, fontsize=11)
    for n, panel in enumerate(panels):
        panel.draw(figure.add_subplot(rows, columns, n + 1, projection=getattr(panel, "projection", None)))
    return figure
