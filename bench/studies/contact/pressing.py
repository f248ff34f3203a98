r"""A tread pressed against its mirror image, with the law of a layer met in four ways; none of it uses the engine.

The nodes of both lie opposite, and the gap at the angle t from the line of centres is `g_0 = 2 R (1 - cos t) - delta`,
delta the approach. With D the compliance of the nodes of one roller, global modes included, u = 2 D f opens the gap
under the forces f of the nodes. Between the rollers lies a layer p = k d. Its law is met in four ways, all of them
minima of convex energies, on the same displacements u:

    nodes    "at nodes":  f = k a <-(g_0 + u)>  at the nodes, a their areas
    nodes     "full":  p = sum s_j psi_j, f = M s, 0 <= s, 0 <= w + 2 M D M s + M s/k, w the weak gaps of g_0
    cells    as nodes, with functions that are constant in a cell around each node instead: f = B s, B_ij = int psi_i dA
             over the cell j
    points   f_i = int psi_i k <-(g_0 + sum_j psi_j u_j)> dA by Gauss points: the law itself, on bodies of that mesh
"""

from __future__ import annotations

from collections.abc import Callable

import numpy as np

from studies.contact.evaluations import POINTS
from studies.speed.step_time import RADIUS
from warpffrf.model.reduced.body import ReducedBody
from warpffrf.model.reduced.stress_field import von_mises

WAYS = ("nodes", "hats", "cells", "points")
SETTLED = 1e-10  # of the force: the secant over the approach
FIRST = 30e-6, 45e-6  # m: approaches from which the secant starts
ROUNDS = 60  # of an active set; a handful in practice
GAUSS = 6, 2  # points around and along a cell: "full" has 3 x 2, which miss the corner where pressure begins


