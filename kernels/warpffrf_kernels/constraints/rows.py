"""Joint constraints, prescribed motion and springs: one scalar row each.

A row is a function c(x, t) of two markers (joint frames) a and b with axes `u_i` (of a), `w_j` (of b) and positions
x_a, x_b:

    TRANSLATION   c = u_i . (x_b - x_a) - s(t)
    DIRECTION     c = u_i . w_j
    ANGLE         c = angle of w_j about u_i from u_j, minus s(t), in (-pi, pi]: no counting of revolutions required
    SECOND_ANGLE  the same with the axes of the other side: angle of w_j about w_i from u_j (universal joints)
    TWIST         c = rotation of b relative to a about the axis i, for any tilt, minus s(t), in (-pi, pi]
    DISTANCE      c = |x_b - x_a| - s(t)

with s the signal of the row (0 without one). Every variation has the form `f.(dx_b - dx_a) + t.(dTheta_b - dTheta_a)`,
where dx are material displacements of the point x_b carried by either body and dTheta their rotations, so a row exerts
the wrench (f, t) at x_b on b and the opposite on a: action equals reaction by construction.
    TRANSLATION: f = u_i, t = 0;  DIRECTION: f = 0, t = w_j x u_i;  DISTANCE: f = (x_b - x_a)/|x_b - x_a|, t = 0;
    ANGLE: f = 0, t = u_i where w_j is perpendicular to it (in general, and for SECOND_ANGLE and TWIST:
                  `model/joints/base.py`).
    BUSHING       c = v.d + z.phi of the row's vector (v, z), with d = A_a^T (x_b - x_a) and exp(phi^) = A_a^T A_b:
                  f = A_a v, t = A_a T(phi)^-1 z, since dphi = T(phi)^-T A_a^T (dTheta_b - dTheta_a).
An angle of a spring counts its revolutions.

A constraint row requires c = 0 and has the multiplier lambda, generalized force -C^T lambda. A spring row has
`lambda = k c + d cdot + preload`; divided by its effective stiffness `k_e = k + d VEL` it is a constraint row with the
compliance 1/k_e on its diagonal, so that springs on flexible interfaces need no special treatment (the modes stay
diagonal). Nonlinear parts are added: `characteristics`.

A marker on a flexible rigid interface moves with the interface: x = r + A (X + u + theta x (X - X_if)), axes A
exp(theta^) L, with (u, theta) = Phi_if q, plus -q.K q/2 if loads stiffen the body (`interfaces`).
"""

import warp as wp

from warpffrf_kernels.bodies.interfaces import (
    add_load,
    arm_on_interface,
    axes_on_interface,
    line_of,
    modal_line,
    rotation_of,
    translation_of,
)
from warpffrf_kernels.constraints.characteristics import characteristic, firm
from warpffrf_kernels.core import control as k
from warpffrf_kernels.core.declaration import kernel, kernel_in_place
from warpffrf_kernels.core.model import Model
from warpffrf_kernels.core.rotation import rotation_vector, tangent_inverse
from warpffrf_kernels.core.run import Run
from warpffrf_kernels.core.scalars import MODULE_OPTIONS, dot, real, vec3
from warpffrf_kernels.core.scratch import Residuals, Trial
from warpffrf_kernels.core.state import LoadState

wp.set_module_options(MODULE_OPTIONS)

TURN = wp.constant(wp.float64(6.283185307179586))  # 2 pi


@wp.func
def evaluate_signal(model: Model, s: int, t: real, order: int) -> real:
    """Value (order 0) or first derivative (order 1) of signal s at time t."""
    first = model.signals.start[s]
    last = model.signals.start[s + 1] - 1
    piece = first
    while piece < last and t >= model.signals.breaks[piece + 1]:
        piece += 1
    x = wp.max(t - model.signals.breaks[piece], real(0.0))
    held = t < model.signals.breaks[first]
    value = real(0.0)
    slope = real(0.0)
    i = int(7)
    while i >= 0:
        slope = slope * x + value
        value = value * x + model.signals.coefficient[piece, i]
        i -= 1
    if order == 0:
        return value
    if held:
        return real(0.0)
    return slope


