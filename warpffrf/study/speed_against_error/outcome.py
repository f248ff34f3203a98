"""`SpeedError`: a study that was made, its fronts, the setting for a wanted error, tables, pictures and files."""

from __future__ import annotations

import csv
import io
from collections.abc import Sequence
from pathlib import Path
from typing import Any

from warpffrf.model.errors import InputError, require_number
from warpffrf.model.files.output_paths import checked_output_path, written_whole
from warpffrf.output.plots.picture import write_picture
from warpffrf.study.speed_against_error.errors import RECOMMENDED
from warpffrf.study.speed_against_error.front import Order, fastest, front, orders
from warpffrf.study.speed_against_error.machine import unit_of
from warpffrf.study.speed_against_error.picture import pareto_figure, steps_figure
from warpffrf.study.speed_against_error.report import report
from warpffrf.study.speed_against_error.runs import Row
from warpffrf.study.speed_against_error.tables import full_table


class SpeedError:
    """A study: `rows`, the `reference` (setting, differences from twice its step), `left_out` (name, value, reason),
    `sittings`, the machines that times were taken on."""

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
        """Rows that no other is both faster and at least as right as, from fast to slow."""
        if measure not in self.measures:
            raise InputError(f"speed_error: {measure!r} was not measured; known: {', '.join(self.measures)}")
        return front(self.rows, measure)

    def recommended(self, error: float, measures: Sequence[str] | None = None) -> Row:
        """The fastest row with at most `error` (a fraction) in all `measures`, by default all against the reference.
        Raises `InputError` for an error below what the reference itself differs by from twice its step, and where no
        row has it, which says the least that was reached."""
        require_number(error, "speed_error: error", positive=True)
        wanted = [m for m in RECOMMENDED if m in self.measures] if measures is None else list(measures)
        known = {m: float(self.reference["apart"].get(m, 0.0)) for m in wanted}
        least_known = max(known, key=lambda m: known[m], default=None)
        if least_known is not None and error < known[least_known]:
            raise InputError(
                f"speed_error: an error of {error:g} cannot be told by this study: in {least_known} its reference "
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
        """Head and rows of the table of all runs: those that differ in the step only follow one another."""
        return full_table(self.rows, self.measures, unit_of(self.sittings))

    def report(self) -> str:
        """Everything as Markdown."""
        return report(self)

    def write(self, folder: str | Path, *, overwrite: bool = False) -> list[Path]:
        """Write speed_error.csv, .md and .png, the fronts, and speed_error_steps.png where steps were chosen. Raises
        `InputError` for files that cannot be written, or exist where `overwrite` is not set."""
        head, lines = self.table()
        text = io.StringIO()
        csv.writer(text).writerows([["warpffrf speed_error", self.title], head, *lines])
        files = {"speed_error.csv": text.getvalue(), "speed_error.md": f"<!-- warpffrf -->\n{self.report()}"}
        paths = [checked_output_path(Path(folder) / name, "speed_error", overwrite=overwrite) for name in files]
        for path, content in zip(paths, files.values(), strict=True):
            with written_whole(path) as partial:
                partial.write_text(content, encoding="utf-8")
        return paths + self.draw(Path(folder) / "speed_error", overwrite=overwrite)

    def draw(self, stem: str | Path, *, overwrite: bool = False) -> list[Path]:
        """Write the pictures STEM.png and, where steps were chosen, STEM_steps.png; raises as `write` does."""
        about = self.rows, self.measures, self.reference["apart"]
        pareto = pareto_figure(*about, self.title)
        steps = steps_figure(*about, self.orders(), self.title)
        figures = {f"{stem}.png": pareto} | ({} if steps is None else {f"{stem}_steps.png": steps})
        return [write_picture(figure, path, "speed_error", overwrite=overwrite) for path, figure in figures.items()]
