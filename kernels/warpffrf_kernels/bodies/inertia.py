"""Inertia of a deforming body: coupling of rotation and deformation, for the modes that carry it.

With the body frame in the centre of mass and modes without linear or angular momentum (Tisserand) the kinetic energy is

    T = m v.v/2 + w.J(q) w/2 + w.h(q, qdot) + |qdot|^2/2,
    J = J0 + sum_i q_i J1_i + sum_ij q_i q_j J2_ij,        h = sum_ij q_i qdot_j G_ij,      G_ij = -G_ji,

w in body axes. With the sums over the first k modes of a body

    P_j = J1_j + 2 sum_i J2_ij q_i    (slope of J by q_j),    P'_j = 2 sum_i J2_ij qdot_i,
    g_j = sum_i q_i G_ij,   g'_j = sum_i qdot_i G_ij,   g''_j = sum_i qddot_i G_ij

the angular momentum is L = J w + h, h = sum_j g_j qdot_j, and (Lagrange) these terms add to the unbalanced forces

    torque    dJ wdot + (sum_j qdot_j P_j) w + sum_j g_j qddot_j + w x (dJ w + h),       dJ = J - J0,
    mode j    2 w.g'_j + wdot.g_j - w.P_j w/2          (Coriolis, Euler, centrifugal).

Their change with dw = VEL dpsi, dwdot = ACC dpsi, dqdot = VEL dq, dqddot = ACC dq gives the blocks of the tangent;
modes that carry inertia are therefore retained unknowns in addition to the rigid ones, "dense", with zero receptance.
So are those of a body that is loaded on several surfaces; the others stay diagonal and are condensed.

The inertia level of a body states which of J1, J2, G it has: the tables of the others are zero. Geometric stiffening by
rotation is included as J2 - K_c (the shortening of a bent body moves its mass), that by loads at an interface as the
second-order motion -q.K_k q/2 of the interface: its derivative is `slope`, and the force of a row on the modes then
contains -F_k K_k q.
"""

import warp as wp

from warpffrf_kernels.bodies.interfaces import line_of, marker_of
from warpffrf_kernels.core.declaration import kernel
from warpffrf_kernels.core.model import Model
from warpffrf_kernels.core.rotation import hat
from warpffrf_kernels.core.run import Run
from warpffrf_kernels.core.scalars import MODULE_OPTIONS, axpy, dot, mat33, real, vec3
from warpffrf_kernels.core.scratch import Residuals, RetainedSystem, Trial
from warpffrf_kernels.core.state import LoadState

wp.set_module_options(MODULE_OPTIONS)


@wp.func
def symmetric(a: wp.array3d(dtype=real), w: int, d: int, at: int) -> mat33:
    return mat33(
        a[w, d, at], a[w, d, at + 3], a[w, d, at + 5],
        a[w, d, at + 3], a[w, d, at + 1], a[w, d, at + 4],
        a[w, d, at + 5], a[w, d, at + 4], a[w, d, at + 2],
    )  # fmt: skip


@wp.func
def first_order(model: Model, d: int) -> mat33:
    a = model.dense.first
    return mat33(a[d, 0], a[d, 3], a[d, 5], a[d, 3], a[d, 1], a[d, 4], a[d, 5], a[d, 4], a[d, 2])


@wp.func
def triple(a: wp.array3d(dtype=real), w: int, d: int, at: int) -> vec3:
    return vec3(a[w, d, at], a[w, d, at + 1], a[w, d, at + 2])


@kernel
def uncondense(run: Run, system: RetainedSystem, receptance: wp.array2d(dtype=real)):
    """Lanes over dense modes: their lines and columns of their body's block of the tangent, diagonal at this point;
    none of them is condensed."""
    w, lane = wp.tid()
    model = run.models[w]
    if run.ctl[w].run == 0 or run.ctl[w].moved == 0:
        return
    d = lane
    while d < model.dense.count:
        b = model.dense.body[d]
        at = 6 * model.bodies.count + d
        for i in range(6):
            system.tangent[w, 6 * b + i, at] = real(0.0)
            system.tangent[w, at, 6 * b + i] = real(0.0)
        i = int(0)
        while i < model.bodies.dense_count[b]:
            system.tangent[w, at, 6 * model.bodies.count + model.bodies.dense_start[b] + i] = real(0.0)
            i += 1
        m = model.dense.mode[d]
        system.tangent[w, at, at] = real(1.0) / receptance[w, m]
        receptance[w, m] = real(0.0)
        d += wp.block_dim()


