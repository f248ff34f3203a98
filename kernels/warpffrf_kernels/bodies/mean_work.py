r"""Forces through quadratic coordinates, whose mean over a step does the work of their potential exactly.

A coordinate c(q) = a.q + q.B q/2 with gradient g = a + B q, and a force f along it, load the modes with f g. Over a
step from q_0 to q_1, with d = q_1 - q_0,

    c_1 - c_0 = (g_0 + g_1)/2 . d,

so that the force (f_0 + f_1)/2 (g_0 + g_1)/2 does the work (f_0 + f_1)/2 (c_1 - c_0): the change of c^2/2 where f = c
(the squares of the membrane energy, c = e_r, g = y_r), that of the energy of a linear spring, and nothing where a joint
holds c. It is a discrete gradient (O. Gonzalez, J. Nonlinear Sci. 6, 1996) in closed form, as only quadratic
coordinates are about. The mean of the forces themselves, which a step has, misses it by

    C = (f_0 + f_1)/2 (g_0 + g_1)/2 - (f_0 g_0 + f_1 g_1)/2 = -(f_1 - f_0) (g_1 - g_0)/4,

of second order in the step: without C a plate that vibrates at twice its thickness gains and loses some per cent of
its energy in turn at thirty steps a period.

**The step with it.** A force Y, and y in the algorithmic acceleration that goes with it, are added so that the mean of
the increment of velocity, v_1 - v_0 = h ((1 - gamma) a_0 + gamma a_1), has C in it (`motion`):

    (1 - gamma) y_0 + gamma y_1 = C,      (1 - alpha_f) Y_1 + alpha_f Y_0 = (1 - alpha_m) y_1 + alpha_m y_0.

Where the method has the mean of the forces at both ends (generalized-alpha with rho_inf = 1, the trapezoidal rule),
d = h (v_0 + v_1)/2, and the energy of a body without gyroscopic terms is kept to the tolerance of the iteration. Where
it dissipates, the gain is that of a linear oscillator's oscillating error.

Coordinates here are those of bodies that loads stiffen: the squares of the membrane energy, and the motion of
interfaces under the forces of rows (joints, drives, springs). What else is not linear, turning above all, and applied
forces that change are as the integrator has them. The tangent of Y_1 makes u_r y_r^T + s_r L_r of y_r y_r^T + e_r L_r,
u = y_1 - KAPPA (y_1 - y_0)/4 and s alike, KAPPA = dY_1/dC; of interfaces it has the part by multipliers.
"""

import warp as wp

from warpffrf_kernels.bodies.interfaces import line_of, marker_of
from warpffrf_kernels.bodies.membrane import slope_line
from warpffrf_kernels.core import control as k
from warpffrf_kernels.core.access import changed, out
from warpffrf_kernels.core.control import Clock, Control
from warpffrf_kernels.core.integration import share_of_miss
from warpffrf_kernels.core.model import Model
from warpffrf_kernels.core.scalars import MODULE_OPTIONS, real

wp.set_module_options(MODULE_OPTIONS)


@wp.func
def pull_of_rows(
    model: Model, w: int, interface: int, c: int, lam: wp.array2d(dtype=real), row_pull: wp.array3d(dtype=real)
) -> real:
    """Component c of what all rows pull at an interface with, body axes."""
    total = real(0.0)
    row = int(0)
    while row < model.rows.count:
        for side in range(2):
            if model.markers.interface[marker_of(model, row, side)] == interface:
                total += lam[w, row] * row_pull[w, 2 * row + side, c]
        row += 1
    return total


@wp.kernel
def change_pulls(
    models: wp.array(dtype=Model),
    ctl: wp.array(dtype=Control),
    lam: wp.array2d(dtype=real),
    row_pull: wp.array3d(dtype=real),
    interface_pull: wp.array3d(dtype=real),
    pull_change: out(wp.array3d(dtype=real)),
):
    """Lanes over interfaces: what their pulls have changed by in the attempt."""
    w, lane = wp.tid()
    model = models[w]
    if ctl[w].run == 0 or ctl[w].moved == 0:
        return
    f = lane
    while f < model.interfaces.count:
        for c in range(6):
            pull_change[w, f, c] = pull_of_rows(model, w, f, c, lam, row_pull) - interface_pull[w, f, c]
        f += wp.block_dim()


