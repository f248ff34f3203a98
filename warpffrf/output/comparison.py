r"""Comparison of two runs: differences of settings and of histories.

A history with components, such as a force, is compared as a vector. With a and b the values of A and B on the times of
A,

    relative L2 = sqrt( int |b - a|^2 dt / int |a|^2 dt ),      largest difference = max over time of |b - a|,

by the trapezoidal rule, over the common time of both runs. If their times differ, b is interpolated linearly between
the rows of B. Quaternions q and -q are the same rotation: the one nearer to A's is used. Integers (iterations, columns
of a grid, states) depend on the settings of a run and are not compared.

Differences of round-off, or of the tolerance of iterations, are counted, but neither listed nor drawn: a largest
difference below 1e-6, of a motion 1e-9, of the largest value of its quantity in both runs, or of the scale of its unit,
with the size L of the machine, the duration T of the run, the largest force F and the largest energy E: L [m], L/T
[m/s], 1/T [rad/s], F L [N m], E/T [W], 1 [rad and without a unit]. Values below 1e-8 of the largest value of their
quantity in both runs are also round-off. The remaining ones are sorted by their share: the root mean square of |b - a|
over the largest value of the quantity, such as of all forces of joints, but of other than motions at least over 1 % of
the scale of its unit, so that what is small compared with its like comes last.
"""

from __future__ import annotations

import os
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np

from warpffrf.model.errors import InputError, require_count, unknown_name
from warpffrf.model.messages.named_arguments import named_arguments
from warpffrf.output.files.fields import RUN_FIELDS
from warpffrf.output.files.table import Series, histories
from warpffrf.output.plots.colors import FINEST, LEAST
from warpffrf.output.plots.panels import Overlaid, overlay_figure
from warpffrf.output.plots.picture import write_picture
from warpffrf.output.result import Result
from warpffrf.output.run_settings import settings_apart

SAME_TIME = 1e-9  # of the duration: closer times are equal
LEAST_SEEN = 1e-8  # of the largest of a quantity: smaller values in both runs are round-off
ROUND_OFF = 1e-9  # of the same, of motions: smaller differences are round-off; for other quantities `LEAST` applies
MOTIONS = ("m", "m/s", "rad", "rad/s")
LISTED = 20  # settings and histories in a report
MINOR = 0.01  # of the scale of its unit: quantities that are smaller come last
HIDDEN = 0.01  # of the range of a curve: a smaller difference cannot be seen
DRAWN = 6  # histories in a picture
COUNTED = {field.name for field in RUN_FIELDS} | {
    "contact_active_nodes", "contact_first_column", "contact_center_column", "contact_first_column_second",
    "contact_cell_column", "contact_cell_column_second", "contact_cells_per_step", "joint_friction_state",
}  # fmt: skip


@dataclass(frozen=True)
class Difference:
    """Difference between B and A in one history `label`, with its unit: `relative` L2 (inf if A is zero), `largest`
    difference, the time of it `at` [s], the largest value of A, `size`, and the `share` in its quantity; `same`: the
    difference is round-off."""

    label: str
    units: str
    relative: float
    largest: float
    at: float
    size: float
    share: float
    same: bool = False


