"""Tables of a study: of all runs, of those on a front, of the orders in the step.

In the table of all runs, those that differ in the step only follow one another, from coarse to fine. `shortened` leaves
out what says nothing in a table to be read: a column that has the same in all rows, and the median of single runs.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from math import isfinite
from statistics import median

from warpffrf.study.speed_against_error.choices import text_of
from warpffrf.study.speed_against_error.front import STEP, Order, changed_names, front, grouped
from warpffrf.study.speed_against_error.runs import Row

NONE = "-"  # of what a row does not have
FASTEST, MEDIAN, UNITS = "wall s/s, fastest", "median", "step U"
FRONT = "on the front of"
ALL = "all"  # measures

Head = list[str]
Lines = list[list[str]]


def ordered(rows: Sequence[Row]) -> list[Row]:
    """Groups of rows that differ in the step only, in the order in which they were chosen, coarse steps first."""
    return [row for group in grouped(rows).values() for row in group]


def _choices(rows: Sequence[Row]) -> list[str]:
    """The names that rows differ in, the step last."""
    names = changed_names(rows)
    return [name for name in names if name != STEP] + [name for name in names if name == STEP]


def _choice(row: Row, name: str) -> str:
    return text_of(row.setting.get(name, "as given"))


def _error(row: Row, measure: str) -> str:
    return f"{100.0 * row.errors[measure]:.3g}" if measure in row.errors else NONE


def _units(row: Row, unit: float | None) -> str:
    """A step of the fastest run in units of U."""
    return f"{row.fastest * row.setting[STEP] / unit:.3g}" if unit and row.walls else NONE


def full_table(rows: Sequence[Row], measures: Sequence[str], unit: float | None) -> tuple[Head, Lines]:
    """Every run; `unit`: U [s], None if not known."""
    names = _choices(rows)
    marks = {m: {id(row) for row in front(rows, m)} for m in measures}
    costs: dict[str, Callable[[Row], str]] = {
        FASTEST: lambda row: f"{row.fastest:.4g}",
        MEDIAN: lambda row: f"{row.median:.4g}",
        "in graph [%]": lambda row: f"{100.0 * median(g / w for g, w in zip(row.graphs, row.walls, strict=True)):.0f}",
        UNITS: lambda row: _units(row, unit),
        "set-up s": lambda row: f"{min(row.set_up):.2g}",
        "checks s": lambda row: f"{min(row.after):.2g}",
    }
    head = [*names, *(f"{m} [%]" for m in measures), *costs, "offline s", FRONT, "status"]
    lines = []
    for row in ordered(rows):
        on = [m for m in measures if id(row) in marks[m]]
        lines.append(
            [
                *(_choice(row, name) for name in names),
                *(_error(row, m) for m in measures),
                *(cost(row) if row.walls else NONE for cost in costs.values()),
                f"{row.offline:.3g}" if isfinite(row.offline) else NONE,
                ALL if len(on) == len(measures) else ", ".join(on),
                f"{row.status}: {row.reason}".rstrip(": "),
            ]
        )
    return head, lines


def shortened(head: Head, lines: Lines) -> tuple[Head, Lines, dict[str, str]]:
    """The table without the columns that say nothing, and what those have that are the same in all rows."""
    columns = dict(zip(head, zip(*lines, strict=True), strict=True))
    same = {name: column[0] for name, column in columns.items() if len(lines) > 1 and len(set(column)) == 1}
    single = columns[MEDIAN] == columns[FASTEST]
    kept = [n for n, name in enumerate(head) if name not in same and not (name == MEDIAN and single)]
    told = {name: value for name, value in same.items() if value not in (NONE, "")}
    return [head[n] for n in kept], [[line[n] for n in kept] for line in lines], told


def front_table(rows: Sequence[Row], measures: Sequence[str], unit: float | None) -> tuple[Head, Lines]:
    """The rows that are on the front of any of `measures`, from fast to slow."""
    names = _choices(rows)
    marks = {m: {id(row) for row in front(rows, m)} for m in measures}
    head = [*names, *(f"{m} [%]" for m in measures), "wall s/s", UNITS, FRONT]
    lines = []
    for row in sorted((row for row in rows if row.timed), key=lambda row: row.fastest):
        on = [m for m in measures if id(row) in marks[m]]
        if on:
            lines.append(
                [
                    *(_choice(row, name) for name in names),
                    *(_error(row, m) for m in measures),
                    f"{row.fastest:.4g}",
                    _units(row, unit),
                    ALL if len(on) == len(measures) else ", ".join(on),
                ]
            )
    return head, lines


def _orders(order: Order) -> str:
    return ", ".join(f"{p:.2f}" if isfinite(p) else NONE for p in order.orders)


def order_table(found: Sequence[Order]) -> tuple[Head, Lines]:
    """A row for each combination of the other choices, a column for each measure: orders from coarse to fine."""
    groups: dict[str, dict[str, Order]] = {}
    for order in found:
        groups.setdefault(order.group, {})[order.measure] = order
    measures = list(dict.fromkeys(order.measure for order in found))
    lines = []
    for group, by_measure in groups.items():
        shown = [_orders(by_measure[m]) if m in by_measure else NONE for m in measures]
        steps = next(iter(by_measure.values())).steps
        lines.append([group, f"{steps[0]:.3g} to {steps[-1]:.3g}", *shown])
    return ["runs", "steps [s]", *measures], lines
