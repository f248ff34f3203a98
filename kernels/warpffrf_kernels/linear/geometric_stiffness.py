"""Geometric stiffness: change of the forces of rows, and of applied forces, with the motion of bodies and modes.

A row exerts the force P = lambda f at x_b and the couple Q = lambda t on marker b, and the opposite at the same point
on marker a. With d_b = x_b - r_b, c_a = x_b - r_a, c = x_b - x_a the residuals of rigid coordinates and modes contain

    b:   P,   A_b^T M_b,   M_b = d_b x P + Q,          B_b^T (A_b^T P, A_b^T Q),
    a:  -P,   A_a^T M_a,   M_a = -(c_a x P + Q),      -B_a^T (A_a^T P, A_a^T (c x P + Q)),

with B the motion, translation at the marker's point and rotation, by the modes (body axes). A coordinate moves the
markers' points by dx and rotates them by dT and the bodies by dTheta. For fixed lambda

    dP = P_a dT_a + P_x (dx_b - dx_a),      dQ = Q_a dT_a + Q_b dT_b,

    TRANSLATION, BUSHING   f rotates with a:          P_a = -P^,  BUSHING also Q_a = Q_b = -Q^/2 (to first order in phi)
    DISTANCE               f = (x_b - x_a)/l:         P_x = lambda (1 - f f^T)/l
    DIRECTION              t = w x u:                 Q_a = -lambda w^ u^,   Q_b = lambda u^ w^
    ANGLE, SECOND_ANGLE    t = e x n/N, n = (q.e) p - (p.e) q, N = (p.e)^2 + (q.e)^2, e rotating with one body, p and q
                           with the other, d(p.e) = (dTheta_e - dTheta_pq).(e x p), likewise q
    TWIST                  t = (u + w)/N, N = 1 + u.w:   Q_a = -lambda (u^ + t (u x w)^T)/N, Q_b likewise, u and w
                           exchanged

and d(A^T v) = A^T (dv + v x dTheta). An applied force F is half a row: the residual has -F at its point, dF = 0, or
dTheta x F if it rotates with the body; a torque likewise. The change of B itself with the modes is in
`inertia.couple_modes` for rows, and here for applied forces.

The residual is independent of these terms; they only affect the convergence rate: without them a static state under a
load with a moving arm had a contraction of (geometric over elastic stiffness), 0.3 for a soft mount. The modal part is
included in static steps, for modes that are retained unknowns: in a step in time inertia dominates.
"""

import warp as wp

from warpffrf_kernels.bodies.interfaces import arm_on_interface, axes_on_interface, line_of
from warpffrf_kernels.core import control as k
from warpffrf_kernels.core.control import Control
from warpffrf_kernels.core.declaration import kernel
from warpffrf_kernels.core.integration import is_static
from warpffrf_kernels.core.model import Model
from warpffrf_kernels.core.rotation import hat
from warpffrf_kernels.core.run import Run
from warpffrf_kernels.core.scalars import MODULE_OPTIONS, mat33, real, vec3
from warpffrf_kernels.core.scratch import Residuals, RetainedSystem, Trial
from warpffrf_kernels.core.state import LoadState
from warpffrf_kernels.linear.sparse_factor import Pattern

wp.set_module_options(MODULE_OPTIONS)


@wp.struct
class Change:
    """Motion of a marker and its body by one coordinate: `point` dx, `marker` dT, `body` dTheta, `origin` dr; world."""

    point: vec3
    marker: vec3
    body: vec3
    origin: vec3


@wp.struct
class Pull:
    """Force and couple of rows on their second marker, and their derivatives; P_a = -carried^."""

    P: vec3
    Q: vec3
    carried: vec3
    P_x: mat33
    Q_a: mat33
    Q_b: mat33


@wp.func
def modes_here(model: Model, ctl: wp.array(dtype=Control), w: int, body: int, interface: int) -> int:
    """Modes of a body that carry inertia and move an interface, in static steps."""
    if not is_static(ctl, w) or body < 0 or interface < 0:
        return 0
    return model.bodies.inertia_count[body]


