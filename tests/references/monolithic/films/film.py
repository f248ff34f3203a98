r"""A film in the monolithic system: its gaps, balances and forces at a trial state, and their derivatives.

At a point x of the first body A, fixed in its material, with the signed distance d_B from the second surface, n its
gradient there, the outward displacements N q of A and the profile depths of both surfaces,

    h = d_B(x) + form - N q,       U = (u_B - u_A)/2,       k = h^3/(12 mu(p)),

and the functions psi_i of `basis` with pressures p_i and cavity volumes D_i, the oil balance of each is

    R_i = sum_k w_k [grad psi_i.(k grad p - h U) + psi_i delta_t h] - m_i delta_t D_i - (T D)_i,

T D the cavity volumes leaving with U across the faces, upwind. Either D_i = 0 or p_i = 0 if no pressure is given.
delta_t f = a_0 f + a_1 f_(n-1) + a_2 f_(n-2) is BDF2 of variable step in the run, Euler's rule in its first step and in
static ones. Static steps have the initial velocities of the scene and the rotation of A about its own axis in U, as a
steady film is fixed in space. The pressure pushes A along n, and B back at the same x, and drags it by the shear of
B's wall,

    tau = mu (u_B - u_A)(1 - D/h)/h + (h/2) grad p,

and loads its coordinates by -N^T w p: the derivative of h. Under "reynolds" D is a slack that is not transported,
"half_sommerfeld" applies only pressures above zero, "full_sommerfeld" all.

Derivatives by p, D and q are those of these formulas. Those by the six coordinates of each body, which move the
points, the normals and the velocities at once, are central differences of R and of the forces, with the step `STEP` of
the gap.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np
from scipy import sparse

from references.monolithic.core.integrator import BEGIN, PROJECT, REST, Formula
from references.monolithic.core.local_coordinates import LocalCoordinates
from references.monolithic.core.state import Layout, State
from references.monolithic.films.basis import Basis
from warpffrf.model import rotation as rot

Array = np.ndarray
STEP = 1e-4  # of the middle gap: truncation 1e-8 of h^3, as round-off of positions of 0.1 m
TURNS = 30.0  # revolutions of the oil in the longest static step: each leaves a thirtieth of the unsteady part
TRAVELS = ("jfo", "reynolds")  # values of `cavitation` with cavity volumes


@dataclass(frozen=True, eq=False)
class Pose:
    """Both bodies: positions of their centres of mass, axes, velocities (world) and angular velocities (own axes)."""

    r: tuple[Array, Array]
    A: tuple[Array, Array]
    v: tuple[Array, Array]
    w: tuple[Array, Array]

    def moved(self, side: int, column: int, size: float, rate: Array) -> Pose:
        """With one of the six coordinates of a side changed by `size`, and its velocity by `rate` (3,)."""
        r, A, v, w = (list(x) for x in (self.r, self.A, self.v, self.w))
        step = np.zeros(3)
        step[column % 3] = size
        if column < 3:
            r[side], v[side] = r[side] + step, v[side] + rate
        else:
            A[side], w[side] = A[side] @ rot.rotation_vector_matrix(step), w[side] + rate
        return Pose((r[0], r[1]), (A[0], A[1]), (v[0], v[1]), (w[0], w[1]))


@dataclass(frozen=True, eq=False)
class Sight:
    """At points for a pose: distance (n,) from B with the form of its surface, sliding u_B - u_A (n, 2) and U (n, 2)
    around and along, and generalised forces (n, 12) of unit forces on A along n, around, along, the opposite on B."""

    distance: Array
    slide: Array
    carried: Array
    push: Array
    drag: tuple[Array, Array]


@dataclass(frozen=True, eq=False)
class Places:
    """Points (n, 3) [m] of A about its centre of mass, and unit vectors around and along (2, n, 3)."""

    x: Array
    e: Array


class FilmData:
    """The constant data of a film; `columns`: its unknowns, six of A, six of B if that moves, A's modes."""

    def __init__(
        self, film: Any, basis: Basis, layout: Layout, surface: int, local: LocalCoordinates, before: FilmData | None
    ) -> None:
        self.film, self.name, self.label = film, str(film.name), film.label
        self.basis = basis
        first = (0, 0) if before is None else (before.in_nodes.stop, before.in_points.stop)
        self.in_nodes = slice(first[0], first[0] + self.basis.functions)  # of the state
        self.in_points = slice(first[1], first[1] + len(self.basis.weight))
        self.a, self.b = film.a.body.index, film.b.body.index
        self.shape, self.second = film.a.surface.shape, film.b.surface.shape
        self.center = np.asarray(film.a.body.center_of_mass)
        self.center_b = np.zeros(3) if self.b < 0 else np.asarray(film.b.body.center_of_mass)
        self.phi = np.hstack([film.a.surface.mode_normal.reshape(local.trace.shape[0], -1), local.trace])
        self.points = self.places(self.basis.theta, self.basis.z)
        self.nodes = self.places(*self.basis.place.T)
        theta, z = np.meshgrid(film.theta, film.grid.z, indexing="ij")
        self.grid_nodes = self.places(theta.ravel(), z.ravel())
        self.form = film.gap_form(self.basis.theta, self.basis.z)
        self.node_form = film.gap_form(theta, z).ravel()
        self.flexible = np.concatenate(
            [6 * layout.bodies + layout.body_modes(self.a), layout.of_surface(surface)]
        )  # fmt: skip
        rigid = [6 * body + np.arange(6) for body in (self.a, self.b) if body >= 0]
        self.columns = np.concatenate([*rigid, self.flexible])
        self.modes = self.flexible - 6 * layout.bodies
        self.rigid = 6 * len(rigid)
        self.free = np.flatnonzero(~self.basis.held)
        self.travels, self.half = film.cavitation in TRAVELS, film.cavitation == "half_sommerfeld"
        self.slack = film.cavitation == "reynolds"
        w = sparse.diags(self.basis.weight)
        self.loads = self.phi.T @ (self.basis.deform.T @ w @ self.basis.value).toarray()  # (modes, functions)
        self.begin_gap = film.gap_at(self.basis.theta, self.basis.z) + self.basis.deform @ self._lift(local)
        self.thickness = float(film.clearance() or np.median(film.initial_gap()))
        self.rest = [_initial_velocities(body) for body in (film.a.body, film.b.body)]

    @property
    def count(self) -> int:
        """Unknown pressures, or cavity volumes instead."""
        return len(self.free)

    def places(self, theta: Array, z: Array) -> Places:
        """Of points of the chart of A."""
        around = np.asarray(self.shape.around(theta))
        if not self.shape.profile().planar:
            around = around * self.shape.side
        along = np.broadcast_to(self.shape.along(theta, z), (len(theta), 3))
        around = np.broadcast_to(around, (len(theta), 3))
        return Places(self.shape.point(theta, z) - self.center, np.stack([around, along]))

    def pose(self, trial: Any, static: bool) -> Pose:
        """Of both bodies; in static steps with the initial velocities of the scene."""
        sides = []
        for body, (v, w) in zip((self.a, self.b), self.rest, strict=True):
            if body < 0:
                sides.append((np.zeros(3), np.eye(3), np.zeros(3), np.zeros(3)))
                continue
            rates = (v, w) if static else (trial.v[body], trial.w[body])
            sides.append((trial.r[body], trial.A[body], *rates))
        return Pose(*((a, b) for a, b in zip(*sides, strict=True)))

    def sight(self, pose: Pose, at: Places, static: bool) -> Sight:
        """Position relative to B of points of A."""
        (A_a, A_b), (v_a, v_b), (w_a, w_b) = pose.A, pose.v, pose.w
        arm = (pose.r[0] - pose.r[1]) + at.x @ A_a.T  # from B's centre of mass, world
        y = arm @ A_b
        theta, z, distance = self.second.chart(y + self.center_b)
        distance = distance + self.film.second_form(theta, z)
        n = self.second.normal(theta, z) @ (A_b.T @ A_a)  # in A's axes
        slide = (v_b - v_a + np.cross(A_b @ w_b, arm)) @ A_a - np.cross(w_a, at.x)
        carried = 0.5 * slide
        if static and not self.shape.profile().planar:
            axis = np.asarray(self.shape.e_a)
            carried = carried + np.cross((w_a @ axis) * axis, at.x - (self.shape.axis_point - self.center))

        def pull(direction: Array) -> Array:
            """Generalised forces (places, 12) of unit forces along `direction` (places, 3), A's axes."""
            world = direction @ A_a.T
            on_b = world @ A_b
            return np.hstack([world, np.cross(at.x, direction), -world, -np.cross(y, on_b)])[:, : self.rigid]

        by = [np.stack([np.sum(x * e, axis=1) for e in at.e], axis=1) for x in (slide, carried)]
        return Sight(distance, by[0], by[1], pull(n), (pull(at.e[0]), pull(at.e[1])))

    def slowness(self) -> float:
        """Time [s] of transport around the film with the initial velocities of the scene; 0 without any."""
        bodies = (self.film.a.body, self.film.b.body)
        sides = []
        for body, index, (v, w) in zip(bodies, (self.a, self.b), self.rest, strict=True):
            still = (np.zeros(3), np.eye(3))
            A = still[1] if index < 0 else rot.matrix(body.rotation)
            sides.append((still[0] if index < 0 else body.position + A @ body.center_of_mass, A, v, w))
        pose = Pose(*((a, b) for a, b in zip(*sides, strict=True)))
        speed = float(np.hypot(*self.sight(pose, self.points, True).carried.T).max())
        grid, radius = self.film.grid, 1.0 if self.shape.profile().planar else float(self.shape.radius)
        length = max(radius * grid.pitch * grid.columns, float(grid.z[-1] - grid.z[0]))
        return length / speed if speed > 0.0 else 0.0

    def _lift(self, local: LocalCoordinates) -> Array:
        """Opening of the gap at the nodes (nodes,) [m] by local modes under given pressures."""
        b = self.basis
        load = b.deform.T @ (b.weight * (b.value @ b.given))
        return local.trace @ ((local.trace.T @ load) / local.stiffness)


