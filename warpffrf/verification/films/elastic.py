r"""A shaft in an elastic bore with a film between them, and asperities beside it: dense, by Newton's method.

In the frame of the bore, with the displacement u = C M (p + a) of its surface, C its compliance (hat displacements per
hat force, with whatever holds it), M the hats' Gram matrix, and the asperity pressure a at the hats:

    h = c - e.n + sum_j psi_j u_j,      a_j = P(h_j),      F = -int (p + a) n dA      on the shaft,

p and the void D as in `grid`, with the viscosity mu(p). What Newton's method needs at the hats, dh = S^-1 (G dp - n de)
with G = C M and S = 1 - G diag(P'), P' <= 0, is a change of pressures p + a by dp + P' dh, which loads points between
hats too. Unknown at a free hat is p where it is full, else D, and e (2,); the set changes once an iteration
(`complementarity` has the rule), and none may leave less than `CLOSEST` of the smallest film.

Rest is not looked for in the steady equation, which Newton's method does not find from everywhere. So `settle` lets the
shaft come to rest under its load, in Euler steps of the squeezing film that grow; what fails is taken again with a
shorter one.
"""

from __future__ import annotations

from dataclasses import dataclass, field

import numpy as np
import scipy.linalg as la
import scipy.sparse as sp

from warpffrf.model.errors import InputError
from warpffrf.model.laws.curves.curve import Curve
from warpffrf.model.oils.oil import Oil
from warpffrf.model.reduced_body import ReducedBody
from warpffrf.verification.films.complementarity import NO_VOID
from warpffrf.verification.films.grid import FilmGrid

Array = np.ndarray
CLOSEST = 0.2  # of the smallest film: what one iteration may leave of it
MOST_ITERATIONS = 60
FLOW, FORCE = 1e-8, 1e-8  # of the flow through a row and of the load
FIRST, GROWTH, SHRINK = 1e-4, 10.0, 0.1  # s; times the step before, times one that failed
THINNEST = 1e-4  # of the clearance: molecules, which no film is made of
STILL = 1e-6  # of the clearance, moved in a step ten times as long as the one before: the shaft is at rest
MOST_STEPS = 60


@dataclass(frozen=True)
class Settled:
    """place (2,) [m]; pressure, asperity [Pa], void [m] (hats,); gap (points,) [m]; steps, those taken again, and
    iterations."""

    place: Array
    pressure: Array
    asperity: Array
    void: Array
    gap: Array
    steps: int
    rejected: int
    iterations: int


def held_compliance(body: ReducedBody, surface: str, interface: str) -> Array:
    """C (hats, hats) [m/N] of a contact surface with the interface held: local modes, and the global modes q with what
    rigid motion keeps the interface where it is."""
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
class _State:
    place: Array
    pressure: Array
    asperity: Array
    void: Array
    full: Array