class Comparison:
    """Run B compared with run A; returned by `compare`. `differences`: a `Difference` for each common history, sorted
    by descending share, followed by those equal up to round-off; `settings`: name -> (of A, of B) where
    they differ; `notes`: what was interpolated, omitted, or is equal."""

    def __init__(self, a: Result, b: Result, names: tuple[str, str]) -> None:
        self.a, self.b, self.names = a, b, names
        self.settings, self.notes = settings_apart(a, b, max(_extent(a), _extent(b)))
        self._first, self._second = ({s.label: s for s in histories(run) if s.name not in COUNTED} for run in (a, b))
        self.differences = self._compared()

    def __repr__(self) -> str:
        apart = self._apart()
        worst = f" in {len(apart)}, largest relative L2 {apart[0].relative:.3g}" if apart else " in none"
        return f"Comparison({len(self.differences)} histories, differ{worst}; {len(self.settings)} settings differ)"

    def _apart(self) -> list[Difference]:
        """The `differences` above round-off."""
        return [found for found in self.differences if not found.same]

    def _compared(self) -> list[Difference]:
        first, second = self._first, self._second
        for own, other, name in ((first, second, "A"), (second, first, "B")):
            if alone := [label for label in own if label not in other]:
                self.notes.append(f"{len(alone)} histories only in {name}, the first {alone[0]}")
        common = [label for label in first if label in second and first[label].components == second[label].components]
        if not common:
            raise InputError("compare: the runs have no history in common; compare runs of one machine")
        rows = self._rows()
        time = self.a.time[rows]
        scale: dict[tuple[str, str], float] = {}
        for label in common:
            largest = max(_largest(first[label].values), _largest(second[label].values))
            kind = first[label].name, first[label].units
            scale[kind] = max(scale.get(kind, 0.0), largest)
        self._sizes = _sizes([self.a, self.b], [*first.values(), *second.values()])
        found, still, torn = [], 0, []
        for label in common:
            a, b = first[label], second[label]
            if max(_largest(a.values), _largest(b.values)) <= LEAST_SEEN * scale[a.name, a.units]:
                still += 1
                continue
            values = a.values[rows]
            difference, size = _size(self._on_times(b, time, values) - values), _size(values)
            both = np.isfinite(difference)
            if np.any(np.isfinite(size) != both):
                torn.append(label)
            if both.any():
                of, machine = scale[a.name, a.units], self._sizes.get(a.units, 0.0)
                least = _least(a.units) * max(of, machine)
                of = of if a.units in MOTIONS else max(of, MINOR * machine)
                found.append(_difference(a, time[both], difference[both], size[both], of, least))
        if still:
            self.notes.append(f"{still} histories are zero, or round-off, in both")
        if torn:
            self.notes.append(f"{len(torn)} histories have rows in which only one run has a value, the first {torn[0]}")
        if same := sum(d.same for d in found):
            self.notes.append(
                f"histories that are the same to {LEAST:g} of their size, motions to {ROUND_OFF:g}: {same}"
            )
        return sorted(found, key=lambda d: np.inf if d.same else -d.share)

    def _rows(self) -> np.ndarray:
        """Rows of A within the time of B; notes state what was omitted, and whether B is interpolated."""
        a, b = self.a.time, self.b.time
        if not len(a) or not len(b):
            raise InputError("compare: a run without saved rows; compare runs that have some")
        tolerance = SAME_TIME * max(abs(a[-1] - a[0]), abs(b[-1] - b[0]))
        rows = np.flatnonzero((a >= b[0] - tolerance) & (a <= b[-1] + tolerance))
        if not len(rows):
            raise InputError(
                f"compare: the runs have no time in common, {a[0]:g} to {a[-1]:g} s and {b[0]:g} to {b[-1]:g} s"
            )
        if len(rows) < len(a):
            self.notes.append(
                f"{len(rows)} of the {len(a)} rows of A are within the time of B, {b[0]:g} to {b[-1]:g} s"
            )
        nearest = np.abs(b[_nearest(b, a[rows])] - a[rows])
        self._interpolated = bool(np.any(nearest > tolerance))
        if self._interpolated:
            self.notes.append("B is interpolated linearly between its rows where it has none at a time of A")
        return rows

    def _on_times(self, series: Series, time: np.ndarray, beside: np.ndarray) -> np.ndarray:
        """Values of B at `time`; for quaternions with the sign nearer to `beside`."""
        values, own = series.values, self.b.time
        turns = "quaternion" in series.frame
        if turns:
            flips = np.where(np.sum(values[1:] * values[:-1], axis=1) < 0.0, -1.0, 1.0)
            values = values * np.cumprod(np.concatenate([[1.0], flips]))[:, None]
        if self._interpolated:
            values = np.stack([np.interp(time, own, column) for column in values.T], axis=1)
            values = values / np.linalg.norm(values, axis=1, keepdims=True) if turns else values
        else:
            values = values[_nearest(own, time)]
        if turns:
            values = values * np.where(np.sum(values * beside, axis=1) < 0.0, -1.0, 1.0)[:, None]
        return values

    def report(self, most: int | None = LISTED) -> str:
        """Settings that differ and the histories that differ most, at most `most` of each (None: all)."""
        most = None if most is None else require_count(most, "report: most", 1)
        apart = self._apart()
        listed = apart[:most]
        lines = [f"A: {self.names[0]}", f"B: {self.names[1]}"]
        if self.settings:
            shown = dict(list(self.settings.items())[:most])
            width = max(len(name) for name in shown)
            first = max(len(values[0]) for values in shown.values())
            lines += ["settings that differ"]
            lines += [f"  {name:{width}}  {a:{first}}  {b}" for name, (a, b) in shown.items()]
            if len(shown) < len(self.settings):
                lines.append(f"  ... and {len(self.settings) - len(shown)} more")
        else:
            lines += ["no settings differ"]
        lines += [f"note: {note}" for note in self.notes]
        if not listed:
            return "\n".join([*lines, "no histories differ"])
        width = max([len(d.label) + len(d.units) + 3 for d in listed], default=0)
        lines.append(f"{'history':{width}}  relative L2  largest difference      at [s]  largest of A")
        for d in listed:
            relative = f"{d.relative:11.3e}" if np.isfinite(d.relative) else f"{'A is 0':>11}"
            name = f"{d.label} [{d.units}]"
            lines.append(f"{name:{width}}  {relative}  {d.largest:18.4e}  {d.at:10.6g}  {d.size:12.4e}")
        if len(listed) < len(apart):
            lines.append(f"... and {len(apart) - len(listed)} that differ less")
        return "\n".join(lines)

    def figure(self, labels: Sequence[str] | None = None, *, theme: str = "light", width: float | None = None) -> Any:
        """A matplotlib Figure of both runs over time, one panel for each history in `labels`, named as in
        `differences`; None: the six that differ most, or six of the equal ones if none differs. For a vector the
        component that differs most is drawn, or the largest if all are equal; where both curves would coincide, B - A
        is drawn instead. theme, width: "dark" and the width [m] of a printed column. Raises
        InputError for a history that the runs do not share."""
        found = {d.label: d for d in self.differences}
        for label in labels or ():
            if label not in found:
                raise unknown_name("compare: history", label, tuple(found))
        chosen = list(labels or [d.label for d in self._apart()] or found)[: None if labels else DRAWN]
        if not chosen:
            raise InputError("compare: nothing to draw, all that the runs share is zero in both")
        return overlay_figure([self._panel(found[label]) for label in chosen], self.names, theme=theme, width=width)

    def _panel(self, difference: Difference) -> Overlaid:
        a, b = self._first[difference.label], self._second[difference.label]
        time = self.a.time[(self.a.time >= self.b.time[0]) & (self.a.time <= self.b.time[-1])]
        apart = [
            np.nanmax(np.abs(np.interp(time, self.b.time, v) - np.interp(time, self.a.time, u)), initial=0.0)
            for u, v in zip(a.values.T, b.values.T, strict=True)
        ]
        if difference.same:
            apart = [_largest(values) for values in a.values.T]
        n = int(np.argmax(apart))
        label = list(a.columns)[n]
        said = "A is zero" if np.isinf(difference.relative) else f"differs by {100.0 * difference.relative:.3g} %"
        said = f"the same to {_least(a.units):g} of its size" if difference.same else said
        first, second = (self.a.time, a.values[:, n]), (self.b.time, b.values[:, n])
        least = max(FINEST * max(_largest(a.values), _largest(b.values)), LEAST * self._sizes.get(a.units, 0.0))
        apart = None
        if not difference.same and len(time) > 1:
            u, v = (np.interp(time, *curve) for curve in (first, second))
            apart = (time, v - u) if _largest(v - u) < HIDDEN * max(np.ptp(u), np.ptp(v), least) else None
        return Overlaid(label, a.units, f"{label}: {said}", first, second, least, apart)

    def save_figure(
        self, path: str | os.PathLike[str], labels: Sequence[str] | None = None, *, theme: str = "light",
        width: float | None = None, overwrite: bool = False,
    ) -> Path:  # fmt: skip
        """Write `figure` of the same labels, theme and width [m] as .png, .pdf or .svg. Raises InputError for a path
        that cannot be written and for an existing file, unless `overwrite` is set and warpffrf wrote it."""
        return write_picture(self.figure(labels, theme=theme, width=width), path, "compare", overwrite=overwrite)


