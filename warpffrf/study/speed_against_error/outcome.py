"""`SpeedError`: result of a study, its fronts, the setting for a required error, tables, pictures and files.

Tables of a study: all runs, those on a front, orders in the step.

In the table of all runs, those that differ in the step only are adjacent, from coarse to fine. `shortened` omits
columns without information: those with equal values in all rows, and the median of single runs.

Report. The report of a study as Markdown: reference, machine, settings for a required error, fronts, orders, all runs.
"""

from __future__ import annotations

import csv
import io
from collections.abc import Callable, Sequence
from math import isfinite
from pathlib import Path
from statistics import median
from typing import Any

from warpffrf.model.errors import InputError, require_number
from warpffrf.model.files.paths import checked_output_path, written_whole
from warpffrf.output.plots.picture import write_picture
from warpffrf.output.plots.restyle import require_theme, restyle
from warpffrf.study.markdown import table
from warpffrf.study.speed_against_error.choices import text_of
from warpffrf.study.speed_against_error.errors import OWN, RECOMMENDED
from warpffrf.study.speed_against_error.front import (
    STEP,
    WANTED,
    Order,
    changed_names,
    fastest,
    front,
    grouped,
    label_in,
    orders,
)
from warpffrf.study.speed_against_error.machines import stated, unit_of
from warpffrf.study.speed_against_error.picture import pareto_figure, steps_figure
from warpffrf.study.speed_against_error.runs import Row


class SpeedError:
    """A study: `rows`, the `reference` (setting, differences from twice its step), `left_out` (name, value, reason),
    `sittings`, the machines of the timings."""

    def __init__(
        self,
        title: str,
        measures: tuple[str, ...],
        rows: list[Row],
        reference: dict[str, Any],
        left_out: list[tuple[str, str, str]],
        series: dict[str, dict[str, Any]],
        sittings: list[dict[str, Any]],
    ) -> None:
        self.title, self.measures, self.rows = title, measures, rows
        self.reference, self.left_out, self._series = reference, left_out, series
        self.sittings = sittings

    def front(self, measure: str) -> list[Row]:
        """Rows for which no other is both faster and at least as accurate, from fast to slow."""
        if measure not in self.measures:
            raise InputError(f"speed_error: {measure!r} was not measured; known: {', '.join(self.measures)}")
        return front(self.rows, measure)

    def recommended(self, error: float, measures: Sequence[str] | None = None) -> Row:
        """The fastest row with at most `error` (a fraction) in all `measures`, by default all with a reference. Raises
        `InputError` for an error below the difference of the reference from that with twice its step, and if no row
        reaches it, with the least error reached."""
        require_number(error, "speed_error: error", positive=True)
        wanted = [m for m in RECOMMENDED if m in self.measures] if measures is None else list(measures)
        known = {m: float(self.reference["apart"].get(m, 0.0)) for m in wanted}
        least_known = max(known, key=lambda m: known[m], default=None)
        if least_known is not None and error < known[least_known]:
            raise InputError(
                f"speed_error: an error of {error:g} cannot be assessed by this study: in {least_known} its reference "
                f"differs from twice its own step by {known[least_known]:.2g}; "
                "give it a finer step, reference={'step': ...}"
            )
        found = fastest(self.rows, error, wanted)
        if found is None:
            worst = [max(r.errors.get(m, float("inf")) for m in wanted) for r in self.rows if r.timed]
            least = f"the least reached is {min(worst):.2g}" if worst else "no run was completed"
            raise InputError(f"speed_error: no setting of this study is within {error:g}; {least}; refine its choices")
        return found

    def orders(self) -> list[Order]:
        """Observed orders in the step."""
        return orders(self.rows, self._series)

    def table(self) -> tuple[list[str], list[list[str]]]:
        """Head and rows of the table of all runs: those that differ in the step only are adjacent."""
        return full_table(self.rows, self.measures, unit_of(self.sittings))

    def report(self) -> str:
        """The complete report as Markdown."""
        return report(self)

    def write(self, folder: str | Path, *, overwrite: bool = False) -> list[Path]:
        """Write speed_error.csv, .md and .png, the fronts, and, if steps were varied, speed_error_steps.png. Raises
        `InputError` for files that cannot be written, or exist if `overwrite` is not set."""
        head, lines = self.table()
        text = io.StringIO()
        csv.writer(text).writerows([["warpffrf speed_error", self.title], head, *lines])
        files = {"speed_error.csv": text.getvalue(), "speed_error.md": f"<!-- warpffrf -->\n{self.report()}"}
        paths = [checked_output_path(Path(folder) / name, "speed_error", overwrite=overwrite) for name in files]
        for path, content in zip(paths, files.values(), strict=True):
            with written_whole(path) as partial:
                partial.write_text(content, encoding="utf-8")
        return paths + self.draw(Path(folder) / "speed_error", overwrite=overwrite)

    def draw(
        self, stem: str | Path, *, theme: str = "light", width: float | None = None, overwrite: bool = False
    ) -> list[Path]:
        """Write the pictures STEM.png and, if steps were varied, STEM_steps.png; theme, width [m]: as of
        `Result.plot`; raises as `write`, and InputError for an unknown theme."""
        require_theme(theme)
        about = self.rows, self.measures, self.reference["apart"]
        pareto = pareto_figure(*about, self.title)
        steps = steps_figure(*about, self.orders(), self.title)
        figures = {f"{stem}.png": pareto} | ({} if steps is None else {f"{stem}_steps.png": steps})
        return [
            write_picture(restyle(figure, theme, width), path, "speed_error", overwrite=overwrite)
            for path, figure in figures.items()
        ]