def _initial_velocities(body: Any) -> tuple[Array, Array]:
    """Of the centre of mass (world) and angular (own axes); zero for the ground."""
    if body.index < 0:
        return np.zeros(3), np.zeros(3)
    A = rot.matrix(body.rotation)
    v = np.asarray(body.velocity) + np.cross(body.angular_velocity, A @ body.center_of_mass)
    return v, A.T @ body.angular_velocity


# --- in time


@dataclass(frozen=True, eq=False)
class Memory:
    """Memory of a film from accepted steps: pressure [Pa], cavity volume [m], full, and the cavity volume of the step
    before (functions,); gap (points, 2) [m] of both; step [s] between them, 0 if there is none."""

    pressure: Array
    void: Array
    full: Array
    void_before: Array
    gap: Array
    step: float

    @classmethod
    def of(cls, data: FilmData, state: State) -> Memory:
        """Read from a state."""
        pressure, void, full, before = state.film_nodes[data.in_nodes].T
        return cls(pressure, void, full > 0.5, before, state.film_points[data.in_points], float(state.film_step[0]))

    def keep(self, data: FilmData, state: State) -> None:
        """Write into a state."""
        state.film_nodes[data.in_nodes] = np.stack([self.pressure, self.void, self.full, self.void_before], axis=1)
        state.film_points[data.in_points] = self.gap
        state.film_step[0] = self.step


