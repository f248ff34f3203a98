r"""Saved results of a contact pair at a step, in the format of the separated solver's record.

Pressures are on the nodes of the first grid, loads on those of the second, both in a window of columns with all
nonzero ones. The multipliers of law "hats" are nodal coefficients of the pressure. Those of law "nodes" are forces f
of FE nodes; the equivalent pressure is

    p_j = sum_n psi_j(x_n) f_n / int psi_j dA,

not negative and of the same resultant, `sum_j p_j int psi_j dA = sum_n f_n`, because the shape functions sum to one.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np

from references.monolithic.line_of_centres.pair import PairState
from references.monolithic.line_of_centres.sampling import NodeTests

BESIDE = 2  # empty columns at both ends of a window


@dataclass(frozen=True, eq=False)
class Window:
    """Values (columns, rows) of grid nodes starting at column `first`; `middle`: column of the line of centres."""

    first: int
    middle: float
    values: np.ndarray


@dataclass(frozen=True, eq=False)
class ContactRow:
    """A pair at a step: generalised force (12,) on its two bodies (force in world axes, torque in body axes about the
    centre of mass), approach [m], pressure [Pa] and load on the second surface [N]."""

    force: np.ndarray
    approach: float
    pressure: Window
    second: Window


def contact_row(pair: PairState, s: np.ndarray) -> ContactRow:
    """The record of `pair` with multipliers s (n,)."""
    data, frame, active = pair.data, pair.frame, np.flatnonzero(s > 0.0)
    approach = data.a.shape.radius + data.b.shape.radius - 0.5 * float(frame.d[0] + frame.d[-1])
    on_a, on_b = (0.5 * float(x[0] + x[-1]) for x in (frame.x_a, frame.x_b))
    if not len(active):
        empty = [Window(int(round(x)), x, np.zeros((1, side.grid.rows))) for x, side in zip(
            (on_a, on_b), (data.a, data.b), strict=True
        )]  # fmt: skip
        return ContactRow(np.zeros(12), approach, *empty)
    column, row, value = _nodes_of(pair, active, s[active], on_a)
    first = int(column.min())
    pressure = np.zeros((int(column.max()) - first + 1, data.a.grid.rows))
    np.add.at(pressure, (column - first, row), value)
    load = (s[active] @ pair.loads(active)).reshape(-1, data.b.grid.rows)
    loaded = np.flatnonzero(load.any(axis=1))
    begin, end = (int(loaded[0]), int(loaded[-1]) + 1) if len(loaded) else (0, 1)
    return ContactRow(
        pair.force(active, s[active])[:12], approach, Window(first, on_a, pressure),
        Window(pair.first_other + begin, on_b, load[begin:end]),
    )  # fmt: skip


def _nodes_of(
    pair: PairState, active: np.ndarray, s: np.ndarray, middle: float
) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Columns (on the branch of `middle`), rows and pressures of the grid nodes for multipliers s of `active`."""
    tests, grid = pair.data.tests, pair.data.a.grid
    number = pair.number[active]
    if not isinstance(tests, NodeTests):
        return np.rint(pair.points.column[active]).astype(int), number % grid.rows, s
    loads = np.asarray(tests.grid_nodes[number].T @ s).ravel()
    grid_nodes = np.flatnonzero(loads)
    column, row = grid_nodes // grid.rows, grid_nodes % grid.rows
    around = np.full(grid.columns, grid.pitch)
    if grid.periodic:
        column = column - grid.columns * np.floor((column - middle) / grid.columns + 0.5).astype(int)
    else:
        around[[0, -1]] *= 0.5
    area = around[column % grid.columns] * grid.gram_z(pair.data.a.shape).sum(axis=1)[row]
    return column, row, loads[grid_nodes] / area


def joined(windows: list[Window], rows: int) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """First columns (T,), columns of the line of centres (T,) and values (T, columns, rows) of all steps, in windows of
    equal width."""
    width = max((len(w.values) for w in windows), default=1) + 2 * BESIDE
    first = np.zeros(len(windows), dtype=int)
    values = np.zeros((len(windows), width, rows))
    for i, window in enumerate(windows):
        before = (width - len(window.values)) // 2
        first[i] = window.first - before
        values[i, before : before + len(window.values)] = window.values
    return first, np.array([w.middle for w in windows]), values


def on_body(force: np.ndarray, A: np.ndarray, center: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Force (T, 3) and torque (T, 3) about the user origin, world axes, of `force` (T, 6) as in `ContactRow`; A (T, 3,
    3) and `center` (3,) of the body."""
    f, about_center = force[:, :3], np.einsum("tij,tj->ti", A, force[:, 3:])
    return f.copy(), about_center + np.cross(A @ center, f)


def contact_arrays(rows: list[ContactRow], bodies: Any, A: Any, grids: Any) -> dict[str, np.ndarray]:
    """Fields of `history.ContactForces` that a pair's rows hold; bodies, their A (T, 3, 3) and grids: first, second (of
    a rigid one None)."""
    forces = np.array([r.force for r in rows]).reshape(-1, 12)
    force, torque = on_body(forces[:, :6], A[0], bodies[0].center_of_mass)
    center_second = getattr(bodies[1], "center_of_mass", np.zeros(3))  # for the ground its origin
    force_second, torque_second = on_body(forces[:, 6:], A[1], center_second)
    first, center, pressure = joined([r.pressure for r in rows], grids[0].rows)
    first_second, load = np.zeros(len(rows), dtype=int), np.zeros((len(rows), 0, 0))
    if grids[1] is not None:
        first_second, _, load = joined([r.second for r in rows], grids[1].rows)
    return {
        "force": force, "torque": torque, "force_second": force_second, "torque_second": torque_second,
        "first_column": first, "center_column": center, "pressure": pressure, "first_column_second": first_second,
        "load_second": load, "approach": np.array([r.approach for r in rows]),
    }  # fmt: skip
