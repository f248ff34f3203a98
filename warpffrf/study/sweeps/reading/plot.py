"""Plots of a sweep: an output over a parameter, over time, or over two parameters, on panels of one figure.

Hues. Colours by the value of a parameter: a few values each have a colour and a name, many have a colour bar.

Axes. A parameter along an axis: numbers by value, texts and booleans by index; detection of grids.

Curves. An output against a parameter: rows that differ in it alone form a line, single rows are points.

Maps. An output over two parameters: cells of a whole grid, triangles between the rows of a sample, points if further
parameters vary. The rows with the least and the largest value are marked.

Histories. An output over time, one line per row, coloured by a parameter.
"""

from __future__ import annotations

import os
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np

from warpffrf.model.errors import InputError, unknown_name
from warpffrf.output.plots.colors import HEADROOM, LEAST, SMALL, largest, no_finer, value_colors
from warpffrf.output.plots.figure import MOST_INSIDE, REFERENCE, STYLES
from warpffrf.output.plots.panels import COLORS, MARKS, Drawn, panels_figure
from warpffrf.output.plots.picture import write_picture
from warpffrf.study.sweeps.reading.values import Table, Values, chosen_rows, shown_in, values_of

KINDS = ("curves", "map")
MOST_PANELS = 12
ROOM = 0.06  # of the range, above and below it


def panels_of(
    table: Table, output: str, x: str | None = None, y: str | None = None, hue: str | None = None,
    style: str | None = None, col: str | None = None, kind: str | None = None, component: str | int | None = None,
    where: Mapping[str, Any] | None = None,
) -> tuple[Sequence[Drawn], str]:  # fmt: skip
    """The panels of `Sweep.plot`, and their common title."""
    values = values_of(table, output, component)
    rows = chosen_rows(table, where)
    if kind is None:
        kind = "curves" if y is None else "map"
    if kind not in KINDS:
        raise unknown_name("sweep: kind of plot", kind, KINDS)
    if not (values.has & rows).any() and not _begun(values, rows):
        raise InputError(
            f"sweep: no row has a value of {output!r} to draw ({values.missing(rows)}); see Sweep.failed()"
        )
    title = " ".join([_named(values), *(f"at {name} = {value}" for name, value in (where or {}).items())])
    panels = _by_panel(table, rows, col)
    named = [name for name in (x, y, hue, style, col) if name is not None]
    for name in named:
        if named.count(name) > 1:
            raise InputError(
                f"sweep: {name!r} is given twice; each of x, y, hue, style and col needs a parameter of its own"
            )
    free = [axis for axis in axes_of(table, rows) if axis.name not in named]
    if kind == "map":
        _refuse("a map", hue=hue, style=style)
        drawn = _maps(table, values, panels, x, y, free)
    elif values.time is not None:
        _refuse("an output over time", x=x, y=y, style=style)
        by = Hue(axis_of(table, hue) if hue else free[0] if len(free) == 1 or _is_grid(free, rows) else None)
        drawn = [Histories(name, values, chosen, by) for name, chosen in panels]
    else:
        _refuse("curves", y=y)
        drawn = _curves(table, values, panels, x, hue, style, free)
    return drawn, title


def plot(
    table: Table, output: str, *, theme: str = "light", width: float | None = None,
    path: str | os.PathLike[str] | None = None, overwrite: bool = False, **chosen: Any,
) -> Any:  # fmt: skip
    """A matplotlib Figure of an output, `chosen` by the arguments of `panels_of`; written to `path` if given."""
    figure = panels_figure(*panels_of(table, output, **chosen), theme=theme, width=width)
    if path is not None:
        write_picture(figure, path, "sweep: picture", overwrite=overwrite)
    return figure


def _named(values: Values) -> str:
    """The output, with its definition if that differs from the name."""
    return values.name if values.text == values.name else f"{values.name} = {values.text}"