@wp.func
def mode_slope(model: Model, slope: wp.array(dtype=real), w: int, interface: int, i: int, lever: vec3):
    """Translation of the point at `lever` from the interface's point, and rotation, by mode i; body axes."""
    at = line_of(model, w, interface) + i
    width = model.interfaces.width
    turn = vec3(slope[at + 3 * width], slope[at + 4 * width], slope[at + 5 * width])
    return vec3(slope[at], slope[at + width], slope[at + 2 * width]) + wp.cross(turn, lever), turn


@wp.func
def change_by(
    model: Model, slope: wp.array(dtype=real), w: int, interface: int, A: mat33, d: vec3, lever: vec3, coordinate: int
) -> Change:
    """By coordinate 0 to 2 (translation), 3 to 5 (rotation about the body's axes) or 6 + i (mode i) of the marker's
    body."""
    out = Change()
    if coordinate < 3:
        out.origin[coordinate] = real(1.0)
        out.point = out.origin
    elif coordinate < 6:
        out.body = vec3(A[0, coordinate - 3], A[1, coordinate - 3], A[2, coordinate - 3])
        out.marker = out.body
        out.point = wp.cross(out.body, d)
    else:
        move, turn = mode_slope(model, slope, w, interface, coordinate - 6, lever)
        out.point = A * move
        out.marker = A * turn
    return out


@wp.func
def column_of(model: Model, body: int, coordinate: int) -> int:
    """Retained column of a coordinate of `change_by`."""
    if coordinate < 6:
        return 6 * body + coordinate
    return 6 * model.bodies.count + model.bodies.dense_start[body] + coordinate - 6


@wp.func
def add_change(
    model: Model, trial: Trial, w: int, body: int, interface: int, modes: int, A: mat33, lever: vec3, turned: vec3,
    P: vec3, dP: vec3, M: vec3, dM: vec3, N: vec3, dN: vec3, column: int, system: RetainedSystem,
):  # fmt: skip
    """Adds the change of a body's residuals to a column: force P, moment M about its origin, couple N at the marker
    (all world axes) and their changes; the body rotates by `turned`."""
    moment = wp.transpose(A) * (dM + wp.cross(M, turned))
    row = 6 * body
    for i in range(3):
        system.tangent[w, row + i, column] = system.tangent[w, row + i, column] + dP[i]
        system.tangent[w, row + 3 + i, column] = system.tangent[w, row + 3 + i, column] + moment[i]
    if modes > 0:
        f = wp.transpose(A) * (dP + wp.cross(P, turned))
        t = wp.transpose(A) * (dN + wp.cross(N, turned))
        i = int(0)
        while i < modes:
            move, turn = mode_slope(model, trial.slope, w, interface, i, lever)
            at = column_of(model, body, 6 + i)
            system.tangent[w, at, column] = system.tangent[w, at, column] + wp.dot(move, f) + wp.dot(turn, t)
            i += 1


@wp.func
def hats(a: vec3, b: vec3) -> mat33:
    """a^ b^."""
    return wp.outer(b, a) - wp.dot(a, b) * wp.identity(n=3, dtype=real)


