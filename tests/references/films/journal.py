r"""A rigid shaft in a rigid bore with a film between them, in the frame of the bore.

    h = c - e.n,    n = (cos theta, sin theta),      F = -int p n dA      on the shaft,
    M_shaft = -R int (mu U_s (1 - D/h)/h + (h/2) p_x) dA,   M_bore = R int (mu U_s (1 - D/h)/h - (h/2) p_x) dA,

e the position of the shaft's centre, U_s = omega R; oil is transported with U = U_s/2. In time, h and D by BDF2 with
h_n and h_(n-1), Euler in the first step:

    f'_n = (a_0 f_n + a_1 f_(n-1) + a_2 f_(n-2)),   a_0 = (1 + 2 r)/((1 + r) h_n),  a_1 = -(1 + r)/h_n,
    a_2 = r^2/((1 + r) h_n),   r = h_n/h_(n-1),

for which h in the balance of a step equals that in the next one: no oil is lost. Under a load the position follows from
F(e) + W = 0 by Newton's method, with the derivative at the computed set of full nodes.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, field

import numpy as np
import scipy.sparse as sp
from scipy.sparse.linalg import splu

from references.films.complementarity import FilmState, solve
from references.films.grid import FilmGrid
from warpffrf.model.errors import InputError

Array = np.ndarray
BALANCED = 1e-9  # of the load
MOST_ITERATIONS = 60
CLOSEST = 0.2  # of the smallest film: lower limit after one iteration


@dataclass
class Past:
    """Gap at the points and cavity volume of the two previous steps, and the last step [s]."""

    gap: Array
    void: Array
    gap_before: Array | None = None
    void_before: Array | None = None
    step: float = 0.0


@dataclass
class JournalFilm:
    """radius, length, clearance [m]; viscosity [Pa s]; speed omega [rad/s]; columns x rows nodes; feeds: columns with
    the pressure `feed` [Pa]; mode: `complementarity.MODES`; ends at zero pressure."""

    radius: float
    length: float
    clearance: float
    viscosity: float
    speed: float
    columns: int
    rows: int
    feeds: tuple[int, ...] = ()
    feed: float = 0.0
    mode: str = "jfo"
    points: tuple[int, int] = (3, 2)
    past: Past | None = field(default=None, init=False)
    state: FilmState | None = field(default=None, init=False)

    def __post_init__(self) -> None:
        turn = 2.0 * np.pi
        theta = np.arange(self.columns) * turn / self.columns
        z = np.linspace(-0.5 * self.length, 0.5 * self.length, self.rows)
        self.grid = FilmGrid(self.radius * theta, z, period=self.radius * turn, points=self.points)
        angle = self.grid.at[:, 0] / self.radius
        self.normal = np.stack([np.cos(angle), np.sin(angle)], axis=1)
        held = np.zeros((self.columns, self.rows), dtype=bool)
        held[:, [0, -1]] = True
        given = np.zeros_like(held, dtype=float)
        for column in self.feeds:
            held[column], given[column, 1:-1] = True, self.feed
        self.held, self.given = held.ravel(), given.ravel()
        self.carried_with = 0.5 * self.speed * self.radius
        self.outflow = self.grid.outflow(self.carried_with)
        self.on_shaft = -(self.grid.value.T @ (self.grid.weights[:, None] * self.normal))  # (nodes, 2): F = p.this

    def gap(self, place: Array) -> Array:
        """h (points,) [m]. Raises `InputError` if the surfaces touch."""
        h = self.clearance - self.normal @ np.asarray(place, dtype=float)
        if h.min() <= 0.0:
            raise InputError(f"journal film: the shaft touches the bore at an eccentricity of {np.hypot(*place):g} m")
        return h

    def steady(self, place: Array) -> FilmState:
        """The film of a shaft at rest."""
        return self._solved(np.asarray(place, dtype=float), None)[0]

    def force(self, state: FilmState) -> Array:
        """On the shaft (2,) [N]."""
        return self.on_shaft.T @ state.pressure

    def torques(self, place: Array, state: FilmState) -> tuple[float, float]:
        """About the axes of shaft and bore, each on its own body [N m], positive in the direction of rotation."""
        h, w = self.gap(place), self.grid.weights
        filled = 1.0 - (self.grid.value @ state.void) / h
        couette = self.viscosity * self.speed * self.radius * filled / h
        poiseuille = 0.5 * h * (self.grid.slope_x @ state.pressure)
        return -self.radius * float(w @ (couette + poiseuille)), self.radius * float(w @ (couette - poiseuille))

    def losses(self, place: Array, state: FilmState) -> tuple[float, float]:
        """Power of shear and of the flow by pressure [W]."""
        h, w, mu = self.gap(place), self.grid.weights, self.viscosity
        filled = 1.0 - (self.grid.value @ state.void) / h
        shear = mu * (self.speed * self.radius) ** 2 * filled / h
        slopes = (self.grid.slope_x @ state.pressure) ** 2 + (self.grid.slope_z @ state.pressure) ** 2
        return float(w @ shear), float(w @ (h**3 / (12.0 * mu) * slopes))

    def advance(self, place: Array, step: float) -> FilmState:
        """One step to a given position; the first starts from `begin` or, if that was not called, from a full film."""
        place = np.asarray(place, dtype=float)
        self.state, _ = self._solved(place, step)
        self._keep(place, step)
        return self.state

    def begin(self, place: Array, state: FilmState | None = None) -> None:
        """The start of a motion: a full film at `place`, or `state`."""
        void = np.zeros(self.grid.count) if state is None else state.void
        self.past, self.state = Past(self.gap(place), void.copy()), state

    def carry(self, place: Array, load: Array, step: float) -> tuple[Array, int]:
        """One step under `load` (2,) [N] of a massless shaft, from an initial position; the position and the number of
        iterations."""
        place, load = np.asarray(place, dtype=float).copy(), np.asarray(load, dtype=float)
        for iteration in range(1, MOST_ITERATIONS + 1):
            self.state, stiffness = self._solved(place, step, derivative=True)
            rest = self.force(self.state) + load
            if np.abs(rest).max() <= BALANCED * np.abs(load).max():
                self._keep(place, step)
                return place, iteration
            move = np.linalg.solve(stiffness, rest)
            h, ahead = self.gap(place), self.clearance - self.normal @ (place + move)
            if ahead.min() < CLOSEST * h.min():
                move *= (1.0 - CLOSEST) * h.min() / (h - ahead).max()
            place += move
        raise InputError(f"journal film: no balance in {MOST_ITERATIONS} iterations; take a shorter step")

    def coefficients(self, place: Array, state: FilmState) -> tuple[Array, Array]:
        """Stiffness [N/m] and damping [N s/m] (2, 2) about a steady state, -dF/de and -dF/de', at its set of full
        nodes."""
        h, p = self.gap(place), state.pressure
        solved = self._factor(h, state, 0.0)
        by_place = self._residual_by_gap(h, p, 0.0) @ (-self.normal)
        by_speed = self.grid.value.T @ (self.grid.weights[:, None] * (-self.normal))
        stiffness, damping = (-(self.on_shaft.T @ self._follow(state, solved, c)) for c in (by_place, by_speed))
        return stiffness, damping

    # --- one linear problem

    def _times(self, step: float | None) -> tuple[float, Array | float, Array | float]:
        """a_0, and a_1 f_(n-1) + a_2 f_(n-2) of gap and cavity volume."""
        if step is None:
            return 0.0, 0.0, 0.0
        assert self.past is not None
        past = self.past
        if past.gap_before is None or past.void_before is None:
            return 1.0 / step, -past.gap / step, -past.void / step
        r = step / past.step
        a1, a2 = -(1.0 + r) / step, r**2 / ((1.0 + r) * step)
        a0 = (1.0 + 2.0 * r) / ((1.0 + r) * step)
        return a0, a1 * past.gap + a2 * past.gap_before, a1 * past.void + a2 * past.void_before

    def _solved(self, place: Array, step: float | None, *, derivative: bool = False) -> tuple[FilmState, Array]:
        if step is not None and self.past is None:
            self.begin(place)
        h = self.gap(place)
        a0, h_past, D_past = self._times(step)
        A = self.grid.diffusion(h**3 / (12.0 * self.viscosity))
        T = (self.outflow + sp.diags(self.grid.area * a0)).tocsr()
        right = self.grid.carried(h, self.carried_with)
        if step is not None:
            right = right - self.grid.integral(a0 * h + h_past) + self.grid.area * D_past
        full = None if self.state is None else self.state.full
        state = solve(A, T, right, self.held, self.given, mode=self.mode, full=full)
        if not derivative:
            return state, np.zeros((2, 2))
        change = self._residual_by_gap(h, state.pressure, a0) @ (-self.normal)
        return state, -(self.on_shaft.T @ self._follow(state, self._factor(h, state, a0), change))

    def _follow(self, state: FilmState, solved: Callable[[Array], Array], change: Array) -> Array:
        """Changes of pressure (nodes, 2) with those of the residual, at the set of `state`; a half film has those of
        its positive pressures."""
        free = ~self.held
        on = state.pressure > 0.0 if self.mode == "half_sommerfeld" else state.full
        found = np.zeros((self.grid.count, 2))
        found[free] = np.where(on[free, None], -solved(change[free]), 0.0)
        return found

    def _residual_by_gap(self, h: Array, p: Array, a0: float) -> sp.csr_matrix:
        """Derivative (nodes, points) of the residual by the gap at the points."""
        g, w = self.grid, self.grid.weights
        conductance = h**2 / (4.0 * self.viscosity)
        by_x = w * (conductance * (g.slope_x @ p) - self.carried_with)
        by_z = w * conductance * (g.slope_z @ p)
        return (g.slope_x.T @ sp.diags(by_x) + g.slope_z.T @ sp.diags(by_z) + g.value.T @ sp.diags(a0 * w)).tocsr()

    def _factor(self, h: Array, state: FilmState, a0: float) -> Callable[[Array], Array]:
        """Solution of the linear problem of the set of `state` for right-hand sides (free, n)."""
        free = np.flatnonzero(~self.held)
        A = self.grid.diffusion(h**3 / (12.0 * self.viscosity))[free][:, free]
        T = (self.outflow + sp.diags(self.grid.area * a0)).tocsr()[free][:, free]
        if self.mode == "reynolds":
            T = sp.identity(len(free), format="csr")
        on = state.full[free].astype(float)
        columns = (A @ sp.diags(on) - T @ sp.diags(1.0 - on)).tocsc()
        size = np.asarray(abs(columns).max(axis=0).todense()).ravel()
        lu = splu((columns @ sp.diags(1.0 / size)).tocsc())
        return lambda right: lu.solve(np.ascontiguousarray(right)) / size[:, None]

    def _keep(self, place: Array, step: float) -> None:
        assert self.past is not None and self.state is not None
        self.past = Past(self.gap(place), self.state.void.copy(), self.past.gap, self.past.void, step)
