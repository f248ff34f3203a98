"""Curves of two runs, one over the other, a panel for each quantity."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np

from warpffrf.output.plots.scales import no_finer

COLUMNS = 2
PANEL = (5.6, 3.2)  # inches
FIRST, SECOND = "#1b6ca8", "#d1495b"


@dataclass(frozen=True, eq=False)
class Overlaid:
    """One quantity of both runs, each at its own times [s]: `first` and `second` are (times (T,), values (T,)); its
    axis shows a range of at least `least`."""

    label: str
    units: str
    title: str
    first: tuple[np.ndarray, np.ndarray]
    second: tuple[np.ndarray, np.ndarray]
    least: float

    def draw(self, ax: Any, names: tuple[str, str]) -> None:
        """Draw on matplotlib axes, the runs called `names`."""
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
        """The numbers of two runs of one row, as equilibria."""
        values = [float(self.first[1][0]), float(self.second[1][0])]
        bars = ax.bar(range(2), values, width=0.5, color=(FIRST, SECOND), label=names)
        ax.bar_label(bars, fmt="%.6g", padding=2, fontsize=9)
        ax.axhline(0.0, color="0.7", lw=0.6)
        ax.set_xticks([])
        ax.margins(x=0.5, y=0.15)
        self._dress(ax)

    def _dress(self, ax: Any) -> None:
        ax.set_ylabel(f"{self.label.partition('[')[0].replace('_', ' ')} [{self.units}]")
        ax.set_title(self.title, fontsize=9, loc="right")  # a power of ten stands on the left
        ax.grid(alpha=0.3)


def overlay_figure(panels: Sequence[Overlaid], names: tuple[str, str]) -> Any:
    """A matplotlib Figure with a panel for each quantity and one legend below."""
    from matplotlib.backends.backend_agg import FigureCanvasAgg
    from matplotlib.figure import Figure

    columns = min(COLUMNS, len(panels))
    rows = -(-len(panels) // columns)
    figure = Figure(figsize=(PANEL[0] * columns, PANEL[1] * rows + 0.4), layout="constrained")
    FigureCanvasAgg(figure)
    for n, panel in enumerate(panels):
        panel.draw(figure.add_subplot(rows, columns, n + 1), names)
    figure.legend(*figure.axes[0].get_legend_handles_labels(), loc="outside lower center", ncols=2, frameon=False)
    return figure