def begin_films(films: list[FilmData], state: State) -> None:
    """Storage for all films in the state, full and under the given pressures."""
    state.film_nodes = np.zeros((sum(data.basis.functions for data in films), 4))
    state.film_points = np.zeros((sum(len(data.basis.weight) for data in films), 2))
    for data in films:
        zero, gap = np.zeros(data.basis.functions), data.begin_gap
        Memory(data.basis.given, zero, zero < 1.0, zero, np.stack([gap, gap], axis=1), 0.0).keep(data, state)


@dataclass(frozen=True, eq=False)
class Rates:
    """delta_t = a0 f + past, with the past of gaps (points,) and cavities (functions,); whether the step is static."""

    a0: float
    gap: Array
    void: Array
    static: bool


def rates_of(data: FilmData, memory: Memory, formula: Formula, stretch: float) -> Rates:
    """Of a step; static ones are `stretch` times as long for films."""
    static = formula.coefficients is REST
    h = formula.h * stretch if static else formula.h
    a0, a1, a2 = 1.0 / h, -1.0 / h, 0.0
    if memory.step > 0.0 and not any(formula.coefficients is x for x in (REST, PROJECT, BEGIN)):
        ratio = h / memory.step
        a0, a1, a2 = (1.0 + 2.0 * ratio) / ((1.0 + ratio) * h), -(1.0 + ratio) / h, ratio**2 / ((1.0 + ratio) * h)
    void = a1 * memory.void + a2 * memory.void_before
    return Rates(a0, a1 * memory.gap[:, 0] + a2 * memory.gap[:, 1], 0.0 * void if data.slack else void, static)