def _begun(values: Values, rows: np.ndarray) -> bool:
    """Whether an uncompleted row has a history."""
    return values.time is not None and bool(np.isfinite(values.numbers[rows]).any())


def _refuse(what: str, **given: str | None) -> None:
    for name, value in given.items():
        if value is not None:
            raise InputError(f"sweep: {what} has no {name}; leave {name}={value!r} out")


def _by_panel(table: Table, rows: np.ndarray, col: str | None) -> list[tuple[str, np.ndarray]]:
    """Title and rows of each panel."""
    if col is None:
        return [("", rows)]
    axis = axis_of(table, col)
    at = np.unique(axis.positions[rows])
    if len(at) > MOST_PANELS:
        raise InputError(
            f"sweep: col={col!r} has {len(at)} values, more than the {MOST_PANELS} panels of a figure; choose some "
            "with where={...}, or colour by it with hue="
        )
    return [(f"{col} = {axis.text(v)}", rows & (axis.positions == v)) for v in at]


def _is_grid(axes: list[Axis], rows: np.ndarray) -> bool:
    return grid_places(axes, rows) is not None


def _curves(
    table: Table, values: Values, panels: list[tuple[str, np.ndarray]], x: str | None, hue: str | None,
    style: str | None, free: list[Axis],
) -> list[Curves]:  # fmt: skip
    """Panels over x, by default the first parameter that varies; for a grid the next one is the colour, and a last one
    with few values the dashes."""
    if x is None and not free:
        raise InputError("sweep: no parameter is left that varies in these rows; name another x, or leave where out")
    along = axis_of(table, x) if x is not None else free.pop(0)
    color, dash = (axis_of(table, name) if name is not None else None for name in (hue, style))
    if color is None and free and len(np.unique(along.positions[panels[0][1]])) < int(panels[0][1].sum()):
        color = free.pop(0)
    if dash is None and len(free) == 1 and len(free[0].distinct) <= len(STYLES):
        dash = free.pop(0)
    limits = _limits(values, np.any([rows for _, rows in panels], axis=0))
    return [
        Curves(name, values, rows, along, Hue(color), dash, free, limits, n == 0)
        for n, (name, rows) in enumerate(panels)
    ]


def _limits(values: Values, rows: np.ndarray) -> tuple[float, float]:
    """Limits of the value axis of all panels: from zero unless values are similar, as in plots of runs."""
    factor, _ = values.shown()
    numbers = values.numbers[rows & values.has] * factor
    low, high = float(numbers.min()), float(numbers.max())
    spread = high - low
    if low >= 0.0 and spread >= SMALL * high:
        return 0.0, HEADROOM * high if high > 0.0 else 1.0
    room = ROOM * spread if spread > LEAST * max(abs(low), abs(high)) else 0.5 * (abs(high) or 1.0)
    return low - room, high + room


def _maps(
    table: Table, values: Values, panels: list[tuple[str, np.ndarray]], x: str | None, y: str | None, free: list[Axis]
) -> list[Map]:
    """Panels over x and y, by default the first parameters that vary."""
    if values.time is not None:
        raise InputError(
            f"sweep: a map needs one number a row, and {values.name!r} is over time; sweep its largest value, "
            f"'max({values.text})', or draw it over time"
        )
    if len(free) < (x is None) + (y is None):
        raise InputError("sweep: a map needs two parameters that vary in these rows; draw curves over the one there is")
    along, up = (free.pop(0) if name is None else axis_of(table, name) for name in (x, y))
    factor, _ = values.shown()
    whole = np.any([rows for _, rows in panels], axis=0) & values.has
    numbers = np.where(whole, values.numbers, np.nan)
    low, high = float(np.nanmin(numbers) * factor), float(np.nanmax(numbers) * factor)
    short = max(0.5 * (LEAST * max(abs(low), abs(high)) - (high - low)), 0.0)
    limits = low - short, high + short
    marked = [(int(np.nanargmin(numbers)), "v", "least"), (int(np.nanargmax(numbers)), "^", "largest")]
    return [Map(name, values, rows, along, up, free, limits, marked) for name, rows in panels]


