r"""The start of a run: velocities, accelerations and multipliers consistent with joints and drives.

Two tiny steps determine contact pressures (`integrator`: PROJECT, BEGIN). They divide displacements by the square of
their size, so accelerations are then computed from the equations of motion and the joints' equations differentiated,

    V = V_given - M0^-1 C^T y,     C V = s',
    M a + C^T lam = -R_0,          C a = s'' - gamma,       gamma = V^T H V,

M0 the mass matrix of the undeformed bodies, M that with all inertia terms (R is linear in a, so M is the difference of
its tangents for ACC = 1 and 0), R_0 the residual without accelerations and multipliers, H the derivative of the row's
gradient by the coordinates (`rows`). Pretensions that pull are forces, not rows of C. Local coordinates with mass
follow their own equations.
"""

from __future__ import annotations

from dataclasses import replace
from typing import Any

import numpy as np

from references.monolithic.core.equations import Balance, Increment, Trial, balance, row_curvature
from references.monolithic.core.integrator import BEGIN, PROJECT, Formula
from references.monolithic.core.rotation import tangent_inverse
from references.monolithic.core.state import State
from references.monolithic.core.tension import tensions_of
from references.monolithic.newton import Evaluation, Solution, System, solve_step
from references.monolithic.nodal.newton import node_pair_state
from warpffrf.model.rotation import matrix

START_STEP = 1e-7  # s, of the tiny steps, which only determine the contact state
SINGULAR = 1e-11  # least pivot over the largest of the scaled equations: dependent rows


class _Slopes(Formula):
    """Tangents by accelerations alone: VEL = 0, ACC as given instead of h."""

    @property
    def vel(self) -> float:
        return 0.0

    @property
    def acc(self) -> float:
        return self.h


def begin(system: System, state: State) -> Solution:
    """Set consistent rates and multipliers of `state` at its time; the solution is that of the last tiny step, with the
    multipliers of the result. A failure is in its `failure`."""
    given = state.copy()
    solution = solve_step(system, state, Formula(PROJECT, START_STEP), state.time + START_STEP)
    if solution.evaluation is None:
        return solution
    trial = solution.evaluation.trial
    state.v, state.w, state.qd = trial.v, trial.w, trial.qd
    solution = solve_step(system, state, Formula(BEGIN, START_STEP), state.time + START_STEP)
    evaluation = solution.evaluation
    if evaluation is None:
        return solution
    trial = evaluation.trial
    state.v_rate, state.w_rate, state.qdd = trial.v_rate, trial.w_rate, trial.qdd
    for name, rate in (("v", trial.v_rate), ("w", trial.w_rate), ("qd", trial.qdd)):
        setattr(state, name, getattr(state, name) - START_STEP * rate)
    state.lam = solution.increment.lam.copy()
    state.stretch, state.locked = evaluation.balance.stretch, evaluation.balance.locked
    found = _refined(system, state, given, evaluation)
    if found is not None:
        solution.increment.lam[:] = state.lam
        solution.evaluation = replace(evaluation, balance=found)
    for name, rate in (("v_alg", state.v_rate), ("w_alg", state.w_rate), ("q_alg", state.qdd)):
        setattr(state, name, rate.copy())
    return solution


def standing(system: System, state: State) -> np.ndarray:
    """Memory of nodes (`State.nodes`) at the start itself, not at the end of a tiny step."""
    found, trial = state.nodes.copy(), _at_rest(state, False)
    for n, data in enumerate(system.pairs):
        pair = node_pair_state(data, system.layout, trial, state, Formula(BEGIN, START_STEP), system.local_slices(n))
        found[data.rows] = pair.remembered()
    return found


def _at_rest(state: State, rates: bool) -> Trial:
    """The state itself as a trial, with its accelerations or without."""
    A = np.array([matrix(p) for p in state.p])
    T = np.array([tangent_inverse(np.zeros(3)) for _ in state.p])
    s = 1.0 if rates else 0.0
    return Trial(
        state.time, state.r, state.p, A, state.v, s * state.v_rate, state.w, s * state.w_rate, state.q, state.qd,
        s * state.qdd, T,
    )  # fmt: skip