# --- at a trial state


@dataclass(frozen=True, eq=False)
class Unknowns:
    """pressure [Pa], cavity volume [m] and full (functions,): pressures unknown if full, else cavity volumes."""

    pressure: Array
    void: Array
    full: Array


@dataclass(frozen=True, eq=False)
class Fluid:
    """At points: p and its slopes around and along (n, 2), mu, mu'/mu, cavity volume, applied pressure."""

    pressure: Array
    slope: Array
    viscosity: Array
    thickening: Array
    void: Array
    pushing: Array


class FilmState:
    """A film at a trial state; `total` (columns,): its generalised force."""

    def __init__(self, data: FilmData, trial: Any, rates: Rates, x: Unknowns, vel: float) -> None:
        self.data, self.rates, self.x, self.vel, self.trial = data, rates, x, vel, trial
        b, self.pose = data.basis, data.pose(trial, rates.static)
        p = b.value @ x.pressure
        mu = np.asarray(data.film.oil.viscosity_at(np.maximum(p, 0.0)))
        steep = np.where(p > 0.0, data.film.oil.viscosity_slope(np.maximum(p, 0.0)), 0.0)
        self.fluid = Fluid(
            p, np.stack([b.around @ x.pressure, b.along @ x.pressure], axis=1), mu, steep / mu, b.value @ x.void,
            np.maximum(p, 0.0) if data.half else p,
        )  # fmt: skip
        self.displacement = data.phi @ trial.q[data.modes]  # of the nodes, outwards
        self.sight = data.sight(self.pose, data.points, rates.static)
        self.gap = self.gap_of(self.sight)
        self.through = self.flux(self.pose)
        self.rest = self.balance(self.gap, self.sight, self.through)
        self.loads = -(data.loads @ (np.maximum(x.pressure, 0.0) if data.half else x.pressure))
        self.total = np.concatenate([self.force(self.gap, self.sight), self.loads])

    def gap_of(self, sight: Sight) -> Array:
        """h (points,) [m]."""
        return sight.distance + self.data.form - self.data.basis.deform @ self.displacement

    def flux(self, pose: Pose) -> Array:
        """Transport by U across the faces (faces,) [m2/s] from the first function to the second."""
        data = self.data
        carried = data.sight(pose, data.nodes, self.rates.static).carried
        i, j = data.basis.faces.T
        return np.sum(0.5 * (carried[i] + carried[j]) * data.basis.normals, axis=1)

    def leaving(self, through: Array) -> Any:
        """T (functions, functions): outflow of the cavity volumes of each function."""
        i, j = self.data.basis.faces.T
        n, out, back = self.data.basis.functions, np.maximum(through, 0.0), np.maximum(-through, 0.0)
        own = sparse.coo_matrix((np.concatenate([out, back]), (np.concatenate([i, j]),) * 2), shape=(n, n))
        if self.data.slack:
            return own.tocsr()
        come = (np.concatenate([-back, -out]), (np.concatenate([i, j]), np.concatenate([j, i])))
        return (own + sparse.coo_matrix(come, shape=(n, n))).tocsr()

    def refill(self, through: Array) -> Array:
        """m delta_t D + T D (functions,) [m3/s]."""
        area, D = self.data.basis.area, self.x.void
        return area * (self.rates.a0 * D + self.rates.void) + self.leaving(through) @ D

    def flows(self, h: Array, sight: Sight) -> tuple[Array, Array]:
        """w (k grad p - h U) (points, 2), and w delta_t h (points,)."""
        w, f = self.data.basis.weight, self.fluid
        k = h**3 / (12.0 * f.viscosity)
        flow = w[:, None] * (k[:, None] * f.slope - h[:, None] * sight.carried)
        return flow, w * (self.rates.a0 * h + self.rates.gap)

    def balance(self, h: Array, sight: Sight, through: Array) -> Array:
        """R (functions,) [m3/s]."""
        b = self.data.basis
        flow, filling = self.flows(h, sight)
        R = b.around.T @ flow[:, 0] + b.along.T @ flow[:, 1] + b.value.T @ filling
        return R - self.refill(through)

    def sliding(self, h: Array) -> Array:
        """mu (1 - D/h)/h (points,) [Pa s/m]."""
        return self.fluid.viscosity * np.clip(1.0 - self.fluid.void / h, 0.0, 1.0) / h

    def force(self, h: Array, sight: Sight) -> Array:
        """On the rigid coordinates (12,)."""
        w, f = self.data.basis.weight, self.fluid
        tau = self.sliding(h)[:, None] * sight.slide + 0.5 * h[:, None] * f.slope
        total = (w * f.pushing) @ sight.push
        for c in range(2):
            total = total + (w * tau[:, c]) @ sight.drag[c]
        return total

    @property
    def off(self) -> float:
        """The largest imbalance of the oil of a function over the largest flow."""
        b = self.data.basis
        flow, filling = self.flows(self.gap, self.sight)
        size = abs(b.around.T) @ np.abs(flow[:, 0]) + abs(b.along.T) @ np.abs(flow[:, 1])
        size = size + np.abs(b.value.T @ filling)
        return float(np.abs(self.rest[self.data.free]).max(initial=0.0)) / float(size.max())

    def blur(self, extent: float) -> float:
        """Contribution of the round-off of gaps, 1e-16 of the `extent` [m] of positions, to `off`."""
        b = self.data.basis
        flow, _ = self.flows(self.gap, self.sight)
        size = abs(b.around.T) @ np.abs(flow[:, 0]) + abs(b.along.T) @ np.abs(flow[:, 1])
        return 1e-16 * extent * self.rates.a0 * float(b.area.max()) / float(size.max())

    # --- derivatives

    def slopes(self) -> FilmSlopes:
        """Of R and of the forces."""
        data, b, f, h, s = self.data, self.data.basis, self.fluid, self.gap, self.sight
        w, a0 = b.weight, self.rates.a0
        k = h**3 / (12.0 * f.viscosity)
        thinner = -w * k * f.thickening
        by_flow = (b.around.T, b.along.T)
        rise = (b.around, b.along)
        R_p: Any = sum(by_flow[c] @ sparse.diags(w * k) @ rise[c] for c in range(2))
        R_p = R_p + sum(by_flow[c] @ sparse.diags(thinner * f.slope[:, c]) @ b.value for c in range(2))
        R_D = -(sparse.diags(a0 * b.area) + self.leaving(self.through))
        wide = 3.0 * k / h
        R_h = b.value.T @ sparse.diags(a0 * w)
        R_h = R_h + sum(by_flow[c] @ sparse.diags(w * (wide * f.slope[:, c] - s.carried[:, c])) for c in range(2))
        R_q = -((R_h @ b.deform) @ data.phi)
        drag, wet = self.sliding(h), f.void < h
        drag_h = -drag / h + np.where(wet, f.viscosity * f.void / h**3, 0.0)
        drag_D = np.where(wet, -f.viscosity / h**2, 0.0)
        pushes = (f.pressure > 0.0) if data.half else np.ones(len(h), dtype=bool)
        F_p = (s.push * (w * pushes)[:, None]).T @ b.value
        F_D, F_h = np.zeros((data.rigid, b.functions)), np.zeros((data.rigid, len(h)))
        for c in range(2):
            Q = s.drag[c]
            F_p = F_p + (Q * (w * 0.5 * h)[:, None]).T @ rise[c]
            F_p = F_p + (Q * (w * drag * f.thickening * s.slide[:, c])[:, None]).T @ b.value
            F_D = F_D + (Q * (w * drag_D * s.slide[:, c])[:, None]).T @ b.value
            F_h += (Q * (w * (drag_h * s.slide[:, c] + 0.5 * f.slope[:, c]))[:, None]).T
        loads_p = -data.loads * (self.x.pressure > 0.0) if data.half else -data.loads
        R_x, F_x, h_x = self._by_motion()
        F_q = -((F_h @ b.deform) @ data.phi)
        return FilmSlopes(np.asarray(R_p.todense()), np.asarray(R_D.todense()), np.hstack([R_x, R_q]),
                          np.vstack([F_p, loads_p]), np.vstack([F_D, np.zeros((len(self.loads), b.functions))]),
                          np.hstack([F_x, F_q]), h_x)  # fmt: skip

    def _by_motion(self) -> tuple[Array, Array, Array]:
        """Derivatives by the rigid coordinates: of R, of the rigid forces, of the gap."""
        data = self.data
        R_x, F_x = np.zeros((data.basis.functions, data.rigid)), np.zeros((data.rigid, data.rigid))
        h_x = np.zeros((len(self.gap), data.rigid))
        size, far = STEP * float(np.median(self.gap)), float(np.abs(data.points.x).max())
        bodies = (data.a, data.b)
        for n in range(data.rigid):
            side, column = divmod(n, 6)
            step = size if column < 3 else size / far
            rate = np.zeros(3)
            if not self.rates.static:
                rate[column % 3] = self.vel * step
                if column >= 3:
                    rate = self.trial.T_inverse[bodies[side]] @ rate
            found = []
            for sign in (1.0, -1.0):
                pose = self.pose.moved(side, column, sign * step, sign * rate)
                sight = data.sight(pose, data.points, self.rates.static)
                h = self.gap_of(sight)
                found.append((self.balance(h, sight, self.flux(pose)), self.force(h, sight), h))
            for into, high, low in zip((R_x, F_x, h_x), *found, strict=True):
                into[:, n] = (high - low) / (2.0 * step)
        return R_x, F_x, h_x

    def remembered(self, memory: Memory, step: float) -> Memory:
        """Memory for the next step, after `memory`; step [s]: 0 for static ones, which restart the history."""
        gap = np.stack([self.gap, memory.gap[:, 0]], axis=1)
        return Memory(self.x.pressure, self.x.void, self.x.full, memory.void, gap, step)

    def begun(self, memory: Memory) -> Memory:
        """The same after a tiny step, which changes its pressures only."""
        return Memory(self.x.pressure, memory.void, self.x.full, memory.void_before, memory.gap, 0.0)


@dataclass(frozen=True, eq=False)
class FilmSlopes:
    """Derivatives of R by p, D and the columns, of the generalised force likewise, and of gaps by rigid coordinates."""

    R_p: Array
    R_D: Array
    R_y: Array
    F_p: Array
    F_D: Array
    F_y: Array
    h_x: Array
