"""How the forces of rows turn and shift with the bodies: their geometric stiffness.

A row pulls on body b with P = lambda f at x_b and the couple Q = lambda t, on body a with the opposite. With d_b =
x_b - r_b, d_a = x_a - r_a, c_a = x_b - r_a, what the residuals contain is

    b:  P,    A_b^T M_b,   M_b = d_b x P + Q;          a:  -P,   A_a^T M_a,   M_a = -(c_a x P + Q).

For small motions dr, dTheta (world axes) and fixed lambda

    dP = P_a dTheta_a + P_b dTheta_b + P_x (dx_b - dx_a),    dx = dr + dTheta x d,    dQ = Q_a dTheta_a + Q_b dTheta_b,

    TRANSLATION, BUSHING   f turns with a:            P_a = -P^,  BUSHING also Q_a = Q_b = -Q^/2 (to first order in phi)
    DISTANCE               f = (x_b - x_a)/l:         P_x = lambda (1 - f f^T)/l
    DIRECTION              t = w x u:                 Q_a = -lambda w^ u^,   Q_b = lambda u^ w^
    ANGLE, SECOND_ANGLE    t = e x n/N, n = (q.e) p - (p.e) q, N = (p.e)^2 + (q.e)^2, e turning with one body, p and q
                           with the other, d(p.e) = (dTheta_e - dTheta_pq).(e x p), likewise q

and dM_b = dd_b x P + d_b x dP + dQ, dM_a = -(dc_a x P + c_a x dP + dQ), d(A^T M) = A^T (dM - dTheta x M). The residual
does not depend on any of this, only how fast it is brought to zero: without it a static state under a load whose arm
moves was found with a contraction of (geometric over elastic stiffness), 0.3 for a soft mount. Modes are left out.
"""

import warp as wp

from warpffrf_kernels import control as k
from warpffrf_kernels.interfaces import arm_on_interface, axes_on_interface
from warpffrf_kernels.model import Model
from warpffrf_kernels.rotation import hat
from warpffrf_kernels.scalars import MODULE_OPTIONS, mat33, real, vec3

wp.set_module_options(MODULE_OPTIONS)


@wp.func
def add_block(tangent: wp.array3d(dtype=real), w: int, row: int, column: int, block: mat33):
    for i in range(3):
        for j in range(3):
            tangent[w, row + i, column + j] = tangent[w, row + i, column + j] + block[i, j]


