"""Local error of a step, and velocities that agree with the joints.

Error. The update of positions truncates the Taylor series of a motion with acceleration vdot at (beta - 1/6) h^3 vddot,
so that, with vddot = (vdot_1 - vdot_0)/h, the increments of a step are wrong by about

    e = |beta - 1/6| h^2 |vdot_1 - vdot_0|

(Zienkiewicz and Xie 1991). Positions are measured by the body's radius of gyration, turns in rad, modal coordinates by
the displacement at the point of the body that moves most, over the radius of gyration. Stiff local modes follow the
load without inertia and are not in it. A step whose largest e exceeds the one allowed is halved; it may be
doubled when e is below 1/16 of it, since e grows with h^3. A load that begins and ends within one step is not seen.

Projection. Index-3 steps keep the joints at position level; velocities then miss C v = s'(t) by the error of the step.
With the inverse H of the outer matrix [S, C^T; C, ...] the correction

    (dv, mu) = H (0, s' - C v - C_m qdot),      dqdot = -sigma^-1 C_m^T mu

removes what they miss with the least change in the metric of S, which is ACC times the mass to first order in h.
The other quantities of the step follow, else accelerations and reactions would lag by a fraction of the step, an error
of first order: what the velocities define through `v_1 = v_0 + h ((1 - gamma) a_0 + gamma a_1)` is

    da_1 = dv/(gamma h),      dvdot_1 = ACC/VEL dv,      dlambda = mu/VEL,

and M dvdot + C^T dlambda = 0, so that the balance of forces stays.
"""

import warp as wp

from warpffrf_kernels.core import control as k
from warpffrf_kernels.core.access import changed, inout, out
from warpffrf_kernels.core.control import Clock, Control
from warpffrf_kernels.core.model import Model
from warpffrf_kernels.core.scalars import MODULE_OPTIONS, real, sync, vec3
from warpffrf_kernels.linear.outer_solve import solve
from warpffrf_kernels.linear.sparse_factor import Pattern
from warpffrf_kernels.step.balance import gyration_of

wp.set_module_options(MODULE_OPTIONS)


@wp.kernel
def estimate_error(
    models: wp.array(dtype=Model),
    ctl: wp.array(dtype=Control),
    step_error: wp.array(dtype=real),
    v_rate: wp.array2d(dtype=vec3),
    v1_rate: wp.array2d(dtype=vec3),
    omega_rate: wp.array2d(dtype=vec3),
    omega1_rate: wp.array2d(dtype=vec3),
    qd_rate: wp.array2d(dtype=real),
    qd1_rate: wp.array2d(dtype=real),
    clk: inout(wp.array(dtype=Clock)),
):
    """Per world: clk[ERROR], the local error as a fraction of the one allowed; 0 where none is."""
    w = wp.tid()
    model = models[w]
    if ctl[w].attempt == 0:
        return
    clk[w].error = real(0.0)
    if step_error[w] <= real(0.0) or ctl[w].mode != k.DYNAMIC:
        return
    worst = real(0.0)
    b = int(0)
    while b < model.bodies.count:
        gyration = gyration_of(model.bodies.inertia[b], model.bodies.mass[b])
        worst = wp.max(worst, wp.length(v1_rate[w, b] - v_rate[w, b]) / gyration)
        worst = wp.max(worst, wp.length(omega1_rate[w, b] - omega_rate[w, b]))
        n = model.bodies.modal_start[b]
        while n < model.bodies.modal_start[b + 1]:
            worst = wp.max(worst, wp.abs(qd1_rate[w, n] - qd_rate[w, n]) * model.modes.reach[n] / gyration)
            n += 1
        b += 1
    h = clk[w].h
    clk[w].error = wp.abs(clk[w].outer.beta - real(1.0) / real(6.0)) * h * h * worst / step_error[w]


@wp.kernel
def missed_rates(
    models: wp.array(dtype=Model),
    ctl: wp.array(dtype=Control),
    wanted: wp.array(dtype=int),
    C: wp.array3d(dtype=real),
    C_modal: wp.array3d(dtype=real),
    v1: wp.array2d(dtype=vec3),
    omega1: wp.array2d(dtype=vec3),
    qd1: wp.array2d(dtype=real),
    drive_rate: wp.array3d(dtype=real),
    missed: out(wp.array2d(dtype=real)),
):
    """Lanes over rows: s' - C v of constraint rows, 0 of springs."""
    w, lane = wp.tid()
    model = models[w]
    if ctl[w].attempt == 0 or ctl[w].mode != k.DYNAMIC or wanted[w] == 0:
        return
    row = lane
    while row < model.rows.count:
        value = real(0.0)
        if model.rows.rigid[row] != 0:
            value = drive_rate[w, 1, row]
            b = int(0)
            while b < model.bodies.count:
                for i in range(3):
                    value -= C[w, row, 6 * b + i] * v1[w, b][i] + C[w, row, 6 * b + 3 + i] * omega1[w, b][i]
                b += 1
            n = int(0)
            while n < model.modes.count:
                value -= C_modal[w, row, n] * qd1[w, n]
                n += 1
        missed[w, row] = value
        row += wp.block_dim()