@wp.func
def pull_of(kind: int, pull: real, f: vec3, t: vec3, R_a: mat33, R_b: mat33, i: int, j: int, length: real) -> Pull:
    """For a row of multiplier `pull` and wrench (f, t) on markers with the axes R_a, R_b."""
    out = Pull()
    out.P = pull * f
    out.Q = pull * t
    if kind == k.TRANSLATION or kind == k.BUSHING:
        out.carried = out.P
    if kind == k.BUSHING:
        out.Q_a = real(-0.5) * hat(out.Q)
        out.Q_b = out.Q_a
    if kind == k.DISTANCE:
        one = wp.identity(n=3, dtype=real)
        out.P_x = (pull / wp.max(length, real(1.0e-300))) * (one - wp.outer(f, f))
    if kind == k.DIRECTION:
        u = vec3(R_a[0, i], R_a[1, i], R_a[2, i])
        w = vec3(R_b[0, j], R_b[1, j], R_b[2, j])
        out.Q_a = -pull * hats(w, u)
        out.Q_b = pull * hats(u, w)
    if kind == k.TWIST:
        u = vec3(R_a[0, i], R_a[1, i], R_a[2, i])
        w = vec3(R_b[0, i], R_b[1, i], R_b[2, i])
        N = real(1.0) + wp.dot(u, w)
        out.Q_a = (-pull / N) * (hat(u) + wp.outer(t, wp.cross(u, w)))
        out.Q_b = (-pull / N) * (hat(w) + wp.outer(t, wp.cross(w, u)))
    if kind == k.ANGLE or kind == k.SECOND_ANGLE:
        held = R_a
        turned = R_b
        sign = real(1.0)
        if kind == k.SECOND_ANGLE:
            held = R_b
            turned = R_a
            sign = real(-1.0)
        q = vec3(held[0, j], held[1, j], held[2, j])
        p = sign * wp.cross(vec3(held[0, i], held[1, i], held[2, i]), q)
        e = vec3(turned[0, j], turned[1, j], turned[2, j])
        along_p = wp.dot(p, e)
        along_q = wp.dot(q, e)
        N = along_p * along_p + along_q * along_q
        n = along_q * p - along_p * q
        u = wp.cross(e, n) / N
        e_p = wp.cross(e, p)
        e_q = wp.cross(e, q)
        steep = wp.outer(e_p, e_q) - wp.outer(e_q, e_p) - wp.outer(u, real(2.0) * (along_p * e_p + along_q * e_q))
        by_turned = (sign * pull / N) * (hats(n, e) + steep)
        by_held = (-sign * pull / N) * (hats(e, n) + steep)
        out.Q_a = by_held
        out.Q_b = by_turned
        if kind == k.SECOND_ANGLE:
            out.Q_a = by_turned
            out.Q_b = by_held
    return out


@wp.func
def pull_of_joint(
    model: Model, w: int, first: int, end: int, R_a: mat33, R_b: mat33, length: real, pattern: Pattern,
    loads: LoadState, residuals: Residuals,
):  # fmt: skip
    """The sum over the rows of a list from entry `first` that have the same markers, and the entry after the last one:
    the rows of a joint have, so that its motions are evaluated once."""
    a = model.rows.a[pattern.row[first]]
    b = model.rows.b[pattern.row[first]]
    out = Pull()
    at = first
    row = pattern.row[first]
    while at < end and model.rows.a[row] == a and model.rows.b[row] == b:
        lam = loads.lam[w, row]
        if lam != real(0.0):
            f = vec3(residuals.row_wrench[w, row, 0], residuals.row_wrench[w, row, 1], residuals.row_wrench[w, row, 2])
            t = vec3(residuals.row_wrench[w, row, 3], residuals.row_wrench[w, row, 4], residuals.row_wrench[w, row, 5])
            own = pull_of(model.rows.kind[row], lam, f, t, R_a, R_b, model.rows.i[row], model.rows.j[row], length)
            out.P = out.P + own.P
            out.Q = out.Q + own.Q
            out.carried = out.carried + own.carried
            out.P_x = out.P_x + own.P_x
            out.Q_a = out.Q_a + own.Q_a
            out.Q_b = out.Q_b + own.Q_b
        at += 1
        if at < end:
            row = pattern.row[at]
    return out, at