@wp.func
def write_side(
    model: Model, w: int, row: int, marker: int, force: vec3, torque: vec3, x: vec3, x_marker: vec3, side: int,
    trial: Trial, residuals: Residuals,
):  # fmt: skip
    """Enter the wrench (force at x, torque), world axes, into the row's entries of the body that carries the marker;
    `row_pull` stores the load on its interface, body axes."""
    b = model.markers.body[marker]
    if b < 0:
        return
    At = wp.transpose(trial.axes[w, b])
    moment = At * (wp.cross(x - trial.r1[w, b], force) + torque)
    for i in range(3):
        residuals.C[w, row, 6 * b + i] = residuals.C[w, row, 6 * b + i] + force[i]
        residuals.C[w, row, 6 * b + 3 + i] = residuals.C[w, row, 6 * b + 3 + i] + moment[i]
    f = model.markers.interface[marker]
    if f < 0:
        return
    # the interface rotates about its undeformed point: du = Phi_t dq + (Phi_r dq) x (X - X_if)
    fb = At * force
    tb = At * (wp.cross(x - x_marker, force) + torque)
    tb += wp.cross(model.markers.point[marker] - model.interfaces.point[f], fb)
    for i in range(3):
        residuals.row_pull[w, 2 * row + side, i] = fb[i]
        residuals.row_pull[w, 2 * row + side, 3 + i] = tb[i]
    line = modal_line(model, w, row, b)
    width = model.interfaces.width
    add_load(
        model.bodies.global_count[b], real(1.0), fb, tb, width, trial.slope, line_of(model, w, f), residuals.C_modal,
        line,
    )  # fmt: skip


@wp.func
def clear_side(model: Model, w: int, row: int, marker: int, residuals: Residuals):
    b = model.markers.body[marker]
    if b < 0:
        return
    for i in range(6):
        residuals.C[w, row, 6 * b + i] = real(0.0)
    if model.markers.interface[marker] >= 0:
        line = modal_line(model, w, row, b)
        n = int(0)
        while n < model.bodies.global_count[b]:
            residuals.C_modal[line + n] = real(0.0)
            n += 1