@dataclass(frozen=True, eq=False)
class Hue:
    """Colours of the values of `axis`; None: all equal."""

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
        """Legend text of the value; "" if there is none."""
        return "" if self.axis is None else f"{self.axis.name} = {self.axis.text(position)}"

    def bar(self, ax: Any) -> None:
        """A colour bar next to `ax`, if values have no colours of their own."""
        if self.axis is not None and not self.is_few:
            ax.figure.colorbar(self._scale(), ax=ax, label=self.axis.name)

    def _scale(self) -> Any:
        axis: Any = self.axis
        return value_colors(float(axis.distinct[0]), float(axis.distinct[-1]), ratios=axis.is_log)


WIDE = 8.0  # largest over least value of an axis that may be logarithmic
FEW = 12  # largest number of values that all have a tick, if there is room
APART = 0.13  # of the axis, smallest distance of ticks


@dataclass(frozen=True, eq=False)
class Axis:
    """Parameter `name` at positions (run,); `words`: texts at positions 0, 1, 2, ..., None for numbers."""

    name: str
    positions: np.ndarray
    words: tuple[str, ...] | None = None

    @property
    def distinct(self) -> np.ndarray:
        """Its distinct values, ascending."""
        return np.unique(self.positions)

    @property
    def is_log(self) -> bool:
        """Whether its values suit a logarithmic scale: the middle value is nearer to the geometric mean of the ends."""
        at = self.distinct
        if self.words is not None or len(at) < 3 or at[0] <= 0.0 or at[-1] < WIDE * at[0]:
            return False
        middle = float(np.median(at))
        return abs(middle - np.sqrt(at[0] * at[-1])) < abs(middle - 0.5 * (at[0] + at[-1]))

    def text(self, position: float) -> str:
        """The value at a position."""
        return f"{position:.4g}" if self.words is None else self.words[int(position)]

    def dress(self, ax: Any, side: str) -> None:
        """Label and scale of the "x" or "y" axis of matplotlib axes."""
        label, scale, ticks = (getattr(ax, f"set_{side}{what}") for what in ("label", "scale", "ticks"))
        label(self.name)
        if self.is_log:
            scale("log")
        at = self.distinct
        if self.words is not None or (len(at) <= FEW and self._apart(at) >= APART):
            ticks(at, [self.text(position) for position in at])
            if self.is_log:
                ticks([], minor=True)

    def _apart(self, at: np.ndarray) -> float:
        """The least distance of two values over the length of the axis."""
        shown = np.log(at) if self.is_log else at
        return float(np.diff(shown).min() / np.ptp(shown)) if len(at) > 1 else 1.0


def axis_of(table: Table, name: str) -> Axis:
    """The parameter as an axis. Raises `InputError` for an unknown one."""
    if name not in table.parameter_names:
        raise unknown_name("sweep: parameter", name, table.parameter_names)
    column = table[name]
    if column.dtype != object and column.dtype != bool:
        return Axis(name, column.astype(float))
    texts = column.astype(str)
    words, positions = np.unique(texts, return_inverse=True)
    return Axis(name, positions.astype(float), tuple(map(str, words)))


def axes_of(table: Table, rows: np.ndarray) -> list[Axis]:
    """The parameters in which the `rows` (run,) differ."""
    found = [axis_of(table, name) for name in table.parameter_names]
    return [axis for axis in found if len(np.unique(axis.positions[rows])) > 1]


