"""An output over two parameters: cells of a whole grid, triangles between the rows of a sample, points where further
parameters vary as well. The rows with the least and the largest value are marked."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np

from warpffrf.output.plots.figure import REFERENCE
from warpffrf.study.sweeps.reading.axes import Axis, grid_places
from warpffrf.study.sweeps.reading.values import Values

MAP = "magma_r"
LEVELS = 14  # of contours
WRITTEN = 36  # cells whose values are written into them
DARK = 0.55  # of the colour range, above which writing is white
FLAT = 1e-6  # breadth over length, of places scaled to their ranges, below which they stand on a line


@dataclass(frozen=True, eq=False)
class Map:
    """`values` of the `rows` (run,) over `x` and `y`; `others` are the further parameters in which rows differ. limits:
    of the colours, in shown units; marked: rows with the least and the largest value, with a mark and a name each."""

    title: str
    values: Values
    rows: np.ndarray
    x: Axis
    y: Axis
    others: Sequence[Axis]
    limits: tuple[float, float]
    marked: Sequence[tuple[int, str, str]]

    def draw(self, ax: Any) -> None:
        """Draw on matplotlib axes."""
        factor, label = self.values.shown()
        image = self._image(ax, factor)
        ax.figure.colorbar(image, ax=ax, label=label)
        missing = self.rows & ~self.values.has
        if missing.any():
            ax.plot(self.x.positions[missing], self.y.positions[missing], "x", ms=8.0, mew=1.8, color=REFERENCE,
                    label="without a value", clip_on=False, zorder=4)  # fmt: skip
        for row, marker, name in self.marked:
            if self.rows[row]:
                text = f"{name}: {self.values.numbers[row] * factor:.4g}"
                ax.plot(self.x.positions[row], self.y.positions[row], marker, ms=11.0, mfc="white", mec="black",
                        mew=1.2, ls="none", label=text, clip_on=False, zorder=5)  # fmt: skip
        self.x.dress(ax, "x")
        self.y.dress(ax, "y")
        over = f"all values of {', '.join(axis.name for axis in self.others)}" if self.others else ""
        said = "; ".join(filter(None, (over, self.values.missing(self.rows))))
        ax.set_title("\n".join(filter(None, (self.title, said))), fontsize=10)
        if ax.get_legend_handles_labels()[0]:
            ax.legend(fontsize=8, loc="upper center", bbox_to_anchor=(0.5, -0.14), ncols=3, frameon=False)

    def _image(self, ax: Any, factor: float) -> Any:
        """Cells, triangles or points."""
        low, high = self.limits
        colors = {"cmap": MAP, "vmin": low, "vmax": high}
        grid = None if self.others else grid_places((self.x, self.y), self.rows)
        if grid is not None:
            (x, y), places = grid
            field = np.full((len(x), len(y)), np.nan)
            field[tuple(places.T)] = np.where(self.values.has, self.values.numbers, np.nan)[self.rows] * factor
            if field.size <= WRITTEN:
                self._write(ax, (x, y), field)
            return ax.pcolormesh(_edges(x, self.x.is_log), _edges(y, self.y.is_log), field.T, **colors)
        has = self.rows & self.values.has
        x, y, z = self.x.positions[has], self.y.positions[has], self.values.numbers[has] * factor
        if not self.others and _spread(x, y):
            levels = np.linspace(low, high, LEVELS + 1) if high > low else None
            image = ax.tricontourf(x, y, z, levels=levels, **colors)
            ax.plot(x, y, ".", ms=4.0, color="0.3")
            return image
        return ax.scatter(x, y, c=z, s=30.0, edgecolors="0.4", linewidths=0.5, **colors)

    def _write(self, ax: Any, at: Sequence[np.ndarray], field: np.ndarray) -> None:
        """The values in their cells, at the lower edge of each, so that marks leave them to be read."""
        low, high = self.limits
        for (i, k), value in np.ndenumerate(field):
            if np.isfinite(value):
                color = "white" if value > low + DARK * (high - low) else "black"
                ax.annotate(f"{value:.4g}", (at[0][i], at[1][k]), (0, -9), textcoords="offset points", color=color,
                            ha="center", va="top", fontsize=7)  # fmt: skip


def _edges(at: np.ndarray, is_log: bool) -> np.ndarray:
    """Borders (n + 1,) of cells around places (n,), which are in their middles where they are evenly spread."""
    at = np.log(at) if is_log else at
    if len(at) == 1:
        edges = at[0] + np.array([-0.5, 0.5])
    else:
        middles = 0.5 * (at[1:] + at[:-1])
        edges = np.concatenate([[2.0 * at[0] - middles[0]], middles, [2.0 * at[-1] - middles[-1]]])
    return np.exp(edges) if is_log else edges


def _spread(x: np.ndarray, y: np.ndarray) -> bool:
    """Whether the places do not all stand on one line."""
    if len(x) < 3 or not np.ptp(x) or not np.ptp(y):
        return False
    scaled = np.stack([(x - x.mean()) / np.ptp(x), (y - y.mean()) / np.ptp(y)])
    length, breadth = np.linalg.svd(scaled, compute_uv=False)
    return bool(breadth > FLAT * length)
