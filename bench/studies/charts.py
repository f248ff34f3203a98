"""Charts of study pages: a map of classes, named curves, and errors over a size with the rule that bounds them;
matplotlib is imported when one is drawn."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path

import numpy as np

CELL = (0.95, 0.30)  # inches
MARGIN = (2.6, 1.6)
DPI = 110
EMPTY = "#ffffff"


def save_class_map(
    rows: Sequence[str],
    columns: Sequence[str],
    classes: Sequence[Sequence[str | None]],
    colors: Mapping[str, str],
    path: str | Path,
    *,
    title: str,
) -> Path:
    """Draw `classes` (rows x columns), names in `colors` or None where there is nothing, into the PNG file `path`;
    returns its path."""
    from matplotlib.backends.backend_agg import FigureCanvasAgg
    from matplotlib.colors import ListedColormap
    from matplotlib.figure import Figure
    from matplotlib.patches import Patch

    names = list(colors)
    numbers = np.array([[0 if name is None else 1 + names.index(name) for name in row] for row in classes])
    size = (MARGIN[0] + CELL[0] * len(columns), MARGIN[1] + CELL[1] * len(rows))
    figure = Figure(figsize=size, dpi=DPI, layout="constrained")
    FigureCanvasAgg(figure)
    ax = figure.add_subplot()
    shades = ListedColormap([EMPTY, *colors.values()])
    ax.pcolormesh(numbers.reshape(len(rows), len(columns)), cmap=shades, vmin=-0.5, vmax=len(names) + 0.5,
                  edgecolors="white", linewidth=1.5)  # fmt: skip
    ax.set_xticks(np.arange(len(columns)) + 0.5, columns, rotation=35, ha="right", fontsize=8)
    ax.set_yticks(np.arange(len(rows)) + 0.5, rows, fontsize=8)
    ax.invert_yaxis()
    ax.set_title(title, fontsize=10)
    handles = [Patch(color=color, label=name) for name, color in colors.items()]
    figure.legend(handles=handles, loc="outside lower center", ncols=len(handles), frameon=False, fontsize=8)
    figure.savefig(path, metadata={"Software": "warpffrf"})
    return Path(path)


CURVES_SIZE = (7.0, 4.2)  # inches
CURVES_DPI = 120
MARKS = "osD^v*Px"


def save_curves(
    curves: Mapping[str, tuple[np.ndarray, np.ndarray]],
    path: str | Path,
    *,
    labels: tuple[str, str],
    title: str,
    log_y: bool = False,
) -> Path:
    """Draw `curves` {name: (x (n,), y (n,))} with axis `labels` (x, y) into the PNG file `path`; returns its path."""
    from matplotlib.backends.backend_agg import FigureCanvasAgg
    from matplotlib.figure import Figure

    figure = Figure(figsize=CURVES_SIZE, dpi=CURVES_DPI, layout="constrained")
    FigureCanvasAgg(figure)
    ax = figure.add_subplot()
    for i, (name, (x, y)) in enumerate(curves.items()):
        ax.plot(x, y, marker=MARKS[i % len(MARKS)], ms=4.0, lw=1.2, label=name)
    if log_y:
        ax.set_yscale("log")
    ax.set(xlabel=labels[0], ylabel=labels[1])
    ax.set_title(title, fontsize=10)
    ax.grid(alpha=0.3)
    ax.legend(frameon=False, fontsize=8)
    figure.savefig(path)
    return Path(path)


POINTS, RULE = "#1b6ca8", "#d1495b"
PANEL = (4.6, 3.4)  # inches
SMALLEST = 1e-6  # errors below it are left out of the scale


@dataclass(frozen=True, eq=False)
class ErrorPanel:
    """One chart: absolute `errors` (n,) at `sizes` (n,), and the bound `factor * size^rate`."""

    title: str
    sizes: np.ndarray
    errors: np.ndarray
    factor: float
    rate: float


def error_charts(panels: Sequence[Sequence[ErrorPanel]], size_label: str, path: Path) -> None:
    """Write rows of panels to the PNG `path`."""
    from matplotlib.backends.backend_agg import FigureCanvasAgg
    from matplotlib.figure import Figure

    rows, columns = len(panels), len(panels[0])
    figure = Figure(figsize=(PANEL[0] * columns, PANEL[1] * rows), dpi=DPI, layout="constrained")
    FigureCanvasAgg(figure)
    axes = figure.subplots(rows, columns, squeeze=False, sharex=True)
    for i, row in enumerate(panels):
        for j, panel in enumerate(row):
            ax = axes[i, j]
            ends = np.array([panel.sizes.min(), panel.sizes.max()])
            ax.loglog(panel.sizes, panel.errors, ".", ms=2.5, color=POINTS, label="one position")
            label = f"rule: {panel.factor:g} (s/b)$^{{{panel.rate:g}}}$"
            ax.loglog(ends, panel.factor * ends**panel.rate, "-", lw=1.2, color=RULE, label=label)
            bottom = max(float(np.quantile(panel.errors, 0.05)), SMALLEST)
            ax.set_ylim(0.5 * bottom, 2.0 * panel.factor * ends[1] ** panel.rate)
            ax.set_title(panel.title, fontsize=10)
            ax.grid(which="both", lw=0.3, color="0.85")
            ax.legend(frameon=False, fontsize=8, loc="lower right")
            if i == rows - 1:
                ax.set_xlabel(size_label)
            if j == 0:
                ax.set_ylabel("relative error")
    figure.savefig(path)
