"""Local error of a step, and projection of velocities onto the joint constraints.

Error. The update of positions truncates the Taylor series of a motion with acceleration vdot at (beta - 1/6) h^3 vddot,
so that, with vddot = (vdot_1 - vdot_0)/h, the error of the increments of a step is about

    e = |beta - 1/6| h^2 |vdot_1 - vdot_0|

(Zienkiewicz and Xie 1991). Positions are scaled by the body's radius of gyration, rotations are in rad, modal
coordinates are scaled as the displacement at the point of the body that moves most over the radius of gyration. Stiff
local modes follow the load without inertia and are excluded. A step whose largest e exceeds the allowed value is
halved; it may be doubled when e is below 1/16 of it, since e grows with h^3. A load that begins and ends within one
step is not detected.

Projection. Index-3 steps satisfy the joints at position level; velocities then violate C v = s'(t) by the error of the
step. With the inverse H of the retained matrix [S, C^T; C, ...] the correction

    (dv, mu) = H (0, s' - C v - C_m qdot),      dqdot = -sigma^-1 C_m^T mu

removes this violation with the least change in the metric of S, which is ACC times the mass to first order in h. The
other quantities of the step are corrected consistently, otherwise accelerations and reactions would lag by a fraction
of the step, an error of first order: from `v_1 = v_0 + h ((1 - gamma) a_0 + gamma a_1)`,

    da_1 = dv/(gamma h),      dvdot_1 = ACC/VEL dv,      dlambda = mu/VEL,

and M dvdot + C^T dlambda = 0, so that the balance of forces is preserved.
"""

import warp as wp

from warpffrf_kernels.core import control as k
from warpffrf_kernels.core.declaration import kernel
from warpffrf_kernels.core.run import Run
from warpffrf_kernels.core.scalars import MODULE_OPTIONS, real, sync, vec3
from warpffrf_kernels.core.scratch import Residuals, RetainedSystem, Trial
from warpffrf_kernels.core.state import LoadState, MotionState
from warpffrf_kernels.linear.retained_solve import solve
from warpffrf_kernels.linear.sparse_factor import Pattern
from warpffrf_kernels.step.balance import gyration_of

wp.set_module_options(MODULE_OPTIONS)


@kernel
def estimate_error(run: Run, state: MotionState, trial: Trial):
    """Per world: clk[ERROR], the local error as a fraction of the allowed one; 0 if no limit is set."""
    w = wp.tid()
    model = run.models[w]
    if run.ctl[w].attempt == 0:
        return
    run.clk[w].error = real(0.0)
    if run.step_error[w] <= real(0.0) or run.ctl[w].mode != k.DYNAMIC:
        return
    worst = real(0.0)
    b = int(0)
    while b < model.bodies.count:
        gyration = gyration_of(model.bodies.inertia[b], model.bodies.mass[b])
        worst = wp.max(worst, wp.length(trial.v1_rate[w, b] - state.v_rate[w, b]) / gyration)
        worst = wp.max(worst, wp.length(trial.omega1_rate[w, b] - state.omega_rate[w, b]))
        n = model.bodies.modal_start[b]
        while n < model.bodies.modal_start[b + 1]:
            worst = wp.max(worst, wp.abs(trial.qd1_rate[w, n] - state.qd_rate[w, n]) * model.modes.reach[n] / gyration)
            n += 1
        b += 1
    h = run.clk[w].h
    run.clk[w].error = wp.abs(run.clk[w].retained.beta - real(1.0) / real(6.0)) * h * h * worst / run.step_error[w]


@kernel
def missed_rates(run: Run, residuals: Residuals, trial: Trial, loads: LoadState, C_modal: wp.array3d(dtype=real)):
    """Lanes over rows: s' - C v of constraint rows, 0 of springs."""
    w, lane = wp.tid()
    model = run.models[w]
    if run.ctl[w].attempt == 0 or run.ctl[w].mode != k.DYNAMIC or run.project[w] == 0:
        return
    row = lane
    while row < model.rows.count:
        value = real(0.0)
        if model.rows.rigid[row] != 0:
            value = loads.drive_rate[w, 1, row]
            b = int(0)
            while b < model.bodies.count:
                for i in range(3):
                    value -= (
                        residuals.C[w, row, 6 * b + i] * trial.v1[w, b][i]
                        + residuals.C[w, row, 6 * b + 3 + i] * trial.omega1[w, b][i]
                    )
                b += 1
            n = int(0)
            while n < model.modes.count:
                value -= C_modal[w, row, n] * trial.qd1[w, n]
                n += 1
        residuals.missed[w, row] = value
        row += wp.block_dim()


