"""An output over time, a line a row, coloured by a parameter."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np

from warpffrf.output.plots.colors import largest
from warpffrf.output.plots.figure import REFERENCE
from warpffrf.output.plots.scales import LEAST, no_finer
from warpffrf.study.sweeps.reading.hues import Hue
from warpffrf.study.sweeps.reading.values import Values, shown_in

MOST_LINES = 400  # rows that are drawn, spread over all


@dataclass(frozen=True, eq=False)
class Histories:
    """`values` (run, time) of the `rows` (run,) over time, a line a row, coloured by `hue`. A row that ended early is
    dotted, with a cross where it ended; one without any value is told in the title."""

    title: str
    values: Values
    rows: np.ndarray
    hue: Hue

    def draw(self, ax: Any) -> None:
        """Draw on matplotlib axes."""
        factor, label = self.values.shown()
        times = np.asarray(self.values.time)
        to_unit, unit = shown_in("s", times[self.rows])
        early, rows = False, np.flatnonzero(self.rows)
        shown = rows if len(rows) <= MOST_LINES else rows[np.linspace(0, len(rows) - 1, MOST_LINES).round().astype(int)]
        for row in shown:
            there = np.isfinite(self.values.numbers[row])
            if not there.any():
                continue
            t, y = times[row][there] * to_unit, self.values.numbers[row][there] * factor
            hue = 0.0 if self.hue.axis is None else float(self.hue.axis.positions[row])
            ended = not self.values.has[row]
            early |= ended
            ax.plot(t, y, ":" if ended else "-", lw=1.2, color=self.hue.color(hue))
            if ended:
                ax.plot(t[-1:], y[-1:], "x", ms=7.0, mew=1.6, color=REFERENCE)
        ax.set(xlabel=f"time [{unit}]", ylabel=label)
        no_finer(ax, LEAST * largest([np.abs(self.values.numbers[row]) * factor for row in shown]))
        missing = self.values.missing(self.rows)
        if len(shown) < len(rows):
            missing = "; ".join(filter(None, (f"{len(shown)} of {len(rows)} rows", missing)))
        ax.set_title("\n".join(filter(None, (self.title, missing))), fontsize=10)
        ax.grid(alpha=0.25, lw=0.5)
        named = []
        if self.hue.is_few and self.hue.axis is not None:
            at = np.unique(self.hue.axis.positions[self.rows])
            named = [({"color": self.hue.color(v)}, self.hue.label(v)) for v in at]
        if early:
            named.append(({"color": REFERENCE, "ls": "none", "marker": "x"}, "ended early"))
        handles = [ax.plot([], [], label=text, **look)[0] for look, text in named]
        if handles:
            ax.legend(handles=handles, frameon=False, fontsize=8)
        self.hue.bar(ax)