@kernel
def stiffen(
    run: Run, trial: Trial, loads: LoadState, residuals: Residuals, system: RetainedSystem,
    patterns: wp.array(dtype=Pattern),
):  # fmt: skip
    """Lanes over the columns of bodies: add the geometric stiffness of all rows to the retained matrix. On a GPU up to
    six lanes share the columns of a body; the only lane of the CPU sums the rows of each joint once for all of them."""
    w, lane = wp.tid()
    model = run.models[w]
    if run.ctl[w].run == 0 or run.ctl[w].moved == 0 or run.ctl[w].refresh == 0:
        return
    pattern = patterns[0]
    shares = wp.min(wp.block_dim(), 6)
    one = wp.identity(n=3, dtype=real)
    item = lane
    while item < shares * model.bodies.count:
        body = item / shares
        end = pattern.row_start[body + 1]
        at = pattern.row_start[body]
        while at < end:
            a = model.rows.a[pattern.row[at]]
            b = model.rows.b[pattern.row[at]]
            body_a = model.markers.body[a]
            body_b = model.markers.body[b]
            A_a = one
            A_b = one
            r_a = vec3(real(0.0))
            r_b = vec3(real(0.0))
            if body_a >= 0:
                A_a = trial.axes[w, body_a]
                r_a = trial.r1[w, body_a]
            if body_b >= 0:
                A_b = trial.axes[w, body_b]
                r_b = trial.r1[w, body_b]
            f_a = model.markers.interface[a]
            f_b = model.markers.interface[b]
            lever_a = vec3(real(0.0))
            lever_b = vec3(real(0.0))
            if f_a >= 0:
                lever_a = model.markers.point[a] - model.interfaces.point[f_a]
            if f_b >= 0:
                lever_b = model.markers.point[b] - model.interfaces.point[f_b]
            d_a = A_a * arm_on_interface(model, a, trial.interface_motion, w)
            d_b = A_b * arm_on_interface(model, b, trial.interface_motion, w)
            c_a = r_b + d_b - r_a
            c = c_a - d_a
            R_a = A_a * axes_on_interface(model, a, trial.interface_motion, w)
            R_b = A_b * axes_on_interface(model, b, trial.interface_motion, w)
            p, after = pull_of_joint(model, w, at, end, R_a, R_b, wp.length(c), pattern, loads, residuals)
            at = after
            modes_a = modes_here(model, run.ctl, w, body_a, f_a)
            modes_b = modes_here(model, run.ctl, w, body_b, f_b)
            side = int(0)
            while side < 2:
                modes = modes_a
                moved = body_a
                if side == 1:
                    modes = modes_b
                    moved = body_b
                coordinate = item % shares
                while moved == body and coordinate < 6 + modes:
                    by_a = Change()
                    by_b = Change()
                    if side == 0:
                        by_a = change_by(model, trial.slope, w, f_a, A_a, d_a, lever_a, coordinate)
                    else:
                        by_b = change_by(model, trial.slope, w, f_b, A_b, d_b, lever_b, coordinate)
                    column = column_of(model, body, coordinate)
                    dP = p.P_x * (by_b.point - by_a.point) - wp.cross(p.carried, by_a.marker)
                    dQ = p.Q_a * by_a.marker + p.Q_b * by_b.marker
                    if body_b >= 0:
                        M = wp.cross(d_b, p.P) + p.Q
                        dM = wp.cross(by_b.point - by_b.origin, p.P) + wp.cross(d_b, dP) + dQ
                        add_change(
                            model, trial, w, body_b, f_b, modes_b, A_b, lever_b, by_b.body, p.P, dP, M, dM, p.Q, dQ,
                            column, system,
                        )  # fmt: skip
                    if body_a >= 0:
                        M = -(wp.cross(c_a, p.P) + p.Q)
                        dM = -(wp.cross(by_b.point - by_a.origin, p.P) + wp.cross(c_a, dP) + dQ)
                        N = -(wp.cross(c, p.P) + p.Q)
                        dN = -(wp.cross(by_b.point - by_a.point, p.P) + wp.cross(c, dP) + dQ)
                        add_change(
                            model, trial, w, body_a, f_a, modes_a, A_a, lever_a, by_a.body, -p.P, -dP, M, dM, N, dN,
                            column, system,
                        )  # fmt: skip
                    coordinate += shares
                side += 1
        item += wp.block_dim()


