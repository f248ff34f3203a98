"""Wide pads and plates, on nodes between two impermeable rows: sliders, and plates with oscillating gap."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
import scipy.sparse as sp

from references.closed_forms.cavitation import PartingPlates
from references.films.complementarity import FilmState, solve
from references.films.grid import FilmGrid

Array = np.ndarray


@dataclass(frozen=True)
class Pad:
    """state; force [N/m]; inflows (2,) [m2/s] at the first node and at the last one."""

    state: FilmState
    force: float
    inflow: tuple[float, float]

    @property
    def void(self) -> Array:
        """D (nodes,) [m]."""
        return self.state.void.reshape(-1, 2)[:, 0]


def pad(
    gap: Callable[[Array], Array], x: Array, *, speed: float, mode: str, viscosity: float = 1.0,
    ends: tuple[float, float] = (0.0, 0.0),
) -> Pad:  # fmt: skip
    """A pad with the gap h(x) [m] between nodes x [m], one surface sliding with `speed`; pressures at both `ends`."""
    grid = FilmGrid(x, np.array([0.0, 1.0]))
    h = gap(grid.at[:, 0])
    A, T, carried = grid.diffusion(h**3 / (12.0 * viscosity)), grid.outflow(0.5 * speed), grid.carried(h, 0.5 * speed)
    held, given = np.zeros((len(x), 2), dtype=bool), np.zeros((len(x), 2))
    held[[0, -1]], given[0], given[-1] = True, ends[0], ends[1]
    state = solve(A, T, carried, held.ravel(), given.ravel(), mode=mode)
    rest = (A @ state.pressure - T @ state.void - carried).reshape(-1, 2).sum(axis=1)
    force = float(grid.weights @ (grid.value @ state.pressure))
    return Pad(state, force, (float(rest[0]), float(rest[-1])))


@dataclass(frozen=True)
class Plates:
    """times [s], half-widths of the cavity [m] and forces [N/m] after each step, and sweeps."""

    time: Array
    cavity: Array
    force: Array
    sweeps: Array


def plates(given: PartingPlates, cells: int, steps: int) -> Plates:
    """A period of the plates from half of it on, in steps by BDF2, on half of their width."""
    x = np.linspace(0.0, given.half_width, cells + 1)
    grid = FilmGrid(x, np.array([0.0, 1.0]))
    held, ambient = np.zeros((cells + 1, 2), dtype=bool), np.zeros((cells + 1, 2))
    held[-1], ambient[-1] = True, given.ambient
    dt, t, full = given.period / steps, 0.5 * given.period, None
    void = before = np.zeros(grid.count)
    rows = []
    for i in range(steps):
        a = np.array([1.5, -2.0, 0.5]) / dt if i else np.array([1.0, -1.0, 0.0]) / dt
        rate = a @ given.gap(np.array([t + dt, t, t - dt]))
        right = grid.area * (a[1] * void + a[2] * before - rate)
        A = grid.diffusion(np.full(len(grid.at), float(given.gap(t + dt)) ** 3 / (12.0 * given.viscosity)))
        state = solve(A, sp.diags(grid.area * a[0]).tocsr(), right, held.ravel(), ambient.ravel(), full=full)
        void, before, full, t = state.void, void, state.full, t + dt
        count = np.count_nonzero(void.reshape(-1, 2)[:, 0])
        rows.append((t, max(count - 0.5, 0.0) * x[1], 2.0 * grid.area @ state.pressure, state.sweeps))
    return Plates(*np.array(rows).T)


def square_plate(cells: int) -> float:
    """F h^3/(mu V) of a squeezed plate of 1 m by 1 m [m4]."""
    nodes = np.linspace(0.0, 1.0, cells + 1)
    grid = FilmGrid(nodes, nodes)
    held = np.zeros((cells + 1, cells + 1), dtype=bool)
    held[[0, -1]] = held[:, [0, -1]] = True
    A, right = grid.diffusion(np.full(len(grid.at), 1.0 / 12.0)), grid.integral(np.ones(len(grid.at)))
    return float(
        grid.area
        @ solve(A, grid.outflow(0.0), right, held.ravel(), np.zeros(grid.count), mode="full_sommerfeld").pressure
    )
