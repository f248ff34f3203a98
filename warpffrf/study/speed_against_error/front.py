"""Pareto fronts of time and error, the fastest setting for a required error, and the observed order in the step.

A setting is on the front if no other is both faster and at least as accurate, to within ALIKE: choices without effect
give errors that differ by round-off. The order in the step requires no reference: for three runs with steps in the
constant ratio r and all else equal, with results a, b, c from coarse to fine,

    p = log(|a - b| / |b - c|) / log r.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass

import numpy as np

from warpffrf.study.speed_against_error.choices import text_of
from warpffrf.study.speed_against_error.runs import Row

STEP = "step"
WANTED = (0.10, 0.03, 0.01, 0.003, 0.001)
ALIKE = 1e-3  # relative difference of equal errors
SAME_RATIO = 1e-6  # for steps given as decimals


def changed_names(rows: Sequence[Row]) -> list[str]:
    """Names of choices in which the rows differ, in the order of their settings."""
    names = list(dict.fromkeys(name for row in rows for name in row.setting))
    return [n for n in names if len({text_of(row.setting.get(n, "as given")) for row in rows}) > 1]


def label_in(names: Sequence[str], row: Row) -> str:
    """Values of the choices `names` in `row`, as text."""
    return ", ".join(f"{name}={text_of(row.setting.get(name, 'as given'))}" for name in names)


def grouped(rows: Sequence[Row]) -> dict[str, list[Row]]:
    """Rows that differ in the step only, coarse steps first, by the other choices."""
    names = [name for name in changed_names(rows) if name != STEP]
    found: dict[str, list[Row]] = {}
    for row in rows:
        found.setdefault(label_in(names, row) or "all", []).append(row)
    return {label: sorted(group, key=lambda row: -row.setting[STEP]) for label, group in found.items()}


def front(rows: Sequence[Row], measure: str) -> list[Row]:
    """The rows on the front of `measure`, from fast to slow."""
    known = sorted((r for r in rows if measure in r.errors and r.timed), key=lambda r: (r.fastest, r.errors[measure]))
    found: list[Row] = []
    for row in known:
        if not found or row.errors[measure] < (1.0 - ALIKE) * found[-1].errors[measure]:
            found.append(row)
    return found


def fastest(rows: Sequence[Row], error: float, measures: Sequence[str]) -> Row | None:
    """The fastest row whose errors of all `measures` are at most `error`; None if there is none."""
    good = [r for r in rows if r.timed and all(r.errors.get(m, np.inf) <= error for m in measures)]
    return min(good, key=lambda r: r.fastest, default=None)


@dataclass(frozen=True)
class Order:
    """A group of runs that differ in the step only: `steps` (n,) s from coarse to fine, `apart` (n - 1,) relative
    difference of each from the next finer one, `orders` (n - 2,), NaN if the ratio of steps changes."""

    group: str
    local: str
    measure: str
    steps: np.ndarray
    apart: np.ndarray
    orders: np.ndarray


def orders(rows: Sequence[Row], series: Mapping[str, Mapping[str, np.ndarray]]) -> list[Order]:
    """Orders of all groups of at least three steps, by measure; `series`: label -> measure -> values of the run."""
    found = []
    for group, members in grouped([row for row in rows if row.label in series]).items():
        if len(members) < 3:
            continue
        steps = np.array([r.setting[STEP] for r in members])
        for measure in series[members[0].label]:
            values = [series[r.label][measure] for r in members]
            size = float(np.linalg.norm(values[-1]))
            if size == 0.0 or any(v.shape != values[-1].shape for v in values):
                continue
            apart = np.array([np.linalg.norm(a - b) for a, b in zip(values, values[1:], strict=False)]) / size
            local = members[0].setting.get("local_modes")
            local = str(getattr(local, "treatment", local))
            found.append(Order(group, local, measure, steps, apart, _rates(steps, apart)))
    return found


def _rates(steps: np.ndarray, apart: np.ndarray) -> np.ndarray:
    ratio = steps[:-1] / steps[1:]
    with np.errstate(divide="ignore", invalid="ignore"):
        rates = np.log(apart[:-1] / apart[1:]) / np.log(ratio[:-1])
    return np.where(np.isclose(ratio[:-1], ratio[1:], rtol=SAME_RATIO) & np.isfinite(rates), rates, np.nan)
