r"""A shaft in an elastic bore with a film between them, and asperities in parallel: dense, by Newton's method.

In the bore's frame, with the displacement u = C M (p + a) of its surface, C its compliance (nodal displacement per
nodal force, including its support), M the Gram matrix, and the asperity pressure a at the nodes:

    h = c - e.n + sum_j psi_j u_j,      a_j = P(h_j),      F = -int (p + a) n dA      on the shaft,

p and the cavity volume D as in `grid`, with the viscosity mu(p); for rough walls with flow factors, k_i = phi_i(h) h^3/
(12 mu) in either direction and the flow U (h - l(h)). The linearisation at the nodes, dh = S^-1 (G dp - n de)
with G = C M and S = 1 - G diag(P'), P' <= 0, is a change of pressures p + a by dp + P' dh, which loads points between
nodes too. The unknowns are e (2,) and, for each column or node of a basis (`bases`), the pressure if it is full, else
its cavity volume; the set changes once per iteration (by the rule of `complementarity`), and no iteration may leave
less than `CLOSEST` of the smallest film.

The equilibrium is not solved from the steady equation, for which Newton's method does not converge from everywhere.
`settle` lets the shaft come to rest under its load, in Euler steps of growing size with the squeeze film; a failed
step is repeated with a smaller size.
"""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import Any

import numpy as np
import scipy.linalg as la
import scipy.sparse as sp

from references.films.bases import grid_nodes, strips
from references.films.complementarity import NO_VOID
from references.films.grid import FilmGrid
from references.films.rough_walls import RoughWalls
from warpffrf.model.errors import InputError
from warpffrf.model.laws.curves.curve import Curve
from warpffrf.model.oils import Oil
from warpffrf.model.reduced.body import ReducedBody

Array = np.ndarray
Sparse = Any
CLOSEST = 0.2  # of the smallest film: lower limit after one iteration
MOST_ITERATIONS = 60
FLOW, FORCE = 1e-8, 1e-8  # of the flow through a row and of the load
FIRST, GROWTH, SHRINK = 1e-4, 10.0, 0.1  # s; times the step before, times a failed one
THINNEST = 1e-4  # of the clearance: molecular thickness, below which no film exists
STILL = 1e-6  # of the clearance, moved in a step ten times as long as the previous one: the shaft is at rest
MOST_STEPS = 60


@dataclass(frozen=True)
class State:
    """place (2,) [m] of the shaft; pressure (unknowns,), asperity (nodes,) [Pa]; void [m] and full (voids,)."""

    place: Array
    pressure: Array
    asperity: Array
    void: Array
    full: Array


@dataclass(frozen=True)
class Settled:
    """State at rest; numbers of steps, repeated steps, and iterations."""

    state: State
    steps: int
    rejected: int
    iterations: int


def held_compliance(body: ReducedBody, surface: str, interface: str) -> Array:
    """C (nodes, nodes) [m/N] of a contact surface with the interface fixed: local modes, and the global modes q with
    the rigid motion that keeps the interface at rest."""
    found, at = body.contact_surfaces[surface], body.interfaces[interface]
    grid, sectors = found.grid, len(found.lags)
    size, number = found.lags.shape[1], np.arange(sectors)
    blocks = found.lags[np.mod(number[:, None] - number[None, :], sectors)]
    D = blocks.transpose(0, 2, 1, 3).reshape(sectors * size, sectors * size)
    theta = grid.theta_start + grid.pitch * np.arange(grid.columns)
    theta, z = (v.ravel() for v in np.meshgrid(theta, grid.z, indexing="ij"))
    normal = found.shape.normal(theta, z)
    arm = np.cross(found.shape.point(theta, z) - at.point, normal)
    shape = found.mode_normal - np.hstack([normal, arm]) @ at.modes.T
    return D + (shape / (2.0 * np.pi * body.frequencies) ** 2) @ shape.T