def _refined(system: System, state: State, given: State, evaluation: Evaluation) -> Balance | None:
    """The equations of the module solved in place; None if the rows are dependent."""
    layout, data = system.layout, system.data
    o, c, B = layout.retained, layout.coordinates, layout.bodies

    def at(acc: float, lam: np.ndarray, rates: bool = False) -> Balance:
        zero = Increment(np.zeros_like(state.r), np.zeros_like(state.w), np.zeros_like(state.q), lam)
        trial = _at_rest(state, rates)
        return balance(data, layout, system.local, state, _Slopes(BEGIN, acc), zero, trial)

    tensions = tensions_of(data, state, _Slopes(BEGIN, 0.0), state.time)
    pulls = tensions.rows[~tensions.holds]
    lam = np.zeros(layout.rows)
    lam[pulls] = tensions.force[~tensions.holds]
    held = np.delete(np.arange(layout.rows), pulls)
    first = at(0.0, lam)
    C = first.retained[:o, o + held].T.copy()  # gradients of the rows as they pull
    M0 = np.zeros((o, o))
    for b, body in enumerate(data.bodies):
        M0[6 * b : 6 * b + 3, 6 * b : 6 * b + 3] = body.mass * np.eye(3)
        M0[6 * b + 3 : 6 * b + 6, 6 * b + 3 : 6 * b + 6] = body.inertia
    modes = np.arange(6 * B, o)
    M0[modes, modes] = 1.0
    rate, rate2 = (
        np.array([_derivative(data.constraints[n].signal, state.time, order) for n in held]) for order in (1, 2)
    )
    V = np.concatenate([np.hstack([given.v, given.w]).ravel(), given.qd[: layout.modes]])
    solved = _constrained(M0, C, np.zeros(o), C @ V - rate)
    if solved is None:
        return None
    V = V - solved[0]
    rigid = V[: 6 * B].reshape(-1, 6)
    state.v, state.w = rigid[:, :3].copy(), rigid[:, 3:].copy()
    state.qd = given.qd.copy()
    state.qd[: layout.modes] = V[6 * B :]
    moving = at(0.0, lam)
    M = at(1.0, lam).retained[:o, :o] - moving.retained[:o, :o]
    force = -moving.residual[:c]
    for unknowns, load in evaluation.loads(system.nodal):
        force[unknowns] += load
    gamma = row_curvature(data, layout, _at_rest(state, False), V)[held]
    solved = _constrained(M, C, force[:o], rate2 - gamma)
    if solved is None:
        return None
    a, lam[held] = solved
    rigid = a[: 6 * B].reshape(-1, 6)
    state.v_rate, state.w_rate = rigid[:, :3].copy(), rigid[:, 3:].copy()
    mass = system.local.mass
    state.qdd = np.concatenate([a[6 * B :], force[o:] / np.where(mass > 0.0, mass, np.inf)])
    state.lam = lam
    return at(0.0, lam, rates=True)


def _constrained(M: np.ndarray, C: np.ndarray, r: np.ndarray, g: np.ndarray) -> tuple[np.ndarray, np.ndarray] | None:
    """x and y of `M x + C^T y = r, C x = g`, by the Schur complement; None if it is singular."""
    CW = np.linalg.solve(M, C.T).T
    free = np.linalg.solve(M, r)
    S = CW @ C.T
    scale = 1.0 / np.sqrt(np.where(np.diag(S) > 0.0, np.diag(S), 1.0))
    if len(S):
        values = np.linalg.eigvalsh(0.5 * (S + S.T) * scale[:, None] * scale)
        if values[0] <= SINGULAR * values[-1]:
            return None
        y = scale * np.linalg.solve(S * scale[:, None] * scale, scale * (C @ free - g))
    else:
        y = np.zeros(0)
    return free - CW.T @ y, y


def _derivative(signal: Any, t: float, order: int) -> float:
    """Derivative of a signal (None: 0) at time t, from its polynomials."""
    if signal is None:
        return 0.0
    breaks, c = signal.polynomial()
    if t < breaks[0]:
        return 0.0
    piece = int(np.clip(np.searchsorted(breaks, t, side="right") - 1, 0, len(c) - 1))
    return float(np.polynomial.Polynomial(c[piece]).deriv(order)(t - breaks[piece]))