@kernel_in_place
def evaluate_rows(run: Run, trial: Trial, loads: LoadState, residuals: Residuals, qd1: wp.array(dtype=real)):
    """Per row: value, gradient, defect (c, or the spring law divided by its stiffness) and compliance."""
    w, lane = wp.tid()
    model = run.models[w]
    if run.ctl[w].run == 0 or run.ctl[w].moved == 0:
        return
    row = lane
    while row < model.rows.count:
        a = model.rows.a[row]
        b = model.rows.b[row]
        body_a = model.markers.body[a]
        body_b = model.markers.body[b]
        x_a = arm_on_interface(model, a, trial.interface_motion, w)
        x_b = arm_on_interface(model, b, trial.interface_motion, w)
        R_a = axes_on_interface(model, a, trial.interface_motion, w)
        R_b = axes_on_interface(model, b, trial.interface_motion, w)
        if body_a >= 0:
            x_a = trial.r1[w, body_a] + trial.axes[w, body_a] * x_a
            R_a = trial.axes[w, body_a] * R_a
        if body_b >= 0:
            x_b = trial.r1[w, body_b] + trial.axes[w, body_b] * x_b
            R_b = trial.axes[w, body_b] * R_b
        t = run.clk[w].next_time
        s = real(0.0)
        s_rate = real(0.0)
        if model.rows.signal[row] >= 0:
            s = evaluate_signal(model, model.rows.signal[row], t, 0)
            s_rate = evaluate_signal(model, model.rows.signal[row], t, 1)
        kind = model.rows.kind[row]
        i = model.rows.i[row]
        j = model.rows.j[row]
        force = vec3(real(0.0))
        torque = vec3(real(0.0))
        value = real(0.0)
        if kind == k.TRANSLATION:
            u = vec3(R_a[0, i], R_a[1, i], R_a[2, i])
            value = wp.dot(u, x_b - x_a) - s
            force = u
        if kind == k.DIRECTION:
            u = vec3(R_a[0, i], R_a[1, i], R_a[2, i])
            z = vec3(R_b[0, j], R_b[1, j], R_b[2, j])
            value = wp.dot(u, z)
            torque = wp.cross(z, u)
        if kind == k.ANGLE or kind == k.SECOND_ANGLE:
            held = R_a
            turned = R_b
            sign = real(1.0)
            if kind == k.SECOND_ANGLE:
                held = R_b
                turned = R_a
                sign = real(-1.0)
            axis = vec3(held[0, i], held[1, i], held[2, i])
            u = vec3(held[0, j], held[1, j], held[2, j])
            v = sign * wp.cross(axis, u)
            z = vec3(turned[0, j], turned[1, j], turned[2, j])
            P = wp.dot(v, z)
            Q = wp.dot(u, z)
            value = wp.atan2(P * wp.cos(s) - Q * wp.sin(s), Q * wp.cos(s) + P * wp.sin(s))
            torque = (sign / (P * P + Q * Q)) * wp.cross(z, Q * v - P * u)
        if kind == k.TWIST:
            p = (i + 1) % 3
            q = (i + 2) % 3
            R = wp.transpose(R_a) * R_b
            P = R[q, p] - R[p, q]
            Q = R[p, p] + R[q, q]
            value = wp.atan2(P * wp.cos(s) - Q * wp.sin(s), Q * wp.cos(s) + P * wp.sin(s))
            u = vec3(R_a[0, i], R_a[1, i], R_a[2, i])
            z = vec3(R_b[0, i], R_b[1, i], R_b[2, i])
            torque = (u + z) / (real(1.0) + R[i, i])
        if kind == k.DISTANCE:
            gap = x_b - x_a
            value = wp.length(gap) - s
            force = gap / wp.max(value + s, real(1.0e-300))
        if kind == k.ANGLE or kind == k.SECOND_ANGLE or kind == k.TWIST:
            if model.rows.rigid[row] == 0:  # a spring counts revolutions from the last accepted state
                value += TURN * wp.round((loads.stretch[w, row] - value) / TURN)
        if kind == k.BUSHING:
            along = vec3(model.rows.vector[row, 0], model.rows.vector[row, 1], model.rows.vector[row, 2])
            about = vec3(model.rows.vector[row, 3], model.rows.vector[row, 4], model.rows.vector[row, 5])
            phi = rotation_vector(wp.transpose(R_a) * R_b)
            force = R_a * along
            torque = R_a * (tangent_inverse(phi) * about)
            value = wp.dot(force, x_b - x_a) + wp.dot(about, phi)
        clear_side(model, w, row, a, residuals)
        clear_side(model, w, row, b, residuals)
        write_side(model, w, row, b, force, torque, x_b, x_b, 1, trial, residuals)
        write_side(model, w, row, a, -force, -torque, x_b, x_a, 0, trial, residuals)
        residuals.coordinate[w, row] = value + s
        value -= model.rows.reference[row]
        loads.drive_rate[w, 1, row] = s_rate
        for c in range(3):
            residuals.row_wrench[w, row, c] = force[c]
            residuals.row_wrench[w, row, 3 + c] = torque[c]
        residuals.defect[w, row] = value
        residuals.softness[w, row] = real(0.0)
        if model.rows.rigid[row] == 0:
            rate = real(0.0)
            if body_a >= 0:
                rate += row_rate(model, w, row, a, residuals, trial, qd1)
            if body_b >= 0 and body_b != body_a:
                rate += row_rate(model, w, row, b, residuals, trial, qd1)
            k_e = model.rows.stiffness[row] + model.rows.damping[row] * run.clk[w].retained.vel
            law = model.rows.stiffness[row] * value + model.rows.damping[row] * rate + model.rows.preload[row]
            if model.rows.elastic[row] >= 0:
                spring = characteristic(model, model.rows.elastic[row], value)
                law += spring[0]
                k_e += spring[1]
            if model.rows.viscous[row] >= 0:
                damper = characteristic(model, model.rows.viscous[row], rate)
                law += damper[0]
                k_e += damper[1] * run.clk[w].retained.vel
            if model.rows.elastic[row] >= 0 or model.rows.viscous[row] >= 0:
                k_e = firm(model, row, force, run.clk[w].retained.acc, k_e)
            if k_e != real(0.0):
                residuals.defect[w, row] = (law - loads.lam[w, row]) / k_e
                residuals.softness[w, row] = real(1.0) / k_e
            else:  # a pure damper at rest: no force
                residuals.defect[w, row] = -loads.lam[w, row]
                residuals.softness[w, row] = real(1.0)
            loads.drive_rate[w, 1, row] = rate
        row += wp.block_dim()


