"""A map of classes, rows against columns, for pages of studies; matplotlib is imported when it is drawn."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
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
