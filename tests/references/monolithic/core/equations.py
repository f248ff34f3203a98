r"""Equations of motion of all coordinates at the end of a step, without contact, and their exact Jacobian.

Unknowns are the increments (dx, psi, dq) of the step (`integrator`) and the multipliers lam of rigid rows. Residuals:

    body      m vdot - m g + (C^T lam)_x - F,          inertia torque (`inertia_forces`) + (C^T lam)_theta - M,
    mode      qddot + c qdot + k q + inertia terms + (C^T lam)_q - f,
    local     mu xiddot + c xidot + kappa xi - f       (quasi-static: mu = c = 0),
    row       c(x, t); of a pretension before locking, lam - F(t) (`tension`).

A spring adds C^T (K (e - e_0) + D edot + preload) with edot = C ydot, ydot = (v, w, qdot); its tangent is
`sum lam_i H_i + C^T (K slope + D (C V + ydot^T H))`, H the derivative of C^T, V = VEL (1, T^-1, 1). Characteristics
add their forces to the law, and their slopes to the diagonals of K and D in the tangent.

Columns belong to (dx, dtheta, dq, dlam), dtheta a rotation about the body's axes: psi follows by dpsi = T^-1 dtheta.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np

from references.membrane import membrane_energy, membrane_gradient, membrane_tangent
from references.monolithic.core.description import SceneData, SpringData
from references.monolithic.core.inertia_forces import inertia_forces
from references.monolithic.core.integrator import Formula
from references.monolithic.core.mean_work import Pulls, add_mean_work
from references.monolithic.core.rotation import cross, exponential, hat, multiply, tangent_inverse
from references.monolithic.core.rows import Function, MarkerState, RowStates, marker_state, row_states
from references.monolithic.core.state import Layout, State
from references.monolithic.core.tension import Tensions, tensions_of
from warpffrf.model import rotation as rot

TURN = 2.0 * np.pi
ANGLES = ("angle", "second_angle", "twist")  # coordinates that are angles


@dataclass(frozen=True, eq=False)
class LocalData:
    """All local coordinates: mass mu, damping c and stiffness kappa (n,)."""

    mass: np.ndarray
    damping: np.ndarray
    stiffness: np.ndarray


@dataclass(eq=False)
class Increment:
    """Unknowns of a step: dx, psi (B, 3), dq (n,) of `State.q`, lam (rows,)."""

    dx: np.ndarray
    psi: np.ndarray
    dq: np.ndarray
    lam: np.ndarray

    def add(self, z: np.ndarray, layout: Layout, T_inverse: np.ndarray) -> None:
        """Add a correction z (size,)."""
        rigid = z[: 6 * layout.bodies].reshape(-1, 6)
        self.dx += rigid[:, :3]
        self.psi += np.einsum("bij,bj->bi", T_inverse, rigid[:, 3:])
        self.dq += z[6 * layout.bodies : layout.coordinates]
        self.lam += z[layout.coordinates :]


@dataclass(frozen=True, eq=False)
class Trial:
    """The state for given increments; T_inverse (B, 3, 3) at psi."""

    time: float
    r: np.ndarray
    p: np.ndarray
    A: np.ndarray
    v: np.ndarray
    v_rate: np.ndarray
    w: np.ndarray
    w_rate: np.ndarray
    q: np.ndarray
    qd: np.ndarray
    qdd: np.ndarray
    T_inverse: np.ndarray


@dataclass(frozen=True, eq=False)
class Balance:
    """`residual` (size,), `retained` (retained + rows, retained + rows) tangent of rigid coordinates, global modes and
    rows, `diagonal` (local,) that of local coordinates, the `wrenches` (rows, 6) of unit multipliers, the largest force
    [N], new `stretch`, energies [J], and `springs` (coordinates, 7): value and wrench on the second body of every
    coordinate of the spring laws. `locked` (t, 2) of pretensions: whether they are locked, and their present or locked
    length. `pulls` (markers, 6) on interfaces and `lag` (2, modes) of the forces whose mean is given (`mean_work`)."""

    residual: np.ndarray
    retained: np.ndarray
    diagonal: np.ndarray
    wrenches: np.ndarray
    force: float
    stretch: np.ndarray
    energy: dict[str, float]
    springs: np.ndarray
    locked: np.ndarray
    pulls: np.ndarray
    lag: np.ndarray


def predicted(state: State, formula: Formula) -> Increment:
    """Increments that keep the accelerations of the state."""
    return Increment(
        formula.predicted(state.v, state.v_rate, state.v_alg),
        formula.predicted(state.w, state.w_rate, state.w_alg),
        formula.predicted(state.qd, state.qdd, state.q_alg),
        state.lam.copy(),
    )


def advance(state: State, formula: Formula, x: Increment, time: float) -> Trial:
    """The state at the end of the step for the increments x."""

    def rates(d, v, rate, alg):
        a = formula.algorithmic(d, v, alg)
        return formula.velocity(v, alg, a), formula.rate(rate, alg, a)

    v, v_rate = rates(x.dx, state.v, state.v_rate, state.v_alg)
    w, w_rate = rates(x.psi, state.w, state.w_rate, state.w_alg)
    qd, qdd = rates(x.dq, state.qd, state.qdd, state.q_alg)
    p = np.array([multiply(a, exponential(b)) for a, b in zip(state.p, x.psi, strict=True)])
    A = np.array([rot.matrix(a) for a in p])
    T_inverse = np.array([tangent_inverse(psi) for psi in x.psi])
    return Trial(time, state.r + x.dx, p, A, v, v_rate, w, w_rate, state.q + x.dq, qd, qdd, T_inverse)


def balance(
    data: SceneData, layout: Layout, local: LocalData, state: State, formula: Formula, x: Increment, trial: Trial
) -> Balance:
    """Residual and Jacobian of the module docstring."""
    B, n_modes = layout.bodies, layout.modes
    work = _Work(data, layout, formula, trial)
    residual, K = work.residual, work.tangent
    vel, acc = formula.vel, formula.acc
    kinetic = strain = 0.0
    for b, body in enumerate(data.bodies):
        o, modes = 6 * b, layout.body_modes(b)
        turn = slice(o + 3, o + 6)
        at = 6 * B + modes
        residual[o : o + 3] += body.mass * (trial.v_rate[b] - data.gravity)
        K[o + np.arange(3), o + np.arange(3)] += body.mass * acc
        q, qd, qdd = trial.q[modes], trial.qd[modes], trial.qdd[modes]
        forces = inertia_forces(body.inertia, body.terms, trial.w[b], trial.w_rate[b], q, qd, qdd, vel, acc)
        T = trial.T_inverse[b]
        residual[turn] += forces.torque
        K[turn, turn] += forces.turn_turn @ T
        residual[at] += qdd + body.damping * qd + body.stiffness * q
        K[at, at] += acc + body.damping * vel + body.stiffness
        k = len(forces.modal)
        if k:
            some = slice(6 * B + layout.mode_start[b], 6 * B + layout.mode_start[b] + k)
            residual[some] += forces.modal
            K[turn, some] += forces.turn_modes
            K[some, turn] += forces.modes_turn @ T
            K[some, some] += forces.modes_modes
        if body.membrane is not None:
            some = slice(6 * B + layout.mode_start[b], 6 * B + layout.mode_start[b] + body.membrane.shape[1])
            residual[some] += membrane_gradient(body.membrane, q)
            K[some, some] += membrane_tangent(body.membrane, q)
            strain += membrane_energy(body.membrane, q)
        kinetic += 0.5 * body.mass * float(trial.v[b] @ trial.v[b]) + forces.energy + 0.5 * float(qd @ qd)
        strain += 0.5 * float(body.stiffness @ (q * q))
        gyration = body.gyration
        work.force = max(work.force, body.mass * float(np.linalg.norm(data.gravity) + np.linalg.norm(trial.v_rate[b])))
        work.force = max(work.force, float(np.linalg.norm(forces.torque)) / gyration)
    tensions = tensions_of(data, state, formula, trial.time)
    wrenches, values = work.add_constraints(x.lam, tensions)
    locked = np.stack([tensions.holds, np.where(tensions.holds, tensions.length, values[tensions.rows])], axis=1)
    stretch, stored = work.add_springs(state.stretch)
    work.add_loads()
    lag = add_mean_work(data, layout, state, formula, trial.q, work.pulls, residual, K)
    xi, xid, xidd = trial.q[n_modes:], trial.qd[n_modes:], trial.qdd[n_modes:]
    full = np.zeros(layout.size)
    full[: layout.retained] = residual[: layout.retained]
    full[layout.retained : layout.coordinates] = local.mass * xidd + local.damping * xid + local.stiffness * xi
    full[layout.coordinates :] = residual[layout.retained :]
    diagonal = acc * local.mass + vel * local.damping + local.stiffness
    potential = stored - sum(b.mass * float(data.gravity @ trial.r[i]) for i, b in enumerate(data.bodies))
    energy = {
        "kinetic": kinetic + 0.5 * float(local.mass @ (xid * xid)),
        "strain": strain,
        "contact": 0.5 * float(local.stiffness @ (xi * xi)),
        "potential": potential,
    }
    return Balance(
        full, K, diagonal, wrenches, work.force, stretch, energy, work.springs, locked, work.pulls.value, lag
    )


def row_curvature(data: SceneData, layout: Layout, trial: Trial, V: np.ndarray) -> np.ndarray:
    """V^T H V (rows,) of the rigid rows for velocities V (retained,): the part of their second derivative besides C
    a."""
    work = _Work(data, layout, None, trial)
    out = np.zeros(layout.rows)
    for n, item in enumerate(data.constraints):
        rows, at = work.rows([(item.kind, item.i, item.j, None)], item.markers)
        out[n] = V[at] @ rows.turning[0] @ V[at]
    return out


class _Work:
    """Residual and tangent of the retained unknowns (rigid, global modes, rows), accumulated."""

    def __init__(self, data: SceneData, layout: Layout, formula: Any, trial: Trial) -> None:
        self.data, self.layout, self.formula, self.trial = data, layout, formula, trial
        size = layout.retained + layout.rows
        self.residual = np.zeros(size)
        self.tangent = np.zeros((size, size))
        self.force = 0.0
        self.springs = np.zeros((sum(len(s.coordinates) for s in data.springs), 7))
        self.pulls = Pulls.none(data, layout)
        self.markers: list[MarkerState] = []
        for place in data.markers:
            b = place.body
            q = trial.q[layout.body_modes(b)] if b >= 0 else np.zeros(0)
            self.markers.append(marker_state(place, trial.r[max(b, 0)], trial.A[max(b, 0)], q))

    def rows(self, functions: list[Function], markers: tuple[int, int]) -> tuple[RowStates, np.ndarray]:
        """Rows of two markers, and their unknowns, each once."""
        a, b = (self.markers[m] for m in markers)
        found = row_states(functions, a, b)
        at_a, at_b = (self.layout.of_body(m.place.body, m.place.modes is not None) for m in (a, b))
        if a.place.body == b.place.body >= 0:
            return found.of_one_body(), at_a
        return found, np.concatenate([at_a, at_b])

    def pull(
        self, functions: list[Function], markers: tuple[int, int], lam: np.ndarray, columns: np.ndarray,
        change: np.ndarray,
    ) -> None:  # fmt: skip
        """Forces of rows with multipliers `lam` (k,) at their markers; `change` (k, c) of these by the unknowns
        `columns`."""
        if not any(m in self.pulls.change for m in markers):
            return
        a, b = (self.markers[m] for m in markers)
        at = [self.layout.of_body(m.place.body, m.place.modes is not None) for m in (a, b)]
        rows = row_states(functions, a, b)
        for number, marker, first in zip(markers, (a, b), (0, len(at[0])), strict=True):
            if number in self.pulls.change:
                self.pulls.add(number, marker, rows, first, np.concatenate(at), lam, columns, change)

    def add_constraints(self, lam: np.ndarray, tensions: Tensions) -> tuple[np.ndarray, np.ndarray]:
        """Rigid rows and pretensions: their multipliers on the bodies, and their residuals. Returns the wrenches of
        unit multipliers and the values of all rows."""
        wrenches, values = np.zeros((len(lam), 6)), np.zeros(len(lam))
        groups: dict[tuple[int, int], list[int]] = {}
        for n, item in enumerate(self.data.constraints):
            groups.setdefault(item.markers, []).append(n)
        for markers, members in groups.items():
            items = [self.data.constraints[n] for n in members]
            rows, at = self.rows([(c.kind, c.i, c.j, None) for c in items], markers)
            lines = self.layout.retained + np.array(members)
            pull = lam[members]
            self.residual[at] += pull @ rows.force
            self.tangent[lines[:, None], at] = rows.slope
            self.tangent[at[:, None], lines] = rows.force.T
            self.tangent[at[:, None], at] += np.tensordot(pull, rows.turning, 1)
            self.pull([(c.kind, c.i, c.j, None) for c in items], markers, pull, lines, np.eye(len(lines)))
            wrenches[members], values[members] = rows.wrench, rows.value
            for item, line, value, force in zip(items, lines, rows.value, pull, strict=True):
                if item.signal is not None:
                    value -= float(item.signal(self.trial.time))
                if item.kind in ANGLES:
                    value = float(np.arctan2(np.sin(value), np.cos(value)))
                self.residual[line] = value - item.reference
                if item.is_length:
                    self.force = max(self.force, abs(float(force)))
        lines = self.layout.retained + tensions.rows
        self.residual[lines] = values[tensions.rows] - tensions.length
        pulls = ~tensions.holds
        lines, scale = lines[pulls], tensions.scale[pulls]
        self.residual[lines] = (lam[tensions.rows] - tensions.force)[pulls] / scale
        self.tangent[lines] = 0.0
        self.tangent[lines, lines] = 1.0 / scale
        return wrenches, values

    def velocities(self, at: np.ndarray) -> np.ndarray:
        """ydot of the unknowns `at`."""
        B, trial = self.layout.bodies, self.trial
        rigid = np.concatenate([trial.v, trial.w], axis=1).ravel()
        return np.concatenate([rigid, trial.qd[: self.layout.modes]])[at] if B else np.zeros(0)

    def rate_slope(self, x: np.ndarray, at: np.ndarray) -> np.ndarray:
        """x V (see the module) for rows x (..., n) over the unknowns `at`."""
        out = self.formula.vel * x
        n = 0
        while n < len(at):
            if at[n] < 6 * self.layout.bodies:
                turn = slice(n + 3, n + 6)
                out[..., turn] = out[..., turn] @ self.trial.T_inverse[at[n] // 6]
                n += 6
            else:
                n += 1
        return out

    def add_springs(self, stretch: np.ndarray) -> tuple[np.ndarray, float]:
        """Springs and dampers; returns the values of their coordinates and the energy stored."""
        new, stored, first = stretch.copy(), 0.0, 0
        for spring in self.data.springs:
            stored += self._add_spring(spring, stretch, new, first)
            first += len(spring.coordinates)
        return new, stored

    def _add_spring(self, spring: SpringData, stretch: np.ndarray, new: np.ndarray, first: int) -> float:
        count = len(spring.coordinates)
        rows, at = self.rows(list(spring.coordinates), spring.markers)
        e = rows.value.copy()
        for n, (kind, *_) in enumerate(spring.coordinates):
            if kind in ANGLES:  # counts revolutions from the last accepted state
                e[n] += TURN * np.round((stretch[first + n] - e[n]) / TURN)
        new[first : first + count] = e
        C, H = rows.force, rows.turning
        ydot = self.velocities(at)
        off = e - spring.reference
        rate = C @ ydot
        lam = spring.stiffness @ off + spring.damping @ rate + spring.preload
        steepness, resistance = spring.stiffness.copy(), spring.damping.copy()
        for n, curve in spring.elastic.items():
            lam[n] += curve.force(off[n])
            steepness[n, n] += curve.slope(off[n])
        for n, curve in spring.viscous.items():
            lam[n] += curve.force(rate[n])
            resistance[n, n] += curve.slope(rate[n])
        slope = steepness @ rows.slope
        slope = slope + resistance @ (self.rate_slope(C, at) + ydot @ H)
        self.residual[at] += lam @ C
        self.tangent[np.ix_(at, at)] += np.tensordot(lam, H, 1) + C.T @ slope
        self.pull(list(spring.coordinates), spring.markers, lam, at, slope)
        self.springs[first : first + count, 0] = e
        self.springs[first : first + count, 1:] = -lam[:, None] * rows.wrench
        pulls = np.abs(lam) * np.linalg.norm(rows.wrench[:, :3], axis=1)
        self.force = max(self.force, float(pulls.max(initial=0.0)))
        symmetric = 0.5 * (spring.stiffness + spring.stiffness.T)
        stored = float(0.5 * off @ symmetric @ off + spring.preload @ off)
        return stored + sum(float(curve.energy(off[n])) for n, curve in spring.elastic.items())

    def add_loads(self) -> None:
        """Concentrated forces and torques, and loads that are constant in body axes."""
        trial, layout = self.trial, self.layout
        for load in self.data.loads:
            self._add_load(load.what, self.markers[load.marker], load.in_body, load.components)
        for load in self.data.body_loads:
            b = load.body.index
            A, s = trial.A[b], float(load.signal(trial.time))
            force = A @ (s * load.force)
            o, at = 6 * b, 6 * layout.bodies + layout.body_modes(b)
            self.residual[o : o + 3] -= force
            self.residual[o + 3 : o + 6] -= s * (load.torque - cross(self.data.bodies[b].center, load.force))
            self.residual[at] -= s * load.modal
            self.tangent[o : o + 3, o + 3 : o + 6] += hat(force) @ A
            self.force = max(self.force, float(np.linalg.norm(force)))

    def _add_load(self, what: str, m: MarkerState, in_body: bool, components: tuple) -> None:
        value = np.array([float(s(self.trial.time)) for s in components])
        local = value if in_body else m.A.T @ value  # in body axes; rotates with the body's inverse if fixed in space
        b = m.place.body
        at = self.layout.of_body(b, m.place.modes is not None)
        n = len(at)
        turned = np.zeros((3, n))  # derivative of `local`
        if not in_body:
            turned[:, 3:6] = hat(local)
        force, change = np.zeros(n), np.zeros((n, n))
        slope = m.slope
        if what == "torque":
            force[3:6], change[3:6] = local, turned
            pull, pull_change = np.concatenate([np.zeros(3), local]), np.concatenate([np.zeros((3, n)), turned])
        else:
            arm = m.A.T @ (m.x - m.r)
            moved = m.A.T @ m.moved  # of the arm: the effect of translation and rotation of the body is omitted
            moved[:, :6] = 0.0
            force[:3] = m.A @ local
            if in_body:
                change[:3, 3:6] = -m.A @ hat(local)
            force[3:6] = cross(arm, local)
            change[3:6] = hat(arm) @ turned - hat(local) @ moved
            lever = np.zeros(3) if m.place.pivot is None else m.place.point - m.place.pivot
            pull = np.concatenate([local, cross(lever, local)])
            pull_change = np.concatenate([turned, hat(lever) @ turned])
            self.force = max(self.force, float(np.linalg.norm(value)))
        if slope is not None:
            force[6:], change[6:] = slope @ pull, slope @ pull_change
            if m.place.stiffening is not None:
                k = m.place.stiffening.shape[1]
                change[6 : 6 + k, 6 : 6 + k] -= np.tensordot(pull, m.place.stiffening, 1)
        if what == "torque":
            gyration = self.data.bodies[b].gyration
            self.force = max(self.force, float(np.linalg.norm(value)) / gyration)
        self.residual[at] -= force
        self.tangent[np.ix_(at, at)] -= change