@kernel
def sum_modes(run: Run, trial: Trial, qd1: wp.array(dtype=real), qd1_rate: wp.array(dtype=real)):
    """Lanes over dense modes: P, P', g, g', g'' of each."""
    w, lane = wp.tid()
    model = run.models[w]
    if run.ctl[w].run == 0 or run.ctl[w].moved == 0:
        return
    d = lane
    while d < model.dense.count:
        b = model.dense.body[d]
        count = model.bodies.inertia_count[b]
        start = w * model.modes.count + model.bodies.modal_start[b]
        if d - model.bodies.dense_start[b] >= count:
            d += wp.block_dim()
            continue
        at = model.bodies.inertia_start[b] + (d - model.bodies.dense_start[b]) * count
        stride = count * count
        for c in range(6):
            row = at + c * stride
            trial.inertia_sums[w, d, c] = model.dense.first[d, c] + real(2.0) * dot(
                count, model.dense.table, row, trial.q1, start
            )
            trial.inertia_sums[w, d, 6 + c] = real(2.0) * dot(count, model.dense.table, row, qd1, start)
        for c in range(3):
            row = at + (6 + c) * stride
            trial.inertia_sums[w, d, 12 + c] = dot(count, model.dense.table, row, trial.q1, start)
            trial.inertia_sums[w, d, 15 + c] = dot(count, model.dense.table, row, qd1, start)
            trial.inertia_sums[w, d, 18 + c] = dot(count, model.dense.table, row, qd1_rate, start)
        d += wp.block_dim()


@kernel
def add_inertia(run: Run, trial: Trial, residuals: Residuals, system: RetainedSystem, q1: wp.array2d(dtype=real)):
    """Lanes over bodies: unbalanced torque and modal forces, the dense blocks of the tangent except their pair terms
    (`couple_modes`), and the kinetic energy of these terms.
    """
    w, lane = wp.tid()
    model = run.models[w]
    if run.ctl[w].run == 0 or run.ctl[w].moved == 0:
        return
    half = real(0.5)
    acc = run.clk[w].retained.acc
    vel = run.clk[w].retained.vel
    b = lane
    while b < model.bodies.count:
        trial.extra_energy[w, b] = real(0.0)
        count = model.bodies.inertia_count[b]
        if count > 0:
            spin = trial.omega1[w, b]
            turn = trial.omega1_rate[w, b]
            dJ = mat33(real(0.0))
            dJ_rate = mat33(real(0.0))
            h = vec3(real(0.0))
            h_rate = vec3(real(0.0))
            n = model.bodies.modal_start[b]
            first = model.bodies.dense_start[b]
            i = int(0)
            while i < count:
                d = first + i
                P = symmetric(trial.inertia_sums, w, d, 0)
                g = triple(trial.inertia_sums, w, d, 12)
                dJ += (half * q1[w, n + i]) * (P + first_order(model, d))
                dJ_rate += trial.qd1[w, n + i] * P
                h += trial.qd1[w, n + i] * g
                h_rate += trial.qd1_rate[w, n + i] * g
                i += 1
            extra = dJ * spin
            t = dJ * turn + dJ_rate * spin + h_rate + wp.cross(spin, extra + h)
            trial.extra_energy[w, b] = half * wp.dot(spin, extra) + wp.dot(spin, h)
            Ti = trial.psi_inverse[w, b]
            S = (acc * dJ + vel * (hat(spin) * dJ - hat(extra + h) + dJ_rate)) * Ti
            o = 6 * b + 3
            for r in range(3):
                residuals.residual[w, o + r] = residuals.residual[w, o + r] + t[r]
                for c in range(3):
                    system.tangent[w, o + r, o + c] = system.tangent[w, o + r, o + c] + S[r, c]
            i = int(0)
            while i < count:
                d = first + i
                m = n + i
                P = symmetric(trial.inertia_sums, w, d, 0)
                g = triple(trial.inertia_sums, w, d, 12)
                g1 = triple(trial.inertia_sums, w, d, 15)
                g2 = triple(trial.inertia_sums, w, d, 18)
                P_spin = P * spin
                value = real(2.0) * wp.dot(spin, g1) + wp.dot(turn, g) - half * wp.dot(spin, P_spin)
                residuals.modal_residual[w, m] = residuals.modal_residual[w, m] + value
                column = P * turn + vel * P_spin + symmetric(trial.inertia_sums, w, d, 6) * spin - g2 + acc * g
                column += wp.cross(spin, P_spin + vel * g - g1)
                line = vel * (real(2.0) * g1 - P_spin) + acc * g
                line = wp.transpose(Ti) * line
                at = 6 * model.bodies.count + d
                for r in range(3):
                    system.tangent[w, o + r, at] = column[r]
                    system.tangent[w, at, o + r] = line[r]
                i += 1
        b += wp.block_dim()