@dataclass
class ElasticJournal:
    """A shaft of `radius` - `clearance` [m] turning with `speed` [rad/s] in a bore whose hats are columns theta [rad]
    by rows z [m], with the `compliance` (hats, hats) [m/N] of hat displacements per hat force. `held`: hats (columns,
    rows) at pressure zero beside the ends; asperities: a curve of pressure by the depth -h."""

    radius: float
    clearance: float
    oil: Oil
    speed: float
    theta: Array
    z: Array
    compliance: Array
    held: Array
    asperities: Curve | None = None
    grid: FilmGrid = field(init=False)

    def __post_init__(self) -> None:
        turn = 2.0 * np.pi * self.radius
        self.grid = g = FilmGrid(self.radius * (self.theta - self.theta[0]), self.z, period=turn)
        angle = g.at[:, 0] / self.radius + self.theta[0]
        self.normal = np.stack([np.cos(angle), np.sin(angle)], axis=1)
        at_hats = np.repeat(self.theta, len(self.z))
        self.normal_at_hats = np.stack([np.cos(at_hats), np.sin(at_hats)], axis=1)
        gram = (g.value.T @ sp.diags(g.weights) @ g.value).toarray()
        self.G = self.compliance @ gram
        held = np.array(self.held, dtype=bool).reshape(len(self.theta), len(self.z))
        held[:, [0, -1]] = True
        self.free = np.flatnonzero(~held.ravel())
        self.carried_with = 0.5 * self.speed * self.radius
        self.outflow = g.outflow(self.carried_with)
        self.on_shaft = -(g.value.T @ (g.weights[:, None] * self.normal))
        self.flow = max(abs(self.carried_with), 1e-6) * self.clearance * float(np.diff(self.z).mean())

    def start(self, place: Array) -> _State:
        """A full film without pressure."""
        none = np.zeros(self.grid.count)
        return _State(np.array(place, dtype=float), none, none.copy(), none.copy(), np.ones(len(none), dtype=bool))

    def gap(self, place: Array, pressures: Array) -> Array:
        """h (points,) [m] under p + a (hats,)."""
        return self.clearance - self.normal @ place + self.grid.value @ (self.G @ pressures)

    def settle(self, place: Array, load: Array) -> Settled:
        """The shaft at rest under `load` (2,) [N], from `place`. Raises `InputError` where it is not found, or
        without a film."""
        state, step, rejected, iterations = self.start(place), FIRST, 0, 0
        for number in range(1, MOST_STEPS + 1):
            found, count = self._stepped(state, np.asarray(load, dtype=float), step)
            iterations += count
            if found is None:
                rejected, step = rejected + 1, SHRINK * step
                continue
            moved, state = np.abs(found.place - state.place).max(), found
            if self.gap(found.place, found.pressure + found.asperity).min() < THINNEST * self.clearance:
                raise InputError("elastic journal: no rest, the film is squeezed out; give it speed, or asperities")
            if number > 1 and moved <= STILL * self.clearance:
                h = self.gap(state.place, state.pressure + state.asperity)
                return Settled(
                    state.place, state.pressure, state.asperity, state.void, h, number, rejected, iterations
                )  # fmt: skip
            step *= GROWTH
        raise InputError(f"elastic journal: no rest in {MOST_STEPS} steps")

    def force(self, pressures: Array) -> Array:
        """On the shaft (2,) [N] by pressures (hats,)."""
        return self.on_shaft.T @ pressures

    def _stepped(self, before: _State, load: Array, step: float) -> tuple[_State | None, int]:
        """An Euler step under `load`, and iterations; None where it fails."""
        g, f, a0 = self.grid, self.free, 1.0 / step
        h_before = self.gap(before.place, before.pressure + before.asperity)
        T = (self.outflow + sp.diags(g.area * a0)).tocsr()[f][:, f].toarray()
        now, settled = before, False
        for iteration in range(1, MOST_ITERATIONS + 1):
            p, a, D, full = now.pressure, now.asperity, now.void, now.full
            h = self.gap(now.place, p + a)
            if h.min() <= 0.0:
                return None, iteration
            h_hats = self.clearance - self.normal_at_hats @ now.place + self.G @ (p + a)
            rest_a = self._asperity(h_hats) - a
            R, A, B = self._flows(p, h, a0)
            R = R + g.integral(a0 * (h - h_before)) - g.area * a0 * (D - before.void) - self.outflow @ D
            F = self.force(p + a) + load
            inside = bool(np.all(p[f][full[f]] >= 0.0) and np.all(D[f][~full[f]] >= -NO_VOID * self.clearance))
            balanced = np.abs(R[f]).max() <= FLOW * self.flow and np.abs(F).max() <= FORCE * np.abs(load).max()
            if settled and inside and balanced and np.abs(rest_a).max() <= FORCE * max(p.max(), 1e5):
                return now, iteration
            change = self._newton(now, R, A, B, T, F, h_hats, rest_a)
            if change is None:
                return None, iteration
            now, settled = self._taken(now, change, h)
        return None, MOST_ITERATIONS

    def _flows(self, p: Array, h: Array, a0: float) -> tuple[Array, sp.csr_matrix, sp.csr_matrix]:
        """Flow by pressure and speed out of each hat, its derivative by pressures at a given gap, and that by the gap
        at the points, squeezing included."""
        g, w = self.grid, self.grid.weights
        at_points = g.value @ p
        mu, mu_slope = self.oil.viscosity_at(at_points), self.oil.viscosity_slope(at_points)
        k, by_x, by_z = h**3 / (12.0 * mu), g.slope_x @ p, g.slope_z @ p
        A = g.diffusion(k)
        R = A @ p - g.carried(h, self.carried_with)
        if np.any(mu_slope):
            thicker = -w * k * mu_slope / mu
            A = A + (g.slope_x.T @ sp.diags(thicker * by_x) + g.slope_z.T @ sp.diags(thicker * by_z)) @ g.value
        wide = w * h**2 / (4.0 * mu)
        B = (
            g.slope_x.T @ sp.diags(wide * by_x - w * self.carried_with)
            + g.slope_z.T @ sp.diags(wide * by_z)
            + g.value.T @ sp.diags(a0 * w)
        )
        return R, A.tocsr(), B.tocsr()

    def _asperity(self, h: Array) -> Array:
        return np.zeros_like(h) if self.asperities is None else self.asperities.pressure(-h)

    def _newton(
        self, now: _State, R: Array, A: sp.csr_matrix, B: sp.csr_matrix, T: Array, F: Array, h_hats: Array,
        rest_a: Array,
    ) -> tuple[Array, Array, Array, Array] | None:  # fmt: skip
        """Changes of place, pressure, asperity pressure, void."""
        g, f, n = self.grid, self.free, self.grid.count
        steep = np.zeros(n) if self.asperities is None else -self.asperities.slope(-h_hats)
        right = np.hstack([self.G, (self.G @ rest_a)[:, None], -self.normal_at_hats])
        at_hats = la.solve(np.eye(n) - self.G * steep[None, :], right) if np.any(steep) else right
        by_p, by_rest, by_e = at_hats[:, :n], at_hats[:, n], at_hats[:, n + 1 :]
        # of p + a, and what that is between the hats
        BG = B @ g.value @ self.G
        J = A.toarray() + BG + BG @ (steep[:, None] * by_p)
        of_rest = BG @ (rest_a + steep * by_rest)
        of_place = -(B @ self.normal) + BG @ (steep[:, None] * by_e)
        on = now.full[f]
        gone_p, gone_D = np.where(now.full, 0.0, -now.pressure), np.where(now.full, -now.void, 0.0)
        matrix = np.where(on[None, :], J[np.ix_(f, f)], -T)
        size = np.abs(matrix).max(axis=0)
        if not np.all(np.isfinite(size)) or np.any(size == 0.0):
            return None
        fixed = R + of_rest + J @ gone_p
        fixed[f] -= T @ gone_D[f]
        lu = la.lu_factor(matrix / size)
        x0, xe = (-la.lu_solve(lu, v) / (size if v.ndim == 1 else size[:, None]) for v in (fixed[f], of_place[f]))
        p0, pe = gone_p.copy(), np.zeros((n, 2))
        p0[f] = np.where(on, x0, gone_p[f])
        pe[f] = np.where(on[:, None], xe, 0.0)
        a_0 = rest_a + steep * (by_p @ p0 + by_rest)
        a_e = steep[:, None] * (by_p @ pe + by_e)
        de = la.solve(self.on_shaft.T @ (pe + a_e), -(F + self.on_shaft.T @ (p0 + a_0)))
        dD = gone_D.copy()
        dD[f] = np.where(on, gone_D[f], x0 + xe @ de)
        return de, p0 + pe @ de, a_0 + a_e @ de, dD

    def _taken(self, now: _State, change: tuple[Array, Array, Array, Array], h: Array) -> tuple[_State, bool]:
        """What the change leads to, and whether it was taken whole and left the set as it was."""
        de, dp, da, dD = change
        part = 1.0
        ahead = self.gap(now.place + de, now.pressure + dp + now.asperity + da)
        if ahead.min() < CLOSEST * h.min():
            part = (1.0 - CLOSEST) * h.min() / float((h - ahead).max())
        f = self.free
        p, D = now.pressure + dp, now.void + dD
        full = now.full.copy()
        full[f] = np.where(now.full[f], p[f] > 0.0, D[f] < -NO_VOID * self.clearance)
        same = np.array_equal(full, now.full)
        found = _State(
            now.place + part * de, now.pressure + part * dp, now.asperity + part * da, now.void + part * dD, full
        )
        return found, same and part == 1.0