@wp.kernel
def project_velocities(
    models: wp.array(dtype=Model),
    patterns: wp.array(dtype=Pattern),
    ctl: wp.array(dtype=Control),
    wanted: wp.array(dtype=int),
    missed: wp.array(dtype=real),
    tangent: wp.array3d(dtype=real),
    hold: wp.array3d(dtype=real),
    C_modal: wp.array3d(dtype=real),
    receptance: wp.array2d(dtype=real),
    clk: wp.array(dtype=Clock),
    scaling: inout(wp.array2d(dtype=real)),
    pivots: inout(wp.array2d(dtype=int)),
    factor: inout(wp.array(dtype=real)),
    vector: inout(wp.array(dtype=real)),
    lines: inout(wp.array(dtype=real)),
    fallback: inout(wp.array2d(dtype=int)),
    work: inout(wp.array3d(dtype=real)),
    inverse_transposed: inout(wp.array(dtype=real)),
    right: inout(wp.array(dtype=real)),
    change: inout(wp.array(dtype=real)),
    modal_change: out(wp.array(dtype=real)),
    v1: changed(wp.array2d(dtype=vec3)),
    omega1: changed(wp.array2d(dtype=vec3)),
    qd1: changed(wp.array2d(dtype=real)),
    v1_rate: changed(wp.array2d(dtype=vec3)),
    omega1_rate: changed(wp.array2d(dtype=vec3)),
    qd1_rate: changed(wp.array2d(dtype=real)),
    lam: inout(wp.array2d(dtype=real)),
):
    """One block per world: the correction of the module, added to velocities, accelerations and multipliers at the end
    of the step."""
    w, lane = wp.tid()
    model = models[w]
    if ctl[w].attempt == 0 or ctl[w].mode != k.DYNAMIC or wanted[w] == 0:
        return
    N = model.outer.count
    i = lane
    while i < N:
        right[w * N + i] = real(0.0)
        if i >= model.outer.row_offset:
            right[w * N + i] = missed[w * model.rows.count + i - model.outer.row_offset]
        i += wp.block_dim()
    sync()
    solve(
        model, patterns[0], w, lane, 1, tangent, right, hold, 0, scaling, pivots, factor, vector, lines, fallback, work,
        inverse_transposed, change,
    )  # fmt: skip
    sync()
    rise = clk[w].outer.acc / clk[w].outer.vel
    row = lane
    while row < model.rows.count:
        if model.rows.rigid[row] != 0:
            lam[w, row] = lam[w, row] + change[w * N + model.outer.row_offset + row] / clk[w].outer.vel
        row += wp.block_dim()
    b = lane
    while b < model.bodies.count:
        o = w * N + 6 * b
        dv = vec3(change[o], change[o + 1], change[o + 2])
        domega = vec3(change[o + 3], change[o + 4], change[o + 5])
        v1[w, b] = v1[w, b] + dv
        omega1[w, b] = omega1[w, b] + domega
        v1_rate[w, b] = v1_rate[w, b] + rise * dv
        omega1_rate[w, b] = omega1_rate[w, b] + rise * domega
        b += wp.block_dim()
    n = lane
    while n < model.modes.count:
        value = real(0.0)
        if model.modes.dense_of[n] >= 0:
            value = change[w * N + 6 * model.bodies.count + model.modes.dense_of[n]]
        else:
            row = int(0)
            while row < model.rows.count:
                value -= receptance[w, n] * C_modal[w, row, n] * change[w * N + model.outer.row_offset + row]
                row += 1
        modal_change[w * model.modes.count + n] = value
        qd1[w, n] = qd1[w, n] + value
        qd1_rate[w, n] = qd1_rate[w, n] + rise * value
        n += wp.block_dim()


@wp.kernel
def correct_algorithmic(
    models: wp.array(dtype=Model),
    ctl: wp.array(dtype=Control),
    wanted: wp.array(dtype=int),
    clk: wp.array(dtype=Clock),
    change: wp.array(dtype=real),
    modal_change: wp.array(dtype=real),
    v_alg: inout(wp.array2d(dtype=vec3)),
    omega_alg: inout(wp.array2d(dtype=vec3)),
    qd_alg: inout(wp.array2d(dtype=real)),
):
    """One block per world: the algorithmic accelerations of an accepted step, as its projected velocities have them."""
    w, lane = wp.tid()
    model = models[w]
    if ctl[w].accept == 0 or ctl[w].mode != k.DYNAMIC or wanted[w] == 0:
        return
    share = real(1.0) / (clk[w].outer.gamma * clk[w].h)
    b = lane
    while b < model.bodies.count:
        o = w * model.outer.count + 6 * b
        v_alg[w, b] = v_alg[w, b] + share * vec3(change[o], change[o + 1], change[o + 2])
        omega_alg[w, b] = omega_alg[w, b] + share * vec3(change[o + 3], change[o + 4], change[o + 5])
        b += wp.block_dim()
    n = lane
    while n < model.modes.count:
        qd_alg[w, n] = qd_alg[w, n] + share * modal_change[w * model.modes.count + n]
        n += wp.block_dim()
