"""What to draw of a sweep: an output over a parameter, over time, or over two parameters, on panels of one figure."""

from __future__ import annotations

import os
from collections.abc import Mapping, Sequence
from typing import Any

import numpy as np

from warpffrf.model.errors import InputError, unknown_name
from warpffrf.output.plots.figure import STYLES
from warpffrf.output.plots.panels import Drawn, panels_figure
from warpffrf.output.plots.picture import write_picture
from warpffrf.output.plots.scales import HEADROOM, LEAST, SMALL
from warpffrf.study.sweeps.reading.axes import Axis, axes_of, axis_of, grid_places
from warpffrf.study.sweeps.reading.curves import Curves
from warpffrf.study.sweeps.reading.histories import Histories
from warpffrf.study.sweeps.reading.hues import Hue
from warpffrf.study.sweeps.reading.maps import Map
from warpffrf.study.sweeps.reading.values import Table, Values, chosen_rows, values_of

KINDS = ("curves", "map")
MOST_PANELS = 12
ROOM = 0.06  # of the range, above and below it


def panels_of(
    table: Table, output: str, x: str | None = None, y: str | None = None, hue: str | None = None,
    style: str | None = None, col: str | None = None, kind: str | None = None, component: str | int | None = None,
    where: Mapping[str, Any] | None = None,
) -> tuple[Sequence[Drawn], str]:  # fmt: skip
    """The panels of `Sweep.plot`, and the title above them."""
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
    table: Table, output: str, *, path: str | os.PathLike[str] | None = None, overwrite: bool = False, **chosen: Any
) -> Any:
    """A matplotlib Figure of an output, `chosen` by the arguments of `panels_of`; written to `path` where that is
    given."""
    figure = panels_figure(*panels_of(table, output, **chosen))
    if path is not None:
        write_picture(figure, path, "sweep: picture", overwrite=overwrite)
    return figure


def _named(values: Values) -> str:
    """The output, and what it is where that is another word."""
    return values.name if values.text == values.name else f"{values.name} = {values.text}"


def _begun(values: Values, rows: np.ndarray) -> bool:
    """Whether a row that was not completed has a history."""
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
    """Panels over x, the first parameter that varies where it is left out; of a grid the next one is the colour, and a
    last one of few values the dashes."""
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
    """Of the value axis of all panels: from zero where values are far from alike, as plots of runs are."""
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
    """Panels over x and y, the first parameters that vary where they are left out."""
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
