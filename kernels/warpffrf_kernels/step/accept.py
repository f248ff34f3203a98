"""Quantities of an accepted attempt become those of the state; multipliers of a rejected one are restored."""

import warp as wp

from warpffrf_kernels.core import control as k
from warpffrf_kernels.core.declaration import kernel
from warpffrf_kernels.core.integration import EXACT, OUTER, algorithmic, coefficients_of, predicted, rule_of
from warpffrf_kernels.core.run import Run
from warpffrf_kernels.core.scalars import MODULE_OPTIONS, real, vec3
from warpffrf_kernels.core.scratch import ImpulsiveContact, Residuals, Trial
from warpffrf_kernels.core.state import LoadState, MotionState

wp.set_module_options(MODULE_OPTIONS)


@wp.func
def is_nearer(mean: vec3, predicted: vec3, found: vec3) -> int:
    """Whether the increment found is nearer to that of the mean velocity of the step before than to the predicted."""
    return int(wp.length(mean - found) < wp.length(predicted - found))


@kernel
def keep_bodies(run: Run, trial: Trial, impulses: ImpulsiveContact, state: MotionState):
    w, lane = wp.tid()
    model = run.models[w]
    if run.ctl[w].accept == 0:
        return
    b = lane
    while b < state.r.shape[1]:
        mode = run.ctl[w].mode
        acc = trial.v1_rate[w, b]
        spin_rate = trial.omega1_rate[w, b]
        if mode == k.DYNAMIC or mode == k.STATIC or mode == k.LOADING:
            state.r[w, b] = trial.r1[w, b]
            state.p[w, b] = trial.p1[w, b]
        h = run.clk[w].h
        state.steady[w, b, 0] = 0
        state.steady[w, b, 1] = 0
        if mode == k.DYNAMIC:
            rule = run.clk[w].retained
            p = predicted(h, rule, state.v[w, b], impulses.v_rate0[w, b], impulses.v_alg0[w, b])
            state.steady[w, b, 0] = is_nearer(h * state.v_mean[w, b], p, trial.dx[w, b])
            p = predicted(h, rule, state.omega[w, b], impulses.omega_rate0[w, b], impulses.omega_alg0[w, b])
            state.steady[w, b, 1] = is_nearer(h * state.omega_mean[w, b], p, trial.psi[w, b])
            state.v_mean[w, b] = trial.dx[w, b] / h
            state.omega_mean[w, b] = trial.psi[w, b] / h
        a_t = algorithmic(h, run.clk[w].retained, trial.dx[w, b], state.v[w, b], impulses.v_alg0[w, b])
        a_r = algorithmic(h, run.clk[w].retained, trial.psi[w, b], state.omega[w, b], impulses.omega_alg0[w, b])
        if mode == k.DYNAMIC and model.pairs.count > 0:
            a_t += impulses.v_rest[w, b]
            a_r += impulses.omega_rest[w, b]
        if mode == k.START:
            a_t = acc
            a_r = spin_rate
        if mode == k.DYNAMIC or mode == k.START:
            state.v_rate[w, b] = acc
            state.omega_rate[w, b] = spin_rate
            state.v_alg[w, b] = a_t
            state.omega_alg[w, b] = a_r
        if mode == k.DYNAMIC or mode == k.PROJECT:
            state.v[w, b] = trial.v1[w, b]
            state.omega[w, b] = trial.omega1[w, b]
        if mode == k.DYNAMIC:
            state.turned[w, b] = wp.max(state.turned[w, b], wp.length(trial.omega1[w, b]))
        if mode == k.START:  # PROJECT found the velocity at the end of its tiny step: back to its start
            state.v[w, b] = state.v[w, b] - h * trial.v1_rate[w, b]
            state.omega[w, b] = state.omega[w, b] - h * trial.omega1_rate[w, b]
        b += wp.block_dim()


@kernel
def keep_modes(
    run: Run, trial: Trial, impulses: ImpulsiveContact, state: MotionState, loads: LoadState, q1: wp.array2d(dtype=real)
):
    w, lane = wp.tid()
    model = run.models[w]
    if run.ctl[w].accept == 0:
        return
    n = lane
    while n < state.q.shape[1]:
        mode = run.ctl[w].mode
        loads.modal_load[w, 0, n] = loads.modal_load[w, 1, n]
        if mode == k.DYNAMIC or mode == k.STATIC or mode == k.LOADING:
            state.q[w, n] = q1[w, n]
        h = run.clk[w].h
        rule = rule_of(model, run, w, n)
        state.steady_mode[w, n] = 0
        if mode == k.DYNAMIC and rule == OUTER:
            p = predicted(
                h, coefficients_of(run.clk, w, rule), vec3(state.qd[w, n]), vec3(impulses.qd_rate0[w, n]),
                vec3(impulses.qd_alg0[w, n]),
            )  # fmt: skip
            state.steady_mode[w, n] = is_nearer(vec3(h * state.qd_mean[w, n]), p, vec3(trial.dq[w, n]))
            state.qd_mean[w, n] = trial.dq[w, n] / h
        a = algorithmic(
            h,
            coefficients_of(run.clk, w, rule),
            vec3(trial.dq[w, n]),
            vec3(state.qd[w, n]),
            vec3(impulses.qd_alg0[w, n]),
        )[0]
        rate = trial.qd1_rate[w, n]
        if mode == k.DYNAMIC and model.pairs.count > 0:
            a += impulses.qd_rest[w, n]
        if mode == k.START or rule == EXACT:
            a = rate
        if mode == k.DYNAMIC or mode == k.START:
            state.qd_rate[w, n] = rate
            state.qd_alg[w, n] = a
        if mode == k.DYNAMIC or mode == k.PROJECT:
            state.qd[w, n] = trial.qd1[w, n]
        if mode == k.START:
            state.qd[w, n] = state.qd[w, n] - h * trial.qd1_rate[w, n]
        n += wp.block_dim()


@kernel
def keep_rest(run: Run, residuals: Residuals, loads: LoadState):
    """Lanes over rows, forces, bodies, modes and lines: accepts or restores the remaining quantities."""
    w, lane = wp.tid()
    model = run.models[w]
    if run.ctl[w].attempt == 0:
        return
    accept = run.ctl[w].accept != 0 and run.ctl[w].mode != k.PROJECT  # its multipliers are impulses over the tiny step
    row = lane
    while row < model.rows.count:
        if accept:
            loads.lam0[w, row] = loads.lam[w, row]
            loads.drive_rate[w, 0, row] = loads.drive_rate[w, 1, row]
            loads.stretch[w, row] = residuals.coordinate[w, row]
        else:
            loads.lam[w, row] = loads.lam0[w, row]
        row += wp.block_dim()
    if not accept:
        return
    i = lane
    while i < model.external[0].forces.count:
        loads.applied[w, 0, i] = loads.applied[w, 1, i]
        loads.applied_at[w, 0, i] = loads.applied_at[w, 1, i]
        i += wp.block_dim()
    i = lane
    while i < 6 * model.bodies.count:
        loads.load[w, 0, i] = loads.load[w, 1, i]
        i += wp.block_dim()
    i = lane
    while i < model.modes.count:
        loads.load_on_modes[w, 0, i] = loads.load_on_modes[w, 1, i]
        i += wp.block_dim()
    i = lane
    while i < k.LINES:
        run.energy[w, 0, i] = run.energy[w, 1, i]
        i += wp.block_dim()