@wp.kernel
def add_mean_work(
    models: wp.array(dtype=Model),
    ctl: wp.array(dtype=Control),
    clk: wp.array(dtype=Clock),
    membrane_slope: wp.array(dtype=real),
    membrane_slope0: wp.array(dtype=real),
    membrane_amplitude: wp.array2d(dtype=real),
    membrane_amplitude0: wp.array2d(dtype=real),
    slope: wp.array(dtype=real),
    slope0: wp.array(dtype=real),
    pull_change: wp.array3d(dtype=real),
    lag: wp.array3d(dtype=real),
    modal_residual: changed(wp.array2d(dtype=real)),
    lag1: out(wp.array3d(dtype=real)),
):
    """Lanes over dense modes: y_1 and Y_1, and Y_1 among the unbalanced forces; none but in steps in time that remember
    accelerations."""
    w, lane = wp.tid()
    model = models[w]
    if ctl[w].run == 0 or ctl[w].moved == 0:
        return
    rule = clk[w].outer
    one = real(1.0)
    quarter = real(0.25)
    whole = share_of_miss(ctl, clk, w) != real(0.0)
    d = lane
    while d < model.dense.count:
        b = model.dense.body[d]
        i = d - model.bodies.dense_start[b]
        lag1[w, 0, d] = real(0.0)
        lag1[w, 1, d] = real(0.0)
        if whole and i < model.bodies.inertia_count[b]:
            miss = real(0.0)
            s = model.bodies.square_start[b]
            while s < model.bodies.square_start[b + 1]:
                at = slope_line(model, w, s) + i
                change = membrane_amplitude[w, s] - membrane_amplitude0[w, s]
                miss -= quarter * change * (membrane_slope[at] - membrane_slope0[at])
                s += 1
            f = int(0)
            while f < model.interfaces.count:
                if model.interfaces.body[f] == b and model.interfaces.stiffening_start[f] >= 0:
                    for c in range(6):
                        at = line_of(model, w, f) + c * model.interfaces.width + i
                        miss -= quarter * pull_change[w, f, c] * (slope[at] - slope0[at])
                f += 1
            old = lag[w, 0, d]
            if ctl[w].trapezoidal != 0:  # from the true accelerations
                old = lag[w, 1, d]
            new = (miss - (one - rule.gamma) * old) / rule.gamma
            force = (one - rule.alpha_m) * new + rule.alpha_m * old - rule.alpha_f * lag[w, 1, d]
            lag1[w, 0, d] = new
            lag1[w, 1, d] = force / (one - rule.alpha_f)
            m = model.dense.mode[d]
            modal_residual[w, m] = modal_residual[w, m] + lag1[w, 1, d]
        d += wp.block_dim()


@wp.kernel
def couple_pulls(
    models: wp.array(dtype=Model),
    ctl: wp.array(dtype=Control),
    clk: wp.array(dtype=Clock),
    slope: wp.array(dtype=real),
    slope0: wp.array(dtype=real),
    row_pull: wp.array3d(dtype=real),
    tangent: changed(wp.array3d(dtype=real)),
):
    """Lanes over dense modes: dY_1 by the multipliers of rows."""
    w, lane = wp.tid()
    model = models[w]
    if ctl[w].run == 0 or ctl[w].moved == 0 or ctl[w].refresh == 0:
        return
    part = real(0.25) * share_of_miss(ctl, clk, w)
    d = lane
    while part != real(0.0) and d < model.dense.count:
        b = model.dense.body[d]
        i = d - model.bodies.dense_start[b]
        row = int(0)
        while row < model.rows.count and i < model.bodies.inertia_count[b]:
            total = real(0.0)
            for side in range(2):
                marker = marker_of(model, row, side)
                f = model.markers.interface[marker]
                if f >= 0 and model.markers.body[marker] == b and model.interfaces.stiffening_start[f] >= 0:
                    for c in range(6):
                        pull = row_pull[w, 2 * row + side, c]
                        if pull != real(0.0):  # most are, along the axes of the body
                            at = line_of(model, w, f) + c * model.interfaces.width + i
                            total += pull * (slope[at] - slope0[at])
            if total != real(0.0):
                line = 6 * model.bodies.count + d
                column = model.outer.row_offset + row
                tangent[w, line, column] = tangent[w, line, column] - part * total
            row += 1
        d += wp.block_dim()


@wp.kernel
def keep_lags(
    ctl: wp.array(dtype=Control),
    lag1: wp.array3d(dtype=real),
    lag: out(wp.array3d(dtype=real)),
):
    """Lanes over dense modes: y and Y of an accepted attempt."""
    w, lane = wp.tid()
    if ctl[w].accept == 0 or ctl[w].mode == k.PROJECT:
        return
    d = lane
    while d < lag.shape[2]:
        for i in range(2):
            lag[w, i, d] = lag1[w, i, d]
        d += wp.block_dim()


@wp.kernel
def keep_pulls(
    models: wp.array(dtype=Model),
    ctl: wp.array(dtype=Control),
    lam: wp.array2d(dtype=real),
    row_pull: wp.array3d(dtype=real),
    interface_pull: out(wp.array3d(dtype=real)),
):
    """Lanes over interfaces: what rows pull with at the end of an accepted attempt."""
    w, lane = wp.tid()
    model = models[w]
    if ctl[w].accept == 0 or ctl[w].mode == k.PROJECT:
        return
    f = lane
    while f < model.interfaces.count:
        for c in range(6):
            interface_pull[w, f, c] = pull_of_rows(model, w, f, c, lam, row_pull)
        f += wp.block_dim()