@kernel
def stiffen_applied(run: Run, trial: Trial, loads: LoadState, residuals: Residuals, system: RetainedSystem):
    """Lanes over the columns of a body, in static steps: add the geometric stiffness of point forces and torques to the
    retained matrix. A column is always that of the same lane."""
    w, lane = wp.tid()
    model = run.models[w]
    if run.ctl[w].run == 0 or run.ctl[w].moved == 0 or run.ctl[w].refresh == 0 or not is_static(run.ctl, w):
        return
    none = vec3(real(0.0))
    i = int(0)
    while i < model.external[0].forces.count + model.external[0].torques.count:
        F = none
        T = none
        body = int(0)
        interface = int(-1)
        follows = int(0)
        arm = none
        lever = none
        if i < model.external[0].forces.count:
            body = model.external[0].forces.body[i]
            interface = model.external[0].forces.interface[i]
            follows = model.external[0].forces.in_body[i]
            F = loads.applied[w, 1, i]
            arm = model.external[0].forces.point[i]
            if interface >= 0:
                lever = arm - model.interfaces.point[interface]
                turn = vec3(
                    trial.interface_motion[w, interface, 3], trial.interface_motion[w, interface, 4],
                    trial.interface_motion[w, interface, 5],
                )  # fmt: skip
                arm += vec3(
                    trial.interface_motion[w, interface, 0], trial.interface_motion[w, interface, 1],
                    trial.interface_motion[w, interface, 2],
                )  # fmt: skip
                arm += wp.cross(turn, lever)
        else:
            at = i - model.external[0].forces.count
            body = model.external[0].torques.body[at]
            interface = model.external[0].torques.interface[at]
            follows = model.external[0].torques.in_body[at]
            T = trial.axes[w, body] * residuals.applied_torque[w, at]
        A = trial.axes[w, body]
        d = A * arm
        modes = modes_here(model, run.ctl, w, body, interface)
        coordinate = lane
        while coordinate < 6 + modes:
            by = change_by(model, trial.slope, w, interface, A, d, lever, coordinate)
            dF = none
            dT = none
            if follows != 0:
                dF = wp.cross(by.body, F)
                dT = wp.cross(by.body, T)
            M = wp.cross(d, F) + T
            dM = wp.cross(by.point - by.origin, F) + wp.cross(d, dF) + dT
            add_change(
                model, trial, w, body, interface, modes, A, lever, by.body, -F, -dF, -M, -dM, -T, -dT,
                column_of(model, body, coordinate), system,
            )  # fmt: skip
            if coordinate >= 6 and model.interfaces.stiffening_start[interface] >= 0:
                bend_modes(
                    model, w, body, interface, coordinate - 6, wp.transpose(A) * F, lever, wp.transpose(A) * T,
                    system.tangent,
                )  # fmt: skip
            coordinate += wp.block_dim()
        i += 1


@wp.func
def bend_modes(
    model: Model, w: int, body: int, interface: int, j: int, f: vec3, lever: vec3, torque: vec3,
    tangent: wp.array3d(dtype=real),
):  # fmt: skip
    """Change of B of an interface with mode j, times a force at `lever` and a torque there (body axes)."""
    count = model.bodies.inertia_count[body]
    t = wp.cross(lever, f) + torque
    first = model.interfaces.stiffening_start[interface]
    column = column_of(model, body, 6 + j)
    i = int(0)
    while i < count:
        row = column_of(model, body, 6 + i)
        total = real(0.0)
        for c in range(3):
            at = first + (c * count + i) * count + j
            total += f[c] * model.interfaces.stiffening[at]
            total += t[c] * model.interfaces.stiffening[at + 3 * count * count]
        tangent[w, row, column] = tangent[w, row, column] + total
        i += 1