@kernel
def project_velocities(
    run: Run, system: RetainedSystem, trial: Trial, loads: LoadState, patterns: wp.array(dtype=Pattern),
    missed: wp.array(dtype=real), C_modal: wp.array3d(dtype=real), receptance: wp.array2d(dtype=real),
):  # fmt: skip
    """One block per world: the correction of the module, added to velocities, accelerations and multipliers at the end
    of the step."""
    w, lane = wp.tid()
    model = run.models[w]
    if run.ctl[w].attempt == 0 or run.ctl[w].mode != k.DYNAMIC or run.project[w] == 0:
        return
    N = model.retained.count
    i = lane
    while i < N:
        system.projection_rhs[w * N + i] = real(0.0)
        if i >= model.retained.row_offset:
            system.projection_rhs[w * N + i] = missed[w * model.rows.count + i - model.retained.row_offset]
        i += wp.block_dim()
    sync()
    solve(
        model, patterns[0], w, lane, 1, system.tangent, system.projection_rhs, system.hold, 0, system.scaling,
        system.pivots, system.sparse_factor, system.sparse_vector, system.sparse_lines, system.fallback,
        system.elimination, system.inverse_transposed, system.change,
    )  # fmt: skip
    sync()
    rise = run.clk[w].retained.acc / run.clk[w].retained.vel
    row = lane
    while row < model.rows.count:
        if model.rows.rigid[row] != 0:
            loads.lam[w, row] = (
                loads.lam[w, row] + system.change[w * N + model.retained.row_offset + row] / run.clk[w].retained.vel
            )
        row += wp.block_dim()
    b = lane
    while b < model.bodies.count:
        o = w * N + 6 * b
        dv = vec3(system.change[o], system.change[o + 1], system.change[o + 2])
        domega = vec3(system.change[o + 3], system.change[o + 4], system.change[o + 5])
        trial.v1[w, b] = trial.v1[w, b] + dv
        trial.omega1[w, b] = trial.omega1[w, b] + domega
        trial.v1_rate[w, b] = trial.v1_rate[w, b] + rise * dv
        trial.omega1_rate[w, b] = trial.omega1_rate[w, b] + rise * domega
        b += wp.block_dim()
    n = lane
    while n < model.modes.count:
        value = real(0.0)
        if model.modes.dense_of[n] >= 0:
            value = system.change[w * N + 6 * model.bodies.count + model.modes.dense_of[n]]
        else:
            row = int(0)
            while row < model.rows.count:
                value -= receptance[w, n] * C_modal[w, row, n] * system.change[w * N + model.retained.row_offset + row]
                row += 1
        system.modal_step[w * model.modes.count + n] = value
        trial.qd1[w, n] = trial.qd1[w, n] + value
        trial.qd1_rate[w, n] = trial.qd1_rate[w, n] + rise * value
        n += wp.block_dim()


@kernel
def correct_algorithmic(run: Run, system: RetainedSystem, state: MotionState):
    """One block per world: algorithmic accelerations of an accepted step, consistent with its projected velocities."""
    w, lane = wp.tid()
    model = run.models[w]
    if run.ctl[w].accept == 0 or run.ctl[w].mode != k.DYNAMIC or run.project[w] == 0:
        return
    share = real(1.0) / (run.clk[w].retained.gamma * run.clk[w].h)
    b = lane
    while b < model.bodies.count:
        o = w * model.retained.count + 6 * b
        state.v_alg[w, b] = state.v_alg[w, b] + share * vec3(
            system.change[o], system.change[o + 1], system.change[o + 2]
        )
        state.omega_alg[w, b] = state.omega_alg[w, b] + share * vec3(
            system.change[o + 3], system.change[o + 4], system.change[o + 5]
        )
        b += wp.block_dim()
    n = lane
    while n < model.modes.count:
        state.qd_alg[w, n] = state.qd_alg[w, n] + share * system.modal_step[w * model.modes.count + n]
        n += wp.block_dim()