@named_arguments
def compare(a: Result | str | os.PathLike[str], b: Result | str | os.PathLike[str]) -> Comparison:
    """Compare run `b` with run `a`, given as results or their files: `.report()` lists the settings that differ and,
    for every history, the relative L2 and largest difference at A's times; `.save_figure(path)` draws both. Raises
    InputError for files that cannot be read and for runs that share neither a history nor a time.

    >>> finer = wf.simulate(scene, 2e-3, step=1e-4, start="equilibrium", results="finer.h5", progress=False)
    >>> found = wf.compare("finer.h5", "press.h5")
    >>> found.settings["step"]
    ('0.0001', '0.0002')
    """
    runs = [run if isinstance(run, Result) else Result.load(run) for run in (a, b)]
    return Comparison(runs[0], runs[1], _names(a, b))


def _names(a: Any, b: Any) -> tuple[str, str]:
    """Labels of the runs: names of their files, with folders if these are equal, else with A and B."""
    runs = (a, b)
    for part in (lambda path: path.name, str):
        first, second = ("result" if isinstance(run, Result) else part(Path(run)) for run in runs)
        if first != second:
            return first, second
    return f"{first} (A)", f"{second} (B)"


def _largest(values: np.ndarray) -> float:
    return float(np.nanmax(np.abs(values[np.isfinite(values)]), initial=0.0))


