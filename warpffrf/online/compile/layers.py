"""Laws of contact pairs -> device tables (`warpffrf_kernels.layers.layer_laws`)."""

from __future__ import annotations

import numpy as np
from warpffrf_kernels.core.model import Model
from warpffrf_kernels.layers import layer_laws as device

from warpffrf.model.laws.layer import Curve
from warpffrf.online.compile.collector import Collector
from warpffrf.online.compile.points import PointRule
from warpffrf.online.compile.sampling_rules import layer_rule

LAYER_ITERATIONS = 2  # times as many Newton iterations: pressures of asperities span decades, a decade an iteration
FORMS = {"power": device.POWER, "exponential": device.EXPONENTIAL, "table": device.TABLE}


def fill_layers(collector: Collector, m: Model) -> None:
    """Curves of the layers whose yield is no constant, and the points where they count."""
    kinds, starts, counts = [], [], []
    numbers: list[list[float]] = []
    tables = [np.zeros((0, 3))]
    rules: list[tuple[PointRule, int] | None] = []
    for contact in collector.scene.contacts:
        curve = contact.law.curve
        kinds.append(int(device.CONSTANT) if curve is None else int(FORMS[curve.form]))
        numbers.append([0.0] * device.NUMBERS if curve is None else curve_numbers(curve))
        table = np.zeros((0, 3)) if curve is None else with_energy(curve.table)
        starts.append(sum(map(len, tables)))
        counts.append(len(table))
        tables.append(table)
        around, along = collector.settings.theta_points, collector.settings.z_points
        rules.append(None if curve is None else (layer_rule(contact, around, along), contact.a.surface.grid.rows))
        end = getattr(contact.law, "end", None)
        if end is not None:
            collector.notes.append(
                f"contact {contact.name!r}: the pressure of its {contact.law.kind} ends at {end:.3g} m"
            )
    collector.fill(
        m.layers, count=sum(kind != int(device.CONSTANT) for kind in kinds), kind=kinds, number=numbers,
        table_start=starts, table_count=counts, table=np.concatenate(tables),
    )  # fmt: skip
    _fill_points(collector, m, rules)


def _fill_points(collector: Collector, m: Model, rules: list[tuple[PointRule, int] | None]) -> None:
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
        m.layers, point_start=starts, point_count=counts, row_start=row_starts,
        **{name: np.concatenate([np.zeros(0), *parts]) for name, parts in columns.items()},
    )  # fmt: skip


def curve_numbers(curve: Curve) -> list[float]:
    """Columns of `layer_number` of a curve (`warpffrf.model.laws.Curve`)."""
    found = [0.0] * device.NUMBERS
    if curve.form == "power":
        stiffness, exponent, shift = curve.numbers
        found[:4] = [stiffness, exponent, shift, shift**exponent]
    elif curve.form == "exponential":
        pressure, length, end = curve.numbers
        found[:4] = [pressure, length, float(np.exp(-end / length)), end]
    found[int(device.CHI)] = curve.damping
    return found


def with_energy(table: np.ndarray) -> np.ndarray:
    """Depth, pressure (n, 2) and the energy up to there, of straight pieces: (n, 3)."""
    if not len(table):
        return np.zeros((0, 3))
    pieces = 0.5 * (table[1:, 1] + table[:-1, 1]) * np.diff(table[:, 0])
    return np.column_stack([table, np.concatenate([[0.0], np.cumsum(pieces)])])
