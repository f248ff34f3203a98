"""Laws of contact pairs -> device tables (`warpffrf_kernels.layer_laws`)."""

from __future__ import annotations

from typing import Any

import numpy as np
from warpffrf_kernels import layer_laws as device

LAYER_ITERATIONS = 2  # times as many Newton iterations: pressures of asperities span decades, a decade an iteration
FORMS = {"power": device.POWER, "exponential": device.EXPONENTIAL, "table": device.TABLE}


def fill_layers(compiler: Any, m: Any) -> None:
    """Curves of the layers whose yield is no constant, and the areas of the points where they count; after the grids
    and quadratures of the pairs."""
    kinds, starts, counts, area_starts = [], [], [], []
    numbers: list[list[float]] = []
    tables, areas = [np.zeros((0, 3))], [np.zeros(0)]
    for contact in compiler.scene.contacts:
        curve = contact.law.curve
        kinds.append(int(device.CONSTANT) if curve is None else int(FORMS[curve.form]))
        numbers.append([0.0] * device.NUMBERS if curve is None else curve_numbers(curve))
        table = np.zeros((0, 3)) if curve is None else with_energy(curve.table)
        starts.append(sum(map(len, tables)))
        counts.append(len(table))
        tables.append(table)
        area = np.zeros(0) if curve is None else point_areas(contact.a.surface, compiler.settings.z_points)
        area_starts.append(sum(map(len, areas)))
        areas.append(area)
        end = getattr(contact.law, "end", None)
        if end is not None:
            compiler.notes.append(
                f"contact {contact.name!r}: the pressure of its {contact.law.kind} ends at {end:.3g} m"
            )
    m.layer_count = sum(kind != int(device.CONSTANT) for kind in kinds)
    for name, values in (
        ("kind", kinds),
        ("table_start", starts),
        ("table_count", counts),
        ("area_start", area_starts),
    ):
        setattr(m, f"layer_{name}", compiler.array(values, int))
    m.layer_number = compiler.array(numbers, shape=(-1, device.NUMBERS))
    m.layer_table = compiler.array(np.concatenate(tables), shape=(-1, 3))
    m.layer_area = compiler.array(np.concatenate(areas))


def curve_numbers(curve: Any) -> list[float]:
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


def point_areas(surface: Any, z_points: int) -> np.ndarray:
    """Area [m^2] of the Gauss points of a column of cells, row by row, all points around taken together."""
    grid, shape = surface.grid, surface.shape
    x, weight = np.polynomial.legendre.leggauss(z_points)
    step = np.diff(grid.z)
    z = grid.z[:-1, None] + step[:, None] * 0.5 * (x + 1.0)
    measure = shape.radius_at(z) * np.sqrt(1.0 + shape.slope_at(z) ** 2)
    return (grid.pitch * 0.5 * weight * step[:, None] * measure).ravel()