@dataclass
class ElasticJournal:
    """A shaft of `radius` - `clearance` [m] rotating with `speed` [rad/s] in a bore with nodes at columns theta [rad]
    by rows z [m], with the `compliance` (nodes, nodes) [m/N] of nodal displacements per nodal force. `held`: columns
    (columns,) bool at pressure zero, as the ends are; asperities: a curve of pressure by the depth -h. powers: of
    `bases.strips`, None for all nodes. walls: flow factors, None for smooth ones."""

    radius: float
    clearance: float
    oil: Oil
    speed: float
    theta: Array
    z: Array
    compliance: Array
    held: Array
    asperities: Curve | None = None
    powers: tuple[int, ...] | None = None
    walls: RoughWalls | None = None
    grid: FilmGrid = field(init=False)

    def __post_init__(self) -> None:
        turn = 2.0 * np.pi * self.radius
        self.grid = g = FilmGrid(self.radius * (self.theta - self.theta[0]), self.z, period=turn)
        free = ~np.asarray(self.held, dtype=bool)
        if self.powers is None:
            inner = np.repeat(free[:, None], g.rows, axis=1)
            inner[:, [0, -1]] = False
            self.basis = grid_nodes(g, inner.ravel())
        else:
            self.basis = strips(g, free, self.powers)
        b = self.basis
        self.normal = self._directions(b.at[:, 0])
        self.normal_at_nodes = self._directions(np.repeat(g.x, g.rows))
        self.G = self.compliance @ (g.value.T @ sp.diags(g.weights) @ g.value).toarray()
        self.G_film = self.G @ b.to_nodes
        self.carried_with = 0.5 * self.speed * self.radius
        self.outflow = b.outflow(self.carried_with)
        self.of_film = -(b.value.T @ (b.weights[:, None] * self.normal))
        self.of_asperities = -(g.value.T @ (g.weights[:, None] * self._directions(g.at[:, 0])))
        self.flow = max(abs(self.carried_with), 1e-6) * self.clearance * float(np.diff(self.z).mean())

    def _directions(self, x: Array) -> Array:
        angle = x / self.radius + self.theta[0]
        return np.stack([np.cos(angle), np.sin(angle)], axis=1)

    def start(self, place: Array) -> State:
        """A full film without pressure."""
        b = self.basis
        voids = len(b.beside)
        return State(
            np.array(place, dtype=float), np.zeros(b.unknowns), np.zeros(self.grid.count), np.zeros(voids),
            np.ones(voids, dtype=bool),
        )  # fmt: skip

    def gap(self, state: State) -> Array:
        """h (points,) [m]."""
        u = self.G_film @ state.pressure + self.G @ state.asperity
        return self.clearance - self.normal @ state.place + self.basis.between @ u

    def gap_at_nodes(self, state: State) -> Array:
        """h (nodes,) [m]."""
        u = self.G_film @ state.pressure + self.G @ state.asperity
        return self.clearance - self.normal_at_nodes @ state.place + u

    def force(self, state: State) -> tuple[Array, Array]:
        """On the shaft (2,) [N], by the film and by the asperities."""
        return self.of_film.T @ state.pressure, self.of_asperities.T @ state.asperity

    def settle(self, place: Array, load: Array) -> Settled:
        """The shaft at rest under `load` (2,) [N], from `place`. Raises `InputError` if it is not found, or
        without a film."""
        state, step, rejected, iterations = self.start(place), FIRST, 0, 0
        for number in range(1, MOST_STEPS + 1):
            found, count = self.stepped(state, np.asarray(load, dtype=float), step)
            iterations += count
            if found is None:
                rejected, step = rejected + 1, SHRINK * step
                continue
            moved, state = np.abs(found.place - state.place).max(), found
            if self.gap(state).min() < THINNEST * self.clearance:
                raise InputError("elastic journal: no rest, the film is squeezed out; give it speed, or asperities")
            if number > 1 and moved <= STILL * self.clearance:
                return Settled(state, number, rejected, iterations)
            step *= GROWTH
        raise InputError(f"elastic journal: no rest in {MOST_STEPS} steps")

    def stepped(
        self, before: State, load: Array, step: float, *, earlier: tuple[State, float] | None = None
    ) -> tuple[State | None, int]:  # fmt: skip
        """A step under `load`, and iterations; None if it fails. By Euler's rule, or BDF2 with the state and the
        step `earlier`."""
        b, now, settled = self.basis, before, False
        a0, h_past, D_past = 1.0 / step, -self.gap(before) / step, -before.void / step
        if earlier is not None:
            r = step / earlier[1]
            a0, a1, a2 = (1.0 + 2.0 * r) / ((1.0 + r) * step), -(1.0 + r) / step, r**2 / ((1.0 + r) * step)
            h_past, D_past = a1 * self.gap(before) + a2 * self.gap(earlier[0]), a1 * before.void + a2 * earlier[0].void
        T = (self.outflow + sp.diags(a0 * b.area)).toarray()
        squeezed = b.value.T @ (b.weights * h_past)
        squeezed[b.beside] -= b.area * D_past
        for iteration in range(1, MOST_ITERATIONS + 1):
            h = self.gap(now)
            if h.min() <= 0.0:
                return None, iteration
            R, A, B = self._flows(now.pressure, h, a0)
            R = R + squeezed + b.value.T @ (b.weights * a0 * h)
            R[b.beside] -= T @ now.void
            F = sum(self.force(now)) + load
            h_nodes = self.gap_at_nodes(now)
            rest_a = (0.0 if self.asperities is None else self.asperities.pressure(-h_nodes)) - now.asperity
            if settled and self._balanced(now, R, F, load, rest_a):
                return now, iteration
            change = self._newton(now, R, A, B, T, F, h_nodes, rest_a)
            if change is None:
                return None, iteration
            now, settled = self._taken(now, change, h)
        return None, MOST_ITERATIONS

    def _balanced(self, now: State, R: Array, F: Array, load: Array, rest_a: Array) -> bool:
        inside = np.all(now.pressure[self.basis.beside] >= 0.0) and np.all(now.void >= -NO_VOID * self.clearance)
        return bool(
            inside
            and np.abs(R).max() <= FLOW * self.flow
            and np.abs(F).max() <= FORCE * np.abs(load).max()
            and np.abs(rest_a).max() <= FORCE * max(now.pressure.max(), 1e5)
        )

    def _flows(self, p: Array, h: Array, a0: float) -> tuple[Array, Array, Sparse]:
        """Flow by pressure and speed, in each equation, its derivative by pressures at a given gap, and that by the
        gap at the points, squeezing included."""
        b, w = self.basis, self.basis.weights
        at_points = b.value @ p
        mu, mu_slope = self.oil.viscosity_at(at_points), self.oil.viscosity_slope(at_points)
        by_x, by_z = b.slope_x @ p, b.slope_z @ p
        walls = self.walls or RoughWalls.smooth()
        (x, x_slope), (z, z_slope), (lag, lag_slope) = walls.around(h), walls.along(h), walls.lag(h)
        k, wide = h**3 / (12.0 * mu), h**2 / (4.0 * mu)
        A = b.slope_x.T @ sp.diags(w * k * x) @ b.slope_x + b.slope_z.T @ sp.diags(w * k * z) @ b.slope_z
        R = A @ p - b.slope_x.T @ (w * (h - lag) * self.carried_with)
        if np.any(mu_slope):
            thicker = -w * k * mu_slope / mu
            A = A + (b.slope_x.T @ sp.diags(thicker * x * by_x) + b.slope_z.T @ sp.diags(thicker * z * by_z)) @ b.value
        B = (
            b.slope_x.T @ sp.diags(w * ((wide * x + k * x_slope) * by_x - (1.0 - lag_slope) * self.carried_with))
            + b.slope_z.T @ sp.diags(w * (wide * z + k * z_slope) * by_z)
            + b.value.T @ sp.diags(a0 * w)
        )
        return R, A.toarray(), B.tocsr()

    def _newton(
        self, now: State, R: Array, A: Array, B: Sparse, T: Array, F: Array, h_nodes: Array, rest_a: Array
    ) -> tuple[Array, Array, Array, Array] | None:  # fmt: skip
        """Changes of position, pressure, asperity pressure, cavity volume."""
        b, n, grid_nodes_ = self.basis, self.basis.unknowns, self.grid.count
        steep = np.zeros(grid_nodes_) if self.asperities is None else -self.asperities.slope(-h_nodes)
        at_grid_nodes = np.hstack([self.G_film, (self.G @ rest_a)[:, None], -self.normal_at_nodes])
        if np.any(steep):
            at_grid_nodes = la.solve(np.eye(grid_nodes_) - self.G * steep[None, :], at_grid_nodes)
        by_p, by_rest, by_e = at_grid_nodes[:, :n], at_grid_nodes[:, n], at_grid_nodes[:, n + 1 :]
        moved = (B @ b.between).toarray()  # by nodal displacements
        J = A + moved @ (self.G_film + self.G @ (steep[:, None] * by_p) if np.any(steep) else self.G_film)
        of_rest = moved @ (self.G @ (rest_a + steep * by_rest))
        of_place = -(B @ self.normal) + moved @ (self.G @ (steep[:, None] * by_e))
        void = ~now.full
        on = np.ones(n, dtype=bool)
        on[b.beside[void]] = False
        gone_p, gone_D = np.where(on, 0.0, -now.pressure), np.where(void, 0.0, -now.void)
        voids = np.zeros((n, int(np.count_nonzero(void))))
        voids[b.beside] = -T[:, void]
        matrix = np.hstack([J[:, on], voids])
        size = np.abs(matrix).max(axis=0)
        if not np.all(np.isfinite(size)) or np.any(size == 0.0):
            return None
        fixed = R + of_rest + J @ gone_p
        fixed[b.beside] -= T @ gone_D
        lu = la.lu_factor(matrix / size)
        x0 = -la.lu_solve(lu, fixed) / size
        xe = -la.lu_solve(lu, of_place) / size[:, None]
        count = int(np.count_nonzero(on))
        p0, pe, dD_e = gone_p.copy(), np.zeros((n, 2)), np.zeros((len(void), 2))
        dD_0 = gone_D.copy()
        p0[on], pe[on], dD_0[void], dD_e[void] = x0[:count], xe[:count], x0[count:], xe[count:]
        a_0 = rest_a + steep * (by_p @ p0 + by_rest)
        a_e = steep[:, None] * (by_p @ pe + by_e)
        stiff = self.of_film.T @ pe + self.of_asperities.T @ a_e
        de = la.solve(stiff, -(F + self.of_film.T @ p0 + self.of_asperities.T @ a_0))
        return de, p0 + pe @ de, a_0 + a_e @ de, dD_0 + dD_e @ de

    def _taken(self, now: State, change: tuple[Array, Array, Array, Array], h: Array) -> tuple[State, bool]:
        """The result of the change, and whether it was applied in full and left the set unchanged."""
        de, dp, da, dD = change
        whole = State(now.place + de, now.pressure + dp, now.asperity + da, now.void + dD, now.full)
        part, ahead = 1.0, self.gap(whole)
        if ahead.min() < CLOSEST * h.min():
            part = (1.0 - CLOSEST) * h.min() / float((h - ahead).max())
        full = np.where(now.full, whole.pressure[self.basis.beside] > 0.0, whole.void < -NO_VOID * self.clearance)
        same = bool(np.array_equal(full, now.full))
        found = State(
            now.place + part * de, now.pressure + part * dp, now.asperity + part * da, now.void + part * dD, full
        )
        return found, same and part == 1.0
