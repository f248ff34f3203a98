"""Charts of errors against a size on double logarithmic scales, beside the rule that bounds them; matplotlib is
imported when a chart is drawn."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path

import numpy as np

POINTS, RULE = "#1b6ca8", "#d1495b"
DPI = 110
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
