"""Colours by the value of a parameter: a few values have each a colour and a name, many share a colour bar."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

from warpffrf.output.plots.panels import COLORS
from warpffrf.output.plots.value_colors import value_colors
from warpffrf.study.sweeps.reading.axes import Axis


@dataclass(frozen=True, eq=False)
class Hue:
    """Colours of the values of `axis`; of None all are alike."""

    axis: Axis | None

    @property
    def is_few(self) -> bool:
        """Whether each value has a colour of its own."""
        return self.axis is None or len(self.axis.distinct) <= len(COLORS) or self.axis.words is not None

    def color(self, position: float) -> Any:
        """The colour of the value at a position of the axis."""
        if self.axis is None:
            return COLORS[0]
        if self.is_few:
            return COLORS[int((self.axis.distinct < position).sum()) % len(COLORS)]
        return self._scale().to_rgba(position)

    def label(self, position: float) -> str:
        """What a legend calls the value; "" where there is none."""
        return "" if self.axis is None else f"{self.axis.name} = {self.axis.text(position)}"

    def bar(self, ax: Any) -> None:
        """A colour bar beside `ax`, where values have no colours of their own."""
        if self.axis is not None and not self.is_few:
            ax.figure.colorbar(self._scale(), ax=ax, label=self.axis.name)

    def _scale(self) -> Any:
        axis: Any = self.axis
        return value_colors(float(axis.distinct[0]), float(axis.distinct[-1]), ratios=axis.is_log)