@wp.kernel
def stiffen(
    models: wp.array(dtype=Model),
    ctl: wp.array2d(dtype=int),
    r1: wp.array2d(dtype=vec3),
    axes: wp.array2d(dtype=mat33),
    motion: wp.array3d(dtype=real),
    lam: wp.array2d(dtype=real),
    row_wrench: wp.array3d(dtype=real),
    tangent: wp.array3d(dtype=real),
):
    """Per world: add the geometric stiffness of all rows to the rigid blocks of the outer matrix."""
    w = wp.tid()
    model = models[0]
    if ctl[w, k.RUN] == 0 or ctl[w, k.MOVED] == 0 or ctl[w, k.REFRESH] == 0:
        return
    one = wp.identity(n=3, dtype=real)
    row = int(0)
    while row < model.row_count:
        pull = lam[w, row]
        if pull != real(0.0):
            a = model.row_a[row]
            b = model.row_b[row]
            body_a = model.marker_body[a]
            body_b = model.marker_body[b]
            A_a = one
            A_b = one
            r_a = vec3(real(0.0))
            r_b = vec3(real(0.0))
            if body_a >= 0:
                A_a = axes[w, body_a]
                r_a = r1[w, body_a]
            if body_b >= 0:
                A_b = axes[w, body_b]
                r_b = r1[w, body_b]
            d_a = A_a * arm_on_interface(model, a, motion, w)
            d_b = A_b * arm_on_interface(model, b, motion, w)
            f = vec3(row_wrench[w, row, 0], row_wrench[w, row, 1], row_wrench[w, row, 2])
            P = pull * f
            Q = pull * vec3(row_wrench[w, row, 3], row_wrench[w, row, 4], row_wrench[w, row, 5])
            c_a = r_b + d_b - r_a
            kind = model.row_kind[row]
            P_a = mat33(real(0.0))
            P_x = mat33(real(0.0))
            Q_a = mat33(real(0.0))
            Q_b = mat33(real(0.0))
            if kind == k.TRANSLATION or kind == k.BUSHING:
                P_a = -hat(P)
            if kind == k.BUSHING:
                Q_a = real(-0.5) * hat(Q)
                Q_b = Q_a
            if kind == k.DISTANCE:
                length = wp.max(wp.length(c_a - d_a), real(1.0e-300))
                P_x = (pull / length) * (one - wp.outer(f, f))
            if kind == k.DIRECTION:
                R_a = A_a * axes_on_interface(model, a, motion, w)
                R_b = A_b * axes_on_interface(model, b, motion, w)
                i = model.row_i[row]
                j = model.row_j[row]
                U = hat(vec3(R_a[0, i], R_a[1, i], R_a[2, i]))
                W = hat(vec3(R_b[0, j], R_b[1, j], R_b[2, j]))
                Q_a = -pull * (W * U)
                Q_b = pull * (U * W)
            if kind == k.ANGLE or kind == k.SECOND_ANGLE:
                held = A_a * axes_on_interface(model, a, motion, w)
                turned = A_b * axes_on_interface(model, b, motion, w)
                sign = real(1.0)
                if kind == k.SECOND_ANGLE:
                    held = A_b * axes_on_interface(model, b, motion, w)
                    turned = A_a * axes_on_interface(model, a, motion, w)
                    sign = real(-1.0)
                i = model.row_i[row]
                j = model.row_j[row]
                q = vec3(held[0, j], held[1, j], held[2, j])
                p = sign * wp.cross(vec3(held[0, i], held[1, i], held[2, i]), q)
                e = vec3(turned[0, j], turned[1, j], turned[2, j])
                along_p = wp.dot(p, e)
                along_q = wp.dot(q, e)
                N = along_p * along_p + along_q * along_q
                n = along_q * p - along_p * q
                t = wp.cross(e, n) / N
                steep = hat(e) * (wp.outer(p, wp.cross(e, q)) - wp.outer(q, wp.cross(e, p)))
                steep = steep - wp.outer(t, real(2.0) * (along_p * wp.cross(e, p) + along_q * wp.cross(e, q)))
                by_turned = (sign * pull / N) * (hat(n) * hat(e) + steep)
                by_held = (sign * pull / N) * (-(hat(e) * hat(n)) - steep)
                Q_a = by_held
                Q_b = by_turned
                if kind == k.SECOND_ANGLE:
                    Q_a = by_turned
                    Q_b = by_held
            M_a = -(wp.cross(c_a, P) + Q)
            M_b = wp.cross(d_b, P) + Q
            for column in range(4):  # dr_a, dTheta_a, dr_b, dTheta_b
                body = body_a
                if column > 1:
                    body = body_b
                if body >= 0:
                    dP = mat33(real(0.0))
                    dQ = mat33(real(0.0))
                    dd_b = mat33(real(0.0))
                    dc_a = mat33(real(0.0))
                    own_a = mat33(real(0.0))  # of A^T on the body that turns
                    own_b = mat33(real(0.0))
                    turn = one
                    if column == 0:
                        dP = -P_x
                        dc_a = -one
                    if column == 1:
                        dP = P_a + P_x * hat(d_a)
                        dQ = Q_a
                        own_a = hat(M_a)
                        turn = A_a
                    if column == 2:
                        dP = P_x
                        dc_a = one
                    if column == 3:
                        dP = -(P_x * hat(d_b))
                        dQ = Q_b
                        dd_b = -hat(d_b)
                        dc_a = dd_b
                        own_b = hat(M_b)
                        turn = A_b
                    at = 6 * body
                    if column == 1 or column == 3:
                        at = at + 3
                    if body_b >= 0:
                        moment = hat(d_b) * dP - hat(P) * dd_b + dQ + own_b
                        add_block(tangent, w, 6 * body_b, at, dP * turn)
                        add_block(tangent, w, 6 * body_b + 3, at, wp.transpose(A_b) * moment * turn)
                    if body_a >= 0:
                        moment = hat(P) * dc_a - hat(c_a) * dP - dQ + own_a
                        add_block(tangent, w, 6 * body_a, at, -(dP * turn))
                        add_block(tangent, w, 6 * body_a + 3, at, wp.transpose(A_a) * moment * turn)
        row += 1