NONE = "-"  # for missing values
FASTEST, MEDIAN, UNITS = "wall s/s, fastest", "median", "step U"
FRONT = "on the front of"
ALL = "all"  # measures

Head = list[str]
Lines = list[list[str]]


def ordered(rows: Sequence[Row]) -> list[Row]:
    """Groups of rows that differ in the step only, in the order of the choices, coarse steps first."""
    return [row for group in grouped(rows).values() for row in group]


def _choices(rows: Sequence[Row]) -> list[str]:
    """The names in which rows differ, the step last."""
    names = changed_names(rows)
    return [name for name in names if name != STEP] + [name for name in names if name == STEP]


def _choice(row: Row, name: str) -> str:
    return text_of(row.setting.get(name, "as given"))


def _error(row: Row, measure: str) -> str:
    return f"{100.0 * row.errors[measure]:.3g}" if measure in row.errors else NONE


def _units(row: Row, unit: float | None) -> str:
    """Step time of the fastest run in units of U."""
    return f"{row.fastest * row.setting[STEP] / unit:.3g}" if unit and row.walls else NONE


def full_table(rows: Sequence[Row], measures: Sequence[str], unit: float | None) -> tuple[Head, Lines]:
    """All runs; `unit`: U [s], None if unknown."""
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
    """The table without columns that have no information, and the values that are equal in all rows."""
    columns = dict(zip(head, zip(*lines, strict=True), strict=True))
    same = {name: column[0] for name, column in columns.items() if len(lines) > 1 and len(set(column)) == 1}
    single = columns[MEDIAN] == columns[FASTEST]
    kept = [n for n, name in enumerate(head) if name not in same and not (name == MEDIAN and single)]
    told = {name: value for name, value in same.items() if value not in (NONE, "")}
    return [head[n] for n in kept], [[line[n] for n in kept] for line in lines], told


def front_table(rows: Sequence[Row], measures: Sequence[str], unit: float | None) -> tuple[Head, Lines]:
    """The rows on the front of any of `measures`, from fast to slow."""
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
    """One row for each combination of the other choices, one column per measure: orders from coarse to fine."""
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


def wanted_table(study: SpeedError) -> tuple[list[str], list[list[str]]]:
    """The fastest setting for each of WANTED, or the reason why there is none."""
    names, lines = changed_names(study.rows), []
    for error in WANTED:
        try:
            best = study.recommended(error)
            lines.append([f"{error:.1%}", label_in(names, best) or best.label, f"{best.fastest:.4g}"])
        except InputError as none:
            lines.append([f"{error:.1%}", str(none).removeprefix("speed_error: "), "-"])
    return ["error", "setting", "wall s/s"], lines


def report(study: SpeedError) -> str:
    """The complete report."""
    unit = unit_of(study.sittings)
    apart = ", ".join(f"{m} {100.0 * e:.2g} %" for m, e in study.reference["apart"].items())
    parts = [
        f"Reference: {study.reference['label']}; difference with twice the step: {apart or 'nothing measured'}.",
        *(stated(facts) for facts in study.sittings),
        "Fastest setting for a required error of all measures against the reference:",
        table(*wanted_table(study)),
    ]
    against = [m for m in study.measures if m not in OWN]
    head, lines = front_table(study.rows, against, unit)
    if lines:
        parts += ["Settings on a front, from fast to slow; errors against the reference:", table(head, lines)]
    orders = study.orders()
    if orders:
        parts += [
            "Order in the step, from differences of runs with consecutive steps, coarse to fine:",
            table(*order_table(orders)),
        ]
    head, lines, same = shortened(*full_table(study.rows, study.measures, unit))
    parts += ["All runs:", table(head, lines)]
    if same:
        parts.append("Equal in all runs: " + ", ".join(f"{name} {value}" for name, value in same.items()) + ".")
    if UNITS in head:
        parts.append("`step U` is the time of a step in units of U.")
    parts += [f"Left out: {name} {value}: {reason}." for name, value, reason in study.left_out]
    return "\n\n".join(part.rstrip("\n") for part in parts) + "\n"
