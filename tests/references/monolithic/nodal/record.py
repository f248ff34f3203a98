r"""Saved results of a pair with the law at nodes, on the nodes of the first grid, as saved by the separated solver.

A node's force f is distributed as `sum_n psi_j(x_n) f_n / int psi_j dA` (`line_of_centres.record`): pressures, and in
the same way both tractions, keep their resultants. Slip velocities are means over the area of the active nodes; a
grid node slips if more than half of that area does. The centre of the patch is the mean column of the forces, or
without any the column of the node with the smallest gap between the rigid shapes.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np

from references.monolithic.line_of_centres.record import ContactRow, Window
from references.monolithic.nodal.friction import SLIP
from references.monolithic.nodal.gap import leaning
from references.monolithic.nodal.pair import FOOT, FORCE, GAP, NodePairState
from references.monolithic.nodal.surface import NodeSide

FRICTION_FIELDS = ("traction_1", "traction_2", "slip_1", "slip_2", "state")
HALF = 0.5  # of the area under a grid node: above it the node is in slip


@dataclass(frozen=True, eq=False)
class FrictionRow:
    """Friction of a pair at a step, fields of `warpffrf.online.history.history.FrictionHistory`: windows of nodes, and
    power [W], creep (2,) [m/s], rolling velocity [m/s] and columns advanced."""

    windows: dict[str, Window]
    power: float
    creep: np.ndarray
    rolling: float
    advanced: float


def node_row(pair: NodePairState) -> tuple[ContactRow, FrictionRow | None]:
    """The record of `pair` at the end of an accepted step."""
    data, at = pair.data, pair.active
    a, center = data.a, _center(data.a, pair.force, pair.rigid_gap)
    facing = pair.over.faces if np.any(pair.over.faces) else slice(None)
    approach = -float(pair.rigid_gap[facing].min())
    wrench = pair.wrench()
    grid_nodes, columns = _columns(a, at, center)
    first = int(columns.min()) if len(columns) else int(round(center))
    width = int(columns.max()) - first + 1 if len(columns) else 1

    def window(values: np.ndarray) -> Window:
        out = np.zeros((width, a.grid.rows))
        np.add.at(out, (columns - first, grid_nodes % a.grid.rows), values[grid_nodes])
        return Window(first, center, out)

    area = _areas(a)
    loads = pair.loads
    spread = a.grid_nodes[at].T
    pressure = window(spread @ loads[:, 0] / area)
    row = ContactRow(wrench, approach, pressure, _second(pair))
    if not data.rough:
        return row, None
    share, tiny = a.share[at], np.finfo(float).tiny
    below = np.maximum(spread @ share, tiny)
    slipping = np.zeros(len(at))
    velocity = pair.slip / pair.sight.h
    if pair.traction is None:
        velocity = np.zeros_like(velocity)
    else:
        slipping = (pair.traction.state == SLIP).astype(float)
    state = np.where(spread @ share > 0.0, 1.0 + (spread @ (share * slipping) > HALF * below), 0.0)
    values = (
        *(spread @ loads[:, 1 + i] / area for i in range(2)),
        *(spread @ (share * velocity[:, i]) / below for i in range(2)), state,
    )  # fmt: skip
    windows = {name: window(value) for name, value in zip(FRICTION_FIELDS, values, strict=True)}
    if pair.traction is None:
        return row, FrictionRow(windows, 0.0, np.zeros(2), 0.0, 0.0)
    return row, FrictionRow(windows, pair.friction_lost / pair.sight.h, *_motion(pair, center))


def _motion(pair: NodePairState, center: float) -> tuple[np.ndarray, float, float]:
    """Creep (2,) of the surfaces as rigid bodies, mean velocity of both through the patch [m/s], and the displacement
    of the patch [columns], in the step."""
    a, before, h = pair.data.a, pair.sight.before, pair.sight.h
    beside = _near(a, a.x, center) - center
    at = int(np.argmin(np.abs(beside) + np.abs(a.z - _middle(a, pair.force)) / (a.grid.z[-1] - a.grid.z[0])))
    directions = a.tangent[:, at] @ pair.over.C.T
    stands = pair.over.foot[at] + leaning(a, pair.data.b, pair.over, np.array([at]))[0] * pair.own[0, at]
    creep = directions @ (stands - before[at, FOOT]) / h
    was = _center(a, before[:, FORCE], before[:, GAP])
    advanced = center - was
    if a.turn:
        advanced -= a.turn * np.floor(advanced / a.turn + 0.5)
    # material of the first surface moves against the columns by which the patch advances
    arc = a.grid.pitch * float(a.shape.radius_at(a.z[at])) * a.shape.side
    return creep, -advanced * arc / h - 0.5 * float(creep[0]), abs(advanced)


def _second(pair: NodePairState) -> Window:
    """Loads on the second grid [N]; zero for a rigid surface."""
    grid = pair.data.b.grid
    if grid is None or pair.over.cells is None:
        return Window(0, 0.0, np.zeros((0, 0)))
    load = pair.second_loads()[0].reshape(grid.columns, grid.rows)
    loaded = np.flatnonzero(load.any(axis=1))
    if not len(loaded):
        return Window(0, 0.0, np.zeros((1, grid.rows)))
    if not grid.periodic:
        return Window(int(loaded[0]), 0.0, load[loaded[0] : loaded[-1] + 1])
    gaps = np.diff(np.append(loaded, loaded[0] + grid.columns))  # the window begins behind the widest gap
    begin = int(loaded[(int(np.argmax(gaps)) + 1) % len(loaded)])
    count = grid.columns - int(gaps.max()) + 1
    return Window(begin, 0.0, load[np.mod(begin + np.arange(count), grid.columns)])


def _center(a: NodeSide, force: np.ndarray, gap: np.ndarray) -> float:
    nearest = float(a.x[int(np.argmax(force) if np.any(force) else np.argmin(gap))])
    total = float(force.sum())
    return nearest if total == 0.0 else float(force @ _near(a, a.x, nearest)) / total


def _middle(a: NodeSide, force: np.ndarray) -> float:
    return float(a.z.mean()) if not np.any(force) else float(force @ a.z) / float(force.sum())


def _near(a: NodeSide, x: np.ndarray, middle: float) -> np.ndarray:
    """Columns x on the branch of `middle`."""
    return x if not a.turn else x - a.turn * np.floor((x - middle) / a.turn + 0.5)


def _columns(a: NodeSide, at: np.ndarray, center: float) -> tuple[np.ndarray, np.ndarray]:
    """Grid nodes under the FE nodes `at`, and their columns on the branch of `center`."""
    grid_nodes = np.unique(a.grid_nodes[at].indices)
    column = grid_nodes // a.grid.rows
    if a.turn:
        column = column - a.grid.columns * np.floor((column - center) / a.grid.columns + 0.5).astype(int)
    return grid_nodes, column


def _areas(a: NodeSide) -> np.ndarray:
    """int psi_j dA (nodes,) [m2]."""
    around = np.full(a.grid.columns, a.grid.pitch)
    if not a.grid.periodic:
        around[[0, -1]] *= 0.5
    return np.outer(around, a.grid.gram_z(a.shape).sum(axis=1)).ravel()


def friction_arrays(rows: list[Any], joined: Any, grid_rows: int) -> dict[str, np.ndarray]:
    """Fields of `FrictionHistory` of the `FrictionRow`s of a pair with friction."""
    field = {name: joined([r.windows[name] for r in rows], grid_rows)[2] for name in FRICTION_FIELDS}
    return {
        "traction": np.stack([field["traction_1"], field["traction_2"]], axis=1),
        "slip_velocity": np.stack([field["slip_1"], field["slip_2"]], axis=1),
        "state": field["state"].astype(np.int8),
        "power": np.array([r.power for r in rows]),
        "creep_velocity": np.array([r.creep for r in rows]).reshape(-1, 2),
        "rolling_velocity": np.array([r.rolling for r in rows]),
        "cells_per_step": np.array([r.advanced for r in rows]),
    }