@kernel
def couple_modes(run: Run, trial: Trial, loads: LoadState, residuals: Residuals, tangent: wp.array(dtype=real)):
    """Per world, lanes over the entries of a line, line by line: 2 VEL w.G_ij + wdot.G_ij - w.J2_ij w in line j,
    column i, and the geometric stiffness of the forces at interfaces.
    """
    w, _ = wp.tid()
    model = run.models[w]
    if run.ctl[w].run == 0 or run.ctl[w].moved == 0 or run.ctl[w].refresh == 0:
        return
    d = int(0)
    N = model.retained.count
    while d < model.dense.count:
        b = model.dense.body[d]
        count = model.bodies.inertia_count[b]
        if d - model.bodies.dense_start[b] >= count:
            d += 1
            continue
        s = trial.omega1[w, b]
        line = (w * N + 6 * model.bodies.count + d) * N + 6 * model.bodies.count + model.bodies.dense_start[b]
        at = model.bodies.inertia_start[b] + (d - model.bodies.dense_start[b]) * count
        stride = count * count
        two = real(2.0)
        for c in range(3):
            axpy(count, -s[c] * s[c], model.dense.table, at + c * stride, tangent, line)
            along = two * run.clk[w].retained.vel * s[c] + trial.omega1_rate[w, b][c]
            axpy(count, along, model.dense.table, at + (6 + c) * stride, tangent, line)
        axpy(count, -two * s[0] * s[1], model.dense.table, at + 3 * stride, tangent, line)
        axpy(count, -two * s[1] * s[2], model.dense.table, at + 4 * stride, tangent, line)
        axpy(count, -two * s[2] * s[0], model.dense.table, at + 5 * stride, tangent, line)
        row = int(0)
        while row < model.rows.count:
            for side in range(2):
                marker = marker_of(model, row, side)
                f = model.markers.interface[marker]
                if f >= 0 and model.markers.body[marker] == b and model.interfaces.stiffening_start[f] >= 0:
                    begin = model.interfaces.stiffening_start[f] + (d - model.bodies.dense_start[b]) * count
                    for c in range(6):
                        pull = -loads.lam[w, row] * residuals.row_pull[w, 2 * row + side, c]
                        if pull != real(0.0):  # most are zero along the axes of the body
                            axpy(count, pull, model.interfaces.stiffening, begin + c * stride, tangent, line)
            row += 1
        d += 1


@kernel
def shorten_interfaces(run: Run, q1: wp.array(dtype=real), slope: wp.array(dtype=real)):
    """Lanes over interfaces: derivative of their motion by the modes, Phi - K_k q if loads stiffen the body."""
    w, lane = wp.tid()
    model = run.models[w]
    if run.ctl[w].run == 0 or run.ctl[w].moved == 0:
        return
    f = lane
    while f < model.interfaces.count:
        start = model.interfaces.stiffening_start[f]
        if start >= 0:
            b = model.interfaces.body[f]
            count = model.bodies.inertia_count[b]
            modes = w * model.modes.count + model.bodies.modal_start[b]
            for c in range(6):
                line = line_of(model, w, f) + c * model.interfaces.width
                i = int(0)
                while i < count:
                    slope[line + i] = model.interfaces.modes[(6 * f + c) * model.interfaces.width + i]
                    i += 1
                i = int(0)
                while i < count:  # K_c is symmetric: whole lines are added
                    axpy(
                        count, -q1[modes + i], model.interfaces.stiffening, start + (c * count + i) * count, slope, line
                    )
                    i += 1
        f += wp.block_dim()
