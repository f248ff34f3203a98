"""A picture of named curves over one pair of axes, for pages of studies; matplotlib is imported when it is drawn."""

from __future__ import annotations

from collections.abc import Mapping
from pathlib import Path

import numpy as np

SIZE = (7.0, 4.2)  # inches
DPI = 120
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

    figure = Figure(figsize=SIZE, dpi=DPI, layout="constrained")
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
