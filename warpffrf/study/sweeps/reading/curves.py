"""An output against a parameter: rows that differ in it alone are one line, by themselves points."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np

from warpffrf.output.plots.figure import MOST_INSIDE, REFERENCE, STYLES
from warpffrf.output.plots.panels import MARKS
from warpffrf.study.sweeps.reading.axes import Axis
from warpffrf.study.sweeps.reading.hues import Hue
from warpffrf.study.sweeps.reading.values import Values

ABSENT = 0.03  # of the height of the axes: where rows without a value are marked


@dataclass(frozen=True, eq=False)
class Curves:
    """`values` of the `rows` (run,) over `x`, coloured by `hue`, dashed by `style`; `others` are the further parameters
    in which rows differ. limits: of the value axis, in shown units."""

    title: str
    values: Values
    rows: np.ndarray
    x: Axis
    hue: Hue
    style: Axis | None
    others: Sequence[Axis]
    limits: tuple[float, float]
    is_first: bool  # of the figure: it names the colours

    def draw(self, ax: Any) -> None:
        """Draw on matplotlib axes."""
        factor, label = self.values.shown()
        has = self.rows & self.values.has
        alone: dict[int, list[int]] = {}  # rows that no other shares a line with, by their mark: drawn at once
        for line in self._lines(has):
            place = self._place(line[0])
            if len(line) == 1:
                alone.setdefault(place, []).append(line[0])
                continue
            ax.plot(
                self.x.positions[line], self.values.numbers[line] * factor, STYLES[place % len(STYLES)], lw=1.4,
                marker=MARKS[place % len(MARKS)], ms=4.5, color=self._color(line[0]),
            )  # fmt: skip
        for place, rows in alone.items():
            ax.scatter(
                self.x.positions[rows], self.values.numbers[rows] * factor, marker=MARKS[place % len(MARKS)], s=20.0,
                c=[self._color(row) for row in rows],
            )  # fmt: skip
        missing = np.flatnonzero(self.rows & ~self.values.has)
        if len(missing):
            ax.plot(
                self.x.positions[missing], np.full(len(missing), ABSENT), "x", ms=7.0, mew=1.6, color=REFERENCE,
                transform=ax.get_xaxis_transform(), clip_on=False,
            )  # fmt: skip
        self.x.dress(ax, "x")
        ax.set_ylabel(label)
        ax.set_ylim(*self.limits)
        ax.set_title(self._title(), fontsize=10)
        ax.grid(alpha=0.25, lw=0.5)
        self._legend(ax, bool(len(missing)))

    def _lines(self, has: np.ndarray) -> list[np.ndarray]:
        """Numbers of the rows of each line, along x."""
        keys = [axis.positions for axis in (self.hue.axis, self.style, *self.others) if axis is not None]
        chosen = np.flatnonzero(has)
        if not len(chosen):
            return []
        _, of_line = np.unique(np.stack([*keys, np.zeros_like(self.x.positions)], axis=1)[chosen], axis=0,
                               return_inverse=True)  # fmt: skip
        lines = [chosen[of_line == n] for n in range(of_line.max() + 1)]
        return [line[np.argsort(self.x.positions[line], kind="stable")] for line in lines]

    def _color(self, row: int) -> Any:
        """That of a row's value of `hue`."""
        return self.hue.color(0.0 if self.hue.axis is None else float(self.hue.axis.positions[row]))

    def _place(self, row: int) -> int:
        """The place of a row's value among those of `style`."""
        return 0 if self.style is None else int((self.style.distinct < self.style.positions[row]).sum())

    def _title(self) -> str:
        missing = self.values.missing(self.rows)
        over = f"all values of {', '.join(axis.name for axis in self.others)}" if self.others else ""
        return "\n".join(filter(None, (self.title, "; ".join(filter(None, (over, missing))))))

    def _legend(self, ax: Any, missing: bool) -> None:
        named = []
        if self.is_first and self.hue.is_few and self.hue.axis is not None:
            at = self.hue.axis.distinct
            named += [({"color": self.hue.color(v), "marker": "o"}, self.hue.label(v)) for v in at]
        if self.is_first and self.style is not None:
            for n, v in enumerate(self.style.distinct):
                look = {"color": "0.3", "ls": STYLES[n % len(STYLES)], "marker": MARKS[n % len(MARKS)]}
                named.append((look, f"{self.style.name} = {self.style.text(v)}"))
        if missing:
            named.append(({"color": REFERENCE, "ls": "none", "marker": "x"}, "without a value"))
        handles = [ax.plot([], [], ms=4.5, label=text, **look)[0] for look, text in named]
        if len(handles) > MOST_INSIDE:
            ax.legend(handles=handles, frameon=False, fontsize=7, loc="upper left", bbox_to_anchor=(1.0, 1.0))
        elif handles:
            ax.legend(handles=handles, frameon=False, fontsize=8)
        self.hue.bar(ax)