def grid_places(axes: Sequence[Axis], rows: np.ndarray) -> tuple[list[np.ndarray], np.ndarray] | None:
    """The values of each axis, and the grid indices of the `rows` (run,): (rows, axes) integers. None if the rows are
    not a whole grid, every combination once."""
    if not axes:
        return None
    values, places = zip(*(np.unique(axis.positions[rows], return_inverse=True) for axis in axes), strict=True)
    places = np.stack(places, axis=1)
    size = int(np.prod([len(v) for v in values]))
    if len(places) != size or len(np.unique(places, axis=0)) != size:
        return None
    return list(values), places


ABSENT = 0.03  # of the height of the axes: position of marks of rows without a value


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
    is_first: bool  # in the figure: it has the legend of colours

    def draw(self, ax: Any) -> None:
        """Draw on matplotlib axes."""
        factor, label = self.values.shown()
        has = self.rows & self.values.has
        alone: dict[int, list[int]] = {}  # rows without a line, by their marker: drawn at once
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
        """Indices of the rows of each line, along x."""
        keys = [axis.positions for axis in (self.hue.axis, self.style, *self.others) if axis is not None]
        chosen = np.flatnonzero(has)
        if not len(chosen):
            return []
        _, of_line = np.unique(np.stack([*keys, np.zeros_like(self.x.positions)], axis=1)[chosen], axis=0,
                               return_inverse=True)  # fmt: skip
        lines = [chosen[of_line == n] for n in range(of_line.max() + 1)]
        return [line[np.argsort(self.x.positions[line], kind="stable")] for line in lines]

    def _color(self, row: int) -> Any:
        """The colour of a row's value of `hue`."""
        return self.hue.color(0.0 if self.hue.axis is None else float(self.hue.axis.positions[row]))

    def _place(self, row: int) -> int:
        """The index of a row's value among those of `style`."""
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


MAP = "magma_r"
LEVELS = 14  # of contours
WRITTEN = 36  # largest number of cells with written values
DARK = 0.55  # of the colour range, above which text is white
FLAT = 1e-6  # width over length, of positions scaled to their ranges, below which they are collinear


@dataclass(frozen=True, eq=False)
class Map:
    """`values` of the `rows` (run,) over `x` and `y`; `others` are the further parameters in which rows differ. limits:
    of the colours, in shown units; marked: rows with the least and the largest value, with a marker and a name each."""

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
        """Draw cells, triangles or points."""
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
        """Write the values into their cells, at the lower edge of each, so that markers do not hide them."""
        low, high = self.limits
        for (i, k), value in np.ndenumerate(field):
            if np.isfinite(value):
                color = "white" if value > low + DARK * (high - low) else "black"
                ax.annotate(f"{value:.4g}", (at[0][i], at[1][k]), (0, -9), textcoords="offset points", color=color,
                            ha="center", va="top", fontsize=7)  # fmt: skip


def _edges(at: np.ndarray, is_log: bool) -> np.ndarray:
    """Borders (n + 1,) of cells around positions (n,), which are at their centres if evenly spaced."""
    at = np.log(at) if is_log else at
    if len(at) == 1:
        edges = at[0] + np.array([-0.5, 0.5])
    else:
        middles = 0.5 * (at[1:] + at[:-1])
        edges = np.concatenate([[2.0 * at[0] - middles[0]], middles, [2.0 * at[-1] - middles[-1]]])
    return np.exp(edges) if is_log else edges


def _spread(x: np.ndarray, y: np.ndarray) -> bool:
    """Whether the positions are not collinear."""
    if len(x) < 3 or not np.ptp(x) or not np.ptp(y):
        return False
    scaled = np.stack([(x - x.mean()) / np.ptp(x), (y - y.mean()) / np.ptp(y)])
    length, breadth = np.linalg.svd(scaled, compute_uv=False)
    return bool(breadth > FLAT * length)


MOST_LINES = 400  # rows drawn, evenly selected


@dataclass(frozen=True, eq=False)
class Histories:
    """`values` (run, time) of the `rows` (run,) over time, one line per row, coloured by `hue`. A row that ended early
    is dotted, with a cross at its end; rows without any value are stated in the title."""

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