@wp.func
def row_rate(
    model: Model, w: int, row: int, marker: int, residuals: Residuals, trial: Trial, qd1: wp.array(dtype=real)
) -> real:
    b = model.markers.body[marker]
    rate = real(0.0)
    for i in range(3):
        rate += (
            residuals.C[w, row, 6 * b + i] * trial.v1[w, b][i]
            + residuals.C[w, row, 6 * b + 3 + i] * trial.omega1[w, b][i]
        )
    if model.markers.interface[marker] >= 0:
        modes = w * model.modes.count + model.bodies.modal_start[b]
        rate += dot(model.bodies.global_count[b], residuals.C_modal, modal_line(model, w, row, b), qd1, modes)
    return rate


@kernel
def apply_forces(run: Run, trial: Trial, residuals: Residuals, loads: LoadState, modal_residual: wp.array(dtype=real)):
    """Per world, lanes over bodies: subtract the point forces from the residuals; their world components and points are
    stored for the ledger."""
    w, lane = wp.tid()
    model = run.models[w]
    if run.ctl[w].run == 0 or run.ctl[w].moved == 0:
        return
    t = run.clk[w].next_time
    i = int(0)
    while i < model.external[0].forces.count:
        b = model.external[0].forces.body[i]
        if b % wp.block_dim() != lane:
            i += 1
            continue
        A = trial.axes[w, b]
        f = vec3(
            evaluate_signal(model, model.external[0].forces.signal[i, 0], t, 0),
            evaluate_signal(model, model.external[0].forces.signal[i, 1], t, 0),
            evaluate_signal(model, model.external[0].forces.signal[i, 2], t, 0),
        )
        if model.external[0].forces.in_body[i] != 0:
            f = A * f
        X = model.external[0].forces.point[i]
        arm = X
        interface = model.external[0].forces.interface[i]
        if interface >= 0:
            arm = X + translation_of(trial.interface_motion, w, interface)
            arm += wp.cross(rotation_of(trial.interface_motion, w, interface), X - model.interfaces.point[interface])
        fb = wp.transpose(A) * f
        moment = wp.cross(arm, fb)
        for c in range(3):
            residuals.residual[w, 6 * b + c] = residuals.residual[w, 6 * b + c] - f[c]
            residuals.residual[w, 6 * b + 3 + c] = residuals.residual[w, 6 * b + 3 + c] - moment[c]
        if interface >= 0:
            tb = wp.cross(X - model.interfaces.point[interface], fb)
            modes = w * model.modes.count + model.bodies.modal_start[b]
            line = line_of(model, w, interface)
            n = model.bodies.global_count[b]
            add_load(n, real(-1.0), fb, tb, model.interfaces.width, trial.slope, line, modal_residual, modes)
        loads.applied[w, 1, i] = f
        loads.applied_at[w, 1, i] = trial.r1[w, b] + A * arm
        i += 1