def _size(values: np.ndarray) -> np.ndarray:
    return np.sqrt(np.sum(np.asarray(values, dtype=float) ** 2, axis=1))


def _nearest(times: np.ndarray, wanted: np.ndarray) -> np.ndarray:
    """The row of `times` (ascending) nearest to each of `wanted`."""
    after = np.clip(np.searchsorted(times, wanted), 1, max(len(times) - 1, 1))
    before = after - 1
    after = np.minimum(after, len(times) - 1)
    return np.where(wanted - times[before] <= times[after] - wanted, before, after)


def _sizes(runs: Sequence[Result], found: Sequence[Series]) -> dict[str, float]:
    """Scale of each unit for the machine, as in the module docstring."""
    length = max(_extent(run) for run in runs)
    spans = [float(run.time[-1] - run.time[0]) for run in runs]
    rate = 1.0 / max(spans) if max(spans) > 0.0 else 0.0
    force = max((_largest(s.values) for s in found if s.units == "N"), default=0.0)
    energy = max(run.energy_scale for run in runs)
    return {
        "m": length, "m/s": length * rate, "m/s2": length * rate**2, "rad": 1.0, "rad/s": rate, "rad/s2": rate**2,
        "1": 1.0, "N": force, "N m": force * length, "J": energy, "W": energy * rate,
    }  # fmt: skip


def _extent(run: Result) -> float:
    """Distance [m] between bodies at the start, and the largest of their radii of gyration."""
    places = [motion.position[0] for motion in run.history.bodies.values()]
    turning = [
        np.sqrt(0.5 * np.trace(body.inertia) / body.mass)
        for body in run.view.bodies.values()
        if body.inertia is not None and body.mass > 0.0
    ]
    return float(np.linalg.norm(np.ptp(places, axis=0)) if places else 0.0) + float(max(turning, default=0.0))


def _least(units: str) -> float:
    """Share of its scale below which a difference is round-off."""
    return ROUND_OFF if units in MOTIONS else LEAST


def _difference(
    series: Series, time: np.ndarray, difference: np.ndarray, size: np.ndarray, scale: float, least: float
) -> Difference:
    """Difference with the lengths `difference` (T,) at `time` (T,) of a quantity up to `scale`; up to `least` they are
    round-off."""
    if len(time) == 1:
        above, below = float(difference[0]), float(size[0])
    else:
        above, below = (float(np.sqrt(np.trapezoid(v**2, time))) for v in (difference, size))
    duration = float(np.sqrt(time[-1] - time[0])) or 1.0
    relative = above / below if below > 0.0 else (np.inf if above > 0.0 else 0.0)
    worst = int(np.argmax(difference))
    largest = float(difference[worst])
    same = largest <= least
    share = above / duration / scale
    return Difference(
        series.label, series.units, relative, largest, float(time[worst]), float(np.max(size)), share, same
    )
