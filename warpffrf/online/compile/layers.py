"""Laws of contact pairs -> device tables (`warpffrf_kernels.layers.layer_laws`)."""

from __future__ import annotations

import numpy as np

from warpffrf.model.errors import InputError
from warpffrf.model.laws.curves import Curve
from warpffrf.online.compile.collector import Collector
from warpffrf.online.compile.points import PointRule
from warpffrf.online.compile.sampling_rules import rule_of
from warpffrf_kernels.core.model import CONSTANT
from warpffrf_kernels.layers import layer_laws as device

LAYER_ITERATIONS = 2  # factor of the Newton iterations: pressures of asperities span decades, one decade per iteration


def fill_layers(collector: Collector) -> None:
    """Curves of the layers with variable compliance, and the points where they are evaluated."""
    kinds, starts, counts = [], [], []
    numbers: list[list[float]] = []
    tables = [np.zeros((0, 3))]
    rules: list[tuple[PointRule, int] | None] = []
    for contact in collector.scene.finite_sliding:
        curve = contact.law.bent
        if curve is not None and curve.form not in device.FORMS:
            raise InputError(
                f"contact {contact.name!r}: the curve of the law {contact.law.kind} has the form {curve.form!r}; the "
                f"kernels evaluate {', '.join(device.FORMS)}; return laws.curves.Table(depths, pressures)"
            )
        kinds.append(int(CONSTANT) if curve is None else int(device.FORMS[curve.form]))
        numbers.append([0.0] * device.NUMBERS if curve is None else _numbers(curve, contact.law.chi))
        table = np.zeros((0, 3)) if curve is None else curve.table
        starts.append(sum(map(len, tables)))
        counts.append(len(table))
        tables.append(table)
        around, along = collector.settings.theta_points, collector.settings.z_points
        plan = collector.patches.get(len(kinds) - 1)
        if curve is None:
            rules.append(None)
        elif plan is not None:
            rules.append((_middles(len(plan.z)), len(plan.z)))
        else:
            rules.append((rule_of(contact, around, along), contact.a.surface.grid.rows))
        if contact.law.remark:
            collector.notes.append(f"contact {contact.name!r}: {contact.law.remark}")
    collector.fill(
        collector.elements.layers, count=sum(kind != int(CONSTANT) for kind in kinds), kind=kinds,
        number=numbers, table_start=starts, table_count=counts, table=np.concatenate(tables),
    )  # fmt: skip
    _fill_points(collector, rules)


def _middles(rows: int) -> PointRule:
    """The centres of the cells of a strip of a patch, as points of it; their areas are those of the cells."""
    k = np.arange(rows)
    below = np.minimum(k, rows - 2)
    return PointRule(np.zeros(rows), below, (k - below).astype(float), np.zeros(rows))


def _fill_points(collector: Collector, rules: list[tuple[PointRule, int] | None]) -> None:
    """Tables of the points of each pair's layer, given with the rows of its grid; None: a pair without such a layer."""
    starts, counts, row_starts = [], [], []
    columns: dict[str, list[np.ndarray]] = {name: [] for name in ("x", "row", "zeta", "area", "row_at")}
    for given in rules:
        starts.append(sum(map(len, columns["x"])))
        row_starts.append(sum(map(len, columns["row_at"])))
        counts.append(0 if given is None else len(given[0].x))
        if given is not None:
            rule, rows = given
            row_at = np.searchsorted(rule.row, np.arange(rows))
            for name, value in zip(columns, (rule.x, rule.row, rule.zeta, rule.weight, row_at), strict=True):
                columns[name].append(value)
    collector.fill(
        collector.elements.layers, point_start=starts, point_count=counts, row_start=row_starts,
        **{name: np.concatenate([np.zeros(0), *parts]) for name, parts in columns.items()},
    )  # fmt: skip


def _numbers(curve: Curve, chi: float) -> list[float]:
    """Columns of `layer_number`: those of the form, then the damping."""
    found = [0.0] * device.NUMBERS
    found[: len(curve.numbers)] = curve.numbers
    found[int(device.CHI)] = chi
    return found