class Pressing:
    """A tread against its mirror image; see the module. `columns` of the grid about its middle are looked at."""

    def __init__(self, body: ReducedBody, columns: int) -> None:
        surface = body.contact_surfaces["tread"]
        grid = surface.grid
        self.body, self.grid, self.gram_z = body, grid, np.asarray(surface.gram_z)
        self.middle = grid.columns // 2
        half = min(columns // 2, self.middle)
        self.columns = np.arange(self.middle - half, self.middle + half + 1)
        nodes = (self.columns[:, None] * grid.rows + np.arange(grid.rows)).ravel()
        self.phi = surface.mode_normal[nodes] / (2.0 * np.pi * np.asarray(body.frequencies))
        self.D = 2.0 * (surface.compliance(self.columns) + self.phi @ self.phi.T)
        n = len(self.columns)
        around = np.diag(np.full(n, 2.0 / 3.0)) + np.diag(np.full(n - 1, 1.0 / 6.0), 1)
        self.M = grid.pitch * np.kron(around + np.triu(around, 1).T, self.gram_z)
        self.area = np.tile(grid.pitch * self.gram_z.sum(axis=1), n)
        around = in_cells(np.ones(n + 1))[1:-1, 1:-1]  # the grid goes on beyond the columns
        self.in_cells = self.grid.pitch * np.kron(around, RADIUS * in_cells(np.diff(grid.z)))
        self.angle = (self.columns - self.middle) * grid.pitch
        self._sample()

    def _sample(self) -> None:
        """Values (points, nodes) of the nodes at the Gauss points, their areas and angles."""
        (x, wx), (z, wz) = ((0.5 * (p + 1.0), 0.5 * w) for p, w in map(np.polynomial.legendre.leggauss, GAUSS))
        n, rows = len(self.columns), self.grid.rows
        grid_node_x = np.zeros((n - 1, len(x), n))
        grid_node_z = np.zeros((rows - 1, len(z), rows))
        for j in range(n - 1):
            grid_node_x[j, :, j], grid_node_x[j, :, j + 1] = 1.0 - x, x
        for k in range(rows - 1):
            grid_node_z[k, :, k], grid_node_z[k, :, k + 1] = 1.0 - z, z
        self.psi = np.kron(grid_node_x.reshape(-1, n), grid_node_z.reshape(-1, rows))
        along = (np.diff(self.grid.z)[:, None] * wz).ravel() * RADIUS * self.grid.pitch
        self.dA = np.kron(np.tile(wx, n - 1), along)
        self.at = np.repeat(((np.arange(n - 1)[:, None] + x).ravel() - (n - 1) // 2) * self.grid.pitch, len(along))

    def norm(self, p: np.ndarray) -> float:
        """Root of the sum over columns of p.M_z p of means (nodes,)."""
        line = p.reshape(-1, self.grid.rows)
        return float(np.sqrt(np.einsum("jk,kl,jl->", line, self.gram_z, line)))

    def means(self, forces: np.ndarray, angle: np.ndarray) -> np.ndarray:
        """Pressures (nodes,) meaned over the nodes, of `forces` (n, rows) at the columns' angles (n,)."""
        place = (angle - self.angle[0]) / self.grid.pitch
        column = np.floor(place + 1e-9).astype(int)
        out = np.zeros((len(self.columns), self.grid.rows))
        for step, part in ((0, 1.0 - (place - column)), (1, place - column)):
            inside = (column + step >= 0) & (column + step < len(out))
            np.add.at(out, (column + step)[inside], forces[inside] * part[inside, None])
        return out.ravel() / self.area

    def stress(self, forces: np.ndarray) -> np.ndarray:
        """Von Mises stress [Pa] at the points of the body under inward hat `forces` (nodes,)."""
        load = np.zeros((self.grid.columns, self.grid.rows))
        load[self.columns] = -forces.reshape(-1, self.grid.rows)
        q = self.phi.T @ load[self.columns].ravel() / (2.0 * np.pi * np.asarray(self.body.frequencies))
        return von_mises(self.body.stress[POINTS].evaluate(q, {"tread": load}))

    def forces(self, way: str, k: float, center: float, load: float) -> np.ndarray:
        """Forces (nodes,) of the nodes under the total force `load` [N], line of centres at the angle `center`; k
        [Pa/m] of the layer."""

        return carrying(lambda delta: getattr(self, f"by_{way}")(k, center, delta), load, SETTLED, way)

    def gap(self, angle: np.ndarray, center: float, delta: float) -> np.ndarray:
        """g_0 [m]."""
        return 2.0 * RADIUS * (1.0 - np.cos(angle - center)) - delta

    def by_nodes(self, k: float, center: float, delta: float) -> np.ndarray:
        """Forces (nodes,) at the approach `delta` [m] with the law at the nodes."""
        gap = np.repeat(self.gap(self.angle, center, delta), self.grid.rows)
        return active_set(self.D + np.diag(1.0 / (k * self.area)), gap)

    def by_hats(self, k: float, center: float, delta: float) -> np.ndarray:
        """Forces (nodes,) at the approach `delta` [m] of pressures in nodes."""
        weak = self.psi.T @ (self.dA * self.gap(self.at, center, delta))
        return self.M @ active_set(self.M @ self.D @ self.M + self.M / k, weak)

    def by_cells(self, k: float, center: float, delta: float) -> np.ndarray:
        """Forces (nodes,) at the approach `delta` [m] of pressures that are constant in cells around the nodes."""
        x, w = np.polynomial.legendre.leggauss(GAUSS[0])
        angle = self.angle[:, None] + 0.5 * self.grid.pitch * x
        weak = np.repeat(self.gap(angle, center, delta) @ (0.5 * w), self.grid.rows) * self.area
        B = self.in_cells
        return B @ active_set(B.T @ self.D @ B + np.diag(self.area) / k, weak)

    def _pressed(self, k: float, on: np.ndarray, gap: np.ndarray) -> np.ndarray:
        """f = -k (int_on psi g_0 + M_on u), u = D f, for a given set of pressed points."""
        psi = self.psi[on]
        nodes = np.flatnonzero(psi.any(axis=0))
        psi, dA = psi[:, nodes], self.dA[on]
        held = k * (psi.T * dA) @ psi
        f = np.zeros(len(self.area))
        f[nodes] = np.linalg.solve(
            np.eye(len(nodes)) + held @ self.D[np.ix_(nodes, nodes)], -k * (psi.T @ (dA * gap[on]))
        )
        return f

    def by_points(self, k: float, center: float, delta: float) -> np.ndarray:
        """Forces (nodes,) at the approach `delta` [m] with the law at Gauss points."""
        gap = self.gap(self.at, center, delta)
        on = gap + self.psi @ (self.D @ self.by_nodes(k, center, delta)) < 0.0
        for _ in range(ROUNDS):
            f = self._pressed(k, on, gap)
            pressed = gap + self.psi @ (self.D @ f) < 0.0
            if np.array_equal(pressed, on):
                return f
            on = pressed
        raise RuntimeError("points: the set of pressed points does not settle")


def in_cells(steps: np.ndarray) -> np.ndarray:
    """Integrals of nodes (lines) over the cells around their nodes (columns), half way to the next: a half cell of step
    h holds 3/8 h of its own node's hat and 1/8 h of the next one's. Cells at both ends are halves."""
    n = len(steps) + 1
    out = np.zeros((n, n))
    j = np.arange(n - 1)
    for a in (0, 1):
        for b in (0, 1):
            out[j + a, j + b] += (3.0 if a == b else 1.0) / 8.0 * steps
    return out


def active_set(A: np.ndarray, b: np.ndarray) -> np.ndarray:
    """x >= 0 with A x + b >= 0 and x (A x + b) = 0, A symmetric positive definite, by the primal-dual active set."""
    active = b < 0.0
    for _ in range(ROUNDS):
        x, inside = np.zeros(len(b)), np.flatnonzero(active)
        x[inside] = np.linalg.solve(A[np.ix_(inside, inside)], -b[inside])
        chosen = np.where(active, x > 0.0, A @ x + b < 0.0)
        if np.array_equal(chosen, active):
            return x
        active = chosen
    raise RuntimeError("the active set does not settle")


def carrying(at: Callable[[float], np.ndarray], load: float, settled: float, way: str) -> np.ndarray:
    """Forces (nodes,) at(approach) whose sum is `load` [N] to the fraction `settled`: a secant over the approach.
    Raises `RuntimeError` where none is found; `way` is its name there."""
    low, high = FIRST
    f_low, found = float(at(low).sum()), at(high)
    for _ in range(ROUNDS):
        total = float(found.sum())
        if abs(total - load) < settled * load:
            return found
        low, high, f_low = high, high + (load - total) * (high - low) / (total - f_low), total
        found = at(high)
    raise RuntimeError(f"{way}: no approach carries {load:.4g} N")
